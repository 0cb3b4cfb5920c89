"""The cases of studies of noses that strike anywhere: what they read off, and what they draw."""

from math import nan
from types import SimpleNamespace

import numpy as np
import pytest

from shellfabric.membrane import quality
from validation.cases import places
from weavecell.runs import sweep
from weavecell.runs.span import Span
from weavecell.runs.table import Shot
from weavecell.studies import shot_row

SIDES = quality.indicator("yarns that changed sides", 3.0)
HOURGLASS = quality.indicator("projectile hourglass", 0.9)


def test_the_checks_of_a_row_are_read_by_name():
    """Each with a number, a limit and a remedy, in whose text there are semicolons too."""
    assert SIDES.doubtful
    assert HOURGLASS.doubtful
    row = {"checks": shot_row.with_reasons((SIDES, HOURGLASS))}
    assert places.find_doubts(row) == ["yarns that changed sides", "projectile hourglass"]
    assert places.find_doubts({"checks": "ok"}) == []
    assert places.find_doubts({}) == []


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_stop_is_drawn_within_the_repeat_and_the_ranges_and_differs_by_its_number(monkeypatch):
    fired = []

    def shot(setup):
        fired.append(setup)
        return {"outcome": "stopped", "residual_velocity_m_s": nan, "energy_error_max": 0.0}

    monkeypatch.setattr(sweep, "shot", shot)
    scene = {"fabric": "S-726", "opening": "60 mm", "projectile": "FSP 1.10 g"}
    found = [
        places.stop(number=number, velocities=(75.0, 110.0), seed=92, **scene)
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


def test_what_a_shot_takes_is_all_but_the_energy_that_is_left(monkeypatch):
    """One perforates, one stops, and one throws the projectile back, whose energy it has not kept."""
    fired = [
        Shot(200.0, 120.0, True, cpu_time=9.0),
        Shot(200.0, 0.0, False, cpu_time=1.0),
        Shot(200.0, -20.0, False, cpu_time=2.0, failure="lost"),
    ]
    monkeypatch.setattr(places.table, "run", lambda rows, folder: fired[: len(rows)])
    found = places.take(
        fabric="S-728", projectile="FSP 1.10 g", opening="60 mm", velocity=200.0, shots=3
    )
    np.testing.assert_allclose(
        found["taken"], 0.5 * 1.1e-3 * np.array([25600.0, 4e4, 40400.0]), rtol=1e-3
    )
    assert found["cpu_s"] == pytest.approx(2.0)
    assert found["failures"] == 1


def test_methods_share_their_draws_and_differ_in_the_yarns(monkeypatch):
    seen = []
    monkeypatch.setattr(
        places.table, "run", lambda rows, folder: seen.extend(rows) or [Shot(90.0, 30.0, True)]
    )
    scene = {
        "fabric": "S-728",
        "projectile": "sphere 5.5 mm",
        "opening": "160 mm",
        "velocity": 90.0,
    }
    for keys in ({}, {"whole_zone": True}, {"crossovers": "pinned"}):
        places.take(shots=1, **scene, **keys)
    default, whole, pinned = (row.setup for row in seen)
    assert {row.draw for row in seen} == {seen[0].draw}
    assert default.zone.width < whole.zone.width == np.inf
    assert pinned.crossovers is None


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_load_is_that_of_yarns_just_before_the_first_fails_and_shots_are_drawn_alike(monkeypatch):
    """The tension of one yarn is near its strength, of none beyond; a nose whose shots all end alike has no V50."""
    studied = []

    def study(setup, scatter, *, shots, seed, folder):
        studied.append((shots, seed))
        span = Span(40.0, 35.0, 46.0)
        told = [Shot(30.0, 0.0, False), Shot(50.0, 20.0, True), Shot(45.0, 9.0, True)]
        posterior = SimpleNamespace(velocities={"V50": span}) if seed == 3 else None
        return SimpleNamespace(shots=told, posterior=posterior, failures=("lost",), doubtful=2)

    monkeypatch.setattr(places.v50, "study", study)
    scene = {
        "fabric": "S-728",
        "opening": "30 mm",
        "projectile": {"mass": "7 g", "diameter": "9 mm", "edge_radius": "0.4 mm"},
    }
    found = places.load(velocity=60.0, shots=3, seed=3, **scene)
    warp, weft = found["tensions"]
    assert 0.8 < max(warp.max(), weft.max()) <= 1.02
    assert found["loaded"] == np.sum(warp > 0.5) + np.sum(weft > 0.5) > 2
    assert 0 < found["taken"] < 0.5 * 7e-3 * 60.0**2
    assert found["error"] == pytest.approx(5.5 / 1.6449, rel=1e-3)
    assert [found[key] for key in ("least", "perforated", "fired", "failures")] == [45.0, 2, 3, 1]
    alike = places.load(velocity=60.0, shots=3, seed=4, share=0.9, **scene)
    assert np.isnan(alike["v50"])
    assert 0 < alike["loaded"] < found["loaded"]
    assert studied == [(3, 3), (3, 4)]
