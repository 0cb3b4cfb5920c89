"""The packed table against the plain one: its potential and slopes, its continuity, and its bounds of the tension."""

import numpy as np
import pytest

from shellfabric.cell import packed_table

FORMS = ["equilibrium", "variational"]


def packed_potential(table, cells, p, q):
    """(W, dW/dp, dW/dq) [J] of the packed rows at local coordinates p, q of cells, numbered along the weft first."""
    rows, constant = packed_table.potential(table)
    c1, c11, c2, c22, c12, c112, c122, c1122 = rows[cells].T
    W = constant[cells] + c1 * p + c11 * p**2 + c2 * q + c22 * q**2
    W += c12 * p * q + c112 * p**2 * q + c122 * p * q**2 + c1122 * p**2 * q**2
    slope1 = c1 + 2 * c11 * p + c12 * q + 2 * c112 * p * q + c122 * q**2 + 2 * c1122 * p * q**2
    slope2 = c2 + 2 * c22 * q + c12 * p + c112 * p**2 + 2 * c122 * p * q + 2 * c1122 * p**2 * q
    return np.stack([W, slope1, slope2])


def plain_potential(table, i, j, p, q):
    """(W, dW/dp, dW/dq) [J] of the plain table's spline in the cells (i, j)."""
    c = table.spline[i, j].reshape(-1, 3, 3)
    P, Q = np.stack([p**0, p, p**2], 1), np.stack([q**0, q, q**2], 1)
    dP, dQ = np.stack([0 * p, p**0, 2 * p], 1), np.stack([0 * q, q**0, 2 * q], 1)
    return np.stack([np.einsum("mab,ma,mb->m", c, *pair) for pair in ((P, Q), (dP, Q), (P, dQ))])


@pytest.mark.parametrize("form", FORMS)
def test_rows_have_the_values_and_slopes_of_the_spline(tables, form):
    table, rng = tables[form], np.random.default_rng(1)
    n1, n2 = table.spline.shape[:2]
    i, j = rng.integers(0, n1, 5000), rng.integers(0, n2, 5000)
    p, q = rng.uniform(0, 1, (2, 5000))
    found, expected = packed_potential(table, i * n2 + j, p, q), plain_potential(table, i, j, p, q)
    for one, other in zip(found, expected):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13 * np.abs(other).max())


@pytest.mark.parametrize("form", FORMS)
def test_values_and_slopes_are_continuous_from_cell_to_cell(tables, form):
    table, across = tables[form], np.linspace(0, 1, 5)
    n1, n2 = table.spline.shape[:2]
    cells = np.arange(n1 * n2).reshape(n1, n2)
    for before, behind, along in ((cells[:-1], cells[1:], 0), (cells[:, :-1], cells[:, 1:], 1)):
        for a in across:
            ends = [(1.0, a), (0.0, a)] if along == 0 else [(a, 1.0), (a, 0.0)]
            here, there = (packed_potential(table, n.ravel(), *end) for n, end in zip((before, behind), ends))
            for one, other in zip(here, there):
                np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())


def test_bound_of_a_single_cell_of_constant_tension():
    """Below its force nothing is known of it; at its force the tension is what it is above that; beyond, its own."""
    N, T = 3.0, 4.0
    plain = np.zeros((2, 3, 1))
    force, tension = plain.copy(), plain.copy()
    force[:, 0], tension[:, 0] = N, T
    steps, unit = packed_table._ceiling(*packed_table._bounds(force, tension))
    assert unit == pytest.approx(T / 256, rel=1e-12)
    first = round(N / unit)  # N lies where two steps meet, so that rounding puts it into both
    np.testing.assert_array_equal(steps[: first - 1], 0.0)
    np.testing.assert_allclose(steps[first - 1 : first + 1, 1], T - N, rtol=1e-8)
    np.testing.assert_allclose(steps[first + 1 :], np.tile([T, 0.0], (256 - first, 1)), rtol=1e-8)
