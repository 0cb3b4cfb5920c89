"""Least squares with few evaluations: against scipy on a curved valley, at a bound, and its Jacobian."""

import numpy as np
import pytest
from scipy.optimize import least_squares as reference

from unitcell3d.identify.levenberg_marquardt import solve

t = np.linspace(0, 3, 12)
FREE = (np.full(3, -10.0), np.full(3, 10.0))


def curve(x):
    """Sum of two decays, in logarithms: a curved valley, as of moduli that a compression hardly tells apart."""
    return np.exp(x[0]) * np.exp(-np.exp(x[1]) * t) + np.exp(x[2]) * np.exp(-2 * t)


class Counted:
    def __init__(self, data):
        self.data, self.calls, self.rounds = data, 0, 0

    def __call__(self, points):
        self.calls += len(points)
        self.rounds += 1
        return [curve(x) - self.data for x in points]


@pytest.mark.parametrize("trials", [1, 2, 4])
def test_finds_the_minimum_of_scipy_with_few_evaluations(trials):
    noisy = curve(np.array([0.7, -0.4, 0.2])) + 0.01 * np.random.default_rng(5).standard_normal(len(t))
    evaluate = Counted(noisy)
    found = solve(evaluate, np.array([-0.5, 0.5, -1.0]), FREE, trials=trials)
    exact = reference(lambda x: curve(x) - noisy, (-0.5, 0.5, -1.0), xtol=1e-12, ftol=1e-12)
    assert found.met
    assert np.sum(found.residual**2) <= 1.02 * 2 * exact.cost
    assert found.residual == pytest.approx(curve(found.x) - noisy)
    assert evaluate.calls < 12 * (3 + trials)
    assert evaluate.rounds < 20


def test_jacobian_is_that_of_the_solution():
    found = solve(Counted(curve(np.array([0.7, -0.4, 0.2]))), np.array([0.5, -0.2, 0.1]), FREE)
    exact = reference(lambda x: curve(x), found.x, max_nfev=1).jac
    assert np.allclose(found.jacobian, exact, rtol=0.03, atol=0.03 * np.abs(exact).max())


def test_stays_inside_its_bounds():
    bounds = (np.full(3, -10.0), np.array([0.3, 10.0, 10.0]))
    found = solve(Counted(curve(np.array([0.7, -0.4, 0.2]))), np.array([0.0, 0.0, 0.0]), bounds)
    exact = reference(lambda x: curve(x) - curve(np.array([0.7, -0.4, 0.2])), np.zeros(3), bounds=bounds)
    assert found.x[0] <= 0.3
    assert np.sum(found.residual**2) <= 1.1 * 2 * exact.cost + 1e-6
