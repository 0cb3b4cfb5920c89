"""Exit codes of `weavecell cost-accuracy`, `stability` and, at a contact that gives energy, `impact`."""

import json

import pytest

from tests.scene_text import impact_scene

EDGE = impact_scene(
    "92.5 m/s", "60 mm", panel='boundary = "clamped"\nsymmetry = "quarter"', extra="[numerics]\npenalty = 5.0\n"
)


@pytest.mark.parametrize(
    ("name", "option", "study", "record"),
    [
        ("cost-accuracy", "--scene", "struck-yarn", {"scene": "struck-yarn", "failed": {}}),
        ("stability", "--map", "viscosity", {"map": "viscosity"}),
    ],
)
def test_one_study(command, tmp_path, name, option, study, record):
    assert command(name, option, study, "--quick", "--out", "s")[0] == 0
    (path,) = (tmp_path / "s").glob("*.json")
    ((written,),) = (entries for entries in json.loads(path.read_text()).values() if isinstance(entries, list))
    assert record.items() <= written.items()
    assert written.get("points", {}).get("failed", 0) == 0


@pytest.mark.parametrize(
    "words", [("cost-accuracy", "--scene", "moon"), ("stability", "--map", "moon"), ("stability",)]
)
def test_unknown_or_missing_studies_are_refused(command, tmp_path, words):
    code, _, err = command(*words, "--out", "s")
    assert (code, err.startswith("error: ")) == (2, True)
    assert not (tmp_path / "s").exists()


def test_a_contact_that_gives_energy_ends_a_run(command, tmp_path):
    (tmp_path / "edge.toml").write_text(EDGE)
    code, _, err = command("impact", "edge.toml", "--out", "i")
    assert code == 3
    assert "the contact has given" in err
