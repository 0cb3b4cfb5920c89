"""`weavecell mesh` and `view` of what it wrote."""

import json

import pytest

pytest.importorskip("gmsh")


def test_mesh_is_written_and_reported(command, tmp_path):
    code, out, _ = command("mesh", "S-720", "--mesh", "coarse", "--out", "mesh")
    assert code == 0
    folder = tmp_path / "mesh"
    assert sorted(path.name for path in folder.iterdir()) == [
        "crossover.msh", "crossover.png", "crossover.vtu", "mesh.json", "quality.png",
    ]  # fmt: skip
    facts = json.loads((folder / "mesh.json").read_text())
    assert facts["hexahedra"] == str(2 * 8 * 6 * 2)
    assert float(facts["worst scaled Jacobian"]) > 0.5
    assert f"worst scaled Jacobian   {facts['worst scaled Jacobian']}" in out
    code, _, _ = command("view", "mesh", "--screenshot", "mesh.png")
    assert code == 0
    assert (tmp_path / "mesh.png").read_bytes().startswith(b"\x89PNG")


def test_choices_reach_the_mesh(command, tmp_path):
    options = ("--mesh", "coarse", "--domain", "whole", "--section", "ellipse", "--yarn-gap", "30 um")
    assert command("mesh", "S-728", *options, "--out", "mesh")[0] == 0
    facts = json.loads((tmp_path / "mesh" / "mesh.json").read_text())
    assert facts["domain"] == "whole"
    assert facts["hexahedra"] == str(2 * 16 * 12 * 2)


def test_a_patch_in_every_format(command, tmp_path):
    options = ("--patch", "2x3", "--mesh", "4,3,1", "--crimp", "2 %, 1 %", "--width", "1.2 mm", "--end-shells", "20 um")
    code, out, err = command("mesh", "S-720", *options, "--format", "msh,vtu,k,inp,rad", "--out", "mesh")
    assert code == 0, err
    assert sorted(path.name for path in (tmp_path / "mesh").iterdir()) == [
        "mesh.json", "patch.inp", "patch.k", "patch.msh", "patch.png", "patch.vtu", "patch_0000.rad", "quality.png",
    ]  # fmt: skip
    facts = json.loads((tmp_path / "mesh" / "mesh.json").read_text())
    assert facts["domain"] == "2 warp x 3 weft yarns"
    assert facts["hexahedra"] == str(2 * 3 * 8 * 4 * 3 * 1)
    assert "solved: " in facts["sections"]
    assert f"facets of the mesh      {facts['facets of the mesh']}" in out
    assert "*ELEMENT_SHELL" in (tmp_path / "mesh" / "patch.k").read_text()


def test_four_crossovers_of_an_edge_length(command, tmp_path):
    assert command("mesh", "S-726", "--domain", "periodic", "--mesh", "0.2 mm", "--out", "mesh")[0] == 0
    facts = json.loads((tmp_path / "mesh" / "mesh.json").read_text())
    assert facts["domain"] == "2 warp x 2 weft yarns"
    assert facts["sections"].startswith("conforming: ")


@pytest.mark.parametrize(
    ("fabric", "options", "line"),
    [
        ("S-720", "--crimp=-1%", "crimp = -0.01: must be a fraction from 0 to below 1 (0.02 or 2 %)"),
        ("S-720", "--crimp 1%,2%,3%", "--crimp = '1%,2%,3%': must be one value, or two separated by a comma, of"),
        ("S-720", "--width 1.4mm", "warp width = 0.0014: must be above 0 and at most the spacing, 0.00127 m"),
        ("S-720", "--yarn-gap 0.7mm", "gap = 0.0007: must be from 0 to below half a spacing, 0.000635 m"),
        (
            "S-720",
            "--section ellipse --overlap refuse",
            "the ellipse sections of warp and weft overlap by 40.5 um, more",
        ),
        (
            "S-731",
            "--section sine --width 0.819mm",
            "the sine sections of warp and weft overlap by 43.9 um even at the",
        ),
        ("S-720", "--patch 3", "--patch = '3': must be numbers of warp and weft yarns, such as 3x4"),
        ("S-720", "--patch 0x2", "count = (0, 2): must be two whole numbers from 1, of warp and of weft yarns"),
        ("S-720", "--patch 2x2 --domain periodic", "--patch = '2x2': must be left out where --domain is given"),
        ("S-720", "--format stl", "--format = 'stl': must be one or more of msh, vtu, k, inp, rad"),
        ("S-720", "--mesh 1,2", "size = (1, 2): must be coarse, medium, fine, auto, an edge length up to"),
        ("S-720", "--end-shells 0mm", "end_shells = 0.0: must be a positive thickness in m, or none"),
    ],
)
def test_a_bad_request_is_one_line_and_no_file(command, tmp_path, fabric, options, line):
    code, out, err = command("mesh", fabric, *options.split(), "--out", "mesh")
    assert code == 2
    assert out == ""
    assert len(err.splitlines()) == 1
    assert err.startswith(f"error: {line}")
    assert not (tmp_path / "mesh").exists()


def test_nothing_to_view(command, tmp_path):
    code, _, err = command("view", "nowhere", "--screenshot", "a.png")
    assert code == 2
    assert err.startswith("error: PATH = 'nowhere': must be a folder that holds")
    code, _, err = command("view", "nowhere", "--screenshot", "a.jpg")
    assert (code, err) == (2, "error: --screenshot = 'a.jpg': must be a file named *.png\n")
