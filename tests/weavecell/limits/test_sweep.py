"""`weavecell sweep`: combinations, table, resuming, and limits against the number of plies."""

import csv
import shutil

import pytest

from shellfabric.impact.ballistic_limit import Limit, Shot
from tests.scene_text import toml
from tests.weavecell.session_runs import SCENES
from weavecell.analysis import limit_search
from weavecell.analysis import sweep as analysis
from weavecell.commands import sweep
from weavecell.results import progress


def rows(folder):
    return list(csv.DictReader((folder / "sweep.csv").read_text().splitlines()))


def test_a_row_of_mixed_outcomes_has_the_middle_of_the_zone(monkeypatch):
    outcomes = {90.0: "stopped", 95.0: "perforated", 100.0: "stopped", 101.0: "perforated"}
    shots = [Shot(velocity, 0.0, name, 1e-4, 0, (1.0, 1.0), 0.0, 0.1) for velocity, name in outcomes.items()]
    found = Limit(100.0, 101.0, tuple(shots))
    monkeypatch.setattr(limit_search, "search", lambda *_, **__: type("Search", (), {"limit": found}))
    row = analysis.limit(None, 1.0)
    assert (row["outcome"], row["critical_velocity_m_s"]) == (analysis.MIXED, 97.5)
    assert (row["lower_m_s"], row["upper_m_s"]) == (95.0, 100.0)
    found = Limit(100.0, 101.0, (shots[0], shots[-1], shots[2]))
    row = analysis.limit(None, 1.0)
    assert (row["outcome"], row["critical_velocity_m_s"]) == ("single limit", 100.5)


def test_progress_without_a_terminal(monkeypatch, capsys):
    """A batch job sees a line every half minute, and one at the end."""
    clock = iter((0.0, 10.0, 31.0, 31.0, 40.0, 50.0))
    monkeypatch.setattr(progress.time, "perf_counter", lambda: next(clock))
    with progress.bar("3 x shot") as advance:
        for share in (0.1, 0.5, 0.9):
            advance(share, f"{share:g}")
    assert capsys.readouterr().err.splitlines() == ["3 x shot: 50 %, 0.5", "3 x shot: 50.0 s"]


def test_values_are_numbers_truth_values_or_texts():
    assert sweep.parse("panel.plies=2, 4") == ("panel.plies", [2, 4])
    assert sweep.parse("projectile.strike_velocity=100 m/s,1e2") == ("projectile.strike_velocity", ["100 m/s", 100.0])
    assert sweep.parse("panel.yarn_failure=true") == ("panel.yarn_failure", [True])


def test_resume_adds_values_without_computing_a_shot_again(command, results, tmp_path):
    made = results("sweep")
    found = rows(made.folder)
    assert [(row["projectile.strike_velocity"], row["projectile.mass"]) for row in found] == [
        ("90 m/s", "3 g"), ("90 m/s", "2 g"), ("150 m/s", "3 g"), ("150 m/s", "2 g"),
    ]  # fmt: skip
    assert "projectile.strike_velocity = 90 m/s, projectile.mass = 3 g: " in made.out
    folder = shutil.copytree(made.folder, tmp_path / "r")
    kept = {path: path.stat().st_mtime_ns for path in (folder / "runs").iterdir()}
    more = ("--over", "projectile.strike_velocity=90 m/s,120 m/s,150 m/s", "--over", "projectile.mass=3 g,2 g")
    assert command("sweep", folder / "scene.toml", *more, "--out", "r", "--jobs", 2, "--resume")[0] == 0
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert rows(folder)[:2] == found[:2]
    assert len(rows(folder)) == 6


def test_the_limit_and_v50_against_the_number_of_plies(command, tmp_path):
    """Against areal density; two plies stop more than one, and V50 of eight shots is near the limit."""
    (tmp_path / "scene.toml").write_text(toml(SCENES["plies"]))
    words = ("sweep", "scene.toml", "--jobs", 1, "--over")
    limit = ("panel.plies=1,2", "--quantity", "critical-velocity", "--tolerance", "10 m/s", "--out", "limit")
    assert command(*words, *limit)[0] == 0
    one, two = rows(tmp_path / "limit")
    assert float(two["areal_density_kg_m2"]) == pytest.approx(2 * float(one["areal_density_kg_m2"]))
    assert float(one["upper_m_s"]) < float(two["lower_m_s"])
    assert command(*words, "panel.plies=1", "--quantity", "v50", "--shots", 8, "--out", "v50")[0] == 0
    (row,) = rows(tmp_path / "v50")
    assert float(row["v50_m_s"]) == pytest.approx(float(one["lower_m_s"]), rel=0.25)
    assert row["shots"] == "8"
