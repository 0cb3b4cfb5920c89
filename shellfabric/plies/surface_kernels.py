"""The surfaces of plies, as their contact sees them (`plies.pressure_kernels`), on the grids of
`plies.frame_kernels`.

Whole fabric is the biquadratic B-spline whose control points are the nodes. Its tangent plane turns
without a jump; it goes through the middle of every element with the slopes that the element has
there. With a the place along the first axis in elements, i the nearest node and r = a - i, the
weights of three nodes are

    B(i-1) = (1/2 - r)^2 / 2,    B(i) = 3/4 - r^2,    B(i+1) = (1/2 + r)^2 / 2

Of torn fabric some of these nodes may be adrift: there the surface is the bilinear facet of the
element itself, with the weights 1 - f, f and 0 at a = i + f.
"""

import math

from shellfabric.cloth.nodal_force_kernels import extend_window
from shellfabric.cloth.spline_kernels import quadratic_weights, weighted_sum
from shellfabric.cloth.vector_kernels import add_scaled, difference, dot, nodal, subtract
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, broadcast, fma, load, shift_in_prev, store, where
from shellfabric.plies.frame_kernels import NI, NJ, STRIDE

_SEARCHED = 1  # elements about a closest point among which it is looked for beside torn fabric


@kernel(_nrt=False, forceinline=True)
def spline_weights(a, n):
    """Weights of three nodes of a line of n elements at the place a: (first node, values, slopes,
    second slopes)."""
    i = min(max(int(a + 0.5), 0), n)
    r = a - i
    return i - 1, quadratic_weights(r), (r - 0.5, -2.0 * r, 0.5 + r), (1.0, -2.0, 1.0)


@kernel(_nrt=False, forceinline=True)
def facet_weights(a, n):
    """The same of the bilinear facet at the place a."""
    i = min(max(math.floor(a), -1), n - 1)
    f = a - i
    return i, (1.0 - f, f, 0.0), (-1.0, 1.0, 0.0), (0.0, 0.0, 0.0)


@kernel(_nrt=False, forceinline=True)
def weights_at(is_facet, a, n):
    """`facet_weights` or `spline_weights`."""
    if is_facet:
        return facet_weights(a, n)
    return spline_weights(a, n)


@kernel(_nrt=False, forceinline=True)
def foot_at(contact, p, torn, a, b):
    """The foot (row, column, number, weights along a and b) of ply p at the place (a, b): the first
    of the three by three nodes that shape the surface there, and the weights of these."""
    i, wa, _, _ = weights_at(torn, a, contact.shape[p, NI])
    j, wb, _, _ = weights_at(torn, b, contact.shape[p, NJ])
    return i, j, contact.base[p] + i * contact.shape[p, STRIDE] + j, wa, wb


@kernel(_nrt=False, forceinline=True)
def vector_of(contact, x, p, foot):
    """The vector x of the nodes, such as their places, at a foot of ply p."""
    _, _, k, wa, wb = foot
    return vector_at(x, (k, contact.shape[p, STRIDE]), wa, wb)


@kernel(_nrt=False, forceinline=True)
def share_out(contact, p, side, foot, force):
    """Share a force at a foot of ply p out to its nodes: the transpose of `vector_of`."""
    i, j, k, wa, wb = foot
    extend_window(contact.grid_window[p, side], i, i + 3, j, j + 3)
    f = contact.f[p, side]
    stride = contact.shape[p, STRIDE]
    k -= p * contact.slots
    for c in range(3):
        for m in range(3):
            for n in range(3):
                f[c, k + m * stride + n] += force[c] * wa[m] * wb[n]


@kernel(_nrt=False, forceinline=True)
def is_torn(contact, p, a, b):
    """Whether a torn element is among those that shape the spline of ply p at the place (a, b)."""
    if contact.failures[p] == 0:
        return False
    i = min(max(int(a + 0.5), 0), contact.shape[p, NI])
    j = min(max(int(b + 0.5), 0), contact.shape[p, NJ])
    return contact.torn[contact.base[p] + i * contact.shape[p, STRIDE] + j] != 0


@kernel(_nrt=False, forceinline=True)
def interpolate(x, at, wa, wb):
    """Sum of wa wb x over three by three nodes; at : number of the first, and from row to row."""
    k, s = at
    m = k + s
    o = m + s
    low = wb[0] * x[k] + wb[1] * x[k + 1] + wb[2] * x[k + 2]
    middle = wb[0] * x[m] + wb[1] * x[m + 1] + wb[2] * x[m + 2]
    high = wb[0] * x[o] + wb[1] * x[o + 1] + wb[2] * x[o + 2]
    return wa[0] * low + wa[1] * middle + wa[2] * high


@kernel(_nrt=False, forceinline=True)
def vector_at(x, at, wa, wb):
    """`interpolate` of the three components of a vector."""
    return (
        interpolate(x[0], at, wa, wb),
        interpolate(x[1], at, wa, wb),
        interpolate(x[2], at, wa, wb),
    )


@kernel(_nrt=False, forceinline=True)
def patch_at(contact, p, torn, a, b):
    """The surface of ply p at the place (a, b): its foot (`foot_at`), place, slopes along a and b,
    and second slopes aa, ab and bb."""
    i, wa, da, ca = weights_at(torn, a, contact.shape[p, NI])
    j, wb, db, cb = weights_at(torn, b, contact.shape[p, NJ])
    stride = contact.shape[p, STRIDE]
    k = contact.base[p] + i * stride + j
    at = k, stride
    x = contact.x
    slopes = vector_at(x, at, da, wb), vector_at(x, at, wa, db)
    second = vector_at(x, at, ca, wb), vector_at(x, at, da, db), vector_at(x, at, wa, cb)
    return (i, j, k, wa, wb), vector_at(x, at, wa, wb), slopes, second


@kernel(_nrt=False)
def nearest_place(contact, p, place, at):
    """Of the middles of the quarters of the elements about a place (a, b) that have not eroded, the
    place of that nearest to the point `at`; the place itself if there is none."""
    a, b = place
    ni = contact.shape[p, NI]
    nj = contact.shape[p, NJ]
    s = contact.shape[p, STRIDE]
    i0 = min(max(int(a), 0), ni - 1)
    j0 = min(max(int(b), 0), nj - 1)
    x = contact.x
    least = 1e30
    found_a = a
    found_b = b
    for i in range(max(i0 - _SEARCHED, 0), min(i0 + _SEARCHED + 1, ni)):
        for j in range(max(j0 - _SEARCHED, 0), min(j0 + _SEARCHED + 1, nj)):
            k = contact.base[p] + i * s + j
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


@kernel(_nrt=False, forceinline=True)
def spline_weights8(r, moved):
    """`spline_weights` of eight points r from their nearest nodes, over four nodes: those of points
    that are `moved` are the last three, of the others the first three. Returns (values, slopes,
    second slopes)."""
    return (
        select_nodes(moved, *quadratic_weights(r)),
        select_nodes(moved, r - 0.5, -2.0 * r, 0.5 + r),
        select_nodes(moved, 1.0, -2.0, 1.0),
    )


@kernel(_nrt=False, forceinline=True)
def select_nodes(moved, a, b, c):
    """a, b, c and nothing; nothing, a, b and c where `moved`."""
    return where(moved, 0.0, a), where(moved, a, b), where(moved, b, c), where(moved, c, 0.0)


@kernel(_nrt=False, forceinline=True)
def interpolate_row8(x, k, w):
    """`weighted_sum` of four nodes from number k on; the next of eight points begins a node
    further."""
    return weighted_sum(w, load(x, k), load(x, k + 1), load(x, k + 2), load(x, k + 3))


@kernel(_nrt=False, forceinline=True)
def interpolate_rows8(x, at, w):
    """`interpolate_row8` along each of four lines.

    at : number of the first node, numbers from line to line, whether the fourth counts: where some
        points are `moved`
    to it
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
    """`interpolate` of eight points side by side, whose four by four nodes begin at the numbers k
    .. k + 7."""
    return weighted_sum(wa, *interpolate_rows8(x, at, wb))


@kernel(_nrt=False, forceinline=True)
def vector_at8(x, at, wa, wb):
    """`interpolate8` of the three components of a vector."""
    return (
        interpolate8(x[0], at, wa, wb),
        interpolate8(x[1], at, wa, wb),
        interpolate8(x[2], at, wa, wb),
    )


@kernel(_nrt=False, forceinline=True)
def patch_component8(x, at, weights):
    """(value, slope along a, slope along b) of a component; weights : values, slopes, second slopes
    along a and b."""
    (wa, da, _), (wb, db, _) = weights
    v = interpolate_rows8(x, at, wb)
    e = interpolate_rows8(x, at, db)
    return weighted_sum(wa, *v), weighted_sum(da, *v), weighted_sum(wa, *e)


@kernel(_nrt=False, forceinline=True)
def patch8(x, at, weights):
    """(place, slope along a, slope along b) of eight surface points, each a vector."""
    x_0, x_a, x_b = patch_component8(x[0], at, weights)
    y_0, y_a, y_b = patch_component8(x[1], at, weights)
    z_0, z_a, z_b = patch_component8(x[2], at, weights)
    return (x_0, y_0, z_0), (x_a, y_a, z_a), (x_b, y_b, z_b)


@kernel(_nrt=False, forceinline=True)
def second_component8(x, at, weights):
    """Second slopes (aa, ab, bb) of a component; weights as of `patch_component8`."""
    (wa, da, ca), (wb, db, cb) = weights
    v = interpolate_rows8(x, at, wb)
    e = interpolate_rows8(x, at, db)
    g = interpolate_rows8(x, at, cb)
    return weighted_sum(ca, *v), weighted_sum(da, *e), weighted_sum(wa, *g)


@kernel(_nrt=False, forceinline=True)
def second_slopes8(x, at, weights):
    """Second slopes aa, ab, bb of eight surface points, each a vector."""
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
    """`interpolate` at eight points side by side whose weights of three by three nodes are
    alike."""
    k, s = at
    total = broadcast(0.0)
    for n in range(3):
        m = k + n
        row = fma(wa[0], load(x, m), fma(wa[1], load(x, m + s), wa[2] * load(x, m + 2 * s)))
        total = fma(wb[n], row, total)
    return total


@kernel(_nrt=False, forceinline=True)
def point_vector8(x, at, wa, wb):
    """`point_mean8` of the three components of a vector."""
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
