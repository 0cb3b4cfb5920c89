"""Fabric files with the numbers of data sheets: crimp, strength, mass."""

import pickle
from pathlib import Path

import numpy as np
import pytest

from fabrics import assumed, catalogue, data_sheet, variants
from fabrics.base.errors import InputError, InputErrors
from fabrics.base.units import si
from fabrics.fabric_tables import OF_FABRIC, OF_YARN

FOLDER = Path(__file__).parents[1] / "weavecell" / "own_fabrics"
OWN = sorted(FOLDER.glob("*.toml"))
TWARON = (FOLDER / "twaron-930.toml").read_text()
YARN_930 = 930e-7 * 2350e3  # [N] 930 dtex at 2350 mN/tex


def load(tmp_path, text):
    path = tmp_path / "own.toml"
    path.write_text(text)
    return catalogue.load(path)


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.stem)
def test_crimp_gives_the_thickness_back(path):
    """2 (h1 + h2) is the thickness of the file, the warp has its share of the heights, and the mass is as stated."""
    fabric = catalogue.load(path)
    assert fabric.weave.thickness == pytest.approx(fabric.thickness, rel=1e-9)
    assert fabric.weave.h01 / sum(fabric.weave.h0) == pytest.approx(
        data_sheet.entries()["warp_share"].value
    )
    assert fabric.assumed == ("crimp", "failure_length", "weave", *data_sheet.OF_SHOTS)
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
    assert fabric.name == "own"
    assert fabric.laws is None
    assert fabric.weave.warp.crimp == 0.01
    assert fabric.sources["warp.crimp"]["status"] == "user"
    assert fabric.weave.thickness == pytest.approx(0.3e-3)
    assert list(assumed.crimp_ends(fabric)) == ["thickness times 0.9", "thickness times 1.1"]
    assert all(end.weave.warp.crimp == 0.01 for end in assumed.crimp_ends(fabric).values())


def test_ends_of_the_crimp_are_those_of_thickness_and_share():
    fabric = assumed.with_shear(catalogue.load(FOLDER / "twaron-930.toml"))
    ends = assumed.crimp_ends(fabric)
    assert [end.weave.thickness for end in ends.values()] == pytest.approx(
        [0.27e-3, 0.33e-3, 0.3e-3, 0.3e-3]
    )
    assert ends["warp share 0.5"].weave.h01 == pytest.approx(ends["warp share 0.5"].weave.h02)
    thin, thick = list(ends.values())[:2]
    assert thin.shear.G2 > fabric.shear.G2 > thick.shear.G2  # the assumed trellis law follows
    assert assumed.crimp_ends(catalogue.load("S-720")) == {}


def test_the_assumed_failure_length_is_within_one_yarn_spacing_of_every_fabric():
    length = data_sheet.entries()["failure_length"]
    for name in catalogue.list_names():
        fabric = catalogue.load(name)
        assert length.value == fabric.failure_length <= 2 * min(fabric.weave.w)
        assert fabric.assumed == ("failure_length",)
        entry = fabric.sources["failure_length"]
        assert entry["value"] == "0.75 mm (0.375 mm .. 1.5 mm)"
        assert entry["status"] == "assumed"
        assert assumed.lines(fabric) == [
            f"assumed: failure length {length.written}, because {name} gives none"
        ]
    ends = [ratio * fabric.failure_length for ratio in assumed.range_of_failure_length(fabric)]
    assert ends == [length.low, length.high]


def test_a_failure_length_that_is_given_is_not_assumed(tmp_path):
    fabric = load(
        tmp_path,
        TWARON.replace(
            "[warp]", 'failure_length = { value = "1.2 mm", source = "a test" }\n[warp]'
        ),
    )
    assert (
        fabric.failure_length == variants.rotated_90(fabric).failure_length == pytest.approx(1.2e-3)
    )
    assert fabric.sources["failure_length"] == {
        "value": "1.2 mm",
        "source": "a test",
        "status": "user",
    }
    assert fabric.assumed == ("crimp", "weave", *data_sheet.OF_SHOTS)
    assert assumed.range_of_failure_length(fabric) is None


def test_examples_and_published_fabrics_are_within_the_bounds():
    for quantity in (OF_YARN | OF_FABRIC).values():
        assert quantity.read(quantity.example)[1] in quantity.bounds
        assert all(low < high for low, high in map(quantity.limits, quantity.bounds))
    for path in Path(__file__).parents[2].glob("validation/measured/inputs/fabrics/*.toml"):
        catalogue.load(path)


@pytest.mark.parametrize(
    "line",
    [
        'tenacity = "2350 mN/tex"',
        'tenacity = "23.5 cN/dtex"',
        'tenacity = "26.6259 g/den"',
        'strength = "218.55 N"',
        'strength = "3384 MPa"',
    ],
)
def test_strength_in_the_units_of_data_sheets(tmp_path, line):
    fabric = load(tmp_path, TWARON.replace('tenacity = "2350 mN/tex"', line))
    assert fabric.weave.warp.strength == pytest.approx(YARN_930, rel=1e-5)
    found = [note for note in fabric.notes if "strength" in note]
    assert len(found) == 1
    assert found[0].startswith("note: warp and weft: the strength ")
    assert "gives 202.5 N (-7.4 %)" in found[0]


def test_strength_needs_no_failure_strain_and_a_modulus_may_be_a_specific_stress():
    """UHMWPE of 1760 dtex, 1150 and 35 cN/dtex."""
    fabric = catalogue.load(FOLDER / "uhmwpe-1760.toml")
    yarn = fabric.weave.warp
    assert yarn.E == pytest.approx(1150e5 * 970)
    assert yarn.failure_strain == pytest.approx(35 / 1150)
    assert not any("strength" in note for note in fabric.notes)


def test_thickness_and_areal_density_are_compared_with_what_follows_from_crimp_and_count(tmp_path):
    fabric = load(tmp_path, TWARON.replace("count", 'crimp = "2 %"\ncount'))
    assert fabric.assumed == ("failure_length", "weave", *data_sheet.OF_SHOTS)
    assert (
        "note: the crimps give a thickness of 0.330 mm, the file states 0.3 mm; the crimps are used"
        in fabric.notes
    )
    assert any(
        "give 208.2 g/m^2, +1.6 % of the stated 205 g/m^2" in note
        for note in load(tmp_path, TWARON).notes
    )


def test_several_errors_survive_a_process():
    errors = InputErrors([InputError("first", file="a", key="b"), InputError("second")])
    assert str(pickle.loads(pickle.dumps(errors))) == str(errors) == "a: b: first\nsecond"
    assert pickle.loads(pickle.dumps(errors)).key == "b"
