"""The nodes of a ply with a ring of ghosts about them: what nose, other plies and guard touch.

The arrays of a ply (`state.State`) are in its own frame: displacements, x along its first family. Here
positions and velocities are in the frame of the first ply, and node (i, j) has the number

    base + i stride + j,     i = -1 ... ni + 1,  j = -1 ... nj + 1

A ghost is the mirror image beyond a plane of symmetry, and goes straight on, 2 x_0 - x_1, at an edge, so
that the surface (`surface.surface_kernels`) has no special case at its sides. Forces on ghosts are handed
back to the nodes that they follow from. A turn is (c, s), cosine and sine from the first frame to a ply's.
"""

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, broadcast, load, masked_store
from shellfabric.state import unit
from shellfabric.surface.nodal_force_kernels import bounds, clear_window, keep_symmetry, set_window


@kernel(_nrt=False, forceinline=True)
def turned(turn, x, y):
    """Turn a vector (x, y) of the first ply's frame into the frame of a ply."""
    return turn[0] * x + turn[1] * y, turn[0] * y - turn[1] * x


@kernel(_nrt=False, forceinline=True)
def turned_back(turn, x, y):
    """Turn a vector (x, y) of another ply's frame back into the frame of the first ply."""
    return turn[0] * x - turn[1] * y, turn[0] * y + turn[1] * x


@kernel(_nrt=False, forceinline=True)
def grid_of(const):
    """Return the grid of a ply by itself: (base, stride, ni, nj)."""
    stride = const.row_stride + 2
    return stride + 1, stride, const.ni, const.nj


@unit()
def place(state, const, first, last):
    """Write positions and velocities of the node rows first .. last of a ply and of their ghosts to
    its grid."""
    surface = state.surface
    x = surface.x
    v = surface.v
    c = surface.turn[0]
    s = surface.turn[1]
    width = const.row_stride
    base, stride, _, _ = grid_of(const)
    for i in range(first, last + 1):
        for j in range(0, width, WIDTH):
            k = i * width + j
            g = base + i * stride + j
            left = width - j
            u_x = load(state.u[0], k)
            u_y = load(state.u[1], k)
            v_x = load(state.v[0], k)
            v_y = load(state.v[1], k)
            masked_store(x[0], g, load(surface.rest[0], g) + (c * u_x - s * u_y), left)
            masked_store(x[1], g, load(surface.rest[1], g) + (c * u_y + s * u_x), left)
            masked_store(x[2], g, load(surface.rest[2], g) + load(state.u[2], k), left)
            masked_store(v[0], g, c * v_x - s * v_y, left)
            masked_store(v[1], g, c * v_y + s * v_x, left)
            masked_store(v[2], g, load(state.v[2], k), left)
    place_ghosts(const, x, first, last)
    place_ghosts(const, v, first, last)


@kernel(_nrt=False)
def place_ghosts(const, x, first, last):
    """Place the ghosts of a vector x of the nodes of a ply, whose rows first .. last are new."""
    base, stride, ni, nj = grid_of(const)
    for c in range(3):
        line = x[c]
        for i in range(first, last + 1):
            g = base + i * stride
            line[g - 1] = ghost(const.mirror_y, c == 1, line[g], line[g + 1])
            line[g + nj + 1] = 2.0 * line[g + nj] - line[g + nj - 1]
        if first <= 1:
            for g in range(base - 1, base + nj + 2):
                line[g - stride] = ghost(const.mirror_x, c == 0, line[g], line[g + stride])
        if last >= ni - 1:
            for g in range(base + ni * stride - 1, base + ni * stride + nj + 2):
                line[g + stride] = 2.0 * line[g] - line[g - stride]


@kernel(_nrt=False, forceinline=True)
def ghost(mirrored, normal, at, inside):
    """Compute a component of the ghost next to the node `at`, whose neighbour is `inside`; normal :
    to the mirror plane."""
    if mirrored:
        if normal:
            return -inside
        return inside
    return 2.0 * at - inside


@kernel(_nrt=False)
def to_nodes(state, const, on_grid, on_nodes):
    """Move forces on the grid of a ply to its nodes, in its own frame.

    on_grid, on_nodes : forces and their window (`nodal_force_kernels`)
    """
    f, grid_window = on_grid
    force, window = on_nodes
    take_from_ghosts(const, f, grid_window)
    take_from_nodes(const, state.surface.turn, f, grid_window, force)
    first_row, end_row, first_column, end_column = bounds(grid_window)
    set_window(window, first_row, end_row, first_column, end_column)
    clear_window(grid_window, const.ni, const.row_stride)
    keep_symmetry(const, force, window)


@kernel(_nrt=False)
def take_from_ghosts(const, f, window):
    """Hand the forces on ghosts to the nodes that they follow from, and widen the window of the
    grid to these."""
    base, stride, ni, nj = grid_of(const)
    first_row, end_row, first_column, end_column = bounds(window)
    if first_row < 0:
        for g in range(base + first_column, base + end_column):
            take_from_ghost(f, g - stride, stride, const.mirror_x, 0)
        first_row = 0
        end_row = max(end_row, 2)
    if end_row > ni + 1:
        for g in range(base + first_column, base + end_column):
            take_from_ghost(f, g + (ni + 1) * stride, -stride, False, 0)
        first_row = min(first_row, ni - 1)
        end_row = ni + 1
    if first_column < 0:
        for i in range(first_row, end_row):
            take_from_ghost(f, base + i * stride - 1, 1, const.mirror_y, 1)
        first_column = 0
        end_column = max(end_column, 2)
    if end_column > nj + 1:
        for i in range(first_row, end_row):
            take_from_ghost(f, base + i * stride + nj + 1, -1, False, 1)
        first_column = min(first_column, nj - 1)
        end_column = nj + 1
    set_window(window, first_row, end_row, first_column, end_column)


@kernel(_nrt=False, forceinline=True)
def take_from_ghost(f, g, inwards, mirrored, normal):
    """Hand the force on ghost g to the nodes one and two steps inwards; the transpose of
    `ghost`."""
    for c in range(3):
        if mirrored:
            sign = 1.0
            if c == normal:
                sign = -1.0
            f[c][g + 2 * inwards] += sign * f[c][g]
        else:
            f[c][g + inwards] += 2.0 * f[c][g]
            f[c][g + 2 * inwards] -= f[c][g]
        f[c][g] = 0.0


@kernel(_nrt=False)
def take_from_nodes(const, turn, f, window, force):
    """Move the forces on the nodes of a window of the grid to the nodal forces of the ply."""
    base, stride, _, _ = grid_of(const)
    none = broadcast(0.0)
    first_row, end_row, first_column, end_column = bounds(window)
    for i in range(first_row, end_row):
        for j in range(first_column, end_column, WIDTH):
            k = i * const.row_stride + j
            g = base + i * stride + j
            left = end_column - j
            f_x, f_y = turned(turn, load(f[0], g), load(f[1], g))
            masked_store(force[0], k, f_x, left)
            masked_store(force[1], k, f_y, left)
            masked_store(force[2], k, load(f[2], g), left)
            for axis in range(3):
                masked_store(f[axis], g, none, left)
