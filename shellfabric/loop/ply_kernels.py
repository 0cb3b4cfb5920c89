"""What one ply does in an explicit step: central differences, velocities at half steps, everything else at
whole ones (docs/theory-panel.md, "Time integration and time step"). The order of a step is that of
`loop.advance`.

The kernels that hand the state on allocate nothing and are compiled without numba's reference counts
(_nrt=False): a pair of them for each array would cost as much as a hundred elements in every block.
LLVM optimises anew, with each kernel, all that it calls: parts that are called from one place are made
part of their caller before anything is compiled (inline="always").
"""

from shellfabric.jit.compile import call_forces, call_phase, entry, kernel
from shellfabric.membrane import (
    boundary_kernels,
    element_kernels,
    energy_kernels,
    failure_kernels,
    packing_kernels,
)
from shellfabric.membrane.motion_kernels import AT_REST, active_blocks, move_rows
from shellfabric.projectile import contact_kernels, window_kernels
from shellfabric.state import DAMAGED, REDO, unit
from shellfabric.surface.grid_kernels import place
from shellfabric.surface.nodal_force_kernels import give_impulses

KINETIC, STORED, SHEAR, PARTS = range(4)  # of `energies`; those of the parts are the last


@kernel(_nrt=False)
def part_forces(state, const, m, first, last, acting):
    """Compute the energy [J] that part m stores at the node rows first .. last; add its forces if
    `acting`."""
    parts = state.parts
    if parts.forces[m] == 0:
        return 0.0
    return call_forces(parts.forces[m], parts.own[m], state, const, first, last, acting)


@kernel(_nrt=False)
def other_forces(state, const, first, last, acting):
    """Compute the energy [J] that the parts store at the node rows first .. last; add their forces
    if `acting`."""
    total = 0.0
    for m in range(state.parts.forces.size):
        total += part_forces(state, const, m, first, last, acting)
    return total


@kernel(_nrt=False)
def stored_energy(state, const, low, high):
    """Compute the energy [J] (of yarns, of all else) that the element rows low .. high - 1
    store."""
    yarns, sheared = energy_kernels.stored_energy(const, state, low, high)
    return yarns, sheared + other_forces(state, const, low, high, False)


@kernel(_nrt=False, inline="always")
def find_failures(state, const, work):
    """Find the edges that break in this step: how many, and the element rows (low, high) that hold
    them."""
    first = state.first_row
    last = state.end_row
    per = const.rows_per_block
    count = 0
    low = const.ni
    high = 0
    for block in range(*active_blocks(state, const)):
        if not failure_kernels.may_fail(const, state, block):
            continue
        begin = max(first, block * per)
        end = min(last, (block + 1) * per)
        near = max(first, begin - const.mean_reach)
        far = min(last, end + const.mean_reach)
        element_kernels.refresh_tensions(state, const, near // per, (far + per - 1) // per, work)
        # of weft edges
        rows = end
        if end == const.ni:
            rows = end + 1
        failing = failure_kernels.find_failures(const, state, 0, begin, end)
        failing += failure_kernels.find_failures(const, state, 1, begin, rows)
        state.warm_blocks[block] = False
        for i in range(begin, rows):
            state.warm_blocks[block] |= state.warm_rows[0, i] or state.warm_rows[1, i]
        if failing > 0:
            low = min(low, begin)
            high = end
            count = count + failing
    return count, low, high


@kernel(_nrt=False, inline="always")
def apply_failure(state, const, work):
    """Apply the failure criterion: remove edges that fail, and compute the forces of their blocks
    again."""
    count, low, high = find_failures(state, const, work)
    if count == 0:
        return
    per = const.rows_per_block
    # a failure changes what its neighbours store, two rows away at most
    low = max(low - 3, 0)
    high = min(high + 3, const.ni)
    stored, sheared = stored_energy(state, const, low, high)
    worked, damped = failure_kernels.half_step_work(const, state, low, high)
    failure_kernels.break_edges(const, state, 0, low, high)
    failure_kernels.break_edges(const, state, 1, low, high)
    state.failures += count
    first = state.first_row
    last = state.end_row
    for block in range(*active_blocks(state, const)):
        if state.block_damage[block] == REDO:
            start = max(first, block * per)
            end = min(last, (block + 1) * per)
            element_kernels.element_forces(state, const, block, start, end, work)
            state.block_damage[block] = DAMAGED
    now_stored, now_sheared = stored_energy(state, const, low, high)
    now_worked, now_damped = failure_kernels.half_step_work(const, state, low, high)
    state.edge_work[0] += now_worked - worked
    state.viscous_work[0] += now_damped - damped
    state.lost_with_yarns += stored - now_stored + now_worked - worked
    state.lost_with_elements += sheared - now_sheared


@kernel(_nrt=False, inline="always")
def update_blocks(state, const, work):
    """Move the active nodes and compute the active element forces, block by block while they are
    in cache.

    The blocks are fixed, whatever the window, and so is what is found in them. The node rows that the
    elements of a block need are moved first: its own, and two beyond.
    """
    per = const.rows_per_block
    first_row = state.first_row
    end_row = state.end_row
    moved = first_row
    for block in range(*active_blocks(state, const)):
        begin = max(first_row, block * per)
        end = min(end_row, (block + 1) * per)
        needed = min(end + 2, end_row + 1)
        move_rows(state, const, moved, needed)
        moved = needed
        element_kernels.element_forces(state, const, block, begin, end, work)


@unit(later=True)
def apply_backing_impulse(state, const):
    """Give the nodes the impulses of the backing block."""
    window = (state.first_row, state.end_row + 1, 0, const.row_stride)
    give_impulses(state, const, state.f_block_cloth, window)


@kernel(_nrt=False)
def nose_contact(state, const, work):
    """Compute the nose's forces on a ply."""
    taken, spring = contact_kernels.contact_forces(state, const, work.contact_scratch)
    state.contact_work += taken
    state.contact_spring_energy = spring


@kernel(_nrt=False, inline="always")
def break_yarns(state, const, work):
    """Apply the failure criterion. Torn elements that are drawn out count as failures."""
    apply_failure(state, const, work)
    if state.failures > 0:
        state.lost_with_elements += packing_kernels.let_go(state, const)


@kernel(_nrt=False, inline="always")
def place_surface(state, const, all_rows):
    """Bring the surface up to date for what touches it: all rows that move, or those that the nose
    can push."""
    if const.window_follows:
        window_kernels.move_window(state, const)
    if all_rows:
        place(state, const, state.first_row, state.end_row)
    else:
        window_kernels.place_near_nose(state, const)


@kernel(_nrt=False, inline="always")
def touch(state, const, work):
    """Compute the nose's forces on the membrane, unless they are to be computed after those of the
    other plies, which implicit springs depend on (see `projectile.contact_kernels`): as long as the
    nose pushes. Returns whether they are."""
    waits = const.point_law.implicit > 0.0 and state.f_contact_nose[2] != 0.0
    if not waits:
        nose_contact(state, const, work)
    return waits


@kernel(_nrt=False)
def meet_nose(state, const):
    """Compute the nose's forces on the part that stands in for the membrane."""
    parts = state.parts
    for m in range(parts.nose.size):
        if parts.nose[m] != 0:
            call_phase(parts.nose[m], parts.own[m], state, const)


@kernel(_nrt=False)
def finish_parts(state, const):
    """Call the parts of a ply that act when all have moved."""
    parts = state.parts
    for m in range(parts.after.size):
        if parts.after[m] != 0:
            call_phase(parts.after[m], parts.own[m], state, const)


@kernel(_nrt=False)
def internal_work(state):
    """Sum the work [J] done so far on yarns, their viscosity and the contact with the nose."""
    total = state.contact_work + state.yarn_work
    for block in range(state.edge_work.size):
        total += state.edge_work[block] + state.viscous_work[block]
    return total


@kernel(_nrt=False)
def begin(state, const, work):
    """Compute forces and slipping edges of the state at rest, before its first step."""
    if state.steps == AT_REST:
        initial_forces(state, const, work)
        if const.slip_node.size > 0:
            boundary_kernels.update_slip_nodes(state, const, 0.0)
        state.steps = 0


@kernel(_nrt=False)
def initial_forces(state, const, work):
    """Compute the internal forces of a state, without a step."""
    per = const.rows_per_block
    for block in range((const.ni + per - 1) // per):
        last = min(const.ni, (block + 1) * per)
        element_kernels.element_forces(state, const, block, block * per, last, work)
    other_forces(state, const, 0, const.ni, True)


@entry(nogil=True)
def energies(state, const, out):
    """Audit the energy [J] at the present whole step, into out (3 + parts,): kinetic, yarns,
    trellis, of the parts (bending, packing, ...).

    Kinetic energy is m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a
    linear system.
    """
    out[:] = 0.0
    for m in range(state.parts.forces.size):
        out[PARTS + m] = part_forces(state, const, m, 0, const.ni, False)
    for i in range(const.ni + 1):
        out[KINETIC] += energy_kernels.kinetic_energy(const, state, i)
    out[STORED], out[SHEAR] = energy_kernels.stored_energy(const, state, 0, const.ni)
