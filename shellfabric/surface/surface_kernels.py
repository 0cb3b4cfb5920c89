"""The surface of a ply as all that touches it sees it, on its grid (`surface.grid_kernels`): of whole fabric
the biquadratic B-spline whose control points are the nodes (docs/theory-panel.md, eq. (2)). Of torn fabric
nodes may be adrift: other plies touch the bilinear facet of the element, the nose a surface that ends
where yarns end (`surface.torn_kernels`).

The foot of a point is the first of three by three nodes (number, numbers from row to row), and weights M
along both axes; forces are shared out by the same weights. Limited shares, "Packs: contact between plies":

    s_j = M_j t_j / sum(M t),    t_j = max(1 - D (n.v_j - u)+ / f, LEAST_PART)             (1)
    u : the larger velocity of both surfaces along the push f, and min(T, T') of their tilts,
    T = FARTHEST (|slope along a| + |slope along b|)      D : `plies.numerics.PlyContact`   (2)
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    fma,
    greater,
    load,
    maximum,
    minimum,
    shift_in_prev,
    store,
    where,
)
from shellfabric.surface.nodal_force_kernels import extend_window
from shellfabric.surface.vector_kernels import dot, nodal

FARTHEST = 1.5  # [elements] of the nodes of a foot from it
FAINT = 1e-3  # weight of a row below which slopes fade out
LEAST_PART = 1e-6  # of a share, so that a push always goes to some node


@kernel(_nrt=False, forceinline=True)
def quadratic_weights(r):
    """Compute the weights B of a node and its two neighbours, at r elements from it.

    They are at least 0 and their sum is 1: a point lies in the convex hull of its nodes, and fabric
    that is flat and even stays so.
    """
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
def part_left(speed, limit):
    """Compute the part t of its share that a node keeps, or eight, eq. (1).

    speed : [m/s] along the normal
    limit : sign of the push along the normal, the speed from which on a node runs ahead of it, D / f
        [s/m]
    """
    sign, of_push, drag = limit
    return maximum(1.0 - drag * maximum(sign * (speed - of_push), 0.0), LEAST_PART)


@kernel(_nrt=False, forceinline=True)
def speeds_row(v, k, n):
    """Compute the speeds along the normal n of three nodes from number k on."""
    return dot(n, nodal(v, k)), dot(n, nodal(v, k + 1)), dot(n, nodal(v, k + 2))


@kernel(_nrt=False, forceinline=True)
def speeds_at(v, at, n):
    """Compute the speeds along the normal n of the three by three nodes of `interpolate`, by
    rows."""
    k, s = at
    return speeds_row(v, k, n), speeds_row(v, k + s, n), speeds_row(v, k + 2 * s, n)


@kernel(_nrt=False, forceinline=True)
def share_out_limited(f, window, foot, speeds, push):
    """Share a push at a foot out to the nodes, whose window grows, by limited shares. Return the mean
    of the nodes' speeds [m/s] along the normal by these shares.

    The sum of the shares is 1, so that momentum is kept. Shares fall where velocities rise; by
    Chebyshev's inequality the power f sum((s - M) n.v) is then at most 0: energy is taken, never
    given. A push moves by less than an element, and with it the moment of a force. A node that runs
    ahead feels a damper of D M_j, stable with D dt / m < 2.

    f : on the grid of the foot; speeds : `speeds_at`
    push : its force, and what limits the shares (`part_left`)
    """
    i, j, (k, stride), wa, wb = foot
    force, limit = push
    extend_window(window, i, i + 3, j, j + 3)
    (low, middle, high), whole, mean = limited_shares((wa, wb), speeds, limit)
    for c in range(3):
        part = force[c] * whole
        for o in range(3):
            f[c][k + o] += part * low[o]
            f[c][k + stride + o] += part * middle[o]
            f[c][k + 2 * stride + o] += part * high[o]
    return mean


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


@kernel(_nrt=False, forceinline=True)
def speed8(v, k, n):
    """Compute the speeds along the normal n of eight nodes from number k on."""
    return fma(n[0], load(v[0], k), fma(n[1], load(v[1], k), n[2] * load(v[2], k)))


@kernel(_nrt=False, forceinline=True)
def speeds_row3(v, k, n):
    """Compute `speed8` of three nodes in a row."""
    return speed8(v, k, n), speed8(v, k + 1, n), speed8(v, k + 2, n)


@kernel(_nrt=False, forceinline=True)
def speeds_row4(v, k, n):
    """Compute `speed8` of four nodes in a row."""
    return speed8(v, k, n), speed8(v, k + 1, n), speed8(v, k + 2, n), speed8(v, k + 3, n)


@kernel(_nrt=False, forceinline=True)
def point_speeds8(v, at, n):
    """Compute the speeds along the normal of the three by three nodes of `point_mean8`, by rows."""
    k, s = at
    return speeds_row3(v, k, n), speeds_row3(v, k + s, n), speeds_row3(v, k + 2 * s, n)


@kernel(_nrt=False, forceinline=True)
def speeds8(v, at, n):
    """Compute the speeds along the normal of the four by four nodes of `interpolate8`, by rows."""
    k, s, tall = at
    none = broadcast(0.0)
    last = none, none, none, none
    if tall:
        last = speeds_row4(v, k + 3 * s, n)
    return speeds_row4(v, k, n), speeds_row4(v, k + s, n), speeds_row4(v, k + 2 * s, n), last


@kernel(_nrt=False, forceinline=True)
def mean_of_three(w, one, two, three):
    """Compute the mean of three numbers, or of three eights, by weights."""
    return fma(w[0], one, fma(w[1], two, w[2] * three))


@kernel(_nrt=False, forceinline=True)
def point_mean_speed(speeds, wa, wb):
    """Compute the mean of `speeds_at` or `point_speeds8` by the weights of the points."""
    one, two, three = speeds
    return mean_of_three(
        wa, mean_of_three(wb, *one), mean_of_three(wb, *two), mean_of_three(wb, *three)
    )


@kernel(_nrt=False, forceinline=True)
def mean_speed8(speeds, wa, wb):
    """Compute the mean of `speeds8` by the weights of the points."""
    one, two, three, four = speeds
    return weighted_sum(
        wa,
        weighted_sum(wb, *one),
        weighted_sum(wb, *two),
        weighted_sum(wb, *three),
        weighted_sum(wb, *four),
    )


@kernel(_nrt=False, forceinline=True)
def smaller_slope(one, two, three):
    """Compute the size of the smaller of the slopes from one to two and on to three, 0 if they
    differ in sign."""
    low = two - one
    high = three - two
    return maximum(maximum(minimum(low, high), 0.0 - maximum(low, high)), 0.0)


@kernel(_nrt=False, forceinline=True)
def slope_of_three(w, one, two, three):
    """Compute the slope of eq. (2) between three means, or three eights, of weights w.

    A slope is the smaller one of the two between three rows of nodes, 0 if these differ in sign, so
    that a tip has none; it fades out with the weight of the outer rows, so that no force jumps
    where a point passes on to other nodes.
    """
    seen = minimum(minimum(w[0], w[2]) / FAINT, 1.0)
    return seen * smaller_slope(one, two, three)


@kernel(_nrt=False, forceinline=True)
def slope_of_four(w, one, two, three, four):
    """Compute `slope_of_three` of those three of four eights that have weights."""
    first = slope_of_three((w[0], w[1], w[2]), one, two, three)
    return where(greater(w[0], 0.0), first, slope_of_three((w[1], w[2], w[3]), two, three, four))


@kernel(_nrt=False, forceinline=True)
def point_tilt(speeds, wa, wb):
    """Compute T [m/s], eq. (2), from `speeds_at` or `point_speeds8`."""
    one, two, three = speeds
    along_a = slope_of_three(
        wa, mean_of_three(wb, *one), mean_of_three(wb, *two), mean_of_three(wb, *three)
    )
    along_b = slope_of_three(
        wb,
        mean_of_three(wa, one[0], two[0], three[0]),
        mean_of_three(wa, one[1], two[1], three[1]),
        mean_of_three(wa, one[2], two[2], three[2]),
    )
    return FARTHEST * (along_a + along_b)


@kernel(_nrt=False, forceinline=True)
def tilt8(speeds, wa, wb):
    """Compute T [m/s], eq. (2), from `speeds8`."""
    one, two, three, four = speeds
    along_a = slope_of_four(
        wa,
        weighted_sum(wb, *one),
        weighted_sum(wb, *two),
        weighted_sum(wb, *three),
        weighted_sum(wb, *four),
    )
    along_b = slope_of_four(
        wb,
        weighted_sum(wa, one[0], two[0], three[0], four[0]),
        weighted_sum(wa, one[1], two[1], three[1], four[1]),
        weighted_sum(wa, one[2], two[2], three[2], four[2]),
        weighted_sum(wa, one[3], two[3], three[3], four[3]),
    )
    return FARTHEST * (along_a + along_b)


@kernel(_nrt=False, forceinline=True)
def shares_row3(w, wb, speeds, limit):
    """Compute M t of three nodes in a row of the weight w, and none of a fourth."""
    return (
        w * (wb[0] * part_left(speeds[0], limit)),
        w * (wb[1] * part_left(speeds[1], limit)),
        w * (wb[2] * part_left(speeds[2], limit)),
        0.0,
    )


@kernel(_nrt=False, forceinline=True)
def shares_row4(w, wb, speeds, limit):
    """Compute M t of four nodes in a row of the weight w."""
    return (
        w * (wb[0] * part_left(speeds[0], limit)),
        w * (wb[1] * part_left(speeds[1], limit)),
        w * (wb[2] * part_left(speeds[2], limit)),
        w * (wb[3] * part_left(speeds[3], limit)),
    )


@kernel(_nrt=False, forceinline=True)
def sum_row(row):
    """Sum the four numbers of a row."""
    return (row[0] + row[1]) + (row[2] + row[3])


@kernel(_nrt=False, forceinline=True)
def limited_shares(weights, speeds, limit):
    """Compute limited shares of three by three nodes, of one point or eight: M t by rows, the factor
    that makes their sum 1, and the mean of the speeds by these shares."""
    wa, wb = weights
    one, two, three = speeds
    low = shares_row3(wa[0], wb, one, limit)
    middle = shares_row3(wa[1], wb, two, limit)
    high = shares_row3(wa[2], wb, three, limit)
    whole = 1.0 / (sum_row(low) + sum_row(middle) + sum_row(high))
    sums = mean_of_three(low, *one) + mean_of_three(middle, *two) + mean_of_three(high, *three)
    return (low, middle, high), whole, whole * sums


@kernel(_nrt=False, forceinline=True)
def scatter_limited_to_points8(f, at, weights, speeds, push):
    """Share eight pushes out to the nodes of `point_mean8` by limited shares, as `share_out_limited`
    does. Return the mean of the nodes' speeds by these shares.

    speeds : `point_speeds8`; push : the forces, and what limits the shares (`part_left`)
    """
    k, s = at
    force, limit = push
    (low, middle, high), whole, mean = limited_shares(weights, speeds, limit)
    for c in range(3):
        part = force[c] * whole
        scatter_row8(f[c], k, part, low)
        scatter_row8(f[c], k + s, part, middle)
        scatter_row8(f[c], k + 2 * s, part, high)
    return mean


@kernel(_nrt=False, forceinline=True)
def scatter_limited8(f, at, weights, speeds, push):
    """Share eight pushes out to the nodes of `interpolate8` by limited shares, as
    `share_out_limited` does; speeds : `speeds8`."""
    k, s, tall = at
    wa, wb = weights
    force, limit = push
    low = shares_row4(wa[0], wb, speeds[0], limit)
    middle = shares_row4(wa[1], wb, speeds[1], limit)
    high = shares_row4(wa[2], wb, speeds[2], limit)
    total = sum_row(low) + sum_row(middle) + sum_row(high)
    none = broadcast(0.0)
    last = none, none, none, none
    if tall:
        last = shares_row4(wa[3], wb, speeds[3], limit)
        total = total + sum_row(last)
    whole = 1.0 / total
    for c in range(3):
        part = force[c] * whole
        scatter_row8(f[c], k, part, low)
        scatter_row8(f[c], k + s, part, middle)
        scatter_row8(f[c], k + 2 * s, part, high)
        if tall:
            scatter_row8(f[c], k + 3 * s, part, last)
