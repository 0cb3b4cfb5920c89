"""Named tuples that the kernels of a pack take; fields, shapes and units: docs/developers/kernel-arrays.md."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Sequence

import numpy as np

from fabrics.checks import FloatArray
from shellfabric.jit.by_reference import by_reference
from shellfabric.panel.arrays import Constants, State
from shellfabric.plies.near_kernels import NEAR, TALL, WIDE

_PAIRS, _ENTRIES = 60, 20  # room for pairs of tiles, of a tile, and of facets, of a node, in the mean

Pair = namedtuple(
    "Pair",
    "closest_point cp_rate normal last_depth depth_offset status on_facet recheck_step max_speed f_front f_rear "
    "front_window rear_window front_box rear_box energy near_torn torn_elements torn_counts "
    "lane_index surface_form points_per_side point_offset law law_step thickness rest_distance min_deflection "
    "area_factor1 area_factor2 friction slip_stiffness slip_damping friction_state normal_force turn",
)
Guard = namedtuple(
    "Guard",
    "f window rest x y impulse kick mirror shape slots dt thickness thickest has_planes turns tile_ply first_tile "
    "tiles_across travel ahead travel_then placed plane_due box order block_speed dropped pair_tiles pair_due "
    "entry_nodes entry_pair entry_end entry_due facets facet_box row_nodes row_normal row_need "
    "node_step node_list root cluster count energy",
)
Stack = namedtuple(
    "Stack", "awake waits_for_plies counter projectile_position f_contact_nose ply_counters projectile_velocity turns"
)

by_reference(Pair, Guard, Stack)


def guard(
    consts: Sequence[Constants],
    states: Sequence[State],
    rest: Sequence[FloatArray],
    thicknesses: Sequence[float],
    dt: float,
    turns: FloatArray | None,
) -> Guard:
    """The guard of plies at rest; node k of ply p is number p slots + k.

    Parameters
    ----------
    consts, states : of the plies
    rest : of each ply, (nodes, 3) [m] its nodes at rest in the frame of the first one
    thicknesses : (plies,) [m]
    dt : [s] time step
    turns : (plies, 2) of `turn_kernels.turn_of`, or None
    """
    plies, slots = len(consts), max(state.mass.size for state in states)
    places, kick, mirror = np.zeros((plies, slots, 3)), np.zeros((plies, slots)), np.zeros((plies, slots), np.uint8)
    for p, (const, state, nodes) in enumerate(zip(consts, states, rest)):
        places[p, : len(nodes)], kick[p, : state.mass.size] = nodes, state.dt_over_mass
        mirror[p, : const.row_stride] |= np.uint8(const.mirror_x)
        mirror[p, : len(nodes) : const.row_stride] |= np.uint8(2 * const.mirror_y)
    down, across = np.array([(-(-c.ni // TALL), -(-c.nj // WIDE)) for c in consts]).T
    first = np.concatenate([[0], np.cumsum(down * across)])
    nodes, tiles = plies * slots, int(first[-1])
    return Guard(
        rest=places.reshape(-1, 3),
        kick=kick.ravel(),
        mirror=mirror.ravel(),
        window=np.array([[c.ni + 1, 0, c.row_stride, 0] for c in consts]),
        shape=np.array([(c.row_stride, c.ni, c.nj, c.mirror_x, c.mirror_y) for c in consts]),
        thickness=np.array(thicknesses),
        thickest=max(thicknesses),
        has_planes=bool(consts[0].mirror_x or consts[0].mirror_y),
        tile_ply=np.repeat(np.arange(plies), np.diff(first)),
        first_tile=first,
        tiles_across=across,
        order=np.arange(tiles),
        count=np.array([0, 0, 0, 0, 0, 1]),
        energy=np.array([0.0, 0.0, NEAR, 0.0]),
        **_zeros("f", plies, 3, slots),
        **_zeros("x y impulse", nodes, 3),
        **_zeros("cluster", nodes, 5),
        **_zeros("dropped", nodes, kind=np.uint8),
        **_zeros("node_step node_list root", nodes, kind=np.int64),
        **_zeros("travel ahead travel_then plane_due", tiles),
        **_zeros("placed", tiles, kind=np.int64),
        **_zeros("box", tiles, 6),
        **_zeros("block_speed", int(((down + 1) * (across + 1)).max())),
        **_lists(_ENTRIES * max(nodes, 20_000), nodes, _PAIRS * tiles),
        slots=slots,
        dt=dt,
        turns=turns,
    )


def _lists(entries, nodes, pairs):
    """Room for pairs of tiles, for near facets, and for rows of all these and of nodes at the planes of symmetry."""
    rows, most = entries + 2 * nodes, 4 * (TALL + 1) * (WIDE + 1)
    return {
        **_zeros("pair_tiles", pairs, 2, kind=np.int64),
        **_zeros("pair_due", pairs),
        **_zeros("entry_nodes", entries, 6, kind=np.int32),
        **_zeros("entry_pair", entries, kind=np.int64),
        **_zeros("entry_end entry_due", entries),
        **_zeros("facets", 2, most, 3, kind=np.int64),
        **_zeros("facet_box", 2, most, 6),
        **_zeros("row_nodes", rows, 6, kind=np.int32),
        **_zeros("row_normal", rows, 3),
        **_zeros("row_need", rows),
    }


def _zeros(names, *shape, kind=float):
    """{name: zeros of a shape} of several arrays."""
    return {name: np.zeros(shape, kind) for name in names.split()}
