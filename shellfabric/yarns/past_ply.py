"""Yarns of a ply that have come past the next one: plies touch at the mean of their warp and weft
(`shadow_kernels`), and a single yarn may reach further where it has parted from those that cross
it."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray
from shellfabric.membrane.slots import by_element, places_of_nodes
from shellfabric.state import ERODED, Constants, State
from shellfabric.yarns.state import Zone

FURTHEST = 0.5  # [thicknesses] behind the surface of the next ply, from which on a node counts
NEAR = 3.0  # [radii of the projectile] about its nose, where yarns part
BESIDE = 1.0  # [spacings] from the nearest node of that surface at most: further there is none


def nodes_past(
    zone: Zone,
    panels: tuple[Any, Any],
    consts: tuple[Constants, Constants],
    states: tuple[State, State],
    apart: float,
) -> BoolArray:
    """Mark the nodes (n,) of the whole yarns of a zone, near the nose, that are FURTHEST
    thicknesses or more behind the surface of the next ply.

    Parameters
    ----------
    panels, consts, states : of the ply of the zone and of the next one
    apart : [m] between their middle surfaces at rest
    """
    from scipy.spatial import cKDTree

    front, rear = panels
    places = front.in_pack(zone.x.T)
    surface, normals = surface_of(rear, consts[1], states[1])
    surface[:, 2] += apart
    nose = front.in_pack(states[0].projectile_position)
    reach = NEAR * front.projectile.radius
    close = np.sum((places[:, :2] - nose[:2]) ** 2, axis=1) < reach**2
    found = np.zeros(len(places), bool)
    close &= zone.node_share > 0
    own = np.flatnonzero(close & zone.whole & np.roll(zone.whole, 1))
    if own.size == 0 or len(surface) == 0:
        return found
    furthest = np.hypot(BESIDE * max(rear.spacing), 2 * rear.weave.thickness)
    distance, nearest = cKDTree(surface).query(places[own], distance_upper_bound=furthest)
    beside = np.isfinite(distance)
    own, nearest = own[beside], nearest[beside]
    depth = ((places[own] - surface[nearest]) * normals[nearest]).sum(axis=1)
    found[own] = depth >= FURTHEST * rear.weave.thickness
    return found


def surface_of(panel: Any, const: Constants, state: State) -> tuple[FloatArray, FloatArray]:
    """Return the places (n, 3) [m] of the nodes of a ply that elements join, in the pack's frame,
    from the ply's plane at rest, and the unit normals (n, 3) there, along the shot."""
    places = places_of_nodes(panel, const, state)
    along, across = np.gradient(places, axis=(0, 1))
    normals = np.cross(along, across)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    fabric = np.pad(by_element(state.element_flag, const) & ERODED == 0, 1)
    joined = fabric[1:, 1:] | fabric[1:, :-1] | fabric[:-1, 1:] | fabric[:-1, :-1]
    return panel.in_pack(places[joined]), panel.in_pack(normals[joined])
