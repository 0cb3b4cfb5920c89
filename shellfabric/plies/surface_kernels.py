"""The surfaces of plies, as their contact sees them (see `plies.contact_kernels`).

The fabric of a ply is the biquadratic B-spline whose control points are its nodes. Its tangent plane turns without a
jump; it goes through the middle of every element with the slopes that the element has there. With a the place along the
warp in elements, i the nearest node and r = a - i, the weights of three nodes are

    B(i-1) = (1/2 - r)^2 / 2,    B(i) = 3/4 - r^2,    B(i+1) = (1/2 + r)^2 / 2

Beyond a plane of symmetry stands the image of the first node, beyond any other edge the straight continuation. Where a
yarn next to the three by three nodes has failed, some of them may be adrift: there the surface is the bilinear facet of
the element itself (FACETS).
"""

import math

import numpy as np

from shellfabric.cloth.membrane_kernels import ERODED
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, broadcast, fma, load, shift_in_prev, store, where
from shellfabric.plies.graded_kernels import add_middle_offset, add_quarter_side_offset
from shellfabric.projectile.window_kernels import intact_at_point

ONE = np.uint64(1)
SMOOTH, FACETS, NODES = 0, 1, 2  # forms of a surface
_SEARCH_ELEMENTS = 2  # elements about a foot among which it is looked for


@kernel(_nrt=False, forceinline=True)
def point_number(fc, pair, i, j, m):
    """Number of the m-th point of element (i, j): the m-th points of the elements of a row are next to each other."""
    return (i * pair.points_per_side**2 + m) * fc.nj + j


@kernel(_nrt=False, forceinline=True)
def point_place(fc, pair, q):
    """Element of point number q, and its place (a, b) [elements]."""
    p = pair.points_per_side
    row, j = q // fc.nj, q % fc.nj
    i, m = row // p**2, row % p**2
    return i * fc.nj + j, i + (m // p + pair.point_offset) / p, j + (m % p + pair.point_offset) / p


@kernel(_nrt=False, forceinline=True)
def spline_weights(a, n, mirrored):
    """Weights of three nodes of a line at the place a: (first node, values, slopes, middle value and slope across).

    The last two belong to the displacement across a plane of symmetry, which its image has with the other sign.
    """
    i = min(max(int(a + 0.5), 0), n)
    r = a - i
    low, middle, high = 0.5 * (0.5 - r) * (0.5 - r), 0.75 - r * r, 0.5 * (0.5 + r) * (0.5 + r)
    fall, turn, rise = r - 0.5, -2.0 * r, r + 0.5
    if 0 < i < n:
        return i - 1, low, middle, high, fall, turn, rise, middle, turn
    if i == n:
        return n - 2, 0.0, low - high, middle + 2.0 * high, 0.0, fall - rise, turn + 2.0 * rise, low - high, fall - rise
    if mirrored:
        return 0, middle, high + low, 0.0, turn, rise + fall, 0.0, high - low, rise - fall
    return 0, middle + 2.0 * low, high - low, 0.0, turn + 2.0 * fall, rise - fall, 0.0, high - low, rise - fall


@kernel(_nrt=False, forceinline=True)
def form_weights(form, a, n, mirrored):
    """`spline_weights`, or its like for the naive forms, which have no images."""
    if form == SMOOTH:
        return spline_weights(a, n, mirrored)
    if a < 0.0:  # the image of the first element
        return 0, 1.0 + a, -a, 0.0, 1.0, -1.0, 0.0, a, 1.0
    i = min(int(a), n - 1)
    f, slope = a - i, 1.0
    if form == NODES:
        f, slope = math.floor(f + 0.5), 0.0
    if i < n - 1:
        return i, 1.0 - f, f, 0.0, -slope, slope, 0.0, f, slope
    return i - 1, 0.0, 1.0 - f, f, 0.0, -slope, slope, 1.0 - f, -slope


@kernel(_nrt=False, forceinline=True)
def second_derivatives(form, a, n, mirrored):
    """Second slopes of `form_weights`: of three nodes, and of the middle one across a plane of symmetry."""
    i = min(max(int(a + 0.5), 0), n)
    if form != SMOOTH or i == n or (i == 0 and not mirrored):
        return 0.0, 0.0, 0.0, 0.0
    if i == 0:
        return -2.0, 2.0, 0.0, 0.0
    return 1.0, -2.0, 1.0, -2.0


@kernel(_nrt=False, forceinline=True)
def interpolate(x, k, s, w0, w1, w2, z0, z1, z2):
    """Sum of w z x over three by three nodes from the slot k on."""
    s = np.uint64(s)
    m = k + s
    o = m + s
    a = z0 * x[k] + z1 * x[k + ONE] + z2 * x[k + ONE + ONE]
    b = z0 * x[m] + z1 * x[m + ONE] + z2 * x[m + ONE + ONE]
    c = z0 * x[o] + z1 * x[o + ONE] + z2 * x[o + ONE + ONE]
    return w0 * a + w1 * b + w2 * c


@kernel(_nrt=False, forceinline=True)
def scatter_weighted(F, k, s, f, w0, w1, w2, z0, z1, z2):
    """Share a force out to three by three nodes by their weights."""
    s = np.uint64(s)
    for w in (w0, w1, w2):
        F[k] += f * w * z0
        F[k + ONE] += f * w * z1
        F[k + ONE + ONE] += f * w * z2
        k += s


@kernel(_nrt=False, forceinline=True)
def surface_patch(x, k, s, wa, wb, da, db):
    """(value, slope along a, slope along b) of the surface over three by three nodes from the slot k on."""
    s = np.uint64(s)
    m = k + s
    o = m + s
    x00, x01, x02 = x[k], x[k + ONE], x[k + ONE + ONE]
    x10, x11, x12 = x[m], x[m + ONE], x[m + ONE + ONE]
    x20, x21, x22 = x[o], x[o + ONE], x[o + ONE + ONE]
    v0 = wb[0] * x00 + wb[1] * x01 + wb[2] * x02
    v1 = wb[0] * x10 + wb[1] * x11 + wb[2] * x12
    v2 = wb[0] * x20 + wb[1] * x21 + wb[2] * x22
    e0 = db[0] * x00 + db[1] * x01 + db[2] * x02
    e1 = db[0] * x10 + db[1] * x11 + db[2] * x12
    e2 = db[0] * x20 + db[1] * x21 + db[2] * x22
    return (
        wa[0] * v0 + wa[1] * v1 + wa[2] * v2,
        da[0] * v0 + da[1] * v1 + da[2] * v2,
        wa[0] * e0 + wa[1] * e1 + wa[2] * e2,
    )


@kernel(_nrt=False, forceinline=True)
def spline_weights8(r, moved):
    """`spline_weights` of eight points r from their nearest nodes, none of which is at an edge, over four nodes: those
    of points that are `moved` are the last three, of the others the first three. Returns (values, slopes, second
    slopes)."""
    low, high = 0.5 - r, 0.5 + r
    values = select_nodes(moved, 0.5 * low * low, 0.75 - r * r, 0.5 * high * high)
    return values, select_nodes(moved, 0.0 - low, -2.0 * r, high), select_nodes(moved, 1.0, -2.0, 1.0)


@kernel(_nrt=False, forceinline=True)
def select_nodes(moved, a, b, c):
    """a, b, c and nothing; nothing, a, b and c where `moved`."""
    return where(moved, 0.0, a), where(moved, a, b), where(moved, b, c), where(moved, c, 0.0)


@kernel(_nrt=False, forceinline=True)
def weighted_sum8(w, a, b, c, d):
    """w0 a + w1 b + w2 c + w3 d"""
    return fma(w[0], a, fma(w[1], b, fma(w[2], c, w[3] * d)))


@kernel(_nrt=False, forceinline=True)
def interpolate_row8(x, k, w):
    """`weighted_sum8` of four nodes from the slot k on; the next of eight points begins a slot further."""
    return weighted_sum8(w, load(x, k), load(x, k + 1), load(x, k + 2), load(x, k + 3))


@kernel(_nrt=False, forceinline=True)
def interpolate_rows8(x, k, s, w, tall):
    """`interpolate_row8` along each of four lines, of which the last counts where some points are `moved` to it:
    `tall`."""
    last = broadcast(0.0)
    if tall:
        last = interpolate_row8(x, k + 3 * s, w)
    return interpolate_row8(x, k, w), interpolate_row8(x, k + s, w), interpolate_row8(x, k + 2 * s, w), last


@kernel(_nrt=False, forceinline=True)
def surface_patch8(x, k, s, wa, wb, da, db, tall):
    """`surface_patch` of eight points side by side, whose four by four nodes begin at the slots k .. k + 7."""
    v, e = interpolate_rows8(x, k, s, wb, tall), interpolate_rows8(x, k, s, db, tall)
    return weighted_sum8(wa, *v), weighted_sum8(da, *v), weighted_sum8(wa, *e)


@kernel(_nrt=False, forceinline=True)
def second_derivatives8(x, k, s, wa, wb, da, db, ca, cb, tall):
    """Second slopes (aa, ab, bb) where `surface_patch8` is."""
    v, e, g = (
        interpolate_rows8(x, k, s, wb, tall),
        interpolate_rows8(x, k, s, db, tall),
        interpolate_rows8(x, k, s, cb, tall),
    )
    return weighted_sum8(ca, *v), weighted_sum8(da, *e), weighted_sum8(wa, *g)


@kernel(_nrt=False, forceinline=True)
def interpolate8(x, k, s, wa, wb, tall):
    """`interpolate` where `surface_patch8` is."""
    return weighted_sum8(wa, *interpolate_rows8(x, k, s, wb, tall))


@kernel(_nrt=False, forceinline=True)
def scatter_weighted8(F, k, s, f, wa, wb, tall):
    """`scatter_weighted` of eight forces where `surface_patch8` is."""
    scatter_row8(F, k, f * wa[0], wb)
    scatter_row8(F, k + s, f * wa[1], wb)
    scatter_row8(F, k + 2 * s, f * wa[2], wb)
    if tall:
        scatter_row8(F, k + 3 * s, f * wa[3], wb)


@kernel(_nrt=False, forceinline=True)
def scatter_row8(F, k, f, w):
    """Share eight forces out to four nodes each, those of the next a slot further: summed up in two registers."""
    none = broadcast(0.0)
    low, high = shift_in_prev(none, f * w[3]), shift_in_prev(f * w[3], none)
    low = low + f * w[2]
    low, high = shift_in_prev(none, low), shift_in_prev(low, high)
    low = low + f * w[1]
    low, high = shift_in_prev(none, low), shift_in_prev(low, high)
    low = low + f * w[0]
    store(F, k, load(F, k) + low)
    store(F, k + WIDTH, load(F, k + WIDTH) + high)


@kernel(_nrt=False, forceinline=True)
def scatter_to_points8(F, k, s, f, wa, wb):
    """Share eight forces out to three by three nodes each, by weights that are alike for all."""
    for m in range(3):
        scatter_row8(F, k + m * s, f * wa[m], wb)


@kernel(_nrt=False, forceinline=True)
def point_mean8(x, k, s, wa, wb):
    """`interpolate` at eight points side by side whose weights are alike."""
    total = broadcast(0.0)
    for n in range(3):
        row = fma(wa[0], load(x, k + n), fma(wa[1], load(x, k + s + n), wa[2] * load(x, k + 2 * s + n)))
        total = fma(wb[n], row, total)
    return total


@kernel(_nrt=False, forceinline=True)
def intact_fraction_at(state, const, a, b):
    """Part of the fabric that is left at the place (a, b)."""
    i, j = min(int(a), const.ni - 1), min(int(b), const.nj - 1)
    k = np.uint64(max(i, 0) * const.row_stride + max(j, 0))
    flag = state.element_flag[k]
    if flag == 0:
        return 1.0
    if flag & ERODED:
        return 0.0
    return intact_at_point(state, const, k, a - i, b - j)


@kernel(_nrt=False)
def intact_about(state, const, a, b):
    """Whether all yarns between the nodes that shape the spline at the place (a, b) are whole."""
    i, j = int(max(0.0, a + 0.5)), int(max(0.0, b + 0.5))  # in this order, 0 of a place that is not a number
    # of blocks within two rows of a failed yarn it is set
    if not state.block_damage[min(i, const.ni - 1) // const.rows_per_block]:
        return True
    for m in range(max(i - 1, 0), min(i, const.ni - 1) + 1):
        for n in range(max(j - 1, 0), min(j, const.nj - 1) + 1):
            if state.element_flag[m * const.row_stride + n]:
                return False
    return True


@kernel(_nrt=False)
def search_closest_point(state, const, foot, q, x, y, z, far):
    """Put the foot of point number q where the fabric about it is nearest to the point, if that is nearer than the foot
    that it has. x, y, z : [m] of the point, from the ply's first node at rest; far : [m] from point to foot."""
    i0, j0, least = int(foot[0][q]), int(foot[1][q]), 0.8 * far * far
    for i in range(max(i0 - _SEARCH_ELEMENTS, 0), min(i0 + _SEARCH_ELEMENTS + 1, const.ni)):
        for j in range(max(j0 - _SEARCH_ELEMENTS, 0), min(j0 + _SEARCH_ELEMENTS + 1, const.nj)):
            k = np.uint64(i * const.row_stride + j)
            if state.element_flag[k] & ERODED:
                continue
            u, v, w = state.u
            x_m, x_a, x_b = mean_and_quarter_sides(u, k, const.row_stride)
            y_m, y_a, y_b = mean_and_quarter_sides(v, k, const.row_stride)
            z_m, z_a, z_b = mean_and_quarter_sides(w, k, const.row_stride)
            x_m = add_middle_offset(x_m, const.line_offset1, i) + (i + 0.5) * const.dx
            y_m = add_middle_offset(y_m, const.line_offset2, j) + (j + 0.5) * const.dy
            x_a = add_quarter_side_offset(x_a, const.line_offset1, i) + 0.25 * const.dx
            y_b = add_quarter_side_offset(y_b, const.line_offset2, j) + 0.25 * const.dy
            for m in range(4):
                a, b = 2.0 * (m & 1) - 1.0, 2.0 * (m >> 1) - 1.0
                d_x, d_y, d_z = x - x_m - a * x_a - b * x_b, y - y_m - a * y_a - b * y_b, z - z_m - a * z_a - b * z_b
                square = d_x * d_x + d_y * d_y + d_z * d_z
                if square < least:
                    least = square
                    foot[0][q], foot[1][q] = i + 0.5 + 0.25 * a, j + 0.5 + 0.25 * b


@kernel(_nrt=False, forceinline=True)
def mean_and_quarter_sides(x, k, s):
    """The mean of the four nodes of the element at slot k, and a quarter of its mean sides along a and b."""
    m = k + np.uint64(s)
    x00, x01, x10, x11 = x[k], x[k + ONE], x[m], x[m + ONE]
    return 0.25 * (x00 + x01 + x10 + x11), 0.125 * (x10 + x11 - x00 - x01), 0.125 * (x01 + x11 - x00 - x10)
