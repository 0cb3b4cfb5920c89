"""Least squares with few evaluations: against scipy on a curved valley, at a bound, and its Jacobian."""

import numpy as np
import pytest
from scipy.optimize import least_squares as reference

pytest.importorskip("dfols")

from unitcell3d.identify.least_squares import solve

t = np.linspace(0, 3, 12)
FREE = (np.full(3, -10.0), np.full(3, 10.0))


def curve(x):
    """Sum of two decays, in logarithms: a curved valley, as of moduli that a compression hardly tells apart."""
    return np.exp(x[0]) * np.exp(-np.exp(x[1]) * t) + np.exp(x[2]) * np.exp(-2 * t)


class Counted:
    def __init__(self, data, noise=0.0, random=None):
        self.data, self.noise, self.random, self.calls = data, noise, random, 0

    def __call__(self, points):
        self.calls += len(points)
        errors = [self.noise * self.random.standard_normal(len(t)) if self.noise else 0.0 for _ in points]
        return [curve(x) - self.data + error for x, error in zip(points, errors)]


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_finds_the_minimum_of_scipy_with_few_evaluations(seed, noise):
    """From starts that are a factor of two off, also where each evaluation has an error of its own."""
    random = np.random.default_rng(seed)
    start = np.array([0.7, -0.4, 0.2]) + 0.7 * random.standard_normal(3)
    data = curve(np.array([0.7, -0.4, 0.2])) + 0.01 * random.standard_normal(len(t))
    evaluate = Counted(data, noise, random)
    found = solve(evaluate, start, FREE)
    exact = reference(lambda x: curve(x) - data, start, xtol=1e-12, ftol=1e-12)
    assert found.met
    assert np.sum((curve(found.x) - data) ** 2) <= 1.02 * 2 * exact.cost
    assert found.residual == pytest.approx(curve(found.x) - data, abs=5 * noise + 1e-12)
    assert evaluate.calls < 50


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
