"""Sections of yarns: their areas; two that touch: overlap measured, removed and reported, areas by the fibre fractions.

Gaps are measured from the centrelines themselves, on a dense grid.
"""

import numpy as np
import pytest
from scipy.integrate import quad, trapezoid

from fabrics import catalogue
from meshing import crossover as mesher
from meshing.section import KINDS, Section
from meshing.section_fit import CLOSEST_PACKING, SHIFT_LIMIT, fit_sections

WOVEN = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
LENSES = [(name, kind) for name in WOVEN for kind in ("sine", "ellipse")]
CONFORMING = [(name, "conforming") for name in catalogue.list_names()]


WIDTH = 1.27e-3
AREA = 1.6e-7


@pytest.mark.parametrize("tip_thickness_ratio", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("kind", KINDS)
def test_area_is_the_integral_of_the_thickness(kind, tip_thickness_ratio):
    section = Section.of_area(kind, WIDTH, AREA, tip_thickness_ratio)
    integral, _ = quad(
        lambda y: 2e6 * section.half_thickness(y), -section.half_width, section.half_width
    )
    assert section.area == pytest.approx(AREA, rel=1e-14)
    assert integral * 1e-6 == pytest.approx(AREA, rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_the_cut_has_the_asked_share_of_the_thickness(kind):
    section = Section(kind, WIDTH, 2e-4, 0.08)
    assert 2 * section.half_thickness(section.half_width) == pytest.approx(0.08 * 2e-4, rel=1e-12)
    assert 2 * section.half_thickness(0.0) == 2e-4
    assert section.half_thickness(-1e-4) == section.half_thickness(1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_meshed_area_converges_with_order_two(kind):
    section = Section.of_area(kind, WIDTH, AREA, 0.075)
    errors = []
    for n in (12, 24, 48):
        y = section.stations(n)
        assert y[0] == 0
        assert y[-1] == section.half_width
        assert np.all(np.diff(y) > 0)
        errors.append(AREA - 4 * trapezoid(section.half_thickness(y), y))
    assert np.all(np.array(errors) > 0)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.05)


def fitted(name, kind="sine", widths=None, **choices):
    """(SectionFit, Fabric); the widths are the spacings where none are given."""
    fabric = catalogue.load(name)
    widths = [2 * w for w in fabric.weave.w][::-1] if widths is None else widths
    fractions = [solid.Vf0 for solid in fabric.solid_laws]
    return fit_sections(kind, widths, fractions, fabric.weave, 0.075, **choices), fabric


def gap_field(sections, shift, weave, n=700):
    """Lower face of the warp minus upper face of the weft on a dense grid."""
    (w1, w2), (h1, h2), (warp, weft) = weave.w, weave.h0, sections
    x = np.linspace(0, weft.half_width, n)[:, None]
    y = np.linspace(0, warp.half_width, n)[None]
    lower = h1 * np.cos(np.pi * x / (2 * w1)) + shift / 2 - warp.half_thickness(y)
    upper = -h2 * np.cos(np.pi * y / (2 * w2)) - shift / 2 + weft.half_thickness(x)
    return lower - upper


@pytest.mark.parametrize("name, kind", LENSES)
def test_lenses_touch_and_nowhere_overlap_and_the_overlap_reported_is_that_of_the_lenses_asked_for(
    name, kind
):
    section_fit, fabric = fitted(name, kind)
    gap = gap_field(section_fit.sections, section_fit.shift, fabric.weave)
    assert gap.min() > -1e-11
    assert gap.min() < 5e-9  # they touch, up to the spacing of the samples
    requested = gap_field(section_fit.requested, 0.0, fabric.weave)
    assert section_fit.overlap == pytest.approx(-requested.min(), abs=5e-9)


@pytest.mark.parametrize("name, kind", CONFORMING)
def test_conforming_sections_touch_everywhere(name, kind):
    section_fit, fabric = fitted(name, kind)
    gap = gap_field(section_fit.sections, section_fit.shift, fabric.weave, n=60)
    assert abs(gap).max() < 1e-18 + 1e-12 * fabric.weave.h01
    assert section_fit.shift == 0
    for section in section_fit.sections:
        y = np.linspace(0, section.half_width, 20001)
        q = section.half_thickness(y)
        assert section.area == pytest.approx(
            4 * np.sum((q[1:] + q[:-1]) / 2) * (y[1] - y[0]), rel=1e-7
        )
        assert q.min() >= 0.075 * q[0] * (1 - 1e-9)
        assert section.half_width <= section.width / 2 * (1 + 1e-12)


@pytest.mark.parametrize("name, kind", LENSES + CONFORMING)
def test_areas_follow_the_fibre_fractions(name, kind):
    """A_yarn = A_s (1 + crimp) / Vf0; lenses only get denser, conforming sections keep the ratio of the fractions."""
    section_fit, fabric = fitted(name, kind)
    denser = [Vf0 / solid.Vf0 for Vf0, solid in zip(section_fit.Vf0, fabric.solid_laws)]
    assert (
        denser[0] == pytest.approx(denser[1], rel=1e-9)
        if kind == "conforming"
        else min(denser) >= 1
    )
    for section, Vf0, yarn in zip(section_fit.sections, section_fit.Vf0, fabric.weave.yarns):
        assert section.area == pytest.approx(yarn.A_s * (1 + yarn.crimp) / Vf0, rel=1e-9)
        assert Vf0 <= CLOSEST_PACKING


def test_a_small_overlap_or_gap_is_shifted_and_changes_no_section():
    for name, shift, report in (
        ("S-720", 2.68e-6, "overlap of the sections 2.68 um, closed by a shift of +2.68 um"),
        ("S-728", -2.37e-6, "gap of the sections 2.37 um, closed by a shift of -2.37 um"),
    ):
        section_fit, fabric = fitted(name)
        assert not section_fit.changed
        assert section_fit.shift == section_fit.overlap == pytest.approx(shift, abs=5e-9)
        assert section_fit.shift <= SHIFT_LIMIT * sum(fabric.weave.h0)
        assert section_fit.report == report


@pytest.mark.parametrize("name, kind", LENSES)
def test_yarns_that_cannot_be_shifted_do_not_overlap_either(name, kind):
    """As those of a patch: a gap stays open, and is said to be."""
    section_fit, fabric = fitted(name, kind, shift=False)
    assert section_fit.shift == 0
    assert gap_field(section_fit.sections, 0.0, fabric.weave).min() > -1e-11
    assert section_fit.report.endswith("left open") == (section_fit.overlap < 0)


def test_sections_are_narrowed_no_more_than_needed():
    """S-728, ellipse: width alone suffices, so the areas stay; half-way to the requested width they overlap."""
    section_fit, fabric = fitted("S-728", "ellipse")
    assert section_fit.Vf0 == tuple(solid.Vf0 for solid in fabric.solid_laws)
    assert all(s.width < a.width for s, a in zip(section_fit.sections, section_fit.requested))
    assert abs(section_fit.shift) < 1e-11
    wider = tuple(
        type(s).of_area(s.kind, (s.width + a.width) / 2, s.area, s.tip_thickness_ratio)
        for s, a in zip(section_fit.sections, section_fit.requested)
    )
    assert gap_field(wider, 0.0, fabric.weave).min() < -1e-6


def test_a_strongly_unbalanced_weave_is_densified_or_conforms_and_says_so():
    """S-731: lenses have to be squeezed to the closest packing before they fit; conforming sections keep more room."""
    lenses = fitted("S-731")[0]
    conforming = fitted("S-731", "conforming")[0]
    assert lenses.changed
    assert lenses.Vf0[0] == pytest.approx(CLOSEST_PACKING)
    assert abs(lenses.shift) < 1e-11
    assert lenses.report == (
        "overlap of the sections 73.00 um, solved: widths times 1.000 / 0.795, areas times 0.772 / 0.688 "
        "(Vf0 0.907 / 0.901)"
    )
    assert conforming.Vf0 == pytest.approx((0.834, 0.739), abs=1e-3)
    assert conforming.report == "conforming sections that touch everywhere (Vf0 0.834 / 0.739)"


def test_the_source_s_own_fractions_fill_the_room_of_its_own_crimp():
    """S-720 is the one fabric whose Vf0 the source fitted (Table 3-2: 0.70, 0.62); its crimp asks for 0.681, 0.603."""
    assert fitted("S-720", "conforming")[0].Vf0 == pytest.approx((0.70, 0.62), rel=0.03)


def test_prescribed_widths_are_kept():
    weave = catalogue.load("S-727").weave
    widths = [2 * weave.w2, 0.88 * 2 * weave.w1]
    section_fit, _ = fitted("S-727", widths=widths, prescribed=True)
    assert [section.width for section in section_fit.sections] == pytest.approx(widths, rel=1e-14)
    assert section_fit.Vf0[0] > 0.7


def test_meshes_of_conforming_sections_are_sound():
    for name in ("S-726", "S-731", "glass-unbalanced"):
        mesh = mesher.build(catalogue.load(name), size=(8, 12, 2), section="conforming")
        assert mesh.min_scaled_jacobian > 0.5
        for areas, A_s in zip(mesh.bar_area, mesh.fibre_area):
            assert areas.sum() / 8 == pytest.approx(A_s / 2, rel=1e-12)


@pytest.mark.parametrize("n", [2, 3, 6])
def test_steps_along_an_ellipse_shrink_as_those_of_equal_angle(n):
    section = Section("ellipse", 1.0, 0.3, 0.075)
    y = section.stations(n)
    steps = np.hypot(np.diff(y), np.diff(section.half_thickness(y)))
    graded = section.grading(n) ** np.arange(n)
    assert graded[-1] / graded[0] == pytest.approx(steps[-1] / steps[0])
