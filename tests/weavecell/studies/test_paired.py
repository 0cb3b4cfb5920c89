"""Difference of V50 from paired shots: closed forms, coverage of drawn pairs, numbers of shots."""

from math import log, sqrt

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from weavecell.studies import paired, v50

A, B = (140.0, 6.0), (132.0, 5.0)


def drawn_pair(random, correlation, shots):
    """Outcomes of shots at two panels that fail at normal velocities, placed as a V50 places them."""
    alike = random.standard_normal(shots)
    own = random.standard_normal((2, shots))
    pair = []
    for (middle, spread), z in zip((A, B), own):
        share = sqrt(correlation) * alike + sqrt(1 - correlation) * z
        pair.append(_fire(middle + spread * share, 1.06 * middle))
    return pair


def _fire(failing, limit):
    velocities, hit = [], []
    while len(velocities) < failing.size:
        count = min(v50.usual_batch(failing.size), failing.size - len(velocities))
        placed = limit * np.linspace(0.75, 1.25, count)
        if velocities:
            placed = v50.plan(velocities, hit, count, True)
        hit += [bool(v > failing[len(velocities) + k]) for k, v in enumerate(placed)]
        velocities += placed.tolist()
    return dict(enumerate(zip(velocities, hit)))


@pytest.mark.parametrize(
    ("x", "y", "r"), [(0.3, -0.8, 0.6), (-1.2, -0.4, -0.7), (0.0, 0.9, 0.5), (2.1, 1.4, 0.0)]
)
def test_two_normal_variables(x, y, r):
    slow = multivariate_normal.cdf([x, y], cov=[[1, r], [r, 1]])
    assert paired.bivariate_cdf(np.array([x]), np.array([y]), np.array([r])) == pytest.approx(slow)


def test_the_likelihood_is_that_of_pairs_of_single_shots_and_of_the_penalty():
    a = {0: (131.0, False), 1: (149.0, True), 2: (139.0, True), 5: (120.0, False)}
    b = {0: (128.0, True), 1: (137.0, False), 2: (133.0, True), 7: (150.0, True)}
    found = paired.PairedLikelihood(a, b)(7.0, 131.0, log(5.5), log(4.5), 0.4)
    slow = 0.0
    for number in range(3):
        z = [(a[number][0] - 138.0) / 5.5, (b[number][0] - 131.0) / 4.5]
        sign = [1 if of[number][1] else -1 for of in (a, b)]
        r = 0.4 * sign[0] * sign[1]
        slow += log(multivariate_normal.cdf(np.multiply(sign, z), cov=[[1, r], [r, 1]]))
    slow += norm.logcdf(-(120.0 - 138.0) / 5.5) + norm.logcdf((150.0 - 131.0) / 4.5)
    for shots, middle, s in ((a, 138.0, 5.5), (b, 131.0, 4.5)):
        information = np.zeros((2, 2))
        for velocity, _ in shots.values():
            z = (velocity - middle) / s
            w = 2 * np.pi * norm.pdf(z) ** 2 / (norm.cdf(z) * norm.cdf(-z))
            row = np.array([1.0, velocity])
            information += w * np.outer(row, row)
        slow += 0.5 * log(np.linalg.det(information))
    assert found == pytest.approx(slow, rel=1e-6)


@pytest.mark.slow(12)
def test_intervals_of_fifty_drawn_pairs_hold_the_difference():
    """Of the 95 % intervals of 50 pairs 44 or more hold the true difference: fewer have a chance of
    1 % if the intervals are right."""
    random = np.random.default_rng(8)
    held = decided = 0
    for number in range(50):
        found = paired.compare_shots(*drawn_pair(random, (0.0, 0.8)[number % 2], 24))
        assert not found.reason
        held += found.low <= A[0] - B[0] <= found.high
        decided += found.verdict == paired.BETTER
        assert found.verdict != paired.WORSE
    assert held >= 44
    assert decided >= 12


def test_what_draws_have_in_common_narrows_the_interval():
    a, b = drawn_pair(np.random.default_rng(3), 0.97, 40)
    alike = paired.compare_shots(a, b)
    apart = paired.compare_shots(a, {number + 100: shot for number, shot in b.items()})
    assert alike.high - alike.low < 0.85 * (apart.high - apart.low)
    assert alike.correlation > 0.3
    assert apart.value == pytest.approx(alike.value, abs=2.0)


def test_outcomes_that_do_not_mix_have_a_wide_interval():
    a = {k: (100.0 + 10 * k, k > 3) for k in range(8)}
    b = {k: (90.0 + 10 * k, k > 4) for k in range(8)}
    found = paired.compare_shots(a, b)
    assert np.isfinite([found.low, found.high]).all()
    assert found.verdict == paired.UNDECIDED
    assert found.high - found.low > 10


def test_shots_of_one_outcome_decide_nothing():
    found = paired.compare_shots(
        {0: (90.0, False), 1: (95.0, False)}, {0: (90.0, False), 1: (95.0, True)}
    )
    assert "V50 of A is not determined" in found.reason
    assert found.verdict == paired.UNDECIDED
    assert found.shots_to_decide() is None
    assert paired.forecast_widths(found) == []


@pytest.mark.parametrize(("value", "low", "high"), [(4.0, -2.0, 9.0), (-3.0, -10.0, 2.5)])
def test_the_number_of_shots_that_would_decide(value, low, high):
    found = paired.Difference(value, low, high, 0.3, 30)
    needed = found.shots_to_decide()
    towards_zero = low if value > 0 else high
    left = value + (towards_zero - value) * sqrt(30 / needed)
    before = value + (towards_zero - value) * sqrt(30 / (needed - 1))
    assert left * value >= 0 > before * value
    rows = paired.forecast_widths(found, (needed - 1, needed, 4 * needed))
    assert rows[0][2] == paired.UNDECIDED
    assert rows[2][1] == pytest.approx(0.5 * rows[1][1])
    assert found.width_after(30) == pytest.approx(0.5 * (high - low))


def test_alike_panels_have_no_number_of_shots():
    assert paired.Difference(0.01, -8.0, 8.0, 0.0, 40).shots_to_decide() is None
