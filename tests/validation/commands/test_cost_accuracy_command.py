"""`weavecell cost-accuracy`: a scene, an unknown one, an unknown choice."""

import json

import pytest


def test_a_scene(command, tmp_path):
    code, out, _ = command("cost-accuracy", "--scene", "struck-yarn", "--quick", "--out", "c")
    assert code == 0
    assert "Pareto-optimal" in out
    made = {path.name for path in (tmp_path / "c").iterdir()}
    assert made == {"struck-yarn.csv", "struck-yarn-references.csv", "chart-struck-yarn.png", "charts.json", "cases"}
    [chart] = json.loads((tmp_path / "c" / "charts.json").read_text())["charts"]
    assert chart["scene"] == "struck-yarn"
    assert not chart["failed"]


def test_an_unknown_scene_lists_them(command, tmp_path):
    code, _, err = command("cost-accuracy", "--scene", "moon", "--out", "c")
    assert code == 2
    assert err.startswith("error: --scene = 'moon': must be one of struck-yarn, ")
    assert err.endswith(", crossover\n")
    assert command("cost-accuracy", "--out", "c")[0] == 2
    assert not (tmp_path / "c").exists()


def test_an_unknown_choice_of_the_long_study_lists_them(command, tmp_path):
    pytest.importorskip("dolfinx")
    code, _, err = command("cost-accuracy", "--scene", "crossover", "--only", "colour", "--out", "c")
    assert code == 2
    assert err.splitlines()[-1].startswith("error: axis = 'colour': must be one of mesh, mesh and penalty, ")
    assert not (tmp_path / "c").exists()
    assert command("cost-accuracy", "--scene", "crossover", "--scene", "struck-yarn")[0] == 2
