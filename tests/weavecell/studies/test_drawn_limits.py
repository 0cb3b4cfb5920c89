"""Limits over all that is drawn: a plane with a normal rest against drawn outcomes, the placing of shots, the share
that passes at one velocity, and the nominal values."""

import numpy as np
import pytest
from scipy.stats import beta

import weavecell as wc
from weavecell.results.finding import Answer, Mover
from weavecell.runs import passing, table
from weavecell.studies import strengths, unknown
from weavecell.studies.places import ON_WARP, resolve, strike_at


def test_the_share_that_passes_has_the_interval_of_jeffreys():
    def shot(number, through):
        left = 30.0 * number if through else 0.0
        return table.Shot(90.0, left, through, number, deflection=0.01)

    found = passing.Passing(90.0, tuple(shot(number, number > 2) for number in range(8)), {})
    assert found.share == pytest.approx((0.625, *beta(5.5, 3.5).ppf([0.05, 0.95])))
    assert found.quantiles("residual")[1] == pytest.approx(105.0)


def test_nominal_values_are_the_middle_of_what_is_drawn():
    setup = resolve(wc.setup("S-728", "90 m/s", opening="50 mm", projectile="sphere 5.5 mm"))
    nominal = unknown.choose_nominal(setup, False)
    ranges = unknown.find_unknown(setup)
    assert nominal.crossovers.friction == np.mean(next(iter(ranges.values())))
    assert unknown.find_unknown(nominal) == ranges
    known = np.array([[*strengths.draw_known(setup, 1, number).values()] for number in range(256)])
    assert known.mean(axis=0) == pytest.approx(0.0, abs=0.02)
    assert nominal.impact_point == strike_at(setup, ON_WARP).impact_point
    assert unknown.choose_nominal(setup, True).impact_point == setup.impact_point


def test_what_moves_an_answer_most_is_named_first():
    """With its number where it is sure."""
    unlike = (
        Mover("mesh", "--uncertainty"),
        Mover("place", "", 3.0, sure=False),
        Mover("roll", "give it", 8.0),
    )
    found = Answer("what", "90 m/s", movers=unlike)
    assert [one.what for one in found.ranked] == ["roll", "place", "mesh"]
    rows = dict(found.rows)
    assert (rows["moved by"], rows["leaves out"]) == ("roll 8 m/s, place", "mesh")
    assert rows["next"] == "give it; uncertainty=True"
