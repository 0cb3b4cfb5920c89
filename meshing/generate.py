"""Hexahedra of yarns by gmsh: the mesh of a script or of a file, each node at its place in its yarn.

gmsh numbers nodes by corner, curve, surface and volume. The solver wants them by place (i, j, k):
i along the yarn, j across it, k through it from bottom to top. In a transfinite mesh the place of a
node is the number of element edges between it and the face where the count begins, so it is found
from the connectivity alone, whatever the shape: of each pair of opposite faces (end and start, the
two tips, contact and plate; a symmetry plane in a quarter) the lower one is where the count begins.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra

from fabrics.base.checks import FilePath, FloatArray, IntArray
from fabrics.base.errors import InputError

# of each dimension, gmsh's number of the element type and its corners: quadrilateral, hexahedron
ELEMENTS = {2: (3, 4), 3: (5, 8)}

# the faces of a yarn that stand opposite each other: along, across and through it
OPPOSITE = (("start", "end"), ("low", "high"), ("contact", "plate"))
# local nodes of the twelve edges of a hexahedron in gmsh's order, which is VTK's
EDGES = np.array(
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
)
# (i, j, k) of the corners of a brick in VTK order, whose local axes run along i, j and k
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
# the same with local axes i, k and j, where (i, j, k) is left-handed
LEFT = [0, 1, 5, 4, 3, 2, 6, 7]
# corners (p, q) of a facet, round the normal p x q
ROUND = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])


@dataclass(frozen=True)
class Groups:
    """A mesh by its physical names, nodes numbered as gmsh gave them, from 0.

    Parameters
    ----------
    points : (n, 3) [m]
    quads : name of a physical surface -> (q, 4) int
    hexes : name of a physical volume -> (m, 8) int
    """

    points: FloatArray
    quads: dict[str, IntArray]
    hexes: dict[str, IntArray]


@dataclass(frozen=True)
class Box:
    """One yarn with its nodes in their places.

    Parameters
    ----------
    nodes : (nx+1, ny+1, nz+1) int, numbers in `Groups.points`
    hexes : (m, 8) int, VTK order, edges 0-1, 3-2, 4-5 and 7-6 along the fibre, numbered by place in
        C order
    quads : name of a face of this yarn -> (q, 4) int, normals outwards, numbered by place
    """

    nodes: IntArray
    hexes: IntArray
    quads: dict[str, IntArray]


def run_script(gmsh: Any, script: str) -> None:
    """Build the geometry of a script in the open session, and mesh it in hexahedra."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "yarns.geo"
        path.write_text(script, encoding="ascii")
        gmsh.open(
            str(path)
        )  # merge() would keep the macros of the script before, even of a session
    gmsh.model.mesh.generate(3)


@lru_cache(maxsize=16)
def of_script(script: str, name: str) -> Groups:
    """Mesh a script of `meshing.geometry`.

    One that this process has meshed before is not meshed again: runs of one patch in several models, or of one
    crossover in several cases, have the same mesh. So nobody can write to its arrays.
    """
    from meshing.session import gmsh_session  # pages and decks import meshes where gmsh is missing

    with gmsh_session(name) as gmsh:
        run_script(gmsh, script)
        groups = read_groups(gmsh)
    for array in (groups.points, *groups.quads.values(), *groups.hexes.values()):
        array.flags.writeable = False
    return groups


def of_file(path: FilePath) -> Groups:
    """Read the physical groups of a .msh file.

    Raises
    ------
    InputError : gmsh cannot read the file
    """
    from meshing.session import gmsh_session

    with gmsh_session(Path(path).stem) as gmsh:
        try:
            gmsh.merge(str(path))
        except Exception as problem:  # gmsh raises plain Exceptions of its own words
            raise InputError(f"gmsh cannot read {path}: {problem}") from None
        return read_groups(gmsh)


def read_groups(gmsh: Any) -> Groups:
    """Take points, facets and hexahedra of all named groups from the open session."""
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    number = np.full(int(tags.max(initial=0)) + 1, -1)
    number[tags[order]] = np.arange(len(tags))
    found: dict[int, dict[str, IntArray]] = {2: {}, 3: {}}
    for name, (dimension, entity) in named_entities(gmsh):
        kind, corners = ELEMENTS[dimension]
        _, nodes = gmsh.model.mesh.getElementsByType(kind, entity)
        part = number[nodes].reshape(-1, corners)
        before = found[dimension].get(name, part[:0])
        found[dimension][name] = np.concatenate([before, part])
    return Groups(xyz.reshape(-1, 3)[order], found[2], found[3])


def named_entities(gmsh: Any) -> Iterator[tuple[str, tuple[int, int]]]:
    """Yield (name, (dimension, tag)) of the entities of all physical surfaces, then of all
    volumes."""
    for dimension in ELEMENTS:
        for _, group in gmsh.model.getPhysicalGroups(dimension):
            name = gmsh.model.getPhysicalName(dimension, group)
            for tag in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
                yield name, (dimension, tag)


def boxed(groups: Groups, name: str, family: int, faces: Mapping[str, str]) -> Box:
    """Put the nodes of a yarn in their places.

    Parameters
    ----------
    groups : Groups
    name : of the yarn
    family : 0 of a warp, 1 of a weft yarn
    faces : name of a face -> what it is in `OPPOSITE`; "flank" is both low and high

    Raises
    ------
    InputError : a group is missing, or its hexahedra are not those of one transfinite box
    """
    hexes = groups.hexes.get(name, np.empty((0, 8), np.int64))
    if len(hexes) == 0:
        raise InputError(f"no hexahedra in a physical volume {name}")
    quads = {}
    for face in faces:
        quads[face] = groups.quads.get(f"{name}_{face}", np.empty((0, 4), np.int64))
        if len(quads[face]) == 0:
            raise InputError(f"no quadrilaterals in a physical surface {name}_{face}")
    used = np.unique(hexes)
    local = np.full(len(groups.points), -1)
    local[used] = np.arange(len(used))
    edges = local[hexes[:, EDGES].reshape(-1, 2)]
    graph = coo_array((np.ones(len(edges)), edges.T), shape=(len(used), len(used))).tocsr()
    places = np.empty((len(used), 3), np.int64)
    for axis, (pair, coordinate) in enumerate(zip(OPPOSITE, (family, 1 - family, 2))):
        chosen = [quads[face] for face, what in faces.items() if what in (*pair, "/".join(pair))]
        origin = _lower_face(np.concatenate(chosen), groups.points[:, coordinate], name)
        # the number of edges from the face, along i, j or k
        steps = dijkstra(
            graph, directed=False, indices=local[origin], unweighted=True, min_only=True
        )
        if not np.all(np.isfinite(steps)):
            raise InputError(f"the physical volume {name} is in several pieces")
        places[:, axis] = steps
    shape = tuple(places.max(axis=0) + 1)
    spots = np.ravel_multi_index(tuple(places.T), shape)
    if len(used) != np.prod(shape) or len(np.unique(spots)) != len(used):
        raise InputError(f"the physical volume {name} is not one transfinite mesh of hexahedra")
    nodes = np.empty(shape, np.int64)
    nodes.ravel()[spots] = used
    right = family == 0
    _check_bricks(places[local[hexes]], shape, name)
    sides = {face: _facets(places[local[of]], shape, right) for face, of in quads.items()}
    return Box(nodes, bricks(shape, right), sides)


def _lower_face(quads, coordinate, name):
    """Nodes of the lower one of two opposite faces, whose facets are given together."""
    used, local = np.unique(quads, return_inverse=True)
    corners = local.reshape(quads.shape)
    ends = np.roll(corners, 1, axis=1)
    pairs = np.stack([corners.ravel(), ends.ravel()])
    links = coo_array((np.ones(pairs.shape[1]), pairs), shape=(len(used), len(used)))
    count, piece = connected_components(links, directed=False)
    if count != 2:
        raise InputError(f"the outer faces of {name} are not those of one transfinite box")
    levels = [coordinate[used[piece == number]].mean() for number in (0, 1)]
    return used[piece == int(np.argmin(levels))]


def bricks(shape: Sequence[int], right: bool) -> IntArray:
    """Number the hexahedra of a box of nodes.

    Parameters
    ----------
    shape : (nx+1, ny+1, nz+1) of the nodes
    right : (i, j, k) is a right-handed system, as in a warp

    Returns
    -------
    hexes : (m, 8) int, nodes in C order of the places; VTK order of corners, edges 0-1, 3-2, 4-5
        and 7-6 along i
    """
    nx, ny, nz = shape
    lowest = np.indices((nx - 1, ny - 1, nz - 1)).reshape(3, -1).T
    corners = np.moveaxis(lowest[:, None] + CORNERS, -1, 0)
    hexes = np.ravel_multi_index(tuple(corners), (nx, ny, nz))
    if right:
        return hexes
    return hexes[:, LEFT]


def _check_bricks(places, shape, name):
    """Refuse hexahedra, by the places (m, 8, 3) of their nodes, that are not all those of a
    box."""
    lowest = places.min(axis=1)
    codes = np.sort((places - lowest[:, None]) @ [1, 2, 4], axis=1)
    cells = np.unique(lowest, axis=0)
    whole = len(cells) == len(places) == np.prod(np.subtract(shape, 1))
    if not (whole and np.array_equal(codes, np.tile(np.arange(8), (len(codes), 1)))):
        raise InputError(f"the physical volume {name} is not one transfinite mesh of hexahedra")


def _facets(places, shape, right):
    """Quadrilaterals (q, 4), normals outwards, of the places (q, 4, 3) of their nodes, in the order
    of their places."""
    lowest = places.min(axis=1)
    order = np.argsort(np.ravel_multi_index(tuple(lowest.T), shape))
    lowest = lowest[order]
    axis = np.argmax(places[order].max(axis=1) == lowest, axis=1)
    facet = np.arange(len(places))[:, None]
    corner = np.arange(4)
    corners = np.repeat(lowest[:, None], 4, axis=1)
    # p x q is the normal along the axis where (i, j, k) is right-handed
    for turn in (0, 1):
        corners[facet, corner, (axis[:, None] + 1 + turn) % 3] += ROUND[:, turn]
    facets = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), shape)
    low = lowest[facet[:, 0], axis] == 0
    inwards = low == right
    facets[inwards] = facets[inwards, ::-1]
    return facets
