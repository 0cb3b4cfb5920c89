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
    """Least vertical gap [m] of the facets of any warp and any weft yarn that cross in a
    `YarnMesh`."""
    families = np.array(mesh.families)
    yarns = [
        [mesh.points[mesh.grids[n]] for n in np.flatnonzero(families == family)]
        for family in (0, 1)
    ]
    return min(
        _crossing_gap(warp, np.swapaxes(weft, 0, 1)) for warp in yarns[0] for weft in yarns[1]
    )


def _crossing_gap(*yarns):
    """Least gap of two yarns (nx, ny, nz, 3) [m], the first axis along x, the second along y, in
    both."""
    lines = [(points[:, 0, 0, 0], points[0, :, 0, 1]) for points in yarns]
    common = [_common(*axes) for axes in zip(*lines)]
    if min(len(axis) for axis in common) == 0:
        return np.inf
    at = np.meshgrid(*common, indexing="ij")
    bottom, top = (
        [
            RegularGridInterpolator(axes, points[:, :, k, 2])(np.stack(at, axis=-1))
            for axes, points in zip(lines, yarns)
        ]
        for k in (0, -1)
    )
    warp_is_over = np.mean(bottom[0] + top[0]) > np.mean(bottom[1] + top[1])
    return float(np.min(bottom[0] - top[1] if warp_is_over else bottom[1] - top[0]))


def _common(a, b):
    """The places of both lines, within the part that they share."""
    low, high = max(a[0], b[0]), min(a[-1], b[-1])
    places = np.union1d(a, b)
    return places[(places >= low) & (places <= high)]
