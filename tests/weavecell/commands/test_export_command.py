"""`weavecell export`: its folder, its printed error, and one clear line for what no deck holds."""

import json

import pytest

from tests.scene_text import impact_scene

FILES = {"lsdyna": {"scene.k"}, "radioss": {"scene_0000.rad", "scene_0001.rad"}}


@pytest.fixture
def scene(tmp_path):
    def write(panel="", extra=""):
        path = tmp_path / "scene.toml"
        path.write_text(impact_scene("90 m/s", "45 mm", "24 us", fabric="S-728", panel=panel, extra=extra))
        return path

    return write


@pytest.mark.parametrize("to", FILES)
def test_the_folder_holds_deck_error_and_report(command, scene, tmp_path, to):
    code, out, _ = command("export", scene(panel="plies = 2"), "--to", to, "--units", "g-mm-ms", "--out", "out")
    folder = tmp_path / "out"
    assert code == 0
    assert "has not been run" in out
    assert {path.name for path in folder.iterdir()} == FILES[to] | {"mapping.svg", "summary.json", "report.html"}
    told = json.loads((folder / "summary.json").read_text())
    assert told["run_in_the_code"] is False
    (card,) = told["error_over_strength"]
    assert 0 < card["rms"] < card["largest"] < 1
    for name in FILES[to]:
        head = (folder / name).read_text()[:1500]
        assert "NOT RUN" in head
        assert "g-mm-ms" in head
        assert f"rms {100 * card['rms']:.1f} %" in head
    page = (folder / "report.html").read_text()
    assert "not run in it" in page
    assert "rms over the biaxial plane" in page


def test_each_fabric_of_a_lay_up_has_a_card(command, tmp_path):
    path = tmp_path / "scene.toml"
    plies = 'ply_gap = "0.1 mm"\n[[panel.ply]]\n[[panel.ply]]\nname = "S-726"\nangle = "90 deg"'
    path.write_text(impact_scene("100 m/s", "30 mm", "50 us", panel=plies))
    code, out, err = command("export", path, "--to", "lsdyna", "--out", "r")
    assert code == 0, err
    assert [line.split(":")[0] for line in out.splitlines() if "rms" in line] == ["S-720", "S-726 turned"]
