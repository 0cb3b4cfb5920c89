"""Forces of a contact on the nodes of a ply: of nose, other plies, guard and block alike.

They are given to the nodes as impulses at the beginning of a step (v += dt f / m), and their work
is half a step's on the velocities before it and half a step's on those after it, so that nothing
is left out where they change. Each has a window of nodes, (first row, row after the last, first
column, column after the last); beyond it the forces are 0. A window is an array, since there is one
for each ply and side of a pack; `bounds` and `set_window` alone know its order.
"""

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    fma,
    head_mask,
    load,
    masked_store,
    reduce_add,
    where,
)


@kernel(forceinline=True)
def bounds(window):
    """Return first row, row after the last, first column and column after the last of a window."""
    return window[0], window[1], window[2], window[3]


@kernel(forceinline=True)
def set_window(window, first_row, end_row, first_column, end_column):
    """Set the four bounds of a window."""
    window[0] = first_row
    window[1] = end_row
    window[2] = first_column
    window[3] = end_column


@kernel(_nrt=False, forceinline=True)
def clear_window(window, ni, width):
    """Make a window of nodes one of none."""
    set_window(window, ni + 1, 0, width, 0)


@kernel(_nrt=False, forceinline=True)
def extend_window(window, i0, i1, j0, j1):
    """Widen a window of nodes to the rows i0 .. i1 - 1 and the columns j0 .. j1 - 1."""
    first_row, end_row, first_column, end_column = bounds(window)
    set_window(
        window,
        min(first_row, i0),
        max(end_row, i1),
        min(first_column, j0),
        max(end_column, j1),
    )


@kernel(_nrt=False, forceinline=True)
def include_rows(state, const, first, last):
    """Widen the window of active element rows to first .. last - 1, as far as there are any."""
    state.first_row = min(state.first_row, max(first, 0))
    state.end_row = max(state.end_row, min(last, const.ni))


@kernel(_nrt=False)
def keep_symmetry(const, force, window):
    """Take from nodes on a plane of symmetry the forces across it."""
    first_row, end_row, first_column, end_column = bounds(window)
    if const.mirror_x and first_row == 0:
        for k in range(first_column, end_column):
            force[0][k] = 0.0
    if const.mirror_y and first_column == 0:
        for i in range(first_row, end_row):
            force[1][i * const.row_stride] = 0.0


@kernel(_nrt=False, forceinline=True)
def give_impulses(state, const, force, window):
    """Add v += dt f / m of the nodes of a window."""
    first_row, end_row, first_column, end_column = bounds(window)
    for i in range(first_row, end_row):
        for j in range(first_column, end_column, WIDTH):
            k = i * const.row_stride + j
            left = end_column - j
            kick = load(state.dt_over_mass, k)
            for c in range(3):
                speed = fma(kick, load(force[c], k), load(state.v[c], k))
                masked_store(state.v[c], k, speed, left)


@kernel(_nrt=False, forceinline=True)
def half_step_work(state, const, force, window, over):
    """Compute half a step's work [J] of forces on the present velocities of the nodes.

    Forces that are `over` are taken away, and their window is then one of none.
    """
    work = broadcast(0.0)
    none = broadcast(0.0)
    first_row, end_row, first_column, end_column = bounds(window)
    for i in range(first_row, end_row):
        for j in range(first_column, end_column, WIDTH):
            k = i * const.row_stride + j
            left = end_column - j
            power = load(force[0], k) * load(state.v[0], k)
            power = fma(load(force[1], k), load(state.v[1], k), power)
            power = fma(load(force[2], k), load(state.v[2], k), power)
            work = work + where(head_mask(left), power, 0.0)
            if over:
                for c in range(3):
                    masked_store(force[c], k, none, left)
    if over:
        clear_window(window, const.ni, const.row_stride)
    return 0.5 * const.dt * reduce_add(work)
