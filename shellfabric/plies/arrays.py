"""The arrays of the contact between the plies of a pack (`plies.state`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.jit.simd import WIDTH
from shellfabric.plies.frame_kernels import TALL, WIDE
from shellfabric.plies.near_kernels import NEAR
from shellfabric.plies.state import Guard, NeighbourLists, PackContact, Pressure
from shellfabric.state import Constants, State

_PAIRS = 60  # capacity for pairs of tiles, of a tile in the mean
_FACET_PAIRS = 20  # capacity for pairs of facets, of a node in the mean


def pack_contact(
    consts: Sequence[Constants],
    states: Sequence[State],
    heights: FloatArray,
    thicknesses: Sequence[float],
    turns: FloatArray,
    **of_points: Any,
) -> PackContact:
    """Set up the contact between plies at rest.

    Parameters
    ----------
    consts, states : of the plies
    heights : (plies,) [m] of their middle surfaces at rest
    thicknesses : (plies,) [m]
    turns : (plies, 2) cosine and sine of the angles from the first frame to those of the plies
    of_points : of `Pressure` what it needs of points, laws and friction: `points_per_side`,
        `first_point`, `closest_a`, `closest_b`, `first_element`, `area_ratio`, `laws`, `law_cell`
        (`numerics.law_tables`), `resilience`, `share_drag`, `friction`, `stick_stiffness`,
        `stick_damping` and `same_angle`
    """
    plies = len(consts)
    ni = np.array([c.ni for c in consts])
    nj = np.array([c.nj for c in consts])
    stride = nj + 3
    slots = int(((ni + 3) * stride).max()) + 4 * WIDTH
    base = np.arange(plies) * slots + stride + 1
    nodes = plies * slots
    x = np.zeros((3, nodes))
    for p, state in enumerate(states):
        flat = state.surface.rest
        own = x[:, p * slots :][:, : flat[0].size]
        c, s = turns[p]
        own[0] = c * flat[0] - s * flat[1]
        own[1] = s * flat[0] + c * flat[1]
        own[2] = heights[p]
    dt_over_mass = np.zeros(nodes)
    plane_bits = np.zeros(nodes, np.uint8)
    for p, (const, state) in enumerate(zip(consts, states)):
        rows = np.arange(const.ni + 1) * stride[p]
        numbers = base[p] + np.add.outer(rows, np.arange(const.row_stride))
        dt_over_mass[numbers] = state.dt_over_mass[: numbers.size].reshape(numbers.shape)
        plane_bits[numbers[0]] |= np.uint8(const.mirror_x)
        plane_bits[numbers[:, 0]] |= np.uint8(2 * const.mirror_y)
    down = np.array([-(-c.ni // TALL) for c in consts])
    across = np.array([-(-c.nj // WIDE) for c in consts])
    first = np.concatenate([[0], np.cumsum(down * across)])
    tiles = int(first[-1])
    no_nodes = np.array([(c.ni + 1, 0, c.nj + 1, 0) for c in consts])
    facet_pairs = _FACET_PAIRS * max(nodes, 20_000)
    sizes = {
        "plies": plies,
        "slots": slots,
        "plies slots": nodes,
        "slots of State": max(state.mass.size for state in states),
        "points + 8": of_points["closest_a"].size,
        "tiles": tiles,
        "blocks": int(((down + 1) * (across + 1)).max()),
        "pairs": _PAIRS * tiles,
        "contact pairs": (1 + _PAIRS) * tiles,
        "facet pairs": facet_pairs,
        # of all these, and of nodes at the planes of symmetry
        "constraints": facet_pairs + 2 * nodes,
        "facets": 4 * (TALL + 1) * (WIDE + 1),
    }
    lists = NeighbourLists.zeros(**sizes) | {
        "tile_ply": np.repeat(np.arange(plies), np.diff(first)),
        "first_tile": first,
        "tiles_across": across,
        "sorted_tiles": np.arange(tiles),
    }
    pressure = Pressure.zeros(**sizes) | of_points
    pressure |= {
        "window": np.stack([no_nodes, no_nodes], axis=1),
        "grid_window": np.stack([no_nodes, no_nodes], axis=1),
    }
    guard = Guard.zeros(**sizes) | {"dt_over_mass": dt_over_mass, "window": no_nodes}
    shared = PackContact.zeros(**sizes) | {
        "x": x,
        "rest": x.copy(),
        "base": base,
        "row_stride": stride,
        "ni": ni,
        "nj": nj,
        "slots_per_ply": slots,
        "turns": turns,
        "dt": float(consts[0].dt),
        "mirror_x": bool(consts[0].mirror_x),
        "mirror_y": bool(consts[0].mirror_y),
        "plane_bits": plane_bits,
        "thickness": np.array(thicknesses),
        "max_thickness": float(max(thicknesses)),
        "max_diagonal": max(_longest(const, state) for const, state in zip(consts, states)),
    }
    contact = PackContact(
        lists=NeighbourLists(**lists), pressure=Pressure(**pressure), guard=Guard(**guard), **shared
    )
    contact.step = 1
    contact.lists.remake = 1
    contact.guard.least_gap_ratio = NEAR
    return contact


def empty_contact() -> PackContact:
    """Return the contact of a single ply, without points."""
    rows = {"lists": NeighbourLists, "pressure": Pressure, "guard": Guard}
    return PackContact.empty(**{name: table.empty() for name, table in rows.items()})


def on_grids(states: Sequence[State], contact: PackContact) -> tuple[State, ...]:
    """Place the states of plies on the grids of their contact, whose parts their surfaces are."""
    found = []
    for p, state in enumerate(states):
        own = slice(p * contact.slots_per_ply, (p + 1) * contact.slots_per_ply)
        surface = state.surface._replace(
            x=tuple(contact.x[:, own]),
            v=tuple(contact.v[:, own]),
            rest=tuple(contact.rest[:, own]),
            f=tuple(np.zeros((3, contact.slots_per_ply))),
            turn=contact.turns[p],
        )
        # predicted increments, if springs of the nose are implicit
        due, given = np.zeros((2, 3, contact.slots_per_ply))
        found.append(state._replace(surface=surface, dv_other=tuple(due), dv_contact=tuple(given)))
    return tuple(found)


def _longest(const, state):
    """[m] longest diagonal of an element at rest."""
    stride = const.row_stride + 2
    x, y, _ = state.surface.rest
    along = np.diff(x[stride + 1 :: stride][: const.ni + 1])
    across = np.diff(y[stride + 1 : 2 * stride - 1])
    return float(np.hypot(along.max(), across.max()))
