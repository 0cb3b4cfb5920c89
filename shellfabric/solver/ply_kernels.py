"""What one ply does in an explicit step: central differences.

Velocities stand at half steps, everything else at whole ones:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1), v(n+1/2)

The nodes are moved by `panel.motion_kernels`, the internal forces of the elements are those of `panel.element_kernels`.
The order of a step is that of `loop.advance`.

Sliding crossovers are an argument, `slide`: None of pinned ones, else (Slip, the State with the effective stretches in
the place of the stretches, the scratch likewise). numba removes the branches on None before it compiles. With an
infinite threshold of slip no flux is computed, and each step is, digit by digit, the pinned one.

The kernels that hand the state on allocate nothing and are compiled without numba's reference counts (_nrt=False): a
pair of them for each array of the state would cost as much as a hundred elements in every block.

LLVM optimises anew, with each kernel that is compiled, all that it calls. The parts of a step that are called from one
place are therefore made part of their caller before anything is compiled (inline="always").
"""

import numpy as np

from shellfabric.cloth import (
    boundary_kernels,
    energy_kernels,
    failure_kernels,
    packing_kernels,
)
from shellfabric.jit.barrier import barrier_wait
from shellfabric.jit.compile import call_module, entry, kernel
from shellfabric.panel import element_kernels
from shellfabric.panel.element_kernels import DAMAGED, LOST_TRELLIS, LOST_YARN, REDO, VISCOUS, WORK
from shellfabric.panel.motion_kernels import (
    AT_REST,
    FAILURES,
    STEP,
    grow_active_rows,
    move_rows,
    thread_range,
)
from shellfabric.projectile import contact_kernels
from shellfabric.sliding import flow_kernels, forces_kernels, slip_energy_kernels
from shellfabric.sliding.flow_kernels import EMPTIED
from shellfabric.state import unit

KINETIC, STORED, SHEAR, BENDING, PACKING = range(5)  # of `energies`; then other modules


@kernel(_nrt=False, inline="always")
def element_forces(state, const, slide, block, first, last, work):
    """Internal forces of the element rows first .. last - 1 of a block, and those on the slip."""
    if slide is None:
        element_kernels.element_forces(state, const, block, first, last, work)
    else:
        slip, _, work_x = slide
        forces_kernels.element_forces(state, const, slip, block, first, last, (work, work_x))


@kernel(_nrt=False, inline="always")
def refresh_tensions(state, const, slide, first, last, work):
    """Update the stale tensions of the blocks first .. last - 1."""
    if slide is None:
        element_kernels.refresh_tensions(state, const, first, last, work)
    else:
        slip, _, work_x = slide
        forces_kernels.refresh_tensions(state, const, slip, first, last, (work, work_x))


@kernel(_nrt=False, inline="always")
def grow_rows(state, const, slide):
    """Grow the window of active element rows ahead of the motion and of the slip; move the yarn by its fluxes."""
    grow_active_rows(state, const)
    if slide is not None:
        slip, _, _ = slide
        if slip.active:
            grow_with_slip(state, const, slip)
            flow_kernels.move_yarn(state, const, slip)


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
def module_force(state, const, m, first, last, acting):
    """Energy [J] that force module m stores at the node rows first .. last; adds its forces if `acting`."""
    table = state.modules
    if table.cell[m] == 0:
        return 0.0
    return call_module(table.cell[m], table.own[m], state, const, first, last, acting)


@kernel(_nrt=False)
def other_forces(state, const, first, last, acting):
    """Energy [J] that the force modules store at the node rows first .. last; adds their forces if `acting`."""
    total = 0.0
    for m in range(state.modules.cell.size):
        total += module_force(state, const, m, first, last, acting)
    return total


@kernel(_nrt=False)
def stored_energy(state, const, slide, low, high):
    """[J] (of yarns, of all else) that the element rows low .. high - 1 store."""
    if slide is None:
        yarns, sheared = failure_kernels.stored_energy(const, state, low, high)
        return yarns, sheared + other_forces(state, const, low, high, False)
    slip, state_x, _ = slide
    yarns = failure_kernels.stored_energy(const, state_x, low, high)[0]
    yarns += forces_kernels.gained_energy(state, const, slip, low, high)
    sheared = failure_kernels.stored_energy(const, state, low, high)[1]
    sheared += other_forces(state, const, low, high, False)
    return yarns, sheared + forces_kernels.lateral_energy(state, const, slip)


@kernel(_nrt=False)
def is_emptied(slide):
    """Whether the end of a sliding yarn has left a segment in this step."""
    if slide is None:
        return False
    slip, _, _ = slide
    return slip.counter[EMPTIED] != 0


@kernel(_nrt=False)
def leave_segments(state, const, slide):
    """Take the slip out of removed segments; [J] that its kinetic energy loses."""
    if slide is None:
        return 0.0
    slip, _, _ = slide
    flow_kernels.new_tails(state, const, slip)
    if slip.counter[EMPTIED] != 0:
        flow_kernels.release_tails(state, const, slip)
    return slip_energy_kernels.leave_removed(state, const, slip) if slip.active else 0.0


@kernel(_nrt=False, inline="always")
def find_failures(state, const, slide, work):
    """Edges that break in this step: how many, and the element rows (low, high) that hold them."""
    first, last, per = state.active_rows[0], state.active_rows[1], const.rows_per_block
    count, low, high = 0, const.ni, 0
    for block in range(first // per, (last + per - 1) // per):
        if not failure_kernels.may_fail(const, state, block):
            continue
        begin, end = max(first, block * per), min(last, (block + 1) * per)
        near, far = max(first, begin - const.mean_reach), min(last, end + const.mean_reach)
        refresh_tensions(state, const, slide, near // per, (far + per - 1) // per, work)
        rows = end + 1 if end == const.ni else end  # of weft edges
        failing = failure_kernels.find_failures(const, state, 0, begin, end)
        failing += failure_kernels.find_failures(const, state, 1, begin, rows)
        state.warm_blocks[block] = False
        for i in range(begin, rows):
            state.warm_blocks[block] |= state.warm_rows[0, i] or state.warm_rows[1, i]
        if failing > 0:
            low, high, count = min(low, begin), end, count + failing
    return count, low, high


@kernel(_nrt=False, inline="always")
def apply_failure(state, const, slide, work):
    """Failure criterion, and segments that a yarn's end has left: remove them, and compute the forces of their blocks
    again."""
    count, low, high = find_failures(state, const, slide, work)
    emptied, per = is_emptied(slide), const.rows_per_block
    if count == 0 and not emptied:
        return
    # a failure changes what its neighbours store, two rows away at most
    low, high = max(low - 3, 0), min(high + 3, const.ni)
    if emptied:
        low, high = 0, const.ni
    stored, sheared = stored_energy(state, const, slide, low, high)
    worked, damped = failure_kernels.half_step_work(const, state, low, high)
    failure_kernels.break_edges(const, state, 0, low, high)
    failure_kernels.break_edges(const, state, 1, low, high)
    state.counter[FAILURES] += count
    dropped = leave_segments(state, const, slide)
    first, last = state.active_rows[0], state.active_rows[1]
    for block in range(first // per, (last + per - 1) // per):
        if state.block_damage[block] == REDO:
            start, end = max(first, block * per), min(last, (block + 1) * per)
            element_forces(state, const, slide, block, start, end, work)
            state.block_damage[block] = DAMAGED
    now_stored, now_sheared = stored_energy(state, const, slide, low, high)
    now_worked, now_damped = failure_kernels.half_step_work(const, state, low, high)
    state.energy_sums[0, WORK] += now_worked - worked
    state.energy_sums[0, VISCOUS] += now_damped - damped
    state.energy_sums[0, LOST_YARN] += stored - now_stored + now_worked - worked + dropped
    state.energy_sums[0, LOST_TRELLIS] += sheared - now_sheared


@kernel(_nrt=False, inline="always")
def update_blocks(state, const, slide, work, shared, me, count):
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
        begin, stop = (
            max(low, block * const.rows_per_block),
            min(high, (block + 1) * const.rows_per_block),
        )
        ahead = max(done, min(stop + 2, tail))
        move_rows(state, const, done, ahead)
        done = ahead
        element_forces(state, const, slide, block, begin, stop, work)


@unit(later=True)
def apply_backing_impulse(state, const):
    """v += dt f / m of nodes, with the forces of the backing block, state.f_block_cloth."""
    for c in range(3):
        for k in range(
            np.uint64(state.active_rows[0] * const.row_stride),
            np.uint64((state.active_rows[1] + 1) * const.row_stride),
        ):
            state.v[c][k] += state.dt_over_mass[k] * state.f_block_cloth[c][k]


@kernel(_nrt=False)
def nose_contact(state, const, work):
    """The nose's forces on a ply."""
    taken, spring = contact_kernels.contact_forces(state, const, work.contact_scratch)
    state.contact_energy[0] += taken
    state.contact_energy[1] = spring


@kernel(_nrt=False, inline="always")
def break_yarns(state, const, slide, work):
    """The failure criterion. Segments that a yarn's end has left, elements in which a window between yarns has opened,
    and torn ones that are drawn out, count as failures."""
    apply_failure(state, const, slide, work)
    if slide is not None:
        slip, _, _ = slide
        if slip.active:
            flow_kernels.open_windows(state, const, slip)
    if state.counter[FAILURES] > 0:
        state.energy_sums[0, LOST_TRELLIS] += packing_kernels.let_go(state, const)


@kernel(_nrt=False, inline="always")
def touch(state, const, work):
    """The nose's forces, but where they are to be computed after those of the other plies, which implicit springs
    depend on (see `projectile.contact_kernels`): as long as the nose pushes. Returns whether they are."""
    waits = const.point_law.implicit_factor > 0.0 and state.f_contact_nose[2] != 0.0
    if not waits:
        nose_contact(state, const, work)
    return waits


@kernel(_nrt=False, inline="always")
def move_edges(state, const):
    """Count the step; move the nodes that slip in a clamp or are pulled."""
    state.counter[STEP] += 1
    if const.slip_node.size > 0:
        boundary_kernels.update_slip_nodes(state, const, state.counter[STEP] * const.dt)


@kernel(_nrt=False)
def internal_work(state):
    """[J] work done so far on yarns, their viscosity and the contact with the nose."""
    total = state.contact_energy[contact_kernels.CONTACT]
    for block in range(state.energy_sums.shape[0]):
        total += state.energy_sums[block, WORK] + state.energy_sums[block, VISCOUS]
    return total


@kernel(_nrt=False)
def begin(state, const, slide, work):
    """Forces and slipping edges of the state at rest, before its first step."""
    if state.counter[STEP] == AT_REST:
        initial_forces(state, const, slide, work)
        if const.slip_node.size > 0:
            boundary_kernels.update_slip_nodes(state, const, 0.0)
        state.counter[STEP] = 0


@kernel(_nrt=False)
def initial_forces(state, const, slide, work):
    """Internal forces of a state, without a step."""
    per = const.rows_per_block
    for block in range((const.ni + per - 1) // per):
        element_forces(
            state, const, slide, block, block * per, min(const.ni, (block + 1) * per), work
        )
    other_forces(state, const, 0, const.ni, True)


@entry(nogil=True)
def energies(state, const, slide, out):
    """Energy audit [J] at the present whole step, into out (3 + modules,): kinetic, yarns, trellis, of the modules
    (bending, packing, ...); of sliding crossovers packing has that of lateral contact too, kinetic that of the slip.

    Kinetic energy is m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
    """
    out[:] = 0.0
    for m in range(state.modules.cell.size):
        out[BENDING + m] = module_force(state, const, m, 0, const.ni, False)
    for i in range(const.ni + 1):
        out[KINETIC] += energy_kernels.kinetic_energy(const, state, i)
    if slide is None:
        out[STORED], out[SHEAR] = failure_kernels.stored_energy(const, state, 0, const.ni)
    else:
        slip, state_x = slide
        out[STORED] = failure_kernels.stored_energy(const, state_x, 0, const.ni)[0]
        out[STORED] += forces_kernels.gained_energy(state, const, slip, 0, const.ni)
        out[SHEAR] = failure_kernels.stored_energy(const, state, 0, const.ni)[1]
        if slip.active:
            out[KINETIC] += slip_energy_kernels.kinetic_energy(state, const, slip)
            out[PACKING] += forces_kernels.lateral_energy(state, const, slip)
