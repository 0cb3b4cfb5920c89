"""Edges of the panel: clamped, free, with a prescribed pull-in, or gripped, each of the four sides on its own.

A side is "clamped", "free", a PullIn or a Grip. Warp yarns end at the two warp sides (lowest and highest x), weft yarns
at the two weft sides. An edge is given as one side for all four, or as (warp, weft), each one side for both ends or a
pair (lowest, highest). Nodes of a slipping side move along the yarns that end there and not otherwise; where two sides
meet that are not free, the corner is held.

Fabric that slips out of the clamp is not added to the panel: as in the thesis, the edge's nodes move in.

The grid follows the yarns, and its middle is the impact point, or that of the opening where crossovers slide or a side
is not clamped (`Panel.grid_middle`). Where the weave is at an angle to the sides of the opening, the opening is round,
or its middle is not that of the grid, the grid covers the opening, and its nodes on and beyond the edge are held: the
fabric out there lies in the clamp. The clamped line is thus a staircase of crossovers, nowhere further from the edge
than the diagonal of one element.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray, IntArray
from fabrics.base.errors import InputError
from shellfabric.cloth.bending_kernels import CLAMPED_END, FREE_END, SYMMETRY_END
from shellfabric.panel.grading import tributary
from shellfabric.projectile.frames import axes

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel


@dataclass(frozen=True)
class PullIn:
    """A side that slips in the clamp by a given amount, from a triangular zone (thesis section 6.4.3).

    Parameters
    ----------
    length : [m] pull-in of the yarn through the impact point, at each end
    start, end : [s] over which it is made, evenly
    zone : [m] whole width of the triangle, at whose ends nothing slips

    Raises
    ------
    InputError : a value out of its range
    """

    length: float
    start: float
    end: float
    zone: float = 60e-3

    def __post_init__(self):
        for key in ("length", "zone"):
            if not 0 < getattr(self, key) < inf:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        if not self.start >= 0:
            raise InputError(key="start", value=self.start, allowed="at least 0")
        if not self.start < self.end < inf:
            raise InputError(key="end", value=self.end, allowed="after the start")


@dataclass(frozen=True)
class Grip:
    """A side whose clamp holds each yarn by friction, up to a force.

    Parameters
    ----------
    force : [N] per yarn

    Raises
    ------
    InputError : a force that is not positive
    """

    force: float

    def __post_init__(self):
        if not 0 < self.force < inf:
            raise InputError(key="force", value=self.force, allowed="above 0")


Boundary: TypeAlias = str | PullIn | Grip | tuple  # in any form that `sides` takes


def sides(edge: Any) -> tuple[tuple[Any, Any], ...]:
    """((lowest, highest) of the warp, (lowest, highest) of the weft) from a boundary in any of its forms.

    Raises
    ------
    InputError : a side that is none of those above
    """
    families = edge if isinstance(edge, tuple) else (edge, edge)
    pairs = tuple(family if isinstance(family, tuple) else (family, family) for family in families)
    if [len(pair) for pair in pairs] != [2, 2]:
        raise InputError(
            key="boundary", value=edge, allowed="one side, or (warp, weft) of one or two sides each"
        )
    for pair in pairs:
        for side in pair:
            if side not in ("clamped", "free") and not isinstance(side, (PullIn, Grip)):
                raise InputError(
                    key="boundary", value=side, allowed="clamped, free, a PullIn or a Grip"
                )
    return pairs


def slips(edge: Any) -> bool:
    """Whether a side of it is not simply clamped or free."""
    return any(not isinstance(side, str) for pair in sides(edge) for side in pair)


def pull_in(edge: Any) -> tuple[float, ...]:
    """(warp, weft) [m] by which fabric slips into the panel at most, of edges without grips."""
    return tuple(
        max(side.length if isinstance(side, PullIn) else 0.0 for side in pair)
        for pair in sides(edge)
    )


def check(panel: Panel) -> None:
    """InputError where the edges do not go with the panel's symmetry or with its oblique weave."""
    given = sides(panel.boundary)
    if any(mirrored and low != high for (low, high), mirrored in zip(given, panel.mirrors)):
        raise InputError(
            key="boundary", value=panel.boundary, allowed="alike at both ends of mirrored yarns"
        )
    if any(offset and mirrored for offset, mirrored in zip(panel.impact_point, panel.mirrors)):
        allowed = "0 across planes of symmetry, or symmetry = whole"
        raise InputError(key="impact_point", value=panel.impact_point, allowed=allowed)
    if panel.round and len(set(panel.opening)) > 1:
        raise InputError(
            key="opening", value=panel.opening, allowed="one diameter of a round opening"
        )
    if stepped(panel) and any(side != "clamped" for pair in given for side in pair):
        what = (
            "turned in its pack"
            if panel.ply_angle
            else "oblique"
            if panel.weave_angle
            else "in a round opening"
        )
        raise InputError(
            key="boundary", value=panel.boundary, allowed=f"clamped if the weave is {what}"
        )
    room = [0.5 * side - 2 * panel.projectile.radius for side in panel.opening]
    inside = (
        np.hypot(*panel.impact_point) < room[0]
        if panel.round
        else np.all(np.abs(panel.impact_point) < room)
    )
    if any(panel.impact_point) and not inside:
        allowed = "within the opening, two radii of the projectile from its edge"
        raise InputError(key="impact_point", value=panel.impact_point, allowed=allowed)
    if not abs(panel.weave_angle) < 1.5708:
        raise InputError(key="weave_angle", value=panel.weave_angle, allowed="within a right angle")
    if panel.weave_angle and any(panel.mirrors):
        what = (
            "a ply is turned by another angle than 90 deg"
            if panel.ply_angle
            else "the weave is oblique"
        )
        raise InputError(key="symmetry", value=panel.symmetry, allowed=f"whole if {what}")


def stepped(panel: Panel) -> bool:
    """Whether the edge of the opening is a staircase of grid lines, in place of four of them."""
    return panel.weave_angle != 0 or panel.round or any(panel.grid_middle)


def extent(panel: Panel) -> tuple[float, ...]:
    """(along warp, along weft) [m] that the grid has to cover, its middle at `Panel.grid_middle`."""
    (a, b), (x, y), (c, s) = panel.opening, panel.grid_middle, axes(panel.weave_angle)[0]
    if s == 0:
        return a + 2 * abs(x), b + 2 * abs(y)
    wide = (a, b) if panel.round else (a * c + b * abs(s), a * abs(s) + b * c)
    off = abs(c * x + s * y), abs(c * y - s * x)
    return tuple(side + 2 * far + 4 * w for side, far, w in zip(wide, off, panel.weave.w))


def in_frame(panel: Panel) -> FloatArray:
    """(2, ni+1, nj+1) [m] places of the nodes at rest from the middle of the opening, along its two sides."""
    (X, Y), (c, s) = panel.coordinates(), axes(panel.weave_angle)[0]
    return np.stack([c * X - s * Y + panel.impact_point[0], s * X + c * Y + panel.impact_point[1]])


def shown(panel: Panel) -> list[FloatArray]:
    """[X, Y] (ni+1, nj+1) [m] of the nodes at rest in the panel's frame, those beyond the opening moved onto its edge:
    what a picture shows of a grid that lies in the clamp out there."""
    places = panel.coordinates()
    if not stepped(panel):
        return places
    at, half = in_frame(panel), 0.5 * np.array(panel.opening)[:, None, None]
    onto = (
        at * (half[0] / np.maximum(np.hypot(*at), half[0]))
        if panel.round
        else np.clip(at, -half, half)
    )
    (x, y), (c, s) = onto - np.array(panel.impact_point)[:, None, None], axes(panel.weave_angle)[0]
    beyond = np.any(onto != at, axis=0)
    return [
        np.where(beyond, moved, place)
        for moved, place in zip((c * x + s * y, c * y - s * x), places)
    ]


def loose(panel: Panel) -> BoolArray:
    """(ni+1, nj+1) bool: which nodes no edge holds or leads."""
    free = np.ones(tuple(n + 1 for n in panel.counts), bool)
    for axis, (pair, mirrored) in enumerate(zip(sides(panel.boundary), panel.mirrors)):
        rows = np.moveaxis(free, axis, 0)
        if pair[1] != "free":
            rows[-1] = False
        if pair[0] != "free" and not mirrored:
            rows[0] = False
    if stepped(panel):
        place, slack = in_frame(panel), 1e-9 * min(panel.spacing)
        across, along = np.abs(place)
        inside = (across < 0.5 * panel.opening[0] - slack) & (
            along < 0.5 * panel.opening[1] - slack
        )
        free &= np.hypot(across, along) < 0.5 * panel.opening[0] - slack if panel.round else inside
    return free


def ends(panel: Panel) -> tuple[tuple[int, int], tuple[int, int]]:
    """Nodes (i, j) where the warp and the weft yarn nearest the impact point end, at high x and at high y."""
    free, start, found = loose(panel), panel.nearest_lines, []
    for line, first in ((free[:, start[1]], start[0]), (free[start[0], :], start[1])):
        held = np.flatnonzero(~line[first:])
        found.append(first + (int(held[0]) if held.size else line.size - 1 - first))
    return (found[0], start[1]), (start[0], found[1])


def rim(panel: Panel) -> tuple[IntArray, IntArray, FloatArray]:
    """What `boundary_kernels` needs of the sides that slip.

    Returns
    -------
    nodes, axes : (n,) int, flat node number and the direction in which it moves
    values : (n, 5) pull-in along that axis [m], start and end of it [s], grip [N], mass [kg]
    """
    if not slips(panel.boundary):
        return np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros((0, 5))
    given, (ni, nj), mass = sides(panel.boundary), panel.counts, panel.masses()
    numbers = np.arange((ni + 1) * (nj + 1)).reshape(ni + 1, nj + 1)
    nodes, axes, values = [], [], []
    for axis, pair in enumerate(given):
        count = (panel.weave.warp_count, panel.weave.weft_count)[axis]
        place = np.moveaxis(np.array(panel.coordinates()[1 - axis]), axis, 0)[0]
        for end, side in zip((0, -1), pair):
            if isinstance(side, str) or (end == 0 and panel.mirrors[axis]):
                continue
            share = np.full(place.size, panel.spacing[1 - axis] * count)
            share[[0, -1]] *= 0.5
            if panel.sides is not None:
                share = count * tributary(panel.sides[1 - axis])
            keep = np.ones(place.size, bool)
            keep[0] = panel.mirrors[1 - axis] or given[1 - axis][0] == "free"
            keep[-1] = given[1 - axis][1] == "free"
            row = np.zeros((place.size, 5))
            row[:, 4] = np.moveaxis(mass, axis, 0)[end]
            if isinstance(side, Grip):
                row[:, 3] = side.force * share
            else:
                inwards = 1.0 if end == 0 else -1.0
                row[:, 0] = (
                    inwards * side.length * np.maximum(1 - np.abs(place) / (0.5 * side.zone), 0)
                )
                row[:, 1:3] = side.start, side.end
            nodes.append(np.moveaxis(numbers, axis, 0)[end][keep])
            axes.append(np.full(keep.sum(), axis))
            values.append(row[keep])
    return np.concatenate(nodes), np.concatenate(axes), np.concatenate(values)


def yarn_ends(panel: Panel) -> IntArray:
    """(2, 2) how warp and weft yarns end at their lowest and highest place, as `bending_kernels` has it."""
    ends = np.array(
        [
            [FREE_END if side == "free" else CLAMPED_END for side in pair]
            for pair in sides(panel.boundary)
        ]
    )
    for family, mirrored in enumerate(panel.mirrors):
        if mirrored:
            ends[family, 0] = SYMMETRY_END
    return ends
