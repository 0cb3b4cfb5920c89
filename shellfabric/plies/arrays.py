"""Named tuples that the kernels of a pack take; fields, shapes and units: docs/developers/kernel-arrays.md."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Sequence

import numpy as np

from fabrics.checks import FloatArray
from shellfabric.jit.by_reference import by_reference
from shellfabric.panel.arrays import Constants, State
from shellfabric.plies import broad_phase_kernels
from shellfabric.plies.grading import line_offsets

_NEAREST = 0.05  # [thicknesses] that torn fabric comes to other fabric
_ENTRIES, _NEAR = 9, 20_000  # of an element in the grid of facets, in the mean; of a ply in the list of what is near

Pair = namedtuple(
    "Pair",
    "closest_point cp_rate normal last_depth depth_offset status on_facet recheck_step max_speed f_front f_rear "
    "front_window rear_window front_box rear_box energy near_torn torn_elements torn_counts deep_points deep_count "
    "lane_index surface_form points_per_side point_offset law law_step thickness rest_distance min_deflection "
    "area_factor1 area_factor2 friction slip_stiffness slip_damping friction_state normal_force turn",
)
TornContact = namedtuple(
    "TornContact",
    "f window x x_next dt_over_mass z_rest min_distance ply_grid ply_shape dt zone_mark intact_quadrants elements "
    "nodes counts failures box_low box_high cell_head entry_element entry_cell entry_next candidates "
    "candidate_normal last_moved sweep energy line_offset turns",
)
Stack = namedtuple(
    "Stack", "awake waits_for_plies counter projectile_position f_contact_nose ply_counters projectile_velocity turns"
)

by_reference(Pair, TornContact, Stack)


def torn_contact(
    consts: Sequence[Constants],
    states: Sequence[State],
    places: FloatArray,
    thicknesses: Sequence[float],
    dt: float,
    turns: FloatArray | None,
) -> TornContact:
    """What keeps torn plies apart, at rest; arrays as wide as those of the largest ply.

    Parameters
    ----------
    consts, states : of the plies
    places, thicknesses : (plies,) [m]
    dt : [s] time step
    turns : (plies, 2) of `turn_kernels.turn_of`, or None
    """
    count, n = len(consts), max(state.mass.size for state in states)
    pad = 2 * broad_phase_kernels.PAD
    cells, room = max((c.ni + pad) * (c.nj + pad) for c in consts), _ENTRIES * max(n, 100)
    kick = np.zeros((count, n))
    for row, state in zip(kick, states):
        row[: state.dt_over_mass.size] = state.dt_over_mass
    nodal = lambda: np.zeros((count, 3, n))  # noqa: E731
    return TornContact(
        f=nodal(), window=np.array([[c.ni + 1, 0, c.row_stride, 0] for c in consts]), x=nodal(), x_next=nodal(),
        dt_over_mass=kick,
        z_rest=places, min_distance=_NEAREST * np.array(thicknesses),
        ply_grid=np.array([(c.x0, c.y0, c.dx, c.dy) for c in consts]), dt=dt,
        ply_shape=np.array([(c.row_stride, c.ni, c.nj, c.mirror_x, c.mirror_y) for c in consts]), box_low=nodal(),
        box_high=nodal(),
        intact_quadrants=np.zeros((count, n), np.uint8), candidates=np.zeros((_NEAR * count, 4), np.int64),
        candidate_normal=np.zeros((_NEAR * count, 3)), last_moved=np.zeros((count, n), np.int64),
        sweep=np.zeros(1, np.int64),
        zone_mark=np.zeros((count, n), np.uint8), elements=np.zeros((count, n), np.int64),
        nodes=np.zeros((count, n), np.int64), counts=np.zeros((count, 3), np.int64), failures=np.zeros(1, np.int64),
        cell_head=np.full((count, cells), -1, np.int32), entry_element=np.zeros((count, room), np.int32),
        entry_cell=np.zeros((count, room), np.int32), entry_next=np.zeros((count, room), np.int32),
        energy=np.zeros(3), line_offset=line_offsets(consts), turns=turns,
    )  # fmt: skip
