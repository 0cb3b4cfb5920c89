"""`weavecell fabrics new`: a fabric file from prompts or a CSV file, curves fitted, every number with its source."""

import numpy as np
import pytest
from typer.testing import CliRunner

from fabrics import catalogue
from fabrics.base import door
from fabrics.data_sheet import OF_SHOTS
from fabrics.trellis import TrellisShear
from weavecell.cli import app

VALUES = """key,warp,weft,source
linear_density,1100 dtex,1100 dtex,data sheet
fibre_density,1.44 g/cm^3,,data sheet
modulus,90 GPa,90 GPa,data sheet
failure_strain,3.3 %,3.3 %,data sheet
crimp,1.2 %,0.8 %,"measured, own"
count,8.5 / cm,8.5 / cm,data sheet
"""
EA = 90e9 * 1.1e-4 / 1440


@pytest.fixture
def values(tmp_path):
    path = tmp_path / "values.csv"
    path.write_text(VALUES)
    return path


@pytest.fixture
def made(succeed, tmp_path, values):
    """A function that makes mine.toml of the values: what is printed, and the fabric of the file."""

    def make(*options):
        out = succeed("fabrics", "new", "mine.toml", "--from", values, *options)
        return out, catalogue.load(tmp_path / "mine.toml")

    return make


def test_from_a_csv_file(made):
    out, fabric = made()
    assert fabric.name == "mine"
    assert [yarn.crimp for yarn in fabric.weave.yarns] == pytest.approx([0.012, 0.008])
    assert fabric.weave.warp.EA == pytest.approx(EA)
    assert fabric.sources["warp.crimp"] == {
        "value": "1.2 %",
        "source": "measured, own",
        "status": "user",
    }
    assert "assumed: [shear] of para-aramid yarns" in out
    assert "assumed: [solid] of para-aramid yarns" in out


@pytest.mark.parametrize("family", [[], ["--family", "para-aramid"]])
def test_the_last_lines_say_what_is_missing_of_a_yarn_of_no_family(succeed, values, family):
    values.write_text(VALUES.replace("1.44", "1.9").replace("90 GPa", "30 GPa"))
    out = succeed("fabrics", "new", "pbo.toml", "--from", values, *family)
    lines = out.partition("written to pbo.toml\n")[2].splitlines()
    assert (
        lines.pop() == "missing: the compression law, which `weavecell calibrate pbo.toml` computes"
    )
    assert [line[:35] for line in lines] == ["missing: fabric pbo has no [shear] "][: not family]
    assert ("with wider ranges for another fibre" in out) == bool(family)


def prompted(tmp_path, typed):
    """The fabric of the lines that are typed at the prompts."""
    words = ["fabrics", "new", str(tmp_path / "own.toml")]
    with door.open_terminal():
        done = CliRunner().invoke(app.program(), words, input=typed)
    assert done.exit_code == 0, done.output
    return catalogue.load(tmp_path / "own.toml")


TYPED = """data sheet
930 dtex

1.44 g/cm^3

95 GPa


2350 mN/tex


0.30 mm
11 / cm

"""


def test_prompts_that_are_left_empty_ask_for_thickness_and_tenacity(tmp_path):
    fabric = prompted(tmp_path, TYPED)
    assert fabric.assumed == ("crimp", "failure_length", "weave", *OF_SHOTS)
    assert fabric.weave.warp.strength == pytest.approx(218.55)


TYPED_AGAIN = """data sheet
1100 mm
1100 dtex

1.44 g/cm^3

90 GPa

0.033

1.2 %
0.8 %
8.5 / cm

"""


def test_a_wrong_unit_is_asked_for_again_and_an_empty_line_takes_the_value_of_the_warp(tmp_path):
    fabric = prompted(tmp_path, TYPED_AGAIN)
    assert fabric.weave.weft.failure_strain == pytest.approx(0.033)
    assert fabric.weave.weft.crimp == pytest.approx(0.008)


SHEET = """key,warp,weft,source
linear_density,930 dtex,,data sheet
fibre_density,1.44 g/cm^3,,data sheet
modulus,95 GPa,,data sheet
tenacity,2350 mN/tex,,data sheet
failure_strain,3.3 %,,data sheet
count,11 / cm,,data sheet
thickness,0.30 mm,,data sheet
failure_length,1.0 mm,,punch test
areal_density,205 g/m^2,,data sheet
"""


def test_numbers_of_a_data_sheet_are_enough(succeed, made, values):
    values.write_text(SHEET)
    out, fabric = made()
    assert fabric.weave.thickness == pytest.approx(0.30e-3)
    assert fabric.sources["thickness"]["source"] == "data sheet"
    assert fabric.failure_length == pytest.approx(1e-3)
    assert fabric.sources["failure_length"]["source"] == "punch test"
    told = out.splitlines()
    assert told[0].startswith("note: warp and weft: the strength 2350 mN/tex is 218.6 N a yarn; ")
    assert told[1].startswith("note: counts, linear densities and crimp give 208.2 g/m^2")
    assert told[2].startswith("assumed: crimp 2.62 / 0.91 % of warp / weft (")
    out = succeed("show", "mine.toml")
    for word in ("warp share", "shear.K_s", "solid.E_c", "interlayer_gap", "section"):
        assert word in out[out.index("what is assumed") : out.index("where each number comes from")]


def test_a_tensile_curve_replaces_modulus_and_failure_strain(made, tmp_path):
    """A straight yarn of known stiffness, with a slack of 0.2 % and noise of 1 %."""
    strain = np.linspace(0, 0.032, 40)
    force = np.maximum(EA * (strain - 0.002), 0) * (1 + 0.01 * np.sin(50 * np.arange(40)))
    rows = "\n".join(f"{100 * e},{f}" for e, f in zip(strain, force))
    (tmp_path / "yarn.csv").write_text(f"strain [%], force [N]\n{rows}\n")
    out, fabric = made("--yarn-curve", "yarn.csv")
    assert fabric.weave.warp.EA == pytest.approx(EA, rel=0.02)
    assert fabric.weave.warp.failure_strain == pytest.approx(0.030, rel=0.03)
    assert fabric.sources["weft.modulus"]["status"] == "fitted"
    assert "yarn.csv" in fabric.sources["weft.modulus"]["source"]
    assert out.startswith("fitted: modulus ")


@pytest.mark.parametrize("door", ["frame", "strip"])
def test_a_curve_of_shear_replaces_the_trellis_law(command, made, tmp_path, values, door):
    """Doors of the readers that test_curves.py proves: the law reaches the file, with its source."""
    known = TrellisShear(5e4, 5e5, 0.35, 0.8)
    if door == "frame":
        gamma = np.linspace(0, 1.0, 60)
        rows = zip(gamma, known.stress(gamma))
        words = ["--picture-frame", "curve.csv"]
        heading = "shear angle [rad], shear stress [Pa]"
    else:
        # torque of both zones at a few angles, with a thickness of the fabric that the file gives
        command("fabrics", "new", "bare.toml", "--from", values)
        thickness = catalogue.load(tmp_path / "bare.toml").weave.thickness
        gamma = np.linspace(0.02, 1.0, 60)
        torque = 200 * known.stress(gamma) + 100 * known.stress(0.5 * gamma)
        force = 1e-3 * torque * thickness / (1.5 * (np.cos(0.5 * gamma) - np.sin(0.5 * gamma)))
        rows = zip(150 * (np.sqrt(1 + np.sin(gamma)) - 1), force)
        words = ["--bias-extension", "curve.csv", "--strip", "100 mm, 250 mm"]
        heading = "displacement [mm], force [N]"
    lines = [heading, *(f"{first},{second}" for first, second in rows)]
    (tmp_path / "curve.csv").write_text("\n".join(lines) + "\n")
    out, fabric = made(*words)
    assert vars(fabric.shear) == pytest.approx(vars(known), rel=0.02)
    assert fabric.sources["shear.G1"]["status"] == "fitted"
    assert "assumed: [shear]" not in out
