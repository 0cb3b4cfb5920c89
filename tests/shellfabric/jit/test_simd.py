"""Eight numbers at once: every operation against numpy on the same numbers."""

import numpy as np
import pytest
from numba import njit

from shellfabric.jit import simd
from shellfabric.jit.simd import load, store

N = 8
RNG = np.random.default_rng(5)
A, B, C = RNG.uniform(-3, 3, (3, N))


@njit
def arithmetic(a, b, c, out):
    x, y, z = load(a, 0), load(b, 0), load(c, 0)
    store(out[0], 0, x + y)
    store(out[1], 0, 2.0 - x)
    store(out[2], 0, x * y)
    store(out[3], 0, x / y)
    store(out[4], 0, simd.fma(x, y, z))
    store(out[5], 0, simd.minimum(x, y))
    store(out[6], 0, simd.maximum(x, 0.5))
    store(out[7], 0, simd.where(simd.greater(x, y), x, 1.0))
    store(out[8], 0, simd.fabs(x))
    store(out[9], 0, simd.copysign(x, y))
    store(out[10], 0, simd.floor(x))
    store(out[11], 0, simd.sqrt(simd.fabs(x)))
    store(out[12], 0, simd.rsqrt(simd.fabs(x)))
    return (
        simd.reduce_add(x),
        simd.reduce_max(x),
        simd.any_lane(simd.greater(x, 2.9)),
        simd.any_lane(simd.greater(x, 3.1)),
    )


def test_arithmetic():
    out = np.empty((13, N))
    total, highest, some, none = arithmetic(A, np.abs(B), C, out)
    b = np.abs(B)
    exact = (
        A + b, 2 - A, A * b, A / b, None, np.minimum(A, b), np.maximum(A, 0.5), np.where(A > b, A, 1.0), np.abs(A),
        np.abs(A), np.floor(A), np.sqrt(np.abs(A)),
    )  # fmt: skip
    for found, expected in zip(out, exact):
        if expected is not None:
            np.testing.assert_array_equal(found, expected)
    np.testing.assert_allclose(out[4], A * b + C, rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(out[12], 1 / np.sqrt(np.abs(A)), rtol=5e-16)
    assert total == pytest.approx(A.sum(), rel=1e-14)
    assert highest == A.max()
    assert (some, none) == ((A > 2.9).any(), False)


@njit
def roots(x, out):
    for j in range(0, x.size, 8):
        store(out, j, simd.rsqrt(load(x, j)))


def test_inverse_root_is_exact_to_the_last_digit():
    """Over all squares of stretches that a run can meet, and at rest to the bit."""
    x = np.append(np.geomspace(1e-6, 1e6, 79999), 1.0)
    out = np.empty_like(x)
    roots(x, out)
    assert np.abs(out * np.sqrt(x) - 1).max() < 4e-16
    assert out[-1] == 1.0


@njit
def rows(table, cell, out):
    which = simd.to_int32(load(cell, 0))
    columns = simd.gather_rows4(table, which)
    for m in range(4):
        store(out[m], 0, columns[m])


@njit
def long_rows(table, cell, out):
    columns = simd.gather_rows8(table, simd.to_int32(load(cell, 0)))
    for m in range(8):
        store(out[m], 0, columns[m])


@pytest.mark.parametrize(("width", "read"), [(4, rows), (8, long_rows)])
def test_columns_of_a_table(width, read):
    table = RNG.normal(size=(50, width))
    cell, out = RNG.integers(0, 50, N), np.empty((width, N))
    read(table, cell.astype(float), out)
    np.testing.assert_array_equal(out, table[cell].T)


@njit
def noted(table, cell, spots, out):
    which = simd.to_int32(load(cell, 0))
    simd.store_int32(spots, 3, which)
    columns = simd.gather8_indexed(table, spots, 3)
    for m in range(8):
        store(out[m], 0, columns[m])
    store(out[8], 0, simd.gather(table[:, 0].copy(), which))


def test_rows_whose_numbers_are_kept():
    table, cell = RNG.normal(size=(50, 8)), RNG.integers(0, 50, N)
    spots, out = np.full(16, -1, np.int32), np.empty((9, N))
    noted(table, cell.astype(float), spots, out)
    np.testing.assert_array_equal(out, table[cell].T[[*range(8), 0]])
    np.testing.assert_array_equal(spots, [-1] * 3 + list(cell) + [-1] * 5)


@njit
def neighbours(x, out):
    store(out[0], 0, simd.shift_in_prev(load(x, 0), load(x, 8)))
    store(out[1], 0, simd.shift_in_next(load(x, 0), load(x, 8)))


def test_neighbouring_slots():
    x, out = np.arange(16.0), np.empty((2, N))
    neighbours(x, out)
    np.testing.assert_array_equal(out, [x[7:15], x[1:9]])


@njit
def part(value, count, out):
    simd.masked_store(out, 3, load(value, 0), count)
    store(out, 20, simd.where(simd.head_mask(count), load(value, 0), -1.0))


@pytest.mark.parametrize("count", [0, 1, 5, 8, 11])
def test_what_must_not_be_overrun_is_not(count):
    out, kept = np.zeros(32), min(count, N)
    part(A, count, out)
    np.testing.assert_array_equal(out[3 : 3 + kept], A[:kept])
    assert not out[3 + kept : 20].any()
    np.testing.assert_array_equal(out[20:28], np.where(np.arange(N) < count, A, -1.0))


@njit
def widened(small, out):
    x = load(small, 2)
    store(out, 0, x)
    store(small, 20, x + 1e-3)


def test_single_precision_storage():
    small, out = RNG.normal(size=32).astype(np.float32), np.empty(N)
    widened(small, out)
    np.testing.assert_array_equal(out, small[2:10].astype(float))
    np.testing.assert_array_equal(small[20:28], (out + 1e-3).astype(np.float32))


@njit
def answers(a, b, flags, value, out):
    x, y = load(a, 0), load(b, 0)
    bits = simd.movemask(simd.greater(x, y))
    store(out, 0, simd.where(simd.mask_from_bits(bits ^ 0b1001), 1.0, 0.0))
    return bits, simd.movemask(simd.equal_bytes(flags, 1, value)), simd.movemask(simd.head_mask(3))


def test_answers_as_bits():
    flags, out, powers = np.array([9, 0, 2, 1, 2, 2, 0, 255, 2, 7], np.uint8), np.empty(N), 1 << np.arange(N)
    bits, those, first = answers(A, B, flags, 2, out)
    assert bits == powers[A > B].sum()
    assert those == powers[flags[1:9] == 2].sum()
    assert first == 0b111
    np.testing.assert_array_equal(out, (A > B) ^ np.isin(np.arange(N), (0, 3)))
