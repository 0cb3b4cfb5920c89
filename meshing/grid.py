"""Numbering on the structured grid of a yarn: faces, bricks and fibre bars from node numbers
nodes[i, j, k].

i runs along the yarn, j across it, k through its thickness from bottom to top. (i, j, k) is a
right-handed system in the warp and a left-handed one in the weft; every function takes `right` and
keeps volumes positive, normals outward.
"""

from __future__ import annotations

import numpy as np

from fabrics.base.checks import FloatArray, IntArray

# (i, j, k) of the corners of a brick in VTK order, whose local axes run along i, j and k
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)


def bricks(nodes: IntArray, right: bool) -> IntArray:
    """List the bricks of a grid of nodes in VTK order, edges 0-1, 3-2, 4-5 and 7-6 along the fibre
    towards growing i.

    Parameters
    ----------
    nodes : (nx+1, ny+1, nz+1) int
    right : bool, the grid is right-handed

    Returns
    -------
    hexes : (m, 8) int
    """
    cells = tuple(n - 1 for n in nodes.shape)
    lowest = np.indices(cells).reshape(3, -1).T
    i, j, k = np.moveaxis(lowest[:, None] + CORNERS, -1, 0)
    hexes = nodes[i, j, k]
    if right:
        return hexes
    return hexes[:, [0, 1, 5, 4, 3, 2, 6, 7]]  # local axes i, k, j


def quads(sheet: IntArray, flip: bool) -> IntArray:
    """List the quadrilaterals of a sheet of nodes (p+1, q+1), normals along p x q, or against it
    with `flip`."""
    cells = np.stack(
        [sheet[:-1, :-1], sheet[1:, :-1], sheet[1:, 1:], sheet[:-1, 1:]], axis=-1
    ).reshape(-1, 4)
    return cells[:, ::-1] if flip else cells


def faces(nodes: IntArray, right: bool) -> dict[str, IntArray]:
    """List the six outer faces, each (m, 4) with outward normals, by the names "i0", "i1", "j0",
    "j1", "k0", "k1"."""
    left = not right
    return {
        "i0": quads(nodes[0], right),
        "i1": quads(nodes[-1], left),
        "j0": quads(nodes[:, 0], left),
        "j1": quads(nodes[:, -1], right),
        "k0": quads(nodes[:, :, 0], right),
        "k1": quads(nodes[:, :, -1], left),
    }


def bars(nodes: IntArray) -> IntArray:
    """List the mesh edges along the fibre as node pairs (nx, ny+1, nz+1, 2)."""
    return np.stack([nodes[:-1], nodes[1:]], axis=-1)


def tributary_areas(y: FloatArray, z: FloatArray) -> FloatArray:
    """Compute the share of each node of a section in its area: each quadrilateral gives the part
    nearest to a corner to that node.

    Parameters
    ----------
    y : (ny+1,) [m] stations across the section
    z : (ny+1, nz+1) [m] heights of the nodes at each station, in equal steps

    Returns
    -------
    area : (ny+1, nz+1) [m2], summing to the area of the polygon
    """
    middle = (y[1:] + y[:-1]) / 2
    bounds = np.concatenate([y[:1], middle, y[-1:]])
    thick = z[:, -1] - z[:, 0]
    at_bounds = np.interp(bounds, y, thick)
    # A strip between two bounds is two trapezoids that meet at the station.
    strip = (bounds[1:] - y) * (at_bounds[1:] + thick) / 2 + (y - bounds[:-1]) * (
        at_bounds[:-1] + thick
    ) / 2
    through = np.ones(z.shape[1])
    through[[0, -1]] = 0.5
    return strip[:, None] * through / through.sum()
