"""`weavecell cost-accuracy` and `weavecell stability`: one study, unknown names, and the guard of the contact."""

import json

import pytest

from tests.scene_text import impact_scene

EDGE = impact_scene(
    "92.5 m/s", "60 mm", panel='boundary = "clamped"\nsymmetry = "quarter"', extra="[numerics]\npenalty = 5.0\n"
)


@pytest.mark.parametrize(
    ("words", "told", "files", "record", "found"),
    [
        (("cost-accuracy", "--scene", "struck-yarn"), "Pareto-optimal",
         {"struck-yarn.csv", "struck-yarn-references.csv", "chart-struck-yarn.png", "charts.json", "cases"},
         ("charts.json", "charts"), {"scene": "struck-yarn", "failed": {}}),
        (("stability", "--map", "viscosity"), "margin",
         {"stability-viscosity.png", "viscosity.csv", "viscosity-edges.csv", "stability.json", "points"},
         ("stability.json", "maps"), {"map": "viscosity"}),
    ],
)  # fmt: skip
def test_one_study(command, tmp_path, words, told, files, record, found):
    code, out, _ = command(*words, "--quick", "--out", "s")
    assert code == 0
    assert told in out
    assert {path.name for path in (tmp_path / "s").iterdir()} == files
    [one] = json.loads((tmp_path / "s" / record[0]).read_text())[record[1]]
    assert found.items() <= one.items()
    assert one.get("points", {}).get("failed", 0) == 0


@pytest.mark.parametrize(
    ("name", "option", "first", "last"),
    [("cost-accuracy", "--scene", "struck-yarn", "crossover"), ("stability", "--map", "time-step", "")],
)
def test_an_unknown_study_lists_them(command, tmp_path, name, option, first, last):
    code, _, err = command(name, option, "moon", "--out", "s")
    assert code == 2
    assert err.startswith(f"error: {option} = 'moon': must be one of {first}, ")
    assert err.endswith(f"{last}\n")
    assert command(name, "--out", "s")[0] == 2
    assert not (tmp_path / "s").exists()


def test_an_unknown_choice_of_the_long_study_lists_them(command, tmp_path):
    pytest.importorskip("dolfinx")
    code, _, err = command("cost-accuracy", "--scene", "crossover", "--only", "colour", "--out", "c")
    assert code == 2
    assert err.splitlines()[-1].startswith("error: axis = 'colour': must be one of mesh, mesh and penalty, ")
    assert not (tmp_path / "c").exists()
    assert command("cost-accuracy", "--scene", "crossover", "--scene", "struck-yarn")[0] == 2


def test_a_contact_that_gives_energy_ends_a_run(command, tmp_path):
    (tmp_path / "edge.toml").write_text(EDGE)
    code, _, err = command("impact", "edge.toml", "--out", "i")
    assert code == 3
    assert "the contact has given" in err
    assert "% of the strike energy that it never took" in err
