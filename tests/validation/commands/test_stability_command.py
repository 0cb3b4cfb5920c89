"""`weavecell stability`, and the guard of the contact from the command line."""

import json

from tests.scene_text import impact_scene

EDGE = impact_scene(
    "92.5 m/s", "60 mm", panel='boundary = "clamped"\nsymmetry = "quarter"', extra="[numerics]\npenalty = 5.0\n"
)


def test_a_map(command, tmp_path):
    code, out, _ = command("stability", "--map", "viscosity", "--quick", "--out", "s")
    assert code == 0
    assert "margin" in out
    made = {path.name for path in (tmp_path / "s").iterdir()}
    assert made == {"stability-viscosity.png", "viscosity.csv", "viscosity-edges.csv", "stability.json", "points"}
    [found] = json.loads((tmp_path / "s" / "stability.json").read_text())["maps"]
    assert found["points"]["failed"] == 0


def test_an_unknown_map_lists_them(command, tmp_path):
    code, _, err = command("stability", "--map", "moon", "--out", "s")
    assert code == 2
    assert err.startswith("error: --map = 'moon': must be one of time-step, ")
    assert command("stability", "--out", "s")[0] == 2
    assert not (tmp_path / "s").exists()


def test_a_contact_that_gives_energy_ends_a_run(command, tmp_path):
    (tmp_path / "edge.toml").write_text(EDGE)
    code, _, err = command("impact", "edge.toml", "--out", "i")
    assert code == 3
    assert "the contact has given" in err
    assert "% of the strike energy that it never took" in err
