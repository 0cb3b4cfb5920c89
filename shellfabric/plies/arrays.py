"""Named tuples that the kernels of a pack take; fields, shapes and units: docs/glossary.md."""

from collections import namedtuple

Pair = namedtuple(
    "Pair",
    "closest_point cp_rate normal last_depth depth_offset status on_facet recheck_step max_speed f_front f_rear "
    "front_window rear_window front_box rear_box energy near_torn torn_elements torn_counts lane_index surface_form "
    "points_per_side point_offset law law_step thickness rest_distance min_deflection area_factor1 area_factor2 "
    "friction slip_stiffness slip_damping friction_state normal_force",
)
TornContact = namedtuple(
    "TornContact",
    "f window x x_next dt_over_mass z_rest min_distance ply_grid ply_shape dt zone_mark intact_quadrants elements "
    "nodes counts failures box_low box_high cell_head entry_element entry_cell entry_next candidates "
    "candidate_normal last_moved sweep energy line_offset",
)
Stack = namedtuple(
    "Stack", "awake waits_for_plies counter projectile_position f_contact_nose ply_counters projectile_velocity"
)
