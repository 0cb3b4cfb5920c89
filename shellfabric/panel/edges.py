"""Nodes at the edges of a panel: where yarns end, which nodes slip, and what a picture shows."""

from __future__ import annotations

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from shellfabric.cloth.bending_kernels import CLAMPED_END, FREE_END, SYMMETRY_END
from shellfabric.panel.boundary import Grip, slips
from shellfabric.panel.grading import tributary
from shellfabric.panel.grid import PanelGrid
from shellfabric.projectile.frames import axes


def shown(panel: PanelGrid) -> list[FloatArray]:
    """[X, Y] (ni+1, nj+1) [m] of the nodes at rest in the panel's frame, those beyond the opening
    moved onto its edge: what a picture shows of a grid that lies in the clamp out there."""
    places = panel.coordinates()
    if not panel.stepped:
        return places
    at = panel.in_frame()
    half = 0.5 * np.array(panel.opening)[:, None, None]
    if panel.round:
        onto = at * (half[0] / np.maximum(np.hypot(*at), half[0]))
    else:
        onto = np.clip(at, -half, half)
    x, y = onto - np.array(panel.impact_point)[:, None, None]
    c, s = axes(panel.weave_angle)[0]
    beyond = np.any(onto != at, axis=0)
    return [
        np.where(beyond, moved, place)
        for moved, place in zip((c * x + s * y, c * y - s * x), places)
    ]


def ends(panel: PanelGrid) -> tuple[tuple[int, int], tuple[int, int]]:
    """Nodes (i, j) where the warp and the weft yarn nearest the impact point end, at high x and at
    high y."""
    free = panel.loose()
    start = panel.nearest_lines
    found = []
    for line, first in ((free[:, start[1]], start[0]), (free[start[0], :], start[1])):
        held = np.flatnonzero(~line[first:])
        if held.size:
            found.append(first + int(held[0]))
        else:
            found.append(line.size - 1)
    return (found[0], start[1]), (start[0], found[1])


def rim(panel: PanelGrid) -> tuple[IntArray, IntArray, FloatArray]:
    """What `boundary_kernels` needs of the sides that slip.

    Returns
    -------
    nodes, axes : (n,) int, flat node number and the direction in which it moves
    values : (n, 5) pull-in along that axis [m], start and end of it [s], grip [N], mass [kg]
    """
    if not slips(panel.boundary):
        return np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros((0, 5))
    given = panel.supports
    ni, nj = panel.counts
    mass = panel.masses()
    numbers = np.arange((ni + 1) * (nj + 1)).reshape(ni + 1, nj + 1)
    nodes = []
    axes = []
    values = []
    for axis, pair in enumerate(given):
        count = (panel.weave.warp_count, panel.weave.weft_count)[axis]
        place = np.moveaxis(np.array(panel.coordinates()[1 - axis]), axis, 0)[0]
        for end, side in zip((0, -1), pair):
            if isinstance(side, str) or (end == 0 and panel.mirrors[axis]):
                continue
            keep = np.ones(place.size, bool)
            keep[0] = panel.mirrors[1 - axis] or given[1 - axis][0] == "free"
            keep[-1] = given[1 - axis][1] == "free"
            row = np.zeros((place.size, 5))
            row[:, 4] = np.moveaxis(mass, axis, 0)[end]
            if isinstance(side, Grip):
                row[:, 3] = side.force * (count * tributary(panel.element_sides[1 - axis]))
            else:
                drawn = side.length * np.maximum(1 - np.abs(place) / (0.5 * side.zone), 0)
                if end == -1:
                    drawn = -drawn  # inwards
                row[:, 0] = drawn
                row[:, 1] = side.start
                row[:, 2] = side.end
            nodes.append(np.moveaxis(numbers, axis, 0)[end][keep])
            axes.append(np.full(keep.sum(), axis))
            values.append(row[keep])
    return np.concatenate(nodes), np.concatenate(axes), np.concatenate(values)


def yarn_ends(panel: PanelGrid) -> IntArray:
    """(2, 2) how warp and weft yarns end at their lowest and highest place, as `bending_kernels`
    has it."""
    ends = np.full((2, 2), CLAMPED_END)
    for family, pair in enumerate(panel.supports):
        for end, side in enumerate(pair):
            if side == "free":
                ends[family, end] = FREE_END
    for family, mirrored in enumerate(panel.mirrors):
        if mirrored:
            ends[family, 0] = SYMMETRY_END
    return ends
