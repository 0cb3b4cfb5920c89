"""The fabric as a smooth surface: quadratic B-splines whose control points are the nodes.

The surface about node (i, j), from half an element before it to half an element behind it along both families, is

    x(s, t) = sum_mn B_m(s) B_n(t) x(i + m, j + n),   m, n = -1, 0, 1,   -1/2 <= s, t <= 1/2
    B = (1/2 - s)^2 / 2,  3/4 - s^2,  (1/2 + s)^2 / 2

Its slope is continuous. Weights are at least 0 and their sum is 1, so that a point lies in the convex hull of its
nodes, and fabric that is flat and even is kept as it is. An element is a quarter each of the surfaces about its four
nodes.

Beyond a plane of symmetry nodes are mirror images. Where a yarn ends, at a border of the panel or where it has failed,
the node beyond is the one that goes straight on, 2 x(i) - x(i + 1), which makes B = (-s or 0), 1 - |s|, (s or 0): the
surface ends at the end of the yarn. So along either family it bends about a node if the yarn is whole on both sides of
it, and is straight otherwise; neither places nor forces are handed across a gap. At a corner of the nine nodes one may
be left that no yarn joins to the others: then it is straight along both, within the element's own four nodes.
"""

import numpy as np

from shellfabric.cloth.vector_kernels import column, dot, subtract
from shellfabric.jit.compile import entry, kernel
from shellfabric.jit.simd import fma, load
from shellfabric.state import unit

WARP, WEFT = 0, 1


@kernel()
def mirror_index(n, last, mirrored):
    """Index of the line that line n mirrors, and the sign; beyond an edge the last line, which has no weight."""
    if n < 0:
        if mirrored:
            return (-n, -1.0)
        return (0, 1.0)
    return min(n, last), 1.0


@kernel()
def node_position(state, const, i, j):
    """Position [m] of node (i, j) in the frame of the projectile."""
    i, sign_x = mirror_index(i, const.ni, const.mirror_x)
    j, sign_y = mirror_index(j, const.nj, const.mirror_y)
    k = np.uint64(i * const.row_stride + j)
    x = sign_x * (const.x0 + i * const.dx + state.u[0][k]) - state.projectile_position[0]
    y = sign_y * (const.y0 + j * const.dy + state.u[1][k]) - state.projectile_position[1]
    return to_projectile_frame(const, (x, y, state.u[2][k] - state.projectile_position[2]))


@kernel()
def to_projectile_frame(const, x):
    """A vector in the frame of the panel, in that of the projectile."""
    if not const.tilted:
        return x
    return dot(const.frame[0], x), dot(const.frame[1], x), dot(const.frame[2], x)


@kernel()
def relative_velocity(state, const, i, j):
    """Velocity of node (i, j) relative to the projectile, in the frame of the panel."""
    return subtract(nodal_vector(state.v, const, i, j), state.projectile_velocity)


@kernel()
def nodal_vector(x, const, i, j):
    """Nodal vector x of node (i, j), in the frame of the panel."""
    i, sign_x = mirror_index(i, const.ni, const.mirror_x)
    j, sign_y = mirror_index(j, const.nj, const.mirror_y)
    k = np.uint64(i * const.row_stride + j)
    return sign_x * x[0][k], sign_y * x[1][k], x[2][k]


@kernel()
def row_positions(state, const, i, first, last, x):
    """Positions [m] of the nodes (i, first) .. (i, last) in the frame of the projectile, into x (3, ...)."""
    row, sign = mirror_index(i, const.ni, const.mirror_x)
    start = const.x0 + row * const.dx
    shift = row * const.row_stride
    for j in range(max(first, 0), min(last, const.nj) + 1):
        k = np.uint64(shift + j)
        m = j - first
        x[0, m] = sign * (start + state.u[0][k]) - state.projectile_position[0]
        x[1, m] = const.y0 + j * const.dy + state.u[1][k] - state.projectile_position[1]
        x[2, m] = state.u[2][k] - state.projectile_position[2]
    if const.tilted:
        for m in range(max(-first, 0), min(last, const.nj) - first + 1):
            x[0, m], x[1, m], x[2, m] = to_projectile_frame(const, column(x, 0, m))
    for j in range(first, 0):
        x[0, j - first], x[1, j - first], x[2, j - first] = node_position(state, const, i, j)
    for j in range(const.nj + 1, last + 1):
        x[0, j - first], x[1, j - first], x[2, j - first] = node_position(state, const, i, j)


@kernel(_nrt=False, forceinline=True)
def quadratic_weights(r):
    """The weights B of a node and its two neighbours, at r elements from it."""
    low = 0.5 - r
    high = 0.5 + r
    return 0.5 * low * low, 0.75 - r * r, 0.5 * high * high


@kernel()
def node_weights(s, quadratic):
    """Spline weights of a node and its two neighbours, at s = -1/2 ... 1/2 elements from it; `quadratic` or linear."""
    if quadratic:
        return quadratic_weights(s)
    return max(-s, 0.0), 1.0 - abs(s), max(s, 0.0)


@entry()
def shape_functions(p, room):
    """Shape functions at the p x p points of an element, s slowest: (2, 8, room), linear, then quadratic.

    Rows 0-3 are of the four nodes about it along the warp, rows 4-7 along the weft; a point's weight for one of the
    sixteen nodes is a product of two. Points beyond p x p have none.
    """
    found = np.zeros((2, 8, room))
    for quadratic in range(2):
        for a in range(p):
            s = (a + 0.5) / p
            q = quadrant(a, p)
            three = node_weights(s - q, quadratic == 1)
            for m in range(3):
                for b in range(p):
                    found[quadratic, q + m, a * p + b] = three[m]
                    found[quadratic, 4 + q + m, b * p + a] = three[m]
    return found


@kernel()
def quadrant(a, p):
    """Whether the nearer node of point number a of p along an element is the one behind (0) or before it (1)."""
    if 2 * a < p:
        return 0
    return 1


@unit(later=True, found="8, points")
def torn_shape_functions(state, const, i, j, found):
    """Shape functions of an element (i, j) in which yarns may end, into found (8, room).

    Each point has those of the corner next to it; one midway between two corners, their mean.
    """
    p = const.points_per_side
    # points before the middle, and with one that is on it
    low = p // 2
    high = (p + 1) // 2
    found[:, : p * p] = 0.0
    for q in range(2):
        for r in range(2):
            quadratic1, quadratic2 = quadratic_directions(state, const, i, j, q, r)
            warp = const.shape_functions[1 if quadratic1 else 0]
            weft = const.shape_functions[1 if quadratic2 else 0]
            for a in range(q * low, high + q * low):
                for b in range(r * low, high + r * low):
                    k = a * p + b
                    part = 1.0
                    if low < high:
                        part = (0.5 if a == low else 1.0) * (0.5 if b == low else 1.0)
                    for m in range(4):
                        found[m, k] += part * warp[m, k]
                        found[4 + m, k] += part * weft[4 + m, k]


@kernel(forceinline=True)
def interpolate(shares, k, x):
    """Interpolate nodal values x (16, 3) at the eight points k .. k + 7: three components."""
    along = load_shape_functions(shares, 0, k)
    across = load_shape_functions(shares, 4, k)
    return (
        interpolate_component(along, across, x, 0),
        interpolate_component(along, across, x, 1),
        interpolate_component(along, across, x, 2),
    )


@kernel(forceinline=True)
def load_shape_functions(shares, row, k):
    """Load four rows of the shape functions of eight points."""
    return (
        load(shares[row], k),
        load(shares[row + 1], k),
        load(shares[row + 2], k),
        load(shares[row + 3], k),
    )


@kernel(forceinline=True)
def interpolate_component(a, b, x, c):
    """Interpolate component c at eight points."""
    y0 = weighted_sum(a, x[0, c], x[4, c], x[8, c], x[12, c])
    y1 = weighted_sum(a, x[1, c], x[5, c], x[9, c], x[13, c])
    y2 = weighted_sum(a, x[2, c], x[6, c], x[10, c], x[14, c])
    y3 = weighted_sum(a, x[3, c], x[7, c], x[11, c], x[15, c])
    return weighted_sum(b, y0, y1, y2, y3)


@kernel(forceinline=True)
def weighted_sum(w, a, b, c, d):
    """w0 a + w1 b + w2 c + w3 d of eight points."""
    return fma(w[0], a, fma(w[1], b, fma(w[2], c, w[3] * d)))


@kernel(forceinline=True)
def scatter_force(shares, k, push, force):
    """Scatter the force on point k to the sixteen nodes, push (3, 16) [N]."""
    for m in range(4):
        for n in range(4):
            weight = shares[m, k] * shares[4 + n, k]
            for c in range(3):
                push[c, 4 * m + n] += weight * force[c]


@kernel()
def column_boxes(lines, count, low, high):
    """Bounding box of the four nodes in each column of the lines (4, 3, count): its ends, (3, count) each."""
    for c in range(3):
        x0 = lines[0, c]
        x1 = lines[1, c]
        x2 = lines[2, c]
        x3 = lines[3, c]
        below = low[c]
        above = high[c]
        for m in range(count):
            below[m] = min(min(x0[m], x1[m]), min(x2[m], x3[m]))
            above[m] = max(max(x0[m], x1[m]), max(x2[m], x3[m]))


@kernel()
def box_misses_nose(low, high, m, R):
    """Whether the box of the columns m .. m + 3, in which the surface of an element lies, is ahead of the nose or
    beside the cylinder."""
    if min(min(low[2, m], low[2, m + 1]), min(low[2, m + 2], low[2, m + 3])) > 0.0:
        return True
    gap = 0.0
    for c in range(2):
        least = min(min(low[c, m], low[c, m + 1]), min(low[c, m + 2], low[c, m + 3]))
        most = max(max(high[c, m], high[c, m + 1]), max(high[c, m + 2], high[c, m + 3]))
        gap += max(max(least, -most), 0.0) ** 2
    return gap > R * R


@kernel()
def neighbourhood_intact(state, const, i, j):
    """Whether element (i, j) is inside the panel and all yarns of it and its eight neighbours are whole."""
    if (
        (i == 0 and not const.mirror_x)
        or (j == 0 and not const.mirror_y)
        or i + 1 == const.ni
        or j + 1 == const.nj
    ):
        return False
    for m in range(max(i - 1, 0), i + 2):
        for n in range(max(j - 1, 0), j + 2):
            if state.element_flag[m * const.row_stride + n]:
                return False
    return True


@kernel()
def quadratic_directions(state, const, i, j, q, r):
    """Whether the surface about the corner (q, r) of element (i, j) is quadratic along the warp and along the weft."""
    m = i + q
    n = j + r
    along1 = edge_intact(state, const, WARP, m - 1, n) and edge_intact(state, const, WARP, m, n)
    along2 = edge_intact(state, const, WEFT, m, n - 1) and edge_intact(state, const, WEFT, m, n)
    for a in (-1, 1):
        for b in (-1, 1):
            own1 = a == 1 - 2 * q
            own2 = b == 1 - 2 * r
            if (own1 and own2) or not (own1 or along1) or not (own2 or along2):
                continue
            # what holds a node that is next to the corner along neither family
            held = edge_intact(state, const, WARP, m + min(a, 0), n + b) or edge_intact(
                state, const, WEFT, m + a, n + min(b, 0)
            )
            if not held:
                return False, False
    return along1, along2


@kernel()
def edge_intact(state, const, family, i, j):
    """Whether the edge that begins at node (i, j) has an intact yarn; beyond an edge of the panel there is none."""
    if (
        (i < 0 and not const.mirror_x)
        or (j < 0 and not const.mirror_y)
        or i > const.ni
        or j > const.nj
    ):
        return False
    if i < 0:
        if family == WARP:
            i = -1 - i
        else:
            i = -i
    if j < 0:
        if family == WEFT:
            j = -1 - j
        else:
            j = -j
    return state.intact_fraction[family][np.uint64(i * const.row_stride + j)] > 0.0
