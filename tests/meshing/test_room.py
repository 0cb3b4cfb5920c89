"""Crossovers whose crimp leaves little room: the section that is chosen, and advice that can be followed."""

import re
from pathlib import Path

import pytest

from fabrics import assumed, catalogue
from fabrics.errors import InputError
from meshing.mesh_plan import Plan, with_room

FOLDER = Path(__file__).parents[1] / "weavecell" / "own_fabrics"
TWARON = (FOLDER / "twaron-930.toml").read_text()
UHMWPE = (FOLDER / "uhmwpe-1760.toml").read_text()


def load(tmp_path, text):
    path = tmp_path / "own.toml"
    path.write_text(text)
    return assumed.with_solid_laws(catalogue.load(path))


def plan(fabric):
    return Plan.of(fabric, size="coarse", shift=True)


def crimped(text, warp, weft):
    """The file with crimps in place of its thickness."""
    lines = [line for line in text.splitlines() if not line.startswith("thickness")]
    head, warps, wefts = "\n".join(lines).replace("[weft]", "[warp]").split("[warp]")
    return f'{head}[warp]\ncrimp = "{warp} %"{warps}[weft]\ncrimp = "{weft} %"{wefts}'


def test_low_crimp_is_refused_with_the_least_that_can_be_meshed(tmp_path):
    """1.0 / 0.8 %: the advice is taken, crimps as well as thickness, and just below it does not fit."""
    fabric = load(tmp_path, crimped(TWARON, 1.0, 0.8))
    with pytest.raises(
        InputError, match="neither sine, ellipse nor conforming sections of warp and weft fit"
    ) as caught:
        plan(fabric)
    text = str(caught.value)
    assert "the crimp leaves a thickness of 0.2" in text
    found = re.search(r'crimp = "(\S+) %" under \[warp\] and crimp = "(\S+) %" under \[weft\]', text)
    warp, weft = map(float, found.groups())
    thickness = float(re.search(r'thickness = "(\S+) mm" without crimp', text)[1])
    assert plan(load(tmp_path, crimped(TWARON, warp, weft))).section_fit.overlap < 1e-4
    plan(load(tmp_path, TWARON.replace("0.30 mm", f"{thickness} mm")))
    for low in (crimped(TWARON, 0.97 * warp, 0.97 * weft), TWARON.replace("0.30 mm", f"{0.98 * thickness} mm")):
        with pytest.raises(InputError, match="the least that can be meshed"):
            plan(load(tmp_path, low))


def test_another_section_is_chosen_where_sine_does_not_fit(tmp_path):
    """A straight weft: the sine lens would ride on its crest; conforming sections fill what the warp leaves."""
    fabric = load(tmp_path, crimped(UHMWPE, 7.25, 0.48))
    assert fabric.section is None
    assert plan(fabric).section_fit.sections[0].kind == "conforming"
    fixed = load(tmp_path, 'section = "sine"\n' + crimped(UHMWPE, 7.25, 0.48))
    with pytest.raises(InputError, match="the sine sections of warp and weft overlap by"):
        plan(fixed)


def test_a_thickness_is_raised_within_its_range(tmp_path):
    """0.55 mm is 2 um too little for this UHMWPE; 0.45 mm is too far off."""
    fabric = load(tmp_path, UHMWPE)
    with pytest.raises(InputError, match="the least that can be meshed"):
        plan(fabric)
    roomy = with_room(fabric)
    plan(roomy)
    assert 1 < roomy.weave.thickness / fabric.weave.thickness < 1.01
    assert roomy.notes[-1].startswith(
        "note: the thickness 0.55 mm leaves too little room for the yarns; the 3D crossover"
    )
    thin = load(tmp_path, UHMWPE.replace("0.55 mm", "0.45 mm"))
    assert with_room(thin) is thin
    given = catalogue.load("S-720")
    assert with_room(given) is given
