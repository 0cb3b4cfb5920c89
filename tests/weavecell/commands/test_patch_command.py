"""weavecell patch: the answer, its files, and what --check says."""

import json

import numpy as np
import pytest

pytest.importorskip("gmsh")

SCENE = """
[fabric]
name = "S-720"

[projectile]
shape = "sphere"
mass = "0.11 g"
diameter = "3 mm"
strike_velocity = "60 m/s"

[panel]
opening = "203 mm"
crossovers = "yarns"
crossover_friction = 0.15

[run]
end_time = "100 us"
"""


def test_a_patch_is_struck_in_three_models(command, tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    code, out, err = command("patch", "scene.toml", "--duration", "2us", "--verbose", "--out", "r")
    assert code == 0, err
    lines = out.splitlines()
    assert (
        "S-720, 60 m/s: 12 x 12 crossovers, struck in a gap, friction 0.15 between yarns" in lines
    )
    for name in ("pinned crossovers", "resolved yarns", "solid yarns"):
        assert sum(line.startswith(name) for line in lines) == 1
    written = json.loads((tmp_path / "r/patch.json").read_text())
    assert written["answer"]["value"] in lines
    assert written["bricks"] == 8 * 4 * 12**2
    assert written["friction_between_yarns"] == 0.15
    table = np.genfromtxt(tmp_path / "r/patch.csv", delimiter=",", names=True)
    assert table["time_s"][-1] == pytest.approx(2e-6, rel=0.1)
    for model in ("pinned", "yarns", "solids"):
        assert table[f"{model}_velocity_m_s"][0] == 60.0
        assert table[f"{model}_way_m"][-1] == pytest.approx(60 * table["time_s"][-1], rel=0.02)
    assert (tmp_path / "r/scene.toml").read_text() == SCENE
    assert b"<svg" in (tmp_path / "r/patch.svg").read_bytes()


def test_a_forecast_runs_nothing(command, tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    code, out, err = command(
        "patch", "scene.toml", "--check", "--crossings", "20", "--mesh", "5,5,2"
    )
    assert code == 0, err
    assert "20 x 20 crossovers of 160,000 hexahedra" in out
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]
