"""`weavecell fit`: numbers of a fabric and of an input file from measured curves."""

import json
import shutil
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from shellfabric.impact import simulation
from tests.scene_text import impact_scene
from weavecell.analysis.uncertainty import inputs

OWN = Path(__file__).parents[1] / "own_fabrics" / "twaron-930.toml"
STRIP = """
[fabric]
name = "S-720"
[uniaxial]
direction = "warp"
length = "20 mm"
width = "8 mm"
strain = "2 %"
failure = false
[run]
steps = 6
"""
CURVE = "strain of the strip [%], load [N]\n0.5, 20\n1.0, 60\n1.5, 160\n2.0, 330\n"
SHOT = impact_scene("90 m/s", "50 mm", "100 us", head="# of the laboratory")


def radar(changes):
    """Text of a curve of the shot of SHOT with another fabric."""
    setup = wc.setup("S-720", "90 m/s", opening="50 mm", end_time="100 us")
    result = simulation.run(inputs.changed_setup(setup, **changes))
    rows = [(t, np.interp(t, result.t, result.v)) for t in np.linspace(2e-6, 98e-6, 40)]
    return "time [us], velocity [m/s]\n" + "".join(f"{1e6 * t:.3f}, {v:.5f}\n" for t, v in rows)


@pytest.fixture
def files(tmp_path):
    (tmp_path / "shot.toml").write_text(SHOT)
    (tmp_path / "strip.toml").write_text(STRIP)
    (tmp_path / "curve.csv").write_text(CURVE)
    (tmp_path / "radar.csv").write_text("time [us], velocity [m/s]\n10, 89\n50, 82\n90, 71\n")
    return tmp_path


def test_the_modulus_of_a_shot_is_found_and_the_written_files_give_its_curve(command, files):
    (files / "radar.csv").write_text(radar({"modulus": 0.9}))
    code, out, err = command("fit", "shot.toml", "radar.csv", "--free", "modulus", "--jobs", 1, "--out", "r")
    assert code == 0, err
    told = json.loads((files / "r" / "fit.json").read_text())
    assert told["parameters"]["modulus"]["value"] == pytest.approx(0.9, rel=0.01)
    assert told["rms"] < 1e-3 < told["rms_before"]
    assert f"modulus                     x {told['parameters']['modulus']['value']:.4g} (" in out
    fitted, plain = catalogue.read(files / "r" / "fabric.toml"), catalogue.load("S-720")
    assert fitted.weave.warp.E == pytest.approx(told["parameters"]["modulus"]["value"] * plain.weave.warp.E, rel=1e-5)
    assert fitted.sources["warp.modulus"]["status"] == "fitted"
    assert fitted.weave.warp.crimp == plain.weave.warp.crimp
    assert "# of the laboratory" in (files / "r" / "fitted.toml").read_text()
    shot = wc.shoot(files / "r" / "fabric.toml", "90 m/s", opening="50 mm", end_time="100 us")
    rows = np.loadtxt(files / "r" / "fit.csv", delimiter=",", skiprows=1, usecols=(0, 2, 3, 4))
    again = np.interp(rows[:, 0], *shot.to_dataframe()[["time_s", "velocity_m_s"]].to_numpy().T)
    assert again == pytest.approx(rows[:, 3], rel=2e-4)
    code, again, _ = command(
        "fit", "shot.toml", "radar.csv", "--free", "modulus", "--jobs", 1, "--out", "r", "--resume"
    )
    assert code == 0
    assert again == out


def test_a_key_of_a_shot_is_fitted_to_residual_velocities(command, files):
    (files / "tests.csv").write_text("velocity [m/s], outcome, residual velocity [m/s]\n90, CP, 71\n120, CP, 108\n")
    words = ("fit", "shot.toml", "tests.csv", "--free", "projectile.mass", "--jobs", 1, "--out", "r")
    code, _out, err = command(*words)
    assert code == 0, err
    table = tomllib.loads((files / "r" / "fitted.toml").read_text())
    told = json.loads((files / "r" / "fit.json").read_text())["parameters"]["projectile.mass"]
    assert float(table["projectile"]["mass"].split()[0]) == pytest.approx(told["value"])
    assert table["fabric"] == {"name": "S-720"}
    assert not (files / "r" / "fabric.toml").exists()


def test_the_crimp_of_a_strip_is_found(command, files):
    fabric = inputs.changed(wc.fabric("S-720"), crimp_warp=0.9)
    size = {"length": 0.02, "width": 0.008, "strain": 0.02, "failure": False, "steps": 6}
    record = wc.coupon(fabric, "uniaxial", direction="warp", **size).record
    rows = zip(record.prescribed, record.measures["load"][1])
    (files / "curve.csv").write_text(
        "strain of the strip [%], load [N]\n" + "".join(f"{100 * x}, {y}\n" for x, y in rows)
    )
    code, _, err = command("fit", "strip.toml", "curve.csv", "--free", "crimp_warp", "--jobs", 1, "--out", "r")
    assert code == 0, err
    told = json.loads((files / "r" / "fit.json").read_text())
    assert told["parameters"]["crimp_warp"]["value"] == pytest.approx(0.9, rel=0.01)
    assert told["rms"] < 2e-3 < told["rms_before"]


def test_platens_give_a_fabric_file_with_the_fitted_solids(command, files, monkeypatch):
    """The fit itself is that of `weavecell calibrate --platen-curve`; here it is another fabric."""
    from fabrics import variants
    from weavecell.commands import calibrate_solid

    def fitted(fabric, curve, out, *, resume):
        return SimpleNamespace(fabric=variants.with_solids(fabric, E_c=3e7, V_c=1.1, K_r=0.03))

    page = SimpleNamespace(figures=[SimpleNamespace(content=b"<svg/>")])
    monkeypatch.setattr(calibrate_solid, "fit", fitted)
    monkeypatch.setattr(calibrate_solid, "chapter", lambda found, around: page)
    rows = "".join(f"{p}, {t}\n" for p, t in ((0.1, 0.3), (0.5, 0.28), (1, 0.27), (5, 0.25), (10, 0.24)))
    (files / "platens.csv").write_text("pressure [MPa], thickness [mm]\n" + rows)
    for name in ("S-728", files / "twaron.toml"):
        shutil.copy(OWN, files / "twaron.toml")
        code, _, err = command("fit", name, "platens.csv", "--out", "r")
        assert code == 0, err
        made = catalogue.read(files / "r" / "fabric.toml")
        assert [law.E_c for law in made.solid_laws] == [3e7, 3e7]
        assert made.solid_laws[0].V_c == pytest.approx(1.1)
        assert made.sources["solid.warp.E_c"]["status"] == "fitted"
    assert made.sources["solid.warp.E_a"]["status"] == "assumed"
