"""Geometry of the catalogue's weaves against closed forms and the source's tables (errata E-01 .. E-40)."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import quad

from fabrics import catalogue
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
STRENGTH = {
    "S-720": 315.6,
    "S-726": 186.7,
    "S-727": 222.2,
    "S-728": 333.3,
    "S-731": 222.2,
    "S-745": 666.7,
}


def length_by_quadrature(w, h):
    """Eq. 4-3 as it is printed."""
    k = pi * h / (2 * w)
    return (
        2
        * quad(
            lambda x: sqrt(1 + k**2 * np.sin(pi * x / (2 * w)) ** 2), 0, w, epsabs=0, epsrel=1e-12
        )[0]
    )


@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.1, 0.37, 1.0, 5.0])
def test_arc_length_is_the_integral(ratio):
    w = 0.635e-3
    assert arc_length(w, ratio * w) == pytest.approx(length_by_quadrature(w, ratio * w), rel=1e-11)


@pytest.mark.parametrize("crimp", [0.0, 1e-12, 1e-6, 0.005, 0.0816, 0.5, 4.0])
def test_height_inverts_the_arc_length(crimp):
    w = 0.41e-3
    h = height_from_length(w, 2 * w * (1 + crimp))
    assert arc_length(w, h) / (2 * w) - 1 == pytest.approx(crimp, rel=1e-9, abs=4e-16)


@pytest.mark.parametrize("name", KEVLAR)
def test_the_weaves_have_the_numbers_of_the_source(name):
    """Tables 4-1 and 5-1; the areal density is nearer with the effective linear density."""
    fabric = catalogue.load(name)
    weave = fabric.weave
    used = fabric.with_effective_density().weave
    h1, h2, thickness, printed = TABLE_5_1[name]
    assert np.multiply(weave.h0, 1e3) == pytest.approx([h1, h2], abs=0.005)
    assert weave.thickness * 1e3 == pytest.approx(thickness, abs=0.006)
    assert weave.areal_density * 1e3 == pytest.approx(printed, rel=0.03)
    assert used.areal_density * 1e3 == pytest.approx(printed, rel=0.003)
    assert [yarn.strength for yarn in weave.yarns] == pytest.approx([STRENGTH[name]] * 2, abs=0.05)
    G2 = locking_modulus(used.warp.E, used.warp.A_s, used.thickness, 2 * used.w1)
    assert G2 == pytest.approx(fabric.shear.G2, rel=0.01)
    assert fabric.shear.G1 == pytest.approx(fabric.shear.G2 / 1000, rel=1e-12)


def test_locking_angle_from_the_weave():
    """Erratum E-08's corrected eq. 4-34 with K_s 0.65, tabulated thickness and the mean spacing."""
    expected = {
        "S-720": 0.666,
        "S-726": 0.546,
        "S-727": 0.427,
        "S-728": 0.809,
        "S-731": 0.241,
        "S-745": 0.437,
    }
    for name, angle in expected.items():
        weave = catalogue.load(name).weave
        found = locking_angle(weave.warp.A_s, 0.65, TABLE_5_1[name][2] * 1e-3, weave.w1 + weave.w2)
        assert found == pytest.approx(angle, abs=0.0015), name


def test_touching_angle_of_a_gap():
    width = catalogue.load("S-720").micrograph["weft"]["width"]
    assert touching_angle(width, 1.27e-3) == pytest.approx(0.252, abs=0.001)


def test_only_the_crossing_count_reproduces_s726():
    """Eq. 4-2: the cell along a yarn is the spacing of the family that crosses; only this weave can tell."""
    weave = catalogue.load("S-726").weave
    assert (2 * weave.w1 * 1e3, 2 * weave.w2 * 1e3) == pytest.approx((0.9407, 0.9769), abs=5e-5)
    own = replace(weave, warp_count=weave.weft_count, weft_count=weave.warp_count)
    assert abs(own.h01 - weave.h01) > 3e-6


def test_glass_weaves_and_the_wave_speed_of_aramid():
    balanced, unbalanced = (
        catalogue.load(f"glass-{kind}").weave for kind in ("balanced", "unbalanced")
    )
    assert np.multiply(balanced.h0, 1e3) == pytest.approx([0.1833, 0.1833], abs=5e-5)
    assert np.multiply(unbalanced.h0, 1e3) == pytest.approx([0.2583, 0.2339], abs=5e-5)
    assert (2 * unbalanced.w1, 2 * unbalanced.w2) == pytest.approx((6.25e-3, 4.545e-3), rel=1e-3)
    assert [yarn.EA for yarn in unbalanced.yarns] == pytest.approx([75000, 8900])
    assert [yarn.strength for yarn in unbalanced.yarns] == pytest.approx([850, 80], rel=1e-4)
    assert catalogue.load("S-720").weave.warp.wave_speed == pytest.approx(8165, abs=1)
