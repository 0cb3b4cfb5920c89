"""A woven patch of n warp and m weft yarns in hexahedra, whole yarns over and under: a plain
weave's chequerboard.

Warp i lies at y_i, weft j at x_j, centred on the origin, i and j counted from 1. The warp is over
the weft where i + j is even. Each centreline is one cosine from end to end (thesis eq. 4-1):

    warp i   z =  (-1)^(i+1) h_1 cos(pi (x - x_1) / 2 w_1)
    weft j   z = -(-1)^(j+1) h_2 cos(pi (y - y_1) / 2 w_2)

The patch ends between crossings, on the plane z = 0 where the centrelines turn. With n and m even
opposite ends fit each other: 2 x 2 is the unit cell of four crossovers.

A yarn that is over here and under there cannot be moved away from both neighbours as a rigid body,
so an overlap is removed from the sections alone, and a gap is left open (`meshing.section_fit`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Unpack

import numpy as np

from fabrics.fabric import Fabric
from meshing import inputs
from meshing.inputs import YARNS, MeshOptions, Size
from meshing.mesh import Strand, YarnMesh, assemble, outer_faces, place
from meshing.mesh_plan import Plan, mirrored


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
    mesh, sides = assemble([*_family(plan, 0, count), *_family(plan, 1, count)])
    return Patch(count=count, faces=outer_faces(sides), **mesh, **plan.fields())


def _family(plan, family, count):
    """The strands of all yarns of one family."""
    w = plan.weave.w[family]
    spacing = 2 * plan.weave.w[1 - family]
    crossings = _centred(count[1 - family], 2 * w)
    cell = mirrored(plan.along(family))
    phase = np.where(np.arange(len(crossings)) % 2 == 0, 1.0, -1.0)
    arch = phase[:, None] * plan.weave.h0[family] * np.cos(np.pi * cell / (2 * w))
    s, z = (_joined(part) for part in (crossings[:, None] + cell, arch))
    y, heights, areas = plan.across(family, whole=True)
    for number, across in enumerate(_centred(count[family], spacing)):
        sign = (-1) ** (family + number)
        over = np.repeat(sign * phase > 0, len(cell) - 1)
        points = place(family, s, sign * z, y, heights, across)
        yield Strand(f"{YARNS[family]}_{number + 1}", family, points, areas, over)


def _centred(n, spacing):
    """(n,) [m] places at equal spacing, the middle at zero."""
    return (np.arange(n) - (n - 1) / 2) * spacing


def _joined(cells):
    """Values (cells, k) of neighbouring cells in one line, the places that two cells share taken
    once."""
    return np.concatenate([cells[0], cells[1:, 1:].ravel()])
