"""What crosses what in a pack: edges of the triangulated plies that go through triangles of other plies.

Found from places, without contact. An element is two triangles where it has yarns of both families, has not eroded, and
has never been drawn out to more than twice its size once torn: what the guard has dropped for that is taken from it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fabrics.checks import FloatArray, IntArray
from shellfabric.cloth.membrane_kernels import ERODED

if TYPE_CHECKING:
    from shellfabric.solver.pack_solver import PackSolver


def count(march: PackSolver) -> int:
    """Number of (edge, triangle) that cross now."""
    return len(pierced(*surfaces(march)))


def surfaces(march: PackSolver) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    """(nodes (n, 3) [m] of all plies, triangles (m, 3), bare yarns (k, 2), ply of each node (n,))."""
    places, facets, bare, owner, first = [], [], [], [], 0
    for p, (panel, c, state) in enumerate(march.parts):
        shape, size = (c.ni + 1, c.row_stride), (c.ni + 1) * c.row_stride
        rest = np.stack([*panel.coordinates(), np.full(shape, march.places[p])], axis=-1)
        now = rest + np.stack([u[:size].reshape(shape) for u in state.u], axis=-1)
        warp, weft = (part[:size].reshape(shape) > 0 for part in state.intact_fraction)
        flag = state.element_flag[:size].reshape(shape)[:-1, :-1]
        is_facet = (warp[:-1, :-1] | warp[:-1, 1:]) & (weft[:-1, :-1] | weft[1:, :-1]) & (flag & ERODED == 0)
        is_facet &= (flag == 0) | ~drawn_out(now, rest)
        is_facet &= march.guard.dropped[p * march.guard.slots :][:size].reshape(shape)[:-1, :-1] == 0
        number = first + np.arange(size).reshape(shape)
        a, b, c, d = (part[is_facet] for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
        about = np.pad(is_facet, 1)
        warp = warp[:-1] & ~(about[1:-1, 1:] | about[1:-1, :-1])
        weft = weft[:, :-1] & ~(about[1:, 1:-1] | about[:-1, 1:-1])
        facets += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
        bare += [np.stack([number[:-1][warp], number[1:][warp]], axis=1)]
        bare += [np.stack([number[:, :-1][weft], number[:, 1:][weft]], axis=1)]
        places.append(panel.in_pack(now).reshape(-1, 3))
        owner.append(np.full(size, p))
        first += size
    return np.concatenate(places), np.concatenate(facets), np.concatenate(bare), np.concatenate(owner)


def drawn_out(now: FloatArray, rest: FloatArray) -> FloatArray:
    """(ni, nj) bool: elements with a diagonal of more than twice its length at rest."""
    ways = [(x[1:, 1:] - x[:-1, :-1], x[1:, :-1] - x[:-1, 1:]) for x in (now, rest)]
    return np.any([(a**2).sum(axis=-1) > 4 * (b**2).sum(axis=-1) for a, b in zip(*ways)], axis=0)


def pierced(places: FloatArray, facets: IntArray, bare: IntArray, owner: IntArray) -> IntArray:
    """(n, 4) of all that cross: nodes of the edge, triangle, ply of the triangle; arguments as of `surfaces`."""
    edges = np.concatenate([facets[:, [0, 1]], facets[:, [1, 2]], facets[:, [2, 0]], bare])
    edges = np.unique(np.sort(edges, axis=1), axis=0)
    edge, facet = near_each_other(places[edges], places[facets])
    other = owner[edges[edge, 0]] != owner[facets[facet, 0]]
    edge, facet = edge[other], facet[other]
    p, q = np.moveaxis(places[edges[edge]], 1, 0)
    a, b, c = np.moveaxis(places[facets[facet]], 1, 0)
    normal = np.cross(b - a, c - a)
    before, behind = (((end - a) * normal).sum(axis=1) for end in (p, q))
    found = before * behind < 0
    at = p + (q - p) * (before / np.where(found, before - behind, 1.0))[:, None]
    for one, next_one in ((a, b), (b, c), (c, a)):
        found &= (np.cross(next_one - one, at - one) * normal).sum(axis=1) >= 0
    return np.column_stack([edges[edge], facet, owner[facets[facet, 0]]])[found]


def near_each_other(edges: FloatArray, facets: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs (edge, triangle) whose boxes overlap, by columns of a raster across the plies."""
    boxes = [(x.min(axis=1), x.max(axis=1)) for x in (edges, facets)]
    low, high = boxes[1]
    size, origin = 2 * np.median((high - low)[:, :2], axis=0), low[:, :2].min(axis=0)
    width = int((high[:, 1].max() - origin[1]) / size[1]) + 2
    listed = []
    for low, high in boxes:
        a, b = (np.floor((end[:, :2] - origin) / size).astype(int) for end in (low, high))
        a[:, 1], b[:, 1] = np.clip(a[:, 1], 0, width - 1), np.clip(b[:, 1], 0, width - 1)
        spans = b - a + 1
        number = np.repeat(np.arange(len(a)), spans.prod(axis=1))
        place = counted(spans.prod(axis=1))
        cell = (a[number, 0] + place // spans[number, 1]) * width + a[number, 1] + place % spans[number, 1]
        order = np.argsort(cell, kind="stable")
        listed.append((number[order], cell[order]))
    (edge, mine), (facet, theirs) = listed
    start, end = np.searchsorted(theirs, mine, "left"), np.searchsorted(theirs, mine, "right")
    edge, facet = np.repeat(edge, end - start), facet[counted(end - start) + np.repeat(start, end - start)]
    (low, high), (least, most) = boxes
    both = np.all((low[edge] <= most[facet]) & (high[edge] >= least[facet]), axis=1)
    pairs = np.unique(np.stack([edge[both], facet[both]]), axis=1)
    return pairs[0], pairs[1]


def counted(numbers: IntArray) -> IntArray:
    """0 ... n - 1 for each of the numbers n, one after the other."""
    return np.arange(numbers.sum()) - np.repeat(np.cumsum(numbers) - numbers, numbers)
