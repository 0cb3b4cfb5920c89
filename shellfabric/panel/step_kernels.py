"""Explicit time steps of the panel and its projectile: central differences.

Velocities stand at half steps, everything else at whole ones:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1), v(n+1/2)

Only rows that motion can have reached are worked on, which is exact: an element whose nodes are all at rest has no
force on them. Velocities below 1e-60 m/s are set to zero, without which the
front of the wave would be preceded by denormal numbers.

The kernels that hand the state on allocate nothing and are compiled without numba's reference counts (_nrt=False): a
pair of them for each array of the state would cost as much as a hundred elements in every block.
"""

import numpy as np

from shellfabric.cloth import (
    bending_kernels,
    boundary_kernels,
    energy_kernels,
    failure_kernels,
    jamming_kernels,
    membrane_kernels,
)
from shellfabric.jit.barrier import STOP, barrier_wait
from shellfabric.jit.compile import entry, kernel
from shellfabric.jit.simd import WIDTH, fabs, fma, greater, load, masked_store, where
from shellfabric.projectile import bar_kernels, contact_kernels

RUNNING, STOPPED, PERFORATED, NOT_FINITE, CHECK = 0, 1, 2, 3, 4  # CHECK: energy is to be audited before the next step
# of state.energy_sums; what is lost with failed yarns, and with trellis and turns; what yarns do not store of the work
WORK, VISCOUS, LOST_YARN, LOST_TRELLIS, QUADRATURE = 0, 1, 2, 3, 4
KINETIC, STORED, SHEAR, BENDING, JAMMING = 0, 1, 2, 3, 4  # of `energies`
INTACT, DAMAGED, REDO = 0, 1, 2  # of state.block_damage: a block without failures, with some, with some of this step
STEP, IDLE, FAILURES = 0, 1, 2
_MIN_VELOCITY = 1e-60


@kernel()
def move_nodes(k0, n, dt, dt_over_mass, f_int, f_int_above, both, v, u):
    """Central-difference update of the nodes k0 .. k0 + n: forces f_int [N], or `both` f_int + f_int_above."""
    for j in range(0, n, WIDTH):
        k, left = k0 + j, n - j
        impulse = load(dt_over_mass, k)
        for c in range(3):
            force = load(f_int[c], k)
            if both:
                force = force + load(f_int_above[c], k)
            speed = fma(impulse, force, load(v[c], k))
            speed = where(greater(fabs(speed), _MIN_VELOCITY), speed, 0.0)
            masked_store(v[c], k, speed, left)
            masked_store(u[c], k, fma(speed, dt, load(u[c], k)), left)


@kernel(_nrt=False, forceinline=True)
def apply_symmetry(state, const, first, last):
    """Zero the force across planes of symmetry, on the node rows first .. last - 1."""
    if const.mirror_x and first == 0:
        for k in range(const.row_stride):
            state.f_int[0][k] = state.f_int_above[0][k] = 0.0
    if const.mirror_y:
        for i in range(first, last):
            k = np.uint64(i * const.row_stride)
            state.f_int[1][k] = state.f_int_above[1][k] = 0.0


@kernel(_nrt=False)
def row_has_moved(state, const, i):
    """Whether a node of row i has a displacement."""
    for k in range(np.uint64(i * const.row_stride), np.uint64((i + 1) * const.row_stride)):
        if state.u[0][k] != 0.0 or state.u[1][k] != 0.0 or state.u[2][k] != 0.0:
            return True
    return False


@kernel(_nrt=False, forceinline=True)
def grow_active_rows(state, const):
    """Grow the window of active element rows, state.active_rows, ahead of the motion.

    The forces of a node reach two rows further than the nodes that have moved: over the segments that cross, and in the
    variational form over those that cross these. So in a step motion goes ahead by two rows at most, and its forces by
    two more, and there is a window in time if its outer four rows are kept at rest.
    """
    for _ in range(2):
        first, last = state.active_rows[0], state.active_rows[1]
        stirred = False
        for i in range(first, min(first + 4, const.ni + 1)):
            stirred = stirred or row_has_moved(state, const, i)
        if first > 0 and stirred:
            state.active_rows[0] -= 1
        stirred = False
        for i in range(max(last - 3, 0), last + 1):
            stirred = stirred or row_has_moved(state, const, i)
        if last < const.ni and stirred:
            state.active_rows[1] += 1


@kernel(_nrt=False)
def element_forces(state, const, block, first, last, work):
    """Internal forces of the element rows first .. last - 1 of one block, from the present displacements."""
    s, thin = const.row_stride, state.block_damage[block] != INTACT
    k0, n = first * s, (last - first) * s
    n2 = n + s if last == const.ni else n  # weft edges: those on the far side of the panel have no row of their own
    edge_stretches(state, const, first, last, thin, work)
    trellis_forces(state, const, first, last, thin, work)
    N1, N2 = work.T1, work.T2
    if const.variational:
        N1, N2 = work.N1, work.N2
        slack = potential_gradient(state, const, block, first, last, thin, work)
    if not (const.variational and slack):
        interpolate_tensions(state, const, block, first, last, thin, work)
    yarn_forces(state, const, block, k0, n, n2, N1, N2, work)
    scatter_forces(state, const, block, first, last, work)


@kernel(_nrt=False, forceinline=True)
def scatter_forces(state, const, block, first, last, work):
    """Scatter the element forces of a block to its nodes, and to the first row of nodes of the next block.

    A row of nodes in whose middle of a block the window begins or ends is at rest: it keeps the forces that it has.
    """
    s, k0, m0, n, w = (
        const.row_stride, first * const.row_stride, 2 * const.row_stride, (last - first) * const.row_stride, work,
    )  # fmt: skip
    f_int, kept, within = state.f_int, work.inv_stretch1, first > block * const.rows_per_block
    if within:
        for c in range(3):
            for j in range(s):
                kept[c * s + j] = f_int[c][k0 + j]
    membrane_kernels.scatter_forces(
        k0, m0, n, s, const.inv_dx, const.inv_dy, w.A, w.B, w.f_over_stretch1, w.f_over_stretch2, w.trellis_f12,
        w.f_next_row, f_int,
    )  # fmt: skip
    if within:
        for c in range(3):
            for j in range(s):
                f_int[c][k0 + j] = kept[c * s + j]
    if last == const.ni:
        membrane_kernels.scatter_forces_last_row(k0 + n, m0 + n, s, w.f_over_stretch2, w.B, w.f_next_row, f_int)
    elif last == (block + 1) * const.rows_per_block:
        for c in range(3):
            copy_to_panel(k0 + n, m0 + n, s, w.f_next_row[c], state.f_int_above[c])


@kernel(_nrt=False, forceinline=True)
def edge_stretches(state, const, first, last, thin, work):
    """Edge vectors, stretches, and means of the crossing stretches, of a block's rows and one beyond at each end."""
    s, w = const.row_stride, work
    low = max(first - 1, 0)
    m0, n = (low - first + 2) * s, (last - low + 1) * s
    membrane_kernels.edge_vectors(
        low * s, m0, n, s, state.u, const.inv_dx, const.inv_dy, w.A, w.B, w.stretch1, w.inv_stretch1, w.stretch2,
        w.inv_stretch2,
    )  # fmt: skip
    membrane_kernels.reset_idle_slots(m0, n, s, w.B, w.stretch2, w.inv_stretch2)
    if first == 0:
        membrane_kernels.copy_row(s, 2 * s, s, w.stretch1)
    if last == const.ni:
        end = (last - first + 2) * s
        membrane_kernels.copy_row(s, end - s, end, w.stretch1)
    membrane_kernels.crossing_means_warp(
        low * s, m0, (last - low) * s, s, const.mean_weight2, w.stretch2, w.mean_stretch2
    )
    membrane_kernels.crossing_means_weft(
        first * s, 2 * s, (last - first + 1) * s, s, const.mean_weight1, w.stretch1, w.mean_stretch1
    )
    if thin:
        shift = (first - 2) * s
        failure_kernels.damaged_means(const, state, 0, low, last, shift, w.stretch2, w.mean_stretch2)
        failure_kernels.damaged_means(const, state, 1, first, last + 1, shift, w.stretch1, w.mean_stretch1)


@kernel(_nrt=False, forceinline=True)
def interpolate_tensions(state, const, block, first, last, thin, work):
    """Interpolate the tensions of a block's edges from the cell table; the largest of each family."""
    s, c, w, most = const.row_stride, const, work, state.block_max_tension[block]
    k0, m0, n = first * s, 2 * s, (last - first) * s
    n2, shift = n + s if last == c.ni else n, (first - 2) * s
    most[0] = membrane_kernels.bilinear_tensions(m0, n, w.stretch1, w.mean_stretch2, c.table_grid, c.tension1, w.T1)
    most[1] = membrane_kernels.bilinear_tensions(m0, n2, w.mean_stretch1, w.stretch2, c.table_grid, c.tension2, w.T2)
    if thin:
        failure_kernels.damaged_forces(const, state, 0, first, last, shift, w.stretch1, w.T1)
        failure_kernels.damaged_forces(const, state, 1, first, last + 1, shift, w.stretch2, w.T2)
        most[0], most[1] = membrane_kernels.max_value(m0, n, w.T1), membrane_kernels.max_value(m0, n2, w.T2)
    if c.variational:
        copy_to_panel(k0, m0, n, w.T1, state.T[0])
        copy_to_panel(k0, m0, n2, w.T2, state.T[1])
        state.tension_stale[block] = False


@kernel(_nrt=False)
def tension_bound(const, p, q, N, unit, ceiling):
    """Upper bound [N] of the tensions of a family, from the largest table coordinates and the largest force N.

    p, q in cells of the table; unit, ceiling : see `crossover_kernels.tension_bound_table`.
    """
    if not (p <= const.table_last1 + 1 and q <= const.table_last2 + 1 and N < unit * ceiling.shape[0]):
        return np.inf
    step = int(N / unit)
    return max(ceiling[step, 0], N + ceiling[step, 1])


@kernel(_nrt=False)
def refresh_tensions(state, const, first, last, work):
    """Update the stale tensions of the blocks first .. last - 1 (lazy evaluation)."""
    for block in range(first, last):
        if state.tension_stale[block]:
            low, high = (
                max(state.active_rows[0], block * const.rows_per_block),
                min(state.active_rows[1], (block + 1) * const.rows_per_block),
            )
            edge_stretches(state, const, low, high, False, work)
            interpolate_tensions(state, const, block, low, high, False, work)


@kernel(_nrt=False, forceinline=True)
def potential_gradient(state, const, block, first, last, thin, work):
    """Forces of the variational form, into work.N1 and work.N2 (see `membrane_kernels`).

    Returns whether no tension can be past the peak so far or a strength, so that none need be looked up.
    """
    s, c, w, low = const.row_stride, const, work, max(first - 1, 0)
    m0, m1 = 2 * s, (low - first + 2) * s
    n, n1, n2 = (last - first) * s, (last - low) * s, (last - first + 1) * s
    p1, q1, high1, _ = membrane_kernels.potential_forces(
        m1, n1, w.stretch1, w.mean_stretch2, c.table_grid, c.potential_coefficients, c.force_per_slope1,
        c.force_per_slope2, 2.0 * c.force_per_slope1 * c.table_scale1, 0.0, w.cell_index, w.dW_own1, w.dW_crossing1,
        w.slope1,
    )  # fmt: skip
    p2, q2, _, high2 = membrane_kernels.potential_forces(
        m0, n2, w.mean_stretch1, w.stretch2, c.table_grid, c.potential_coefficients, c.force_per_slope1,
        c.force_per_slope2, 0.0, 2.0 * c.force_per_slope2 * c.table_scale2, w.cell_index, w.dW_crossing2, w.dW_own2,
        w.slope2,
    )  # fmt: skip
    if first == 0:
        membrane_kernels.copy_row(s, m0, s, work.dW_crossing1)
    if last == const.ni:
        end = (last - first + 2) * s
        membrane_kernels.copy_row(s, end - s, end, work.dW_crossing1)
    shift = (first - 2) * s
    if thin:
        failure_kernels.damaged_gradient(
            const, state, 0, first, last, shift, w.stretch1, w.dW_own1, w.dW_crossing2, w.N1, w.slope1
        )
        failure_kernels.damaged_gradient(
            const, state, 1, first, last + 1, shift, w.stretch2, w.dW_own2, w.dW_crossing1, w.N2, w.slope2
        )
        return False
    membrane_kernels.distribute_warp(first * s, m0, n, s, c.mean_weight2, work.dW_own1, work.dW_crossing2, work.N1)
    membrane_kernels.distribute_weft(first * s, m0, n2, s, c.mean_weight1, work.dW_own2, work.dW_crossing1, work.N2)
    most = state.block_max_tension[block]
    most[0] = tension_bound(const, p1, q1, high1, c.tension_bound_step1, c.tension_bound_table1)
    most[1] = tension_bound(const, p2, q2, high2, c.tension_bound_step2, c.tension_bound_table2)
    state.tension_stale[block] = (
        const.filter_alpha == 0.0
        and most[0] <= min(state.peak_tension[0], const.min_strength1)
        and most[1] <= min(state.peak_tension[1], const.min_strength2)
    )
    return state.tension_stale[block]


@kernel(forceinline=True)
def copy_to_panel(k0, m0, n, x, kept):
    """Copy scratch to the panel's slots."""
    for j in range(0, n, WIDTH):
        masked_store(kept, k0 + j, load(x, m0 + j), n - j)


@kernel(_nrt=False, forceinline=True)
def yarn_forces(state, const, block, k0, n, n2, N1, N2, work):
    """Axial forces of the block's edges, into work.f_over_stretch1 and work.f_over_stretch2, and their work."""
    L, N, D, S, y, c, w, s = (
        state.stretch, state.N, state.dstretch, state.force_slope, state.yarn_length, const, work, const.row_stride,
    )  # fmt: skip
    again = state.block_damage[block] == REDO
    work1, viscous1, over1 = membrane_kernels.yarn_forces(
        k0, 2 * s, n, 1, again, c.inv_dx, c.cv1, w.stretch1, w.inv_stretch1, w.trellis_f1, N1, w.slope1, y[0], L[0],
        N[0], D[0], S[0], w.f_over_stretch1,
    )  # fmt: skip
    work2, viscous2, over2 = membrane_kernels.yarn_forces(
        k0, 2 * s, n2, s, again, c.inv_dy, c.cv2, w.stretch2, w.inv_stretch2, w.trellis_f2, N2, w.slope2, y[1], L[1],
        N[1], D[1], S[1], w.f_over_stretch2,
    )  # fmt: skip
    if not again:
        state.energy_sums[block, WORK] += work1 + work2
        state.energy_sums[block, VISCOUS] += viscous1 + viscous2
        state.energy_sums[block, QUADRATURE] += 0.5 * (over1 + over2)  # what has the slope is half of N


@kernel(_nrt=False, forceinline=True)
def trellis_forces(state, const, first, last, thin, work):
    """Shear forces of the block's elements and of the row before them, which shares their first weft edges."""
    s, c, w, low = const.row_stride, const, work, max(first - 1, 0)
    m0, n = (low - first + 2) * s, (last - low) * s
    membrane_kernels.trellis_forces(
        low * s, m0, n, s, w.A, w.B, w.stretch1, w.stretch2, c.trellis_volume, c.G1, c.G2, c.gamma1, c.gamma2,
        w.trellis_f1, w.trellis_f2, w.trellis_f12,
    )  # fmt: skip
    if thin:
        failure_kernels.damaged_trellis(
            const, state, low, last, (first - 2) * s, w.trellis_f1, w.trellis_f2, w.trellis_f12
        )
    # beyond the panel there is none
    if first == 0:
        for j in range(s, 2 * s):
            w.trellis_f1[j] = w.trellis_f2[j] = w.trellis_f12[j] = 0.0
    if last == const.ni:
        for j in range(m0 + n, m0 + n + s):
            w.trellis_f2[j] = 0.0


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


@kernel(_nrt=False)
def out_of_plane_forces(state, const, first, last, acting):
    """Bending and jamming energy [J] of the node rows first .. last; adds their forces to state.f_int if `acting`."""
    turns = bending_kernels.bending_forces(state, const, first, last, acting)
    return turns + jamming_kernels.jamming_forces(state, const, first, last, acting)


@kernel(_nrt=False)
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
    # looking for failures cuts yarns: what was before is asked for first where there may be one
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


@kernel(_nrt=False, forceinline=True)
def move_rows(state, const, first, last):
    """Move the node rows first .. last - 1 by one step. A block's first row has forces from the block before too."""
    apply_symmetry(state, const, first, last)
    row = first
    while row < last:
        met = row > 0 and row % const.rows_per_block == 0
        end = row + 1 if met else min(last, (row // const.rows_per_block + 1) * const.rows_per_block)
        k0, n = row * const.row_stride, (end - row) * const.row_stride
        move_nodes(k0, n, const.dt, state.dt_over_mass, state.f_int, state.f_int_above, met, state.v, state.u)
        row = end


@kernel(_nrt=False)
def thread_range(state, const, me, count):
    """(first, last) active blocks of thread `me` among `count`; the last thread has at least one."""
    start, end = (
        state.active_rows[0] // const.rows_per_block,
        (state.active_rows[1] + const.rows_per_block - 1) // const.rows_per_block,
    )
    return start + (end - start) * me // count, start + (end - start) * (me + 1) // count


@kernel(_nrt=False, forceinline=True)
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


@kernel(_nrt=False, forceinline=True)
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


@kernel(_nrt=False, forceinline=True)
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
    idle = failures > 0 and alone and not contact_kernels.cloth_ahead_of_nose(state, const)
    state.counter[IDLE] = state.counter[IDLE] + 1 if idle else 0
    return PERFORATED if state.counter[IDLE] >= const.perforation_delay_steps else RUNNING


@kernel(forceinline=True)
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
def run_steps_main(state, const, work, steps, history, shared, count, allowed):
    """Make at most `steps` steps, with `count` - 1 worker threads in `run_steps_worker`, all with scratch of their own.

    history (steps, 3): the projectile's foremost z, v_z of its centre of mass and the force on it after each; of a bar
    (steps, 9), see `record_step`. shared : see `barrier.barrier_wait`. allowed [J] : energy exchange, the sum over
    steps of the change of `internal_work`, after which CHECK ends the call: no energy error can exceed the energy
    exchanged. Returns (steps made, RUNNING or the reason to end).
    """
    made, reason, exchanged, before = 0, RUNNING, 0.0, internal_work(state)
    while made < steps and reason == RUNNING:
        pre_step(state, const)
        barrier_wait(shared, count)
        update_blocks(state, const, work, shared, 0, count)
        barrier_wait(shared, count)
        reason = post_step(state, const, work)
        record_step(state, const, state.f_contact_nose[2] + state.f_block_nose[2], history[made])
        made += 1
        now = internal_work(state)
        exchanged, before = exchanged + abs(now - before), now
        if reason == RUNNING and not exchanged <= allowed:
            reason = CHECK
    shared[STOP] = 1
    barrier_wait(shared, count)
    first, last = thread_range(state, const, 0, count)
    refresh_tensions(state, const, first, last, work)
    barrier_wait(shared, count)
    return made, reason


@entry(nogil=True, _nrt=False)
def run_steps_worker(state, const, work, shared, me, count):
    """Worker thread `me` of the steps that `run_steps_main` makes."""
    while True:
        barrier_wait(shared, count)
        if shared[STOP] != 0:
            break
        update_blocks(state, const, work, shared, me, count)
        barrier_wait(shared, count)
    first, last = thread_range(state, const, me, count)
    refresh_tensions(state, const, first, last, work)
    barrier_wait(shared, count)


@entry(nogil=True, _nrt=False)
def run_steps(state, const, work, steps, history):
    """`run_steps_main` without worker threads."""
    return run_steps_main(state, const, work, steps, history, work.barrier, 1, np.inf)


@entry(nogil=True, _nrt=False)
def initial_forces(state, const, work):
    """Internal forces of the initial state, before the first step."""
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
    out[BENDING] = bending_kernels.bending_forces(state, const, 0, const.ni, False)
    out[JAMMING] = jamming_kernels.jamming_forces(state, const, 0, const.ni, False)
