"""Whether plies of a pack go through each other, found by another library than the contact: ipctk looks for edges of
the triangulated plies that cross triangles of other plies.

An element is two triangles where it has yarns of both families, has not eroded, and has never been drawn out to more
than twice its size once torn: what the contact has dropped for that is taken from it. Where yarns are resolved
their shadow nodes bear the triangles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from shellfabric.membrane.slots import by_element, by_node
from shellfabric.state import ERODED, RESOLVED

if TYPE_CHECKING:
    from shellfabric.loop.pack_solver import PackSolver

UNIT = 1e-3  # [m] of the library's coordinates


def plies_cross(march: PackSolver) -> bool:
    """Tell whether any ply crosses another now."""
    import ipctk

    places, facets, bare, owner = surfaces(march)
    sides = np.concatenate([facets[:, [0, 1]], facets[:, [1, 2]], facets[:, [2, 0]], bare])
    edges = np.unique(np.sort(sides, axis=1), axis=0).astype(np.int32)
    points = np.asfortranarray(places / UNIT)
    mesh = ipctk.CollisionMesh(points, edges, facets.astype(np.int32))
    mesh.can_collide = ipctk.make_vertex_patches_filter(owner.astype(np.int32))
    return bool(ipctk.has_intersections(mesh, points))


def surfaces(march: PackSolver) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    """Collect (nodes (n, 3) [m] of all plies, triangles (m, 3), bare yarns (k, 2), ply of each node
    (n,))."""
    places = []
    facets = []
    bare = []
    owner = []
    first = 0
    for p, (panel, c, state) in enumerate(march.plies):
        shape = (c.ni + 1, c.row_stride)
        size = shape[0] * shape[1]
        rest = np.stack([*panel.coordinates(), np.full(shape, march.pack.places[p])], -1)
        now = rest + np.stack([by_node(u, c) for u in state.u], axis=-1)
        warp, weft = (by_node(part, c) > 0 for part in state.intact_fraction)
        flag = by_element(state.element_flag, c)
        is_facet = (
            (warp[:-1, :-1] | warp[:-1, 1:])
            & (weft[:-1, :-1] | weft[1:, :-1])
            & (flag & ERODED == 0)
        )
        is_facet &= (flag == 0) | ~drawn_out(now, rest)
        is_facet |= (flag & RESOLVED != 0) & (flag & ERODED == 0)
        contact = march.contact
        rows = np.arange(c.ni)[:, None]
        is_facet &= (
            contact.dropped[contact.base[p] + rows * contact.row_stride[p] + np.arange(c.nj)] == 0
        )
        number = first + np.arange(size).reshape(shape)
        a, b, c, d = (
            part[is_facet]
            for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
        )
        about = np.pad(is_facet, 1)
        warp = warp[:-1] & ~(about[1:-1, 1:] | about[1:-1, :-1])
        weft = weft[:, :-1] & ~(about[1:, 1:-1] | about[:-1, 1:-1])
        facets += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
        bare += [np.stack([number[:-1][warp], number[1:][warp]], axis=1)]
        bare += [np.stack([number[:, :-1][weft], number[:, 1:][weft]], axis=1)]
        places.append(panel.in_pack(now).reshape(-1, 3))
        owner.append(np.full(size, p))
        first += size
    return (
        np.concatenate(places),
        np.concatenate(facets),
        np.concatenate(bare),
        np.concatenate(owner),
    )


def drawn_out(now: FloatArray, rest: FloatArray) -> FloatArray:
    """Mark the elements, (ni, nj) bool, with a diagonal of more than twice its length at rest."""
    ways = [(x[1:, 1:] - x[:-1, :-1], x[1:, :-1] - x[:-1, 1:]) for x in (now, rest)]
    return np.any([(a**2).sum(axis=-1) > 4 * (b**2).sum(axis=-1) for a, b in zip(*ways)], axis=0)
