"""The arrays of a panel that the kernels work on: constants, state, scratch."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.ply_laws import half_a_ply, packing_stiffness
from shellfabric.jit.aligned import aligned_zeros
from shellfabric.jit.simd import WIDTH
from shellfabric.membrane import edges, failure, grading
from shellfabric.membrane.grid import PanelGrid
from shellfabric.membrane.motion_kernels import AT_REST
from shellfabric.membrane.slots import by_node
from shellfabric.parts import make_table, parts_of
from shellfabric.projectile import contact, window_kernels
from shellfabric.state import Constants, Numbers, PointLaw, State, Surface, Work
from shellfabric.surface.nodal_force_kernels import clear_window

USUAL_POINTS = 8  # of contact along a crossover, under a nose that they resolve
SPACING = 0.8  # [nose radii] of contact points at most: peak tensions are within 3 % of those of points much closer
# along a side of an element: all those of an element are kept in memory, four numbers each
MOST_POINTS = 32
# [mass over the square of the bound of the step] of an explicit contact with the nose at most: twice of it is
# stable with the usual damping, and yarns bounce off a nose from 1.7 times on
MOST_EXPLICIT = 0.74
_ROWS = 6  # of a block at least: with fewer, most of the work would be on the rows about it that two blocks need


def constants(panel: PanelGrid) -> Constants:
    """Compute what the kernels need to know, as plain numbers and arrays.

    Computed once: all runs of a panel read the same arrays, and no kernel writes to them.
    """
    known = panel.__dict__
    if "_constants" not in known:
        known["_constants"] = _constants(panel)
    found: Constants = known["_constants"]
    return found


def _constants(panel):
    """The constants, computed anew."""
    ni, nj = panel.counts
    dx, dy = panel.spacing
    mirror_x, mirror_y = panel.mirrors
    weave = panel.weave
    table = panel.table
    numerics = panel.numerics
    dt = panel.time_step
    w1, w2 = weave.w
    S01, S02 = weave.S0
    warp, weft = weave.yarns
    rx, ry = (1 / step for step in table.steps)
    law = {"G1": 0.0, "G2": 0.0, "gamma1": 0.5, "gamma2": 1.0}
    if panel.trellis and panel.fabric.shear:
        law = {name: getattr(panel.fabric.shear, name) for name in law}
    lag = panel.critical_step / dt
    mass = weave.areal_density * dx * dy
    x0, y0 = panel.origin
    shot = panel.shot
    warp_lines, weft_lines = failure.lines_of(panel)
    (bound1, bound_step1), (bound2, bound_step2) = table.packed.ceilings
    coefficients, constant = table.packed.potential
    rim = edges.rim(panel)
    # over the fabric: it slides, or the fabric is drawn under it; on a graded panel from within the
    # first zone
    roaming = shot.roaming or (rim["slip_node"].size > 0 and panel.sides is None)
    cv1, cv2 = (numerics.stretch_viscosity * lag * yarn.EA for yarn in (warp, weft))
    slots: dict[str, Any] = {
        "inv_dx": 1 / dx,
        "inv_dy": 1 / dy,
        "trellis_volume": dx * dy * weave.thickness,
    }
    slots |= {"cv1": cv1, "cv2": cv2}
    slots |= {"mean_weight1": 0.5, "mean_weight2": 0.5}
    if panel.sides is not None:
        slots = grading.slots(panel.sides, panel.spacing, weave.thickness, (cv1, cv2))
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
        tension_bound_table1=bound1,
        tension_bound_step1=bound_step1,
        tension_bound_table2=bound2,
        tension_bound_step2=bound_step2,
        potential_coefficients=coefficients,
        potential_constant=constant,
        table_grid=(
            table.stretch1[0],
            rx,
            table.stretch1.size - 2.0,
            table.stretch2[0],
            ry,
            table.stretch2.size - 2.0,
            table.stretch2.size - 1.0,
        ),
        table_beyond=table.packed.beyond,
        force_per_slope1=rx / (2 * w1),
        force_per_slope2=ry / (2 * w2),
        variational=table.model.cell_formulation == "variational",
        **law,
        w1=w1,
        S01=S01,
        EA1=warp.EA,
        w2=w2,
        S02=S02,
        EA2=weft.EA,
        half_strength1=warp_lines.half_strength.min(),
        half_strength2=weft_lines.half_strength.min(),
        panel=Numbers.of(panel),
        rate_law=failure.rate_table(panel.rate_law),
        erosion_gap_ratio=numerics.erosion_gap,
        window_limits=_near(panel, roaming),
        **_contact(panel, mass),
        projectile_radius=shot.radius,
        projectile_mass=shot.mass * panel.share,
        free_dofs=(float(not mirror_x), float(not mirror_y), 1.0),
        perforation_delay_steps=max(1, round(numerics.clear_time / dt)),
        nose=shot.nose,
        frame=shot.frame,
        window_follows=roaming,
        body_depth=2 * shot.radius,
        draw_in_reach=panel.reach(),
        foremost_offset=shot.top,
        shoulder=shot.shoulder,
        friction=float(shot.friction),
        holds_force=shot.deforms,
        **rim,
        bending=_bending(panel),
        packing_stiffness=float(packing_stiffness(panel.fabric)),
        packed_area=float(panel.packed_area),
        yarn_ends=edges.yarn_ends(panel),
        has_backing=panel.backing is not None,
    )


def state(panel: PanelGrid, strike_velocity: float) -> State:
    """Return the panel at rest, flat at z = 0, touched by the projectile that flies at it at
    `strike_velocity` [m/s].

    The kernels of a run compute its forces before the first step.
    """
    const = constants(panel)
    state = undeformed(panel, const, strike_velocity)
    ni = const.ni
    if const.window_follows:
        window_kernels.move_window(state, const)
        first_row, end_row, _, _ = state.contact_window
        state.first_row = max(first_row - 2, 0)
        state.end_row = min(end_row + 2, ni)
    if np.any(const.slip_length):
        # edges with a prescribed pull-in move before any wave comes to them
        state.first_row = 0
        state.end_row = ni
    for part in parts_of(state.parts):
        part.cut(state)
    return state


def undeformed(panel: PanelGrid, const: Constants, strike_velocity: float) -> State:
    """Return the state before its forces are computed."""
    s = const.row_stride
    slots = (const.ni + 2) * s + 16
    found = State.zeros(slots=slots, blocks=-(-const.ni // const.rows_per_block), rows=const.ni + 1)
    mass = found["mass"]
    mass[: (const.ni + 1) * s] = panel.masses().ravel()
    loose = np.flatnonzero(panel.loose())
    found["inverse_mass"][loose] = 1.0 / mass[loose]
    found["dt_over_mass"][:] = const.dt * found["inverse_mass"]
    lengths = zip(found["yarn_length"], _yarn_lengths(panel), found["stretch"])
    for y, length, stretch in lengths:
        y[: length.size] = length
        stretch[:] = 1.0
    if not const.variational:
        found["T"] = found["N"]
    found["intact_fraction"] = tuple((y > 0).astype(float) for y in found["yarn_length"])
    _fill_half_strengths(const, found["filtered_tension"])
    # arrays that most runs do not need are empty
    found["rate_damage"] = aligned_zeros(2, 0)
    if const.rate_law.load.size:
        found["rate_damage"] = aligned_zeros(2, slots)
    found["f_block_cloth"] = aligned_zeros(3, 0)
    if const.has_backing:
        found["f_block_cloth"] = aligned_zeros(3, slots)
    found |= contact.contact_state(const.window_limits, const.points_per_side, const.friction)
    found["surface"] = make_surface(panel, const)
    found["projectile_position"] = panel.shot.start()
    found["projectile_velocity"] = strike_velocity * panel.shot.flight
    first_row, end_row, _, _ = const.window_limits
    found["first_row"][...] = max(first_row - 2, 0)
    found["end_row"][...] = min(end_row + 2, const.ni)
    found["steps"][...] = AT_REST
    found["contact_window"][:] = const.window_limits
    found["slip_force"] = np.zeros(const.slip_node.size)
    found["slip_push"] = np.zeros(const.slip_node.size)
    found["parts"] = make_table(panel.make_parts(), panel.sides is not None)
    return State(**found)


def make_surface(panel: PanelGrid, const: Constants) -> Surface:
    """Lay out the nodes of a ply and their ghosts at rest, in its own frame at z = 0."""
    x, y = panel.coordinates()
    rest = with_ghosts(const, np.stack([x, y, np.zeros_like(x)]))
    found = Surface.zeros(**{"grid slots": rest[0].size})
    found["rest"] = rest
    for place, at_rest in zip(found["x"], rest):
        place[:] = at_rest
    found["turn"][0] = 1.0
    clear_window(found["window"], const.ni, const.row_stride)
    return Surface(**found)


def with_ghosts(const: Constants, places: FloatArray) -> tuple[FloatArray, ...]:
    """Add their ghosts to positions (3, ni + 1, nj + 1) of nodes: 3 x (grid slots) [m]
    (`grid_kernels`)."""
    grid = np.pad(places, ((0, 0), (1, 1), (1, 1)))
    for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
        lines = np.moveaxis(grid, axis + 1, 0)
        lines[0] = 2 * lines[1] - lines[2]
        lines[-1] = 2 * lines[-2] - lines[-3]
        if mirrored:
            lines[0] = lines[2]
            lines[0, axis] *= -1
    found = aligned_zeros(3, grid[0].size + 4 * WIDTH)
    for row, component in zip(found, grid):
        row[: component.size] = component.ravel()
    return found


def work(panel: PanelGrid) -> Work:
    """Allocate the scratch of one thread, for one block of elements."""
    const = constants(panel)
    rows = Work.zeros(size=(const.rows_per_block + 4) * const.row_stride + 16)
    # arrays that are needed last share the memory of those no longer needed then: scratch is to fit
    # into the cache
    rows["T"] = rows["dW_own"]
    rows["f_over_stretch"] = rows["dW_crossing"]
    rows["f_next_row"] = *rows["mean_stretch"], rows["dW_own"][0]
    return Work(**rows, contact_scratch=contact.scratch())


def _bending(panel):
    """Bending stiffness of the nodes: of each family, or on a graded panel of each slot (see
    `bending_kernels`)."""
    if panel.sides is None:
        return np.array(
            [n * EI / d for n, EI, d in zip(panel.yarns_a_line, panel.bending, panel.spacing)]
        )
    counts = panel.weave.warp_count, panel.weave.weft_count
    return grading.bending(panel.sides, counts, panel.bending)


def _block(panel):
    """Element rows of a block: all blocks are of one size, but the last."""
    ni, nj = panel.counts
    rows = max(_ROWS, panel.numerics.block / (nj + 1))
    return -(-ni // max(1, round(ni / rows)))


def _contact(panel, mass):
    """Constants of the contact of elements of a mass [kg]."""
    numerics = panel.numerics
    usual = numerics.contact_points or USUAL_POINTS
    points = max(2, -(-usual * panel.finest // panel.lines_per_crossover))
    if numerics.contact_points is None:
        resolving = np.ceil(max(panel.spacing) / (SPACING * panel.projectile.nose_radius))
        points = max(points, int(min(resolving, MOST_POINTS)))
    return {"points_per_side": points, "point_law": nose_law(panel, mass / points**2)}


def nose_law(panel: PanelGrid, mass: float, *, implicit: bool = False) -> PointLaw:
    """Compute the law of contact points of the fabric with the nose, which stand for a mass [kg]:
    half a ply of solid fibre.

    An explicit spring is no stiffer than the bound of the step bears, which only meshes of one or two
    elements a crossover feel. That of a ply of a pack, which other plies press on besides, is
    implicit, and has any stiffness.
    """
    numerics = panel.numerics
    area = mass / panel.weave.areal_density
    stiffness = numerics.nose_stiffness * half_a_ply(panel.fabric) * area
    if not implicit:
        stiffness = min(stiffness, MOST_EXPLICIT * mass / panel.largest_step**2)
    law = contact.point_law(
        mass, stiffness, numerics.contact_damping, numerics.cfl, panel.time_step
    )
    return law._replace(implicit=float(implicit))


def _yarn_lengths(panel):
    """(warp, weft) [m] length of yarn of each edge at its slot: an edge's own times its yarns, half
    on the rim."""
    counts = panel.weave.warp_count, panel.weave.weft_count
    areas = grading.edge_areas(*panel.element_sides)
    return [(count * area).ravel() for count, area in zip(counts, areas)]


def _fill_half_strengths(const, slots):
    """Fill (warp, weft) slots of the nodes with half of the strength of their lines, as finite
    numbers."""
    warp, weft = (
        np.nan_to_num(lines.half_strength) for lines in (const.warp_lines, const.weft_lines)
    )
    by_node(slots[0], const)[:] = warp
    by_node(slots[1], const)[:] = weft[:, None]


def _near(panel, roaming):
    """Element rows and columns (i0, i1, j0, j1) that can come under the projectile: all of them if
    it roams, on a graded panel those of the first zone."""
    if roaming:
        return panel.first_zone()
    bounds = []
    for start, step, count, reach in zip(panel.origin, panel.spacing, panel.counts, panel.reach()):
        bounds += [
            max(0, int((-reach - start) / step)),
            min(count, int((reach - start) / step) + 1),
        ]
    return tuple(bounds)
