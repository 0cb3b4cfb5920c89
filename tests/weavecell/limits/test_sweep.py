"""`weavecell sweep`: combinations, table, resuming, and what is refused before anything is computed."""

import csv
import json

import pytest

from fabrics.errors import InputError
from shellfabric.impact.ballistic_limit import Limit, Shot
from weavecell.analysis import limit_search
from weavecell.analysis import sweep as analysis
from weavecell.api import sweeps
from weavecell.results import progress

SCENE = """
[fabric]
name = "S-720"
[projectile]
mass = "3 g"
diameter = "5.5 mm"
edge_radius = "0.3 mm"
strike_velocity = "90 m/s"
[panel]
opening = "40 mm"
[run]
end_time = "60 us"
elements_per_crossover = 1
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def rows(folder):
    return list(csv.DictReader((folder / "sweep.csv").read_text().splitlines()))


def made_up(velocity, outcome):
    return Shot(velocity, 0.0, outcome, 1e-4, 0, (1.0, 1.0), 0.0, 0.1)


def test_a_row_of_mixed_outcomes_has_the_middle_of_the_zone(monkeypatch):
    outcomes = {90.0: "stopped", 95.0: "perforated", 100.0: "stopped", 101.0: "perforated"}
    shots = [made_up(*shot) for shot in outcomes.items()]
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
    monkeypatch.setattr(progress, "shown", True)
    with progress.bar("3 x shot") as advance:
        for share in (0.1, 0.5, 0.9):
            advance(share, f"{share:g}")
    assert capsys.readouterr().err.splitlines() == ["3 x shot: 50 %, 0.5", "3 x shot: 50.0 s"]


def test_what_is_swept():
    assert sweeps.parse("panel.plies=2, 4") == ("panel.plies", [2, 4])
    assert sweeps.parse("projectile.strike_velocity=100 m/s,1e2") == ("projectile.strike_velocity", ["100 m/s", 100.0])
    assert sweeps.parse("panel.yarn_failure=true") == ("panel.yarn_failure", [True])
    for wrong in ("panel.plies", "=2", "panel.plies=2,,4", "panel.plies="):
        with pytest.raises(InputError, match="over"):
            sweeps.parse(wrong)


def test_shots_of_all_combinations(command, scene, tmp_path):
    """Each row is the shot of its input file; --resume adds values without computing a shot again."""
    over = ("--over", "projectile.strike_velocity=90 m/s,150 m/s", "--over", "projectile.mass=3 g,2 g")
    code, out, _ = command("sweep", scene, *over, "--out", "r", "--jobs", 1)
    folder = tmp_path / "r"
    assert code == 0
    found = rows(folder)
    assert [(row["projectile.strike_velocity"], row["projectile.mass"]) for row in found] == [
        ("90 m/s", "3 g"), ("90 m/s", "2 g"), ("150 m/s", "3 g"), ("150 m/s", "2 g"),
    ]  # fmt: skip
    assert "projectile.strike_velocity = 90 m/s, projectile.mass = 3 g: " in out
    assert {"scene.toml", "sweep.csv", "sweep.json", "sweep.png", "runs"} <= {path.name for path in folder.iterdir()}
    command("impact", scene, "--out", "one")
    one = json.loads((tmp_path / "one" / "summary.json").read_text())
    assert found[0]["outcome"] == one["outcome"]
    assert float(found[0]["residual_velocity_m_s"]) == one["residual_velocity_m_s"]
    assert float(found[0]["absorbed_energy_J"]) == pytest.approx(one["absorbed_energy_J"])
    kept = {path: path.stat().st_mtime_ns for path in (folder / "runs").iterdir()}
    more = ("--over", "projectile.strike_velocity=90 m/s,120 m/s,150 m/s", "--over", "projectile.mass=3 g,2 g")
    assert command("sweep", scene, *more, "--out", "r", "--jobs", 2, "--resume")[0] == 0
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert rows(folder)[:2] == found[:2]
    assert len(rows(folder)) == 6


def test_the_limit_and_v50_against_the_number_of_plies(command, scene, tmp_path):
    """Against areal density; two plies stop more than one, and V50 of twelve shots is near the limit."""
    over = ("--over", "panel.plies=1,2", "--jobs", 1)
    limit = ("--quantity", "critical-velocity", "--tolerance", "10 m/s", "--out", "limit")
    assert command("sweep", scene, *over, *limit)[0] == 0
    one, two = rows(tmp_path / "limit")
    assert float(two["areal_density_kg_m2"]) == pytest.approx(2 * float(one["areal_density_kg_m2"]))
    assert float(one["upper_m_s"]) < float(two["lower_m_s"])
    told = command("sweep", scene, *over, "--quantity", "v50", "--shots", 12, "--out", "v50")
    assert told[0] == 0
    for row, same in zip(rows(tmp_path / "v50"), (one, two)):
        assert float(row["v50_m_s"]) == pytest.approx(float(same["lower_m_s"]), rel=0.25)
        assert row["shots"] == "12"
