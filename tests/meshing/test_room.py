"""Crossovers whose crimp leaves little room: the section that is chosen, and advice that can be followed."""

import re
from pathlib import Path

import pytest

from fabrics import assumed, catalogue
from fabrics.base.errors import InputError
from fabrics.fabric import SECTIONS
from meshing import inputs, section_fit
from meshing.mesh_plan import Plan, with_room

FOLDER = Path(__file__).parents[1] / "weavecell" / "own_fabrics"
TWARON = (FOLDER / "twaron-930.toml").read_text()
UHMWPE = (FOLDER / "uhmwpe-1760.toml").read_text()


@pytest.fixture
def load(tmp_path):
    def fabric_of(text):
        path = tmp_path / "own.toml"
        path.write_text(text)
        return assumed.with_solid_laws(catalogue.load(path))

    return fabric_of


def sections(fabric):
    return Plan.of(fabric, size="coarse", shift=True).section_fit


def crimped(text, warp, weft):
    """The file with crimps [%] in place of its thickness."""
    text = re.sub(r"thickness = .*\n", "", text)
    return text.replace("[warp]", f'[warp]\ncrimp = "{warp} %"').replace(
        "[weft]", f'[weft]\ncrimp = "{weft} %"'
    )


def test_low_crimp_is_refused_with_the_least_that_can_be_meshed(load):
    """1.0 / 0.8 %: the advice is taken, crimps as well as thickness, and just below it does not fit."""
    line = "neither sine, ellipse nor conforming sections of warp and weft fit.*the crimp leaves a thickness of 0.2"
    with pytest.raises(InputError, match=line) as caught:
        sections(load(crimped(TWARON, 1.0, 0.8)))
    advice = r'crimp = "(\S+) %" under \[warp\] and crimp = "(\S+) %" under \[weft\], or thickness = "(\S+) mm" without'
    warp, weft, thickness = map(float, re.search(advice, str(caught.value)).groups())
    assert sections(load(crimped(TWARON, warp, weft))).overlap < 1e-4
    sections(load(TWARON.replace("0.30 mm", f"{thickness} mm")))
    for low in (
        crimped(TWARON, 0.97 * warp, 0.97 * weft),
        TWARON.replace("0.30 mm", f"{0.98 * thickness} mm"),
    ):
        with pytest.raises(InputError, match="the least that can be meshed"):
            sections(load(low))


def test_another_section_is_chosen_where_sine_does_not_fit(load):
    """A straight weft: the sine lens would ride on its crest; conforming sections fill what the warp leaves."""
    text = crimped(UHMWPE, 7.25, 0.48)
    assert load(text).section is None
    assert sections(load(text)).sections[0].kind == "conforming"
    with pytest.raises(InputError, match="the sine sections of warp and weft overlap by"):
        sections(load('section = "sine"\n' + text))


def test_a_thickness_is_raised_within_its_range(load):
    """0.51 mm is 4 um too little for this UHMWPE; 0.45 mm is too far off."""
    fabric = load(UHMWPE.replace("0.55 mm", "0.51 mm"))
    roomy = with_room(fabric)
    sections(roomy)
    assert 1 < roomy.weave.thickness / fabric.weave.thickness < 1.01
    assert roomy.notes[-1].startswith(
        "note: the thickness 0.51 mm leaves too little room for the yarns; the 3D crossover"
    )
    for given in (load(UHMWPE.replace("0.55 mm", "0.45 mm")), catalogue.load("S-720")):
        assert with_room(given) is given


@pytest.mark.parametrize("text, factors", [(TWARON, (0.7, 0.8, 1.0)), (UHMWPE, (0.9, 1.0, 1.01))])
def test_whether_there_is_room_is_what_the_search_for_sections_says(
    load, monkeypatch, text, factors
):
    """Of thicknesses on both sides of the least, by each kind of section and by any."""
    monkeypatch.setattr(section_fit, "_advice", lambda *_: "")  # which takes seconds
    fabric = load(text)
    answers = set()
    for factor in factors:
        made = assumed.of_thickness(fabric, factor)
        sizes = (inputs.widths(made, 0.0, None), inputs.fractions(made), made.weave)
        given = (*sizes, inputs.TIP_THICKNESS_RATIO)
        for kind in (*SECTIONS, None):
            found = True
            try:
                section_fit.fit_sections(kind, *given)
            except InputError:
                found = False
            assert section_fit.leaves_room(kind, *given) == found, (kind, factor)
            answers.add(found)
    assert answers == {True, False}
