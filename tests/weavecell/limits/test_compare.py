"""`weavecell compare`: tests beside computed shots, from the command line."""

import csv
import json

from tests.scene_text import impact_scene

TESTS = "velocity [m/s], outcome, residual velocity [m/s]\n60, PP,\n140, CP, 100\n150, CP, 120\n"


def test_tests_and_computed_shots_stand_side_by_side(command, tmp_path):
    (tmp_path / "tests.csv").write_text(TESTS)
    (tmp_path / "scene.toml").write_text(impact_scene("100 m/s", "50 mm", "60 us"))
    words = ("compare", "tests.csv", "scene.toml", "--tolerance", "10 m/s", "--jobs", 1, "--out", "r")
    code, out, err = command(*words)
    assert code == 0, err
    told = json.loads((tmp_path / "r" / "comparison.json").read_text())
    assert told["tests"] == 3
    assert 60 < told["tested_V50_m_s"] < 140
    with open(tmp_path / "r" / "shots.csv") as file:
        rows = list(csv.DictReader(file))
    assert [row["tested"] for row in rows] == ["stopped", "perforated", "perforated"]
    assert told["outcomes_that_agree"] == sum(row["tested"] == row["computed"] for row in rows)
    off = [float(row["computed residual velocity [m/s]"]) - v for row, v in zip(rows[1:], (100, 120))]
    assert abs(told["residual_velocity_mean_m_s"] - sum(off) / 2) < 0.1
    assert f"outcome as tested in {told['outcomes_that_agree']} of 3 shots" in out
    assert sorted(path.name for path in (tmp_path / "r").iterdir()) == [
        "comparison.json", "comparison.svg", "scene.toml", "shots.csv",
    ]  # fmt: skip
