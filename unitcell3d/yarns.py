"""Other sets of yarns from the mesh of a crossover: one yarn alone, or plies of crossovers on each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshing.inputs import YARNS


def alone(mesh, family):
    """The yarn of one family (0 warp, 1 weft) of a crossover, as a `YarnMesh` of its own."""
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


def with_bars(mesh, lines):
    """The mesh of one yarn whose fibres lie on `lines` of its fibre lines alone, spread over the section.

    The lines that stay carry the whole fibre area, in the ratio of their shares; none leaves no fibres.
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


def _spread(across, through, lines):
    """Numbers of `lines` fibre lines of a section: first spread over the middle layer, then over pairs of layers."""
    layers = sorted(range(through), key=lambda k: abs(2 * k - through + 1))
    kept = []
    for first in (0, *range(1, through, 2)) if through % 2 else range(0, through, 2):
        layer = layers[:1] if through % 2 and first == 0 else layers[first : first + 2]
        count = min(lines - len(kept), across * len(layer))
        places = [j * through + k for j in range(across) for k in layer]
        kept += [places[i] for i in np.unique(np.round(np.linspace(0, len(places) - 1, count)).astype(int))]
    return np.array(kept, int)


def stacked(mesh, offsets):
    """Plies of one mesh, moved by `offsets` : (plies, 3) [m]; the yarns of ply 0 first."""
    plies, yarns, n = len(offsets), len(mesh.names), len(mesh.points)

    def numbered(arrays):
        return tuple(array + ply * n for ply in range(plies) for array in arrays)

    return replace(
        mesh,
        points=np.concatenate([mesh.points + np.asarray(offset) for offset in offsets]),
        hexes=np.concatenate([mesh.hexes + ply * n for ply in range(plies)]),
        yarn=np.concatenate([mesh.yarn + ply * yarns for ply in range(plies)]),
        names=tuple(f"{name}_ply_{ply + 1}" for ply in range(plies) for name in mesh.names),
        families=mesh.families * plies,
        grids=numbered(mesh.grids),
        bars=numbered(mesh.bars),
        bar_area=mesh.bar_area * plies,
        faces={},
    )
