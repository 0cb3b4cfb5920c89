"""The Lambert-Jonas curve: closed forms, exact and noisy data, and what cannot be fitted."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import curve_fit
from scipy.stats import t as student

from fabrics.base.errors import InputError
from weavecell.studies.lambert_jonas import curve, fit

STRIKE = np.linspace(101.0, 300.0, 15)


def test_curve_in_closed_form():
    """p = 2: V_r^2 = a^2 (V_s^2 - V_bl^2); nothing below the limit; a V_s far above it; a V_s at p -> infinity."""
    assert_allclose(curve(STRIKE, 0.8, 2.0, 100.0), 0.8 * np.sqrt(STRIKE**2 - 1e4), rtol=1e-13)
    assert np.all(curve(np.array([1.0, 50.0, 100.0]), 0.9, 2.6, 100.0) == 0.0)
    assert curve(1e6, 0.9, 2.6, 100.0) == pytest.approx(0.9e6, rel=1e-9)
    assert curve(150.0, 0.9, 200.0, 100.0) == pytest.approx(135.0, rel=1e-9)


@pytest.mark.parametrize("p", [1.3, 2.0, 2.6, 5.0, 12.0])
@pytest.mark.parametrize("stopped", [(), (60.0, 80.0, 99.0)])
def test_exact_data_come_back(p, stopped):
    """Parameters of the curve that made the data, with intervals of no width; stopped shots take part."""
    strike = np.array([*stopped, *STRIKE])
    residual = curve(strike, 0.9, p, 100.0)
    for known in (None, 100.0):
        found = fit(strike, residual, limit=known)
        assert (found.a, found.p, found.limit) == pytest.approx((0.9, p, 100.0), rel=1e-6)
        assert set(found.intervals) == ({"a", "p"} if known else {"a", "p", "limit"})
        for name, (low, high) in found.intervals.items():
            assert low <= getattr(found, name) <= high
            assert high - low < 1e-4 * getattr(found, name)
        assert found.residual_rms < 1e-5
        assert_allclose(found.residual_velocity(strike), residual, atol=1e-4)


def test_intervals_are_those_of_the_covariance():
    """Of one noisy set: by SciPy's `curve_fit` and Student's distribution."""
    noise = np.random.default_rng(1).normal(0, 2.0, STRIKE.size)
    residual = np.maximum(curve(STRIKE, 0.9, 2.6, 100.0) + noise, 0.1)
    found = fit(STRIKE, residual, limit=100.0, confidence=0.9)
    values, covariance = curve_fit(
        lambda strike, a, p: curve(strike, a, p, 100.0), STRIKE, residual, p0=(0.8, 2.0)
    )
    half = student.ppf(0.95, STRIKE.size - 2) * np.sqrt(np.diag(covariance))
    for name, value, width in zip("ap", values, half):
        assert found.intervals[name] == pytest.approx((value - width, value + width), rel=1e-4)


@pytest.mark.slow(3)
def test_intervals_hold_what_they_promise():
    """Of 150 noisy sets, 90 % intervals cover the truth in 90 % (binomial: 82 to 98 % at three sigma)."""
    draw = np.random.default_rng(1)
    clean = curve(STRIKE, 0.9, 2.6, 100.0)
    covered = np.zeros(2)
    for _ in range(150):
        found = fit(
            STRIKE,
            np.maximum(clean + draw.normal(0, 2.0, STRIKE.size), 0.1),
            limit=100.0,
            confidence=0.9,
        )
        for k, (name, truth) in enumerate((("a", 0.9), ("p", 2.6))):
            low, high = found.intervals[name]
            covered[k] += low < truth < high
    assert np.all(abs(covered / 150 - 0.9) < 0.074)


def test_no_projectile_leaves_faster_than_it_came():
    """Data that would want a > 1 end at 1, without an interval for it and with one for the others; p is not determined
    by scatter that leaves half of it open, nor by one velocity."""
    found = fit(STRIKE, 1.2 * curve(STRIKE, 0.9, 2.0, 100.0), limit=100.0)
    assert found.a == pytest.approx(1.0, abs=1e-6)
    assert found.intervals["a"] is None
    assert found.intervals["p"] is not None
    assert found.words().startswith("a = 1 (its upper bound), p = ")
    scatter = curve(STRIKE, 0.9, 2.6, 100.0) * (1 + 0.3 * (-1.0) ** np.arange(15))
    assert ", p not determined, about " in fit(STRIKE, scatter, limit=100.0).words()
    assert fit([150.0] * 4, [90.0] * 4, limit=100.0).words().endswith(" (-inf to inf)")


def test_a_bound_that_is_the_answer_is_said_to_be_it():
    """Exact sets of a = 1 all give 1; p at the end of the search is not determined."""
    random = np.random.default_rng(4)
    for _ in range(8):
        strike = np.sort(random.uniform(105.0, 300.0, 8))
        found = fit(strike, curve(strike, 1.0, random.uniform(1.5, 6.0), 100.0))
        assert found.words().startswith("a = 1 (")
        assert found.a == pytest.approx(1.0, abs=1e-6)
    sharp = fit(STRIKE, 0.9 * STRIKE, limit=100.0)
    assert "p not determined (at the bound 50 of the search)" in sharp.words()


@pytest.mark.parametrize(
    "strike, residual, limit, told",
    [
        ([110.0, 120.0, 130.0], [50.0, 60.0, 70.0], None, "3 perforations do not determine its 3"),
        ([90.0, 110.0, 120.0], [0.0, 60.0, 70.0], 100.0, "2 perforations do not determine its 2"),
        ([], [], None, "0 perforations do not determine its 3"),
        (STRIKE, 0.8 * STRIKE, 120.0, "a shot perforates at 101 m/s, below the limit, 120 m/s"),
    ],
)
def test_shots_that_determine_no_curve_give_one_without_numbers(strike, residual, limit, told):
    found = fit(strike, residual, limit=limit)
    assert found.words().startswith(f"not determined, because {told}")
    assert np.isnan([found.a, found.p, found.limit, found.residual_rms]).all()


@pytest.mark.parametrize(
    "strike, residual, options, told",
    [
        ([110.0, 120.0], [50.0], {}, "same length"),
        ([110.0, np.nan, 1.0], [50.0, 60.0, 0.0], {}, "above 0"),
        ([110.0, 120.0, 130.0], [50.0, -60.0, 1.0], {}, "above 0"),
        (STRIKE, 0.8 * STRIKE, {"confidence": 95.0}, "confidence = 95.0"),
    ],
)
def test_what_cannot_be_fitted(strike, residual, options, told):
    with pytest.raises(InputError, match=told):
        fit(strike, residual, **options)


def test_the_limit_is_never_below_a_known_stop():
    """The fastest stop below the slowest perforation bounds the limit, and its interval."""
    strike = np.array([110.0, 115.0, 120.0, 130.0, 140.0, 150.0])
    residual = np.array([22.0, 40.0, 55.0, 75.0, 92.0, 104.0])
    alone = fit(strike, residual)
    stops = [104.0, 107.0, 109.0]
    assert alone.limit < max(stops)
    found = fit([*stops, *strike], [0.0, 0.0, 0.0, *residual])
    assert found.limit == max(stops)
    assert "limit = 109 (its lower bound, the fastest stop)" in found.words()
    assert found.points == strike.size
    # noise, so that the limit has an interval of its own, within what is known
    random = np.random.default_rng(2)
    for _ in range(20):
        noisy = curve(strike, 0.85, 2.2, 108.0) + random.normal(0, 3.0, strike.size)
        found = fit([60.0, 105.0, *strike], [0.0, 0.0, *np.maximum(noisy, 0.5)])
        low, high = found.intervals["limit"] or (found.limit, found.limit)
        assert 105.0 <= low <= found.limit <= high <= 110.0


def test_a_stop_that_is_faster_than_a_perforation_is_no_bound():
    strike = np.array([100.0, 112.0, 120.0, 130.0, 140.0])
    residual = np.array([30.0, 58.0, 71.0, 86.0, 99.0])
    found = fit([105.0, *strike], [0.0, *residual])
    assert found.fastest_stop == 0.0
    assert found.limit <= 100.0
