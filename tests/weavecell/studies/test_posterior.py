"""Shots have an interval by a posterior whose prior is said, and a forecast of how many more bound V50 without it."""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad, trapezoid
from scipy.stats import norm

from validation.cases import series
from weavecell.studies import posterior, probit

FOOT = 0.3048
# the six shots of the example of MIL-STD-662F
MIL_STD = FOOT * np.array([430.0, 445.0, 452.0, 455.0, 470.0, 480.0])
MIL_STD_CP = np.array([False, False, True, False, True, True])


@pytest.fixture(scope="module")
def six():
    return probit.fit(MIL_STD, MIL_STD_CP)


def test_the_six_shots_of_the_standard_are_bounded_and_say_by_what(six):
    """The likelihood alone would say 129 to 148 m/s, too narrow; the penalised one sets no bounds."""
    assert six.intervals["V50"] == pytest.approx((118.39, 159.05), abs=0.02)
    assert six.by_prior
    assert six.more_shots == 6
    assert six.words() == (
        "V50 (probit) 138.5 m/s, 118.4 to 159.0 m/s with 95 % confidence, by a prior: panels fail within 5 % of V50 "
        "(standard deviation), log-normal, factor 2.5; about 6 more shots would bound it without a prior"
    )
    assert all(0 < low < high < np.inf for low, high in six.intervals.values())


def test_the_ends_are_those_of_the_integral_by_quadrature(six):
    """p(V50 < low) of the same posterior, by another rule over s and exact sums of V50."""

    def mass(until):
        def over_s(x):
            s = 0.05 * six.V50 * 2.5**x
            V = np.linspace(max(MIL_STD[0] - 9 * s, 0.0), min(MIL_STD[-1] + 9 * s, until), 2001)
            if V[-1] <= V[0]:
                return 0.0
            share = norm.cdf((MIL_STD[:, None] - V) / s)
            likelihood = np.where(MIL_STD_CP[:, None], share, 1 - share).prod(axis=0)
            return norm.pdf(x) * trapezoid(likelihood, V)

        return quad(over_s, -4, 4, limit=100, epsabs=0, epsrel=1e-6)[0]

    whole = mass(np.inf)
    low, high = six.intervals["V50"]
    assert_allclose([mass(low) / whole, mass(high) / whole], [0.025, 0.975], atol=5e-4)


def many():
    """80 shots, whose posterior is a small part of what is summed over at first."""
    V = 100 + 12 * np.sin(np.arange(80.0))
    return V, V > 100 + 4 * np.cos(1.7 * np.arange(80.0))


@pytest.mark.parametrize(
    "V, hit",
    [([100.0, 100.01, 102.0, 99.0], [False, True, True, False]), many()],
    ids=["4 shots", "80 shots"],
)
def test_finer_sums_move_no_end_by_a_thirtieth_of_the_width(V, hit, monkeypatch):
    V, hit = np.array(V), np.array(hit)

    def ends():
        found = probit.posterior_of(V, hit, 100.0)
        return np.array([*found.interval(0.0, 0.95), *found.interval(-2.3, 0.95)])

    usual = ends()
    monkeypatch.setattr(posterior, "_SPREADS", 81)
    monkeypatch.setattr(posterior, "_PLACES", 481)
    assert_allclose(usual, ends(), atol=0.03 * (usual[1] - usual[0]))


def test_the_interval_is_of_the_posterior_whether_or_not_the_shots_bound_v50_alone():
    """One that is chosen by the outcomes holds too few (validation study v50-coverage)."""
    V = np.arange(90.0, 120.0, 2.5)
    hit = (V > 101) ^ (V == 100.0)
    few = probit.fit(V[1:-1], hit[1:-1])
    assert few.by_prior
    assert few.more_shots == 2
    enough = probit.fit(V, hit)
    assert enough.more_shots == 0
    assert not enough.by_prior
    assert "the shots would bound it without a prior too" in enough.words()
    for shots, curve in ((slice(1, -1), few), (slice(None), enough)):
        of_posterior = probit.posterior_of(V[shots], hit[shots], curve.V50).interval(0.0, 0.95)
        assert_allclose(curve.intervals["V50"], of_posterior)
        edges = probit.band(V[shots], hit[shots], curve, (0.5, 0.9))
        assert_allclose(edges[0], of_posterior)
        assert (edges[1] > edges[0]).all()


def test_as_many_more_shots_as_are_forecast_bound_v50():
    """Twelve shots of which one stop is fast: the shots again, as often as is forecast, have bounds."""
    V = 100 + 4.0 * np.arange(12)
    hit = np.isin(np.arange(12), (3, 4, 8, 9, 11))
    curve = probit.fit(V, hit)
    assert curve.by_prior
    rounds = 1 + curve.more_shots / V.size
    for times in (int(np.floor(rounds)), int(np.ceil(rounds))):
        bounded = probit.bounds_V50(np.tile(V, times), np.tile(hit, times), curve.V50)
        assert bounded == (times >= rounds)


def test_intervals_of_drawn_series_hold_v50_and_the_study_decides_as_the_fit():
    """Of 24 series of 6, 8 and 12 shots at least 20 hold it: fewer have a chance of 1 % at 95 %."""
    random = np.random.default_rng(7)
    held = 0
    for count, share, number in product((6, 8, 12), (0.012, 0.03), range(4)):
        failing = series.V50 * (1 + share * random.standard_normal(count))
        velocity, hit = list(series.PROTOCOLS.values())[number % 2](failing, random)
        inside, _, width = series._inside(velocity, hit)
        curve = probit.fit(velocity, hit)
        low, high = curve.intervals["V50"]
        held += inside
        if not curve.reason:
            assert inside == (low <= series.V50 <= high)
            assert width == pytest.approx(high - low)
    assert held >= 20
