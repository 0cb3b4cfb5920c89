"""`weavecell mesh` and `view` of what it wrote."""

import json

import pytest

pytest.importorskip("gmsh")


def test_mesh_is_written_and_reported(command, tmp_path):
    code, out, _ = command("mesh", "S-720", "--mesh", "coarse", "--out", "mesh")
    assert code == 0
    folder = tmp_path / "mesh"
    assert sorted(path.name for path in folder.iterdir()) == [
        "crossover.msh",
        "crossover.png",
        "crossover.vtu",
        "mesh.json",
        "quality.png",
    ]
    facts = json.loads((folder / "mesh.json").read_text())
    assert facts["hexahedra"] == str(2 * 8 * 6 * 2)
    assert float(facts["worst scaled Jacobian"]) > 0.5
    assert f"worst scaled Jacobian   {facts['worst scaled Jacobian']}" in out
    code, _, _ = command("view", "mesh", "--screenshot", "mesh.png")
    assert code == 0
    assert (tmp_path / "mesh.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "domain", "facts"),
    [
        (
            "S-728 --mesh coarse --domain whole --section ellipse --yarn-gap 30um",
            "whole",
            {"hexahedra": "768"},
        ),
        ("S-726 --mesh 0.2mm --domain periodic", "2 warp x 2 weft yarns", {}),
    ],
)
def test_choices_reach_the_mesh(command, tmp_path, words, domain, facts):
    assert command("mesh", *words.split(), "--out", "mesh")[0] == 0
    found = json.loads((tmp_path / "mesh" / "mesh.json").read_text())
    assert found.items() >= (facts | {"domain": domain}).items()
    assert domain == "whole" or found["sections"].startswith("conforming: ")


def test_a_patch_in_every_format(command, tmp_path):
    options = (
        "--patch",
        "2x3",
        "--mesh",
        "4,3,1",
        "--crimp",
        "2 %, 1 %",
        "--width",
        "1.2 mm",
        "--end-shells",
        "20 um",
    )
    code, out, err = command(
        "mesh", "S-720", *options, "--format", "msh,vtu,k,inp,rad", "--out", "mesh"
    )
    assert code == 0, err
    assert sorted(path.name for path in (tmp_path / "mesh").iterdir()) == [
        "mesh.json",
        "patch.inp",
        "patch.k",
        "patch.msh",
        "patch.png",
        "patch.vtu",
        "patch_0000.rad",
        "quality.png",
    ]
    facts = json.loads((tmp_path / "mesh" / "mesh.json").read_text())
    assert facts["domain"] == "2 warp x 3 weft yarns"
    assert facts["hexahedra"] == str(2 * 3 * 8 * 4 * 3 * 1)
    assert "solved: " in facts["sections"]
    assert f"facets of the mesh      {facts['facets of the mesh']}" in out
    assert "*ELEMENT_SHELL" in (tmp_path / "mesh" / "patch.k").read_text()
