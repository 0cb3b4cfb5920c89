"""Motion of the nodes of a panel in a step, and the window of rows that motion can have reached.

Only these rows are updated, which is exact: an element whose nodes are all at rest has no force on
them. Velocities below 1e-60 m/s are set to zero, without which the front of the wave would be
preceded by denormal numbers.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, fabs, fma, greater, load, masked_store, where
from shellfabric.state import unit

AT_REST = -1  # of state.steps, until the initial forces are computed
_MIN_VELOCITY = 1e-60


@unit()
def move_nodes(state, const, begin, end, both):
    """Update the nodes begin .. end - 1 by central differences: forces f_int [N], or `both` f_int +
    f_int_above."""
    for k in range(begin, end, WIDTH):
        left = end - k
        impulse = load(state.dt_over_mass, k)
        for c in range(3):
            force = load(state.f_int[c], k)
            if both:
                force = force + load(state.f_int_above[c], k)
            speed = fma(impulse, force, load(state.v[c], k))
            speed = where(greater(fabs(speed), _MIN_VELOCITY), speed, 0.0)
            masked_store(state.v[c], k, speed, left)
            masked_store(state.u[c], k, fma(speed, const.dt, load(state.u[c], k)), left)


@kernel(_nrt=False, forceinline=True)
def apply_symmetry(state, const, first, last):
    """Set the force across planes of symmetry to zero, on the node rows first .. last - 1."""
    if const.mirror_x and first == 0:
        for k in range(const.row_stride):
            state.f_int[0][k] = state.f_int_above[0][k] = 0.0
    if const.mirror_y:
        for i in range(first, last):
            k = np.uint64(i * const.row_stride)
            state.f_int[1][k] = state.f_int_above[1][k] = 0.0


@kernel(_nrt=False)
def row_has_moved(state, const, i):
    """Tell whether a node of row i has a displacement."""
    for k in range(np.uint64(i * const.row_stride), np.uint64((i + 1) * const.row_stride)):
        if state.u[0][k] != 0.0 or state.u[1][k] != 0.0 or state.u[2][k] != 0.0:
            return True
    return False


@unit()
def grow_active_rows(state, const):
    """Grow the window of active element rows, state.first_row .. state.end_row - 1, ahead of the motion.

    The forces of a node reach two rows further than the nodes that have moved: over the segments
    that cross, and in the variational form over those that cross these. So in a step motion goes
    ahead by two rows at most, and its forces by two more. At the last row of nodes the elements
    beyond are missing: there is a window in time if its outer five rows are kept at rest.
    """
    for _ in range(2):
        first = state.first_row
        last = state.end_row
        stirred = False
        for i in range(first, min(first + 5, const.ni + 1)):
            stirred = stirred or row_has_moved(state, const, i)
        if first > 0 and stirred:
            state.first_row -= 1
        stirred = False
        for i in range(max(last - 4, 0), last + 1):
            stirred = stirred or row_has_moved(state, const, i)
        if last < const.ni and stirred:
            state.end_row += 1


@unit()
def move_rows(state, const, first, last):
    """Move the node rows first .. last - 1 by one step. A block's first row has forces from the
    block before too."""
    apply_symmetry(state, const, first, last)
    row = first
    while row < last:
        met = row > 0 and row % const.rows_per_block == 0
        if met:
            end = row + 1
        else:
            end = min(last, (row // const.rows_per_block + 1) * const.rows_per_block)
        move_nodes(state, const, row * const.row_stride, end * const.row_stride, met)
        row = end


@kernel(_nrt=False)
def active_blocks(state, const):
    """Return (first, last): the blocks first .. last - 1 hold the active rows."""
    per = const.rows_per_block
    return state.first_row // per, (state.end_row + per - 1) // per
