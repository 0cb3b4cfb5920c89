"""`weavecell sweep` and `v50`: tables, resuming, and limits against the number of plies."""

import re
import shutil
from dataclasses import replace
from types import SimpleNamespace as Given

import pytest

import weavecell as wc
from shellfabric.membrane import quality
from tests.scene_text import merged, toml
from tests.weavecell.session_runs import SCENES
from tests.weavecell.written import page_of, rows_of
from weavecell.answers.sweep import SweepTable
from weavecell.api import sweeps
from weavecell.api.target import resolve_target
from weavecell.report.shot import chapters_shot
from weavecell.results import progress
from weavecell.runs import sweep as analysis
from weavecell.studies import limit as limits
from weavecell.studies import pack_limit
from weavecell.studies.ballistic_limit import Limit, Shot


def test_a_row_of_mixed_outcomes_has_the_zone_and_no_velocity(monkeypatch):
    outcomes = {90.0: "stopped", 95.0: "perforated", 100.0: "stopped", 101.0: "perforated"}
    shots = [
        Shot(velocity, 0.0, name, 1e-4, 0, (1.0, 1.0), 0.0, 0.1)
        for velocity, name in outcomes.items()
    ]
    found = Limit(100.0, 101.0, tuple(shots))
    monkeypatch.setattr(limits, "search", lambda *_, **__: type("Search", (), {"limit": found}))
    one_ply = Given(plies=1)
    row = analysis.critical_velocity(one_ply, 1.0)
    assert row["outcome"] == analysis.MIXED
    assert row["critical_velocity_m_s"] is None
    assert row["lower_m_s"] == 95.0
    assert row["upper_m_s"] == 100.0
    found = Limit(100.0, 101.0, (shots[0], shots[-1], shots[2]))
    row = analysis.critical_velocity(one_ply, 1.0)
    assert row["outcome"] == "single limit"
    assert row["critical_velocity_m_s"] == 100.5


def energy(velocity):
    """An energy error that grows with the strike velocity [m/s]."""
    return quality.indicator("energy error", 1e-3 * velocity)


def test_a_row_of_a_pack_is_its_v50_with_the_interval_and_of_few_perforations_the_bracket(
    monkeypatch,
):
    """Outcomes of a pack may mix: V50 stands for them, by the same shots as its own command."""
    asked = []
    left = {95.0: 0.0, 100.0: 31.0, 103.0: 0.0, 106.0: 47.0, 109.0: 60.0, 113.0: 71.0}
    # the fastest, at no end of the bracket, is the worst
    fired = [
        Shot(v, r, "perforated" if r else "stopped", 1e-4, 0, (1.0, 1.0), 0.0, 0.1, (energy(v),))
        for v, r in left.items()
    ]

    def search(setup, **options):
        asked.append(options)
        return Given(limit=Limit(95.0, 100.0, tuple(fired[: options["v50_shots"]])))

    monkeypatch.setattr(limits, "search", search)
    row = analysis.critical_velocity(Given(plies=3), 4.0)
    assert asked == [{"tolerance": 4.0, "v50_shots": pack_limit.SHOTS, "scan": None}]
    found = pack_limit.of_shots(fired)
    assert row["outcome"] == "95 % interval"
    assert (row["critical_velocity_m_s"], row["lower_m_s"], row["upper_m_s"]) == (
        found.velocity,
        found.low,
        found.high,
    )
    assert row["spread_m_s"] == found.spread
    assert row["shots"] == 6
    assert row["checks"].startswith("doubtful: energy error 0.113")
    del fired[3:]
    row = analysis.critical_velocity(Given(plies=3))
    assert row["outcome"] == analysis.MIXED
    assert (row["lower_m_s"], row["upper_m_s"]) == (100.0, 103.0)


def test_a_sweep_prints_the_interval_of_a_pack():
    rows = (
        {"panel.plies": 2, "outcome": analysis.INTERVAL, "critical_velocity_m_s": 233.44}
        | {"lower_m_s": 228.26, "upper_m_s": 239.71, "checks": "ok"},
    )
    table = SweepTable("critical-velocity", ("panel.plies",), rows, ())
    assert table.lines() == ["panel plies 2: 233.4 m/s, 95 % interval from 228.3 to 239.7 m/s"]


def test_progress_without_a_terminal(monkeypatch, capsys):
    """A batch job sees a line every half minute, and one at the end; a Python script nothing."""
    clock = [0.0]
    monkeypatch.setattr("tqdm.std.time", lambda: clock[0])
    for shown, estimate in ((True, True), (True, False), (False, True)):
        monkeypatch.setattr(progress, "shown", shown)
        with progress.bar("3 x shot", estimate) as advance:
            for share in (0.1, 0.5, 0.9):
                clock[0] += 16.0
                advance(share, f"{share:g}")
    lines = ["3 x shot: 50 %, 00:32<00:32, 0.5", "3 x shot: 100 %, 00:48<00:00"]
    lines += ["3 x shot: 50 %, 00:32, 0.5", "3 x shot: 100 %, 00:48"]
    assert capsys.readouterr().err.splitlines() == lines


def test_values_are_numbers_truth_values_or_texts():
    assert sweeps.parse("panel.plies=2, 4") == ("panel.plies", [2, 4])
    assert sweeps.parse("projectile.strike_velocity=100 m/s,1e2") == (
        "projectile.strike_velocity",
        ["100 m/s", 100.0],
    )
    assert sweeps.parse("panel.yarn_failure=true") == ("panel.yarn_failure", [True])


def test_resume_adds_values_without_computing_a_shot_again(succeed, results, tmp_path):
    made = results("sweep")
    found = rows_of(made.folder, "sweep.csv")
    assert [(row["projectile.strike_velocity"], row["projectile.mass"]) for row in found] == [
        ("90 m/s", "3 g"),
        ("90 m/s", "2 g"),
        ("150 m/s", "3 g"),
        ("150 m/s", "2 g"),
    ]
    assert "strike velocity 90 m/s, projectile mass 3 g: " in made.out
    folder = shutil.copytree(made.folder, tmp_path / "r")
    kept = {path: path.stat().st_mtime_ns for path in (folder / "runs").iterdir()}
    velocities = "projectile.strike_velocity='90 m/s,120 m/s,150 m/s'"
    line = f"sweep {folder}/scene.toml --over {velocities} --over projectile.mass='3 g,2 g'"
    succeed(f"{line} --out r --jobs 1 --resume")
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert rows_of(folder, "sweep.csv")[:2] == found[:2]
    assert len(rows_of(folder, "sweep.csv")) == 6


@pytest.mark.slow(12)
def test_the_limit_and_v50_against_the_number_of_plies(succeed, drawn_once, tmp_path):
    """Against areal density; two plies stop more than one, and V50 of eight shots is near the limit."""
    (tmp_path / "scene.toml").write_text(toml(SCENES["plies"]))
    line = "sweep scene.toml --jobs 1 --over panel.plies="
    limit = "--quantity critical-velocity --tolerance '10 m/s' --out limit"
    succeed(f"{line}1,2 {limit}")
    one, two = rows_of(tmp_path / "limit", "sweep.csv")
    assert float(two["areal_density_kg_m2"]) == pytest.approx(2 * float(one["areal_density_kg_m2"]))
    assert float(one["upper_m_s"]) < float(two["lower_m_s"])
    succeed(f"{line}1 --quantity v50 --shots 8 --out v50")
    (row,) = rows_of(tmp_path / "v50", "sweep.csv")
    limit = (float(one["lower_m_s"]) + float(one["upper_m_s"])) / 2
    assert float(row["v50_m_s"]) == pytest.approx(limit, rel=0.25)
    assert row["shots"] == "8"


def test_a_v50_study_prints_each_v50_that_it_found(results):
    out = results("v50").out
    assert len(re.findall(r"^answer +V50 \S+ m/s \(.*V10 .*V90 ", out, re.MULTILINE)) == 1
    assert out.count("V50 of six shots (MIL-STD-662F") == 1


def test_a_v50_study_says_what_was_fired_and_what_is_not_drawn(results):
    out = results("v50").out
    assert "projectile: a cylinder of 3 g and 5.5 mm" in out
    assert "not in these numbers, mesh: " in out
    drawn = r"12 drawn shots, \d+ pass: place, friction between yarns 0\.1 to 0\.3, "
    assert re.search(drawn, out)


def test_a_v50_study_says_what_is_assumed_in_print_and_report(results):
    run = results("v50")
    for text in (run.out, page_of(run.folder)):
        assert "assumed: failure length 0.75 mm (0.375 mm .. 1.5 mm)" in text


def test_the_report_of_a_v50_study_has_result_assumptions_sources_and_making(results):
    page = page_of(results("v50").folder)
    sections = re.findall(r'<section id="([^"]*)"', page)
    parts = ["movers", "result", "drawn", "remarks", "assumptions", "sources", "making", "words"]
    assert sections == parts


def test_the_report_of_a_v50_study_begins_with_v50_and_what_was_shot_at(results):
    page = page_of(results("v50").folder)
    panel = "One ply of S-720, 30.6 mm square and clamped"
    answer = re.search(r'<div class="answer plain">(.*?)</p>', page, re.DOTALL)[1]
    assert re.search(r"V50(</abbr>)? \d+(\.\d)? m/s \(", answer)
    assert f"{panel}, struck by a cylinder of 3 g and 5.5 mm." in page
    # of a quarter each drawn panel would be its own image
    assert "The whole panel is modelled" in page


@pytest.mark.parametrize("quantity, drawn", [("v50", True), ("critical-velocity", False)])
def test_a_sweep_says_whether_each_yarn_has_a_drawn_strength(quantity, drawn):
    """V50 draws strengths, in a sweep too; all yarns of a limit have the same."""
    panel = resolve_target("S-720", {}, "v50")
    table = SweepTable(quantity, ("panel.opening",), (), (panel,))
    assert table.draws_strengths == drawn
    section = chapters_shot.assumptions(table.fired, (), drawn=table.draws_strengths)
    assert ("it is the same for all yarns" in str(section)) == (not drawn)
    assert ("The whole panel is modelled" in str(section)) == drawn


def test_a_sweep_says_what_came_of_the_keys_that_vary(tmp_path):
    """Two keys of which one has a single value: axis, title and headline are about the other."""
    scene = {"run": {"end_time": "5 us"}, "projectile": {"strike_velocity": "150 m/s"}}
    (tmp_path / "scene.toml").write_text(toml(merged(SCENES["limit"], scene)))
    over = {"projectile.strike_velocity": ["140 m/s"], "panel.opening": ["16 mm", "20 mm"]}
    table = wc.sweep(tmp_path / "scene.toml", over=over)
    assert table.answer.over == "2 rows over panel opening: 2 in flight"
    assert table.title.endswith(", shot over panel opening")
    assert table.lines()[1].startswith("panel opening 20 mm: ")
    axes = table.plot().axes[0]
    assert axes.get_xlabel() == "panel opening [mm]"
    x, y = axes.lines[0].get_data()
    assert list(x) == pytest.approx([16.0, 20.0])
    assert axes.get_ylim()[1] > max(y)  # the marks are within the axes
    for outcome, residual, words in (
        ("stopped", 0.0, "2 stopped"),
        ("undecided: no bracket", None, "2 undecided: no bracket"),
    ):
        rows = [row | {"outcome": outcome, "residual_velocity_m_s": residual} for row in table.rows]
        assert replace(table, rows=rows).answer.value == words
    rows = [{**row, "outcome": word} for row, word in zip(table.rows, ("stopped", "perforated"))]
    rows[0]["residual_velocity_m_s"], rows[1]["residual_velocity_m_s"] = 0.0, 31.4
    ends = "0 m/s (opening 16 mm) to 31.4 m/s (opening 20 mm)"
    answer = replace(table, rows=rows).answer
    assert answer.value == f"residual velocity {ends}"
    assert answer.over.endswith(": 1 stopped, 1 perforated")
