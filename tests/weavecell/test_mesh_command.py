"""`weavecell mesh` and `view` of what it wrote."""

import json

import pytest

pytest.importorskip("gmsh")


def test_mesh_is_written_and_told(command, tmp_path):
    code, out, _ = command("mesh", "S-720", "--size", "coarse", "--out", "mesh")
    assert code == 0
    folder = tmp_path / "mesh"
    assert sorted(path.name for path in folder.iterdir()) == [
        "crossover.msh", "crossover.png", "crossover.vtu", "mesh.json",
    ]  # fmt: skip
    facts = json.loads((folder / "mesh.json").read_text())
    assert facts["hexahedra"] == str(2 * 8 * 6 * 2)
    assert float(facts["worst scaled Jacobian"]) > 0.5
    assert f"worst scaled Jacobian   {facts['worst scaled Jacobian']}" in out
    code, _, _ = command("view", "mesh", "--screenshot", "mesh.png")
    assert code == 0
    assert (tmp_path / "mesh.png").read_bytes().startswith(b"\x89PNG")


def test_choices_reach_the_mesh(command, tmp_path):
    options = ("--size", "coarse", "--domain", "whole", "--section", "ellipse", "--gap", "30 um")
    assert command("mesh", "S-728", *options, "--out", "mesh")[0] == 0
    facts = json.loads((tmp_path / "mesh" / "mesh.json").read_text())
    assert facts["domain"] == "whole"
    assert facts["hexahedra"] == str(2 * 16 * 12 * 2)


def test_nothing_to_view(command, tmp_path):
    code, _, err = command("view", "nowhere", "--screenshot", "a.png")
    assert code == 2
    assert err.startswith("error: PATH = 'nowhere': must be a folder that holds")
    code, _, err = command("view", "nowhere", "--screenshot", "a.jpg")
    assert (code, err) == (2, "error: --screenshot = 'a.jpg': must be a file named *.png\n")
