"""What the meshed surfaces of crossing yarns leave between them: the least gap of their facets,
negative where they overlap.

`meshing.section_fit` makes the smooth sections touch. The mesh has flat facets between nodes on
them, whose sag is of order two in the element size. Seen from above, the nodes of both surfaces
stand on lines along x and y: on the grid of all these lines both surfaces are bilinear between the
same lines, so their least distance in z is found at a grid point.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator


def least_gap(mesh: Any) -> float:
    """Compute the least vertical gap [m] of the facets of any warp and any weft yarn that cross in
    a `YarnMesh`."""
    yarns: tuple[list, list] = ([], [])
    for grid, family in zip(mesh.grids, mesh.families):
        yarns[family].append(mesh.points[grid])
    warps, wefts = yarns
    return min(_crossing_gap(warp, np.swapaxes(weft, 0, 1)) for warp in warps for weft in wefts)


def _crossing_gap(warp, weft):
    """Least gap of two yarns (nx, ny, nz, 3) [m], the first axis along x, the second along y, in
    both."""
    x = _common(warp[:, 0, 0, 0], weft[:, 0, 0, 0])
    y = _common(warp[0, :, 0, 1], weft[0, :, 0, 1])
    if min(len(x), len(y)) == 0:
        return np.inf
    places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    warp_bottom, warp_top = (_heights(warp, k, places) for k in (0, -1))
    weft_bottom, weft_top = (_heights(weft, k, places) for k in (0, -1))
    if np.mean(warp_bottom + warp_top) > np.mean(weft_bottom + weft_top):
        return float(np.min(warp_bottom - weft_top))
    return float(np.min(weft_bottom - warp_top))


def _heights(points, k, places):
    """Heights [m] of the layer k of nodes at places (..., 2) [m]."""
    lines = (points[:, 0, 0, 0], points[0, :, 0, 1])
    return RegularGridInterpolator(lines, points[:, :, k, 2])(places)


def _common(a, b):
    """The places of both lines, within the part that they share."""
    places = np.union1d(a, b)
    return places[(places >= max(a[0], b[0])) & (places <= min(a[-1], b[-1]))]
