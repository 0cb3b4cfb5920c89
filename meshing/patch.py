"""A woven patch of n warp and m weft yarns in hexahedra: a plain weave's chequerboard. 2 x 2 is the unit
cell of four crossovers.

Warp i lies at y_i, weft j at x_j, centred on the origin, counted from 1; the warp is over the weft
where i + j is even. Centrelines are one cosine from end to end (thesis eq. 4-1), on z = 0 at the ends:

    warp i   z =  (-1)^(i+1) h_1 cos(pi (x - x_1) / 2 w_1)
    weft j   z = -(-1)^(j+1) h_2 cos(pi (y - y_1) / 2 w_2)

A yarn that is over here and under there cannot be moved as a rigid body: an overlap is removed from
the sections alone, and a gap is left open (`meshing.section_fit`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np

from fabrics.fabric import Fabric
from meshing import geometry, inputs
from meshing.generate import Groups, of_script
from meshing.geometry import Yarn
from meshing.inputs import YARNS, MeshOptions, Size
from meshing.mesh import YarnMesh, assemble
from meshing.mesh_plan import Plan


@dataclass(frozen=True, eq=False)
class Patch(YarnMesh):
    """The mesh of a woven patch: a `YarnMesh` of the yarns "warp_1" .. "warp_n", "weft_1" ..
    "weft_m".

    Parameters
    ----------
    count : (n, m) numbers of warp and of weft yarns
    """

    count: tuple[int, int]

    @property
    def extent(self) -> tuple[float, float]:
        """[m] lengths of the patch along x and y."""
        return 2 * self.w[0] * self.count[1], 2 * self.w[1] * self.count[0]


def build(
    fabric: Fabric,
    count: Sequence[int] = (2, 2),
    *,
    size: Size = "coarse",
    **options: Unpack[MeshOptions],
) -> Patch:
    """Mesh a patch of a plain weave.

    Parameters
    ----------
    fabric : Fabric, with solid laws (for the fibre volume fractions)
    count : (n, m) numbers of warp and of weft yarns; (2, 2) is the unit cell of four crossovers
    size : as in `meshing.crossover.build`; nx, ny, nz count a quarter of a yarn in one crossing, so
        a crossing has 8 nx ny nz hexahedra
    **options : of `meshing.inputs.MeshOptions`; no shift is made: overlap="refuse" refuses any
        overlap

    Raises
    ------
    InputError : a value is not allowed, or the sections overlap and this is refused or cannot be
        solved
    """
    count = inputs.counts(count)
    plan = Plan.of(fabric, size=size, shift=False, **options)
    yarns = [*_family(plan, 0, count), *_family(plan, 1, count)]
    script = geometry.script(plan, yarns, quarter=False, stem="patch")
    names = [yarn.name for yarn in yarns]
    families = [yarn.family for yarn in yarns]
    found = assemble(_groups(plan, yarns), names, families, False, plan.weave)
    return Patch(count=count, script=script, **found, **plan.fields())


def _groups(plan, yarns):
    """The physical groups of all yarns, of which gmsh meshes those that differ by more than the
    place of their axis: at most two of a family, whatever the size of the patch.

    gmsh takes half a second to read the script of one yarn over 14 crossings, copies take none.
    """
    meshed = {}
    for yarn in yarns:
        meshed.setdefault((yarn.family, yarn.ups), replace(yarn, axis=0.0))
    script = geometry.script(plan, meshed.values(), quarter=False, stem="patch")
    made = of_script(script, plan.fabric)
    points = []
    quads = {}
    hexes = {}
    first = 0
    for yarn in yarns:
        like = meshed[yarn.family, yarn.ups].name
        moved = made.points.copy()
        moved[:, 1 - yarn.family] += yarn.axis
        used, local = np.unique(made.hexes[like], return_inverse=True)
        number = np.full(len(moved), -1)
        number[used] = first + np.arange(len(used))
        points.append(moved[used])
        hexes[yarn.name] = first + local.reshape(made.hexes[like].shape)
        for group, corners in made.quads.items():
            if group.startswith(f"{like}_"):
                quads[yarn.name + group.removeprefix(like)] = number[corners]
        first += len(used)
    return Groups(np.concatenate(points), quads, hexes)


def _family(plan, family, count):
    """The yarns of one family, each divided at its crossings and halfway between them."""
    w = plan.weave.w[family]
    spacing = 2 * plan.weave.w[1 - family]
    crossings = count[1 - family]
    stations = _centred(2 * crossings + 1, w)
    for number, axis in enumerate(_centred(count[family], spacing)):
        sides = plan.weave.pattern.sides(family, number, np.arange(-1, crossings + 1))
        ups = tuple(map(int, sides))
        name = f"{YARNS[family]}_{number + 1}"
        yield Yarn(name, family, ups=ups, axis=axis, first=stations[1], stations=stations)


def _centred(n, spacing):
    """(n,) [m] places at equal spacing, the middle at zero."""
    return (np.arange(n) - (n - 1) / 2) * spacing
