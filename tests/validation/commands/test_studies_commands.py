"""The programs of `python -m validation`: what they write and refuse; and a contact that gives energy."""

import json

import pytest

from fabrics.errors import InputError
from tests.scene_text import impact_scene
from validation.__main__ import main
from validation.commands import cost_accuracy, scatter, stability

EDGE = impact_scene(
    "92.5 m/s", "60 mm", panel='boundary = "clamped"\nsymmetry = "quarter"', extra="[numerics]\npenalty = 5.0\n"
)


@pytest.mark.parametrize(
    ("study", "name", "record"),
    [
        (cost_accuracy, "struck-yarn", {"scene": "struck-yarn", "failed": {}}),
        (stability, "viscosity", {"map": "viscosity"}),
    ],
)
def test_one_study(tmp_path, study, name, record):
    study.main([name], quick=True, out=tmp_path / "s")
    (path,) = (tmp_path / "s").glob("*.json")
    ((written,),) = (entries for entries in json.loads(path.read_text()).values() if isinstance(entries, list))
    assert record.items() <= written.items()
    assert written.get("points", {}).get("failed", 0) == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("cost-accuracy moon", "error: scenes = 'moon': must be one of struck-yarn, "),
        ("stability moon", "error: maps = 'moon': must be one of time-step, "),
        ("claims --topics moon", "error: "),
        ("calibration --page page.md", "error: --page goes with --fit-solid"),
        ("scatter page.md sweep", "error: command = 'sweep': must be one of v50, sensitivity"),
    ],
)
def test_what_there_is_none_of_is_refused(capsys, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as leaving:
        main([*words.split(), "--out", "s"])
    assert leaving.value.code == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_study_of_scatter_is_put_into_its_page(tmp_path):
    page = tmp_path / "docs" / "scatter.md"
    page.parent.mkdir()
    page.write_text("before\n<!-- v50 -->\nold\n<!-- end of v50 -->\nafter\n")
    with pytest.raises(InputError, match="has no marks"):
        scatter.main(page, "sensitivity S-720 --samples 2 --opening '30.6 mm'", out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
    scatter.main(page, "v50 S-720 --shots 8 --batch 4 --opening '30.6 mm' --seed 2 --jobs 1", out=tmp_path / "out")
    before, text, after = page.read_text().replace("\n<!-- end of v50 -->", "<!-- v50 -->").split("<!-- v50 -->")
    assert (before, after) == ("before\n", "\nafter\n")
    assert "old" not in text
    assert "| probit | V50 |" in text
    assert "- A series of tests up and down" in text
    assert (page.parent / "figures" / "scatter-v50.png").exists()


def test_a_contact_that_gives_energy_ends_a_run(command, tmp_path):
    (tmp_path / "edge.toml").write_text(EDGE)
    code, _, err = command("impact", "edge.toml", "--out", "i")
    assert code == 3
    assert "the contact has given" in err
