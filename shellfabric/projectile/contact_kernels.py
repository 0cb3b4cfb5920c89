"""Contact of the fabric with a projectile: penalty on a signed distance, over points of a smooth surface
(derivation: docs/theory-panel.md, "Contact with the projectile").

The distance is that of `sdf_kernels`, in the frame of the projectile: its nose at the origin, its axis
along z; a tilted one has a frame of its own. Every element carries p x p points x = sum N_i x_i
(`surface.surface_kernels`), whose forces its nodes share by their N_i. Where yarns have failed, k and c
are those of what is left of the two next to a point.

In packs the push along n is shared out by limited shares, and the force is that of the end of the step,
eq. (2) of `contact.normal_kernels`. The mass there is over s, the force of a step ago and the nose's force
spread over an element: else the load hops from point to point as fabric slides round the rim.
"""

import numpy as np

from shellfabric.contact import friction_kernels, normal_kernels
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    fabs,
    fma,
    greater,
    load,
    mask_from_bits,
    maximum,
    minimum,
    movemask,
    reduce_add,
    store,
    where,
)
from shellfabric.projectile import sdf_kernels
from shellfabric.projectile.profile_kernels import (
    clear_profile,
    profile_power,
    profile_velocity,
    push_profile,
)
from shellfabric.projectile.window_kernels import (
    erode,
    intact_at_point,
)
from shellfabric.state import Scratch, unit
from shellfabric.surface.grid_kernels import grid_of, to_nodes, turned, turned_back
from shellfabric.surface.nodal_force_kernels import bounds, extend_window, half_step_work
from shellfabric.surface.surface_kernels import (
    foot_at,
    point_mean_speed,
    point_speeds8,
    point_vector8,
    scatter_limited_to_points8,
    scatter_to_points8,
    share_out,
    share_out_limited,
    speeds_at,
    vector_of,
)
from shellfabric.surface.torn_kernels import WHOLE, bent_corners, torn_foot
from shellfabric.surface.vector_kernels import (
    add,
    column,
    combined,
    components,
    dot,
    scaled,
    subtract,
)

MIN_PUSH = 1e-12  # [N] that limits shares
MIN_FORCE_SCALE = 1e-30  # [N] force of a point of a nose that does not push yet


@unit("2 numbers", work=Scratch)
def contact_forces(state, const, work):
    """Compute the contact forces at the present positions (`grid_kernels.place`), into
    state.f_contact; the force on the projectile into state.f_contact_nose.

    The elements of the block of rows and columns state.contact_window, which lies in
    const.window_limits, are looked at, unless eroded: what no yarn holds is out of contact. Returns
    the work that the contact has taken in since the last call (spring and damper: half a step's of
    the old nodal forces and of the new, on the same velocities, so that nothing is left out where
    the fabric fails) and the energy in its springs.
    """
    # half a step's work of the last forces, on the velocities that they have had an effect on
    before = half_step_work(state, const, state.f_contact, state.nose_window, True)
    held = nose_power(state, const)
    before += 0.5 * const.dt * dot(state.f_contact_nose, state.projectile_velocity)
    if const.nose.kind == sdf_kernels.PROFILE:
        before += 0.5 * const.dt * profile_power(const.nose.profile)
        clear_profile(const.nose.profile)
    see_nose(state, const, work)
    i0, i1, j0, j1 = bounds(state.contact_window)
    state.friction_spring_energy = 0.0
    taken = 0.0
    spring = 0.0
    for i in range(i0, i1):
        for j in range(j0, j1, WIDTH):
            row_taken, row_spring = contact_elements(state, const, i, j, work)
            taken += row_taken
            spring += row_spring
    surface = state.surface
    to_nodes(state, const, (surface.f, surface.window), (state.f_contact, state.nose_window))
    push = work.nose_force
    state.f_contact_nose[0], state.f_contact_nose[1] = turned(surface.turn, push[0], push[1])
    state.f_contact_nose[2] = push[2]
    if const.holds_force:
        # the body holds the force of a step ago over all of the step
        before += 0.5 * const.dt * (held - nose_power(state, const))
    return taken - before, spring


@kernel(_nrt=False)
def nose_power(state, const):
    """Compute the power [W] of the ply's force on the projectile along its axis, in which a body that
    deforms moves in steps of its own, and on the rings of its profile."""
    force = 0.0
    velocity = 0.0
    for c in range(3):
        force += const.frame[2, c] * state.f_contact_nose[c]
        velocity += const.frame[2, c] * state.projectile_velocity[c]
    power = force * velocity
    if const.nose.kind == sdf_kernels.PROFILE:
        power += profile_power(const.nose.profile)
    return power


@kernel(_nrt=False)
def see_nose(state, const, work):
    """Turn position, velocity and axes of the nose into the frame of the surface, in
    work.nose_place, nose_velocity and axes; no force on it yet."""
    turn = state.surface.turn
    x = state.projectile_position
    v = state.projectile_velocity
    place = work.nose_place
    velocity = work.nose_velocity
    place[0], place[1] = turned_back(turn, x[0], x[1])
    place[2] = x[2] + state.surface.rest[2][grid_of(const)[0]]
    velocity[0], velocity[1] = turned_back(turn, v[0], v[1])
    velocity[2] = v[2]
    work.nose_force[:] = 0.0
    for row in range(3):
        axis = const.frame[row]
        work.axes[row, 0], work.axes[row, 1] = turned_back(turn, axis[0], axis[1])
        work.axes[row, 2] = axis[2]


@kernel(_nrt=False)
def reset_element(state, const, e):
    """Reset the contact history of element number e."""
    state.in_contact[e] = False
    for forces in state.last_contact_force:
        forces[e] = 0.0
    if const.friction > 0.0:
        state.friction_slip[e] = 0.0
        state.friction_force[e] = 0.0


@kernel(_nrt=False)
def number_in_window(const, i, j):
    """Return the number of element (i, j) among those that the nose may touch."""
    first_row, _, first_column, end_column = const.window_limits
    return (i - first_row) * (end_column - first_column) + j - first_column


@unit("integer", work=Scratch)
def near_elements(state, const, i, j, work):
    """Return those of eight elements from (i, j) on, as bits, whose surface the nose may touch, or
    has touched a step ago. Those that no yarn holds any more erode."""
    _, _, _, end_column = bounds(state.contact_window)
    count = min(WIDTH, end_column - j)
    e = number_in_window(const, i, j)
    near = ~beside_nose8(state, const, i, j, work)
    found = 0
    for lane in range(count):
        # an element that has touched is looked at once more, to end its contact
        if state.element_flag[np.uint64(i * const.row_stride + j + lane)] and erode(
            state, const, i, j + lane
        ):
            reset_element(state, const, e + lane)
        elif state.in_contact[e + lane] or near >> lane & 1:
            found |= 1 << lane
    return found


@kernel(_nrt=False, forceinline=True)
def beside_nose8(state, const, i, j, work):
    """Return those of eight elements from (i, j) on, as bits, that are ahead of the nose or beside
    the cylinder, by the boxes of the four by four nodes which their surfaces follow from."""
    base, stride, _, _ = grid_of(const)
    k = base + (i - 1) * stride + j - 1
    x = state.surface.x
    nose = work.nose_place
    low_x, high_x = range8(x[0], k, stride)
    low_y, high_y = range8(x[1], k, stride)
    low_z, high_z = range8(x[2], k, stride)
    low = low_x, low_y, low_z
    high = high_x, high_y, high_z
    middle = subtract(scaled(0.5, add(low, high)), nose)
    half = scaled(0.5, subtract(high, low))
    square = broadcast(0.0)
    for c in range(2):
        beside = maximum(fabs(dot(work.axes[c], middle)) - half_width8(work.axes[c], half), 0.0)
        square = fma(beside, beside, square)
    ahead = dot(work.axes[2], middle) - half_width8(work.axes[2], half)
    return movemask(greater(ahead, 0.0)) | movemask(greater(square, sdf_kernels.reach(const) ** 2))


@kernel(_nrt=False, forceinline=True)
def half_width8(axis, half):
    """Compute half the width along an axis of eight boxes of these half widths."""
    return abs(axis[0]) * half[0] + abs(axis[1]) * half[1] + abs(axis[2]) * half[2]


@kernel(_nrt=False, forceinline=True)
def range8(x, k, stride):
    """Find the least and largest x of four by four nodes from each of the numbers k .. k + 7 on."""
    low = high = load(x, k)
    for m in range(4):
        for n in range(4):
            here = load(x, k + m * stride + n)
            low = minimum(low, here)
            high = maximum(high, here)
    return low, high


@unit("2 numbers", work=Scratch)
def contact_elements(state, const, i, j, work):
    """Compute the contact of the points of up to eight elements from (i, j) on: (work taken, spring
    energy) [J]. The forces go to the grid.

    Points with the same place in their elements are looked at together; those that touch, or did a
    step ago, are few and dealt with one by one, and so are those beside failed yarns.
    """
    near = near_elements(state, const, i, j, work)
    if near == 0:
        return 0.0, 0.0
    e = number_in_window(const, i, j)
    torn = 0
    for lane in range(WIDTH):
        if near >> lane & 1:
            state.in_contact[e + lane] = False
            work.bent[lane] = bent_corners(state, const, i, j + lane)
            torn |= int(work.bent[lane] != WHOLE) << lane
    work.contact_work = 0.0
    work.spring_energy = 0.0
    for number in range(const.points_per_side**2):
        touch_together(state, const, (i, j, number), near & ~torn, work)
        for lane in range(WIDTH):
            if torn >> lane & 1:
                touch_alone(state, const, i, j + lane, number, lane, work)
    return work.contact_work, work.spring_energy


@kernel(_nrt=False, forceinline=True)
def touch_together(state, const, points, whole, work):
    """Compute the contact of eight points (number in the element, from element (i, j) on), of those
    whose elements are `whole`, as bits."""
    if whole == 0:
        return
    i, j, number = points
    surface = state.surface
    a, b = place_in_element(const, number)
    row, line, nodes, wa, wb = foot_at(grid_of(const), False, i + a, j + b)
    x = subtract(point_vector8(surface.x, nodes, wa, wb), work.nose_place)
    x = components(work.axes, x)
    last = load(state.last_contact_force[number], number_in_window(const, i, j))
    # below 0 within the cylinder's radius and behind the foremost point
    radius = sdf_kernels.reach(const)
    outside = maximum(x[2], fma(x[0], x[0], fma(x[1], x[1], 0.0 - radius * radius)))
    touched = whole & movemask(greater(maximum(last, 0.0 - outside), 0.0))
    if touched == 0:
        return
    v = point_vector8(surface.v, nodes, wa, wb)
    store_points(work.place, x)
    store_points(work.velocity, subtract(v, work.nose_velocity))
    if const.point_law.implicit > 0.0:
        store_points(work.dv_other, point_vector8(state.dv_other, nodes, wa, wb))
        store_points(work.dv_contact, point_vector8(state.dv_contact, nodes, wa, wb))
    for lane in range(WIDTH):
        if touched >> lane & 1:
            contact_point(state, const, i, j + lane, number, lane, work)
    extend_window(surface.window, row, row + 3, line, min(line + WIDTH + 2, const.nj + 2))
    which = mask_from_bits(touched)
    force = (
        where(which, load(work.force[0], 0), 0.0),
        where(which, load(work.force[1], 0), 0.0),
        where(which, load(work.force[2], 0), 0.0),
    )
    if const.point_law.share_drag > 0.0:
        n = load(work.normal[0], 0), load(work.normal[1], 0), load(work.normal[2], 0)
        push = where(which, load(work.push, 0), 0.0)
        along = scaled(push, n)
        speeds = point_speeds8(surface.v, nodes, n)
        speed = point_mean_speed(speeds, wa, wb)
        limit = 1.0, speed + maximum(load(work.closing, 0), 0.0), load(work.share_drag, 0)
        went = scatter_limited_to_points8(surface.f, nodes, (wa, wb), speeds, (along, limit))
        # the work was counted with the mean by the plain shares
        work.contact_work -= 0.5 * const.dt * reduce_add(push * (went - speed))
        if const.friction == 0.0:
            return
        force = subtract(force, along)
    own = (wa[0], wa[1], wa[2], 0.0), (wb[0], wb[1], wb[2], 0.0)
    for c in range(3):
        scatter_to_points8(surface.f[c], nodes, force[c], own)


@unit(work=Scratch)
def touch_alone(state, const, i, j, number, lane, work):
    """Compute `contact_point` of a point beside failed yarns."""
    surface = state.surface
    foot = torn_foot(const, work.bent[lane], (i, j), divmod(number, const.points_per_side))
    x = components(work.axes, subtract(vector_of(surface.x, foot), work.nose_place))
    inside = x[2] < 0.0 and x[0] * x[0] + x[1] * x[1] < sdf_kernels.reach(const) ** 2
    last = state.last_contact_force[number, number_in_window(const, i, j)]
    if not inside and last == 0.0:
        return
    store_point(work.place, lane, x)
    v = subtract(vector_of(surface.v, foot), work.nose_velocity)
    store_point(work.velocity, lane, v)
    if const.point_law.implicit > 0.0:
        store_point(work.dv_other, lane, vector_of(state.dv_other, foot))
        store_point(work.dv_contact, lane, vector_of(state.dv_contact, foot))
    contact_point(state, const, i, j, number, lane, work)
    force = column(work.force, 0, lane)
    if const.point_law.share_drag > 0.0:
        n = column(work.normal, 0, lane)
        push = work.push[lane]
        along = scaled(push, n)
        _, _, at, wa, wb = foot
        speeds = speeds_at(surface.v, at, n)
        speed = point_mean_speed(speeds, wa, wb)
        limit = 1.0, speed + max(work.closing[lane], 0.0), work.share_drag[lane]
        went = share_out_limited(surface.f, surface.window, foot, speeds, (along, limit))
        work.contact_work -= 0.5 * const.dt * push * (went - speed)
        if const.friction == 0.0:
            return
        force = subtract(force, along)
    share_out(surface.f, surface.window, foot, force)


@kernel(_nrt=False, forceinline=True)
def place_in_element(const, number):
    """Return the place (s, t) of a point in its element, from 0 to 1."""
    a, b = divmod(number, const.points_per_side)
    return (a + 0.5) / const.points_per_side, (b + 0.5) / const.points_per_side


@kernel(_nrt=False, forceinline=True)
def store_points(rows, vector):
    """Store a vector of eight points in three rows."""
    store(rows[0], 0, vector[0])
    store(rows[1], 0, vector[1])
    store(rows[2], 0, vector[2])


@kernel(_nrt=False, forceinline=True)
def store_point(rows, lane, vector):
    """Store a vector of one of eight points in three rows."""
    rows[0, lane] = vector[0]
    rows[1, lane] = vector[1]
    rows[2, lane] = vector[2]


@unit(work=Scratch)
def contact_point(state, const, i, j, number, lane, work):
    """Compute the contact of a point: of element (i, j), its number in it, its lane of the arrays of
    `Scratch`.

    Its force goes to work.force, what work it takes to work.contact_work, and what its spring holds to
    work.spring_energy.
    """
    law = const.point_law
    e = number_in_window(const, i, j)
    k = np.uint64(i * const.row_stride + j)
    last = state.last_contact_force[number]
    before = last[e]
    store_point(work.force, lane, (0.0, 0.0, 0.0))
    work.push[lane] = 0.0
    place = column(work.place, 0, lane)
    foot = 0.0, 0.0
    if const.nose.kind == sdf_kernels.PROFILE:
        foot, depth, normal = sdf_kernels.distance_to_profile(const.nose, place)
    else:
        depth, normal = sdf_kernels.distance(const.nose, place)
    if depth >= 0.0 and before == 0.0:
        return
    part = 1.0
    if state.element_flag[k] != 0:
        part = intact_at_point(state, const, k, place_in_element(const, number))
    # no yarn is left to push on
    if part == 0.0:
        last[e] = 0.0
        if const.friction > 0.0:
            state.friction_slip[e, number] = 0.0
            state.friction_force[e, number] = 0.0
        return
    stiffness = part * law.stiffness
    damping = part * law.damping
    normal = combined(work.axes, normal)
    v = column(work.velocity, 0, lane)
    if const.nose.kind == sdf_kernels.PROFILE:
        own = profile_velocity(const.nose.profile, place, foot)
        v = subtract(v, combined(work.axes, own))
    push = 0.0
    spring = 0.0
    if depth < 0.0:
        if law.implicit > 0.0:
            away = dot(normal, add(v, column(work.dv_other, 0, lane)))
            gave = dot(normal, column(work.dv_contact, 0, lane))
            push = normal_kernels.implicit_penalty_force(
                const, (stiffness, damping), (depth, away), (before, gave), state.force_scale
            )
            spring = -0.5 * depth * min(push, -stiffness * depth)
        else:
            # eq. (1)
            held, spring = normal_kernels.spring(stiffness, -depth)
            push = normal_kernels.damped(held, damping, -dot(normal, v))
        state.in_contact[e] = True
        # how deep fabric goes says how stiff the contact should be; torn ends hang anywhere
        if part == 1.0:
            state.max_penetration = max(state.max_penetration, -depth)
    force = scaled(push, normal)
    last[e] = push
    store_point(work.normal, lane, normal)
    work.push[lane] = push
    work.closing[lane] = 0.0 - dot(normal, v)
    work.share_drag[lane] = part * law.share_drag / max(push, MIN_PUSH)
    rubbed = 0.0
    if const.friction > 0.0:
        slip = state.friction_slip[e, number]
        pull = state.friction_force[e, number]
        limit = const.friction * push
        stick = part * law.stick_stiffness, part * law.stick_damping
        rub, rubbed, held = friction_kernels.friction_force(
            slip, pull, limit, stick, const.dt, normal, v
        )
        state.nose_friction_work += rubbed
        state.friction_spring_energy += held
        force = add(force, rub)
    store_point(work.force, lane, force)
    for c in range(3):
        work.nose_force[c] -= force[c]
    if const.nose.kind == sdf_kernels.PROFILE:
        back = scaled(-1.0, components(work.axes, force))
        push_profile(const.nose.profile, place, foot, back)
    work.contact_work -= 0.5 * const.dt * dot(force, v) + rubbed
    work.spring_energy += spring
