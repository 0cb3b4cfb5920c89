"""Least squares with intervals, on curves whose answer is known."""

import numpy as np
import pytest
from scipy.stats import binom

from fabrics.errors import InputError, UnstableError
from weavecell.analysis import fit
from weavecell.analysis.fit import Parameter

X = np.linspace(0, 2, 40)
A, B = Parameter("a", "m", 0.5, 4.0, 1.0), Parameter("b", "", 0.2, 3.0, 0.5)


def decay(values):
    a, b = values
    return a * np.exp(-b * X)


def solved(measured, model=decay, parameters=(A, B)):
    return fit.solve(lambda many: [model(one) for one in many], parameters, measured, np.full(len(measured), 2.0))


def test_known_values_are_found_and_their_intervals_hold_them_in_95_of_100():
    held, rng, trials = np.zeros(2), np.random.default_rng(5), 200
    for _ in range(trials):
        found = solved(decay((2.0, 0.8)) + 0.04 * rng.standard_normal(len(X)))
        held += np.abs(found.values - (2.0, 0.8)) <= found.half
        assert found.met
        assert found.determined == [True, True]
    assert np.all(held >= binom.ppf(1e-3, trials, 0.95))
    assert np.all(held <= binom.ppf(1 - 1e-6, trials, 0.95))
    exact = solved(decay((2.0, 0.8)))
    assert exact.values == pytest.approx((2.0, 0.8), rel=1e-4)
    assert exact.rms(exact.before) > 0.1 > exact.rms(exact.computed)


def test_what_only_a_product_enters_is_known_only_together():
    rng = np.random.default_rng(1)
    found = solved(1.2 * X + 0.02 * rng.standard_normal(len(X)), lambda values: values[0] * values[1] * X)
    assert found.determined == [False, False]
    assert [pair[:2] for pair in found.together] == [("a", "b")]
    assert found.intervals[0] == (A.low, A.high)
    told = found.summary()
    assert told["known_only_together"][0][2] == pytest.approx(-1, abs=1e-3)
    assert told["parameters"]["a"]["determined"] is False


def test_a_model_that_cannot_follow_the_curve_has_wider_intervals():
    rng = np.random.default_rng(2)
    right = solved(decay((2.0, 0.8)) + 0.04 * rng.standard_normal(len(X)))
    wrong = solved(decay((2.0, 0.8)) + 0.08 * np.sin(6 * X))
    assert right.likeness == 0
    assert wrong.likeness > 0.8
    noise = wrong.rms(wrong.computed) / right.rms(right.computed)
    assert np.all(wrong.half > 2.5 * noise * right.half)


def test_a_solution_beyond_the_range_is_at_its_end():
    found = solved(decay((5.0, 0.8)))
    assert found.at_bound == [True, False]
    assert found.values[0] == pytest.approx(4.0, rel=1e-3)


def test_runs_that_fail_are_stepped_back_from():
    fails = lambda values: decay(values) if values[0] < 2.05 else np.full(len(X), np.nan)  # noqa: E731
    found = solved(decay((2.0, 0.8)), fails)
    assert found.values == pytest.approx((2.0, 0.8), rel=1e-3)
    with pytest.raises(UnstableError, match="the values that the fit begins with"):
        solved(decay((2.0, 0.8)), lambda values: np.full(len(X), np.nan))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Parameter("a", "m", 2.0, 1.0, 1.5), r"a = '2..1': must be a range LOW..HIGH that rises"),
        (lambda: Parameter("a", "m", 1.0, 2.0, 0.5), r"a = '1..2': must be a range about 0.5"),
        (lambda: solved(decay((2.0, 0.8))[:2]), r"points = 2: must be more than the 2 parameters"),
    ],
)
def test_refused(make, words):
    with pytest.raises(InputError, match=words):
        make()
