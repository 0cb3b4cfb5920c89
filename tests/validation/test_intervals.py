"""The cases of studies of answers over what nobody knows: what they read off, and what they draw."""

from math import nan

import pytest
from weavecell.studies.interval import SHOT, Interval, Run

from shellfabric.membrane import quality
from validation.cases import intervals
from weavecell.studies import sweep
from weavecell.studies.places import CROSSOVER, GAP, Places

RIM = quality.indicator("slip at the rim", 0.31)
CUT = quality.indicator("cut outside the zone", 0.9)


def test_the_checks_of_a_row_are_read_by_name():
    """Each with a number, a limit and a remedy, in whose text there are semicolons too."""
    assert RIM.doubtful
    assert CUT.doubtful
    row = {"checks": sweep._with_reasons((RIM, CUT))}
    assert intervals.find_doubts(row) == ["slip at the rim", "cut outside the zone"]
    assert intervals.find_doubts({"checks": "ok"}) == []
    assert intervals.find_doubts({}) == []


def run_of(place, outcome, left, *checks, **more):
    row = {"outcome": outcome, "residual_velocity_m_s": left, "checks": sweep._with_reasons(checks)}
    return Run(place, {}, row | {"strike_velocity_m_s": 100.0} | more)


def test_an_answer_counts_doubtful_runs_those_that_stopped_and_those_run_again():
    runs = (
        run_of(CROSSOVER, "stopped", 0.4, RIM),
        run_of(GAP, "stopped", 0.0, CUT, widened="a zone of 20 mm was too small"),
        run_of(GAP, "perforated", 31.5, RIM, CUT),
        run_of(CROSSOVER, "stopped", 0.0),
    )
    found = intervals.describe(Interval(SHOT, Places((CROSSOVER, GAP)), {}, runs))
    assert (found["runs"], found["doubtful"], found["widened"]) == (4, 3, 1)
    assert (found["stopped"], found["stopped_doubtful"]) == (3, 2)
    assert found["doubts"] == "slip at the rim (2), cut outside the zone (2)"
    assert (found["low"], found["high"]) == (0.0, 31.5)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_stop_is_drawn_within_the_repeat_and_the_ranges_and_differs_by_its_number(monkeypatch):
    fired = []

    def shot(setup):
        fired.append(setup)
        return {"outcome": "stopped", "residual_velocity_m_s": nan, "energy_error_max": 0.0}

    monkeypatch.setattr(sweep, "shot", shot)
    scene = {"fabric": "S-726", "opening": "60 mm", "projectile": "FSP 1.10 g"}
    found = [
        intervals.stop(number=number, velocities=(75.0, 110.0), seed=92, **scene)
        for number in range(4)
    ]
    for key, low, high in (
        ("velocity", 75.0, 110.0),
        ("u", -1.0, 1.0),
        ("v", -1.0, 1.0),
        ("yarns", 0.1, 0.3),
        ("nose", 0.0, 0.2),
    ):
        values = [one[key] for one in found]
        assert low <= min(values) < max(values) <= high
        # points of the sequence: one in each quarter
        assert {int(4 * (value - low) / (high - low)) for value in values} == {0, 1, 2, 3}
    w = fired[0].fabric.weave.w
    assert w[0] != w[1]
    struck = [setup.impact_point for setup in fired]
    assert struck == [(2 * one["u"] * w[0], 2 * one["v"] * w[1]) for one in found]
    assert [setup.strike_velocity for setup in fired] == [one["velocity"] for one in found]
    assert {setup.symmetry for setup in fired} == {"whole"}
