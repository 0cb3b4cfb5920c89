"""Nodes at the edges of a panel: where yarns end, which nodes slip, and what a picture shows."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from shellfabric.membrane.bending_kernels import CLAMPED_END, FREE_END, SYMMETRY_END
from shellfabric.membrane.boundary import Grip, slips
from shellfabric.membrane.grading import tributary
from shellfabric.membrane.grid import PanelGrid
from shellfabric.projectile.frames import axes


def shown(panel: PanelGrid) -> list[FloatArray]:
    """Return [X, Y] (ni+1, nj+1) [m] of the nodes at rest in the panel's frame, those beyond the
    opening moved onto its edge: what a picture shows of a grid that lies in the clamp out there."""
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
    """Find the nodes (i, j) where the warp and the weft yarn nearest the impact point end, at high
    x and at high y."""
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


def rim(panel: PanelGrid) -> dict[str, Any]:
    """Return {name in `Constants`: (n,) values} of the nodes of the sides that slip."""
    found: dict[str, list[Any]] = {
        "slip_node": [np.zeros(0, np.int64)],
        "slip_axis": [np.zeros(0, np.int64)],
        "slip_length": [np.zeros(0)],
        "slip_start": [np.zeros(0)],
        "slip_end": [np.zeros(0)],
        "slip_grip": [np.zeros(0)],
        "slip_mass": [np.zeros(0)],
    }
    if not slips(panel.boundary):
        return {name: parts[0] for name, parts in found.items()}
    given = panel.supports
    ni, nj = panel.counts
    mass = panel.masses()
    numbers = np.arange((ni + 1) * (nj + 1)).reshape(ni + 1, nj + 1)
    for axis, pair in enumerate(given):
        count = (panel.weave.warp_count, panel.weave.weft_count)[axis]
        place = np.moveaxis(np.array(panel.coordinates()[1 - axis]), axis, 0)[0]
        for end, side in zip((0, -1), pair):
            if isinstance(side, str) or (end == 0 and panel.mirrors[axis]):
                continue
            keep = np.ones(place.size, bool)
            keep[0] = panel.mirrors[1 - axis] or given[1 - axis][0] == "free"
            keep[-1] = given[1 - axis][1] == "free"
            own = {name: np.zeros(place.size, parts[0].dtype) for name, parts in found.items()}
            own["slip_node"][:] = np.moveaxis(numbers, axis, 0)[end]
            own["slip_axis"][:] = axis
            own["slip_mass"][:] = np.moveaxis(mass, axis, 0)[end]
            if isinstance(side, Grip):
                yarns = count * tributary(panel.element_sides[1 - axis])
                own["slip_grip"][:] = side.clamp_force * yarns
            else:
                drawn = side.pull_in * np.maximum(1 - np.abs(place) / (0.5 * side.zone), 0)
                if end == -1:
                    drawn = -drawn  # inwards
                own["slip_length"][:] = drawn
                own["slip_start"][:] = side.start
                own["slip_end"][:] = side.end
            for name, values in own.items():
                found[name].append(values[keep])
    return {name: np.concatenate(parts) for name, parts in found.items()}


def yarn_ends(panel: PanelGrid) -> IntArray:
    """Return how warp and weft yarns end at their lowest and highest place, (2, 2), as
    `bending_kernels` has it."""
    ends = np.full((2, 2), CLAMPED_END)
    for family, pair in enumerate(panel.supports):
        for end, side in enumerate(pair):
            if side == "free":
                ends[family, end] = FREE_END
    for family, mirrored in enumerate(panel.mirrors):
        if mirrored:
            ends[family, 0] = SYMMETRY_END
    return ends
