"""A default zone of resolved yarns that proves too small is followed by a run with all yarns resolved."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.impact.attempts import Attempt, RimWatch, Superseded
from shellfabric.impact.run import run_impact
from shellfabric.loop.checkpoint import Checkpoints
from shellfabric.membrane import quality
from weavecell.report import installed
from weavecell.studies import ballistic_limit

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")
# unlike warp and weft, on a crossover: a quarter
QUARTER = {"crossovers": "yarns", "impact_point": ["0 mm", "0 mm"], "symmetry": "quarter"}
FLAT = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "friction": 0}
UNZIPS = QUARTER | {"opening": "50 mm", "projectile": FLAT}
SPHERE = {"shape": "sphere", "mass": "0.69 g", "diameter": "5.5 mm"}
SLIPS = QUARTER | {"opening": "70 mm", "crossover_friction": 0.15, "projectile": SPHERE}


def test_a_shot_whose_pinned_yarns_unzip_is_run_again_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    found = wc.impact("S-726", "80 m/s", **UNZIPS, out=tmp_path / "r")
    assert found.outcome == "perforated"
    assert found.doubts == ()
    assert "a zone of 20 mm was too small (" in found.answer.over
    assert "of the cut yarns were outside it" in found.answer.over
    assert "run again with all yarns resolved, 756 crossings in place of 552" in found.answer.over
    assert "Yarns are resolved in the whole panel" in found.summary()["assumptions"]
    # it is the run that a zone of the whole panel asks for
    setup = found.target.setup
    assert setup.crossovers.half_width == inf
    again = run_impact(setup)
    assert again.widened == ""
    np.testing.assert_array_equal(again.velocity, found.velocity)
    # and is read again as it was run
    loaded = wc.load(tmp_path / "r")
    assert loaded.widened == found.widened
    assert loaded.answer == found.answer
    assert loaded.target.setup.crossovers.half_width == inf


def test_a_shot_of_a_search_that_draws_in_yarn_through_the_rim_is_fired_again():
    """No yarn is cut: what would have come in through the rim alone stops the nose."""
    setup = wc.setup("S-720", "105 m/s", **SLIPS)
    (shot,) = ballistic_limit.shoot(setup.target(), (105.0,))
    assert (shot.outcome, shot.cut_yarns, shot.status) == ("stopped", 0.0, "ok")
    assert "a yarn slipped by 0." in shot.widened
    limit = ballistic_limit.Limit(120.0, 130.0, (shot, replace(shot, widened="")))
    assert limit.widened.startswith("1 of 2 shots fired again with all yarns resolved")
    # the cost of the second run is told before the first
    note = "if a zone of 20 mm proves too small, another "
    assert any(line.startswith(note) for line in wc.impact(setup, check=True).lines())


def fire(setup, **others):
    """The result of a set-up, and how long each of its runs went on [s]."""
    times = {}

    def hook(solver):
        times[id(solver.pack)] = solver.time

    found = run_impact(setup, hooks=[hook], **others)
    return found, list(times.values())


def test_a_run_whose_yarn_has_slipped_through_the_rim_ends_when_the_nose_is_slow(monkeypatch):
    """What counts is the run with all yarns, to the bit, whether the one before it goes on to its end or not."""
    setup = wc.setup("S-720", "105 m/s", **SLIPS)
    found, (cut_short, counted) = fire(setup)
    assert 0.0 < cut_short < 0.75 * counted
    assert "(a yarn slipped by 0." in found.widened
    monkeypatch.setattr("shellfabric.impact.attempts.SLOWED", -1.0)
    whole, (to_its_end, same) = fire(setup)
    assert to_its_end > 0.9 * counted
    assert same == counted
    np.testing.assert_array_equal(found.step_history, whole.step_history)
    np.testing.assert_array_equal(found.peaks, whole.peaks)
    assert all(
        np.array_equal(found.energies[name], whole.energies[name]) for name in found.energies
    )


@pytest.mark.parametrize(
    ("velocity", "cut", "slip", "ends"),
    [
        (40.0, 0.0, 0.2, True),
        (70.0, 0.0, 0.2, False),
        (40.0, 1.0, 0.2, False),
        (40.0, 0.0, 0.1, False),
    ],
)
def test_the_watch_of_a_rim_ends_a_slow_whole_slipping_run_alone(velocity, cut, slip, ends):
    """A torn run goes on: slack yarns slip, and whether the zone was too small is told by what is cut outside."""
    last = {"v": [105.0, velocity], "cut_yarns": [0.0, cut]}
    solver = SimpleNamespace(ended=False, sample=last.get, strike_velocity=105.0, slip_at_rim=slip)
    watch = RimWatch(Attempt(wc.setup("S-720", "105 m/s", **SLIPS).target()))
    if ends:
        with pytest.raises(Superseded):
            watch(solver)
    else:
        watch(solver)


def test_a_run_that_none_can_follow_goes_on_with_its_doubt():
    """Its zone was given."""
    setup = wc.setup("S-720", "105 m/s", **SLIPS)
    given = replace(setup, crossovers=replace(setup.crossovers, half_width=20e-3))
    found, (time,) = fire(given)
    assert found.outcome == "stopped"
    assert time == pytest.approx(found.time[-1])
    assert any(check.name == "slip at the rim" and check.doubtful for check in found.checks)


def ended(step_loss=0.0, **checks):
    """What a run says when it has ended: its loss to the step, and checks of its zone."""
    values = {name.replace("_", " "): value for name, value in checks.items()}
    found = [quality.indicator(name, value) for name, value in values.items()]
    return SimpleNamespace(step_loss=step_loss, part_indicators=found)


def test_what_follows_a_run_is_a_shorter_step_or_all_yarns_once():
    setup = wc.setup("S-726", "80 m/s", **UNZIPS)
    first = Attempt(setup.target())
    assert first.follow(ended(slip_at_the_rim=0.14, cut_outside_the_zone=0.19)) is None
    shorter = first.follow(ended(0.005, cut_outside_the_zone=0.3))
    assert (shorter.step_factor, shorter.widened) == (0.7, "")
    assert first.follow(ended(0.009)).step_factor == 0.5
    assert first.follow(ended(0.03)).step_factor == 0.5
    both = shorter.follow(ended(0.005, cut_outside_the_zone=0.3))
    assert both.step_factor == 0.7
    assert "30% of the cut yarns" in both.widened
    assert both.target.plies[0].numerics.cfl == shorter.target.plies[0].numerics.cfl
    assert both.follow(ended(0.005)) is None
    wider = first.follow(ended(slip_at_the_rim=0.2))
    assert wider.target.plies[0].patch.rim_rows == 0
    # a zone that was given stays, and so do pinned yarns
    for crossovers in (replace(setup.crossovers, half_width=20e-3), None):
        given = Attempt(replace(setup, crossovers=crossovers).target())
        assert given.follow(ended(slip_at_the_rim=0.9)) is None


def test_the_series_of_runs_are_all_that_may_follow():
    """However each run ends: with a loss to its step, slip at its rim, both or neither."""
    setup = wc.setup("S-726", "80 m/s", **UNZIPS)
    ends = [
        ended(loss, slip_at_the_rim=slip) for loss in (0.001, 0.005, 0.009) for slip in (0.1, 0.2)
    ]

    def follow_all(runs):
        found = set()
        for end in ends:
            following = runs[-1].follow(end)
            found |= (
                {tuple(map(name, runs))} if following is None else follow_all([*runs, following])
            )
        return found

    def name(run):
        return run.step_factor, bool(run.widened)

    given = replace(setup, crossovers=replace(setup.crossovers, half_width=20e-3))
    for one, longest in ((setup, 3), (given, 2)):
        first = Attempt(one.target())
        listed = [tuple(map(name, runs)) for runs in first.list_series()]
        assert len(set(listed)) == len(listed)
        assert {*listed} == follow_all([first])
        assert max(map(len, listed)) == longest


def test_memory_that_does_not_hold_all_yarns_leaves_the_doubt(monkeypatch):
    first = Attempt(wc.setup("S-726", "80 m/s", **UNZIPS).target())

    def refuse(plies):
        raise InputError(key="memory", allowed="less")

    monkeypatch.setattr("shellfabric.loop.pack_memory.check", refuse)
    assert first.follow(ended(slip_at_the_rim=0.9)) is None


def test_a_checkpoint_of_the_second_run_is_gone_on_from(tmp_path):
    setup = wc.setup("S-726", "80 m/s", **UNZIPS, end_time="16 us")
    wider = replace(setup, crossovers=setup.crossovers.whole)
    path = tmp_path / "run.h5"
    whole = run_impact(wider, hooks=[Checkpoints(path, 10e-6)])
    # a run with the default zone that was made again had the same checkpoint
    gone_on = run_impact(setup, resume=path)
    assert "all yarns resolved" in gone_on.widened
    np.testing.assert_array_equal(gone_on.velocity, whole.velocity)


def test_a_panel_that_its_zone_covers_is_run_again_without_a_rim():
    """No crossing is resolved more than before, so none is said to be."""
    found = {}
    for opening in ("24 mm", "50 mm"):
        setup = wc.setup("S-726", "80 m/s", **QUARTER | {"opening": opening})
        found[opening] = Attempt(setup.target()).widen("a yarn slipped").widened
    assert found["24 mm"].endswith("(a yarn slipped): run again without a rim")
    assert "crossings in place of" not in found["24 mm"]
    assert found["50 mm"].endswith("756 crossings in place of 552")
