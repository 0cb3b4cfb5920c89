"""`weavecell chart`: an unknown scene, an unknown choice."""

import pytest

pytest.importorskip("dolfinx")


def test_an_unknown_scene_lists_them(command, tmp_path):
    code, _, err = command("chart", "--scene", "moon", "--out", "c")
    assert (code, err) == (2, "error: --scene = 'moon': must be one of crossover\n")
    code, _, err = command("chart", "--scene", "crossover", "--only", "colour", "--out", "c")
    assert code == 2
    assert err.splitlines()[-1].startswith("error: axis = 'colour': must be one of mesh, mesh and penalty, ")
    assert not (tmp_path / "c").exists()
