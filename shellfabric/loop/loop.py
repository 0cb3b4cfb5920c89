"""The time loop: explicit steps of the plies of a run and of their projectile.

All forces of a step are known before it begins: from them the guard of a pack finds what keeps the
plies from passing through each other in it. Several threads can share the plies of a pack, and wait
for each other in between. No two write to the same place, so that results do not depend on their number;
what involves all plies at once is one thread's.

States, constants and scratch come as lists (`jit.table.Rows`), so that what is compiled does not depend
on the number of plies. Plies of one grid share their scratch; those of another have their own, since
its idle slots must stay at rest.
"""

from shellfabric.jit.barrier import STOP, barrier_wait
from shellfabric.jit.compile import entry, kernel
from shellfabric.jit.table import row_of
from shellfabric.loop.ply_kernels import begin as begin_ply
from shellfabric.loop.ply_kernels import (
    break_yarns,
    meet_nose,
    other_forces,
    place_surface,
    touch,
    update_blocks,
)
from shellfabric.loop.stack_kernels import (
    CHECK,
    RUNNING,
    finish_parts,
    fly,
    implicit_nose_contact,
    internal_work,
    move_edges,
    note,
    press_plies,
    wakes,
)
from shellfabric.membrane.element_kernels import refresh_tensions
from shellfabric.membrane.motion_kernels import active_blocks, grow_active_rows
from shellfabric.plies.frame_kernels import mark_torn
from shellfabric.plies.pack_guard_kernels import (
    add_guard_work,
    enforce_constraints,
    update_displacements,
)


@entry(nogil=True, _nrt=False)
def advance(states, consts, contact, stack, works, history, shared, me, count, allowed):
    """Advance by at most as many steps as `history` has rows, as thread `me` of `count`, each with
    scratch of its own.

    states, consts, works : of the plies, each a list
    contact : PackContact; of a single ply one without points
    stack : what the plies share
    history : (steps, 3) the projectile's foremost z, v_z of its centre of mass and the force on it after
        each; of a bar (steps, 9), see `stack_kernels.record_step`
    shared : see `barrier.barrier_wait`
    allowed : [J] energy exchange, the sum over steps of the change of `internal_work`, after which CHECK
        ends the call: no energy error can exceed the energy exchanged

    Returns (steps made, RUNNING or the reason to end) of thread 0.
    """
    several = len(states) > 1
    if me == 0:
        begin(states, consts, works)
    made = 0
    reason = RUNNING
    exchanged = 0.0
    before = internal_work(states, contact)
    while True:
        if me == 0:
            shared[STOP] = 0 if made < history.shape[0] and reason == RUNNING else 1
            if shared[STOP] == 0:
                if several:
                    # positions after the step follow from forces that are all known by now
                    enforce_constraints(states, consts, contact)
                fly(states, consts, stack)
        barrier_wait(shared, count)
        if shared[STOP] != 0:
            break
        for p in range(me, len(states), count):
            state = row_of(states, p)
            const = row_of(consts, p)
            work = row_of(works, p)
            if several and not wakes(state, const, contact, stack, p):
                continue
            grow_active_rows(state, const)
            update_blocks(state, const, work)
            break_yarns(state, const, work)
            other_forces(state, const, state.first_row, state.end_row, True)
            if state.parts.replaces_membrane:  # it places what the other plies see of it
                meet_nose(state, const)
                place_surface(state, const, several)
            else:
                place_surface(state, const, several)
                # an implicit spring of the nose has to know the pushes of the other plies first
                stack.waits_for_plies[p] = touch(state, const, work)
            state.steps += 1
            if several:
                mark_torn(state, const, contact, p)
                update_displacements(state, const, contact, p)
        if several:
            press_plies(states, consts, contact, shared, me, count)
            barrier_wait(shared, count)
            implicit_nose_contact(states, consts, contact, stack, works, me, count)
            barrier_wait(shared, count)
        if me == 0:
            if several:
                add_guard_work(states, consts, contact, True)
            reason = note(states, consts, stack, history[made])
            finish_parts(states, consts, stack)
            move_edges(states, consts, contact)
            made += 1
            now = internal_work(states, contact)
            exchanged += abs(now - before)
            before = now
            if reason == RUNNING and not exchanged <= allowed:
                reason = CHECK
    for p in range(me, len(states), count):
        if stack.awake[p]:
            refresh(states, consts, works, p)
    barrier_wait(shared, count)
    return made, reason


@kernel(_nrt=False)
def refresh(states, consts, works, p):
    """Look up the tensions of ply p that nothing has needed so far."""
    state = row_of(states, p)
    const = row_of(consts, p)
    first, last = active_blocks(state, const)
    refresh_tensions(state, const, first, last, row_of(works, p))


@kernel(_nrt=False)
def begin(states, consts, works):
    """Compute the forces and slipping edges of all plies at rest, before the first step."""
    for p in range(len(states)):
        begin_ply(row_of(states, p), row_of(consts, p), row_of(works, p))
