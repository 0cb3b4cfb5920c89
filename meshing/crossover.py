"""One crossover of a plain weave in hexahedra: the warp along x over the weft along y, the crossing
at the origin.

Centrelines (thesis eq. 4-1), moved apart by the shift that closes the sections
(`meshing.section_fit`):

    warp   z =   h_1 cos(pi x / 2 w_1) + shift/2
    weft   z = -(h_2 cos(pi y / 2 w_2) + shift/2)

"quarter" is x >= 0, y >= 0: half the length and half the width of each yarn, so half of its bars'
area.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Unpack

import numpy as np

from fabrics.fabric import Fabric
from meshing import inputs
from meshing.inputs import YARNS, MeshOptions, Size
from meshing.mesh import Strand, YarnMesh, assemble, outer_faces, place
from meshing.mesh_plan import Plan, mirrored


@dataclass(frozen=True, eq=False)
class Crossover(YarnMesh):
    """The mesh of a crossover: a `YarnMesh` of two yarns, "warp" and "weft".

    Parameters
    ----------
    domain : "quarter" or "whole"; the bars that cut one section sum to `share` A_s
    """

    domain: str

    @property
    def share(self) -> float:
        """[-] of a yarn's section that is meshed: a half in a quarter crossover."""
        return 0.5 if self.domain == "quarter" else 1.0


def build(
    fabric: Fabric,
    *,
    domain: str = "quarter",
    size: Size = "medium",
    **options: Unpack[MeshOptions],
) -> Crossover:
    """Mesh one crossover of a fabric.

    Parameters
    ----------
    fabric : Fabric, with solid laws (for the fibre volume fractions)
    domain : "quarter" or "whole"
    size : "coarse", "medium", "fine", "auto", or (nx, ny, nz), hexahedra along, across and through
        a quarter of each yarn, or an edge length [m] (`meshing.inputs.size`)
    **options : of `meshing.inputs.MeshOptions`

    Raises
    ------
    InputError : a value is not allowed, or the sections overlap and this is refused or cannot be
        solved
    """
    inputs.one_of("domain", domain, ("quarter", "whole"))
    plan = Plan.of(fabric, size=size, shift=True, **options)
    whole = domain == "whole"
    mesh, sides = assemble([_strand(plan, family, whole) for family in (0, 1)])
    faces = outer_faces(sides) if whole else _faces_of_a_quarter(sides)
    return Crossover(domain=domain, faces=faces, **mesh, **plan.fields())


def _strand(plan, family, whole):
    s = plan.along(family)
    if whole:
        s = mirrored(s)
    y, heights, areas = plan.across(family, whole)
    w = plan.weave.w[family]
    h = plan.weave.h0[family]
    sign = 1 if family == 0 else -1
    centre = sign * (h * np.cos(np.pi * s / (2 * w)) + plan.section_fit.shift / 2)
    points = place(family, s, centre, y, heights)
    over = np.full(len(s) - 1, family == 0)
    return Strand(YARNS[family], family, points, areas, over)


def _faces_of_a_quarter(sides):
    """Names of the outer faces of both yarns, as `YarnMesh.groups` lists them."""
    named = {}
    for yarn, planes in zip(YARNS, (("symx", "symy"), ("symy", "symx"))):
        of = sides[yarn]
        parts = ("contact", "plate", "end", "tip", *planes)
        for part, side in zip(parts, ("contact", "plate", "i1", "j1", "i0", "j0")):
            named[f"{yarn}_{part}"] = of[side]
    return named
