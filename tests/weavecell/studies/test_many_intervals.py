"""Answers over what nobody knows, many at once: sweeps, and the difference of two panels."""

import json
from types import SimpleNamespace

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from weavecell.studies import interval, sweep
from weavecell.studies.interval import Interval, Run, Variation
from weavecell.studies.places import CROSSOVER, GAP, Places

YARNS, NOSE, PLIES = interval.FRICTIONS
TWO = {YARNS: (0.1, 0.3), NOSE: (0.0, 0.2)}
SCENE = """
[fabric]
name = "S-728"
[projectile]
shape = "sphere"
mass = "0.69 g"
diameter = "5.5 mm"
strike_velocity = "120 m/s"
[panel]
opening = "24 mm"
crossovers = "yarns"
zone = "8 mm"
[run]
end_time = "18 us"
"""
STRIKE = "projectile.strike_velocity"


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


def answer(quantity, *rows):
    """An Interval over TWO: (place, friction between yarns, on the nose, entries of its row)."""
    setup = SimpleNamespace(strike_velocity=150.0)
    runs = []
    for place, yarns, nose, row in rows:
        runs.append(Run(Variation(place, {YARNS: yarns, NOSE: nose}, setup), row))
    return Interval(quantity, Places((CROSSOVER, GAP)), TWO, tuple(runs))


def shot(left, **row):
    outcome = "perforated" if left else "stopped"
    return {"outcome": outcome, "residual_velocity_m_s": left, "checks": "ok"} | row


def limit(low, high, **row):
    return {"outcome": "single limit", "lower_m_s": low, "upper_m_s": high, "checks": "ok"} | row


def test_a_row_of_a_sweep_has_both_ends_of_an_interval_and_what_decides():
    again = shot(61.0, checks="doubtful: slip", widened="cut yarns outside")
    found = answer(
        "shot",
        (CROSSOVER, 0.1, 0.0, shot(0.0)),
        (GAP, 0.1, 0.0, again),
        (CROSSOVER, 0.3, 0.2, shot(0.0)),
        (GAP, 0.3, 0.0, shot(22.0)),
        (GAP, 0.1, 0.2, shot(49.0)),
    )
    assert sweep.row_of_interval(found) == {
        "outcome": "depends",
        "residual_velocity_low_m_s": 0.0,
        "residual_velocity_high_m_s": 61.0,
        "decides": "the place, friction between yarns",
        "runs": 5,
        "checks": "doubtful: 1 of 5 runs",
        "widened": "1 of 5 runs: cut yarns outside",
    }
    first = (CROSSOVER, 0.1, 0.0, limit(101.0, 103.0))
    alike = answer("critical-velocity", first, (GAP, 0.1, 0.0, limit(104.0, 105.0)))
    row = sweep.row_of_interval(alike)
    ends = row["critical_velocity_low_m_s"], row["critical_velocity_high_m_s"]
    assert (row["outcome"], row["decides"], *ends) == (
        "alike wherever it strikes",
        "",
        102.0,
        104.5,
    )
    differ = answer("critical-velocity", first, (GAP, 0.1, 0.0, limit(70.0, 74.0)))
    row = sweep.row_of_interval(differ)
    assert (row["outcome"], row["decides"]) == ("depends", "the place")
    lost = answer("critical-velocity", (CROSSOVER, 0.1, 0.0, {"outcome": "undecided: slow"}))
    row = sweep.row_of_interval(lost)
    assert (row["outcome"], row["critical_velocity_low_m_s"]) == ("undecided: slow", None)


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::weavecell.DoubtfulResult")
def test_a_sweep_of_intervals_is_forecast_written_told_and_resumed(
    scene, tmp_path, monkeypatch, drawn_once
):
    over = {STRIKE: ["70 m/s", "120 m/s"]}
    size = wc.sweep(scene, over=over, interval=True, check=True)
    assert (size.shots, size.more.shots) == (6, 4)
    assert "if these do not agree, about 4 shots more; " in str(size)
    found = wc.sweep(scene, over=over, interval=True, out=tmp_path / "r")
    runs = json.loads((tmp_path / "r/sweep.json").read_text())["runs"]
    table = found.to_dataframe()
    for (_, row), of_row in zip(table.iterrows(), runs):
        left = [run["residual_velocity_m_s"] for run in of_row]
        ends = row["residual_velocity_low_m_s"], row["residual_velocity_high_m_s"]
        assert ends == pytest.approx((min(left), max(left)))
        assert row["runs"] == len(of_row)
        assert [run["place"] for run in of_row[:3]] == [CROSSOVER.name, GAP.name, CROSSOVER.name]
    assert table["residual_velocity_low_m_s"].nunique() == 2
    assert "in flight wherever it strikes" in found.lines()[1]
    assert "over strike velocity and what nobody knows" in found.headline[1]
    # a run alone is the shot that its entry says
    second = found.intervals[1].runs[2]
    alone = wc.impact(second.variation.setup)
    assert alone.residual_velocity == pytest.approx(runs[1][2]["residual_velocity_m_s"], rel=1e-9)
    # frictions are varied, and are not said to be left out
    (data,) = [part.text for part in found.left_out if part.kind == "assumed data"]
    assert "friction" not in data.replace("frictions are varied", "")
    again = wc.load(tmp_path / "r").to_dataframe()
    assert list(again) == list(table)
    monkeypatch.setattr("weavecell.studies.sweep.shot", None)
    again = wc.sweep(scene, over=over, interval=True, out=tmp_path / "r", resume=True)
    assert again.lines() == found.lines()


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_rows_that_do_not_agree_are_followed_up(scene, monkeypatch):
    """The gap lets through at the second velocity; friction raised there alone tells what decides."""
    fired = []

    def row(setup, quantity, tolerance):
        fired.append(setup)
        slow = setup.strike_velocity < 100
        if slow or not any(setup.impact_point):
            return shot(0.0)
        return shot(50.0 - 100 * setup.crossovers.friction)

    monkeypatch.setattr(sweep, "row", row)
    over = {STRIKE: ["80 m/s", "120 m/s"]}
    found = wc.sweep(scene, over=over, interval=True)
    assert [len(one.runs) for one in found.intervals] == [3, 5]
    assert list(found.to_dataframe()["outcome"]) == ["stopped", "depends"]
    assert len(fired) == 8
    told = "stopped to perforated with 40.0 m/s left: the place and friction between yarns decide; "
    assert found.lines()[1].startswith(f"strike velocity 120 m/s: {told}")


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    ("over", "options", "words"),
    [
        ({STRIKE: ["90 m/s"]}, {"quantity": "v50"}, "interval: must be left out of v50"),
        ({"panel.crossovers": ["pinned"]}, {}, "panel.crossovers = .pinned.: must be yarns, auto"),
        ({"panel.zone": ["3 mm"]}, {}, "zone"),
    ],
)
def test_what_no_interval_of_a_sweep_reads_is_refused(scene, over, options, words):
    if "panel.crossovers" in over:
        scene.write_text(SCENE.replace('zone = "8 mm"', ""))
    with pytest.raises(InputError, match=words):
        wc.sweep(scene, over=over, interval=True, check=True, **options)
