"""The cloth as a smooth surface: quadratic B-splines whose control points are the nodes.

The surface about node (i, j), from half an element before it to half an element behind it along both families, is

    x(s, t) = sum_mn B_m(s) B_n(t) x(i + m, j + n),   m, n = -1, 0, 1,   -1/2 <= s, t <= 1/2
    B = (1/2 - s)^2 / 2,  3/4 - s^2,  (1/2 + s)^2 / 2

Its slope is continuous. Weights are at least 0 and their sum is 1, so that a point lies in the convex hull of its
nodes, and cloth that is flat and even is kept as it is. An element is a quarter each of the surfaces about its four
nodes.

Beyond a plane of symmetry nodes are mirror images. Where a yarn ends, at a border of the panel or where it has failed,
the node beyond is the one that goes straight on, 2 x(i) - x(i + 1), which makes B = (-s or 0), 1 - |s|, (s or 0): the
surface ends at the end of the yarn. So along either family it bends about a node if the yarn is whole on both sides of
it, and is straight otherwise; neither places nor forces are handed across a gap. At a corner of the nine nodes one may
be left that no yarn joins to the others: then it is straight along both, within the element's own four nodes.
"""

import numpy as np
from numba import njit

WARP, WEFT = 0, 1
OUTER = 15 / 64  # of the surface in an element: the most that it takes from nodes that are not the element's own


@njit(cache=True, error_model="numpy")
def seen(n, last, mirrored):
    """The line that line n is an image of, and the sign of the image; beyond a border the last, which has no weight."""
    if n < 0:
        return (-n, -1.0) if mirrored else (0, 1.0)
    return min(n, last), 1.0


@njit(cache=True, error_model="numpy")
def node(state, const, i, j, x, v):
    """Place of node (i, j) in the frame of the projectile, and its velocity relative to it, in that of the panel."""
    i, sign_x = seen(i, const.ni, const.mirror_x)
    j, sign_y = seen(j, const.nj, const.mirror_y)
    k = np.uint64(i * const.s + j)
    x[0] = sign_x * (const.x0 + i * const.dx + state.u[0][k]) - state.position[0]
    x[1] = sign_y * (const.y0 + j * const.dy + state.u[1][k]) - state.position[1]
    x[2] = state.u[2][k] - state.position[2]
    v[0] = sign_x * state.v[0][k] - state.speed[0]
    v[1] = sign_y * state.v[1][k] - state.speed[1]
    v[2] = state.v[2][k] - state.speed[2]
    if const.tilted:
        frame, x0, x1, x2 = const.frame, x[0], x[1], x[2]
        for c in range(3):
            x[c] = frame[c, 0] * x0 + frame[c, 1] * x1 + frame[c, 2] * x2


@njit(cache=True, error_model="numpy")
def weights(s, bent):
    """Of a node's neighbour, itself and its other neighbour, at s = -1/2 ... 1/2 elements from it."""
    if bent:
        return 0.5 * (0.5 - s) ** 2, 0.75 - s * s, 0.5 * (0.5 + s) ** 2
    return max(-s, 0.0), 1.0 - abs(s), max(s, 0.0)


@njit(cache=True, error_model="numpy")
def between(B, x, m):
    """Mean of the rows m, m + 1, m + 2 of x with the weights B."""
    return (
        B[0] * x[m, 0] + B[1] * x[m + 1, 0] + B[2] * x[m + 2, 0],
        B[0] * x[m, 1] + B[1] * x[m + 1, 1] + B[2] * x[m + 2, 1],
        B[0] * x[m, 2] + B[1] * x[m + 1, 2] + B[2] * x[m + 2, 2],
    )


@njit(cache=True, error_model="numpy")
def apart(x, R):
    """Whether an element lies ahead of the nose or beside the cylinder; x (16, 3): its nodes and those around it.

    Its surface is in the box of its own four nodes, made wider by OUTER of what the box of all sixteen is wider.
    """
    gap = 0.0
    for c in range(3):
        low, high = min(x[5, c], x[6, c], x[9, c], x[10, c]), max(x[5, c], x[6, c], x[9, c], x[10, c])
        lowest, highest = low, high
        for m in range(16):
            lowest, highest = min(lowest, x[m, c]), max(highest, x[m, c])
        low, high = low + OUTER * (lowest - low), high + OUTER * (highest - high)
        if c < 2:
            gap += max(low, -high, 0.0) ** 2
        elif low > 0.0:
            return True
    return gap > R * R


@njit(cache=True, error_model="numpy")
def untorn(state, const, i, j):
    """Whether element (i, j) is inside the panel and all yarns of it and its eight neighbours are whole."""
    if (i == 0 and not const.mirror_x) or (j == 0 and not const.mirror_y) or i + 1 == const.ni or j + 1 == const.nj:
        return False
    for m in range(max(i - 1, 0), i + 2):
        for n in range(max(j - 1, 0), j + 2):
            if state.flag[m * const.s + n]:
                return False
    return True


@njit(cache=True, error_model="numpy")
def bends(state, const, i, j, q, r):
    """Whether the surface about the corner (q, r) of element (i, j) bends along the warp and along the weft."""
    m, n = i + q, j + r
    along1 = runs(state, const, WARP, m - 1, n) and runs(state, const, WARP, m, n)
    along2 = runs(state, const, WEFT, m, n - 1) and runs(state, const, WEFT, m, n)
    for a in (-1, 1):
        for b in (-1, 1):
            own1, own2 = a == 1 - 2 * q, b == 1 - 2 * r
            if (own1 and own2) or not (own1 or along1) or not (own2 or along2):
                continue
            # what holds a node that is next to the corner along neither family
            held = runs(state, const, WARP, m + min(a, 0), n + b) or runs(state, const, WEFT, m + a, n + min(b, 0))
            if not held:
                return False, False
    return along1, along2


@njit(cache=True, error_model="numpy")
def runs(state, const, family, i, j):
    """Whether a yarn of a family is left on the edge that begins at node (i, j); beyond a border there is none."""
    if (i < 0 and not const.mirror_x) or (j < 0 and not const.mirror_y) or i > const.ni or j > const.nj:
        return False
    if i < 0:
        i = -1 - i if family == WARP else -i
    if j < 0:
        j = -1 - j if family == WEFT else -j
    return state.intact[family][np.uint64(i * const.s + j)] > 0.0
