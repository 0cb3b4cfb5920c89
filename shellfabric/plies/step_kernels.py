"""One time step of a pack of plies and its projectile, and many of them.

Every ply makes the step of a single one (`march_kernels`); between them stands the contact of `ply_contact_kernels`.
The projectile is one: its speed is shared, and takes the impulses of all plies. Its place is kept for each ply, counted
from the ply's own plane at rest. A ply sleeps, and costs nothing, until something pushes on it. At most one ply of a
pair is asleep while the pair is looked at.

States, constants, scratch and pairs come as numba's lists, so that what is compiled does not depend on the number of
plies. Plies of one grid share their scratch; those of another have their own, since its idle slots must stay at rest.
Several threads can share the work: each has some plies, then some pairs, and they wait for each other in between. No
two write to the same place, so that results do not depend on their number. What keeps torn cloth apart
(`ply_stop_kernels`) looks at all plies at once, and is one thread's.
"""

import math

import numpy as np
from numba.typed import List

from shellfabric.cloth import boundary_kernels
from shellfabric.jit.barrier import STOP, meet
from shellfabric.jit.borrowed_list import item
from shellfabric.jit.compile import entry, kernel
from shellfabric.panel import step_kernels as panel_step_kernels
from shellfabric.panel.step_kernels import CHECK, FAILURES, IDLE, NOT_FINITE, PERFORATED, RUNNING, STEP, STOPPED
from shellfabric.plies import contact_kernels as plies_contact_kernels
from shellfabric.plies import torn_contact_kernels
from shellfabric.projectile import bar_kernels, contact_kernels


@entry()
def listed(first):
    """A numba list of one item; compiled once for all runs, unlike `List` used from without."""
    items = List()
    items.append(first)
    return items


@entry()
def append(items, one):
    """Add one to such a list."""
    items.append(one)


@kernel(_nrt=False, forceinline=True)
def ply_step(state, const, work):
    """What a ply does in a step but for the impulses of contact: as `march_kernels.lead` has it.

    Returns whether the nose's forces are to wait for those of the other plies, which firm springs answer to (see
    `contact_kernels`). So they do as long as the nose pushes; when it comes there is nothing yet to answer to.
    """
    panel_step_kernels.widen(state, const)
    panel_step_kernels.sweep(state, const, work, work.shared, 0, 1)
    panel_step_kernels.fail(state, const, work)
    panel_step_kernels.resist(state, const, state.rows[0], state.rows[1], True)
    waits = const.firmer > 0.0 and state.reaction[2] != 0.0
    if not waits:
        press(state, const, work)
    state.counter[STEP] += 1
    boundary_kernels.hold(state, const, state.counter[STEP] * const.dt)
    return waits


@kernel(_nrt=False)
def press(state, const, work):
    """The nose's forces on a ply."""
    taken, spring = contact_kernels.contact(state, const, work.touch)
    state.contact_energy[0] += taken
    state.contact_energy[1] = spring


@kernel(_nrt=False)
def launch(states, consts, stack):
    """The impulses of the nose on all plies that are awake, and of a block behind the last; then the projectile's own
    motion."""
    last, force = len(states) - 1, 0.0
    for p in range(len(states)):
        if stack.awake[p]:
            state, const = item(states, p), item(consts, p)
            contact_kernels.push(state, const)
            force += bar_kernels.along(state, const)
    state, const = item(states, last), item(consts, last)
    if const.backed and stack.awake[last]:
        panel_step_kernels.lean(state, const)
    state, const = item(states, 0), item(consts, 0)
    if const.bar_mass.size > 0:
        bar_kernels.fly(state, const, force)
    for p in range(len(states)):
        for c in range(3):
            stack.places[p, c] += const.dt * stack.speed[c]


@kernel(_nrt=False, forceinline=True)
def give(state, const, force, touched):
    """Give a ply the impulses of a neighbour's forces; whether there are any."""
    if touched[0] >= touched[1]:
        return False
    plies_contact_kernels.push(state, const, force, touched)
    return True


@kernel(_nrt=False)
def step_plies(states, consts, pairs, stack, stops, works, me, count):
    """One thread's plies: the impulses of the others, their own step."""
    last = len(states) - 1
    for p in range(me, len(states), count):
        state, const = item(states, p), item(consts, p)
        stack.awake[p] |= give(state, const, stops.force[p], stops.touched[p])
        if p > 0:
            near, back = item(pairs, p - 1), item(pairs, len(pairs) // 2 + p - 1)
            stack.awake[p] |= give(state, const, near.on_rear, near.rear_touched)
            stack.awake[p] |= give(state, const, back.on_front, back.front_touched)
        if p < last:
            near, back = item(pairs, p), item(pairs, len(pairs) // 2 + p)
            stack.awake[p] |= give(state, const, near.on_front, near.front_touched)
            stack.awake[p] |= give(state, const, back.on_rear, back.rear_touched)
        if stack.awake[p]:
            stack.firm[p] = ply_step(state, const, item(works, p))


@kernel(_nrt=False)
def step_pairs(states, consts, pairs, stack, me, count):
    """One thread's pairs of plies, one of which at least is awake."""
    step = stack.counter[STEP]
    for p in range(me, len(states) - 1, count):
        if stack.awake[p] or stack.awake[p + 1]:
            front, fc, rear, rc = item(states, p), item(consts, p), item(states, p + 1), item(consts, p + 1)
            plies_contact_kernels.contact(front, fc, rear, rc, item(pairs, p), step)
            plies_contact_kernels.contact_back(rear, rc, front, fc, item(pairs, len(pairs) // 2 + p), step)


@kernel(_nrt=False)
def press_firmly(states, consts, pairs, stack, works, me, count):
    """The nose's forces on those of one thread's plies that wait for the others' (see `ply_step`)."""
    for p in range(me, len(states), count):
        if stack.firm[p]:
            state, const = item(states, p), item(consts, p)
            foresee(state, const, pairs, p, len(states))
            press(state, const, item(works, p))
            if state.reaction[2] == 0.0:
                forget(state, const)


@kernel(_nrt=False)
def foresee(state, const, pairs, p, plies):
    """By what all other forces will speed up the nodes of ply p that the nose can push, into state.due, and by what the
    nose's own of a step ago have, into state.pushed; the nose's force shared out to one element, into state.usual."""
    i0, i1, j0, j1 = contact_kernels.reached(state, const)
    half = len(pairs) // 2
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(np.uint64(i * const.s + j0), np.uint64(i * const.s + j1 + 1)):
                state.due[c][k] = state.g0[c][k] + state.g1[c][k]
                if const.backed:
                    state.due[c][k] += state.behind[c][k]
    if p > 0:
        near, back = item(pairs, p - 1), item(pairs, half + p - 1)
        add(state, const, near.on_rear)
        add(state, const, back.on_front)
    if p < plies - 1:
        near, back = item(pairs, p), item(pairs, half + p)
        add(state, const, near.on_front)
        add(state, const, back.on_rear)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(np.uint64(i * const.s + j0), np.uint64(i * const.s + j1 + 1)):
                state.due[c][k] *= state.kick[k]
                state.pushed[c][k] = state.kick[k] * state.contact[c][k]
    if const.mirror_x and i0 == 0:
        for j in range(j0, j1 + 1):
            state.due[0][j] = 0.0
    if const.mirror_y and j0 == 0:
        for i in range(i0, i1 + 1):
            state.due[1][i * const.s] = 0.0
    force = state.reaction[0] ** 2 + state.reaction[1] ** 2 + state.reaction[2] ** 2
    state.usual[0] = math.sqrt(force) / const.points**2


@kernel(_nrt=False)
def add(state, const, forces):
    """Add a neighbour's forces to state.due."""
    i0, i1, j0, j1 = contact_kernels.reached(state, const)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(np.uint64(i * const.s + j0), np.uint64(i * const.s + j1 + 1)):
                state.due[c][k] += forces[c][k]


@kernel(_nrt=False)
def forget(state, const):
    """Undo `foresee`."""
    for c in range(3):
        state.due[c][:] = 0.0
        state.pushed[c][:] = 0.0
    state.usual[0] = contact_kernels.LEAST


@kernel(_nrt=False)
def conclude(states, consts, stack, row):
    """Why the step should be the last, or RUNNING; as `march_kernels.conclude`, with all plies for the one. What
    `march_kernels.tell` has of it goes into a row."""
    stack.counter[STEP] += 1
    first, const, last = item(states, 0), item(consts, 0), item(states, len(states) - 1)
    force = 0.0
    for p in range(len(states)):
        force += stack.reactions[p, 2]
    panel_step_kernels.tell(first, const, force + last.outer[2], row)
    speed = bar_kernels.approach(first, const)
    if not abs(speed) < 1e9:
        return NOT_FINITE
    if speed <= 0.0:
        return STOPPED
    failed, pushed = False, False
    for p in range(len(states)):
        failed |= stack.counters[p, FAILURES] > 0
        pushed |= stack.reactions[p, 2] != 0.0 or item(states, p).outer[2] != 0.0
    idle = failed and not pushed
    if idle:
        for p in range(len(states)):
            if contact_kernels.in_the_way(item(states, p), item(consts, p)):
                idle = False
                break
    stack.counter[IDLE] = stack.counter[IDLE] + 1 if idle else 0
    return PERFORATED if stack.counter[IDLE] >= const.idle_steps else RUNNING


@kernel(_nrt=False)
def worked(states, pairs):
    """[J] work that plies and contacts have taken in so far; see `march_kernels.worked`."""
    total = 0.0
    for p in range(len(states)):
        total += panel_step_kernels.worked(item(states, p))
    for p in range(len(pairs)):
        total += item(pairs, p).energy[plies_contact_kernels.TAKEN]
    return total


@entry(nogil=True)
def lead(states, consts, pairs, stack, stops, works, steps, history, shared, count, allowed):
    """March at most `steps` steps, with `count` - 1 threads that `follow`; see `march_kernels.lead`."""
    made, reason, exchanged, before = 0, RUNNING, 0.0, worked(states, pairs) + stops.energy[torn_contact_kernels.TAKEN]
    while made < steps and reason == RUNNING:
        launch(states, consts, stack)
        meet(shared, count)
        step_plies(states, consts, pairs, stack, stops, works, 0, count)
        meet(shared, count)
        step_pairs(states, consts, pairs, stack, 0, count)
        meet(shared, count)
        press_firmly(states, consts, pairs, stack, works, 0, count)
        meet(shared, count)
        torn_contact_kernels.restrain(states, consts, pairs, stack, stops)
        reason = conclude(states, consts, stack, history[made])
        made += 1
        now = worked(states, pairs) + stops.energy[torn_contact_kernels.TAKEN]
        exchanged, before = exchanged + abs(now - before), now
        if reason == RUNNING and not exchanged <= allowed:
            reason = CHECK
    shared[STOP] = 1
    meet(shared, count)
    freshen(states, consts, stack, works, 0, count)
    meet(shared, count)
    return made, reason


@entry(nogil=True)
def follow(states, consts, pairs, stack, stops, works, shared, me, count):
    """Do thread number `me`'s part of each step that `lead` makes."""
    while True:
        meet(shared, count)
        if shared[STOP] != 0:
            break
        step_plies(states, consts, pairs, stack, stops, works, me, count)
        meet(shared, count)
        step_pairs(states, consts, pairs, stack, me, count)
        meet(shared, count)
        press_firmly(states, consts, pairs, stack, works, me, count)
        meet(shared, count)
    freshen(states, consts, stack, works, me, count)
    meet(shared, count)


@kernel(_nrt=False)
def freshen(states, consts, stack, works, me, count):
    """The tensions of one thread's plies, as `march_kernels.freshen`."""
    for p in range(me, len(states), count):
        if stack.awake[p]:
            state, const = item(states, p), item(consts, p)
            first, last = panel_step_kernels.part(state, const, 0, 1)
            panel_step_kernels.freshen(state, const, first, last, item(works, p))
