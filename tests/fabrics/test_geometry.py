"""Geometry of the catalogue's weaves against closed forms and the source's tables (errata E-01 .. E-40)."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import quad

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.trellis import locking_angle, locking_modulus, touching_angle
from fabrics.weave import arc_length, height_from_length

KEVLAR = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
# thesis Table 5-1 (mm, mm, mm, g/m2); S-731's thickness is 0.3851 mm, printed 0.38
TABLE_5_1 = {
    "S-720": (0.12, 0.10, 0.43, 255.2),
    "S-726": (0.11, 0.04, 0.31, 201.4),
    "S-727": (0.12, 0.05, 0.34, 238.1),
    "S-728": (0.13, 0.09, 0.44, 231.1),
    "S-731": (0.15, 0.04, 0.38, 282.3),
    "S-745": (0.22, 0.11, 0.67, 473.7),
}
# erratum E-39 (N), at nominal linear density
STRENGTH = {"S-720": 315.6, "S-726": 186.7, "S-727": 222.2, "S-728": 333.3, "S-731": 222.2, "S-745": 666.7}


def length_by_quadrature(w, h):
    """Eq. 4-3 as it is printed."""
    k = pi * h / (2 * w)
    return 2 * quad(lambda x: sqrt(1 + k**2 * np.sin(pi * x / (2 * w)) ** 2), 0, w, epsabs=0, epsrel=1e-12)[0]


@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.1, 0.37, 1.0, 5.0])
def test_arc_length_is_the_integral(ratio):
    w = 0.635e-3
    assert arc_length(w, ratio * w) == pytest.approx(length_by_quadrature(w, ratio * w), rel=1e-11)


@pytest.mark.parametrize("crimp", [0.0, 1e-12, 1e-6, 0.005, 0.0816, 0.5, 4.0])
def test_height_inverts_the_arc_length(crimp):
    w = 0.41e-3
    h = height_from_length(w, 2 * w * (1 + crimp))
    assert arc_length(w, h) / (2 * w) - 1 == pytest.approx(crimp, rel=1e-9, abs=4e-16)


def test_height_of_a_small_crimp():
    w = 4.545e-3 / 2
    assert height_from_length(w, 2 * w * 1.004) == pytest.approx(2 * 2 * w / pi * sqrt(0.004), rel=0.01)


def test_a_yarn_shorter_than_its_cell_is_refused():
    with pytest.raises(InputError, match="at least the cell length"):
        height_from_length(1e-3, 1.9e-3)


@pytest.mark.parametrize("name", KEVLAR)
def test_heights_and_thickness_follow_from_crimp(name):
    weave = catalogue.load(name).weave
    h1, h2, thickness, _ = TABLE_5_1[name]
    assert weave.h01 * 1e3 == pytest.approx(h1, abs=0.005)
    assert weave.h02 * 1e3 == pytest.approx(h2, abs=0.005)
    assert weave.thickness * 1e3 == pytest.approx(thickness, abs=0.006)


@pytest.mark.parametrize("name", KEVLAR)
def test_areal_density(name):
    fabric = catalogue.load(name)
    printed = TABLE_5_1[name][3]
    assert fabric.weave.areal_density * 1e3 == pytest.approx(printed, rel=0.03)
    assert fabric.with_effective_density().weave.areal_density * 1e3 == pytest.approx(printed, rel=0.003)


@pytest.mark.parametrize("name", KEVLAR)
def test_strengths(name):
    assert [yarn.strength for yarn in catalogue.load(name).weave.yarns] == pytest.approx([STRENGTH[name]] * 2, abs=0.05)


@pytest.mark.parametrize("name", KEVLAR)
def test_locking_modulus_of_table_4_1(name):
    fabric = catalogue.load(name).with_effective_density()
    weave = fabric.weave
    G2 = locking_modulus(weave.warp.E, weave.warp.A_s, weave.thickness, 2 * weave.w1)
    assert G2 == pytest.approx(fabric.shear.G2, rel=0.01)
    assert fabric.shear.G1 == pytest.approx(fabric.shear.G2 / 1000, rel=1e-12)


def test_locking_angle_from_the_weave():
    """Erratum E-08's corrected eq. 4-34 with K_s 0.65, tabulated thickness and the mean spacing."""
    expected = {"S-720": 0.666, "S-726": 0.546, "S-727": 0.427, "S-728": 0.809, "S-731": 0.241, "S-745": 0.437}
    for name, angle in expected.items():
        weave = catalogue.load(name).weave
        found = locking_angle(weave.warp.A_s, 0.65, TABLE_5_1[name][2] * 1e-3, weave.w1 + weave.w2)
        assert found == pytest.approx(angle, abs=0.0015), name


def test_touching_angle_needs_a_gap():
    micrograph = catalogue.load("S-720").micrograph
    assert touching_angle(micrograph["weft"]["width"], 1.27e-3) == pytest.approx(0.252, abs=0.001)
    with pytest.raises(InputError, match="below the spacing"):
        touching_angle(micrograph["warp"]["width"], 1.27e-3)


def test_only_the_crossing_count_reproduces_s726():
    """Eq. 4-2: the cell along a yarn is the spacing of the family that crosses; only this weave can tell."""
    weave = catalogue.load("S-726").weave
    assert (2 * weave.w1 * 1e3, 2 * weave.w2 * 1e3) == pytest.approx((0.9407, 0.9769), abs=5e-5)
    own = replace(weave, warp_count=weave.weft_count, weft_count=weave.warp_count)
    assert abs(own.h01 - weave.h01) > 3e-6


def test_glass_weaves():
    balanced, unbalanced = (catalogue.load(f"glass-{kind}").weave for kind in ("balanced", "unbalanced"))
    assert np.multiply(balanced.h0, 1e3) == pytest.approx([0.1833, 0.1833], abs=5e-5)
    assert np.multiply(unbalanced.h0, 1e3) == pytest.approx([0.2583, 0.2339], abs=5e-5)
    assert (2 * unbalanced.w1, 2 * unbalanced.w2) == pytest.approx((6.25e-3, 4.545e-3), rel=1e-3)
    assert [yarn.EA for yarn in unbalanced.yarns] == pytest.approx([75000, 8900])
    assert [yarn.strength for yarn in unbalanced.yarns] == pytest.approx([850, 80], rel=1e-4)


def test_wave_speed_of_the_fibre():
    assert catalogue.load("S-720").weave.warp.wave_speed == pytest.approx(8165, abs=1)


@pytest.mark.parametrize("name", KEVLAR)
def test_void_of_the_micrographs(name):
    """Erratum E-26: void = (A_T - A_f) / A_T, with width x thickness x a shape factor between sine and ellipse."""
    fabric = catalogue.load(name)
    for family, yarn in zip(("warp", "weft"), fabric.weave.yarns):
        section = fabric.micrograph[family]
        area = yarn.A_s / (1 - section["void"])
        assert 0.60 < area / (section["width"] * section["thickness"]) < 0.82
        assert section["total_thickness"] == pytest.approx(section["thickness"] + section["crossing_thickness"])
