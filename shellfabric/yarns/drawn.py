"""The resolved yarns of a ply as pictures show them: the surface of each yarn about its chain of
nodes, in place of the membrane's elements.

A yarn is drawn as an ellipse of its width and half of the ply's thickness about its chain. The
chains alone are computed: a yarn that flattens or turns about its own axis is not seen to. The
width lies along the line from the yarn before to the yarn behind it, so that the surface turns with
the fabric; along the family that crosses where these are torn or have parted.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellfabric.yarns.state import Zone

AROUND = 6  # vertices about a section
PARTED = 1.5  # of their distance at rest: neighbours further apart say nothing of how a yarn lies
FURTHEST = 25e-3  # [m] from the impact point: yarns of a wider zone are drawn as fabric beyond


def draw_yarns(zone: Zone, panel: Any) -> dict[str, np.ndarray]:
    """Return what a `loop.snapshots.Snapshot` has of the resolved yarns of a ply.

    Parameters
    ----------
    panel : yarns.model.YarnPanel

    Returns
    -------
    yarn_surface : (n, AROUND, 3) float32 [m] sections about the nodes, yarn after yarn, in the frame
        of the pack
    yarn_tension : (n,) float32 [N] of the segment from a node to the next; not a number where there
        is none
    yarn_family : (n,) int8, 0 of warp and 1 of weft
    resolved : (ni, nj) bool, elements that the yarns stand for
    """
    corner = panel.corner
    drawn = [_drawn_rows(panel, axis) for axis in range(2)]
    resolved = np.zeros(panel.counts, bool)
    resolved[slice(*drawn[0]), slice(*drawn[1])] = True
    surfaces = []
    tensions = []
    families = []
    thickness = 0.5 * panel.weave.thickness
    for family in range(2):
        count, length = int(zone.yarns[family]), int(zone.nodes[family])
        own = slice(zone.first[family], zone.first[family] + count * length)
        place = zone.x[:, own].T.reshape(count, length, 3)
        tension = np.where(zone.whole[own], zone.tension[own], np.nan).reshape(count, length)
        width = zone.touch_distance[family]
        apart = panel.spacing[1 - family]
        surface = _sections(place, tension, family, (width, thickness), apart)
        # the rim is node 0 of a chain, the line m behind it is node 2 m, and that of yarn m - 1
        first, last = (line - corner[family] for line in drawn[family])
        low, high = (line - corner[1 - family] for line in drawn[1 - family])
        chosen = slice(max(low - 1, 0), high), slice(2 * first, 2 * last + 1)
        tension[:, 2 * last] = np.nan
        part = surface[chosen]
        surfaces.append(panel.in_pack(part.reshape(-1, AROUND, 3)))
        tensions.append(tension[chosen].ravel())
        families.append(np.full(part.shape[0] * part.shape[1], family, np.int8))
    return {
        "yarn_surface": np.concatenate(surfaces).astype(np.float32),
        "yarn_tension": np.concatenate(tensions).astype(np.float32),
        "yarn_family": np.concatenate(families),
        "resolved": resolved,
    }


def _drawn_rows(panel, axis):
    """(first, last) line of the grid along an axis between which yarns are drawn: the first and the
    last yarn of the zone, whose ends between there and the rim the membrane's elements hide."""
    first, last = panel.rim_rows[axis]
    near = np.flatnonzero(np.abs(panel.lines()[axis]) <= FURTHEST)
    return max(first + 1 - panel.mirrors[axis], int(near[0])), min(last - 1, int(near[-1]))


def _sections(place, tension, family, size, apart):
    """(yarns, nodes, AROUND, 3) [m] of chains (yarns, nodes, 3), of the size (width, height)."""
    along = np.gradient(place, axis=1)
    along /= np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), 1e-12)
    across = np.zeros(3)
    across[1 - family] = 1.0
    side = np.gradient(place, axis=0)
    distance = np.linalg.norm(side, axis=-1)
    whole = np.isfinite(tension)
    whole[:, -1] = whole[:, -2]
    beside = whole.copy()
    beside[1:] &= whole[:-1]
    beside[:-1] &= whole[1:]
    known = beside & (distance < PARTED * apart) & (distance > apart / PARTED)
    side = np.where(known[..., None], side, across)
    side = side - (side * along).sum(axis=-1, keepdims=True) * along
    side /= np.maximum(np.linalg.norm(side, axis=-1, keepdims=True), 1e-12)
    up = np.cross(along, side)
    turn = 2 * np.pi * np.arange(AROUND) / AROUND
    width, height = 0.5 * np.array(size)
    round_about = (
        width * np.cos(turn)[:, None] * side[..., None, :]
        + height * np.sin(turn)[:, None] * up[..., None, :]
    )
    return place[..., None, :] + round_about
