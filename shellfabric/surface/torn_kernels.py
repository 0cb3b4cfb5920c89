"""The surface of torn fabric as the nose sees it: it ends where yarns end. About node (i, j), from half an
element before it to half an element behind it along both families, it is

    x(s, t) = sum_mn B_m(s) B_n(t) x(i + m, j + n),   m, n = -1, 0, 1,   -1/2 <= s, t <= 1/2

with the B of `surface.surface_kernels`. Where a yarn has failed, the node beyond goes straight on, which
makes B = (-s or 0), 1 - |s|, (s or 0): along either family it bends about a node if the yarn is whole on
both sides, and is straight otherwise; nothing is handed across a gap. Where no yarn joins one of the nine
nodes to the others it is straight along both, within the element's own four nodes. An element is a quarter
each of the surfaces about its four nodes; its `bent` are eight bits, two of each of its corners (q, r).
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.state import WARP, WEFT, unit
from shellfabric.surface.grid_kernels import grid_of
from shellfabric.surface.surface_kernels import quadratic_weights

WHOLE = 255  # of `bent`


@kernel()
def node_weights(s, bends):
    """Compute the weights of a node and its two neighbours, at s = -1/2 ... 1/2 elements from
    it."""
    if bends:
        return quadratic_weights(s)
    return max(-s, 0.0), 1.0 - abs(s), max(s, 0.0)


@kernel()
def corner_weights(bent, corner, family, s):
    """Compute `node_weights` about a corner (q, r) of an element along a family."""
    q, r = corner
    return node_weights(s, bent >> (4 * q + 2 * r + family) & 1 == 1)


@kernel()
def mean_weights(one, other):
    """Average two sets of three weights."""
    return 0.5 * (one[0] + other[0]), 0.5 * (one[1] + other[1]), 0.5 * (one[2] + other[2])


@kernel()
def torn_foot(const, bent, element, point):
    """Find the foot (`surface_kernels`) of a point (a, b) of those of an element (i, j) in which
    yarns may end.

    It is of the corner next to the point; midway between two corners it is the mean of both, whose
    weights differ along the line between them alone.
    """
    i, j = element
    a, b = point
    per = const.points_per_side
    q = int(2 * a >= per)
    r = int(2 * b >= per)
    s = (a + 0.5) / per - q
    t = (b + 0.5) / per - r
    wa = corner_weights(bent, (q, r), WARP, s)
    wb = corner_weights(bent, (q, r), WEFT, t)
    if 2 * a + 1 == per:
        wb = mean_weights(wb, corner_weights(bent, (1 - q, r), WEFT, t))
    if 2 * b + 1 == per:
        wa = mean_weights(wa, corner_weights(bent, (q, 1 - r), WARP, s))
    base, stride, _, _ = grid_of(const)
    i += q - 1
    j += r - 1
    return i, j, (base + i * stride + j, stride), wa, wb


@kernel()
def bent_corners(state, const, i, j):
    """Find `bent` of element (i, j)."""
    if neighbourhood_intact(state, const, i, j):
        return WHOLE
    return bent_beside_failures(state, const, i, j)


@unit("integer", later=True)
def bent_beside_failures(state, const, i, j):
    """Find `bent` of an element beside which yarns have failed."""
    bent = 0
    for q in range(2):
        for r in range(2):
            along1, along2 = quadratic_directions(state, const, (i, j), (q, r))
            bent |= (int(along1) + 2 * int(along2)) << (4 * q + 2 * r)
    return bent


@kernel()
def neighbourhood_intact(state, const, i, j):
    """Tell whether all yarns of element (i, j) and of its eight neighbours are whole."""
    for m in range(max(i - 1, 0), min(i + 2, const.ni)):
        for n in range(max(j - 1, 0), min(j + 2, const.nj)):
            if state.element_flag[m * const.row_stride + n]:
                return False
    return True


@kernel()
def quadratic_directions(state, const, element, corner):
    """Tell whether the surface about a corner (q, r) of an element bends along the warp and the
    weft."""
    q, r = corner
    m = element[0] + q
    n = element[1] + r
    along1 = runs_through(state, const, WARP, (m, n))
    along2 = runs_through(state, const, WEFT, (m, n))
    for a in (-1, 1):
        for b in (-1, 1):
            own1 = a == 1 - 2 * q
            own2 = b == 1 - 2 * r
            if (own1 and own2) or not (own1 or along1) or not (own2 or along2):
                continue
            # what holds a node that is next to the corner along neither family
            if edge_intact(state, const, WARP, (m + min(a, 0), n + b)):
                continue
            if not edge_intact(state, const, WEFT, (m + a, n + min(b, 0))):
                return False, False
    return along1, along2


@kernel()
def runs_through(state, const, family, node):
    """Tell whether the yarns of a family are whole on both sides of a node."""
    i, j = node
    before = i, j - 1
    if family == WARP:
        before = i - 1, j
    return edge_intact(state, const, family, before) and edge_intact(state, const, family, node)


@kernel()
def edge_intact(state, const, family, node):
    """Tell whether the edge that begins at a node has an intact yarn; beyond the panel there is
    none."""
    i, j = node
    if (
        (i < 0 and not const.mirror_x)
        or (j < 0 and not const.mirror_y)
        or i > const.ni
        or j > const.nj
    ):
        return False
    # the edge from -1 to 0 mirrors that from 0 to 1
    if i < 0:
        i = -i - int(family == WARP)
    if j < 0:
        j = -j - int(family == WEFT)
    return state.intact_fraction[family][np.uint64(i * const.row_stride + j)] > 0.0
