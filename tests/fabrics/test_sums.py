"""Sums of `fabrics.base.sums` against numpy's and scipy's, and the same bits for every BLAS kernel."""

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import spsolve

from fabrics.base import sums

RNG = np.random.default_rng(4)


def test_norms_are_those_of_numpy():
    values = RNG.normal(size=(5, 7, 3))
    assert sums.norm(values) == pytest.approx(np.linalg.norm(values), rel=1e-14)
    for axis in (0, 1, -1):
        expected = np.linalg.norm(values, axis=axis, keepdims=True)
        assert sums.norm(values, axis, keepdims=True) == pytest.approx(expected, rel=1e-14)


def test_products_are_those_of_numpy():
    first = RNG.normal(size=(6, 4, 3))
    second = RNG.normal(size=(3, 5))
    vector = RNG.normal(size=3)
    assert sums.multiply(first, second) == pytest.approx(first @ second, rel=1e-13)
    assert sums.multiply(first, vector) == pytest.approx(first @ vector, rel=1e-13)
    assert sums.multiply(vector, second) == pytest.approx(vector @ second, rel=1e-13)
    assert sums.dot(vector, second[:, 2]) == pytest.approx(vector @ second[:, 2], rel=1e-13)


def test_determinants_and_inverses_are_those_of_numpy():
    matrices = RNG.normal(size=(8, 3, 3))
    assert sums.determinant(matrices) == pytest.approx(np.linalg.det(matrices), rel=1e-12)
    assert sums.invert(matrices) == pytest.approx(np.linalg.inv(matrices), rel=1e-9)


def test_a_line_is_that_of_least_squares():
    x = np.array([-1.0, 0.5, 2.0, 7.0])
    y = np.array([3.0, 1.0, 4.0, -6.0])
    assert sums.fit_line(x, y) == pytest.approx(np.polyfit(x, y, 1), rel=1e-12)


def test_a_membrane_is_solved_as_by_a_factorization():
    """Of two columns of unlike sizes; what nothing loads stays zero."""
    n = 9
    row = sparse.diags([-1.0, 2.2, -1.0], [-1, 0, 1], shape=(n, n))
    other = sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(4, 4))
    matrix = sparse.block_diag([sparse.kronsum(row, other), other]).tocsr()
    loads = RNG.normal(size=(matrix.shape[0], 2)) * [3e-5, 40.0]
    loads[-4:] = 0.0
    found = sums.solve_laplace(matrix, loads)
    expected = spsolve(matrix.tocsc(), loads)
    for column in range(2):
        assert found[:, column] == pytest.approx(expected[:, column], rel=1e-9)
    assert not found[-4:].any()
