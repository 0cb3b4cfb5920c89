"""Places, velocities and forces of the nodes of all plies in one frame, that of the first ply, for
their contact.

The arrays of a ply (`panel.arrays.State`) are in its own frame: displacements, x along its first
family of yarns. Here the nodes of ply p are those of a grid with a ring of ghosts about it: node
(i, j) has the number

    base[p] + i stride + j,     i = -1 ... ni + 1,  j = -1 ... nj + 1

A ghost is the mirror image of the node beyond a plane of symmetry, and goes straight on, 2 x_0 -
x_1, at an edge. With it the surface of a ply (`plies.surface_kernels`) has no special case at its
sides. Forces on ghosts are handed back to the nodes that they follow from. A turn is (c, s), cosine
and sine of the angle from the first frame to that of a ply.
"""

import numpy as np

from shellfabric.cloth.membrane_kernels import ERODED
from shellfabric.cloth.nodal_force_kernels import (
    clear_window,
    give_impulses,
    half_step_work,
    include_rows,
    keep_symmetry,
)
from shellfabric.cloth.packing_kernels import is_fabric
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, broadcast, load, masked_store
from shellfabric.panel.motion_kernels import FAILURES
from shellfabric.state import unit

STRIDE, NI, NJ, MIRROR_X, MIRROR_Y = range(5)  # of contact.shape
TALL, WIDE = 4, 8  # elements of a tile of `plies.near_kernels`
BEFORE, BEHIND = 0, 1  # sides of a ply, of its forces


@kernel(_nrt=False, forceinline=True)
def turned(turn, x, y):
    """Components in the frame of a ply of a vector (x, y) of the first one's."""
    return turn[0] * x + turn[1] * y, turn[0] * y - turn[1] * x


@kernel(_nrt=False, forceinline=True)
def turned_back(turn, x, y):
    """Components in the frame of the first ply of a vector (x, y) of another's."""
    return turn[0] * x - turn[1] * y, turn[0] * y + turn[1] * x


@kernel(_nrt=False, forceinline=True)
def mean_thickness(contact, p, q):
    """[m] of plies p and q."""
    return 0.5 * (contact.thickness[p] + contact.thickness[q])


@unit()
def place(state, const, contact, p):
    """Places and velocities of the nodes of the active rows of ply p and of their ghosts; what of
    it is torn."""
    c = contact.turns[p, 0]
    s = contact.turns[p, 1]
    x = contact.x
    v = contact.v
    rest = contact.rest
    width = const.row_stride
    first = state.active_rows[0]
    last = state.active_rows[1]
    for i in range(first, last + 1):
        for j in range(0, width, WIDTH):
            k = i * width + j
            g = contact.base[p] + i * contact.shape[p, STRIDE] + j
            left = width - j
            u_x = load(state.u[0], k)
            u_y = load(state.u[1], k)
            v_x = load(state.v[0], k)
            v_y = load(state.v[1], k)
            masked_store(x[0], g, load(rest[0], g) + (c * u_x - s * u_y), left)
            masked_store(x[1], g, load(rest[1], g) + (c * u_y + s * u_x), left)
            masked_store(x[2], g, load(rest[2], g) + load(state.u[2], k), left)
            masked_store(v[0], g, c * v_x - s * v_y, left)
            masked_store(v[1], g, c * v_y + s * v_x, left)
            masked_store(v[2], g, load(state.v[2], k), left)
    place_ghosts(contact, x, p, first, last)
    place_ghosts(contact, v, p, first, last)
    contact.failures[p] = state.counter[FAILURES]
    if contact.failures[p] > 0:
        look_at_torn(state, const, contact, p)


@kernel(_nrt=False)
def place_ghosts(contact, x, p, first, last):
    """The ghosts of a vector x of the nodes of ply p, whose rows first .. last are new."""
    base = contact.base[p]
    stride = contact.shape[p, STRIDE]
    ni = contact.shape[p, NI]
    nj = contact.shape[p, NJ]
    for c in range(3):
        for i in range(first, last + 1):
            g = base + i * stride
            x[c, g - 1] = ghost(contact.shape[p, MIRROR_Y], c == 1, x[c, g], x[c, g + 1])
            x[c, g + nj + 1] = 2.0 * x[c, g + nj] - x[c, g + nj - 1]
        if first <= 1:
            for g in range(base - 1, base + nj + 2):
                x[c, g - stride] = ghost(
                    contact.shape[p, MIRROR_X], c == 0, x[c, g], x[c, g + stride]
                )
        if last >= ni - 1:
            for g in range(base + ni * stride - 1, base + ni * stride + nj + 2):
                x[c, g + stride] = 2.0 * x[c, g] - x[c, g - stride]


@kernel(_nrt=False, forceinline=True)
def ghost(mirrored, normal, at, inside):
    """A component of the ghost next to the node `at`, whose neighbour is `inside`; normal : to the
    mirror plane."""
    if mirrored:
        if normal:
            return -inside
        return inside
    return 2.0 * at - inside


@kernel(_nrt=False)
def look_at_torn(state, const, contact, p):
    """Mark the nodes of torn elements of ply p, and drop the elements that are no fabric any more:
    those without a yarn of either family, eroded ones, and those that join pieces which have
    parted."""
    for i in range(const.ni):
        for j in range(const.nj):
            k = np.uint64(i * const.row_stride + j)
            flag = state.element_flag[k]
            if flag == 0:
                continue
            g = contact.base[p] + i * contact.shape[p, STRIDE] + j
            stride = contact.shape[p, STRIDE]
            contact.torn[g] = contact.torn[g + 1] = contact.torn[g + stride] = contact.torn[
                g + stride + 1
            ] = 1
            if contact.dropped[g] or flag & ERODED or not is_fabric(state, const, k):
                contact.dropped[g] = 1
                contact.holes[
                    contact.first_tile[p] + i // TALL * contact.tiles_across[p] + j // WIDE
                ] = 1


@unit()
def hand_over(state, const, contact, p):
    """The forces on the grid of ply p, of plies before it and behind it, as nodal forces in its own
    frame; half a step's work of those of the last step, which are over, and half a step's of the
    new."""
    for side in range(2):
        force = contact.force[p, side]
        window = contact.window[p, side]
        contact.work[p] -= half_step_work(state, const, force, window, True)
        take_from_ghosts(contact, p, side)
        take_from_nodes(contact, p, side)
        keep_symmetry(const, force, window)
        contact.work[p] -= half_step_work(state, const, force, window, False)


@kernel(_nrt=False)
def take_from_ghosts(contact, p, side):
    """Hand the forces on ghosts to the nodes that they follow from, and widen the window of the
    grid to these."""
    f = contact.f[p, side]
    window = contact.grid_window[p, side]
    base = contact.base[p] - p * contact.slots
    stride = contact.shape[p, STRIDE]
    ni = contact.shape[p, NI]
    nj = contact.shape[p, NJ]
    if window[0] < 0:
        for g in range(base + window[2], base + window[3]):
            take_from_ghost(f, g - stride, stride, contact.shape[p, MIRROR_X], 0)
        window[0] = 0
        window[1] = max(window[1], 2)
    if window[1] > ni + 1:
        for g in range(base + window[2], base + window[3]):
            take_from_ghost(f, g + (ni + 1) * stride, -stride, False, 0)
        window[0] = min(window[0], ni - 1)
        window[1] = ni + 1
    if window[2] < 0:
        for i in range(window[0], window[1]):
            take_from_ghost(f, base + i * stride - 1, 1, contact.shape[p, MIRROR_Y], 1)
        window[2] = 0
        window[3] = max(window[3], 2)
    if window[3] > nj + 1:
        for i in range(window[0], window[1]):
            take_from_ghost(f, base + i * stride + nj + 1, -1, False, 1)
        window[2] = min(window[2], nj - 1)
        window[3] = nj + 1


@kernel(_nrt=False, forceinline=True)
def take_from_ghost(f, g, inwards, mirrored, normal):
    """Hand the force on ghost g to the nodes one and two steps inwards; the transpose of
    `ghost`."""
    for c in range(3):
        if mirrored:
            sign = 1.0
            if c == normal:
                sign = -1.0
            f[c, g + 2 * inwards] += sign * f[c, g]
        else:
            f[c, g + inwards] += 2.0 * f[c, g]
            f[c, g + 2 * inwards] -= f[c, g]
        f[c, g] = 0.0


@kernel(_nrt=False)
def take_from_nodes(contact, p, side):
    """Move the forces on the nodes of a grid to the nodal forces of the ply."""
    f = contact.f[p, side]
    force = contact.force[p, side]
    window = contact.grid_window[p, side]
    c = contact.turns[p, 0]
    s = contact.turns[p, 1]
    width = contact.shape[p, NJ] + 1
    stride = contact.shape[p, STRIDE]
    none = broadcast(0.0)
    for i in range(window[0], window[1]):
        for j in range(window[2], window[3], WIDTH):
            k = i * width + j
            g = contact.base[p] - p * contact.slots + i * stride + j
            left = window[3] - j
            f_x = load(f[0], g)
            f_y = load(f[1], g)
            masked_store(force[0], k, c * f_x + s * f_y, left)
            masked_store(force[1], k, c * f_y - s * f_x, left)
            masked_store(force[2], k, load(f[2], g), left)
            for axis in range(3):
                masked_store(f[axis], g, none, left)
    for m in range(4):
        contact.window[p, side, m] = window[m]
    clear_window(window, contact.shape[p, NI], width)


@unit("flag", force="3, n", window="4 int64")
def apply_impulses(state, const, force, window):
    """Give a ply the impulses of contact forces of others; widen its window of active rows to them.
    Whether there are any."""
    if window[1] <= window[0]:
        return False
    give_impulses(state, const, force, window)
    include_rows(state, const, window[0] - 4, window[1] + 3)
    return True
