"""The contact window: the elements that the projectile can touch, their erosion, and what lies
ahead of the nose."""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.projectile import sdf_kernels
from shellfabric.state import ERODED, unit
from shellfabric.surface.grid_kernels import grid_of, place, turned
from shellfabric.surface.nodal_force_kernels import bounds, include_rows, set_window
from shellfabric.surface.surface_kernels import facet_foot, vector_of
from shellfabric.surface.vector_kernels import components, subtract

X, Y = 0, 1  # axes


@kernel()
def reachable_nodes(state, const):
    """Return the first and last row, and column, of the nodes that contact forces can reach: one
    beyond those of the elements."""
    i0, i1, j0, j1 = bounds(state.contact_window)
    return max(i0 - 1, 0), min(i1 + 1, const.ni), max(j0 - 1, 0), min(j1 + 1, const.nj)


@kernel(_nrt=False)
def place_near_nose(state, const):
    """Place the rows of nodes that the nose can push."""
    first, last, _, _ = reachable_nodes(state, const)
    place(state, const, first, last)


@kernel()
def move_window(state, const):
    """Move the contact window, state.contact_window, with a projectile that moves sideways.

    The body lies between its nose and the place where its axis is at const.body_depth below the
    panel; about that the window leaves const.draw_in_reach, by which fabric may be drawn in besides
    the body's own width, and what the edges have slipped. Nothing bounds how far a yarn that has
    failed is drawn in: then the window is the whole panel. Fabric from beyond would be found by the
    window's next row when it is an edge radius deep, on springs that nobody has squeezed. On a
    graded panel the window stays in the first zone, and so does the projectile
    (`PackSolver.guard_model`).
    """
    torn = False
    slip = 0.0
    # nothing bounds how far a failed yarn is drawn in
    for block in range(state.block_damage.size):
        torn = torn or state.block_damage[block] != 0
    for m in range(const.slip_node.size):
        slip = max(slip, abs(state.u[const.slip_axis[m]][const.slip_node[m]]))
    back = min(
        (state.projectile_position[2] + const.body_depth) / const.frame[2, 2],
        const.nose.length,
    )
    first_row, end_row, first_column, end_column = const.window_limits
    if not torn:
        lines = const.x0, const.dx, first_row, end_row
        first_row, end_row = elements_in_reach(state, const, X, back, slip, lines)
        lines = const.y0, const.dy, first_column, end_column
        first_column, end_column = elements_in_reach(state, const, Y, back, slip, lines)
    set_window(state.contact_window, first_row, end_row, first_column, end_column)
    include_rows(state, const, first_row - 2, end_row + 2)


@kernel()
def elements_in_reach(state, const, axis, back, slip, lines):
    """Return the first element along an axis that the body may touch, and the end.

    back : [m] along the projectile's axis, from its nose to the place that is furthest behind
    slip : [m] by which the edges have slipped
    lines : first grid line and its distance to the next [m], first element and end of the widest
        window
    """
    start, step, first, last = lines
    nose = state.projectile_position[axis]
    foot = state.projectile_position[axis] - back * const.frame[2, axis]
    low = min(nose, foot) - start
    high = max(nose, foot) - start
    low = low - const.draw_in_reach[axis] - slip
    high = high + const.draw_in_reach[axis] + slip
    begin = min(max(int(low / step), first), last)
    end = min(max(int(high / step) + 1, begin), last)
    return begin, end


@kernel()
def erode(state, const, i, j):
    """Apply the erosion criterion: all yarns of the element have failed, or those of one family and
    the gap that they left is wider than const.erosion_gap_ratio. Erosion is permanent."""
    k = np.uint64(i * const.row_stride + j)
    row = np.uint64(const.row_stride)
    one = np.uint64(1)
    if state.element_flag[k] & ERODED:
        return True
    warp = state.intact_fraction[0][k] + state.intact_fraction[0][k + one]
    weft = state.intact_fraction[1][k] + state.intact_fraction[1][k + row]
    a = 0.0
    b = 0.0
    for c in range(3):
        u = state.u[c]
        u0 = u[k]
        u1 = u[k + row]
        u2 = u[k + one]
        u3 = u[k + row + one]
        across = u1 - u0 + u3 - u2
        along = u2 - u0 + u3 - u1
        if c == 0:
            across += 2.0 * const.dx
        if c == 1:
            along += 2.0 * const.dy
        a += across * across
        b += along * along
    open1 = a > (2.0 * const.erosion_gap_ratio * const.dx) ** 2
    open2 = b > (2.0 * const.erosion_gap_ratio * const.dy) ** 2
    if (warp == 0.0 and (weft == 0.0 or open1)) or (weft == 0.0 and open2):
        state.element_flag[k] |= ERODED
        return True
    return False


@kernel()
def intact_at_point(state, const, k, place):
    """Compute the intact fraction at the place (s, t) in element k: the mean of the warp and the
    weft next to it."""
    s, t = place
    warp = state.intact_fraction[0]
    weft = state.intact_fraction[1]
    row = np.uint64(const.row_stride)
    if t < 0.5:
        near = warp[k]
    else:
        near = warp[k + np.uint64(1)]
    if s < 0.5:
        other = weft[k]
    else:
        other = weft[k + row]
    if t == 0.5:
        near = 0.5 * (warp[k] + warp[k + np.uint64(1)])
    if s == 0.5:
        other = 0.5 * (weft[k] + weft[k + row])
    return 0.5 * (near + other)


@unit("flag", later=True)
def cloth_ahead_of_nose(state, const):
    """Tell whether an element that is not eroded lies ahead of the shoulder, within the
    projectile's radius."""
    i0, i1, j0, j1 = bounds(state.contact_window)
    radius = sdf_kernels.reach(const)
    shoulder = sdf_kernels.shoulder_of(const)
    for i in range(i0, i1):
        for j in range(j0, j1):
            if state.element_flag[i * const.row_stride + j] & ERODED:
                continue
            middle = facet_foot(grid_of(const), (i, j), (i + 0.5, j + 0.5))
            p_x, p_y, p_z = from_nose(state, const, vector_of(state.surface.x, middle))
            if p_z > -shoulder and p_x * p_x + p_y * p_y < radius * radius:
                return True
    return False


@kernel()
def from_nose(state, const, x):
    """Turn a place of the surface into the frame of the projectile."""
    z = x[2] - state.surface.rest[2][grid_of(const)[0]]
    p_x, p_y = turned(state.surface.turn, x[0], x[1])
    return components(const.frame, subtract((p_x, p_y, z), state.projectile_position))
