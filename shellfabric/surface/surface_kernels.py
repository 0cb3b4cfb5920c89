"""The surface of a ply as all that touches it sees it, on its grid (`surface.grid_kernels`).

Whole fabric is the biquadratic B-spline whose control points are the nodes: with a the place along
the first axis in elements, i the nearest node and r = a - i, the weights of three nodes are

    B(i-1) = (1/2 - r)^2 / 2,    B(i) = 3/4 - r^2,    B(i+1) = (1/2 + r)^2 / 2

Its slope is continuous. Weights are at least 0 and their sum is 1, so that a point lies in the
convex hull of its nodes, and fabric that is flat and even is kept as it is. Its tangent plane goes
through the middle of every element with the slopes that the element has there.

Of torn fabric some of these nodes may be adrift. There other plies touch the bilinear facet of the
element itself, with the weights 1 - f, f and 0 at a = i + f; the nose a surface that ends where
yarns end (`surface.torn_kernels`).

The foot of a point is what its surface follows from: the row and column of the first of three by
three nodes, (number of that node, numbers from row to row), and weights along both axes. Forces are
shared out by the same weights: the transpose of the interpolation.
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, broadcast, fma, load, shift_in_prev, store, where
from shellfabric.surface.nodal_force_kernels import extend_window


@kernel(_nrt=False, forceinline=True)
def quadratic_weights(r):
    """Compute the weights B of a node and its two neighbours, at r elements from it."""
    low = 0.5 - r
    high = 0.5 + r
    return 0.5 * low * low, 0.75 - r * r, 0.5 * high * high


@kernel(_nrt=False, forceinline=True)
def spline_weights(a, n):
    """Compute the weights of three nodes of a line of n elements at the place a: (first node,
    values, slopes, second slopes)."""
    i = min(max(int(a + 0.5), 0), n)
    r = a - i
    return i - 1, quadratic_weights(r), (r - 0.5, -2.0 * r, 0.5 + r), (1.0, -2.0, 1.0)


@kernel(_nrt=False, forceinline=True)
def facet_weights(a, n):
    """Compute the weights of the bilinear facet at the place a, as `spline_weights` returns
    them."""
    i = min(max(math.floor(a), -1), n - 1)
    f = a - i
    return i, (1.0 - f, f, 0.0), (-1.0, 1.0, 0.0), (0.0, 0.0, 0.0)


@kernel(_nrt=False, forceinline=True)
def weights_at(is_facet, a, n):
    """Choose `facet_weights` or `spline_weights`."""
    if is_facet:
        return facet_weights(a, n)
    return spline_weights(a, n)


@kernel(_nrt=False, forceinline=True)
def foot_at(grid, is_facet, a, b):
    """Find the foot of the place (a, b) on a grid (base, stride, ni, nj)."""
    base, stride, ni, nj = grid
    i, wa, _, _ = weights_at(is_facet, a, ni)
    j, wb, _, _ = weights_at(is_facet, b, nj)
    return i, j, (base + i * stride + j, stride), wa, wb


@kernel(_nrt=False, forceinline=True)
def facet_foot(grid, facet, place):
    """Find the foot of a place (a, b) on the facet of element (i, j), or beside it."""
    base, stride, _, _ = grid
    i, j = facet
    f = place[0] - i
    g = place[1] - j
    return i, j, (base + i * stride + j, stride), (1.0 - f, f, 0.0), (1.0 - g, g, 0.0)


@kernel(_nrt=False, forceinline=True)
def vector_of(x, foot):
    """Interpolate the vector x of the nodes, such as their places, at a foot."""
    _, _, at, wa, wb = foot
    return vector_at(x, at, wa, wb)


@kernel(_nrt=False, forceinline=True)
def share_out(f, window, foot, force):
    """Share a force at a foot out to the nodes, whose window grows: the transpose of `vector_of`."""
    i, j, (k, stride), wa, wb = foot
    extend_window(window, i, i + 3, j, j + 3)
    for c in range(3):
        for m in range(3):
            for n in range(3):
                f[c][k + m * stride + n] += force[c] * wa[m] * wb[n]


@kernel(_nrt=False, forceinline=True)
def interpolate(x, at, wa, wb):
    """Sum wa wb x over three by three nodes; at : number of the first, and from row to row."""
    k, s = at
    m = k + s
    o = m + s
    low = wb[0] * x[k] + wb[1] * x[k + 1] + wb[2] * x[k + 2]
    middle = wb[0] * x[m] + wb[1] * x[m + 1] + wb[2] * x[m + 2]
    high = wb[0] * x[o] + wb[1] * x[o + 1] + wb[2] * x[o + 2]
    return wa[0] * low + wa[1] * middle + wa[2] * high


@kernel(_nrt=False, forceinline=True)
def vector_at(x, at, wa, wb):
    """Interpolate the three components of a vector, each by `interpolate`."""
    return (
        interpolate(x[0], at, wa, wb),
        interpolate(x[1], at, wa, wb),
        interpolate(x[2], at, wa, wb),
    )


@kernel(_nrt=False, forceinline=True)
def patch_at(x, grid, is_facet, a, b):
    """Evaluate the surface at the place (a, b) of a grid: its foot, place, slopes along a and b,
    and second slopes aa, ab and bb."""
    base, stride, ni, nj = grid
    i, wa, da, ca = weights_at(is_facet, a, ni)
    j, wb, db, cb = weights_at(is_facet, b, nj)
    at = base + i * stride + j, stride
    slopes = vector_at(x, at, da, wb), vector_at(x, at, wa, db)
    second = vector_at(x, at, ca, wb), vector_at(x, at, da, db), vector_at(x, at, wa, cb)
    return (i, j, at, wa, wb), vector_at(x, at, wa, wb), slopes, second


@kernel(_nrt=False, forceinline=True)
def spline_weights8(r, moved):
    """Compute `spline_weights` of eight points r from their nearest nodes, over four nodes: those
    of points that are `moved` are the last three, of the others the first three. Returns (values,
    slopes, second slopes)."""
    return (
        select_nodes(moved, *quadratic_weights(r)),
        select_nodes(moved, r - 0.5, -2.0 * r, 0.5 + r),
        select_nodes(moved, 1.0, -2.0, 1.0),
    )


@kernel(_nrt=False, forceinline=True)
def select_nodes(moved, a, b, c):
    """Select a, b, c and nothing; nothing, a, b and c where `moved`."""
    return where(moved, 0.0, a), where(moved, a, b), where(moved, b, c), where(moved, c, 0.0)


@kernel(forceinline=True)
def weighted_sum(w, a, b, c, d):
    """Compute w0 a + w1 b + w2 c + w3 d of eight points."""
    return fma(w[0], a, fma(w[1], b, fma(w[2], c, w[3] * d)))


@kernel(_nrt=False, forceinline=True)
def interpolate_row8(x, k, w):
    """Compute `weighted_sum` of four nodes from number k on; the next of eight points begins a node
    further."""
    return weighted_sum(w, load(x, k), load(x, k + 1), load(x, k + 2), load(x, k + 3))


@kernel(_nrt=False, forceinline=True)
def interpolate_rows8(x, at, w):
    """Compute `interpolate_row8` along each of four lines.

    at : number of the first node, numbers from line to line, and whether the fourth line counts,
        which it does if some points are `moved`
    """
    k, s, tall = at
    last = broadcast(0.0)
    if tall:
        last = interpolate_row8(x, k + 3 * s, w)
    return (
        interpolate_row8(x, k, w),
        interpolate_row8(x, k + s, w),
        interpolate_row8(x, k + 2 * s, w),
        last,
    )


@kernel(_nrt=False, forceinline=True)
def interpolate8(x, at, wa, wb):
    """Interpolate at eight points side by side, as `interpolate` does; their four by four nodes
    begin at the numbers k .. k + 7."""
    return weighted_sum(wa, *interpolate_rows8(x, at, wb))


@kernel(_nrt=False, forceinline=True)
def vector_at8(x, at, wa, wb):
    """Interpolate the three components of a vector, each by `interpolate8`."""
    return (
        interpolate8(x[0], at, wa, wb),
        interpolate8(x[1], at, wa, wb),
        interpolate8(x[2], at, wa, wb),
    )


@kernel(_nrt=False, forceinline=True)
def patch_component8(x, at, weights):
    """Compute (value, slope along a, slope along b) of a component; weights : values, slopes,
    second slopes along a and b."""
    (wa, da, _), (wb, db, _) = weights
    v = interpolate_rows8(x, at, wb)
    e = interpolate_rows8(x, at, db)
    return weighted_sum(wa, *v), weighted_sum(da, *v), weighted_sum(wa, *e)


@kernel(_nrt=False, forceinline=True)
def patch8(x, at, weights):
    """Compute (place, slope along a, slope along b) of eight surface points, each a vector."""
    x_0, x_a, x_b = patch_component8(x[0], at, weights)
    y_0, y_a, y_b = patch_component8(x[1], at, weights)
    z_0, z_a, z_b = patch_component8(x[2], at, weights)
    return (x_0, y_0, z_0), (x_a, y_a, z_a), (x_b, y_b, z_b)


@kernel(_nrt=False, forceinline=True)
def second_component8(x, at, weights):
    """Compute the second slopes (aa, ab, bb) of a component; weights as in `patch_component8`."""
    (wa, da, ca), (wb, db, cb) = weights
    v = interpolate_rows8(x, at, wb)
    e = interpolate_rows8(x, at, db)
    g = interpolate_rows8(x, at, cb)
    return weighted_sum(ca, *v), weighted_sum(da, *e), weighted_sum(wa, *g)


@kernel(_nrt=False, forceinline=True)
def second_slopes8(x, at, weights):
    """Compute the second slopes aa, ab, bb of eight surface points, each a vector."""
    x_aa, x_ab, x_bb = second_component8(x[0], at, weights)
    y_aa, y_ab, y_bb = second_component8(x[1], at, weights)
    z_aa, z_ab, z_bb = second_component8(x[2], at, weights)
    return (x_aa, y_aa, z_aa), (x_ab, y_ab, z_ab), (x_bb, y_bb, z_bb)


@kernel(_nrt=False, forceinline=True)
def scatter8(f, at, force, weights):
    """Share eight forces out to the nodes of `interpolate8`."""
    k, s, tall = at
    wa, wb = weights
    scatter_row8(f, k, force * wa[0], wb)
    scatter_row8(f, k + s, force * wa[1], wb)
    scatter_row8(f, k + 2 * s, force * wa[2], wb)
    if tall:
        scatter_row8(f, k + 3 * s, force * wa[3], wb)


@kernel(_nrt=False, forceinline=True)
def scatter_row8(f, k, force, w):
    """Share eight forces out to four nodes each, those of the next a node further: summed up in two
    registers."""
    none = broadcast(0.0)
    low = shift_in_prev(none, force * w[3])
    high = shift_in_prev(force * w[3], none)
    low = low + force * w[2]
    low, high = shift_in_prev(none, low), shift_in_prev(low, high)
    low = low + force * w[1]
    low, high = shift_in_prev(none, low), shift_in_prev(low, high)
    low = low + force * w[0]
    store(f, k, load(f, k) + low)
    store(f, k + WIDTH, load(f, k + WIDTH) + high)


@kernel(_nrt=False, forceinline=True)
def point_mean8(x, at, wa, wb):
    """Interpolate at eight points side by side, as `interpolate` does, if their weights of three by
    three nodes are alike."""
    k, s = at
    total = broadcast(0.0)
    for n in range(3):
        m = k + n
        row = fma(wa[0], load(x, m), fma(wa[1], load(x, m + s), wa[2] * load(x, m + 2 * s)))
        total = fma(wb[n], row, total)
    return total


@kernel(_nrt=False, forceinline=True)
def point_vector8(x, at, wa, wb):
    """Interpolate the three components of a vector, each by `point_mean8`."""
    return (
        point_mean8(x[0], at, wa, wb),
        point_mean8(x[1], at, wa, wb),
        point_mean8(x[2], at, wa, wb),
    )


@kernel(_nrt=False, forceinline=True)
def scatter_to_points8(f, at, force, weights):
    """Share eight forces out to the nodes of `point_mean8`."""
    k, s = at
    wa, wb = weights
    for m in range(3):
        scatter_row8(f, k + m * s, force * wa[m], wb)
