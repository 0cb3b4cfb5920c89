"""The range of a law from all that is not known of its crossover, with a closed form in place of the paths."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics import assumed, catalogue
from fabrics.base.errors import UnstableError
from fabrics.base.executors import InProcess
from fabrics.compression import NORMAL_95, CompressionLaw
from unitcell3d.identify import law_range
from unitcell3d.identify.solid_record import with_solid_laws

A = 4e-5
B = 5e-5
F = np.geomspace(0.1, 100, 25)
OWN = Path(__file__).parents[2] / "weavecell" / "own_fabrics" / "twaron-930.toml"


def law_of(fabric, which):
    """a as the root of 2 GPa over E_c and as the thickness, b as K_r and the cube of the thickness; 1.1 of both of a
    stated fraction."""
    solid = fabric.solid_laws[0]
    thick = fabric.weave.thickness / 3e-4
    stated = 1.1 if which == "stated" else 1.0
    a = A * (2e9 / solid.E_c) ** 0.5 * thick * stated
    return CompressionLaw(a, B * solid.K_r / 0.02 * thick**3 * stated)


@pytest.fixture
def ranged(monkeypatch, tmp_path):
    """A function of fabric and fit that gives the LawRange; its paths are the closed form."""
    dead = []

    def solve_samples(fabric, size, friction, fraction):
        if dead and fabric.solid_laws[0].E_c < dead[0]:
            return np.empty(0), np.empty(0), "too soft"
        return F, law_of(fabric, fraction).d(F), ""

    monkeypatch.setattr(law_range, "solve_samples", solve_samples)

    def of(fabric, fit=None, without=None):
        dead[:] = [without] if without else []
        unknowns = law_range.list_unknowns(fabric, fit, "mesh")
        law = law_of(fabric, "mesh")
        # the mesh of the calibration makes a a tenth less
        law = CompressionLaw.fit(F, replace(law, a=0.9 * law.a).d(F))
        found = law_range.find_range(
            fabric, law, unknowns, fraction="mesh", folder=tmp_path, executor=InProcess()
        )
        return law, found

    return of


@pytest.fixture(scope="module")
def own():
    return assumed.with_solid_laws(catalogue.load(OWN))


def test_all_that_is_unknown_is_in_it_and_adds_up(ranged, own):
    _, found = ranged(own)
    names = {"E_c", "K_r", "V_c", "fibre fraction", "thickness", "warp share", "mesh"}
    assert set(found.ends) == names
    low, high = own.ranges["solid.E_c"]
    of_E_c = found.parts()["E_c"]
    expected = np.max(np.log([low, high]) ** 2) / 4 / NORMAL_95**2
    assert of_E_c[0, 0] == pytest.approx(expected, rel=2e-2)
    assert abs(of_E_c[1, 1]) < 1e-4 * of_E_c[0, 0]
    thick = found.parts()["thickness"]
    assert thick[1, 1] == pytest.approx(9 * thick[0, 0], rel=2e-2)
    assert thick[0, 1] == pytest.approx(3 * thick[0, 0], rel=2e-2)
    assert found.covariance == pytest.approx(sum(found.parts().values()), rel=1e-12)
    shares = found.shares()
    assert sum(shares.values()) == pytest.approx(1)
    assert list(shares.values()) == sorted(shares.values(), reverse=True)


def test_each_unknown_at_its_end_lies_inside(ranged, own):
    law, found = ranged(own)
    law = found.around(law)
    for name, laws in found.ends.items():
        for end in laws:
            a, b = law.a * end.a / found.law.a, law.b * end.b / found.law.b
            assert law.holds(a, b), name
    assert not law.holds(30 * law.a, law.b)


def test_ends_bracket_the_law_by_construction(ranged, own):
    law, found = ranged(own)
    law = replace(found.around(law), F_range=(0.1, 1e4))
    assert law.outside_ends() == []
    soft, stiff = law.ends().values()
    assert np.all(soft.d(F) > law.d(F))
    assert np.all(stiff.d(F) < law.d(F))


def test_an_end_without_a_law_is_left_out_and_told(ranged, own):
    _, found = ranged(own, without=0.5 * own.solid_laws[0].E_c)
    assert len(found.ends["E_c"]) == 1
    assert found.failed == {"E_c": "too soft"}


def test_best_values_without_a_law_are_refused(ranged, own):
    with pytest.raises(UnstableError, match="on a small mesh give no law: too soft"):
        ranged(own, without=1e12)


def test_of_a_fitted_solid_its_directions_count_in_place_of_the_assumed_constants(ranged, s720):
    def fabric_of(*logarithms):
        return with_solid_laws(s720, np.log([2e9, 0.3, 0.02]) + np.array(logarithms), 0.7)

    limits = (
        (fabric_of(-0.2, 0, 0), fabric_of(0.2, 0, 0)),
        (fabric_of(0, 0, -0.4), fabric_of(0, 0, 0.5)),
    )
    _, found = ranged(fabric_of(0, 0, 0), SimpleNamespace(limits=limits))
    assert set(found.ends) == {"solid, direction 1", "solid, direction 2", "mesh"}
    parts = found.parts()
    assert parts["solid, direction 1"][0, 0] == pytest.approx((0.1 / NORMAL_95) ** 2, rel=1e-2)
    assert parts["solid, direction 2"][1, 1] == pytest.approx(0.5**2 / NORMAL_95**2, rel=1e-2)


def test_a_stated_crimp_with_a_range_is_in_it(ranged, own):
    """Of the file's crimps each moves alone, and the other stays; without a range it is known."""
    stated = replace(own, assumed=("solid",), ranges={"weft.crimp": (0.8, 1.25)})
    unknowns = law_range.list_unknowns(stated, None, "mesh")
    crimps = [[yarn.crimp for yarn in end.weave.yarns] for end, _ in unknowns.pop("weft crimp")]
    warp, weft = (yarn.crimp for yarn in own.weave.yarns)
    assert np.allclose(crimps, [(warp, 0.8 * weft), (warp, 1.25 * weft)], rtol=1e-12)
    assert not any("crimp" in name or name == "thickness" for name in unknowns)
