"""A law.json that was fitted to another state of a fabric file is used, and the change is told."""

import logging
import tomllib
from pathlib import Path

import pytest

from fabrics import assumed, catalogue, ply_laws
from fabrics.compression import CompressionLaw
from fabrics.variants import as_written, data_digest, with_linear_density
from meshing.mesh_plan import with_room
from tests.scene_text import merged, toml
from weavecell.scenes import build

BASES = tomllib.loads((Path(__file__).parents[2] / "refusals" / "bases.toml").read_text())
SHEET = BASES["sheet"] | {"name": "mine"}
CHANGES = tomllib.loads("""
crimp = { warp.crimp = "1.5 %", weft.crimp = "1.6 %" }
modulus = { warp.modulus = "99 GPa" }
strength = { weft.tenacity = "2300 mN/tex" }
width = { warp.width = "0.8 mm" }
section = { section = "ellipse" }
""")


def fabric_of(change):
    return catalogue.read("mine.toml", toml(merged(SHEET, change)))


def law_of(folder, fabric):
    law = CompressionLaw(4e-5, 5e-5, fabric=fabric.name, fitted_data=data_digest(fabric))
    law.to_json(folder / "law.json")
    assert CompressionLaw.from_json(folder / "law.json") == law
    return folder / "law.json"


@pytest.mark.parametrize("change", CHANGES)
def test_what_a_law_was_fitted_to_is_compared(tmp_path, caplog, change):
    path = law_of(tmp_path, fabric_of({}))
    with caplog.at_level(logging.WARNING, "weavecell"):
        build.laws_of(fabric_of({}), path)
        assert not caplog.records
        build.laws_of(fabric_of(CHANGES[change]), path)
    assert f"{path} was fitted to other data of mine than it has now" in caplog.text


def test_a_contact_law_of_plies_that_was_fitted_to_other_data_is_told(tmp_path, caplog):
    first = fabric_of({})
    changed = fabric_of(CHANGES["modulus"])
    law = CompressionLaw(4e-5, 5e-5, fabric=first.name, fitted_data=data_digest(first))
    path = tmp_path / "law.json"
    law.to_json(path, ply_laws.solid_fibre(first))
    with caplog.at_level(logging.WARNING, "weavecell"):
        build._with_ply_contact(first, path, None)
        build._with_ply_contact(changed, "solid", None)
        assert not caplog.records
        build._with_ply_contact(changed, path, None)
    assert f"{path} was fitted to other data of mine than it has now" in caplog.text


def test_what_no_law_is_computed_from_does_not_count():
    """Trellis and areal density; and either linear density of a fabric that has two."""
    digest = data_digest(fabric_of({}))
    assert data_digest(fabric_of({"areal_density": "210 g/m^2"})) == digest
    trellis = {"G1": "10 MPa", "G2": "10 GPa", "gamma1": "0.24", "gamma2": "0.49"}
    assert data_digest(fabric_of({"shear": trellis})) == digest
    fabric = catalogue.load("S-720")
    assert data_digest(fabric) == data_digest(with_linear_density(fabric, "effective"))


@pytest.mark.slow(20)
def test_a_fabric_that_needs_more_room_in_3d_keeps_its_law_and_its_crimp(tmp_path, caplog):
    yarn = SHEET["warp"] | {"linear_density": "600 denier", "count": "34 / inch"}
    sheet = SHEET | {"thickness": "8 mil", "areal_density": "180 g/m^2", "warp": yarn, "weft": yarn}
    tight = catalogue.read("mine.toml", toml(sheet))
    thicker = with_room(assumed.with_solid_laws(tight))
    assert thicker.weave.warp.crimp > tight.weave.warp.crimp
    assert as_written(thicker).weave == tight.weave
    with caplog.at_level(logging.WARNING, "weavecell"):
        build.laws_of(tight, law_of(tmp_path, thicker))
    assert not caplog.records
