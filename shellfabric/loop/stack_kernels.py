"""What the plies of a run share in a step: the projectile, impulses on each other, reasons to end.

The projectile is one: its speed is shared, and takes the impulses of all plies. Its place is kept
for each ply, counted from the ply's own plane at rest; where plies lie at other angles each has
position and velocity in its own frame, and the velocity is kept in the first one's. A ply is skipped
until something pushes on it. The order of a step is that of `loop.advance`.
"""

import math

import numpy as np

from shellfabric.jit.barrier import barrier_wait
from shellfabric.jit.compile import call_flight, kernel
from shellfabric.jit.table import row_of
from shellfabric.loop import ply_kernels
from shellfabric.membrane.boundary_kernels import update_slip_nodes
from shellfabric.plies.frame_kernels import BEFORE, BEHIND, apply_impulses, collect_forces
from shellfabric.plies.near_kernels import list_contact_pairs
from shellfabric.plies.pack_guard_kernels import force_without_nose
from shellfabric.plies.pressure_kernels import press, press_others
from shellfabric.plies.state import unit
from shellfabric.projectile import contact_kernels, window_kernels
from shellfabric.projectile.bar_kernels import CENTRE
from shellfabric.surface.grid_kernels import grid_of, place_ghosts, turned, turned_back
from shellfabric.surface.nodal_force_kernels import give_impulses
from shellfabric.surface.vector_kernels import nodal, scaled

# CHECK: energy is to be audited before the next step; LOOK: whether the nose has passed all held fabric
RUNNING, STOPPED, PERFORATED, NOT_FINITE, CHECK, LOOK = range(6)
# of its energy that the contact could take from the nose over a diameter: less counts as no push
FAINT = 0.01


@kernel(_nrt=False, forceinline=True)
def push_projectile(stack, const, p, force):
    """Add v += dt f / m of the projectile, with a force in the frame of ply p."""
    f_x, f_y = turned_back(stack.turns[p], force[0], force[1])
    stack.projectile_velocity[0] += const.dt * const.free_dofs[0] * f_x / const.projectile_mass
    stack.projectile_velocity[1] += const.dt * const.free_dofs[1] * f_y / const.projectile_mass
    stack.projectile_velocity[2] += const.dt * const.free_dofs[2] * force[2] / const.projectile_mass


@unit()
def fly(states, consts, stack):
    """Give the impulses of the nose to all plies that are awake, and of a block behind the last;
    then move the projectile itself."""
    last = len(states) - 1
    force = 0.0
    for p in range(len(states)):
        if stack.awake[p]:
            state = row_of(states, p)
            const = row_of(consts, p)
            give_impulses(state, const, state.f_contact, state.nose_window)
            push_projectile(stack, const, p, state.f_contact_nose)
            force += axial_force(state, const)
    state = row_of(states, last)
    const = row_of(consts, last)
    if const.has_backing and stack.awake[last]:
        ply_kernels.apply_backing_impulse(state, const)
        push_projectile(stack, const, last, state.f_block_nose)
    const = row_of(consts, 0)
    move_body(row_of(states, 0), const, force)
    for p in range(len(states)):
        velocity = row_of(states, p).projectile_velocity
        of_first = stack.projectile_velocity
        if p > 0:
            velocity[0], velocity[1] = turned(stack.turns[p], of_first[0], of_first[1])
            velocity[2] = of_first[2]
        for c in range(3):
            stack.projectile_position[p, c] += const.dt * velocity[c]


@kernel(_nrt=False)
def move_body(state, const, force):
    """Move a projectile that is not rigid by a step, under a force [N] along its axis."""
    parts = state.parts
    for m in range(parts.flight.size):
        if parts.flight[m] != 0:
            call_flight(parts.flight[m], parts.own[m], state, const, force)


@kernel(_nrt=False)
def wakes(state, const, contact, stack, p):
    """Give ply p the impulses of the others and of the guard; whether anything has acted on it
    yet."""
    pressure = contact.pressure
    guard = contact.guard
    pushed = apply_impulses(state, const, guard.force[p], guard.window[p])
    for side in range(2):
        pushed |= apply_impulses(state, const, pressure.force[p, side], pressure.window[p, side])
    stack.awake[p] |= pushed
    return stack.awake[p]


@kernel(_nrt=False, inline="always")
def press_plies(states, consts, contact, shared, me, count):
    """Compute the forces between plies, once all are at their new positions."""
    barrier_wait(shared, count)
    if me == 0:
        list_contact_pairs(contact)
    barrier_wait(shared, count)
    press(contact, me, count)
    barrier_wait(shared, count)
    if me == 0:
        press_others(contact)
    barrier_wait(shared, count)
    for p in range(me, len(states), count):
        collect_forces(row_of(states, p), row_of(consts, p), contact, p)


@kernel(_nrt=False)
def implicit_nose_contact(states, consts, contact, stack, works, me, count):
    """Compute the nose's forces on those of one thread's plies that wait for the others' (see
    `ply_kernels.touch`)."""
    for p in range(me, len(states), count):
        if stack.waits_for_plies[p]:
            state = row_of(states, p)
            const = row_of(consts, p)
            predict_increments(state, const, contact, p)
            ply_kernels.nose_contact(state, const, row_of(works, p))
            if state.f_contact_nose[2] == 0.0:
                clear_increments(state, const)


@unit(later=True)
def predict_increments(state, const, contact, p):
    """Predict by what all other forces will speed up the nodes of ply p that the nose can push,
    into state.dv_other, and by what the nose's own of a step ago have, into state.dv_contact; the
    nose's force shared out to one element, into state.force_scale."""
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    base, stride, _, _ = grid_of(const)
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            k = np.uint64(i * const.row_stride + j)
            force = force_without_nose(state, const, contact, p, k)
            if const.mirror_x and i == 0:
                force = 0.0, force[1], force[2]
            if const.mirror_y and j == 0:
                force = force[0], 0.0, force[2]
            kick = state.dt_over_mass[k]
            g = base + i * stride + j
            store_turned(state, state.dv_other, g, scaled(kick, force))
            store_turned(state, state.dv_contact, g, scaled(kick, nodal(state.f_contact, k)))
    place_ghosts(const, state.dv_other, i0, i1)
    place_ghosts(const, state.dv_contact, i0, i1)
    # of a quarter of the nose, whatever part is modelled: what planes of symmetry cut off has the
    # same force, but for its part along their normals
    f_x, f_y, f_z = state.f_contact_nose
    quarters = 0.25
    if const.mirror_x:
        f_x = 0.0
        quarters *= 2.0
    if const.mirror_y:
        f_y = 0.0
        quarters *= 2.0
    force = math.sqrt(f_x**2 + f_y**2 + f_z**2)
    state.force_scale = quarters * force / const.points_per_side**2


@kernel(_nrt=False, forceinline=True)
def store_turned(state, x, g, vector):
    """Store a vector of a ply's frame as vector x of node g of its grid."""
    x[0][g], x[1][g] = turned_back(state.surface.turn, vector[0], vector[1])
    x[2][g] = vector[2]


@kernel(_nrt=False)
def clear_increments(state, const):
    """Undo `predict_increments`."""
    for c in range(3):
        state.dv_other[c][:] = 0.0
        state.dv_contact[c][:] = 0.0
    state.force_scale = contact_kernels.MIN_FORCE_SCALE


@kernel(_nrt=False)
def axial_force(state, const):
    """Compute the force [N] of a ply, and of what lies behind it, on the projectile along its
    axis."""
    force = 0.0
    for c in range(3):
        pushed = state.f_contact_nose[c] + state.f_block_nose[c]
        force += const.frame[2, c] * const.free_dofs[c] * pushed
    return force


@kernel(_nrt=False)
def normal_velocity(state, const, stack):
    """Compute the velocity [m/s] of the projectile's centre of mass along the panel's normal."""
    velocity = state.projectile_velocity[2]
    if stack.motion.size == 0:
        return velocity
    tip = 0.0
    for c in range(3):
        tip += const.frame[2, c] * state.projectile_velocity[c]
    return velocity + const.frame[2, 2] * (stack.motion[CENTRE] - tip)


@kernel(inline="always")
def record_step(state, const, stack, force, row):
    """Record one row of the history: foremost z, v_z and the force [N] along z; of a body that is
    not rigid also its motion."""
    row[0] = state.projectile_position[2] + const.foremost_offset
    row[1] = normal_velocity(state, const, stack)
    row[2] = force
    for m in range(3, row.size):
        row[m] = stack.motion[m - 3]


@unit("integer", row="9")
def note(states, consts, stack, row):
    """Tell why the step should be the last, or RUNNING; record its row of the history."""
    stack.steps += 1
    first = row_of(states, 0)
    const = row_of(consts, 0)
    last = row_of(states, len(states) - 1)
    force = 0.0
    for p in range(len(states)):
        force += stack.f_contact_nose[p, 2]
    record_step(first, const, stack, force + last.f_block_nose[2], row)
    speed = normal_velocity(first, const, stack)
    if not abs(speed) < 1e9:
        return NOT_FINITE
    if stack.stop_step > 0:
        return RUNNING
    if speed <= 0.0 and stack.after_stop > 0.0:
        stack.stop_step = stack.steps
        return RUNNING
    if speed <= 0.0:
        return STOPPED
    # perforated: yarns have failed, no whole one is ahead, and what still rubs cannot hold the nose:
    # flanks touch yarns that were pushed aside as long as there is a flank, cut ones ride on the nose.
    # Resolved yarns need not fail, the nose may have pushed them aside
    failed = False
    ahead = False
    for p in range(len(states)):
        state = row_of(states, p)
        failed |= stack.ply_failures[p] > 0 or state.parts.replaces_membrane
        ahead |= state.yarns_ahead > 0 or state.f_block_nose[2] != 0.0
    if ahead or not failed:
        stack.idle_steps = 0
        stack.idle_push = 0.0
        return RUNNING
    stack.idle_steps += 1
    stack.idle_push -= force
    if stack.idle_steps < const.perforation_delay_steps:
        return RUNNING
    push = stack.idle_push / stack.idle_steps
    stack.idle_steps = 0
    stack.idle_push = 0.0
    energy = 0.5 * const.projectile_mass * speed * speed
    if push * const.body_depth > FAINT * energy:
        return RUNNING
    return LOOK


@kernel(_nrt=False)
def finish_parts(states, consts, stack):
    """Call the parts of all plies that are awake which act when all have moved."""
    for p in range(len(states)):
        if stack.awake[p]:
            ply_kernels.finish_parts(row_of(states, p), row_of(consts, p))


@kernel(_nrt=False)
def move_edges(states, consts, contact):
    """Set the velocities of the nodes of all plies that slip in a clamp or are pulled, once all
    forces on them are known and have done their work of this step."""
    for p in range(len(states)):
        const = row_of(consts, p)
        if const.slip_node.size == 0:
            continue
        state = row_of(states, p)
        if len(states) > 1:
            for m in range(const.slip_node.size):
                k = const.slip_node[m]
                c = const.slip_axis[m]
                before = contact.pressure.force[p, BEFORE, c, k]
                state.slip_push[m] = before + contact.pressure.force[p, BEHIND, c, k]
        update_slip_nodes(state, const, state.steps * const.dt)


@kernel(_nrt=False)
def internal_work(states, contact):
    """Sum the work [J] done so far on yarns, their viscosity and the contacts."""
    pressure = contact.pressure
    guard = contact.guard
    total = 0.0
    for p in range(len(states)):
        total += ply_kernels.internal_work(row_of(states, p))
    if len(states) > 1:
        for p in range(len(states)):
            total += pressure.work[p]
        total += guard.work
    return total
