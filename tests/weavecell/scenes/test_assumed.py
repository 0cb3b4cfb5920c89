"""A fabric file with what a data sheet gives: what is assumed is printed, recorded and shown; else one line."""

import json
import shutil
from pathlib import Path

import pytest

from fabrics import assumed, catalogue
from fabrics.errors import InputError
from weavecell.commands import calibrate

EXAMPLES = Path(__file__).parents[3] / "examples"
MINE = EXAMPLES / "fabrics" / "mine.toml"
SHEAR = "assumed: [shear] of S-720, because mine gives none"
SOLID = "assumed: [solid] of S-720, because mine gives none"


def own(folder, law='law = { a = "0.04 mm", b = "0.05 mm N^(1/3)" }'):
    """examples/own-fabric.toml on a small panel for a short time, with a fabric file that may be changed."""
    (folder / "fabrics").mkdir()
    shutil.copy(MINE, folder / "fabrics")
    text = (EXAMPLES / "own-fabric.toml").read_text().replace('"150 mm"', '"26 mm"').replace('"600 us"', '"12 us"')
    text = text.replace("elements_per_crossover = 2", 'outputs = ["report"]\ncheckpoint_interval = "10 us"')
    text = text.replace('law = { a = "0.04 mm", b = "0.05 mm N^(1/3)" }', law)
    (folder / "own.toml").write_text(text)
    return folder / "own.toml"


def test_the_example_of_a_fabric_of_ones_own_runs(command, tmp_path):
    code, out, err = command("impact", own(tmp_path), "--out", "r")
    assert code == 0, err
    assert out.splitlines()[0] == SHEAR
    told = json.loads((tmp_path / "r/summary.json").read_text())
    assert told["provenance"]["assumed"] == SHEAR
    energies = told["energies_at_end_J"]
    assert energies["shear"] > 0  # the assumed law is in force
    assert sum(energies.values()) - 2 * energies["error"] == pytest.approx(told["strike_energy_J"], rel=1e-9)
    page = (tmp_path / "r/report.html").read_text()
    row = page[page.index("shear.G1") :]
    row = row[: row.index("</tr>")]
    assert "9.67 MPa" in row
    assert "assumed" in row
    assert "as S-720, thesis Table 4-1" in row


def test_nothing_is_assumed_of_what_is_given(command, tmp_path):
    path = own(tmp_path)
    with (tmp_path / "fabrics/mine.toml").open("a") as file:
        file.write('\n[shear]\nG1 = "10 MPa"\nG2 = "10 GPa"\ngamma1 = 0.2\ngamma2 = 0.5\n')
    code, out, err = command("impact", path, "--out", "r")
    assert code == 0, err
    assert "assumed" not in out
    assert "assumed" not in json.loads((tmp_path / "r/summary.json").read_text())["provenance"]


@pytest.mark.parametrize(
    ("old", "new", "quantity"),
    [
        ('"1.44 g/cm^3"', '"2.56 g/cm^3"', "fibre_density is 1380 to 1480 kg/m^3"),  # glass
        ('"1.44 g/cm^3"', '"0.97 g/cm^3"', "fibre_density is 1380 to 1480 kg/m^3"),  # polyethylene
        ('"90 GPa"', '"20 GPa"', "modulus is 60 to 145 GPa"),
    ],
)
def test_other_yarns_are_one_line(command, tmp_path, old, new, quantity):
    path = own(tmp_path)
    file = tmp_path / "fabrics/mine.toml"
    file.write_text(file.read_text().replace(old, new, 1))  # the warp alone
    told = "assumed for para-aramid yarns alone, whose " + quantity
    code, out, err = command("impact", path, "--out", "r")
    assert (code, out) == (2, "")
    needs = "fabric mine has no [shear] table; must be given, with G1, G2, gamma1 and gamma2"
    assert err == f"error: {path}: {needs}: it is {told}\n"
    code, out, err = command("mesh", file, "--out", "r")
    assert (code, out) == (2, "")
    assert err.startswith(f"error: FABRIC = '{file}': fabric mine has no [solid] table; must be given, with E_a,")
    assert told in err
    assert not (tmp_path / "r").exists()


def test_the_values_are_those_of_the_catalogue():
    """Numbers of assumed.toml against the file that they are taken from."""
    given, found = catalogue.load("S-720"), assumed.with_solid_laws(assumed.with_shear(catalogue.load(MINE)))
    assert (found.shear, found.solid_laws) == (given.shear, given.solid_laws)
    assert found.assumed == ("shear", "solid")
    added = {key: entry["status"] for key, entry in found.sources.items() if key.startswith(("shear", "solid"))}
    assert len(added) == 16
    assert set(added.values()) == {"assumed"}
    assert assumed.with_shear(given) is given
    assert assumed.with_solid_laws(given) is given
    with pytest.raises(InputError, match="no \\[shear\\] table"):
        assumed.with_shear(catalogue.load("glass-balanced"))


def test_the_calibration_of_it_is_set_up(command, tmp_path, monkeypatch):
    """Its crossover is meshed with its overlap solved, and its 3D model can be put together."""
    pytest.importorskip("dolfinx")
    from unitcell3d.model import crossover as model_crossover

    built, solved = calibrate.mesh.build, {}

    def stop(fabric, out, **choices):
        solved["model"] = model_crossover.CrossoverModel(built(fabric, size="coarse", domain="whole"), fabric)
        raise InputError("enough")

    monkeypatch.setattr(calibrate, "calibrate", stop)
    monkeypatch.setattr(calibrate.mesh, "write", lambda *_, **__: None)
    code, out, err = command("calibrate", MINE, "--mesh", "coarse", "--out", "r")
    assert (code, err.splitlines()[-1]) == (2, "error: enough")
    assert out.splitlines()[0] == SOLID
    assert solved["model"] is not None


def test_a_coupon_of_glass_says_that_it_has_no_shear_stiffness(command, tmp_path):
    text = '[fabric]\nname = "glass-balanced"\n[TEST]\n[run]\nsteps = 1\noutputs = []\n'
    path = tmp_path / "scene.toml"
    path.write_text(text.replace("[TEST]", '[picture_frame]\nshear_angle = "5 deg"\ncrossovers = 2'))
    code, out, err = command("coupon", path, "--out", "r")
    assert (code, out) == (2, "")
    assert "fabric glass-balanced has no [shear] table" in err
    path.write_text(text.replace("[TEST]", '[biaxial]\nstrain = ["0.2 %", "0.2 %"]\ncentre = 2\narm = 1'))
    code, out, err = command("coupon", path, "--out", "r")
    assert code == 0, err
    assert out.splitlines()[0] == "no [shear] of glass-balanced: its cloth has no shear stiffness"


@pytest.mark.parametrize("model", ["incompressible", "decoupled"])
def test_yarns_that_are_not_compressed_need_no_law(command, tmp_path, model):
    path = own(tmp_path, law=f'cell_model = "{model}"')
    code, _, err = command("impact", path, "--out", "r")
    assert code == 0, err
    told = json.loads((tmp_path / "r/summary.json").read_text())
    assert told["law_name"] == f"none, {model} yarns"


def test_compressible_yarns_need_one(command, tmp_path):
    code, _, err = command("impact", own(tmp_path, law=""), "--out", "r")
    assert code == 2
    assert "fabric mine has no published law; calibrate one or give a and b" in err
    assert not (tmp_path / "r").exists()
