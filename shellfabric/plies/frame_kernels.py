"""The plies of a pack on their grids (`surface.grid_kernels`), which are parts of one: node (i, j) of
ply p is number base[p] + i stride + j. What of them is torn, and what they hand over."""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.membrane.packing_kernels import is_fabric
from shellfabric.plies.state import unit
from shellfabric.state import ERODED, RESOLVED
from shellfabric.surface.grid_kernels import to_nodes
from shellfabric.surface.nodal_force_kernels import (
    bounds,
    give_impulses,
    half_step_work,
    include_rows,
)
from shellfabric.surface.vector_kernels import add_scaled, difference, dot, nodal, subtract

TALL, WIDE = 4, 8  # elements of a tile of `plies.near_kernels`
BEFORE, BEHIND = 0, 1  # sides of a ply, of its forces
_SEARCHED = 1  # elements about a closest point among which it is looked for beside torn fabric


@kernel(_nrt=False, forceinline=True)
def mean_thickness(contact, p, q):
    """Return the mean thickness [m] of plies p and q."""
    return 0.5 * (contact.thickness[p] + contact.thickness[q])


@kernel(_nrt=False, forceinline=True)
def grid_in_pack(contact, p):
    """Return the grid of ply p: (base, stride, ni, nj)."""
    return contact.base[p], contact.row_stride[p], contact.ni[p], contact.nj[p]


@unit()
def mark_torn(state, const, contact, p):
    """Mark the nodes of torn elements of ply p, and drop the elements that are no fabric any more:
    those without a yarn of either family, eroded ones, and those that join pieces which have
    parted. Where yarns are resolved only those that the zone has eroded are torn."""
    lists = contact.lists
    contact.failures[p] = state.failures
    if contact.failures[p] == 0:
        return
    for i in range(const.ni):
        for j in range(const.nj):
            k = np.uint64(i * const.row_stride + j)
            flag = state.element_flag[k]
            if flag == 0 or (flag & RESOLVED and not flag & ERODED):
                continue
            g = contact.base[p] + i * contact.row_stride[p] + j
            stride = contact.row_stride[p]
            contact.torn[g] = contact.torn[g + 1] = contact.torn[g + stride] = contact.torn[
                g + stride + 1
            ] = 1
            if contact.dropped[g] or flag & ERODED or not is_fabric(state, const, k):
                contact.dropped[g] = 1
                lists.has_hole[
                    lists.first_tile[p] + i // TALL * lists.tiles_across[p] + j // WIDE
                ] = 1


@kernel(_nrt=False, forceinline=True)
def is_torn(contact, p, a, b):
    """Tell whether a torn element is among those that shape the spline of ply p at the place (a,
    b)."""
    if contact.failures[p] == 0:
        return False
    base, stride, ni, nj = grid_in_pack(contact, p)
    i = min(max(int(a + 0.5), 0), ni)
    j = min(max(int(b + 0.5), 0), nj)
    return contact.torn[base + i * stride + j] != 0


@kernel(_nrt=False, forceinline=True)
def has_dropped(contact, p, a, b):
    """Tell whether the element of ply p at the place (a, b) has eroded, or hangs loose."""
    base, stride, ni, nj = grid_in_pack(contact, p)
    i = min(max(int(a), 0), ni - 1)
    j = min(max(int(b), 0), nj - 1)
    return contact.dropped[base + i * stride + j] != 0


@kernel(_nrt=False)
def nearest_place(contact, p, place, at):
    """Find the place nearest to the point `at` among the middles of the quarters of the elements
    about a place (a, b) that have not eroded; the place itself if there is none."""
    a, b = place
    base, s, ni, nj = grid_in_pack(contact, p)
    i0 = min(max(int(a), 0), ni - 1)
    j0 = min(max(int(b), 0), nj - 1)
    x = contact.x
    least = 1e30
    found_a = a
    found_b = b
    for i in range(max(i0 - _SEARCHED, 0), min(i0 + _SEARCHED + 1, ni)):
        for j in range(max(j0 - _SEARCHED, 0), min(j0 + _SEARCHED + 1, nj)):
            k = base + i * s + j
            if contact.dropped[k]:
                continue
            for m in range(4):
                f = 0.25 + 0.5 * (m & 1)
                g = 0.25 + 0.5 * (m >> 1)
                low = add_scaled(nodal(x, k), g, difference(x, k, k + 1))
                high = add_scaled(nodal(x, k + s), g, difference(x, k + s, k + s + 1))
                off = subtract(add_scaled(low, f, subtract(high, low)), at)
                square = dot(off, off)
                if square < least:
                    least = square
                    found_a = i + f
                    found_b = j + g
    return found_a, found_b


@unit()
def collect_forces(state, const, contact, p):
    """Hand over the forces on the grid of ply p, of plies before it and behind it, as nodal forces
    in its own frame; half a step's work of those of the last step, which are over, and half a
    step's of the new."""
    pressure = contact.pressure
    for side in range(2):
        force = pressure.force[p, side]
        window = pressure.window[p, side]
        pressure.work[p] -= half_step_work(state, const, force, window, True)
        on_grid = pressure.grid_force[p, side], pressure.grid_window[p, side]
        to_nodes(state, const, on_grid, (force, window))
        pressure.work[p] -= half_step_work(state, const, force, window, False)


@unit("flag", force="3, n", window="4 int64")
def apply_impulses(state, const, force, window):
    """Give a ply the impulses of contact forces of others; widen its window of active rows to them.
    Whether there are any."""
    first_row, end_row, _, _ = bounds(window)
    if end_row <= first_row:
        return False
    give_impulses(state, const, force, window)
    include_rows(state, const, first_row - 4, end_row + 3)
    return True
