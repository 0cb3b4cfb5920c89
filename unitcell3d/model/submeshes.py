"""Other sets of yarns from the mesh of a crossover: one yarn alone, or plies of crossovers on each
other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshing.inputs import YARNS
from meshing.mesh import YarnMesh


def single_yarn_mesh(mesh: YarnMesh, family: int) -> YarnMesh:
    """Extract the yarn of one family (0 warp, 1 weft) of a crossover as a `YarnMesh` of its own."""
    grid = mesh.grids[family]
    first = int(grid.min())
    nodes = slice(first, first + grid.size)
    return replace(
        mesh,
        points=mesh.points[nodes],
        hexes=mesh.hexes[mesh.yarn == family] - first,
        yarn=np.zeros(np.count_nonzero(mesh.yarn == family), int),
        names=(YARNS[family],),
        families=(family,),
        grids=(grid - first,),
        bars=(mesh.bars[family] - first,),
        bar_area=(mesh.bar_area[family],),
        faces={},
    )


def with_bars(mesh: YarnMesh, lines: int) -> YarnMesh:
    """Keep `lines` of the fibre lines of the mesh of one yarn alone, spread over the section.

    The lines that stay carry the whole fibre area, in the ratio of their shares; none leaves no
    fibres.
    """
    grid = mesh.grids[0]
    across = grid.shape[1] * grid.shape[2]
    area = mesh.bar_area[0].reshape(-1, across)
    pairs = mesh.bars[0].reshape(-1, across, 2)
    kept = _spread(grid.shape[1], grid.shape[2], lines)
    if not lines:
        return replace(mesh, bars=(np.empty((0, 2), int),), bar_area=(np.empty(0),))
    share = area[:, kept] * (area.sum(axis=1) / area[:, kept].sum(axis=1))[:, None]
    return replace(mesh, bars=(pairs[:, kept].reshape(-1, 2),), bar_area=(share.ravel(),))


def line_numbers(across: int, through: int) -> list[int]:
    """List the numbers of fibre lines that can be spread evenly: over the middle layer, then over
    pairs of layers about it."""
    middle = across if through % 2 else 0
    return [*range(middle + 1), *range(middle + 2, across * through + 1, 2)]


def _spread(across, through, lines):
    """Numbers (j through + k) of `lines` fibre lines of a section, one of `line_numbers`."""
    middle = 0
    if through % 2:
        middle = min(lines, across)
    places = [(j, through // 2) for j in _evenly(across, middle)]
    pairs = (lines - middle) // 2
    half = through // 2
    for layer in range(half - 1, -1, -1):
        for j in _evenly(across, min(pairs, across)):
            places += [(j, layer), (j, through - 1 - layer)]
        pairs -= min(pairs, across)
    return np.array(sorted(j * through + k for j, k in places), int)


def _evenly(n, count):
    """`count` of n numbers, evenly spread; one: the first, which is the middle of a quarter
    yarn."""
    if count < 2:
        return range(count)
    return np.round(np.linspace(0, n - 1, count)).astype(int)


def stacked(mesh: YarnMesh, plies: int, pitch: float) -> YarnMesh:
    """Stack plies of one mesh on each other, `pitch` [m] from ply to ply, the middle at z = 0; the
    yarns of ply 0 come first."""
    yarns = len(mesh.names)
    n = len(mesh.points)
    heights = [(ply - (plies - 1) / 2) * pitch for ply in range(plies)]

    def numbered(arrays):
        return tuple(array + ply * n for ply in range(plies) for array in arrays)

    return replace(
        mesh,
        points=np.concatenate([mesh.points + np.array([0.0, 0.0, height]) for height in heights]),
        hexes=np.concatenate([mesh.hexes + ply * n for ply in range(plies)]),
        yarn=np.concatenate([mesh.yarn + ply * yarns for ply in range(plies)]),
        names=tuple(f"{name}_ply_{ply + 1}" for ply in range(plies) for name in mesh.names),
        families=mesh.families * plies,
        grids=numbered(mesh.grids),
        bars=numbered(mesh.bars),
        bar_area=mesh.bar_area * plies,
        faces={},
    )
