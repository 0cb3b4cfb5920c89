"""`weavecell mesh` and `view` of what it wrote."""

import pytest

from tests.weavecell.written import names, table_of

pytest.importorskip("gmsh")


def test_mesh_is_written_and_reported(succeed, tmp_path):
    out = succeed("mesh S-720 --mesh coarse --out mesh")
    folder = tmp_path / "mesh"
    assert names(folder) == "crossover.msh crossover.png crossover.vtu mesh.json quality.png"
    facts = table_of(folder, "mesh.json")
    assert facts["hexahedra"] == 2 * 8 * 6 * 2
    assert facts["worst_scaled_jacobian"] > 0.5
    assert f"worst scaled Jacobian   {facts['worst_scaled_jacobian']:.3f}" in out
    succeed("view mesh --screenshot mesh.png")
    assert (tmp_path / "mesh.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "words, domain, facts",
    [
        (
            "S-728 --mesh coarse --domain whole --section ellipse --yarn-gap 30um",
            "whole",
            {"hexahedra": 768},
        ),
        pytest.param(
            "S-726 --mesh 0.2mm --domain periodic",
            "2 warp x 2 weft yarns",
            {},
            marks=pytest.mark.slow(3),
        ),
    ],
)
def test_choices_reach_the_mesh(succeed, tmp_path, words, domain, facts):
    succeed(f"mesh {words} --out mesh")
    found = table_of(tmp_path / "mesh", "mesh.json")
    assert found.items() >= (facts | {"domain": domain}).items()
    assert domain == "whole" or found["sections"].startswith("conforming: ")


def test_a_patch_in_every_format(succeed, tmp_path):
    size = "--crimp '2 %, 1 %' --width '1.2 mm' --end-shells '20 um'"
    line = (
        f"mesh S-720 --patch 2x3 --mesh 2,2,1 {size} --format msh,geo,vtu,k,inp,rad --out mesh -v"
    )
    out = succeed(line)
    folder = tmp_path / "mesh"
    decks = "patch.geo patch.inp patch.k patch.msh patch.png patch.vtu patch_0000.rad"
    assert names(folder) == f"mesh.json {decks} quality.png"
    facts = table_of(folder, "mesh.json")
    assert facts["domain"] == "2 warp x 3 weft yarns"
    assert facts["hexahedra"] == 2 * 3 * 8 * 2 * 2 * 1
    assert "solved: " in facts["sections"]
    state = "apart by at least" if facts["least_gap_m"] > 0 else "overlap by up to"
    assert f"facets of the mesh      {state} {1e6 * abs(facts['least_gap_m']):.2f} um" in out
    assert "*ELEMENT_SHELL" in (folder / "patch.k").read_text()
