"""The closing of the yarns: the overlap measured, removed and reported."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.variants import with_yarns
from meshing.section_fit import CLOSEST_PACKING, SHIFT_LIMIT, SectionFit, fit_sections

WOVEN = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
ALL = [(name, kind) for name in WOVEN for kind in ("sine", "ellipse")]


def closed(name, kind="sine", tip_thickness_ratio=0.075, **choices) -> SectionFit:
    fabric = catalogue.load(name)
    spacing = [2 * w for w in fabric.weave.w][::-1]
    return fit_sections(
        kind,
        choices.pop("widths", spacing),
        [s.Vf0 for s in fabric.solid_laws],
        fabric.weave,
        tip_thickness_ratio,
        **choices,
    )


def gap_field(sections, shift, weave, n=700):
    """Lower face of the warp minus upper face of the weft on a dense grid, from the centrelines themselves."""
    (w1, w2), (h1, h2), (warp, weft) = weave.w, weave.h0, sections
    x, y = np.linspace(0, weft.half_width, n)[:, None], np.linspace(0, warp.half_width, n)[None]
    lower = h1 * np.cos(np.pi * x / (2 * w1)) + shift / 2 - warp.half_thickness(y)
    upper = -h2 * np.cos(np.pi * y / (2 * w2)) - shift / 2 + weft.half_thickness(x)
    return lower - upper


@pytest.mark.parametrize(("name", "kind"), ALL)
def test_the_yarns_touch_and_nowhere_overlap(name, kind):
    section_fit = closed(name, kind)
    gap = gap_field(section_fit.sections, section_fit.shift, catalogue.load(name).weave)
    assert gap.min() > -1e-11
    assert gap.min() < 5e-9  # they touch, up to the spacing of the samples


@pytest.mark.parametrize(("name", "kind"), ALL)
def test_the_overlap_reported_is_that_of_the_sections_asked_for(name, kind):
    section_fit = closed(name, kind)
    gap = gap_field(section_fit.requested, 0.0, catalogue.load(name).weave)
    assert section_fit.overlap == pytest.approx(-gap.min(), abs=5e-9)


@pytest.mark.parametrize(("name", "kind"), ALL)
def test_areas_follow_the_fibre_fractions(name, kind):
    """A_yarn (1 + crimp) = A_s (1 + crimp) / Vf0, with the fractions of the mesh; nothing denser than round fibres."""
    fabric, section_fit = catalogue.load(name), closed(name, kind)
    for section, Vf0, solid, yarn in zip(section_fit.sections, section_fit.Vf0, fabric.solid_laws, fabric.weave.yarns):
        assert section.area == pytest.approx(yarn.A_s * (1 + yarn.crimp) / Vf0, rel=1e-9)
        assert solid.Vf0 <= Vf0 <= CLOSEST_PACKING


def test_a_small_overlap_is_shifted_and_changes_no_section():
    section_fit = closed("S-720")
    weave = catalogue.load("S-720").weave
    assert not section_fit.changed
    assert 0 < section_fit.shift == section_fit.overlap <= SHIFT_LIMIT * sum(weave.h0)
    assert section_fit.shift == pytest.approx(2.7e-6, abs=0.1e-6)
    assert section_fit.report == "overlap of the sections 2.68 um, closed by a shift of +2.68 um"


def test_a_gap_is_closed_too():
    section_fit = closed("S-728")
    assert section_fit.overlap < 0
    assert section_fit.shift == section_fit.overlap
    assert section_fit.report == "gap of the sections 2.37 um, closed by a shift of -2.37 um"


def test_sections_are_narrowed_no_more_than_needed():
    """S-728, ellipse: width alone suffices, so the areas stay; half-way to the requested width they overlap."""
    section_fit, weave = closed("S-728", "ellipse"), catalogue.load("S-728").weave
    assert section_fit.Vf0 == tuple(solid.Vf0 for solid in catalogue.load("S-728").solid_laws)
    assert all(s.width < a.width for s, a in zip(section_fit.sections, section_fit.requested))
    assert abs(section_fit.shift) < 1e-11
    wider = tuple(
        type(s).of_area(s.kind, (s.width + a.width) / 2, s.area, s.tip_thickness_ratio)
        for s, a in zip(section_fit.sections, section_fit.requested)
    )
    assert gap_field(wider, 0.0, weave).min() < -1e-6


def test_a_strongly_unbalanced_weave_is_densified_and_says_so():
    section_fit = closed("S-731")
    assert section_fit.changed
    assert section_fit.Vf0[0] == pytest.approx(CLOSEST_PACKING)
    assert abs(section_fit.shift) < 1e-11
    assert section_fit.report == (
        "overlap of the sections 73.00 um, solved: widths times 1.000 / 0.795, areas times 0.772 / 0.688 "
        "(Vf0 0.907 / 0.901)"
    )


def test_a_large_overlap_can_be_refused():
    with pytest.raises(InputError) as caught:
        closed("S-720", "ellipse", overlap="refuse")
    assert str(caught.value) == (
        "the ellipse sections of warp and weft overlap by 40.5 um, more than the 4.3 um that a shift may remove: "
        "narrow them, or let the overlap be solved"
    )


def test_prescribed_widths_are_kept():
    weave = catalogue.load("S-727").weave
    widths = [2 * weave.w2, 0.88 * 2 * weave.w1]
    section_fit = closed("S-727", widths=widths, prescribed=True)
    assert [section.width for section in section_fit.sections] == pytest.approx(widths, rel=1e-14)
    assert section_fit.Vf0[0] > 0.7


def test_what_cannot_be_solved_is_an_input_error():
    with pytest.raises(InputError) as caught:
        closed("S-731", prescribed=True)
    assert str(caught.value) == (
        "the sine sections of warp and weft overlap by 44.0 um even at the closest packing of the fibres "
        "(Vf0 = 0.907): try other widths or another section"
    )


def test_yarns_without_crimp_cannot_cross():
    flat = with_yarns(catalogue.load("S-720"), crimp=0.0).weave
    with pytest.raises(InputError, match=r"overlap by .* even at the closest packing"):
        fit_sections("sine", [1.27e-3, 1.27e-3], [0.7, 0.62], flat, 0.1)
