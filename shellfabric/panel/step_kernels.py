"""Explicit time steps of the panel and its projectile: central differences.

Velocities stand at half steps, everything else at whole ones:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1), v(n+1/2)

The nodes are moved by `motion_kernels`, the internal forces of the elements are those of `element_kernels`.

The kernels that hand the state on allocate nothing and are compiled without numba's reference counts (_nrt=False): a
pair of them for each array of the state would cost as much as a hundred elements in every block.

LLVM optimises anew, with each kernel that is compiled, all that it calls. The parts of a step that are called from one
place are therefore made part of their caller before anything is compiled (inline="always").
"""

import numpy as np

from shellfabric.cloth import bending_kernels, boundary_kernels, energy_kernels, failure_kernels, jamming_kernels
from shellfabric.jit.barrier import STOP, barrier_wait
from shellfabric.jit.compile import entry, kernel
from shellfabric.panel.element_kernels import (
    DAMAGED,
    LOST_TRELLIS,
    LOST_YARN,
    REDO,
    VISCOUS,
    WORK,
    element_forces,
    refresh_tensions,
)
from shellfabric.panel.motion_kernels import grow_active_rows, move_rows, thread_range
from shellfabric.projectile import bar_kernels, contact_kernels, window_kernels

RUNNING, STOPPED, PERFORATED, NOT_FINITE, CHECK = 0, 1, 2, 3, 4  # CHECK: energy is to be audited before the next step
KINETIC, STORED, SHEAR, BENDING, JAMMING = 0, 1, 2, 3, 4  # of `energies`
STEP, IDLE, FAILURES = 0, 1, 2
AT_REST = -1  # of counter[STEP], until the initial forces are computed


@kernel(_nrt=False)
def rows_near_failure(state, const):
    """(first, last) element rows that may hold a new peak or a failure: conservative, from block maxima.

    The mean over a yarn is no higher than the highest of its edges, which are as many rows as a crossover has elements.
    A filtered tension follows the tension at any height: all active rows.
    """
    first, last = state.active_rows[0], state.active_rows[1]
    if const.filter_alpha > 0.0:
        return first, last
    bound1, bound2 = min(state.peak_tension[0], const.min_strength1), min(state.peak_tension[1], const.min_strength2)
    low, high = last, first
    for block in range(first // const.rows_per_block, (last + const.rows_per_block - 1) // const.rows_per_block):
        if state.block_max_tension[block, 0] > bound1 or state.block_max_tension[block, 1] > bound2:
            low = min(low, max(first, block * const.rows_per_block - const.n_per_crossover + 1))
            high = max(high, min(last, (block + 1) * const.rows_per_block + const.n_per_crossover - 1))
    return low, high


@kernel(_nrt=False, inline="always")
def out_of_plane_forces(state, const, first, last, acting):
    """Bending and jamming energy [J] of the node rows first .. last; adds their forces to state.f_int if `acting`."""
    turns = bending_kernels.bending_forces(const.bending, state, const, first, last, acting)
    return turns + jamming_kernels.jamming_forces(const.jamming, state, const, first, last, acting)


@kernel(_nrt=False, inline="always")
def apply_failure(state, const, work):
    """Failure criterion: remove failed yarns, and compute the forces of their blocks again."""
    first, last = rows_near_failure(state, const)
    if first >= last:
        return
    start, end = (
        max(state.active_rows[0], first - const.n_per_crossover + 1),
        min(state.active_rows[1], last + const.n_per_crossover - 1),
    )
    refresh_tensions(
        state, const, start // const.rows_per_block, (end + const.rows_per_block - 1) // const.rows_per_block, work
    )
    most1, most2 = 0.0, 0.0
    for block in range(first // const.rows_per_block, (last + const.rows_per_block - 1) // const.rows_per_block):
        most1, most2 = max(most1, state.block_max_tension[block, 0]), max(most2, state.block_max_tension[block, 1])
    # detecting failures breaks yarns: the energies before are computed first where there may be one
    near = (
        const.filter_alpha > 0.0
        or (most1 > const.min_strength1 and failure_kernels.any_past_strength(const, state, 0, first, last))
        or (most2 > const.min_strength2 and failure_kernels.any_past_strength(const, state, 1, first, last))
    )
    stored, sheared, worked, damped = 0.0, 0.0, 0.0, 0.0
    # a failure changes what its neighbours store, two rows away at most
    low, high = max(first - const.n_per_crossover - 3, 0), min(last + const.n_per_crossover + 3, const.ni)
    if near:
        stored, sheared = failure_kernels.stored_energy(const, state, low, high)
        sheared += out_of_plane_forces(state, const, low, high, False)
        worked, damped = failure_kernels.half_step_work(const, state, low, high)
    count = failure_kernels.detect_failures(const, state, 0, first, last)
    count += failure_kernels.detect_failures(const, state, 1, first, last)
    if count == 0:
        return
    state.counter[FAILURES] += count
    first, last = state.active_rows[0], state.active_rows[1]
    for block in range(first // const.rows_per_block, (last + const.rows_per_block - 1) // const.rows_per_block):
        if state.block_damage[block] == REDO:
            start, end = max(first, block * const.rows_per_block), min(last, (block + 1) * const.rows_per_block)
            element_forces(state, const, block, start, end, work)
            state.block_damage[block] = DAMAGED
    now_stored, now_sheared = failure_kernels.stored_energy(const, state, low, high)
    now_sheared += out_of_plane_forces(state, const, low, high, False)
    now_worked, now_damped = failure_kernels.half_step_work(const, state, low, high)
    state.energy_sums[0, WORK] += now_worked - worked
    state.energy_sums[0, VISCOUS] += now_damped - damped
    state.energy_sums[0, LOST_YARN] += stored - now_stored + now_worked - worked
    state.energy_sums[0, LOST_TRELLIS] += sheared - now_sheared


@kernel(_nrt=False, inline="always")
def update_blocks(state, const, work, shared, me, count):
    """Update the active nodes and compute the active element forces, block by block while they are in cache.

    The blocks are fixed, whatever the window and the number of threads, and so is what is found in them. The node rows
    that the elements of a block need are moved first: its own, and one beyond. Those at the ends of a thread's blocks,
    which its neighbours need too, are moved before all.
    """
    first, last = thread_range(state, const, me, count)
    low, high = (
        max(state.active_rows[0], first * const.rows_per_block),
        min(state.active_rows[1], last * const.rows_per_block),
    )
    end = high + 1 if me == count - 1 else high  # the node rows are low .. end - 1
    done = min(low + 2, end)
    tail = max(end - 2, done)
    if first < last:
        move_rows(state, const, low, done)
        move_rows(state, const, tail, end)
    barrier_wait(shared, count)
    for block in range(first, last):
        begin, stop = max(low, block * const.rows_per_block), min(high, (block + 1) * const.rows_per_block)
        ahead = max(done, min(stop + 2, tail))
        move_rows(state, const, done, ahead)
        done = ahead
        element_forces(state, const, block, begin, stop, work)


@kernel(_nrt=False)
def apply_backing_impulse(state, const):
    """v += dt f / m of nodes and projectile, with the forces of the backing block (state.f_block_cloth,
    state.f_block_nose)."""
    for c in range(3):
        for k in range(
            np.uint64(state.active_rows[0] * const.row_stride), np.uint64((state.active_rows[1] + 1) * const.row_stride)
        ):
            state.v[c][k] += state.dt_over_mass[k] * state.f_block_cloth[c][k]
        state.projectile_velocity[c] += const.dt * const.free_dofs[c] * state.f_block_nose[c] / const.projectile_mass


@kernel(_nrt=False, inline="always")
def pre_step(state, const):
    """Before the nodes move: contact impulses, motion of the projectile, active rows."""
    contact_kernels.apply_contact_impulse(state, const)
    if const.has_backing:
        apply_backing_impulse(state, const)
    if const.bar_mass.size > 0:
        bar_kernels.advance_bar(state, const, bar_kernels.axial_force(state, const))
    for c in range(3):
        state.projectile_position[c] += const.dt * state.projectile_velocity[c]
    grow_active_rows(state, const)


@kernel(_nrt=False, inline="always")
def post_step(state, const, work):
    """After the element forces: failure, bending, contact, boundary; returns RUNNING or the reason to end."""
    apply_failure(state, const, work)
    out_of_plane_forces(state, const, state.active_rows[0], state.active_rows[1], True)
    failures = state.counter[FAILURES]
    taken, spring = contact_kernels.contact_forces(state, const, work.contact_scratch)
    state.contact_energy[0] += taken
    state.contact_energy[1] = spring
    state.counter[STEP] += 1
    boundary_kernels.update_slip_nodes(state, const, state.counter[STEP] * const.dt)
    speed = bar_kernels.normal_velocity(state, const)
    if not abs(speed) < 1e9:
        return NOT_FINITE
    if speed <= 0.0:
        return STOPPED
    # perforated: yarns have failed, nothing pushes, and nothing that is held is left in front, for a while
    alone = state.f_contact_nose[2] == 0.0 and state.f_block_nose[2] == 0.0
    idle = failures > 0 and alone and not window_kernels.cloth_ahead_of_nose(state, const)
    state.counter[IDLE] = state.counter[IDLE] + 1 if idle else 0
    return PERFORATED if state.counter[IDLE] >= const.perforation_delay_steps else RUNNING


@kernel(inline="always")
def record_step(state, const, force, row):
    """One row of the history: foremost z, v_z and the force [N] along z; of a bar also the velocities of tip, tail and
    centre of mass, and how far they have come, all along its axis."""
    row[0], row[1] = state.projectile_position[2] + const.foremost_offset, bar_kernels.normal_velocity(state, const)
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
def internal_work(state):
    """[J] work done so far on yarns, their viscosity and the contact with the nose."""
    total = state.contact_energy[contact_kernels.CONTACT]
    for block in range(state.energy_sums.shape[0]):
        total += state.energy_sums[block, WORK] + state.energy_sums[block, VISCOUS]
    return total


@entry(nogil=True, _nrt=False)
def run_thread(state, const, work, steps, history, shared, me, count, allowed):
    """Thread `me` of `count`, each with scratch of its own: at most `steps` steps, as thread 0 has them.

    The initial forces are computed before the first step, also where `steps` is 0.

    history (steps, 3): the projectile's foremost z, v_z of its centre of mass and the force on it after each; of a bar
    (steps, 9), see `record_step`. shared : see `barrier.barrier_wait`. allowed [J] : energy exchange, the sum over
    steps of the change of `internal_work`, after which CHECK ends the call: no energy error can exceed the energy
    exchanged. Returns (steps made, RUNNING or the reason to end) of thread 0.
    """
    if me == 0:
        begin(state, const, work)
    made, reason, exchanged, before = 0, RUNNING, 0.0, internal_work(state)
    while True:
        if me == 0:
            shared[STOP] = 0 if made < steps and reason == RUNNING else 1
            if shared[STOP] == 0:
                pre_step(state, const)
        barrier_wait(shared, count)
        if shared[STOP] != 0:
            break
        update_blocks(state, const, work, shared, me, count)
        barrier_wait(shared, count)
        if me == 0:
            reason = post_step(state, const, work)
            record_step(state, const, state.f_contact_nose[2] + state.f_block_nose[2], history[made])
            made += 1
            now = internal_work(state)
            exchanged, before = exchanged + abs(now - before), now
            if reason == RUNNING and not exchanged <= allowed:
                reason = CHECK
    first, last = thread_range(state, const, me, count)
    refresh_tensions(state, const, first, last, work)
    barrier_wait(shared, count)
    return made, reason


def run_steps(state, const, work, steps, history):
    """`run_thread` of one thread, without a check of the energy."""
    return run_thread(state, const, work, steps, history, work.barrier, 0, 1, np.inf)


@kernel(_nrt=False)
def begin(state, const, work):
    """Forces and slipping edges of the state at rest, before its first step."""
    if state.counter[STEP] == AT_REST:
        initial_forces(state, const, work)
        boundary_kernels.update_slip_nodes(state, const, 0.0)
        state.counter[STEP] = 0


@kernel(_nrt=False)
def initial_forces(state, const, work):
    """Internal forces of a state, without a step."""
    for block in range((const.ni + const.rows_per_block - 1) // const.rows_per_block):
        element_forces(
            state, const, block, block * const.rows_per_block, min(const.ni, (block + 1) * const.rows_per_block), work
        )
    out_of_plane_forces(state, const, 0, const.ni, True)


@entry(nogil=True)
def energies(state, const, out):
    """Energy audit [J] at the present whole step, into out (5,): kinetic, yarns, trellis, bending, jamming.

    Kinetic energy is m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
    """
    out[:] = 0.0
    for i in range(const.ni + 1):
        out[KINETIC] += energy_kernels.kinetic_energy(const, state, i)
    out[STORED], out[SHEAR] = failure_kernels.stored_energy(const, state, 0, const.ni)
    out[BENDING] = bending_kernels.bending_forces(const.bending, state, const, 0, const.ni, False)
    out[JAMMING] = jamming_kernels.jamming_forces(const.jamming, state, const, 0, const.ni, False)
