"""Which node of a cell a symmetry of the weave takes each node to.

A cell repeats after a number of crossings along warp and weft, as it is or upside down. With columns of
elements c a crossing, node column i of a yarn stands at i / c - 1/2 crossings along it; a motion that takes
crossing s to +-s + m takes it to column +-(i - c/2) + c/2 + c m, which is brought back into the cell.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.pattern import Symmetry
from meshing.mesh import YarnMesh


def partners(
    mesh: YarnMesh, cells: int, period: Sequence[int], parity: float, symmetry: Symmetry
) -> tuple[IntArray, IntArray, FloatArray]:
    """Find the node of the cell to which the symmetry takes each of its nodes.

    Parameters
    ----------
    mesh : meshing.mesh.YarnMesh, a cell of like yarns
    cells : columns of elements of one crossing
    period : (2,) crossings along warp and weft after which the weave repeats
    parity : +1 as it is, -1 upside down

    Returns
    -------
    nodes, images : (n,) node numbers
    signs : (n, 3) of the components: u(image) = signs u(node)
    """
    families = np.asarray(mesh.families)
    yarns = [np.flatnonzero(families == family) for family in (0, 1)]
    signs = symmetry.warp_sign, symmetry.weft_sign
    moves = symmetry.warp, symmetry.weft
    found = []
    for family in (0, 1):
        other = 1 - family
        for number, yarn in enumerate(yarns[family]):
            grid = mesh.grids[yarn]
            away, partner = divmod(signs[family] * number + moves[family], len(yarns[family]))
            columns = np.arange(len(grid)) - cells // 2
            columns = signs[other] * columns + cells // 2 + cells * moves[other]
            beyond, place = np.divmod(columns, cells * period[family])
            image = mesh.grids[yarns[family][partner]][place]
            if signs[family] < 0:
                image = image[:, ::-1]
            upside_down = np.full(len(grid), symmetry.upside_down)
            if parity < 0:
                upside_down ^= (away + beyond) % 2 == 1
            image[upside_down] = image[upside_down][:, :, ::-1]
            sign = np.ones((*grid.shape, 3))
            sign[..., family] = signs[other]
            sign[..., other] = signs[family]
            sign[upside_down, ..., 2] = -1
            found.append((grid.ravel(), image.ravel(), sign.reshape(-1, 3)))
    nodes, images, changes = (np.concatenate(part) for part in zip(*found))
    return nodes, images, changes
