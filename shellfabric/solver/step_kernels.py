"""Explicit time steps of plies and their projectile: of a single ply, or of a pack.

In a step the contact forces give their impulses, the projectile moves, each ply makes its own part (`ply_kernels`), and
the contact between plies is computed (`plies.pressure_kernels`). All forces of a step are known before it begins: from
them the guard of a pack (`plies.pack_guard_kernels`) finds what keeps the plies from passing through each other in it.
The projectile is one: its speed is shared, and takes the impulses of all plies. Its place is kept for each ply, counted
from the ply's own plane at rest; where plies lie at other angles each has place and velocity in its own frame, and the
velocity is kept in the first one's. A ply is skipped until something pushes on it.

States, constants and scratch come as lists (`jit.borrowed_list.Items`), so that what is compiled does not depend on the
number of plies; `contact` is None of a single ply, and numba removes what is done for it before it compiles. Plies of
one grid share their scratch; those of another have their own, since its idle slots must stay at rest.

Several threads can share the work: a single ply by its blocks of rows; a pack by its plies. They wait for each other in
between. No two write to the same place, so that results do not depend on their number. What involves all plies at once
(lists of what is near, the guard) is one thread's.
"""

import math

import numpy as np

from shellfabric.jit.barrier import STOP, barrier_wait
from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import entry, kernel
from shellfabric.panel import element_kernels
from shellfabric.panel.motion_kernels import (
    FAILURES,
    IDLE,
    STEP,
    TURNED,
    grow_active_rows,
    thread_range,
)
from shellfabric.plies import near_kernels
from shellfabric.plies.frame_kernels import apply_impulses, hand_over, place, turned, turned_back
from shellfabric.plies.near_kernels import list_pressed
from shellfabric.plies.pack_guard_kernels import count_work, follow, hold_apart
from shellfabric.plies.pressure_kernels import press, press_others
from shellfabric.projectile import bar_kernels, contact_kernels, window_kernels
from shellfabric.solver import ply_kernels

RUNNING, STOPPED, PERFORATED, NOT_FINITE, CHECK = (
    0,
    1,
    2,
    3,
    4,
)  # CHECK: energy is to be audited before the next step


@kernel(_nrt=False, forceinline=True)
def push_projectile(stack, const, p, force):
    """v += dt f / m of the projectile, with a force in the frame of ply p."""
    f_x, f_y = turned_back(stack.turns[p], force[0], force[1])
    stack.projectile_velocity[0] += const.dt * const.free_dofs[0] * f_x / const.projectile_mass
    stack.projectile_velocity[1] += const.dt * const.free_dofs[1] * f_y / const.projectile_mass
    stack.projectile_velocity[2] += const.dt * const.free_dofs[2] * force[2] / const.projectile_mass


@kernel(_nrt=False)
def apply_nose_impulses(states, consts, stack):
    """The impulses of the nose on all plies that are awake, and of a block behind the last; then the projectile's own
    motion."""
    last, force = len(states) - 1, 0.0
    for p in range(len(states)):
        if stack.awake[p]:
            state, const = borrowed_item(states, p), borrowed_item(consts, p)
            contact_kernels.apply_contact_impulse(state, const)
            push_projectile(stack, const, p, state.f_contact_nose)
            force += bar_kernels.axial_force(state, const)
    state, const = borrowed_item(states, last), borrowed_item(consts, last)
    if const.has_backing and stack.awake[last]:
        ply_kernels.apply_backing_impulse(state, const)
        push_projectile(stack, const, last, state.f_block_nose)
    state, const = borrowed_item(states, 0), borrowed_item(consts, 0)
    if const.bar_mass.size > 0:
        bar_kernels.advance_bar(state, const, force)
    for p in range(len(states)):
        velocity, of_first = borrowed_item(states, p).projectile_velocity, stack.projectile_velocity
        if p > 0:
            velocity[0], velocity[1] = turned(stack.turns[p], of_first[0], of_first[1])
            velocity[2] = of_first[2]
        for c in range(3):
            stack.projectile_position[p, c] += const.dt * velocity[c]


@kernel(_nrt=False, inline="always")
def begin_step(states, consts, contact, stack):
    """What one thread does before the others join: the guard, contact impulses, motion of the projectile."""
    if contact is not None:
        hold_apart(states, consts, contact)
    apply_nose_impulses(states, consts, stack)
    if contact is None:
        grow_active_rows(borrowed_item(states, 0), borrowed_item(consts, 0))


@kernel(_nrt=False, inline="always")
def step_ply(states, consts, works, shared, me, count):
    """The step of a single ply, whose blocks the threads share."""
    state, const, work = borrowed_item(states, 0), borrowed_item(consts, 0), borrowed_item(works, 0)
    ply_kernels.update_blocks(state, const, work, shared, me, count)
    barrier_wait(shared, count)
    if me == 0:
        ply_kernels.after_forces(state, const, work)


@kernel(_nrt=False)
def step_plies(states, consts, contact, stack, works, me, count):
    """One thread's plies of a pack: the impulses of the others and of the guard, their own step."""
    for p in range(me, len(states), count):
        state, const, work = (
            borrowed_item(states, p),
            borrowed_item(consts, p),
            borrowed_item(works, p),
        )
        pushed = apply_impulses(state, const, contact.guard_force[p], contact.guard_window[p])
        for side in range(2):
            pushed |= apply_impulses(state, const, contact.force[p, side], contact.window[p, side])
        stack.awake[p] |= pushed
        if stack.awake[p]:
            grow_active_rows(state, const)
            ply_kernels.update_blocks(state, const, work, work.barrier, 0, 1)
            stack.waits_for_plies[p] = ply_kernels.after_forces(state, const, work)
            place(state, const, contact, p)
            follow(state, const, contact, p)


@kernel(_nrt=False, inline="always")
def press_plies(states, consts, contact, shared, me, count):
    """The forces between plies at their new places."""
    if me == 0:
        list_pressed(contact)
    barrier_wait(shared, count)
    press(contact, me, count)
    barrier_wait(shared, count)
    if me == 0:
        press_others(contact)
    barrier_wait(shared, count)
    for p in range(me, len(states), count):
        hand_over(borrowed_item(states, p), borrowed_item(consts, p), contact, p)


@kernel(_nrt=False)
def implicit_nose_contact(states, consts, contact, stack, works, me, count):
    """The nose's forces on those of one thread's plies that wait for the others' (see `ply_kernels.after_forces`)."""
    for p in range(me, len(states), count):
        if stack.waits_for_plies[p]:
            state, const = borrowed_item(states, p), borrowed_item(consts, p)
            predict_increments(state, const, contact, p)
            ply_kernels.nose_contact(state, const, borrowed_item(works, p))
            if state.f_contact_nose[2] == 0.0:
                clear_increments(state, const)


@kernel(_nrt=False)
def predict_increments(state, const, contact, p):
    """By what all other forces will speed up the nodes of ply p that the nose can push, into state.dv_other, and by
    what the nose's own of a step ago have, into state.dv_contact; the nose's force shared out to one element, into
    state.force_scale."""
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(
                np.uint64(i * const.row_stride + j0), np.uint64(i * const.row_stride + j1 + 1)
            ):
                state.dv_other[c][k] = state.f_int[c][k] + state.f_int_above[c][k]
                if const.has_backing:
                    state.dv_other[c][k] += state.f_block_cloth[c][k]
    for side in range(2):
        add_forces(state, const, contact.force[p, side])
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(
                np.uint64(i * const.row_stride + j0), np.uint64(i * const.row_stride + j1 + 1)
            ):
                state.dv_other[c][k] *= state.dt_over_mass[k]
                state.dv_contact[c][k] = state.dt_over_mass[k] * state.f_contact[c][k]
    if const.mirror_x and i0 == 0:
        for j in range(j0, j1 + 1):
            state.dv_other[0][j] = 0.0
    if const.mirror_y and j0 == 0:
        for i in range(i0, i1 + 1):
            state.dv_other[1][i * const.row_stride] = 0.0
    # of a quarter of the nose, whatever part is modelled: what planes of symmetry cut off has the same force, but for
    # its part along their normals
    f_x, f_y, f_z = state.f_contact_nose
    f_x, f_y = 0.0 if const.mirror_x else f_x, 0.0 if const.mirror_y else f_y
    images = (2 if const.mirror_x else 1) * (2 if const.mirror_y else 1)
    state.force_scale[0] = (
        0.25 * images * math.sqrt(f_x**2 + f_y**2 + f_z**2) / const.points_per_side**2
    )


@kernel(_nrt=False)
def add_forces(state, const, forces):
    """Add a neighbour's forces to state.dv_other."""
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(
                np.uint64(i * const.row_stride + j0), np.uint64(i * const.row_stride + j1 + 1)
            ):
                state.dv_other[c][k] += forces[c][k]


@kernel(_nrt=False)
def clear_increments(state, const):
    """Undo `predict_increments`."""
    for c in range(3):
        state.dv_other[c][:] = 0.0
        state.dv_contact[c][:] = 0.0
    state.force_scale[0] = contact_kernels.MIN_FORCE_SCALE


@kernel(inline="always")
def record_step(state, const, force, row):
    """One row of the history: foremost z, v_z and the force [N] along z; of a bar also the velocities of tip, tail and
    centre of mass, and how far they have come, all along its axis."""
    row[0], row[1] = (
        state.projectile_position[2] + const.foremost_offset,
        bar_kernels.normal_velocity(state, const),
    )
    row[2] = force
    if const.bar_mass.size > 0:
        tail = const.bar_h.size
        row[3], row[4], row[5] = (
            state.bar_v[0],
            state.bar_v[tail],
            bar_kernels.mass_average(const.bar_mass, state.bar_v),
        )
        row[6], row[7], row[8] = (
            state.bar_u[0],
            state.bar_u[tail],
            bar_kernels.mass_average(const.bar_mass, state.bar_u),
        )


@kernel(_nrt=False)
def post_step(states, consts, stack, row):
    """Why the step should be the last, or RUNNING; its row of the history."""
    stack.counter[STEP] += 1
    first, const, last = (
        borrowed_item(states, 0),
        borrowed_item(consts, 0),
        borrowed_item(states, len(states) - 1),
    )
    force = 0.0
    for p in range(len(states)):
        force += stack.f_contact_nose[p, 2]
    record_step(first, const, force + last.f_block_nose[2], row)
    speed = bar_kernels.normal_velocity(first, const)
    if not abs(speed) < 1e9:
        return NOT_FINITE
    if stack.counter[TURNED] > 0:
        return RUNNING
    if speed <= 0.0:
        return STOPPED
    # perforated: yarns have failed, nothing pushes, and nothing that is held is left in front, for a while
    failed, pushed = False, False
    for p in range(len(states)):
        failed |= stack.ply_counters[p, FAILURES] > 0
        pushed |= (
            stack.f_contact_nose[p, 2] != 0.0 or borrowed_item(states, p).f_block_nose[2] != 0.0
        )
    idle = failed and not pushed
    if idle:
        for p in range(len(states)):
            if window_kernels.cloth_ahead_of_nose(
                borrowed_item(states, p), borrowed_item(consts, p)
            ):
                idle = False
                break
    stack.counter[IDLE] = stack.counter[IDLE] + 1 if idle else 0
    return PERFORATED if stack.counter[IDLE] >= const.perforation_delay_steps else RUNNING


@kernel(_nrt=False)
def internal_work(states, contact):
    """[J] work done so far on yarns, their viscosity and the contacts."""
    total = 0.0
    for p in range(len(states)):
        total += ply_kernels.internal_work(borrowed_item(states, p))
    if contact is not None:
        for p in range(len(states)):
            total += contact.work[p]
        total += contact.guard[near_kernels.WORK]
    return total


@kernel(_nrt=False)
def begin(states, consts, works):
    """As `ply_kernels.begin`, of all plies."""
    for p in range(len(states)):
        state, const, work = (
            borrowed_item(states, p),
            borrowed_item(consts, p),
            borrowed_item(works, p),
        )
        ply_kernels.begin(state, const, work)


@entry(nogil=True, _nrt=False)
def run_thread(states, consts, contact, stack, works, history, shared, me, count, allowed):
    """Thread `me` of `count`, each with scratch of its own: at most as many steps as `history` has rows, as
    thread 0 has them.

    The initial forces are computed before the first step, also where there is to be none.

    states, consts, works : of the plies, each a list
    contact : PackContact; None of a single ply
    stack : what the plies share
    history (steps, 3): the projectile's foremost z, v_z of its centre of mass and the force on it after each; of a bar
    (steps, 9), see `record_step`. shared : see `barrier.barrier_wait`. allowed [J] : energy exchange, the sum over
    steps of the change of `internal_work`, after which CHECK ends the call: no energy error can exceed the energy
    exchanged. Returns (steps made, RUNNING or the reason to end) of thread 0.
    """
    if me == 0:
        begin(states, consts, works)
    made, reason, exchanged, before = 0, RUNNING, 0.0, internal_work(states, contact)
    while True:
        if me == 0:
            shared[STOP] = 0 if made < history.shape[0] and reason == RUNNING else 1
            if shared[STOP] == 0:
                begin_step(states, consts, contact, stack)
        barrier_wait(shared, count)
        if shared[STOP] != 0:
            break
        if contact is None:
            step_ply(states, consts, works, shared, me, count)
        else:
            step_plies(states, consts, contact, stack, works, me, count)
            barrier_wait(shared, count)
            press_plies(states, consts, contact, shared, me, count)
            barrier_wait(shared, count)
            implicit_nose_contact(states, consts, contact, stack, works, me, count)
            barrier_wait(shared, count)
        if me == 0:
            if contact is not None:
                count_work(states, consts, contact, True)
            reason = post_step(states, consts, stack, history[made])
            made += 1
            now = internal_work(states, contact)
            exchanged, before = exchanged + abs(now - before), now
            if reason == RUNNING and not exchanged <= allowed:
                reason = CHECK
    refresh_tensions(states, consts, contact, stack, works, me, count)
    barrier_wait(shared, count)
    return made, reason


@kernel(_nrt=False, inline="always")
def refresh_tensions(states, consts, contact, stack, works, me, count):
    """The tensions of one thread's blocks of a single ply, or plies of a pack."""
    if contact is None:
        state, const, work = (
            borrowed_item(states, 0),
            borrowed_item(consts, 0),
            borrowed_item(works, 0),
        )
        first, last = thread_range(state, const, me, count)
        element_kernels.refresh_tensions(state, const, first, last, work)
    else:
        for p in range(me, len(states), count):
            if stack.awake[p]:
                state, const, work = (
                    borrowed_item(states, p),
                    borrowed_item(consts, p),
                    borrowed_item(works, p),
                )
                first, last = thread_range(state, const, 0, 1)
                element_kernels.refresh_tensions(state, const, first, last, work)
