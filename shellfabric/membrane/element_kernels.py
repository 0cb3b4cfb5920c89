"""Internal forces of the elements of a panel, block by block: stretches, tensions, yarn forces,
trellis.

Tensions of the variational form are evaluated only where they may reach a new peak or half of a
strength (`tension_bound`, `refresh_tensions`). Compiled without reference counts, as all kernels
that the state is handed to (`loop.ply_kernels`).
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.membrane import (
    damage_kernels,
    failure_kernels,
    membrane_kernels,
    packing_kernels,
    table_kernels,
    trellis_kernels,
)
from shellfabric.membrane.membrane_kernels import copy_slots, scratch_slot
from shellfabric.state import GONE, INTACT, WARP, WEFT, unit


@unit()
def element_forces(state, const, block, first, last, work):
    """Compute the internal forces of the element rows first .. last - 1 of one block, from the
    present displacements."""
    if state.block_damage[block] == GONE:
        membrane_kernels.clear_forces(state, const, block, first, last)
        return
    damaged = state.block_damage[block] != INTACT
    stretches(state, const, first, last, damaged, work)
    trellis_kernels.trellis_forces(state, const, work, first, last)
    if damaged:
        damage_kernels.damaged_trellis(state, const, work, first, last)
    needed = True  # tensions
    if const.variational:
        needed = potential_gradient(state, const, block, first, last, damaged, work)
    if needed:
        interpolate_tensions(state, const, block, first, last, damaged, work)
    membrane_kernels.pull_yarns(state, const, work, block, first, last)
    state.packed_blocks[block] = packing_kernels.has_packed(state, const, work, first, last)
    membrane_kernels.scatter_forces(state, const, work, block, first, last)


@kernel(_nrt=False)
def stretches(state, const, first, last, damaged, work):
    """Compute the stretches of a block's edges, and their means over the edges that cross each."""
    membrane_kernels.stretch_edges(state, const, work, first, last)
    if damaged:
        damage_kernels.damaged_means(state, const, work, first, last)
    else:
        membrane_kernels.average_crossing(state, const, work, first, last)


@kernel(_nrt=False)
def interpolate_tensions(state, const, block, first, last, damaged, work):
    """Interpolate the tensions of a block's edges from the cell table; the largest of each
    family."""
    s = const.row_stride
    m = 2 * s
    n = (last - first) * s
    n_weft = n
    if last == const.ni:
        n_weft += s  # the weft on the far side of the panel has no row of its own
    reach1, reach2, _, _, _, _ = const.table_beyond
    most = state.block_max_tension[block]
    stretch1, stretch2 = work.stretch
    mean1, mean2 = work.mean_stretch
    warp, weft = work.T
    # a yarn's own stretch counts all beyond the table
    most[WARP] = table_kernels.bilinear_tensions(
        m, n, stretch1, mean2, const.table_grid, const.tension1, (np.inf, reach2), warp
    )
    most[WEFT] = table_kernels.bilinear_tensions(
        m, n_weft, mean1, stretch2, const.table_grid, const.tension2, (reach1, np.inf), weft
    )
    if damaged:
        damage_kernels.damaged_tensions(const, work, first, last)
        most[WARP] = table_kernels.max_value(m, n, warp)
        most[WEFT] = table_kernels.max_value(m, n_weft, weft)
    if const.variational:
        copy_slots(warp, m, n, state.T[WARP], first * s)
        copy_slots(weft, m, n_weft, state.T[WEFT], first * s)
        state.tension_stale[block] = False


@kernel(_nrt=False)
def tension_bound(const, p, q, N, unit, ceiling):
    """Compute an upper bound [N] of the tensions of a family, from the largest table coordinates
    and the largest force N.

    p, q in cells of the table; unit, ceiling : see `crossover_kernels.tension_bound_table`.
    """
    _, _, last1, _, _, last2, _ = const.table_grid
    if not (p <= last1 + 1.0 and q <= last2 + 1.0 and N < unit * ceiling.shape[0]):
        return np.inf
    step = int(N / unit)
    return max(ceiling[step, 0], N + ceiling[step, 1])


@unit()
def refresh_tensions(state, const, first, last, work):
    """Update the stale tensions of the blocks first .. last - 1 (lazy evaluation)."""
    per = const.rows_per_block
    for block in range(first, last):
        if state.tension_stale[block]:
            low = max(state.first_row, block * per)
            high = min(state.end_row, (block + 1) * per)
            stretches(state, const, low, high, False, work)
            interpolate_tensions(state, const, block, low, high, False, work)


@kernel(_nrt=False)
def potential_gradient(state, const, block, first, last, damaged, work):
    """Compute the forces of the variational form, into work.N (see `table_kernels`).

    Returns whether a tension may be past the peak so far or half of a strength, so that they have
    to be looked up.
    """
    s = const.row_stride
    low = max(first - 1, 0)
    p1, q1, high1, _ = table_kernels.potential_forces(
        scratch_slot(const, first, low),
        (last - low) * s,
        work.stretch[WARP],
        work.mean_stretch[WEFT],
        const.table_grid,
        const.potential_coefficients,
        const.table_beyond,
        (const.force_per_slope1, const.force_per_slope2),
        work.cell_index,
        work.dW_own[WARP],
        work.dW_crossing[WARP],
    )
    p2, q2, _, high2 = table_kernels.potential_forces(
        2 * s,
        (last - first + 1) * s,
        work.mean_stretch[WARP],
        work.stretch[WEFT],
        const.table_grid,
        const.potential_coefficients,
        const.table_beyond,
        (const.force_per_slope1, const.force_per_slope2),
        work.cell_index,
        work.dW_crossing[WEFT],
        work.dW_own[WEFT],
    )
    if damaged:
        damage_kernels.damaged_gradient(state, const, work, first, last)
        return True
    membrane_kernels.share_forces(state, const, work, first, last)
    most = state.block_max_tension[block]
    most[WARP] = tension_bound(
        const, p1, q1, high1, const.tension_bound_step1, const.tension_bound_table1
    )
    most[WEFT] = tension_bound(
        const, p2, q2, high2, const.tension_bound_step2, const.tension_bound_table2
    )
    needed = failure_kernels.may_fail(const, state, block)
    state.tension_stale[block] = not needed
    return needed
