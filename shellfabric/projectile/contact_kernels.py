"""Contact of the fabric with a rigid projectile: penalty on a signed distance, over points of a
smooth surface.

The distance is that of `sdf_kernels`, in the frame of the projectile: its nose at the origin, its
axis along z. A projectile whose axis is tilted has a frame of its own, into which positions are
rotated, and normals back out of it. Every element carries p x p points x = sum N_i x_i of the
surface of `spline_kernels`. A point with distance < 0 has

    f = max(0, -k distance - c n.(v - v_p)) n                                 (1)

and the friction of `friction_kernels`; its nodes share the force by their N_i, and the projectile
gets its opposite. Where yarns have failed, k and c are those of what is left of the two next to a
point.

In packs the spring is const.point_law.implicit_factor times as stiff, and its force is that of the
end of the step: with the depth d and the velocity v at which the point will approach by all other
forces than the nose's,

    f = max(0, k d + (c + k dt) v) / (1 + (c + k dt) dt / m)                 (2)

m = s / (A s) is the mass that a point moves, forces f accelerating the points by A f. s is the
force of a step ago and besides, on every point, the nose's force on the ply over the points of an
element (without the second part the load hops from point to point as fabric slides round the rim).
The largest eigenvalue of m A is 1 (Perron); up to 4/3 is stable for any k. Derivation, and why the
surface is smooth: docs/theory-panel.md, "Contact with the projectile".
"""

import math

import numpy as np

from shellfabric.cloth import spline_kernels
from shellfabric.cloth.nodal_force_kernels import half_step_work, keep_symmetry
from shellfabric.cloth.vector_kernels import add, add_scaled, column, dot, scaled
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, any_lane, fma, greater, load, maximum, store
from shellfabric.projectile import friction_kernels, sdf_kernels
from shellfabric.projectile.window_kernels import (
    erode,
    intact_at_point,
    move_window,
    reachable_nodes,
    window_bounds,
)
from shellfabric.state import Scratch, unit

# of state.contact_energy: energies [J], and last the largest penetration [m] of a point of whole
# fabric so far
CONTACT, SPRING, FRICTION, FRICTION_SPRING, MAX_PENETRATION = 0, 1, 2, 3, 4
MIN_FORCE_SCALE = 1e-30  # [N] force of a point of a nose that does not push yet
# first rows of work.point_data: of vectors with three components, but for OUTSIDE
PLACE, VELOCITY, OUTSIDE, AHEAD, PUSHED = 0, 3, 6, 7, 10


@unit("2 numbers", work=Scratch)
def contact_forces(state, const, work):
    """Contact forces at the present positions, into state.f_contact; the force on the projectile
    into state.f_contact_nose.

    The elements of the block of rows and columns state.contact_window, which lies in
    const.window_limits, are looked at, unless eroded: what no yarn holds is out of contact. Returns
    the work that the contact has taken in since the last call (spring and damper: half a step's of
    the old nodal forces and of the new, on the same velocities, so that nothing is left out where
    the fabric fails) and the energy in its springs.
    """
    # half a step's work of the last forces, on the velocities that they have had an effect on
    before = half_step_work(state, const, state.f_contact, state.nose_window, True)
    before += 0.5 * const.dt * dot(state.f_contact_nose, state.projectile_velocity)
    state.f_contact_nose[:] = 0.0
    if const.window_follows:
        move_window(state, const)
    taken, spring = contact_window(state, const, work)
    return taken - before, spring


@kernel(_nrt=False, inline="always")
def contact_window(state, const, work):
    """Contact of the elements in the window: (half a step's work that it takes in, spring energy)
    [J]."""
    i0, i1, j0, j1 = window_bounds(state)
    across = const.window_limits[3] - const.window_limits[2]
    state.contact_energy[FRICTION_SPRING] = 0.0
    taken = 0.0
    spring = 0.0
    # four rows of nodes shape a row of elements; each row of nodes is found once
    for i in range(i0 - 1, i0 + 2):
        spline_kernels.row_positions(state, const, i, j0 - 1, j1 + 1, work.node_rows[i & 3])
    for i in range(i0, i1):
        spline_kernels.row_positions(
            state, const, i + 2, j0 - 1, j1 + 1, work.node_rows[(i + 2) & 3]
        )
        spline_kernels.column_boxes(work.node_rows, j1 - j0 + 3, work.box_low, work.box_high)
        for j in range(j0, j1):
            e = (i - const.window_limits[0]) * across + j - const.window_limits[2]
            # an element that has touched is looked at once more, to end its contact
            if state.element_flag[i * const.row_stride + j] and erode(state, const, i, j):
                reset_element(state, const, e)
            elif state.in_contact[e] or not spline_kernels.box_misses_nose(
                work.box_low, work.box_high, j - j0, const.projectile_radius
            ):
                element_taken, element_spring = contact_element(state, const, i, j, e, work)
                taken += element_taken
                spring += element_spring
    i0, i1, j0, j1 = reachable_nodes(state, const)
    state.nose_window[0] = i0
    state.nose_window[1] = i1 + 1
    state.nose_window[2] = j0
    state.nose_window[3] = j1 + 1
    keep_symmetry(const, state.f_contact, state.nose_window)
    return taken, spring


@kernel(_nrt=False)
def reset_element(state, const, e):
    """Reset the contact history of element number e."""
    state.in_contact[e] = False
    state.last_contact_force[e] = 0.0
    if const.friction > 0.0:
        state.friction_state[e] = 0.0


@unit("2 numbers", work=Scratch)
def contact_element(state, const, i, j, e, work):
    """Contact of the points of one element: (work taken, spring energy) [J]; scatters the forces.

    Eight points are looked at together; those that touch, or did a step ago, are few and dealt with
    one by one.
    """
    at = work.point_data
    x = work.node_position
    column_of_boxes = j - state.contact_window[2]
    for m in range(4):
        slot = (i - 1 + m) & 3
        for n in range(4):
            for c in range(3):
                x[4 * m + n, c] = work.node_rows[slot, c, column_of_boxes + n]
    shares = const.shape_functions[1]
    last = state.last_contact_force[e]
    # beside a failed yarn the surface ends where the yarn does
    if not spline_kernels.neighbourhood_intact(state, const, i, j):
        shares = work.torn_shape_functions
        spline_kernels.torn_shape_functions(state, const, i, j, shares)
    state.in_contact[e] = False
    taken = 0.0
    spring = 0.0
    hit = False
    radius = const.projectile_radius
    for first in range(0, last.size, WIDTH):
        place = spline_kernels.interpolate(shares, first, x)
        # below 0 within the cylinder's radius and behind the foremost point
        beside = fma(place[0], place[0], fma(place[1], place[1], 0.0 - radius * radius))
        outside = maximum(place[2], beside)
        if not any_lane(greater(maximum(load(last, first), 0.0 - outside), 0.0)):
            continue
        if not hit:
            gather_velocities(state, const, i, j, work)
        hit = True
        store_points(at, PLACE, place)
        store(at[OUTSIDE], 0, outside)
        store_points(at, VELOCITY, spline_kernels.interpolate(shares, first, work.node_velocity))
        if const.point_law.implicit_factor > 0.0:
            store_points(at, AHEAD, spline_kernels.interpolate(shares, first, work.node_dv[0]))
            store_points(at, PUSHED, spline_kernels.interpolate(shares, first, work.node_dv[1]))
        for m in range(WIDTH):
            if at[OUTSIDE, m] < 0.0 or last[first + m] != 0.0:
                point_taken, point_spring = contact_point(
                    state, const, i, j, e, first + m, m, shares, work
                )
                taken += point_taken
                spring += point_spring
    if hit:
        scatter_element_force(state, const, i - 1, j - 1, work.node_force)
    return taken, spring


@kernel(_nrt=False, forceinline=True)
def store_points(at, row, vector):
    """Store a vector of eight points in three rows."""
    store(at[row], 0, vector[0])
    store(at[row + 1], 0, vector[1])
    store(at[row + 2], 0, vector[2])


@kernel(_nrt=False, forceinline=True)
def store_node(values, k, vector):
    """Store the vector of a node in a row of (16, 3)."""
    values[k, 0] = vector[0]
    values[k, 1] = vector[1]
    values[k, 2] = vector[2]


@unit(work=Scratch)
def gather_velocities(state, const, i, j, work):
    """Gather the velocities of the nodes about element (i, j) into work.node_velocity; zero the
    forces on them, work.node_force."""
    work.node_force[:] = 0.0
    for m in range(4):
        for n in range(4):
            k = 4 * m + n
            row = i - 1 + m
            line = j - 1 + n
            velocity = spline_kernels.relative_velocity(state, const, row, line)
            store_node(work.node_velocity, k, velocity)
            if const.point_law.implicit_factor > 0.0:
                other = spline_kernels.nodal_vector(state.dv_other, const, row, line)
                pushed = spline_kernels.nodal_vector(state.dv_contact, const, row, line)
                store_node(work.node_dv[0], k, other)
                store_node(work.node_dv[1], k, pushed)


@unit("2 numbers", shares="8, points", work=Scratch)
def contact_point(state, const, i, j, e, number, m, shares, work):
    """Contact of one point of an element, whose position and velocity are in column m of
    work.point_data."""
    at = work.point_data
    law = const.point_law
    last = state.last_contact_force[e]
    k = np.uint64(i * const.row_stride + j)
    before = last[number]
    depth, n_x, n_y, n_z = sdf_kernels.distance(
        const.nose_shape,
        at[0, m],
        at[1, m],
        at[2, m],
        const.projectile_radius,
        const.edge_radius,
        const.projectile_length,
        const.nose_parameters,
    )
    if depth >= 0.0 and before == 0.0:
        return 0.0, 0.0
    part = 1.0
    if state.element_flag[k] != 0:
        per = const.points_per_side
        s = (number // per + 0.5) / per
        t = (number % per + 0.5) / per
        part = intact_at_point(state, const, k, s, t)
    # no yarn is left to push on
    if part == 0.0:
        last[number] = 0.0
        if const.friction > 0.0:
            state.friction_state[e, number] = 0.0
        return 0.0, 0.0
    stiffness = part * law.stiffness
    damping = part * law.damping
    normal = (n_x, n_y, n_z)
    if const.tilted:
        normal = to_panel_frame(const.frame, normal)
    v = column(at, VELOCITY, m)
    push = 0.0
    spring = 0.0
    if depth < 0.0:
        if law.implicit_factor > 0.0:
            # eq. (2); the damper keeps its ratio to critical
            hard = law.implicit_factor * stiffness
            drag = math.sqrt(law.implicit_factor) * damping
            away = dot(normal, add(v, column(at, AHEAD, m)))
            gave = dot(normal, column(at, PUSHED, m))
            push = implicit_penalty_force(
                const, hard, drag, depth, away, gave, before, state.force_scale[0]
            )
            spring = -0.5 * depth * min(push, -hard * depth)
        else:
            # eq. (1)
            push = max(0.0, -damping * dot(normal, v) - stiffness * depth)
            spring = 0.5 * stiffness * depth * depth
        state.in_contact[e] = True
        # how deep fabric goes says how stiff the contact should be; torn ends hang anywhere
        if part == 1.0:
            deepest = state.contact_energy[MAX_PENETRATION]
            state.contact_energy[MAX_PENETRATION] = max(deepest, -depth)
    force = scaled(push, normal)
    last[number] = push
    rubbed = 0.0
    if const.friction > 0.0:
        stuck = state.friction_state[e, number]
        limit = const.friction * push
        rub, rubbed, held = friction_kernels.friction_force(
            stuck, limit, (stiffness, damping), const.dt, normal, v
        )
        state.contact_energy[FRICTION] += rubbed
        state.contact_energy[FRICTION_SPRING] += held
        force = add(force, rub)
    spline_kernels.scatter_force(shares, number, work.node_force, force)
    for c in range(3):
        state.f_contact_nose[c] -= force[c]
    return -0.5 * const.dt * dot(force, v) - rubbed, spring


@kernel(forceinline=True)
def implicit_penalty_force(const, stiffness, damping, depth, away, gave, before, usual):
    """Implicit penalty force [N] on a point at the distance `depth` [m] with predicted opening
    velocity `away` [m/s].

    before, gave : force on the point a step ago, and by what that and those on its neighbours have
        sped it up
    usual : force that every point is taken to have besides
    """
    both = damping + stiffness * const.dt
    mobility = (max(gave, 0.0) + usual * const.dt / const.point_law.mass) / (before + usual)
    return max(0.0, (-stiffness * depth - both * away) / (1.0 + both * mobility))


@kernel(_nrt=False)
def scatter_element_force(state, const, i, j, push):
    """Scatter the forces on the nodes (i, j) .. (i + 3, j + 3), or on those that they mirror."""
    for m in range(4):
        row, sign_x = spline_kernels.mirror_index(i + m, const.ni, const.mirror_x)
        for n in range(4):
            line, sign_y = spline_kernels.mirror_index(j + n, const.nj, const.mirror_y)
            k = np.uint64(row * const.row_stride + line)
            state.f_contact[0][k] += sign_x * push[0, 4 * m + n]
            state.f_contact[1][k] += sign_y * push[1, 4 * m + n]
            state.f_contact[2][k] += push[2, 4 * m + n]


@kernel()
def to_panel_frame(frame, x):
    """Rotate a vector from the frame of the projectile to that of the panel."""
    found = scaled(x[0], frame[0])
    return add_scaled(add_scaled(found, x[1], frame[1]), x[2], frame[2])
