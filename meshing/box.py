"""The reference box of a yarn: nx x ny x nz unit cubes, meshed by gmsh (transfinite, recombined to hexahedra).

The box is what gmsh meshes; the yarn is its image under an analytic map (`meshing.crossover`). A node of the box has
integer coordinates, its place (i, j, k) in the grid along, across and through the yarn.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fabrics.checks import IntArray

HEXAHEDRON = 5  # gmsh's number of the 8-node brick


@lru_cache(maxsize=16)
def transfinite_box(nx: int, ny: int, nz: int) -> IntArray:
    """Mesh the box and return the grid places of the eight nodes of every brick.

    Returns
    -------
    corners : (nx ny nz, 8, 3) int, read only; (i, j, k) of the nodes of each brick, in the VTK order of a brick
        whose local axes run along i, j and k

    Raises
    ------
    RuntimeError : gmsh did not mesh the box as a grid
    """
    from meshing.session import gmsh_session  # decks of panels need no gmsh

    with gmsh_session("box") as gmsh:
        _box(gmsh, nx, ny, nz)
        gmsh.model.mesh.generate(3)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        _, nodes = gmsh.model.mesh.getElementsByType(HEXAHEDRON)
        place = np.zeros((int(np.max(tags)) + 1, 3))
        place[np.asarray(tags, np.int64)] = np.reshape(coordinates, (-1, 3))
        bricks = np.reshape(np.asarray(nodes, np.int64), (-1, 8))
    exact = np.rint(place[bricks]).astype(np.int64)
    if len(exact) != nx * ny * nz or np.abs(exact - place[bricks]).max() > 1e-6:
        raise RuntimeError(
            f"gmsh {gmsh.__version__} did not mesh the box {nx} x {ny} x {nz} as a transfinite grid"
        )
    corners = _in_vtk_order(exact)
    corners.setflags(write=False)
    return corners


def _box(gmsh, *sides):
    """The box with its transfinite curves, surfaces and volume."""
    geo, mesh = gmsh.model.geo, gmsh.model.mesh
    entity = [(0, geo.addPoint(0, 0, 0))]
    for axis, side in enumerate(sides):
        step = [0, 0, 0]
        step[axis] = side
        entity = [geo.extrude(entity, *step)[1]]
    geo.synchronize()
    for dim, curve in gmsh.model.getEntities(1):
        bounds = np.asarray(gmsh.model.getBoundingBox(dim, curve))
        mesh.setTransfiniteCurve(curve, round(max(bounds[3:] - bounds[:3])) + 1)
    for dim, surface in gmsh.model.getEntities(2):
        mesh.setTransfiniteSurface(surface)
        mesh.setRecombine(dim, surface)
    for _, volume in gmsh.model.getEntities(3):
        mesh.setTransfiniteVolume(volume)


def _in_vtk_order(places):
    """Bricks sorted by their place, the nodes of each in the order of local axes along i, j, k."""
    low = places.min(axis=1)
    low = low[np.lexsort(low.T[::-1])]
    steps = np.array(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    )
    return low[:, None] + steps
