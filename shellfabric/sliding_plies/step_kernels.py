"""Explicit time steps of a pack whose yarns slide through their crossovers: `plies.step_kernels` with the yarn's slip.

Every ply makes the step of `sliding.step_kernels`, the pack the contacts between them. The fluxes of a ply are updated
last, when all forces on its nodes are known: those of its yarns, of the nose, of both neighbours and of what keeps torn
cloth apart. The sum of the contact forces is what presses the yarns on each other in the threshold of slip.

Segments that a yarn's end has left, and elements in which a window has opened, count as failures of their ply: there
the contact between plies looks for edges and holes, and the projectile for a way through.

With an infinite threshold no flux is computed, and each step is, digit by digit, that of a pack of pinned plies.
"""

import numpy as np

from shellfabric.cloth import boundary_kernels
from shellfabric.jit.barrier import STOP, barrier_wait
from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import entry, kernel
from shellfabric.jit.simd import WIDTH, load, masked_store
from shellfabric.panel.motion_kernels import grow_active_rows
from shellfabric.panel.step_kernels import CHECK, FAILURES, RUNNING, STEP
from shellfabric.plies import step_kernels as plies
from shellfabric.plies import torn_contact_kernels
from shellfabric.sliding import flow_kernels, forces_kernels, slip_kernels
from shellfabric.sliding import step_kernels as sliding
from shellfabric.sliding.flow_kernels import OPENED, PULLED_OUT


@kernel(_nrt=False, forceinline=True)
def ply_step(states, const, slip, works):
    """What a ply does in a step but for the impulses of contact and its fluxes; see `plies.step_kernels.ply_step`.

    states, works : see `sliding.step_kernels.run_steps`
    """
    state, lost = states[0], slip.counter[PULLED_OUT] + slip.counter[OPENED]
    grow_active_rows(state, const)
    if slip.active:
        sliding.grow_with_slip(state, const, slip)
        flow_kernels.move_yarn(state, const, slip)
    sliding.update_blocks(state, const, slip, works)
    sliding.remove_segments(states, const, slip, works)
    if slip.active:
        flow_kernels.open_windows(state, const, slip)
    state.counter[FAILURES] += slip.counter[PULLED_OUT] + slip.counter[OPENED] - lost
    waits = const.point_law.implicit_factor > 0.0 and state.f_contact_nose[2] != 0.0
    if not waits:
        plies.nose_contact(state, const, works[0])
    state.counter[STEP] += 1
    boundary_kernels.update_slip_nodes(state, const, state.counter[STEP] * const.dt)
    return waits


@kernel(_nrt=False)
def step_plies(pack, pairs, stack, stops, works, me, count):
    """One thread's plies: the impulses of the others, their own step; as `plies.step_kernels.step_plies`."""
    states, effective, _, consts, slips = pack
    last, half = len(states) - 1, len(pairs) // 2
    for p in range(me, len(states), count):
        state, const = borrowed_item(states, p), borrowed_item(consts, p)
        stack.awake[p] |= plies.apply_forces(state, const, stops.f[p], stops.window[p])
        if p > 0:
            near, back = borrowed_item(pairs, p - 1), borrowed_item(pairs, half + p - 1)
            stack.awake[p] |= plies.apply_forces(state, const, near.f_rear, near.rear_window)
            stack.awake[p] |= plies.apply_forces(state, const, back.f_front, back.front_window)
        if p < last:
            near, back = borrowed_item(pairs, p), borrowed_item(pairs, half + p)
            stack.awake[p] |= plies.apply_forces(state, const, near.f_front, near.front_window)
            stack.awake[p] |= plies.apply_forces(state, const, back.f_rear, back.rear_window)
        if stack.awake[p]:
            both = borrowed_item(works[0], p), borrowed_item(works[1], p)
            stack.waits_for_plies[p] = ply_step(
                (state, borrowed_item(effective, p)), const, borrowed_item(slips, p), both
            )


@kernel(_nrt=False)
def add_rows(total, state, const, forces):
    """Add forces on the nodes of the active rows to `total`."""
    s = const.row_stride
    for c in range(3):
        for i in range(state.active_rows[0], state.active_rows[1] + 1):
            for j in range(0, s, WIDTH):
                k = i * s + j
                masked_store(total[c], k, load(total[c], k) + load(forces[c], k), s - j)


@kernel(_nrt=False)
def gather_contact(pack, pairs, stops, p):
    """Sum of the contact forces on the active rows of ply p, into the contact forces of its loaded state."""
    states, _, loaded, consts, _ = pack
    state, const, total = borrowed_item(states, p), borrowed_item(consts, p), borrowed_item(loaded, p).f_contact
    s, half = const.row_stride, len(pairs) // 2
    for c in range(3):
        for i in range(state.active_rows[0], state.active_rows[1] + 1):
            for k in range(np.uint64(i * s), np.uint64((i + 1) * s)):
                total[c][k] = state.f_contact[c][k] + stops.f[p, c, k]
    if p > 0:
        add_rows(total, state, const, borrowed_item(pairs, p - 1).f_rear)
        add_rows(total, state, const, borrowed_item(pairs, half + p - 1).f_front)
    if p < len(states) - 1:
        add_rows(total, state, const, borrowed_item(pairs, p).f_front)
        add_rows(total, state, const, borrowed_item(pairs, half + p).f_rear)


@kernel(_nrt=False)
def slip_plies(pack, pairs, stack, stops, me, count):
    """New fluxes of one thread's plies."""
    for p in range(me, len(pack[0]), count):
        slip = borrowed_item(pack[4], p)
        if stack.awake[p] and slip.active:
            gather_contact(pack, pairs, stops, p)
            slip_kernels.slip_nodes(borrowed_item(pack[2], p), borrowed_item(pack[3], p), slip)


@kernel(_nrt=False)
def begin(pack, works):
    """As `sliding.step_kernels.begin`, of all plies."""
    states, _, _, consts, slips = pack
    for p in range(len(states)):
        both = borrowed_item(works[0], p), borrowed_item(works[1], p)
        sliding.begin(borrowed_item(states, p), borrowed_item(consts, p), borrowed_item(slips, p), both)


@entry(nogil=True)
def run_thread(pack, pairs, stack, stops, works, steps, history, shared, me, count, allowed):
    """Thread `me` of `count`: at most `steps` steps, as thread 0 has them; as `plies.step_kernels.run_thread`.

    pack : (states, the same with the effective stretches in the place of the stretches, the same with the sum of all
        contact forces in the place of those of the nose, constants, slips) of the plies, each a list
    works : (scratch, the same scratch with the effective stretches in the place of the stretches), each a list
    """
    states, consts = pack[0], pack[3]
    if me == 0:
        begin(pack, works)
    made, reason, exchanged = 0, RUNNING, 0.0
    before = plies.internal_work(states, pairs) + stops.energy[torn_contact_kernels.WORK]
    while True:
        if me == 0:
            shared[STOP] = 0 if made < steps and reason == RUNNING else 1
            if shared[STOP] == 0:
                plies.apply_nose_impulses(states, consts, stack)
        barrier_wait(shared, count)
        if shared[STOP] != 0:
            break
        step_plies(pack, pairs, stack, stops, works, me, count)
        barrier_wait(shared, count)
        plies.step_pairs(states, consts, pairs, stack, me, count)
        barrier_wait(shared, count)
        plies.implicit_nose_contact(states, consts, pairs, stack, works[0], me, count)
        barrier_wait(shared, count)
        if me == 0:
            torn_contact_kernels.enforce_constraints(states, consts, pairs, stack, stops)
        barrier_wait(shared, count)
        slip_plies(pack, pairs, stack, stops, me, count)
        barrier_wait(shared, count)
        if me == 0:
            reason = plies.post_step(states, consts, stack, history[made])
            made += 1
            now = plies.internal_work(states, pairs) + stops.energy[torn_contact_kernels.WORK]
            exchanged, before = exchanged + abs(now - before), now
            if reason == RUNNING and not exchanged <= allowed:
                reason = CHECK
    refresh_tensions(pack, stack, works, me, count)
    barrier_wait(shared, count)
    return made, reason


@kernel(_nrt=False)
def refresh_tensions(pack, stack, works, me, count):
    """The tensions of one thread's plies."""
    states, _, _, consts, slips = pack
    for p in range(me, len(states), count):
        if stack.awake[p]:
            state, const = borrowed_item(states, p), borrowed_item(consts, p)
            first, last, per = state.active_rows[0], state.active_rows[1], const.rows_per_block
            both = borrowed_item(works[0], p), borrowed_item(works[1], p)
            forces_kernels.refresh_tensions(
                state, const, borrowed_item(slips, p), first // per, (last + per - 1) // per, both
            )
