"""What passes through what in a pack: found from what crosses what from step to step, without the contact.

A passage is the middle of an element with yarns left that goes through another ply where that has yarns left. Through a
hole, where warp and weft next to the place are both gone or its element has eroded, it may go. Two surfaces stand for a
ply: the four triangles between the nodes and the middle of each element, and that of the contact, which is the spline
where it is whole. They lie on the two sides of a bend, and a point that has crossed both the same way is through. When
a yarn fails the second changes at once from the one side of a bend to the other, and a point between is behind it
without having moved: what is back within AT_ONCE steps has not passed, and is counted as such.
Points and corners of facets are taken to move straight within a step; a point crosses a triangle where the volume of
the two changes its sign between the triangle's sides.

Looked at are the elements about the middle of a quarter panel, every ply against its neighbours and, through their
holes, against the next but one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fabrics.checks import BoolArray, FloatArray, IntArray
from shellfabric.cloth.membrane_kernels import ERODED

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel
    from shellfabric.solver.pack_solver import PackSolver

REACH, AT_ONCE = 2, 10  # [plies, steps]


class Passage(NamedTuple):
    """Where something passed.

    step, ply, other : [-] whose point, through which ply's cloth
    element, through : (2,) [-] of the ply, of the other
    whole : whether both are untorn there
    """

    step: int
    ply: int
    other: int
    element: tuple
    through: tuple
    whole: bool


class Passages:
    """Those of a solver that calls it after every step.

    Parameters
    ----------
    march : PackSolver of a quarter panel, at rest or under way
    near : elements from the middle, along each side, which are looked at

    Attributes
    ----------
    found : list of Passage
    back : list of those that were undone at once
    """

    def __init__(self, march: PackSolver, near: int) -> None:
        self.march, self.near = march, near
        self.found: list[Any] = []
        self.back: list[Any] = []
        self._net: dict[Any, Any] = {}
        self._fill()

    def _fill(self):
        count = range(len(self.march.states))
        self.nodes = [nodes(self.march, p, self.near) for p in count]
        self.surfaces = [surfaces(self.march, p, self.nodes[p]) for p in count]

    def step(self) -> None:
        """Look at what the march has just done in a step."""
        last, then = self.nodes, self.surfaces
        self._fill()
        awake = self.march.stack.awake
        for p in np.flatnonzero(awake):
            middles, held = points(self.march, p, self.nodes[p])
            pair = points(self.march, p, last[p])[0], middles
            for q in range(max(p - REACH, 0), min(p + REACH + 1, len(last))):
                if q != p:
                    self._note(int(p), q, pair, held, then[q])

    def _note(self, p, q, pair, held, then):
        *now, cloth = self.surfaces[q]
        for number, (before, after) in enumerate(zip(then, now)):
            for point, facet, way in crossings(pair, held, (before, after), cloth):
                element, through = tuple(map(int, point)), tuple(int(n) // 2 for n in facet)
                net = self._net.setdefault((p, q, element), np.zeros(2, int))
                old = gone(net)
                net[number] += way
                if abs(gone(net)) < abs(old):
                    self._undo(p, q, element)
                if abs(gone(net)) > abs(old):
                    flags = (by_element(self.march, r, "element_flag", self.near) for r in (p, q))
                    whole = not any(flag[at] for flag, at in zip(flags, (element, through)))
                    self.found.append(Passage(self.march.steps, p, q, element, through, whole))

    def _undo(self, p, q, element):
        """The point is back: its last passage was none if it is no older than that."""
        for one in reversed(self.found):
            if (one.ply, one.other, one.element) == (p, q, element) and self.march.steps - one.step <= AT_ONCE:
                self.found.remove(one)
                self.back.append(one)
                return


def gone(net: Any) -> Any:
    """How often, and which way, a point is through, by its net crossings of both surfaces."""
    return int(min(net) if min(net) > 0 else max(net) if max(net) < 0 else 0)


def nodes(march: PackSolver, p: int, near: int) -> FloatArray:
    """(near + 1, near + 1, 3) places of the nodes of a ply about the middle."""
    c, state = march.consts[p], march.states[p]
    i, j = np.mgrid[: near + 1, : near + 1]
    moved = [u[: (c.ni + 1) * c.row_stride].reshape(c.ni + 1, c.row_stride)[: near + 1, : near + 1] for u in state.u]
    rest = (
        c.x0 + i * c.dx + offsets(c.line_offset1, i), c.y0 + j * c.dy + offsets(c.line_offset2, j),
        march.pack.places[p] + 0.0 * i,
    )  # fmt: skip
    return np.stack([a + b for a, b in zip(rest, moved)], axis=-1)


def offsets(of_lines: Any, i: IntArray) -> Any:
    """[m] of lines from where equal elements would have them at rest: a number for each line of a graded ply, or 0."""
    return of_lines[i] if np.ndim(of_lines) else of_lines


def elements_within(panel: Panel, crossovers: float) -> int:
    """Elements from the middle of a quarter panel along the side that needs more of them to reach that far."""
    reach = ((lines, 2 * w * crossovers) for lines, w in zip(panel.lines(), panel.weave.w))
    return max(int(np.searchsorted(lines, length - 1e-9)) for lines, length in reach)


def by_element(march: PackSolver, p: int, name: str, near: int, family: int | None = None) -> NDArray[Any]:
    """(near + 1, near + 1) flags, or the intact part of a family's edges."""
    c, values = march.consts[p], getattr(march.states[p], name)
    values = values if family is None else values[family]
    return values[: (c.ni + 1) * c.row_stride].reshape(c.ni + 1, c.row_stride)[: near + 1, : near + 1]


def surfaces(march: PackSolver, p: int, x: FloatArray) -> tuple[FloatArray, FloatArray, BoolArray]:
    """(2 near + 1, 2 near + 1, 3) places on the facets of a ply, the same on the surface of its contact, and
    (2 near, 2 near) where it has cloth: of quarters of elements, corners of which are a node and a middle."""
    near = len(x) - 1
    flag = by_element(march, p, "element_flag", near)
    cloth = np.empty((2 * near, 2 * near), bool)
    warp, weft = (by_element(march, p, "intact_fraction", near, family) for family in (0, 1))
    for a in (0, 1):
        for b in (0, 1):
            left = warp[:near, b : near + b] + weft[a : near + a, :near]
            cloth[a::2, b::2] = (left > 0) & (flag[:near, :near] & ERODED == 0)
    flat, smooth = facets(x), spline(x)
    if flag.any():
        torn = np.pad(flag != 0, ((1, 0), (1, 0)), mode="edge")
        torn = torn[1:, 1:] | torn[:-1, 1:] | torn[1:, :-1] | torn[:-1, :-1]
        smooth = np.where(torn.repeat(2, 0).repeat(2, 1)[:-1, :-1, None], flat, smooth)
    return flat, smooth, cloth


def spline(x: FloatArray) -> FloatArray:
    """Twice as many places, of the spline over the nodes, with images of those next to planes of symmetry."""
    for axis in (0, 1):
        rows = np.moveaxis(x, axis, 0)
        image = rows[1:2] * np.where(np.arange(3) == axis, -1.0, 1.0)
        image = np.concatenate([image, rows])
        fine = np.empty((2 * len(rows) - 1, *rows.shape[1:]))
        fine[1::2], fine[-1] = 0.5 * (rows[1:] + rows[:-1]), rows[-1]
        fine[:-1:2] = 0.75 * rows[:-1] + 0.125 * (image[:-2] + image[2:])
        x = np.moveaxis(fine, 0, axis)
    return x


def facets(x: FloatArray) -> FloatArray:
    """Twice as many places, of the bilinear facets between the nodes."""
    for axis in (0, 1):
        rows = np.moveaxis(x, axis, 0)
        fine = np.empty((2 * len(rows) - 1, *rows.shape[1:]))
        fine[::2], fine[1::2] = rows, 0.5 * (rows[1:] + rows[:-1])
        x = np.moveaxis(fine, 0, axis)
    return x


def points(march: PackSolver, p: int, x: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Middles of the elements of a ply, and which of them have cloth."""
    near = len(x) - 1
    warp, weft = (by_element(march, p, "intact_fraction", near, family) for family in (0, 1))
    left = warp[:-1, :-1] + warp[:-1, 1:] + weft[:-1, :-1] + weft[1:, :-1]
    held = (left > 0) & (by_element(march, p, "element_flag", near)[:-1, :-1] & ERODED == 0)
    return 0.25 * (x[1:, 1:] + x[:-1, 1:] + x[1:, :-1] + x[:-1, :-1]), held


def crossings(x: Any, held: Any, Y: Any, cloth: Any) -> list[Any]:
    """Which points cross which facets, and which way: list of (element of the point, facet, 1 or -1).

    x : (n, n, 3) pair of places of points before and after a step; held : (n, n) which count
    Y : (m + 1, m + 1, 3) pair of places of the corners of facets; cloth : (m, m) which count
    A point that goes there and back within the step has not crossed.
    """
    x = np.stack([a[held] for a in x])
    ring = np.stack([np.stack([a[:-1, :-1], a[1:, :-1], a[1:, 1:], a[:-1, 1:]])[:, cloth] for a in Y])
    n, m = near_each_other(x, ring)
    if n.size == 0:
        return []
    elements, patches, found = np.argwhere(held), np.argwhere(cloth), []
    # of a quarter of an element the diagonal between node and middle goes from its first corner, or from the second
    turn = patches[m].sum(axis=1) % 2
    x = x[:, n]
    a, b, c, d = (ring[:, (k + turn) % 4, m] for k in range(4))
    way = pierced(x, a, b, c) + pierced(x, a, c, d)
    for point in np.unique(n[way != 0]):
        own = np.flatnonzero((n == point) & (way != 0))
        if way[own].sum():
            found.append((elements[point], patches[m[own[0]]], int(np.sign(way[own].sum()))))
    return found


def near_each_other(x: FloatArray, ring: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs (point, facet) whose boxes over the step overlap; found by columns of a raster across the plies."""
    low, high = ring.min(axis=(0, 1)), ring.max(axis=(0, 1))
    least, most = x.min(axis=0), x.max(axis=0)
    if not (len(low) and len(least)):
        return np.empty(0, int), np.empty(0, int)
    size = np.median((high - low)[:, :2], axis=0)
    origin = np.minimum(low[:, :2].min(axis=0), least[:, :2].min(axis=0))
    a, b = (np.floor((ends[:, :2] - origin) / size).astype(int) for ends in (low, high))
    width = b[:, 1].max() + 2
    span = b - a + 1
    count = span.prod(axis=1)
    facet = np.repeat(np.arange(len(low)), count)
    place = np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count)
    cell = (a[facet, 0] + place // span[facet, 1]) * width + a[facet, 1] + place % span[facet, 1]
    order = np.argsort(cell, kind="stable")
    cell, facet = cell[order], facet[order]
    bottom, top, floor, ceiling = (np.ascontiguousarray(ends[:, 2]) for ends in (least, most, low, high))
    found = []
    for ends in (least, most):  # a point seldom changes its cell within a step
        at = np.floor((ends[:, :2] - origin) / size).astype(int)
        at = np.where((at[:, 1] < width), at[:, 0] * width + at[:, 1], -1)
        start, end = np.searchsorted(cell, at, "left"), np.searchsorted(cell, at, "right")
        n = np.repeat(np.arange(len(at)), end - start)
        m = facet[np.arange(len(n)) - np.repeat(np.cumsum(end - start) - (end - start), end - start) + start[n]]
        near = (top[n] >= floor[m]) & (bottom[n] <= ceiling[m])  # of most pairs the heights alone tell
        found.append(np.stack([n[near], m[near]]))
    n, m = np.unique(np.concatenate(found, axis=1), axis=1)
    both = np.all((most[n] >= low[m]) & (least[n] <= high[m]), axis=-1)
    return n[both], m[both]


def pierced(x: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> IntArray:
    """(n,) which points cross the triangles a, b, c, and which way; all (2, n, 3), before and after the step."""
    corners = np.stack([a, b, c], axis=2)
    side = np.linalg.det(corners - x[:, :, None])
    share = (side[0] / np.where(side[0] == side[1], 1.0, side[0] - side[1]))[:, None]
    at = x[0] + share * (x[1] - x[0])
    a, b, c = (one[0] + share * (one[1] - one[0]) for one in (a, b, c))
    normal = np.cross(b - a, c - a)
    crossed = (side[0] < 0) != (side[1] < 0)
    for one, other in ((a, b), (b, c), (c, a)):
        crossed &= np.einsum("ij,ij->i", np.cross(other - one, at - one), normal) >= 0
    return np.where(crossed, np.where(side[0] < 0, 1, -1), 0)


def count(march: PackSolver, end: float, near: int, begin: float = 0.0) -> tuple[list[Any], list[Any]]:
    """Passages of a march from `begin` to `end` [s], or until it ends: (those for good, those undone at once)."""
    march.exchange = np.inf  # the steps are made here one by one, whatever is exchanged
    march.advance(np.empty((0, 3)))
    if begin:
        march.advance(np.empty((round(begin / march.const.dt), 3)))
    passages, reason = Passages(march, near), 0
    while march.time < end and not reason:
        made, reason = march.advance(np.empty((1, 3)))
        march.reason = reason
        if made:
            passages.step()
    return passages.found, passages.back
