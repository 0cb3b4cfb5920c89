"""Eight numbers at once: every operation against numpy on the same numbers."""

import numpy as np
import pytest
from numba import njit
from numpy.testing import assert_allclose, assert_array_equal

from shellfabric.jit import simd
from shellfabric.jit.simd import load, store

N = 8
RNG = np.random.default_rng(5)
A, B, C = RNG.uniform(-3, 3, (3, 2 * N))
TABLE = RNG.normal(size=(50, 8))
ROW = RNG.integers(0, 50, N)
FLAGS = np.array([9, 0, 2, 1, 2, 2, 0, 255, 2], np.uint8)


@njit
def operations(a, b, c, count, out):
    x = load(a, 0)
    y = load(b, 0)
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
    store(out[11], 0, simd.shift_in_prev(x, load(a, 8)))
    store(out[12], 0, simd.where(simd.head_mask(count), x, -1.0))
    store(out[13], 0, simd.fma(x, y, load(c, 0)))
    bits = simd.movemask(simd.greater(x, y))
    store(out[14], 0, simd.where(simd.mask_from_bits(bits ^ 0b1001), 1.0, 0.0))
    some = simd.any_lane(simd.greater(x, 2.0))
    none = simd.any_lane(simd.greater(x, 3.1))
    return simd.reduce_add(x), simd.reduce_max(x), some, none, bits


@pytest.mark.parametrize("count", [0, 1, 5, 8, 11])
def test_operations(count):
    out, (a, b) = np.empty((15, N)), (A[:N], B[:N])
    total, *others = operations(A, B, C, count, out)
    exact = [
        a + b,
        2 - a,
        a * b,
        a / b,
        np.minimum(a, b),
        np.maximum(a, 0.5),
        np.where(a > b, a, 1.0),
        abs(a),
    ]
    exact += [np.copysign(a, b), np.floor(a), np.sqrt(abs(a)), A[N - 1 : -1]]
    exact += [
        np.where(np.arange(N) < count, a, -1.0),
        out[13],
        (a > b) ^ np.isin(np.arange(N), (0, 3)),
    ]
    assert_array_equal(out, exact)
    assert_allclose(out[13], a * b + C[:N], rtol=1e-14, atol=1e-15)
    assert others == [a.max(), (a > 2.0).any(), False, (1 << np.arange(N))[a > b].sum()]
    assert total == pytest.approx(a.sum(), rel=1e-14)


@njit
def operations_on_floats(a, b, out):
    for k in range(N):
        x = a[k]
        y = b[k]
        out[0, k] = simd.minimum(x, y)
        out[1, k] = simd.maximum(x, 0.5)
        out[2, k] = simd.where(simd.greater(x, y), x, 1.0)
        out[3, k] = simd.fabs(x)
        out[4, k] = simd.floor(x)
        out[5, k] = simd.sqrt(simd.fabs(x))
        out[6, k] = simd.where(simd.both(simd.greater(x, y), simd.greater(1.0, x)), 3.0, y)
        out[7, k] = simd.reduce_add(x) + 2.0 * simd.reduce_max(y)
    store(out[8], 0, load(a, 0))
    x = load(a, 0)
    y = load(b, 0)
    store(out[9], 0, simd.where(simd.both(simd.greater(x, y), simd.greater(1.0, x)), 3.0, y))


def test_operations_on_floats():
    out, (a, b) = np.empty((10, N)), (A[:N], B[:N])
    operations_on_floats(A, B, out)
    where = np.where((a > b) & (a < 1.0), 3.0, b)
    exact = [np.minimum(a, b), np.maximum(a, 0.5), np.where(a > b, a, 1.0), abs(a)]
    exact += [np.floor(a), np.sqrt(abs(a)), where, a + 2.0 * b, a, where]
    assert_array_equal(out, exact)
    assert len(set(where == 3.0)) == 2


@njit
def roots(x, out):
    for j in range(0, x.size, 8):
        store(out, j, simd.rsqrt(load(x, j)))


@njit
def roots_one_by_one(x, out):
    for j in range(x.size):
        out[j] = simd.rsqrt(x[j])


def test_inverse_root_is_exact_to_the_last_digit():
    """Over all squares of stretches that a run can meet, and at rest to the bit."""
    x = np.append(np.geomspace(1e-6, 1e6, 79999), 1.0)
    out = np.empty_like(x)
    roots(x, out)
    assert abs(out * np.sqrt(x) - 1).max() < 4e-16
    assert out[-1] == 1.0
    alone = np.empty_like(x)
    roots_one_by_one(x, alone)
    assert_array_equal(alone, out)


@njit
def memory(table, narrow, row, flags, small, noted, masked, out):
    which = simd.to_int32(load(row, 0))
    simd.store_int32(noted, 3, which)
    rows = simd.gather8_indexed(table, noted, 3)
    four = simd.gather_rows4(narrow, which)
    x = load(small, 2)
    for m in range(8):
        store(out[m], 0, rows[m])
    for m in range(4):
        store(out[8 + m], 0, four[m])
    store(out[12], 0, simd.gather(narrow[:, 0].copy(), which))
    for m in range(8):
        one = simd.gather_rows4(narrow, simd.to_int32(row[m]))
        out[13, m], out[14, m], out[15, m], out[16, m] = one
    store(small, 20, x + 1e-3)
    for count in range(12):
        simd.masked_store(masked[count], 3, load(row, 0), count)
    return simd.movemask(simd.equal_bytes(flags, 1, 2)), simd.movemask(simd.head_mask(3))


def test_memory():
    """Rows are gathered as columns; what is stored, in single precision too, overruns nothing."""
    noted = np.full(16, -1, np.int32)
    out = np.empty((17, N))
    masked = np.zeros((12, 16))
    small = RNG.normal(size=32).astype(np.float32)
    row = ROW.astype(float)
    bits = memory(TABLE, TABLE[:, :4].copy(), row, FLAGS, small, noted, masked, out)
    assert_array_equal(out, TABLE[ROW].T[[*range(8), *range(4), 0, *range(4)]])
    assert_array_equal(noted, [-1] * 3 + list(ROW) + [-1] * 5)
    assert_array_equal(small[20:28], (small[2:10].astype(float) + 1e-3).astype(np.float32))
    for count, stored in enumerate(masked):
        assert_array_equal(stored, np.pad(row[:count], (3, 13 - min(count, N))))
    assert bits == ((1 << np.arange(N))[FLAGS[1:] == 2].sum(), 0b111)
