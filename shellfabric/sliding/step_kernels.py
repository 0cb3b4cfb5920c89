"""Explicit time steps of a panel with sliding crossovers: those of `panel.step_kernels` with the yarn's slip.

    the yarn moves on by the fluxes q(n+1/2), the nodes by their velocities;
    forces and configurational forces at n+1;  failure, contact, boundary;  fluxes q(n+3/2)  (`slip_kernels`)

What the fluxes take of the forces is subtracted from them at the end of a step, so that the next step moves the nodes
as on a pinned panel. With an infinite threshold no flux is computed, and each step is, digit by digit, the pinned one.
"""

from shellfabric.cloth import boundary_kernels, energy_kernels, failure_kernels
from shellfabric.jit.compile import entry, kernel
from shellfabric.panel.element_kernels import DAMAGED, LOST_TRELLIS, LOST_YARN, REDO, VISCOUS, WORK
from shellfabric.panel.motion_kernels import move_rows
from shellfabric.panel.step_kernels import (
    AT_REST,
    CHECK,
    FAILURES,
    IDLE,
    NOT_FINITE,
    PERFORATED,
    RUNNING,
    STEP,
    STOPPED,
    internal_work,
    pre_step,
    record_step,
    rows_near_failure,
)
from shellfabric.projectile import bar_kernels, contact_kernels, window_kernels
from shellfabric.sliding import flow_kernels, forces_kernels, slip_energy_kernels, slip_kernels
from shellfabric.sliding.flow_kernels import EMPTIED, OPENED
from shellfabric.sliding.forces_kernels import element_forces, refresh_tensions


@kernel(_nrt=False)
def grow_with_slip(state, const, slip):
    """Grow the window of active element rows ahead of the slip, as `motion_kernels.grow_active_rows` does of motion."""
    first, last = state.active_rows[0], state.active_rows[1]
    for i in range(first, min(first + 4, const.ni + 1)):
        if slip.row_slips[i] and first > 0:
            state.active_rows[0] = max(first - 2, 0)
    for i in range(max(last - 3, 0), last + 1):
        if slip.row_slips[i] and last < const.ni:
            state.active_rows[1] = min(last + 2, const.ni)


@kernel(_nrt=False)
def update_blocks(state, const, slip, works):
    """Move the active nodes and compute the forces, block by block, as `panel.step_kernels.update_blocks` of one
    thread."""
    low, high, per = state.active_rows[0], state.active_rows[1], const.rows_per_block
    end = high + 1
    done = min(low + 2, end)
    tail = max(end - 2, done)
    move_rows(state, const, low, done)
    move_rows(state, const, tail, end)
    for block in range(low // per, (high + per - 1) // per):
        begin, stop = max(low, block * per), min(high, (block + 1) * per)
        ahead = max(done, min(stop + 2, tail))
        move_rows(state, const, done, ahead)
        done = ahead
        element_forces(state, const, slip, block, begin, stop, works)


@kernel(_nrt=False)
def stored(states, const, slip, low, high):
    """[J] (of yarns, of trellis and lateral contact) of the element rows low .. high - 1."""
    state, state_x = states
    yarns = failure_kernels.stored_energy(const, state_x, low, high)[0]
    yarns += forces_kernels.gained_energy(state, const, slip, low, high)
    return yarns, failure_kernels.stored_energy(const, state, low, high)[1] + forces_kernels.lateral_energy(
        state, const, slip
    )


@kernel(_nrt=False)
def remove_segments(states, const, slip, works):
    """Failure criterion and yarn ends that leave a node: remove the segments, and compute their blocks again."""
    state, emptied = states[0], slip.counter[EMPTIED] != 0
    first, last = rows_near_failure(state, const)
    if first >= last and not emptied:
        return
    most1, most2, per = 0.0, 0.0, const.rows_per_block
    if first < last:
        refresh_tensions(state, const, slip, first // per, (last + per - 1) // per, works)
        for block in range(first // per, (last + per - 1) // per):
            most1, most2 = max(most1, state.block_max_tension[block, 0]), max(most2, state.block_max_tension[block, 1])
    near = (
        emptied
        or const.filter_alpha > 0.0
        or (most1 > const.min_strength1 and failure_kernels.any_past_strength(const, state, 0, first, last))
        or (most2 > const.min_strength2 and failure_kernels.any_past_strength(const, state, 1, first, last))
    )
    cells, sheared, worked, damped = 0.0, 0.0, 0.0, 0.0
    low, high = (0, const.ni) if emptied else (max(first - 4, 0), min(last + 4, const.ni))
    if near:
        cells, sheared = stored(states, const, slip, low, high)
        worked, damped = failure_kernels.half_step_work(const, state, low, high)
    count = 0
    if first < last:
        count += failure_kernels.detect_failures(const, state, 0, first, last)
        count += failure_kernels.detect_failures(const, state, 1, first, last)
        state.counter[FAILURES] += count
    if count == 0 and not emptied:
        return
    flow_kernels.new_tails(state, const, slip)
    if emptied:
        flow_kernels.release_tails(state, const, slip)
    dropped = slip_energy_kernels.leave_removed(state, const, slip) if slip.active else 0.0
    recompute(state, const, slip, works)
    now_cells, now_sheared = stored(states, const, slip, low, high)
    now_worked, now_damped = failure_kernels.half_step_work(const, state, low, high)
    state.energy_sums[0, WORK] += now_worked - worked
    state.energy_sums[0, VISCOUS] += now_damped - damped
    state.energy_sums[0, LOST_YARN] += cells - now_cells + now_worked - worked + dropped
    state.energy_sums[0, LOST_TRELLIS] += sheared - now_sheared


@kernel(_nrt=False)
def recompute(state, const, slip, works):
    """Forces of the blocks in which segments have been removed in this step."""
    first, last = state.active_rows[0], state.active_rows[1]
    for block in range(first // const.rows_per_block, (last + const.rows_per_block - 1) // const.rows_per_block):
        if state.block_damage[block] == REDO:
            start, end = max(first, block * const.rows_per_block), min(last, (block + 1) * const.rows_per_block)
            element_forces(state, const, slip, block, start, end, works)
            state.block_damage[block] = DAMAGED


@kernel(_nrt=False)
def post_step(states, const, slip, works):
    """After the element forces, as `panel.step_kernels.post_step`; and the new fluxes."""
    state = states[0]
    remove_segments(states, const, slip, works)
    if slip.active:
        flow_kernels.open_windows(state, const, slip)
    failures = state.counter[FAILURES] + slip.counter[OPENED]
    taken, spring = contact_kernels.contact_forces(state, const, works[0].contact_scratch)
    state.contact_energy[0] += taken
    state.contact_energy[1] = spring
    state.counter[STEP] += 1
    boundary_kernels.update_slip_nodes(state, const, state.counter[STEP] * const.dt)
    if slip.active:
        slip_kernels.slip_nodes(state, const, slip)
    speed = bar_kernels.normal_velocity(state, const)
    if not abs(speed) < 1e9:
        return NOT_FINITE
    if speed <= 0.0:
        return STOPPED
    alone = state.f_contact_nose[2] == 0.0
    idle = failures > 0 and alone and not window_kernels.cloth_ahead_of_nose(state, const)
    state.counter[IDLE] = state.counter[IDLE] + 1 if idle else 0
    return PERFORATED if state.counter[IDLE] >= const.perforation_delay_steps else RUNNING


@entry(nogil=True, _nrt=False)
def run_steps(states, const, slip, works, steps, history, allowed):
    """Make at most `steps` steps; history, allowed and what is returned as `panel.step_kernels.run_thread`.

    states : (State, the same with the effective stretches in the place of the stretches)
    works : see `forces_kernels.element_forces`
    """
    state = states[0]
    begin(state, const, slip, works)
    made, reason, exchanged, before = 0, RUNNING, 0.0, internal_work(state)
    while made < steps and reason == RUNNING:
        pre_step(state, const)
        if slip.active:
            grow_with_slip(state, const, slip)
            flow_kernels.move_yarn(state, const, slip)
        update_blocks(state, const, slip, works)
        reason = post_step(states, const, slip, works)
        record_step(state, const, state.f_contact_nose[2], history[made])
        made += 1
        now = internal_work(state)
        exchanged, before = exchanged + abs(now - before), now
        if reason == RUNNING and not exchanged <= allowed:
            reason = CHECK
    first, last, per = state.active_rows[0], state.active_rows[1], const.rows_per_block
    refresh_tensions(state, const, slip, first // per, (last + per - 1) // per, works)
    return made, reason


@kernel(_nrt=False)
def begin(state, const, slip, works):
    """Forces and slipping edges of the state at rest, before its first step."""
    if state.counter[STEP] == AT_REST:
        initial_forces(state, const, slip, works)
        boundary_kernels.update_slip_nodes(state, const, 0.0)
        state.counter[STEP] = 0


@kernel(_nrt=False)
def initial_forces(state, const, slip, works):
    """Internal and configurational forces of a state, without a step."""
    for block in range((const.ni + const.rows_per_block - 1) // const.rows_per_block):
        first, last = block * const.rows_per_block, min(const.ni, (block + 1) * const.rows_per_block)
        element_forces(state, const, slip, block, first, last, works)


@entry(nogil=True, _nrt=False)
def energies(states, const, slip, out):
    """Energy audit [J] at the present whole step, into out (5,): kinetic, yarns, trellis, kinetic energy of the slip,
    lateral contact.

    Kinetic energy is m v(n-1/2) v(n+1/2) / 2 of each yarn's material, whose velocity is v + t q.
    """
    state, state_x = states
    out[:] = 0.0
    for i in range(const.ni + 1):
        out[0] += energy_kernels.kinetic_energy(const, state, i)
    out[1] = failure_kernels.stored_energy(const, state_x, 0, const.ni)[0]
    out[1] += forces_kernels.gained_energy(state, const, slip, 0, const.ni)
    out[2] = failure_kernels.stored_energy(const, state, 0, const.ni)[1]
    if slip.active:
        out[3] = slip_energy_kernels.kinetic_energy(state, const, slip)
        out[4] = forces_kernels.lateral_energy(state, const, slip)
