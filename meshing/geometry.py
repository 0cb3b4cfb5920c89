"""The geometry of the yarns as a gmsh script: what `meshing.generate` meshes, and what a user edits.

The script is the request in numbers (half cell lengths, heights, elements, the two sections as
formulas), the macro that builds one yarn (`yarn.geo`), and a call of it for each yarn. gmsh runs it
as it runs a user's own .geo: eight corners, twelve curves, six surfaces and a volume for each
quarter of a crossing, transfinite and recombined, with the physical names of `YarnMesh.groups`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from meshing.mesh_plan import Plan

# points of a spline in each block: gmsh's splines then leave the formulas by less than 1e-6 of
# their height
SAMPLES = 60

_HEAD = """\
// Yarns of {fabric}, lengths in metres.
//
// Change a number or a formula here, mesh it in 3D and save it as .msh (in a terminal:
// gmsh -3 {stem}.geo -o my.msh); `weavecell calibrate {fabric} --mesh my.msh` reads a quarter back.
SetFactory("Built-in");

// of the warp (along x) and of the weft (along y)
half_length() = {{{half_length}}};
height() = {{{height}}};
half_width() = {{{half_width}}};
grading() = {{{grading}}};
shift = {shift};

// hexahedra in a quarter of a crossing
along = {along};
across = {across};
through = {through};
samples = {samples};

// half thickness q at the distance v from the middle of the yarn
Macro WarpSection
  q = {warp};
Return
Macro WeftSection
  q = {weft};
Return

"""

_CALL = """
name = "{name}";
family = {family};
ups() = {{{ups}}};
axis = {axis};
first = {first};
stations() = {{{stations}}};
sides() = {{{sides}}};
Call Yarn;
"""


@dataclass(frozen=True)
class Yarn:
    """One yarn of the geometry.

    Parameters
    ----------
    name : of its physical groups
    family : 0 of a warp, 1 of a weft yarn
    ups : +1 where the yarn is above its middle plane, -1 where it is below: at the crossing before
        `first`, at all that it has, and at the one behind the last
    axis : [m] place of its centreline across
    first : [m] place of its first crossing along it
    stations : [m] places along, between which it is divided into blocks
    """

    name: str
    family: int
    ups: tuple[int, ...]
    axis: float
    first: float
    stations: Sequence[float]


@cache
def _macros() -> str:
    return Path(__file__).with_name("yarn.geo").read_text(encoding="ascii")


def script(plan: Plan, yarns: Iterable[Yarn], *, quarter: bool, stem: str) -> str:
    """Write the gmsh script of some yarns.

    Parameters
    ----------
    plan : Plan
    yarns : in the order of the mesh
    quarter : half the width of each yarn, its flank on a symmetry plane; otherwise the whole
    stem : name of the file in the example at its head

    Returns
    -------
    text : of a .geo file
    """
    weave = plan.weave
    sections = plan.section_fit.sections
    along, across, through = plan.size
    parts = [
        _HEAD.format(
            fabric=plan.fabric,
            stem=stem,
            half_length=_listed(weave.w),
            height=_listed(weave.h0),
            half_width=_listed(section.half_width for section in sections),
            grading=_listed(section.grading(across) for section in sections),
            shift=repr(float(plan.section_fit.shift)),
            along=along,
            across=across,
            through=through,
            samples=SAMPLES,
            warp=sections[0].formula,
            weft=sections[1].formula,
        ),
        f"quarter = {int(quarter)};\n\n",
        _macros(),
    ]
    for yarn in yarns:
        width = f"half_width({yarn.family})"
        sides = f"-{width}, 0, {width}"
        if quarter:
            sides = f"0, {width}"
        parts.append(
            _CALL.format(
                name=yarn.name,
                family=yarn.family,
                ups=", ".join(map(str, yarn.ups)),
                axis=repr(float(yarn.axis)),
                first=repr(float(yarn.first)),
                stations=_listed(yarn.stations),
                sides=sides,
            )
        )
    return "".join(parts)


def _listed(numbers):
    return ", ".join(repr(float(number)) for number in numbers)
