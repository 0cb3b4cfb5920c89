"""One time step of a pack of plies and its projectile, and many of them.

Every ply makes the step of a single one (`panel.step_kernels`); between them stands the contact of
`plies.contact_kernels`. The projectile is one: its speed is shared, and takes the impulses of all plies. Its place is
kept for each ply, counted from the ply's own plane at rest. A ply is skipped until something pushes on it; at most
one ply of a pair is skipped while the pair is computed.

States, constants, scratch and pairs come as lists (`jit.borrowed_list.Items`), so that what is compiled does not depend
on the number of plies. Plies of one grid share their scratch; those of another have their own, since its idle slots
must stay at rest.
Several threads can share the work: each has some plies, then some pairs, and they wait for each other in between. No
two write to the same place, so that results do not depend on their number. The constraints of torn
plies (`plies.torn_contact_kernels`) involve all plies at once, and are one thread's.
"""

import math

import numpy as np

from shellfabric.cloth import boundary_kernels
from shellfabric.jit.barrier import STOP, barrier_wait
from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import entry, kernel
from shellfabric.panel import step_kernels as panel_step_kernels
from shellfabric.panel.step_kernels import CHECK, FAILURES, IDLE, NOT_FINITE, PERFORATED, RUNNING, STEP, STOPPED
from shellfabric.plies import contact_kernels as plies_contact_kernels
from shellfabric.plies import torn_contact_kernels
from shellfabric.projectile import bar_kernels, contact_kernels, window_kernels


@kernel(_nrt=False, forceinline=True)
def ply_step(state, const, work):
    """What a ply does in a step but for the impulses of contact: as `panel.step_kernels.run_thread` has it.

    Returns whether the nose's forces are to be computed after those of the other plies, which implicit springs depend
    on (see `contact_kernels`): as long as the nose pushes.
    """
    panel_step_kernels.grow_active_rows(state, const)
    panel_step_kernels.update_blocks(state, const, work, work.barrier, 0, 1)
    panel_step_kernels.apply_failure(state, const, work)
    panel_step_kernels.out_of_plane_forces(state, const, state.active_rows[0], state.active_rows[1], True)
    waits = const.point_law.implicit_factor > 0.0 and state.f_contact_nose[2] != 0.0
    if not waits:
        nose_contact(state, const, work)
    state.counter[STEP] += 1
    boundary_kernels.update_slip_nodes(state, const, state.counter[STEP] * const.dt)
    return waits


@kernel(_nrt=False)
def nose_contact(state, const, work):
    """The nose's forces on a ply."""
    taken, spring = contact_kernels.contact_forces(state, const, work.contact_scratch)
    state.contact_energy[0] += taken
    state.contact_energy[1] = spring


@kernel(_nrt=False)
def apply_nose_impulses(states, consts, stack):
    """The impulses of the nose on all plies that are awake, and of a block behind the last; then the projectile's own
    motion."""
    last, force = len(states) - 1, 0.0
    for p in range(len(states)):
        if stack.awake[p]:
            state, const = borrowed_item(states, p), borrowed_item(consts, p)
            contact_kernels.apply_contact_impulse(state, const)
            force += bar_kernels.axial_force(state, const)
    state, const = borrowed_item(states, last), borrowed_item(consts, last)
    if const.has_backing and stack.awake[last]:
        panel_step_kernels.apply_backing_impulse(state, const)
    state, const = borrowed_item(states, 0), borrowed_item(consts, 0)
    if const.bar_mass.size > 0:
        bar_kernels.advance_bar(state, const, force)
    for p in range(len(states)):
        for c in range(3):
            stack.projectile_position[p, c] += const.dt * stack.projectile_velocity[c]


@kernel(_nrt=False, forceinline=True)
def apply_forces(state, const, force, touched):
    """Give a ply the impulses of a neighbour's forces; whether there are any."""
    if touched[0] >= touched[1]:
        return False
    plies_contact_kernels.apply_impulses(state, const, force, touched)
    return True


@kernel(_nrt=False)
def step_plies(states, consts, pairs, stack, stops, works, me, count):
    """One thread's plies: the impulses of the others, their own step."""
    last = len(states) - 1
    for p in range(me, len(states), count):
        state, const = borrowed_item(states, p), borrowed_item(consts, p)
        stack.awake[p] |= apply_forces(state, const, stops.f[p], stops.window[p])
        if p > 0:
            near, back = borrowed_item(pairs, p - 1), borrowed_item(pairs, len(pairs) // 2 + p - 1)
            stack.awake[p] |= apply_forces(state, const, near.f_rear, near.rear_window)
            stack.awake[p] |= apply_forces(state, const, back.f_front, back.front_window)
        if p < last:
            near, back = borrowed_item(pairs, p), borrowed_item(pairs, len(pairs) // 2 + p)
            stack.awake[p] |= apply_forces(state, const, near.f_front, near.front_window)
            stack.awake[p] |= apply_forces(state, const, back.f_rear, back.rear_window)
        if stack.awake[p]:
            stack.waits_for_plies[p] = ply_step(state, const, borrowed_item(works, p))


@kernel(_nrt=False)
def step_pairs(states, consts, pairs, stack, me, count):
    """One thread's pairs of plies, one of which at least is awake."""
    step = stack.counter[STEP]
    for p in range(me, len(states) - 1, count):
        if stack.awake[p] or stack.awake[p + 1]:
            front, fc, rear, rc = (
                borrowed_item(states, p),
                borrowed_item(consts, p),
                borrowed_item(states, p + 1),
                borrowed_item(consts, p + 1),
            )
            plies_contact_kernels.contact_forces(front, fc, rear, rc, borrowed_item(pairs, p), step)
            plies_contact_kernels.contact_forces_back(
                rear, rc, front, fc, borrowed_item(pairs, len(pairs) // 2 + p), step
            )


@kernel(_nrt=False)
def implicit_nose_contact(states, consts, pairs, stack, works, me, count):
    """The nose's forces on those of one thread's plies that wait for the others' (see `ply_step`)."""
    for p in range(me, len(states), count):
        if stack.waits_for_plies[p]:
            state, const = borrowed_item(states, p), borrowed_item(consts, p)
            predict_increments(state, const, pairs, p, len(states))
            nose_contact(state, const, borrowed_item(works, p))
            if state.f_contact_nose[2] == 0.0:
                clear_increments(state, const)


@kernel(_nrt=False)
def predict_increments(state, const, pairs, p, plies):
    """By what all other forces will speed up the nodes of ply p that the nose can push, into state.dv_other, and by
    what the nose's own of a step ago have, into state.dv_contact; the nose's force shared out to one element, into
    state.force_scale."""
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    half = len(pairs) // 2
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(np.uint64(i * const.row_stride + j0), np.uint64(i * const.row_stride + j1 + 1)):
                state.dv_other[c][k] = state.f_int[c][k] + state.f_int_above[c][k]
                if const.has_backing:
                    state.dv_other[c][k] += state.f_block_cloth[c][k]
    if p > 0:
        near, back = borrowed_item(pairs, p - 1), borrowed_item(pairs, half + p - 1)
        add_forces(state, const, near.f_rear)
        add_forces(state, const, back.f_front)
    if p < plies - 1:
        near, back = borrowed_item(pairs, p), borrowed_item(pairs, half + p)
        add_forces(state, const, near.f_front)
        add_forces(state, const, back.f_rear)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(np.uint64(i * const.row_stride + j0), np.uint64(i * const.row_stride + j1 + 1)):
                state.dv_other[c][k] *= state.dt_over_mass[k]
                state.dv_contact[c][k] = state.dt_over_mass[k] * state.f_contact[c][k]
    if const.mirror_x and i0 == 0:
        for j in range(j0, j1 + 1):
            state.dv_other[0][j] = 0.0
    if const.mirror_y and j0 == 0:
        for i in range(i0, i1 + 1):
            state.dv_other[1][i * const.row_stride] = 0.0
    force = state.f_contact_nose[0] ** 2 + state.f_contact_nose[1] ** 2 + state.f_contact_nose[2] ** 2
    state.force_scale[0] = math.sqrt(force) / const.points_per_side**2


@kernel(_nrt=False)
def add_forces(state, const, forces):
    """Add a neighbour's forces to state.dv_other."""
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(np.uint64(i * const.row_stride + j0), np.uint64(i * const.row_stride + j1 + 1)):
                state.dv_other[c][k] += forces[c][k]


@kernel(_nrt=False)
def clear_increments(state, const):
    """Undo `predict_increments`."""
    for c in range(3):
        state.dv_other[c][:] = 0.0
        state.dv_contact[c][:] = 0.0
    state.force_scale[0] = contact_kernels.MIN_FORCE_SCALE


@kernel(_nrt=False)
def post_step(states, consts, stack, row):
    """Why the step should be the last, or RUNNING; as `panel.step_kernels.post_step`, with all plies for the one. What
    `panel.step_kernels.record_step` has of it goes into a row."""
    stack.counter[STEP] += 1
    first, const, last = borrowed_item(states, 0), borrowed_item(consts, 0), borrowed_item(states, len(states) - 1)
    force = 0.0
    for p in range(len(states)):
        force += stack.f_contact_nose[p, 2]
    panel_step_kernels.record_step(first, const, force + last.f_block_nose[2], row)
    speed = bar_kernels.normal_velocity(first, const)
    if not abs(speed) < 1e9:
        return NOT_FINITE
    if speed <= 0.0:
        return STOPPED
    failed, pushed = False, False
    for p in range(len(states)):
        failed |= stack.ply_counters[p, FAILURES] > 0
        pushed |= stack.f_contact_nose[p, 2] != 0.0 or borrowed_item(states, p).f_block_nose[2] != 0.0
    idle = failed and not pushed
    if idle:
        for p in range(len(states)):
            if window_kernels.cloth_ahead_of_nose(borrowed_item(states, p), borrowed_item(consts, p)):
                idle = False
                break
    stack.counter[IDLE] = stack.counter[IDLE] + 1 if idle else 0
    return PERFORATED if stack.counter[IDLE] >= const.perforation_delay_steps else RUNNING


@kernel(_nrt=False)
def internal_work(states, pairs):
    """[J] work that plies and contacts have taken in so far; see `panel.step_kernels.internal_work`."""
    total = 0.0
    for p in range(len(states)):
        total += panel_step_kernels.internal_work(borrowed_item(states, p))
    for p in range(len(pairs)):
        total += borrowed_item(pairs, p).energy[plies_contact_kernels.WORK]
    return total


@kernel(_nrt=False)
def begin(states, consts, works):
    """As `panel.step_kernels.begin`, of all plies."""
    for p in range(len(states)):
        panel_step_kernels.begin(borrowed_item(states, p), borrowed_item(consts, p), borrowed_item(works, p))


@entry(nogil=True)
def run_thread(states, consts, pairs, stack, stops, works, steps, history, shared, me, count, allowed):
    """Thread `me` of `count`: at most `steps` steps, as thread 0 has them; see `panel.step_kernels.run_thread`."""
    if me == 0:
        begin(states, consts, works)
    made, reason, exchanged, before = (
        0,
        RUNNING,
        0.0,
        internal_work(states, pairs) + stops.energy[torn_contact_kernels.WORK],
    )
    while True:
        if me == 0:
            shared[STOP] = 0 if made < steps and reason == RUNNING else 1
            if shared[STOP] == 0:
                apply_nose_impulses(states, consts, stack)
        barrier_wait(shared, count)
        if shared[STOP] != 0:
            break
        step_plies(states, consts, pairs, stack, stops, works, me, count)
        barrier_wait(shared, count)
        step_pairs(states, consts, pairs, stack, me, count)
        barrier_wait(shared, count)
        implicit_nose_contact(states, consts, pairs, stack, works, me, count)
        barrier_wait(shared, count)
        if me == 0:
            torn_contact_kernels.enforce_constraints(states, consts, pairs, stack, stops)
            reason = post_step(states, consts, stack, history[made])
            made += 1
            now = internal_work(states, pairs) + stops.energy[torn_contact_kernels.WORK]
            exchanged, before = exchanged + abs(now - before), now
            if reason == RUNNING and not exchanged <= allowed:
                reason = CHECK
    refresh_tensions(states, consts, stack, works, me, count)
    barrier_wait(shared, count)
    return made, reason


@kernel(_nrt=False)
def refresh_tensions(states, consts, stack, works, me, count):
    """The tensions of one thread's plies, as `panel.step_kernels.refresh_tensions`."""
    for p in range(me, len(states), count):
        if stack.awake[p]:
            state, const = borrowed_item(states, p), borrowed_item(consts, p)
            first, last = panel_step_kernels.thread_range(state, const, 0, 1)
            panel_step_kernels.refresh_tensions(state, const, first, last, borrowed_item(works, p))
