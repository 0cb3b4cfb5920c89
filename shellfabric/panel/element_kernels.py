"""Internal forces of the elements of a panel, block by block: stretches, tensions, yarn forces, trellis.

Tensions of the variational form are evaluated only where they may reach a new peak or half of a strength
(`tension_bound`, `refresh_tensions`). Compiled without reference counts, as all kernels that the state is handed to
(`solver.ply_kernels`).
"""

import numpy as np

from shellfabric.cloth import (
    damage_kernels,
    failure_kernels,
    membrane_kernels,
    packing_kernels,
    table_kernels,
    trellis_kernels,
)
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, load, masked_store
from shellfabric.state import unit

# of state.energy_sums; what is lost with failed yarns, and with trellis and turns
WORK, VISCOUS, LOST_YARN, LOST_TRELLIS = 0, 1, 2, 3
INTACT, DAMAGED, REDO = (
    0,
    1,
    2,
)  # of state.block_damage: a block without failures, with some, with some of this step


@unit()
def element_forces(state, const, block, first, last, work):
    """Internal forces of the element rows first .. last - 1 of one block, from the present displacements."""
    s, thin = const.row_stride, state.block_damage[block] != INTACT
    k0, n = first * s, (last - first) * s
    n2 = (
        n + s if last == const.ni else n
    )  # weft edges: those on the far side of the panel have no row of their own
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


@kernel(_nrt=False, inline="always")
def scatter_forces(state, const, block, first, last, work):
    """Scatter the element forces of a block to its nodes, and to the first row of nodes of the next block; find whether
    it has packed elements.

    A row of nodes in whose middle of a block the window begins or ends is at rest: it keeps the forces that it has.
    """
    s, k0, m0, n, w = (
        const.row_stride,
        first * const.row_stride,
        2 * const.row_stride,
        (last - first) * const.row_stride,
        work,
    )
    state.packed_blocks[block] = packing_kernels.has_packed(
        m0, n, s, w.A, w.B, const.packing[packing_kernels.SHARE]
    )
    f_int, kept, within = state.f_int, work.inv_stretch1, first > block * const.rows_per_block
    if within:
        for c in range(3):
            for j in range(s):
                kept[c * s + j] = f_int[c][k0 + j]
    membrane_kernels.scatter_forces(
        k0,
        m0,
        n,
        s,
        (const.inv_dx, const.inv_dy),
        w.A,
        w.B,
        w.f_over_stretch1,
        w.f_over_stretch2,
        w.trellis_f12,
        w.f_next_row,
        f_int,
    )
    if within:
        for c in range(3):
            for j in range(s):
                f_int[c][k0 + j] = kept[c * s + j]
    if last == const.ni:
        membrane_kernels.scatter_forces_last_row(
            k0 + n, m0 + n, s, w.f_over_stretch2, w.B, w.f_next_row, f_int
        )
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
        low * s,
        m0,
        n,
        s,
        state.u,
        (const.inv_dx, const.inv_dy),
        w.A,
        w.B,
        w.stretch1,
        w.inv_stretch1,
        w.stretch2,
        w.inv_stretch2,
    )
    membrane_kernels.reset_idle_slots(m0, n, s, w.B, w.stretch2, w.inv_stretch2)
    if first == 0:
        membrane_kernels.copy_row(s, 2 * s, s, w.stretch1)
    if last == const.ni:
        end = (last - first + 2) * s
        membrane_kernels.copy_row(s, end - s, end, w.stretch1)
    crossing_means(state, const, first, last, thin, w)


@kernel(_nrt=False, forceinline=True)
def crossing_means(state, const, first, last, thin, work):
    """Means of the crossing stretches of the edges of a block's rows, from work.stretch1 and work.stretch2."""
    s, w, low = const.row_stride, work, max(first - 1, 0)
    membrane_kernels.crossing_means_warp(
        low * s,
        (low - first + 2) * s,
        (last - low) * s,
        s,
        const.mean_weight2,
        w.stretch2,
        w.mean_stretch2,
    )
    membrane_kernels.crossing_means_weft(
        first * s, 2 * s, (last - first + 1) * s, s, const.mean_weight1, w.stretch1, w.mean_stretch1
    )
    if thin:
        shift = (first - 2) * s
        damage_kernels.damaged_means(const, state, 0, low, last, shift, w.stretch2, w.mean_stretch2)
        damage_kernels.damaged_means(
            const, state, 1, first, last + 1, shift, w.stretch1, w.mean_stretch1
        )


@kernel(_nrt=False, forceinline=True)
def interpolate_tensions(state, const, block, first, last, thin, work):
    """Interpolate the tensions of a block's edges from the cell table; the largest of each family."""
    s, c, w, most = const.row_stride, const, work, state.block_max_tension[block]
    k0, m0, n = first * s, 2 * s, (last - first) * s
    n2, shift = n + s if last == c.ni else n, (first - 2) * s
    reach1, reach2 = c.table_beyond[0], c.table_beyond[1]  # a yarn's own stretch counts all
    most[0] = table_kernels.bilinear_tensions(
        m0, n, w.stretch1, w.mean_stretch2, c.table_grid, c.tension1, (np.inf, reach2), w.T1
    )
    most[1] = table_kernels.bilinear_tensions(
        m0, n2, w.mean_stretch1, w.stretch2, c.table_grid, c.tension2, (reach1, np.inf), w.T2
    )
    if thin:
        damage_kernels.damaged_forces(const, state, 0, first, last, shift, w.stretch1, w.T1)
        damage_kernels.damaged_forces(const, state, 1, first, last + 1, shift, w.stretch2, w.T2)
        most[0], most[1] = (
            table_kernels.max_value(m0, n, w.T1),
            table_kernels.max_value(m0, n2, w.T2),
        )
    if c.variational:
        copy_to_panel(k0, m0, n, w.T1, state.T[0])
        copy_to_panel(k0, m0, n2, w.T2, state.T[1])
        state.tension_stale[block] = False


@kernel(_nrt=False)
def tension_bound(const, p, q, N, unit, ceiling):
    """Upper bound [N] of the tensions of a family, from the largest table coordinates and the largest force N.

    p, q in cells of the table; unit, ceiling : see `crossover_kernels.tension_bound_table`.
    """
    if not (
        p <= const.table_last1 + 1 and q <= const.table_last2 + 1 and N < unit * ceiling.shape[0]
    ):
        return np.inf
    step = int(N / unit)
    return max(ceiling[step, 0], N + ceiling[step, 1])


@unit()
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


@kernel(_nrt=False, inline="always")
def potential_gradient(state, const, block, first, last, thin, work):
    """Forces of the variational form, into work.N1 and work.N2 (see `table_kernels`).

    Returns whether no tension can be past the peak so far or half of a strength, so that none need be looked up.
    """
    s, c, w, low = const.row_stride, const, work, max(first - 1, 0)
    m0, m1 = 2 * s, (low - first + 2) * s
    n, n1, n2 = (last - first) * s, (last - low) * s, (last - first + 1) * s
    p1, q1, high1, _ = table_kernels.potential_forces(
        m1,
        n1,
        w.stretch1,
        w.mean_stretch2,
        c.table_grid,
        c.potential_coefficients,
        c.table_beyond,
        (c.force_per_slope1, c.force_per_slope2),
        w.cell_index,
        w.dW_own1,
        w.dW_crossing1,
    )
    p2, q2, _, high2 = table_kernels.potential_forces(
        m0,
        n2,
        w.mean_stretch1,
        w.stretch2,
        c.table_grid,
        c.potential_coefficients,
        c.table_beyond,
        (c.force_per_slope1, c.force_per_slope2),
        w.cell_index,
        w.dW_crossing2,
        w.dW_own2,
    )
    if first == 0:
        membrane_kernels.copy_row(s, m0, s, work.dW_crossing1)
    if last == const.ni:
        end = (last - first + 2) * s
        membrane_kernels.copy_row(s, end - s, end, work.dW_crossing1)
    membrane_kernels.distribute_warp(
        first * s, m0, n, s, c.mean_weight2, work.dW_own1, work.dW_crossing2, work.N1
    )
    membrane_kernels.distribute_weft(
        first * s, m0, n2, s, c.mean_weight1, work.dW_own2, work.dW_crossing1, work.N2
    )
    if thin:
        shift = (first - 2) * s
        damage_kernels.damaged_gradient(
            const, state, 0, first, last, shift, w.stretch1, w.dW_own1, w.dW_crossing2, w.N1
        )
        damage_kernels.damaged_gradient(
            const, state, 1, first, last + 1, shift, w.stretch2, w.dW_own2, w.dW_crossing1, w.N2
        )
        return False
    most = state.block_max_tension[block]
    most[0] = tension_bound(const, p1, q1, high1, c.tension_bound_step1, c.tension_bound_table1)
    most[1] = tension_bound(const, p2, q2, high2, c.tension_bound_step2, c.tension_bound_table2)
    state.tension_stale[block] = not failure_kernels.may_fail(const, state, block)
    return state.tension_stale[block]


@kernel(forceinline=True)
def copy_to_panel(k0, m0, n, x, kept):
    """Copy scratch to the panel's slots."""
    for j in range(0, n, WIDTH):
        masked_store(kept, k0 + j, load(x, m0 + j), n - j)


@kernel(_nrt=False, inline="always")
def yarn_forces(state, const, block, k0, n, n2, N1, N2, work):
    """Axial forces of the block's edges, into work.f_over_stretch1 and work.f_over_stretch2, and their work."""
    L, N, D, y, c, w, s = (
        state.stretch,
        state.N,
        state.dstretch,
        state.yarn_length,
        const,
        work,
        const.row_stride,
    )
    again = state.block_damage[block] == REDO
    work1, viscous1 = membrane_kernels.yarn_forces(
        k0,
        2 * s,
        n,
        1,
        again,
        c.inv_dx,
        c.cv1,
        (w.stretch1, w.inv_stretch1, w.trellis_f1, N1),
        y[0],
        (L[0], N[0], D[0]),
        w.f_over_stretch1,
    )
    work2, viscous2 = membrane_kernels.yarn_forces(
        k0,
        2 * s,
        n2,
        s,
        again,
        c.inv_dy,
        c.cv2,
        (w.stretch2, w.inv_stretch2, w.trellis_f2, N2),
        y[1],
        (L[1], N[1], D[1]),
        w.f_over_stretch2,
    )
    if not again:
        state.energy_sums[block, WORK] += work1 + work2
        state.energy_sums[block, VISCOUS] += viscous1 + viscous2


@kernel(_nrt=False, inline="always")
def trellis_forces(state, const, first, last, thin, work):
    """Shear forces of the block's elements and of the row before them, which shares their first weft edges."""
    s, c, w, low = const.row_stride, const, work, max(first - 1, 0)
    m0, n = (low - first + 2) * s, (last - low) * s
    trellis_kernels.trellis_forces(
        low * s,
        m0,
        n,
        s,
        w.A,
        w.B,
        (w.stretch1, w.stretch2),
        c.trellis_volume,
        (c.G1, c.G2, c.gamma1, c.gamma2),
        w.trellis_f1,
        w.trellis_f2,
        w.trellis_f12,
    )
    if thin:
        damage_kernels.damaged_trellis(
            const, state, low, last, (first - 2) * s, w.trellis_f1, w.trellis_f2, w.trellis_f12
        )
    # beyond the panel there is none
    if first == 0:
        for j in range(s, 2 * s):
            w.trellis_f1[j] = w.trellis_f2[j] = w.trellis_f12[j] = 0.0
    if last == const.ni:
        for j in range(m0 + n, m0 + n + s):
            w.trellis_f2[j] = 0.0
