"""Conforming sections: no gap and no overlap anywhere, areas in the asked ratio, what the crimp leaves room for."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.variants import with_yarns
from meshing import crossover as mesher
from meshing.conforming import conform
from meshing.section_fit import CLOSEST_PACKING, fit_sections

NAMES = catalogue.list_names()


def closed(name, tip_thickness_ratio=0.075, **choices):
    fabric = catalogue.load(name)
    spacing = [2 * w for w in fabric.weave.w][::-1]
    return fit_sections(
        "conforming", spacing, [s.Vf0 for s in fabric.solid_laws], fabric.weave, tip_thickness_ratio, **choices
    )


@pytest.mark.parametrize("name", NAMES)
def test_the_yarns_touch_everywhere(name):
    """From the centrelines themselves: lower face of the warp minus upper face of the weft is zero at every point."""
    weave, (warp, weft) = catalogue.load(name).weave, closed(name).sections
    (w1, w2), (h1, h2) = weave.w, weave.h0
    x, y = np.linspace(0, weft.half_width, 60)[:, None], np.linspace(0, warp.half_width, 60)[None]
    lower = h1 * np.cos(np.pi * x / (2 * w1)) - warp.half_thickness(y)
    upper = -h2 * np.cos(np.pi * y / (2 * w2)) + weft.half_thickness(x)
    assert np.abs(lower - upper).max() < 1e-18 + 1e-12 * h1


@pytest.mark.parametrize("name", NAMES)
def test_areas_keep_the_ratio_of_the_fibre_fractions(name):
    fabric, section_fit = catalogue.load(name), closed(name)
    factors = [Vf0 / solid.Vf0 for Vf0, solid in zip(section_fit.Vf0, fabric.solid_laws)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-9)
    for section, Vf0, yarn in zip(section_fit.sections, section_fit.Vf0, fabric.weave.yarns):
        y = np.linspace(0, section.half_width, 20001)
        q = section.half_thickness(y)
        assert section.area == pytest.approx(4 * np.sum((q[1:] + q[:-1]) / 2) * (y[1] - y[0]), rel=1e-7)
        assert section.area == pytest.approx(yarn.A_s * (1 + yarn.crimp) / Vf0, rel=1e-9)
        assert Vf0 < CLOSEST_PACKING
        assert q.min() >= 0.075 * q[0] * (1 - 1e-9)
        assert section.half_width <= section.width / 2 * (1 + 1e-12)


def test_the_source_s_own_fractions_fill_the_room_of_its_own_crimp():
    """S-720 is the one fabric whose Vf0 the source fitted (Table 3-2: 0.70, 0.62); its crimp asks for 0.681, 0.603."""
    assert closed("S-720").Vf0 == pytest.approx((0.70, 0.62), rel=0.03)


def test_an_unbalanced_weave_keeps_more_room_than_a_lens_leaves_it():
    """S-731: lenses have to be squeezed to 0.907 / 0.901, the closest packing, before they fit."""
    fabric = catalogue.load("S-731")
    lens = mesher.build(fabric, size=(2, 2, 1), section="sine")
    assert max(lens.Vf0) > 0.9
    assert closed("S-731").Vf0 == pytest.approx((0.834, 0.739), abs=1e-3)
    assert closed("S-731").report == "conforming sections that touch everywhere (Vf0 0.834 / 0.739)"


def test_meshes_are_sound_and_volumes_exact():
    for name in ("S-726", "S-731", "glass-unbalanced"):
        fabric = catalogue.load(name)
        mesh = mesher.build(fabric, size=(8, 12, 2), section="conforming")
        assert mesh.min_scaled_jacobian > 0.5
        assert mesh.shift == 0
        for areas, A_s in zip(mesh.bar_area, mesh.fibre_area):
            assert areas.sum() / 8 == pytest.approx(A_s / 2, rel=1e-12)


def test_bad_weaves_are_input_errors():
    fabric = catalogue.load("S-720")
    flat = with_yarns(fabric, crimp=(0.0, fabric.weave.weft.crimp)).weave
    with pytest.raises(InputError, match="need crimp in warp and weft"):
        conform([1e-3, 1e-3], [1e-7, 1e-7], flat, 0.075)
    with pytest.raises(InputError, match="no conforming sections have the fibre fractions"):
        conform([1.27e-3, 1.27e-3], [1e-7, 1e-12], fabric.weave, 0.075)
    thin = with_yarns(fabric, crimp=1e-3).weave
    with pytest.raises(InputError, match="denser than the closest packing"):
        fit_sections("conforming", [1.27e-3, 1.27e-3], [0.7, 0.62], thin, 0.075)
