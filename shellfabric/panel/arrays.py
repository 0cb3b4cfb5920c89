"""The arrays of a panel that the kernels work on: constants, state, scratch."""

from __future__ import annotations

from collections import namedtuple
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.ply_laws import packing_stiffness
from shellfabric.cell import packed_table
from shellfabric.jit import barrier
from shellfabric.jit.aligned import aligned_zeros
from shellfabric.jit.by_reference import by_reference
from shellfabric.panel import boundary, failure, grading
from shellfabric.panel.motion_kernels import AT_REST
from shellfabric.projectile import contact, dynamics, window_kernels

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel

_PIECE = 256  # slots that loops of two halves go over at a time (see `membrane_kernels`): a whole number of eights
USUAL_POINTS = 8  # of contact along a crossover, under a nose that they resolve
SPACING = 0.8  # [nose radii] of contact points at most: peak tensions are within 3 % of those of points much closer
MOST_POINTS = (
    32  # along a side of an element: all those of an element are kept in memory, four numbers each
)
_ROWS = 6  # of a block at least: with fewer, most of the work would be on the rows about it that two blocks need

Constants = namedtuple(
    "Constants",
    "ni nj row_stride rows_per_block n_per_crossover warp_lines weft_lines mean_reach mirror_x mirror_y x0 y0 dx "
    "dy inv_dx inv_dy dt tension1 tension2 tension_bound_table1 tension_bound_step1 tension_bound_table2 "
    "tension_bound_step2 potential_coefficients potential_constant table_start1 table_scale1 table_last1 "
    "table_start2 table_scale2 table_last2 table_grid table_beyond force_per_slope1 force_per_slope2 variational "
    "mean_weight1 mean_weight2 cv1 cv2 trellis_volume G1 G2 gamma1 gamma2 w1 S01 EA1 w2 S02 EA2 half_strength1 "
    "half_strength2 rate_law erosion_gap_ratio window_limits points_per_side shape_functions point_law "
    "projectile_radius edge_radius projectile_mass free_dofs perforation_delay_steps nose_shape nose_parameters "
    "projectile_length frame tilted window_follows body_depth draw_in_reach foremost_offset shoulder friction "
    "slip_node slip_axis slip_data bending packing yarn_ends bar_mass bar_h bar_area bar_law bar_substeps "
    "has_backing line_offset1 line_offset2",
)
State = namedtuple(
    "State",
    "u v f_int f_int_above mass inverse_mass dt_over_mass stretch N T dstretch yarn_length intact_fraction failed "
    "filtered_tension warm_rows warm_blocks rate_damage failure_sums element_flag block_damage tension_stale "
    "packed_blocks block_max_tension last_contact_force in_contact dv_other dv_contact force_scale f_contact "
    "projectile_position projectile_velocity f_contact_nose contact_energy active_rows counter energy_sums "
    "peak_tension peak_segment contact_window friction_state slip_force slip_energy f_block_nose f_block_cloth "
    "bar_u bar_v bar_plastic bar_stress bar_energy",
)
Work = namedtuple(
    "Work",
    "A B stretch1 stretch2 inv_stretch1 inv_stretch2 mean_stretch1 mean_stretch2 T1 T2 N1 N2 dW_own1 "
    "dW_own2 dW_crossing1 dW_crossing2 f_over_stretch1 f_over_stretch2 trellis_f1 trellis_f2 trellis_f12 f_next_row "
    "cell_index barrier contact_scratch",
)

by_reference(Constants, State, Work)


def constants(panel: Panel, bends: bool = False) -> Constants:
    """What the kernels need to know, as plain numbers and arrays.

    Computed once: all runs of a panel read the same arrays, and no kernel writes to them.

    bends : whether the kernels know of bending even if this panel has none, as they have to if another ply of its pack
        has it
    """
    kept: dict[bool, Constants] = panel.__dict__.setdefault("_constants", {})
    if bends not in kept:
        kept[bends] = _constants(panel, bends)
    return kept[bends]


def _constants(panel, bends):
    """The constants, computed anew."""
    (ni, nj), (dx, dy), (mirror_x, mirror_y) = panel.counts, panel.spacing, panel.mirrors
    weave, table, knobs, dt = panel.weave, panel.table, panel.numerics, panel.time_step
    (w1, w2), (S01, S02), (warp, weft) = weave.w, weave.S0, weave.yarns
    rx, ry = (1 / step for step in table.steps)
    shear = panel.fabric.shear if panel.trellis else None
    G1, G2, gamma1, gamma2 = (
        (shear.G1, shear.G2, shear.gamma1, shear.gamma2) if shear else (0.0, 0.0, 0.5, 1.0)
    )
    lag = panel.critical_step / dt
    mass = weave.areal_density * dx * dy
    (x0, y0), shot = panel.origin, panel.shot
    rim_node, rim_axis, rim = panel.rim()
    warp_lines, weft_lines = failure.lines_of(panel)
    # over the fabric: it slides, or the fabric is drawn under it; on a graded panel from within the first zone
    roaming = shot.roaming or (rim_node.size > 0 and panel.sides is None)
    cv1, cv2 = (knobs.stretch_viscosity * lag * yarn.EA for yarn in (warp, weft))
    slots: dict[str, Any] = {
        "inv_dx": 1 / dx,
        "inv_dy": 1 / dy,
        "trellis_volume": dx * dy * weave.thickness,
    }
    slots |= {"cv1": cv1, "cv2": cv2, "line_offset1": None, "line_offset2": None}
    slots |= {"mean_weight1": 0.5, "mean_weight2": 0.5}
    if panel.sides is not None:
        slots = grading.slots(
            panel.sides, panel.spacing, weave.thickness, (cv1, cv2), aligned_zeros
        )
        slots |= grading.line_offsets(panel.lines(), panel.origin, panel.spacing, aligned_zeros)
    return Constants(
        ni=ni,
        nj=nj,
        row_stride=nj + 1,
        rows_per_block=_block(panel),
        mirror_x=mirror_x,
        mirror_y=mirror_y,
        x0=x0,
        y0=y0,
        dx=dx,
        dy=dy,
        dt=dt,
        n_per_crossover=panel.lines_per_crossover,
        warp_lines=warp_lines,
        weft_lines=weft_lines,
        mean_reach=weft_lines.weights.shape[1] - 1,
        **slots,
        tension1=table.tension1.reshape(-1, 4),
        tension2=table.tension2.reshape(-1, 4),
        tension_bound_table1=panel.ceilings[0][0],
        tension_bound_step1=panel.ceilings[0][1],
        tension_bound_table2=panel.ceilings[1][0],
        tension_bound_step2=panel.ceilings[1][1],
        potential_coefficients=panel.potential[0],
        potential_constant=panel.potential[1],
        table_start1=table.stretch1[0],
        table_scale1=rx,
        table_last1=table.stretch1.size - 2,
        table_start2=table.stretch2[0],
        table_scale2=ry,
        table_last2=table.stretch2.size - 2,
        table_grid=(
            table.stretch1[0],
            rx,
            table.stretch1.size - 2.0,
            table.stretch2[0],
            ry,
            table.stretch2.size - 2.0,
            table.stretch2.size - 1.0,
        ),
        table_beyond=packed_table.beyond(table),
        force_per_slope1=rx / (2 * w1),
        force_per_slope2=ry / (2 * w2),
        variational=table.model.cell_formulation == "variational",
        G1=G1,
        G2=G2,
        gamma1=gamma1,
        gamma2=gamma2,
        w1=w1,
        S01=S01,
        EA1=warp.EA,
        w2=w2,
        S02=S02,
        EA2=weft.EA,
        half_strength1=warp_lines.half_strength.min(),
        half_strength2=weft_lines.half_strength.min(),
        rate_law=panel.rate_law,
        erosion_gap_ratio=knobs.widest,
        window_limits=_near(panel, roaming),
        **_contact(panel, mass),
        projectile_radius=shot.radius,
        edge_radius=shot.edge_radius,
        projectile_mass=shot.mass * panel.share,
        free_dofs=(0.0 if mirror_x else 1.0, 0.0 if mirror_y else 1.0, 1.0),
        perforation_delay_steps=max(1, round(knobs.clear_time / dt)),
        nose_shape=shot.number,
        nose_parameters=shot.form,
        projectile_length=inf if shot.length is None else shot.length,
        frame=shot.frame,
        tilted=shot.tilted,
        window_follows=roaming,
        body_depth=2 * shot.radius,
        draw_in_reach=panel.reach(),
        foremost_offset=shot.top,
        shoulder=shot.shoulder,
        friction=shot.friction,
        slip_node=rim_node,
        slip_axis=rim_axis,
        slip_data=rim,
        bending=_bending(panel) if bends or any(panel.bending) else None,
        packing=np.array([packing_stiffness(panel.fabric), panel.packed_area]),
        yarn_ends=boundary.yarn_ends(panel),
        has_backing=panel.backing is not None,
        **dynamics.constants(shot, panel.share, dt),
    )


def state(panel: Panel, strike_velocity: float) -> State:
    """The panel at rest, flat at z = 0, touched by the projectile that flies at it at `strike_velocity` [m/s].

    The kernels of a run compute its forces before the first step.
    """
    const = panel.constants()
    state, ni = undeformed(panel, const, strike_velocity), const.ni
    if const.window_follows:
        window_kernels.move_window(state, const)
        state.active_rows[:] = (
            max(state.contact_window[0] - 2, 0),
            min(state.contact_window[1] + 2, ni),
        )
    if np.any(const.slip_data[:, 0]):
        state.active_rows[:] = (
            0,
            ni,
        )  # edges with a prescribed pull-in move before any wave comes to them
    return state


def undeformed(panel: Panel, const: Constants, strike_velocity: float) -> State:
    """The state before its forces are computed."""
    ni, s = const.ni, const.row_stride
    slots = (ni + 2) * s + 16
    (mass, inverse), (kick,) = aligned_zeros(2, slots), aligned_zeros(1, slots)
    mass[: (ni + 1) * s] = panel.masses().ravel()
    loose = np.flatnonzero(boundary.loose(panel))
    inverse[loose] = 1.0 / mass[loose]
    kick[:] = const.dt * inverse
    blocks = -(-ni // const.rows_per_block)
    three, two = (lambda: aligned_zeros(3, slots)), (lambda: aligned_zeros(2, slots))
    small = aligned_zeros(
        2, slots, np.float32
    )  # of the last changes of stretch: they enter the audit alone
    forces, lengths, stretches = two(), two(), two()
    for y, length, L in zip(lengths, _yarn_lengths(panel, const), stretches):
        y[: length.size], L[:] = length, 1.0
    i0, i1 = const.window_limits[:2]
    return State(
        u=three(),
        v=three(),
        f_int=three(),
        f_int_above=three(),
        mass=mass,
        inverse_mass=inverse,
        dt_over_mass=kick,
        stretch=stretches,
        N=forces,
        T=two() if const.variational else forces,
        dstretch=small,
        yarn_length=lengths,
        intact_fraction=tuple((y > 0).astype(float) for y in lengths),
        failed=(np.zeros(slots, np.uint8), np.zeros(slots, np.uint8)),
        filtered_tension=_half_strengths(const, two()),
        warm_rows=np.zeros((2, ni + 1), np.bool_),
        warm_blocks=np.zeros(blocks, np.bool_),
        rate_damage=aligned_zeros(2, slots if const.rate_law is not None else 0),
        failure_sums=np.zeros(2),
        block_damage=np.zeros(blocks, np.uint8),
        tension_stale=np.zeros(blocks, np.bool_),
        packed_blocks=np.zeros(blocks, np.bool_),
        block_max_tension=np.zeros((blocks, 2)),
        element_flag=np.zeros(slots, np.uint8),
        f_contact=three(),
        **contact.contact_state(
            const.window_limits, const.points_per_side, const.shape_functions, const.friction
        ),
        projectile_position=panel.shot.start(),
        projectile_velocity=strike_velocity * panel.shot.flight,
        f_contact_nose=np.zeros(3),
        contact_energy=np.zeros(5),
        active_rows=np.array([max(i0 - 2, 0), min(i1 + 2, ni)]),
        counter=np.array([AT_REST, 0, 0]),
        energy_sums=np.zeros((blocks, 4)),
        peak_tension=np.zeros(2),
        peak_segment=np.zeros((2, 2), np.int64),
        contact_window=np.array(const.window_limits),
        slip_force=np.zeros(const.slip_node.size),
        slip_energy=np.zeros(3),
        f_block_nose=np.zeros(3),
        f_block_cloth=three() if const.has_backing else aligned_zeros(3, 0),
        **dynamics.state(panel.shot, strike_velocity),
    )


def work(panel: Panel) -> Work:
    """Scratch of one thread, for one block of elements."""
    const = panel.constants()
    size = (const.rows_per_block + 4) * const.row_stride + 16
    rows = {name: aligned_zeros(1, size)[0] for name in Work._fields}
    rows["A"], rows["B"] = aligned_zeros(3, size), aligned_zeros(3, size)
    rows["barrier"] = np.zeros(barrier.SLOTS, np.int64)
    rows["cell_index"] = np.zeros(_PIECE, np.int32)
    # arrays that are needed last share the room of those no longer needed then: scratch is to fit into the cache
    rows["T1"], rows["T2"], rows["f_over_stretch1"], rows["f_over_stretch2"] = (
        rows[name] for name in ("dW_own1", "dW_own2", "dW_crossing1", "dW_crossing2")
    )
    rows["f_next_row"] = rows["mean_stretch1"], rows["mean_stretch2"], rows["dW_own1"]
    rows["contact_scratch"] = contact.scratch(const)
    return Work(**rows)


def _bending(panel):
    """Bending stiffness of the nodes: of each family, or on a graded panel of each slot (see `bending_kernels`)."""
    if panel.sides is None:
        return np.array(
            [n * EI / d for n, EI, d in zip(panel.yarns_a_line, panel.bending, panel.spacing)]
        )
    counts = panel.weave.warp_count, panel.weave.weft_count
    return grading.bending(panel.sides, counts, panel.bending, aligned_zeros)


def _block(panel):
    """Element rows of a block: all blocks are of one size, but the last."""
    ni, nj = panel.counts
    rows = max(_ROWS, panel.numerics.block / (nj + 1))
    return -(-ni // max(1, round(ni / rows)))


def _contact(panel, mass):
    """Constants of the contact of elements of a mass [kg]."""
    knobs, usual = panel.numerics, panel.numerics.contact_points or USUAL_POINTS
    points = max(2, -(-usual * panel.finest // panel.lines_per_crossover))
    if knobs.contact_points is None:
        resolving = np.ceil(max(panel.spacing) / (SPACING * panel.projectile.nose_radius))
        points = max(points, int(min(resolving, MOST_POINTS)))
    return contact.constants(
        points, mass, panel.step_of_bound, knobs.penalty, knobs.contact_damping
    )


def _yarn_lengths(panel, const):
    """(warp, weft) [m] length of yarn of each edge at its slot: an edge's own times its yarns, half on the rim."""
    if panel.sides is not None:
        (a, b), (m, n) = panel.sides, map(grading.tributary, panel.sides)
        warp, weft = np.zeros((2, const.ni + 1, const.row_stride))
        warp[:-1], weft[:, :-1] = np.multiply.outer(a, n), np.multiply.outer(m, b)
        return [(panel.weave.warp_count * warp).ravel(), (panel.weave.weft_count * weft).ravel()]
    found, area = [], const.dx * const.dy
    for count, axis in ((panel.weave.warp_count, 0), (panel.weave.weft_count, 1)):
        y = np.zeros((const.ni + 1, const.row_stride))
        lines = np.moveaxis(y, axis, 0)[:-1]
        lines[:] = area * count
        lines[:, [0, -1]] *= 0.5
        found.append(y.ravel())
    return found


def _half_strengths(const, slots):
    """(warp, weft) slots of the nodes, filled with half of the strength of their lines, as finite numbers."""
    warp, weft = (
        np.nan_to_num(lines.half_strength) for lines in (const.warp_lines, const.weft_lines)
    )
    grids = [each[: (const.ni + 1) * const.row_stride].reshape(const.ni + 1, -1) for each in slots]
    grids[0][:], grids[1][:] = warp, weft[:, None]
    return slots


def _near(panel, roaming):
    """Element rows and columns (i0, i1, j0, j1) that can come under the projectile: all of them if it roams, on a
    graded panel those of the first zone."""
    if roaming:
        return panel.first_zone()
    bounds = []
    for start, step, count, reach in zip(panel.origin, panel.spacing, panel.counts, panel.reach()):
        bounds += [
            max(0, int((-reach - start) / step)),
            min(count, int((reach - start) / step) + 1),
        ]
    return tuple(bounds)
