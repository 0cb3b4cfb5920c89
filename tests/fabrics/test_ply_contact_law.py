"""Where the contact law of plies comes from: the fabric's own, solid fibre, the pressure law of packs; and files."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import assumed, catalogue, ply_laws
from fabrics.compression import CompressionLaw
from fabrics.plate_curve import PLATEN_PRESSURE, PlateCurve
from fabrics.ply_law import PlyLaw
from fabrics.ply_laws import between_plies
from fabrics.variants import rotated_90
from shellfabric.plies.gap import compression_gap, ply_gap

CSV = "# two plies\npressure [kPa], closure [um]\n0, 0\n100, 40\n2000, 90\n"


@pytest.fixture(scope="module")
def fabric():
    """S-728 with a law like the platen curve of its 3D crossover."""
    plain = catalogue.load("S-728")
    x = np.linspace(0.0, 1.0, 25)
    stiffness = ply_laws.solid_fibre(plain).stiffness
    return replace(
        plain,
        ply_contact=PlyLaw(190.6e-6 * x, PLATEN_PRESSURE * x**3, stiffness, "platens", "computed"),
    )


def test_the_fabrics_own_law_comes_first_and_then_solid_fibre(fabric):
    """E_c rho_f / areal density."""
    assert ply_laws.default(fabric).status == "computed"
    assert ply_laws.default(fabric) == fabric.ply_contact
    for name in catalogue.list_names():
        plain = catalogue.load(name)
        law = ply_laws.default(plain)
        yarn = plain.weave.warp
        assert law == ply_laws.solid_fibre(plain)
        assert law.status == "assumed"
        assert law.pressure_at(1e-6) == pytest.approx(1e-6 * law.stiffness)
        E_c = assumed.with_solid_laws(plain).solid_laws[0].E_c
        assert law.stiffness == pytest.approx(
            E_c * yarn.fibre_density / plain.weave.areal_density, rel=1e-12
        ), name


def test_pressure_law_of_packs_is_eq_5_4(fabric):
    """d_f = (d_N - d_1) / (N - 1); the pressure counts from that of 10 N."""
    law = ply_laws.of_packs(fabric)
    four, one = (PlateCurve.pressure_law(fabric.areal_density_measured, plies) for plies in (4, 1))
    for P in np.array([0.1, 1.0, 10.0]) * 1e6:
        expected = (four.at(P) - one.at(P)) / 3
        # straight between 24 pressures
        assert law.closure_at(P - one.pressure[0]) == pytest.approx(expected, rel=1e-2)
    assert law.travel == pytest.approx(compression_gap(fabric.areal_density_measured), rel=1e-12)
    assert law.pressure_at(0.0) == 0
    assert between_plies(fabric.areal_density_measured)[0][0] == pytest.approx(10 / 0.019**2)


def test_what_the_law_closes_is_not_in_the_gap_again(fabric):
    """Gap and law close together what the test of packs closes; a law that closes more leaves no gap."""
    solid = ply_laws.solid_fibre(fabric)
    packs = ply_laws.of_packs(fabric)
    assert ply_gap(fabric).value == pytest.approx(0.12e-3)
    assert ply_gap(fabric, solid).value + solid.closure_at(PLATEN_PRESSURE) == pytest.approx(
        0.12e-3
    )
    untold = replace(fabric, interlayer_gap=None)
    assert ply_gap(untold, packs).value == pytest.approx(0.0, abs=5e-9)
    assert ply_gap(fabric, fabric.ply_contact).value == 0.0  # 191 um in place of 120


def test_csv_and_law_json(tmp_path, fabric):
    """A user's columns in either order; and law.json of a calibration, which holds both laws."""
    (tmp_path / "curve.csv").write_text(CSV)
    law = ply_laws.read(tmp_path / "curve.csv", fabric)
    assert law.travel == pytest.approx(9e-5)
    assert law.pressure[-1] == pytest.approx(2e6)
    assert law.status == "user"
    CompressionLaw(4e-5, 5e-5).to_json(tmp_path / "law.json", fabric.ply_contact)
    assert ply_laws.read(tmp_path / "law.json", fabric) == fabric.ply_contact
    assert CompressionLaw.from_json(tmp_path / "law.json").a == 4e-5
    assert ply_laws.stands_in(tmp_path / "law.json")
    CompressionLaw(4e-5, 5e-5).to_json(tmp_path / "old.json")
    assert not ply_laws.stands_in(tmp_path / "old.json")


def test_table_of_a_fabric_file(tmp_path, fabric):
    """[ply_contact] as lists with units, or the name of a file beside it."""
    text = (catalogue._FOLDER / "S-728.toml").read_text().split("# Contact law of plies")[0]
    path = tmp_path / "mine.toml"
    table = '[ply_contact]\nclosure = ["0 um", "0.1 mm"]\npressure = ["0 Pa", "5 MPa"]\nsource = "test"\n'
    path.write_text(f'{text}{table}status = "measured"\n')
    mine = catalogue.read(path)
    assert mine.ply_contact.travel == 1e-4
    assert mine.ply_contact.status == "measured"
    assert mine.sources["ply_contact"]["source"] == "test"
    assert mine == catalogue.read(path)
    (tmp_path / "curve.csv").write_text(CSV)
    path.write_text(text + '[ply_contact]\nfile = "curve.csv"\n')
    assert catalogue.read(path).ply_contact.travel == pytest.approx(9e-5)


def test_between_two_fabrics_acts_half_of_each_law():
    """At any pressure the closure is half of each: plies of two fabrics press like a half ply of either, in series."""
    soft = PlyLaw(np.array([0.0, 4e-5, 6e-5]), np.array([0.0, 1e6, 5e6]), 1e12)
    stiff = PlyLaw(np.array([0.0, 1e-5]), np.array([0.0, 2e6]), 4e12)
    both = soft.between(stiff)
    for pressure in (0.0, 5e5, 1e6, 2e6, 4e6, 5e6, 8e7):
        halves = 0.5 * soft.closure_at(pressure) + 0.5 * stiff.closure_at(pressure)
        assert both.closure_at(pressure) == pytest.approx(halves, rel=1e-12, abs=1e-18)
    assert soft.between(PlyLaw(soft.closure.copy(), soft.pressure.copy(), soft.stiffness)) is soft


def test_warp_and_weft_are_packed_with_their_own_moduli():
    """Of unlike solids: exchanged yarns exchange them."""
    fabric = assumed.with_solid_laws(catalogue.load("S-726"))
    warp, weft = fabric.solid_laws
    unlike = replace(fabric, solid_laws=(replace(warp, E_c=300e6), replace(weft, E_c=500e6)))
    assert assumed.transverse_moduli(unlike) == (300e6, 500e6)
    assert assumed.transverse_moduli(rotated_90(unlike)) == (500e6, 300e6)


def test_half_a_ply_is_each_family_with_its_own_modulus_in_series():
    """By the masses of warp and weft a square metre, of which the weft has 1.7 times as much a length."""
    plain = assumed.with_solid_laws(catalogue.load("S-728"))
    warp, weft = plain.weave.yarns
    heavier = replace(weft, linear_density=1.7 * weft.linear_density)
    laws = [replace(law, E_c=E_c) for law, E_c in zip(plain.solid_laws, (1e9, 3e9))]
    weave = replace(plain.weave, weft=heavier)
    unlike = replace(plain, weave=weave, solid_laws=tuple(laws))
    masses = [
        length * yarn.linear_density / weave.cell_area
        for length, yarn in zip(weave.S0, (warp, heavier))
    ]
    give = masses[0] / warp.fibre_density / 1e9 + masses[1] / weft.fibre_density / 3e9
    assert ply_laws.half_a_ply(unlike) == pytest.approx(2 / give, rel=1e-12)
    assert ply_laws.solid_fibre(unlike).stiffness == pytest.approx(1 / give, rel=1e-12)


def test_a_law_is_followed_up_to_a_share_of_solid_fibre():
    """Slopes of 1e11, 2e13 and 5e11 Pa/m before 1e13 of solid fibre, cut to 4e12."""
    law = PlyLaw([0.0, 30e-6, 31e-6, 51e-6], [0.0, 3e6, 23e6, 33e6], 1e13)
    cut = law.capped(0.4)
    assert cut.pressure_at([15e-6, 30e-6, 31e-6, 51e-6, 61e-6]) == pytest.approx(
        [1.5e6, 3e6, 7e6, 17e6, 57e6], rel=1e-12
    )
    assert (cut.steepest, cut.source, cut.status) == (4e12, law.source, law.status)
    assert law.steepest == pytest.approx(2e13)
    assert law.capped(2.0) == law
