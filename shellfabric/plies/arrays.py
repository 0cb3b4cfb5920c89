"""The arrays of the contact between the plies of a pack (`shellfabric.state.PackContact`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.jit.simd import WIDTH
from shellfabric.plies.frame_kernels import TALL, WIDE
from shellfabric.plies.near_kernels import LEAST, NEAR, REMAKE, STEP
from shellfabric.state import Constants, PackContact, State

_PAIRS = 60  # room for pairs of tiles, of a tile in the mean
_ENTRIES = 20  # room for pairs of facets, of a node in the mean


def pack_contact(
    consts: Sequence[Constants],
    states: Sequence[State],
    heights: FloatArray,
    thicknesses: Sequence[float],
    turns: FloatArray,
    **of_points: Any,
) -> PackContact:
    """The contact between plies at rest.

    Parameters
    ----------
    consts, states : of the plies
    heights : (plies,) [m] of their middle surfaces at rest
    thicknesses : (plies,) [m]
    turns : (plies, 2) cosine and sine of the angles from the first frame to those of the plies
    of_points : `points` along each side of an element; `first_point` (plies,), `closest_a` and
        `closest_b` of all points, `first_element` (plies,) and `area` of all elements; `laws`,
        `law_step` (`numerics.law_tables`), `friction`, `stick_damping` and `side_by_side` (plies,)
    """
    plies = len(consts)
    shape = np.array([(c.nj + 3, c.ni, c.nj, c.mirror_x, c.mirror_y) for c in consts])
    slots = int(max((s[1] + 3) * s[0] for s in shape)) + 4 * WIDTH
    base = np.arange(plies) * slots + shape[:, 0] + 1
    nodes = plies * slots
    x = np.zeros((3, nodes))
    for p, state in enumerate(states):
        flat = state.surface.rest
        own = x[:, p * slots :][:, : flat[0].size]
        c, s = turns[p]
        own[0] = c * flat[0] - s * flat[1]
        own[1] = s * flat[0] + c * flat[1]
        own[2] = heights[p]
    kick = np.zeros(nodes)
    mirror = np.zeros(nodes, np.uint8)
    for p, (const, state) in enumerate(zip(consts, states)):
        rows = np.arange(const.ni + 1) * shape[p, 0]
        numbers = base[p] + np.add.outer(rows, np.arange(const.row_stride))
        kick[numbers] = state.dt_over_mass[: numbers.size].reshape(numbers.shape)
        mirror[numbers[0]] |= np.uint8(const.mirror_x)
        mirror[numbers[:, 0]] |= np.uint8(2 * const.mirror_y)
    down = np.array([-(-c.ni // TALL) for c in consts])
    across = np.array([-(-c.nj // WIDE) for c in consts])
    first = np.concatenate([[0], np.cumsum(down * across)])
    tiles = int(first[-1])
    no_nodes = np.array([(c.ni + 1, 0, c.nj + 1, 0) for c in consts])
    entries = _ENTRIES * max(nodes, 20_000)
    sizes = {
        "plies": plies,
        "slots": slots,
        "plies slots": nodes,
        "slots of State": max(state.mass.size for state in states),
        "points + 8": of_points["closest_a"].size,
        "tiles": tiles,
        "blocks": int(((down + 1) * (across + 1)).max()),
        "pairs": _PAIRS * tiles,
        "presses": (1 + _PAIRS) * tiles,
        "entries": entries,
        "rows": entries + 2 * nodes,  # of all these, and of nodes at the planes of symmetry
        "facets": 4 * (TALL + 1) * (WIDE + 1),
    }
    found = PackContact.zeros(**sizes) | of_points
    found |= {
        "x": x,
        "rest": x.copy(),
        "kick": kick,
        "mirror": mirror,
        "base": base,
        "shape": shape,
        "slots": slots,
        "turns": turns,
        "dt": float(consts[0].dt),
        "window": np.stack([no_nodes, no_nodes], axis=1),
        "grid_window": np.stack([no_nodes, no_nodes], axis=1),
        "guard_window": no_nodes,
        "thickness": np.array(thicknesses),
        "thickest": float(max(thicknesses)),
        "longest": max(_longest(const, state) for const, state in zip(consts, states)),
        "has_planes": bool(consts[0].mirror_x or consts[0].mirror_y),
        "tile_ply": np.repeat(np.arange(plies), np.diff(first)),
        "first_tile": first,
        "tiles_across": across,
        "order": np.arange(tiles),
        "lanes": np.arange(float(WIDTH)),
    }
    found["count"][STEP] = 1
    found["count"][REMAKE] = 1
    found["guard"][LEAST] = NEAR
    return PackContact(**found)


def on_grids(states: Sequence[State], contact: PackContact) -> tuple[State, ...]:
    """The states of plies whose surfaces are parts of the grids of their contact."""
    found = []
    for p, state in enumerate(states):
        own = slice(p * contact.slots, (p + 1) * contact.slots)
        surface = state.surface._replace(
            x=tuple(contact.x[:, own]),
            v=tuple(contact.v[:, own]),
            rest=tuple(contact.rest[:, own]),
            f=tuple(np.zeros((3, contact.slots))),
            turn=contact.turns[p],
        )
        # room for what firm springs of the nose foresee
        due, given = np.zeros((2, 3, contact.slots))
        found.append(state._replace(surface=surface, dv_other=tuple(due), dv_contact=tuple(given)))
    return tuple(found)


def _longest(const, state):
    """[m] longest diagonal of an element at rest."""
    stride = const.row_stride + 2
    x, y, _ = state.surface.rest
    along = np.diff(x[stride + 1 :: stride][: const.ni + 1])
    across = np.diff(y[stride + 1 : 2 * stride - 1])
    return float(np.hypot(along.max(), across.max()))
