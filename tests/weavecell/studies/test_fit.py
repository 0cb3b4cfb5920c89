"""Least squares with intervals, on curves whose answer is known."""

import numpy as np
import pytest
from scipy.stats import binom

import weavecell as wc
from fabrics.errors import InputError, UnstableError
from fabrics.variants import scale_yarns

X = np.linspace(0, 2, 40)
BOTH = {"a": (0.5, 1.0, 4.0), "b": (0.2, 0.5, 3.0)}


def decay(a, b):
    return a * np.exp(-b * X)


def test_known_values_are_found_and_their_intervals_hold_them_in_95_of_100():
    held, rng, trials = np.zeros(2), np.random.default_rng(5), 200
    for _ in range(trials):
        fit = wc.fit(decay, decay(2.0, 0.8) + 0.04 * rng.standard_normal(len(X)), BOTH)
        held += [
            abs(fit.values[name] - known) <= fit.half[name]
            for name, known in (("a", 2.0), ("b", 0.8))
        ]
        assert fit.converged
        assert fit.determined == {"a": True, "b": True}
    assert np.all(held >= binom.ppf(1e-3, trials, 0.95))
    assert np.all(held <= binom.ppf(1 - 1e-6, trials, 0.95))


def test_what_only_a_product_enters_is_known_only_together():
    measured = 1.2 * X + 0.02 * np.random.default_rng(1).standard_normal(len(X))
    fit = wc.fit(lambda a, b: a * b * X, measured, BOTH)
    assert fit.determined == {"a": False, "b": False}
    assert fit.correlation[0, 1] == pytest.approx(-1, abs=1e-3)
    assert fit.half["a"] > 3.5


def test_a_model_that_cannot_follow_the_curve_has_wider_intervals():
    noise = np.random.default_rng(2).standard_normal(len(X))
    right, wrong = (
        wc.fit(decay, decay(2.0, 0.8) + off, BOTH) for off in (0.04 * noise, 0.08 * np.sin(6 * X))
    )
    assert right.likeness == 0
    assert wrong.likeness > 0.8
    assert all(wrong.half[name] > 2.5 * wrong.rms / right.rms * right.half[name] for name in BOTH)


def test_a_solution_beyond_the_range_is_at_its_end():
    assert wc.fit(decay, decay(5.0, 0.8), BOTH).values["a"] == pytest.approx(4.0, rel=1e-3)


def test_runs_that_fail_are_stepped_back_from():
    def fails(a, b):
        if a > 2.05:
            raise UnstableError("a run")
        return decay(a, b)

    assert list(wc.fit(fails, decay(2.0, 0.8), BOTH).values.values()) == pytest.approx(
        (2.0, 0.8), rel=1e-3
    )
    with pytest.raises(UnstableError, match="the values that the fit begins with"):
        wc.fit(lambda a, b: np.nan * X, decay(2.0, 0.8), BOTH)


@pytest.mark.parametrize(
    ("unknowns", "count", "words"),
    [
        ({"a": (2, 1.5, 1)}, 40, "which rise"),
        ({"a": (1, 0.5, 2)}, 40, "which rise"),
        (BOTH, 2, "more than the 2"),
    ],
)
def test_refused(unknowns, count, words):
    with pytest.raises(InputError, match=words):
        wc.fit(decay, X[:count] + 1, unknowns)


def test_the_modulus_that_made_the_curve_of_a_shot_is_found():
    times = np.linspace(2e-6, 98e-6, 40)

    def velocity(modulus):
        shot = wc.impact(
            scale_yarns(wc.fabric("S-720"), E=modulus), "90 m/s", opening="50 mm", end_time="100 us"
        )
        return np.interp(times, *shot.to_dataframe()[["time_s", "velocity_m_s"]].to_numpy().T)

    fit = wc.fit(velocity, velocity(0.9), {"modulus": (0.5, 1.0, 2.0)})
    assert fit.values["modulus"] == pytest.approx(0.9, rel=0.01)
    assert fit.rms < 1e-3
