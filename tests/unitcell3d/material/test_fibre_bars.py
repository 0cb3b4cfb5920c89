"""Fibre bars: law, force and tangent against plain twins."""

import numpy as np
import pytest
from equations import assert_tangent, dense
from numpy.testing import assert_allclose

from unitcell3d.material.fibre_kernels import bar_forces, bar_strains, bar_tangent, fibre_law
from unitcell3d.material.fibres import Fibres

R = 1e-3
D = 1e-4


def plain_law(e):
    if e <= 0:
        return R * e
    if e >= D:
        return e
    t = e / D
    return R * e * (1 - t) ** 2 + e * t * (2 - t)


def test_law_and_its_continuous_slope():
    for e in (-0.01, -1e-6, 0.2 * D, 0.7 * D, D, 2 * D, 0.03):
        value, slope = fibre_law(e, R, D)
        assert value == pytest.approx(plain_law(e), rel=1e-14)
        step = 1e-5 * D
        assert slope == pytest.approx(
            (plain_law(e + step) - plain_law(e - step)) / (2 * step), rel=1e-5
        )
    assert fibre_law(0.0, R, D) == (0.0, R)
    for join in (0.0, D):  # where the kink was
        below = fibre_law(join - 1e-12, R, D)[1]
        above = fibre_law(join + 1e-12, R, D)[1]
        assert above == pytest.approx(below, abs=1e-6)


@pytest.fixture
def bundle():
    rng = np.random.default_rng(0)
    X = rng.standard_normal((6, 3))
    pairs = np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [0, 5]])
    length = np.linalg.norm(X[pairs[:, 1]] - X[pairs[:, 0]], axis=1) / np.array(
        [1.02, 0.99, 1.00005, 1.0, 1.03, 0.9]
    )
    return X, pairs, length, np.array([3.0, 5.0, 2.0, 4.0, 1.0, 6.0])


def forces_of(X, pairs, length, stiffness):
    forces = np.zeros_like(X)
    bar_forces(X, pairs, length, stiffness, R, D, forces)
    return forces


def test_forces_equal_the_plain_twin(bundle):
    X, pairs, length, stiffness = bundle
    plain = np.zeros_like(X)
    for (p, q), L, EA in zip(pairs, length, stiffness):
        edge = X[q] - X[p]
        l = np.linalg.norm(edge)
        N = EA * plain_law(l / L - 1)
        plain[q] += N * edge / l
        plain[p] -= N * edge / l
    assert_allclose(forces_of(*bundle), plain, rtol=1e-13)
    strain = np.empty(len(pairs))
    bar_strains(X, pairs, length, strain)
    assert np.allclose(strain, [0.02, -0.01, 0.00005, 0, 0.03, -0.1])


def test_tangent_is_the_derivative(bundle):
    X, pairs, length, stiffness = bundle
    n = len(X)

    def check(some, step, tolerance):
        values = np.zeros((n * n, 3, 3))
        places = pairs[some, :, None] * n + pairs[some, None, :]
        bar_tangent(X, pairs[some], length[some], stiffness[some], R, D, places, values)
        K = dense(values, n)
        direction = np.random.default_rng(1).standard_normal(X.shape)
        assert np.allclose(K, K.T)
        assert_tangent(
            K,
            lambda x: forces_of(x, pairs[some], length[some], stiffness[some]),
            X,
            direction,
            step,
            tolerance,
        )

    # the bar at zero strain stands on its kink of second order: with it the difference is good to the step
    check(np.arange(len(pairs)), 1e-7, 1e-2)
    check(np.delete(np.arange(len(pairs)), [2, 3]), 1e-5, 1e-9)


def test_the_mean_strain_of_a_yarn_is_that_of_its_fibre_volume(tiny, s720):
    fibres = Fibres(tiny, s720)
    strain = np.random.default_rng(2).uniform(-0.01, 0.03, len(fibres.pairs))
    found = fibres.means(strain)
    for yarn, (pairs, area) in enumerate(zip(tiny.bars, tiny.bar_area)):
        edges = tiny.points[pairs[:, 1]] - tiny.points[pairs[:, 0]]
        volume = area * np.linalg.norm(edges, axis=1)
        of_yarn = strain[fibres.yarn == yarn]
        assert found[yarn] == pytest.approx((volume * of_yarn).sum() / volume.sum(), rel=1e-12)
