"""Fabric files with the numbers of data sheets: crimp, strength, mass; and all that is wrong, told at once."""

from pathlib import Path

import numpy as np
import pytest

from fabrics import assumed, catalogue, data_sheet
from fabrics.errors import InputError, InputErrors
from fabrics.units import si

FOLDER = Path(__file__).parents[1] / "weavecell" / "own_fabrics"
OWN = sorted(FOLDER.glob("*.toml"))
TWARON = (FOLDER / "twaron-930.toml").read_text()
YARN_930 = 930e-7 * 2350e3  # [N] 930 dtex at 2350 mN/tex


def load(tmp_path, text):
    path = tmp_path / "own.toml"
    path.write_text(text)
    return catalogue.load(path)


def refused(tmp_path, text):
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    return str(caught.value).splitlines()


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.stem)
def test_crimp_gives_the_thickness_back(path):
    """2 (h1 + h2) is the thickness of the file, the warp has its share of the heights, and the mass is as stated."""
    fabric = catalogue.load(path)
    assert fabric.weave.thickness == pytest.approx(fabric.thickness, rel=1e-9)
    assert fabric.weave.h01 / sum(fabric.weave.h0) == pytest.approx(data_sheet.entries()["warp_share"].value)
    assert fabric.assumed == ("crimp",)
    assert fabric.sources["warp.crimp"]["status"] == "derived"
    stated = si(fabric.sources["areal_density"]["value"], "kg/m^2")
    assert fabric.weave.areal_density == pytest.approx(stated, rel=0.02)


def test_the_warp_share_is_the_mean_of_the_catalogue_and_its_range_encloses_it():
    shares = [f.weave.h01 / sum(f.weave.h0) for f in map(catalogue.load, catalogue.list_names())]
    entry = data_sheet.entries()["warp_share"]
    assert entry.value == pytest.approx(np.mean(shares), abs=0.005)
    assert entry.low - 1e-9 <= min(shares) <= max(shares) <= entry.high


def test_a_crimp_that_is_given_leaves_the_rest_to_the_other(tmp_path):
    fabric = load(tmp_path, TWARON.replace("count", 'crimp = "1.0 %"\ncount', 1))
    assert fabric.weave.warp.crimp == 0.01
    assert fabric.weave.thickness == pytest.approx(0.3e-3)
    assert list(assumed.crimp_ends(fabric)) == ["thickness times 0.9", "thickness times 1.1"]
    assert all(end.weave.warp.crimp == 0.01 for end in assumed.crimp_ends(fabric).values())
    high = refused(tmp_path, TWARON.replace("count", 'crimp = "9 %"\ncount', 1))
    assert len(high) == 1
    assert "thickness = '0.30 mm': must be above" in high[0]


def test_ends_of_the_crimp_are_those_of_thickness_and_share():
    fabric = assumed.with_shear(catalogue.load(FOLDER / "twaron-930.toml"))
    ends = assumed.crimp_ends(fabric)
    assert [end.weave.thickness for end in ends.values()] == pytest.approx([0.27e-3, 0.33e-3, 0.3e-3, 0.3e-3])
    assert ends["warp share 0.5"].weave.h01 == pytest.approx(ends["warp share 0.5"].weave.h02)
    thin, thick = list(ends.values())[:2]
    assert thin.shear.G2 > fabric.shear.G2 > thick.shear.G2  # the assumed trellis law follows
    assert assumed.crimp_ends(catalogue.load("S-720")) == {}


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("0.30 mm", "0.30 m", "thickness = '0.30 m': must be from 0.02 to 5 mm"),
        ("0.30 mm", "3.0 mm", "thickness = '3.0 mm': must be one that gives a crimp from 0 to 50 % at these"),
        ("0.30 mm", "0.15 mm", "thickness = '0.15 mm': must be at least 0.157 mm, which the closest packed fibres of"),
        ("95 GPa", "95 MPa", "warp.modulus = '95 MPa': must be from 1 to 1000 GPa"),
        ("95 GPa", "950 N/tex", "warp.modulus = '950 N/tex': must be from 0.5 to 500 N/tex"),
        ("95 GPa", "1.5 GPa", "warp.tenacity = '2350 mN/tex': must be a strength that this modulus reaches at a strain "
         "from 0.1 to 50 %, not 226 %"),
        ("2350 mN/tex", "2350 N/tex", "warp.tenacity = '2350 N/tex': must be from 0.05 to 10 N/tex"),
        ('"930 dtex"', '"930 kg/m"', "warp.linear_density = '930 kg/m': must be from 5 to 100000 dtex"),
        ("1.44 g/cm^3", "1.44 kg/m3", "warp.fibre_density = '1.44 kg/m3': must be from 0.5 to 23 g/cm^3"),
        ('"3.3 %"', "3.3", "warp.failure_strain = 3.3: must be from 0.1 to 50 %"),
        ("11 / cm", "11 / m", "warp.count = '11 / m': must be from 0.5 to 100 / cm"),
        ("205 g/m^2", "205 kg/m2", "areal_density = '205 kg/m2': must be from 5 to 5000 g/m^2"),
        ('thickness =', 'interlayer_gap = "0.1 m"\nthickness =', "interlayer_gap = '0.1 m': must be from 0 to 5 mm"),
        ("count", 'width = "1.1 m"\ncount', "warp.width = '1.1 m': must be from 0.02 to 20 mm"),
        ("count", 'crimp = 1.2\ncount', "warp.crimp = 1.2: must be from 0 to 50 %"),
    ],
)  # fmt: skip
def test_the_key_that_was_given_is_named(tmp_path, old, new, line):
    (found,) = refused(tmp_path, TWARON.replace(old, new, 1))
    assert found.startswith(f"{tmp_path}/own.toml: {line}")


def test_examples_and_published_fabrics_are_within_the_bounds():
    for quantity in data_sheet.QUANTITIES.values():
        assert quantity.read(quantity.example)[1] in quantity.bounds
        assert all(low < high for low, high in map(quantity.limits, quantity.bounds))
    for path in Path(__file__).parents[2].glob("validation/published/measured_fabrics/*.toml"):
        catalogue.load(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [("1.44 g/cm^3", "1.44 g/cm3"), ("1.44 g/cm^3", "1440 kg/m3"), ("205 g/m^2", "205 g/m2"), ("205 g/m^2", "205 gsm"),
     ('"930 dtex"', '"837 den"'), ('"930 dtex"', '"837denier"'),
     ("11 / cm", "27.94 per inch"), ("11 / cm", "11/cm")],
)  # fmt: skip
def test_spellings_of_data_sheets(tmp_path, old, new):
    fabric, other = load(tmp_path, TWARON), load(tmp_path, TWARON.replace(old, new))
    assert other.weave.areal_density == pytest.approx(fabric.weave.areal_density)
    assert other.weave.thickness == pytest.approx(fabric.weave.thickness)
    assert other.weave.warp.strength == pytest.approx(fabric.weave.warp.strength)


@pytest.mark.parametrize(
    "line",
    ['tenacity = "2350 mN/tex"', 'tenacity = "23.5 cN/dtex"', 'tenacity = "26.6259 g/den"', 'strength = "218.55 N"',
     'strength = "3384 MPa"'],
)  # fmt: skip
def test_strength_in_the_units_of_data_sheets(tmp_path, line):
    fabric = load(tmp_path, TWARON.replace('tenacity = "2350 mN/tex"', line))
    assert fabric.weave.warp.strength == pytest.approx(YARN_930, rel=1e-5)
    found = [note for note in fabric.notes if "strength" in note]
    assert len(found) == 1
    assert found[0].startswith("note: warp and weft: the strength ")
    assert "gives 202.5 N (-7.4 %)" in found[0]


def test_strength_needs_no_failure_strain(tmp_path):
    fabric = load(tmp_path, TWARON.replace('failure_strain = "3.3 %"\n', ""))
    assert fabric.weave.weft.failure_strain == pytest.approx(YARN_930 / fabric.weave.weft.EA)
    assert not any("strength" in note for note in fabric.notes)


def test_modulus_as_a_specific_stress():
    yarn = catalogue.load(FOLDER / "uhmwpe-1760.toml").weave.warp
    assert yarn.E == pytest.approx(1150e5 * 970)


def test_areal_density_is_checked(tmp_path):
    assert any("give 208.2 g/m^2, +1.6 % of the stated 205 g/m^2" in note for note in load(tmp_path, TWARON).notes)
    line = refused(tmp_path, TWARON.replace("205 g/m^2", "250 g/m^2"))
    assert len(line) == 1
    assert "areal_density = '250 g/m^2': must be within 15 % of 208.2 g/m^2" in line[0]


def test_given_crimps_are_compared_with_the_thickness(tmp_path):
    fabric = load(tmp_path, TWARON.replace("count", 'crimp = "0.5 %"\ncount'))
    assert fabric.assumed == ()
    assert "note: the crimps give a thickness of 0.164 mm, the file states 0.3 mm; the crimps are used" in fabric.notes


def test_all_that_is_wrong_is_reported_at_once(tmp_path):
    text = TWARON
    for old, new in (
        ('thickness = "0.30 mm"', 'thicknes = "0.30 mm"'), ("205 g/m^2", "205 kg"), ('"930 dtex"', '"930 detx"'),
        ("95 GPa", "-95 GPa"), ("fibre_density", "fibre_densty"), ("2350 mN/tex", "2350 mN"),
    ):  # fmt: skip
        text = text.replace(old, new, 1)
    lines = refused(tmp_path, text)
    assert [line.split(": ")[1].split(" = ")[0] for line in lines] == [
        "thicknes", "warp.fibre_densty", "areal_density", "warp.modulus", "warp.linear_density", "warp.tenacity",
    ]  # fmt: skip
    assert all(line.startswith(f"{tmp_path}/own.toml: ") for line in lines)
    assert 'such as "1100 dtex"' in lines[4]


def test_without_crimp_and_thickness_the_message_names_both(tmp_path):
    lines = refused(tmp_path, TWARON.replace('thickness = "0.30 mm"\n', ""))
    assert [line.split(": ")[1] for line in lines] == ["warp.crimp", "weft.crimp"]
    assert 'or computed: give thickness, such as "0.3 mm", above [warp]' in lines[0]


def test_several_errors_survive_a_process():
    import pickle

    errors = InputErrors([InputError("first", file="a", key="b"), InputError("second")])
    assert str(pickle.loads(pickle.dumps(errors))) == str(errors) == "a: b: first\nsecond"
    assert pickle.loads(pickle.dumps(errors)).key == "b"
