"""Least squares with few evaluations: against a plain solver on a curved valley, at a bound, past a failed trial."""

import numpy as np
import pytest
from scipy.optimize import least_squares as reference

from unitcell3d.identify.least_squares import solve

t = np.linspace(0, 3, 12)
TRUTH = np.array([0.7, -0.4, 0.2])
FREE = (np.full(3, -10.0), np.full(3, 10.0))


def decays(x):
    return np.exp(x[0]) * np.exp(-np.exp(x[1]) * t), np.exp(x[2]) * np.exp(-2 * t)


def curve(x):
    """Sum of two decays, in logarithms: a curved valley, as of moduli that a compression hardly tells apart."""
    return sum(decays(x))


def jacobian(x):
    first, second = decays(x)
    return np.stack([first, -np.exp(x[1]) * t * first, second], axis=1)


class Counted:
    def __init__(self, data):
        self.data = data
        self.calls = 0

    def __call__(self, x):
        self.calls += 1
        return curve(x) - self.data, jacobian(x)


@pytest.mark.parametrize("seed", range(10))
def test_finds_the_minimum_with_few_evaluations(seed):
    """From starts that are a factor of two off, with a misfit that no x takes away."""
    random = np.random.default_rng(seed)
    start = TRUTH + 0.7 * random.standard_normal(3)
    data = curve(TRUTH) + 0.01 * random.standard_normal(len(t))
    evaluate = Counted(data)
    found = solve(evaluate, start, FREE)
    exact = reference(lambda x: curve(x) - data, start, xtol=1e-12, ftol=1e-12)
    assert found.met
    assert np.sum((curve(found.x) - data) ** 2) <= 1.02 * 2 * exact.cost
    assert found.residual == pytest.approx(curve(found.x) - data, abs=1e-12)
    assert found.jacobian == pytest.approx(jacobian(found.x), abs=1e-12)
    assert evaluate.calls < 25


def test_stays_inside_its_bounds():
    bounds = (np.full(3, -10.0), np.array([0.3, 10.0, 10.0]))
    found = solve(Counted(curve(TRUTH)), np.array([0.0, 0.0, 0.0]), bounds)
    exact = reference(lambda x: curve(x) - curve(TRUTH), np.zeros(3), bounds=bounds)
    assert found.x[0] <= 0.3
    assert np.sum(found.residual**2) <= 1.1 * 2 * exact.cost + 1e-6


def test_a_step_to_where_nothing_is_computed_is_taken_shorter():
    evaluate = Counted(curve(TRUTH))

    def failing_once(x):
        residual, slopes = evaluate(x)
        return (np.full(len(t), np.nan) if evaluate.calls == 2 else residual), slopes

    found = solve(failing_once, np.array([-0.5, 0.6, 0.9]), FREE)
    assert found.met
    assert found.x == pytest.approx(TRUTH, abs=0.05)
