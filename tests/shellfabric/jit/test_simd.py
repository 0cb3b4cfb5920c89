"""Eight numbers at once: every operation against numpy on the same numbers."""

import numpy as np
import pytest
from numba import njit

from shellfabric.jit import simd
from shellfabric.jit.simd import load, store

N = 8
RNG = np.random.default_rng(5)
A, B, C = RNG.uniform(-3, 3, (3, N))
TABLE, ROW, FLAGS = RNG.normal(size=(50, 8)), RNG.integers(0, 50, N), np.array([9, 0, 2, 1, 2, 2, 0, 255, 2], np.uint8)


@njit
def arithmetic(a, b, c, out):
    x, y, z = load(a, 0), load(b, 0), load(c, 0)
    store(out[0], 0, x + y)
    store(out[1], 0, 2.0 - x)
    store(out[2], 0, x * y)
    store(out[3], 0, x / y)
    store(out[4], 0, simd.minimum(x, y))
    store(out[5], 0, simd.maximum(x, 0.5))
    store(out[6], 0, simd.where(simd.greater(x, y), x, 1.0))
    store(out[7], 0, simd.fabs(x))
    store(out[8], 0, simd.copysign(x, y))
    store(out[9], 0, simd.floor(x))
    store(out[10], 0, simd.sqrt(simd.fabs(x)))
    store(out[11], 0, simd.fma(x, y, z))
    some, none = simd.any_lane(simd.greater(x, 2.9)), simd.any_lane(simd.greater(x, 3.1))
    return simd.reduce_add(x), simd.reduce_max(x), some, none


def test_arithmetic():
    out = np.empty((12, N))
    total, highest, some, none = arithmetic(A, B, C, out)
    exact = [A + B, 2 - A, A * B, A / B, np.minimum(A, B), np.maximum(A, 0.5), np.where(A > B, A, 1.0), np.abs(A)]
    exact += [np.copysign(A, B), np.floor(A), np.sqrt(np.abs(A))]
    np.testing.assert_array_equal(out[:-1], exact)
    np.testing.assert_allclose(out[-1], A * B + C, rtol=1e-14, atol=1e-15)
    assert total == pytest.approx(A.sum(), rel=1e-14)
    assert (highest, some, none) == (A.max(), (A > 2.9).any(), False)


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
def gathered(table, narrow, row, noted, out):
    which = simd.to_int32(load(row, 0))
    simd.store_int32(noted, 3, which)
    rows, again, four = (
        simd.gather_rows8(table, which),
        simd.gather8_indexed(table, noted, 3),
        simd.gather_rows4(narrow, which),
    )
    for m in range(8):
        store(out[m], 0, rows[m])
        store(out[8 + m], 0, again[m])
    for m in range(4):
        store(out[16 + m], 0, four[m])
    store(out[20], 0, simd.gather(table[:, 0].copy(), which))


def test_rows_of_a_table_are_gathered_as_columns():
    noted, out, narrow = np.full(16, -1, np.int32), np.empty((21, N)), TABLE[:, :4].copy()
    gathered(TABLE, narrow, ROW.astype(float), noted, out)
    np.testing.assert_array_equal(out, TABLE[ROW].T[[*range(8), *range(8), *range(4), 0]])
    np.testing.assert_array_equal(noted, [-1] * 3 + list(ROW) + [-1] * 5)


@njit
def stored(value, count, small, out):
    store(out[0], 0, simd.shift_in_prev(load(value, 0), load(value, 8)))
    store(out[1], 0, simd.shift_in_next(load(value, 0), load(value, 8)))
    store(out[2], 0, simd.where(simd.head_mask(count), load(value, 0), -1.0))
    simd.masked_store(out[3], 3, load(value, 0), count)
    x = load(small, 2)
    store(small, 20, x + 1e-3)
    store(out[4], 0, x)


@pytest.mark.parametrize("count", [0, 1, 5, 8, 11])
def test_neighbours_masks_and_single_precision(count):
    value, small, out, kept = (
        np.arange(1.0, 17.0),
        RNG.normal(size=32).astype(np.float32),
        np.zeros((5, 16)),
        min(count, N),
    )
    stored(value, count, small, out)
    np.testing.assert_array_equal(out[:2, :8], [value[7:15], value[1:9]])
    np.testing.assert_array_equal(out[2, :8], np.where(np.arange(N) < count, value[:8], -1.0))
    np.testing.assert_array_equal(out[3], [0.0] * 3 + list(value[:kept]) + [0.0] * (13 - kept))  # no more is overrun
    np.testing.assert_array_equal(out[4, :8], small[2:10].astype(float))
    np.testing.assert_array_equal(small[20:28], (out[4, :8] + 1e-3).astype(np.float32))


@njit
def answers(a, b, flags, value, out):
    bits = simd.movemask(simd.greater(load(a, 0), load(b, 0)))
    store(out, 0, simd.where(simd.mask_from_bits(bits ^ 0b1001), 1.0, 0.0))
    return bits, simd.movemask(simd.equal_bytes(flags, 1, value)), simd.movemask(simd.head_mask(3))


def test_answers_as_bits():
    out, powers = np.empty(N), 1 << np.arange(N)
    assert answers(A, B, FLAGS, 2, out) == (powers[A > B].sum(), powers[FLAGS[1:] == 2].sum(), 0b111)
    np.testing.assert_array_equal(out, (A > B) ^ np.isin(np.arange(N), (0, 3)))
