"""Plies that stop a threat: made packs whose least count is known, and what tests say of the model."""

from dataclasses import replace
from math import exp, log

import numpy as np
import pytest

from validation.cases import series
from weavecell.report.chapters_discretisation import read_scored
from weavecell.runs import go_no_go, plies
from weavecell.runs.go_no_go import Outcomes
from weavecell.runs.plies import ModelError, Rows, V50Test

V, SURE, REFERENCE = 260.0, 0.85, 4
ERROR = ModelError(Rows(0.05, 0.12, 9), Rows(0.15, 0.08, 4), 0.03)


@pytest.fixture(scope="module")
def posterior():
    """Of 24 shots at packs of 2 to 7 plies, with one thing known of each."""
    random = np.random.default_rng(3)
    counts = random.integers(2, 8, 24)
    known = random.uniform(-0.5, 0.5, (24, 1))
    middle = 240.0 * (counts / REFERENCE) ** 0.4
    limits = middle * (1 + 0.12 * known[:, 0] + 0.05 * random.standard_normal(24))
    velocity = middle * random.uniform(0.85, 1.15, 24)
    times = counts / REFERENCE
    return go_no_go.fit(
        Outcomes(("friction on the nose",), known, velocity, velocity > limits, times), 250.0
    )


def test_the_least_count_of_made_packs_is_found():
    """Within one ply; the range holds it."""
    found = series.plies_coverage(plies=5, sure=0.9, scatter=0.05, growth=0.4, shots=[16], series=6)
    assert found["near"][0] == 100
    assert found["held"][0] >= 80


def test_the_posterior_of_other_counts_has_the_growth(posterior):
    assert np.median(posterior.growth) == pytest.approx(0.4, abs=0.15)
    for times in (0.5, 1.75):
        assert posterior.of(times).middles == pytest.approx(
            posterior.middles * times**posterior.growth
        )
    assert 200 < np.median(posterior.middles) < 280


def test_of_just_enough_plies_as_many_stop_as_asked(posterior):
    real = plies.real_counts(posterior, REFERENCE, V, SURE)
    for number in (0, 700, 1500):
        passed = posterior.of(real[number] / REFERENCE).passed([V])[number, 0]
        assert passed == pytest.approx(1 - SURE, abs=1e-3)


def test_the_count_is_the_least_whose_mean_is_sure(posterior):
    count = plies.count_plies(posterior, REFERENCE, V, SURE)
    stops = [
        1 - posterior.of((count.plies + less) / REFERENCE).passed([V]).mean() for less in (0, -1)
    ]
    assert stops[0] >= SURE > stops[1]
    assert count.low <= count.plies <= count.high
    surer = plies.count_plies(posterior, REFERENCE, V, 0.97)
    assert surer.plies > count.plies
    beyond = plies.count_plies(posterior, REFERENCE, 60 * V, SURE)
    assert beyond.words().startswith(">100 (")


def test_what_tests_say_widens_and_moves_the_count(posterior):
    count = plies.count_plies(posterior, REFERENCE, V, SURE)
    told = plies.as_tests_say(posterior, REFERENCE, ERROR)
    told_count = plies.count_plies(told, REFERENCE, V, SURE)
    # the model is too fast: more are needed
    assert np.median(told.middle) == pytest.approx(
        np.median(posterior.middle) * exp(-0.05), rel=0.02
    )
    assert told_count.plies > count.plies
    assert told_count.high - told_count.low > count.high - count.low


def test_an_own_test_at_the_count_narrows_it_and_far_away_it_does_less(posterior):
    told = plies.as_tests_say(posterior, REFERENCE, ERROR)
    wide = plies.count_plies(told, REFERENCE, V, SURE)
    count = wide.plies
    v50 = float(np.median(told.of(count / REFERENCE).middles))
    far = float(np.median(told.of(1 / REFERENCE).middles))
    found = {}
    for name, test in {"near": V50Test(count, v50), "far": V50Test(1, far)}.items():
        of_test = plies.as_tests_say(posterior, REFERENCE, ERROR, [test])
        found[name] = plies.count_plies(of_test, REFERENCE, V, SURE)
        middles = of_test.of(test.plies / REFERENCE).middles
        assert np.median(middles) == pytest.approx(test.velocity, rel=0.02)
        assert np.std(np.log(middles)) == pytest.approx(ERROR.of_test, rel=0.35)
    width = {name: one.high - one.low for name, one in found.items()}
    assert width["near"] < wide.high - wide.low
    assert width["near"] < width["far"]


def test_a_lower_test_asks_for_more_plies(posterior):
    counts = [
        plies.count_plies(
            plies.as_tests_say(posterior, REFERENCE, ERROR, [V50Test(5, velocity)]),
            REFERENCE,
            V,
            SURE,
        ).plies
        for velocity in (230.0, 290.0)
    ]
    assert counts[0] > counts[1]


def test_where_growth_is_computed_too_large_a_test_lowers_it(posterior):
    """By what the scored rows say: limits grow by less with the plies, away from the count of the test."""
    test = V50Test(5, float(np.median(posterior.of(5 / REFERENCE).middles)))
    lowered = plies.as_tests_say(posterior, REFERENCE, ERROR, [test])
    less = np.median(posterior.growth) - np.median(lowered.growth)
    assert less == pytest.approx(ERROR.growth.mean, abs=0.06)
    beyond = [np.median(one.of(12 / REFERENCE).middles) for one in (posterior, lowered)]
    assert beyond[1] < 0.95 * beyond[0]


def test_the_error_is_that_of_the_scored_rows():
    """By hand, of rows with numbers of their own."""
    names = "V50 of one ply", "V50 of packs", "growth of V50 from 2 to 8 plies", "thickness"
    numbers = (
        ("1.2", "1", "", "0.05"),
        ("0.9", "4", "0.03", "0.04"),
        ("1.4", "3", "0.02", "0.06"),
        ("0.8", "5", "0.1", "0.1"),
    )
    columns = ("bias", "n", "sigma_model", "sigma_test")
    rows = [dict(zip(columns, of), quantity=name) for name, of in zip(names, numbers)]
    found = plies.find_error(rows)
    mean = (log(1.2) + 4 * log(0.9) + 3 * log(1.4)) / 8
    within = 3 * (0.03**2 + 0.04**2) + 2 * (0.02**2 + 0.06**2)
    between = sum(n * (log(b) - mean) ** 2 for n, b in ((1, 1.2), (4, 0.9), (3, 1.4)))
    assert found.factor.mean == pytest.approx(mean)
    assert found.factor.deviation == pytest.approx(((within + between) / 7) ** 0.5)
    assert found.factor.size == 8
    assert found.growth.mean == pytest.approx(log(1.4) / log(4))
    assert found.growth.deviation == pytest.approx((0.02**2 + 0.06**2) ** 0.5 / log(4))
    assert found.of_test == 0.04


def test_the_file_of_the_package_has_these_rows():
    found = plies.find_error(read_scored())
    assert found.factor.size >= 6
    assert found.growth.size >= 2
    assert 0.02 < found.factor.deviation < 0.4
    assert 0 < found.of_test < 0.1


def test_fabrics_whose_order_is_not_decided_are_one_group():
    random = np.random.default_rng(2)
    masses = {"heavy": 2.1, "light": 1.0, "as light": 1.04}
    drawn = {
        name: mass * np.exp(0.08 * random.standard_normal(500)) for name, mass in masses.items()
    }
    assert plies.group(drawn) == [["light", "as light"], ["heavy"]]
    assert plies.group({}) == []


def test_shots_walk_in_plies_until_outcomes_differ(posterior):
    alike = {"velocity": V, "sure": SURE, "mixed": False, "seed": 1}
    assert plies.choose_count(posterior, REFERENCE, [], **alike) == REFERENCE
    thin = replace(posterior, middle=0.2 * posterior.middle)
    assert plies.choose_count(thin, REFERENCE, [4, 4], **alike) == 8
    thick = replace(posterior, middle=9 * posterior.middle)
    assert plies.choose_count(thick, REFERENCE, [8, 8], **alike) == 4
    chosen = {
        plies.choose_count(posterior, REFERENCE, [4] * shots, **alike | {"mixed": True})
        for shots in range(2, 22, 2)
    }
    count = plies.count_plies(posterior, REFERENCE, V, SURE)
    assert min(chosen) >= count.low - 1
    assert max(chosen) <= 8
