"""The fabric: yarn segments along the grid lines, crossovers at the nodes, trellis in between; total Lagrangian.

Displacements, not positions, are stored, so that cloth at rest is exactly at rest. Lines j = const are warp, lines
i = const weft. The edge from a node to the next one along its line is a segment of yarn with the stretch

    Lambda1 = |dX + u(i+1, j) - u(i, j)| / |dX|   (warp),      Lambda2 likewise from u(i, j+1) - u(i, j)   (weft)

so that neighbouring yarns are told apart, and no in-plane motion of the nodes is without force. The crossovers of a
segment see its own stretch and the mean <> of the four segments of the other family that meet its two ends. With the
cell of `crossover_kernels`

    equilibrium form   T1 = T1(Lambda1, <Lambda2>),   T2 = T2(<Lambda1>, Lambda2)           forces along the segments
    variational form   E = 1/2 sum_warp n W(Lambda1, <Lambda2>) + 1/2 sum_weft n W(<Lambda1>, Lambda2)

n being the crossovers that a segment stands for: half of a segment's on lines that bound the panel. The variational
forces are the exact gradient of E. The trellis (eq. 4-35 as a total, odd function, erratum E-11) has one point in each
quadrilateral: a, b being the means of its two warp and two weft edges, sin(gamma) = a.b / <Lambda1><Lambda2> of these.

Cloth drawn together. Forces that turn an edge grow as its inverse length, and the stiffness of the trellis as its
inverse square: an edge that is drawn to nothing, as at a free side or beside failed yarns, would be beyond any time
step. So below the stretch c = SHORT, f(Lambda) stands for Lambda in sin(gamma), and the trellis fades out with it:

    f(Lambda) = c / 2 + Lambda^2 / 2 c,     sin(gamma) = a.b / f(<Lambda1>) f(<Lambda2>)

It goes on from Lambda with its slope. c is such that cloth that has locked stays within the time step of `panel` in
whatever way it is drawn together. The trellis alone adds G2 t (1 / f1^2 + 1 / f2^2) / 4 to the D of that bound, and a
locked one has 2 G2 t = D (eq. 4-49). As it fades out it unlocks: with both stretches at 0.3 the sine is 0.4 at most,
near the locking angles of the fabrics, and f = 0.46 makes the sum 1.2 D, what a Courant factor of 0.9 leaves: 1 /
0.9^2.

Graded panels. Lines may lie closer together in some places than in others, and each stands for the yarns up to halfway
to its neighbours. All above holds, if of the pieces of a crossing line before and behind a node each counts in the mean
<> by its length. The mean is its own transpose then: the force that crossing segments give to one is their mean, with
the same weights. What one float says of a uniform panel (the inverse side of an element, that weight, the volume of its
trellis, the viscosity) is an array of slots of a graded one, and numba makes two programs of these kernels
(`load_or_broadcast`).

Where yarns have failed. Segment e keeps the part alpha_e of its yarns; kappa_e = mean of alpha over the four crossing
segments is the part of it that is still crossed. Means are weighted by alpha, and the rest is alone (erratum E-14):

    N_e = kappa_e N(Lambda_e, <Lambda>_e) + (1 - kappa_e) T_alone(Lambda_e),     force alpha_e N_e

How it is made fast. Arrays are flat, by component, a row of s = nj + 1 slots for each i; node (i, j), the warp edge to
(i+1, j), the weft edge to (i, j+1) and the quadrilateral beside both share the slot k = i s + j. Weft edges and
quadrilaterals leave the last slot of a row idle. An element row - the warp edges and quadrilaterals between two node
rows, and the weft edges of the lower one - adds to the node row below it and above it. Node rows between two blocks
have two places for this, g0 and g1, all others one: nothing is written twice, and the result does not depend on the
order of the blocks. Every loop below runs over a block of rows and does all that can be done to its slots at once,
eight of them at a time (`simd`). Scratch may be overrun by up to seven slots, the panel's arrays may not. Scratch
begins two rows before the block's first: one is idle, one repeats the last row of the block before, and another follows
the block's last.
"""

import math

import numpy as np
from numba import types
from numba.extending import overload

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    broadcast,
    copysign,
    fabs,
    floor,
    fma,
    gather8_indexed,
    gather_rows4,
    greater,
    head_mask,
    load,
    load_or_broadcast,
    masked_store,
    maximum,
    minimum,
    reduce_add,
    reduce_max,
    rsqrt,
    shift_in_next,
    shift_in_prev,
    sqrt,
    store,
    store_int32,
    to_int32,
    where,
)

ONE = np.uint64(1)
FADE_STRETCH = 0.8  # stretch below which the trellis fades out
WARP_FAILED, WEFT_FAILED, ERODED = 1, 2, 4
# P(z) of asin(x) = x + x z P(z), z = x^2 <= 1/4: interpolated at Chebyshev points, to 1e-13
_Z = 0.125 * (1 - np.cos(np.pi * (np.arange(12) + 0.5) / 12))
_P = (np.arcsin(np.sqrt(_Z)) / np.sqrt(_Z) - 1) / _Z
ARCSINE = tuple(np.polynomial.Polynomial.fit(_Z, _P, 11).convert().coef)


def mean_crossing_warp(split, k, a, b, c, d):
    """Weighted mean over the four weft edges that cross a warp edge; a and c lie before its nodes, b and d behind."""


@overload(mean_crossing_warp, inline="always")
def _mean_crossing_warp(split, k, a, b, c, d):
    if isinstance(split, types.Float):
        return lambda split, k, a, b, c, d: 0.25 * ((a + b) + (c + d))

    def weighted(split, k, a, b, c, d):
        before = load(split, k)
        behind = 1.0 - before
        return 0.5 * (fma(before, a, behind * b) + fma(before, c, behind * d))

    return weighted


def mean_crossing_weft(split, k, a, b, c, d):
    """Weighted mean over the four warp edges that cross a weft edge; a and b lie before the line, c and d behind."""


@overload(mean_crossing_weft, inline="always")
def _mean_crossing_weft(split, k, a, b, c, d):
    if isinstance(split, types.Float):
        return lambda split, k, a, b, c, d: 0.25 * ((a + b) + (c + d))

    def weighted(split, k, a, b, c, d):
        before = load(split, k)
        return 0.5 * fma(before, a + b, (1.0 - before) * (c + d))

    return weighted


def scale_terms(factor, k, x):
    """x times the factor of each slot, if it is an array: applied before a sum; see `scale_sum`."""


@overload(scale_terms, inline="always")
def _scale_terms(factor, k, x):
    if isinstance(factor, types.Float):
        return lambda factor, k, x: x
    return lambda factor, k, x: load(factor, k) * x


def scale_sum(factor, x):
    """x times the factor, if it is one float for all slots: applied after a sum; see `scale_terms`."""


@overload(scale_sum, inline="always")
def _scale_sum(factor, x):
    if isinstance(factor, types.Float):
        return lambda factor, x: factor * x
    return lambda factor, x: x


@kernel()
def edge_vectors(k0, m0, n, s, u, rx, ry, A, B, l1, i1, l2, i2):
    """Edges of n slots from k0 on, relative to their length at rest, their stretches and the inverses of these.

    Into scratch from m0 on; A, l1, i1 those of the warp, B, l2, i2 of the weft.
    """
    next_x, next_y, next_z = load(u[0], k0), load(u[1], k0), load(u[2], k0)
    for j in range(0, n, WIDTH):
        k, m = k0 + j, m0 + j
        x, y, z, r = next_x, next_y, next_z, load_or_broadcast(rx, k)
        next_x, next_y, next_z = load(u[0], k + WIDTH), load(u[1], k + WIDTH), load(u[2], k + WIDTH)
        a, b, c = fma(load(u[0], k + s) - x, r, 1.0), r * (load(u[1], k + s) - y), r * (load(u[2], k + s) - z)
        store(A[0], m, a)
        store(A[1], m, b)
        store(A[2], m, c)
        square = fma(c, c, fma(b, b, a * a))
        inverse = rsqrt(square)
        store(i1, m, inverse)
        store(l1, m, square * inverse)
        q = load_or_broadcast(ry, k)
        a, b, c = (
            q * (shift_in_next(x, next_x) - x),
            fma(shift_in_next(y, next_y) - y, q, 1.0),
            q * (shift_in_next(z, next_z) - z),
        )
        store(B[0], m, a)
        store(B[1], m, b)
        store(B[2], m, c)
        square = fma(c, c, fma(b, b, a * a))
        inverse = rsqrt(square)
        store(i2, m, inverse)
        store(l2, m, square * inverse)


@kernel()
def reset_idle_slots(m0, n, s, B, l2, i2):
    """Reset the idle slot at the end of each row of weft edges, where `edge_vectors` has joined two rows."""
    for j in range(m0 + s - 1, m0 + n, s):
        B[0][j] = B[2][j] = 0.0
        B[1][j] = l2[j] = i2[j] = 1.0


@kernel()
def copy_row(n, source, target, x):
    """Repeat a row: n slots of x from `source` to `target`."""
    for j in range(n):
        x[target + j] = x[source + j]


@kernel()
def crossing_means_warp(k0, m0, n, s, split, x, mean):
    """For n warp edges the mean of x over the weft edges that cross them: four, or two at the ends of a row."""
    for j in range(m0, m0 + n, WIDTH):
        k = k0 + j - m0
        store(mean, j, mean_crossing_warp(split, k, load(x, j - 1), load(x, j), load(x, j + s - 1), load(x, j + s)))
    for j in range(m0, m0 + n, s):
        end = j + s - 1
        mean[j], mean[end] = 0.5 * (x[j] + x[j + s]), 0.5 * (x[end - 1] + x[end + s - 1])


@kernel()
def crossing_means_weft(k0, m0, n, s, split, x, mean):
    """For n weft edges the mean of x over the warp edges that cross them; rows beyond the panel repeat its last."""
    for j in range(m0, m0 + n, WIDTH):
        k = k0 + j - m0
        store(mean, j, mean_crossing_weft(split, k, load(x, j - s), load(x, j - s + 1), load(x, j), load(x, j + 1)))
    for j in range(m0 + s - 1, m0 + n, s):
        mean[j] = 1.0


@kernel()
def bilinear_tensions(m0, n, l1, l2, grid, table, T):
    """Bilinear interpolation of one tension [N] at n pairs of stretches. Returns the largest, at least 0.

    grid : where the table begins, cells per stretch and number of the last cell, of both stretches; cells along the
        second. Below the table its edge, which is exact there; above it linear.
    """
    x0, rx, top1, y0, ry, top2, across = grid
    greatest = broadcast(0.0)
    for j in range(0, n, WIDTH):
        m = m0 + j
        p, q = maximum((load(l1, m) - x0) * rx, 0.0), maximum((load(l2, m) - y0) * ry, 0.0)
        cell1, cell2 = floor(minimum(p, top1)), floor(minimum(q, top2))
        c = gather_rows4(table, to_int32(fma(cell1, across, cell2)))
        p, q = p - cell1, q - cell2
        tension = fma(q, fma(c[3], p, c[2]), fma(c[1], p, c[0]))
        store(T, m, tension)
        greatest = maximum(greatest, tension if n - j >= WIDTH else where(head_mask(n - j), tension, 0.0))
    return reduce_max(greatest)


@kernel()
def potential_forces(m0, n, l1, l2, grid, table, per1, per2, stiff1, stiff2, spots, N1, N2, K):
    """Gradient of the biquadratic potential, N = per dW/d(local coordinate), and a slope K of it.

    Below the table its edge, which is exact there; above it tensions go on straight. table (cells, 8) : of p, p p, q,
    q q, p q, p p q, p q q, p p q q. K is stiff1 / 2 d2W/dp2 + stiff2 / 2 d2W/dq2. Returns the largest p and q, the
    places in the table in units of its cells, and the largest N1 and N2, at least 0.

    A piece of spots.size slots at a time, in two loops: the first finds places in the table, which are kept in spots,
    N1 and N2, and the second what stands there. In one loop the rows wait for their number and the sums for the rows,
    and what waits fills all the room that a processor has for it.
    """
    far1, far2, high1, high2 = broadcast(0.0), broadcast(0.0), broadcast(0.0), broadcast(0.0)
    x0, rx, top1, y0, ry, top2, across = grid
    for start in range(m0, m0 + n, spots.size):
        stop = min(start + spots.size, m0 + n)
        whole = stop - (stop - start) % WIDTH
        for j in range(start, stop, WIDTH):
            p, q = maximum((load(l1, j) - x0) * rx, 0.0), maximum((load(l2, j) - y0) * ry, 0.0)
            cell1, cell2 = floor(minimum(p, top1)), floor(minimum(q, top2))
            store_int32(spots, j - start, to_int32(fma(cell1, across, cell2)))
            store(N1, j, p - cell1)
            store(N2, j, q - cell2)
            if j < whole:
                far1, far2 = maximum(far1, p), maximum(far2, q)
            else:
                far1 = maximum(far1, where(head_mask(stop - j), p, 0.0))
                far2 = maximum(far2, where(head_mask(stop - j), q, 0.0))
        for j in range(start, stop, WIDTH):
            p, q, c = load(N1, j), load(N2, j), gather8_indexed(table, spots, j - start)
            flat1, turn1 = fma(q, fma(q, c[6], c[4]), c[0]), fma(q, fma(q, c[7], c[5]), c[1])
            flat2, turn2 = fma(p, fma(p, c[5], c[4]), c[2]), fma(p, fma(p, c[7], c[6]), c[3])
            force1, force2 = per1 * fma(p + p, turn1, flat1), per2 * fma(q + q, turn2, flat2)
            store(N1, j, force1)
            store(N2, j, force2)
            store(K, j, fma(stiff1, turn1, stiff2 * turn2))
            if j < whole:
                high1, high2 = maximum(high1, force1), maximum(high2, force2)
            else:
                high1 = maximum(high1, where(head_mask(stop - j), force1, 0.0))
                high2 = maximum(high2, where(head_mask(stop - j), force2, 0.0))
    return reduce_max(far1), reduce_max(far2), reduce_max(high1), reduce_max(high2)


@kernel()
def potential(l1, l2, grid, table, level):
    """The biquadratic potential [J] at a pair of stretches, for `potential_forces`. level (cells,) [J] : of 1."""
    x0, rx, top1, y0, ry, top2, across = grid
    p, q = max((l1 - x0) * rx, 0.0), max((l2 - y0) * ry, 0.0)
    cell1, cell2 = math.floor(min(p, top1)), math.floor(min(q, top2))
    m, p, q = np.int64(cell1 * across + cell2), p - cell1, q - cell2
    c = table[m]
    zero, one, two = level[m] + q * (c[2] + q * c[3]), c[0] + q * (c[4] + q * c[6]), c[1] + q * (c[5] + q * c[7])
    return zero + p * (one + p * two)


@kernel()
def distribute_warp(k0, m0, n, s, split, own, given, N):
    """Forces N of n warp edges: half its own, half the transpose of `crossing_means_warp` of crossing weft edges."""
    for j in range(m0, m0 + n, WIDTH):
        k = k0 + j - m0
        met = mean_crossing_warp(
            split, k, load(given, j - 1), load(given, j), load(given, j + s - 1), load(given, j + s)
        )
        store(N, j, 0.5 * (met + load(own, j)))
    for j in range(m0, m0 + n, s):
        end = j + s - 1
        N[j] = 0.5 * (own[j] + 0.5 * (given[j] + given[j + s]))
        N[end] = 0.5 * (own[end] + 0.5 * (given[end - 1] + given[end + s - 1]))


@kernel()
def distribute_weft(k0, m0, n, s, split, own, given, N):
    """Forces N of n weft edges: half its own plus half the mean over crossing warp edges."""
    for j in range(m0, m0 + n, WIDTH):
        k = k0 + j - m0
        met = mean_crossing_weft(
            split, k, load(given, j - s), load(given, j - s + 1), load(given, j), load(given, j + 1)
        )
        store(N, j, 0.5 * (met + load(own, j)))
    for j in range(m0 + s - 1, m0 + n, s):  # idle slots
        N[j] = 0.0


@kernel()
def max_value(m0, n, values):
    """The largest of n values, at least 0."""
    found = 0.0
    for j in range(m0, m0 + n):
        found = max(found, values[j])
    return found


@kernel()
def yarn_forces(k0, m0, n, back, again, r, cv, l, inverse, turned, N, K, y, L, P, D, S, on):
    """Update n edges of one family, and compute their axial force over the stretch, r = 1 / dX, into `on`.

    The pull is y (N + cv dL), dE/dLambda with y [m] the length of yarn of an edge, less what the trellis on both sides
    takes. Returns the work of N and of the viscous force. The work of a step is the trapezoid of the force over the
    change of stretch. Summed over the steps it equals, term by term, what central differences exchange with the kinetic
    energy. `again`: in a step that has been made before yarns failed in it.

    The trapezoid of a force whose slope K changes by dK in a step is dK dL^2 / 12 more than its integral (Euler and
    Maclaurin). The third that is returned is the sum of it, from the slopes alone; S keeps them. A yarn that snaps taut
    loses that much, and gets none of it back, as it slackens slowly.
    """
    work, viscous, over = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    for j in range(0, n, WIDTH):
        k, m, left = k0 + j, m0 + j, n - j
        stretch, force, slope, length, last = load(l, m), load(N, m), load(K, m), load(y, k), load(D, k)
        d = last if again else stretch - load(L, k)
        part = length * d if left >= WIDTH else where(head_mask(left), length * d, 0.0)
        work = fma(part, force + load(P, k), work)
        viscous = fma(scale_terms(cv, k, part), d + last, viscous)
        over = fma(part * d, slope - load(S, k), over)
        pull = length * fma(load_or_broadcast(cv, k), d, force) - (load(turned, m) + load(turned, m - back))
        store(on, m, load_or_broadcast(r, k) * load(inverse, m) * pull)
        masked_store(L, k, stretch, left)
        masked_store(P, k, force, left)
        masked_store(D, k, d, left)
        masked_store(S, k, slope, left)
    return 0.5 * reduce_add(work), scale_sum(cv, 0.5 * reduce_add(viscous)), reduce_add(over) / 12.0


@kernel()
def trellis_law(gamma, G1, G2, gamma1, gamma2):
    """Trellis stress, odd in the shear angle gamma, and its integral: three zones (eq. 4-35, erratum E-11)."""
    g = abs(gamma)
    rise = (G2 - G1) / (gamma2 - gamma1)
    middle = min(max(g - gamma1, 0.0), gamma2 - gamma1)
    beyond = max(g - gamma2, 0.0)
    stress = G1 * g + 0.5 * rise * middle * middle + (G2 - G1) * beyond
    energy = 0.5 * G1 * g * g + rise * middle**3 / 6.0
    energy += 0.5 * rise * (gamma2 - gamma1) ** 2 * beyond + 0.5 * (G2 - G1) * beyond * beyond
    return math.copysign(stress, gamma), energy


@kernel()
def shear_energy(sine, V, G1, G2, gamma1, gamma2):
    """Energy V U of the trellis in one quadrilateral."""
    return V * trellis_law(math.asin(min(max(sine, -0.999), 0.999)), G1, G2, gamma1, gamma2)[1]


@kernel(forceinline=True)
def arcsine_terms(z, z2, m):
    """Four terms of P from that of z^m on, over z^m (Estrin's scheme)."""
    return fma(z2, fma(z, ARCSINE[m + 3], ARCSINE[m + 2]), fma(z, ARCSINE[m + 1], ARCSINE[m]))


@kernel(forceinline=True)
def arcsine(sine):
    """Eight arcsines, sizes: x + x z P(z), z = x^2, up to sine 1/2; pi/2 less twice that of sqrt((1 - x) / 2) above."""
    x = minimum(fabs(sine), 0.999)
    high, root, z = greater(x, 0.5), x, x * x
    if any_lane(high):
        z = where(high, fma(x, -0.5, broadcast(0.5)), z)
        root = where(high, sqrt(z), x)
    z2 = z * z
    z4 = z2 * z2
    P = fma(z4, arcsine_terms(z, z2, 8), arcsine_terms(z, z2, 4))
    P = fma(z4, P, arcsine_terms(z, z2, 0))
    angle = fma(root * z, P, root)
    return where(high, fma(angle, -2.0, broadcast(0.5 * math.pi)), angle)


@kernel()
def shear_slope(sine, G1, G2, gamma1, gamma2):
    """dU/d(sin gamma) = tau / cos(gamma) of eight angles. Yarns closer to each other than 2.6 degrees count as that.

    `trellis_law` written without branches.
    """
    x = minimum(fabs(sine), 0.999)
    angle, cosine = arcsine(x), 1.0 - x * x
    span = gamma2 - gamma1
    middle = minimum(maximum(angle - gamma1, 0.0), span)
    stress = fma((0.5 * (G2 - G1) / span) * middle, middle, G1 * angle)
    stress = fma(maximum(angle - gamma2, 0.0), G2 - G1, stress)
    return copysign(stress * rsqrt(cosine), sine)


@kernel(forceinline=True)
def regularized_stretch(stretch):
    """Regularized stretch f of the sum of two stretches, and its slope (see above)."""
    short = minimum(stretch, 2.0 * FADE_STRETCH)
    missing = 2.0 * FADE_STRETCH - short
    return fma((0.25 / FADE_STRETCH) * missing, missing, stretch), (0.5 / FADE_STRETCH) * short


@kernel()
def regularized_stretch_scalar(stretch):
    """`regularized_stretch` of one sum, without the slope."""
    missing = max(2.0 * FADE_STRETCH - stretch, 0.0)
    return stretch + 0.25 / FADE_STRETCH * missing * missing


@kernel(forceinline=True)
def shear_sines(j, s, A, B, l1, l2):
    """Of eight quadrilaterals: sine, over f of the two warp and of the two weft edges' stretches, and these, summed."""
    dot = (load(A[0], j) + load(A[0], j + 1)) * (load(B[0], j) + load(B[0], j + s))
    dot = fma(load(A[1], j) + load(A[1], j + 1), load(B[1], j) + load(B[1], j + s), dot)
    dot = fma(load(A[2], j) + load(A[2], j + 1), load(B[2], j) + load(B[2], j + s), dot)
    along, over = load(l1, j) + load(l1, j + 1), load(l2, j) + load(l2, j + s)
    product = along * over
    if any_lane(greater(2.0 * FADE_STRETCH, minimum(along, over))):
        product = regularized_stretch(along)[0] * regularized_stretch(over)[0]
    share = 1.0 / product
    return dot * share, share, along, over


@kernel()
def trellis_forces(k0, m0, n, s, A, B, l1, l2, V, G1, G2, gamma1, gamma2, turn1, turn2, cross):
    """Shear forces of n elements.

    turn1, turn2 : -dE/dLambda that it gives to each of its two warp and its two weft edges
    cross : dE/d(a.b) over four, a and b being doubled
    """
    next_sine, next_share, next_along, next_over = shear_sines(m0, s, A, B, l1, l2)
    for j in range(m0, m0 + n, WIDTH):
        sine, share, along, over = next_sine, next_share, next_along, next_over
        next_sine, next_share, next_along, next_over = shear_sines(j + WIDTH, s, A, B, l1, l2)
        crossed = load_or_broadcast(V, k0 + j - m0) * shear_slope(sine, G1, G2, gamma1, gamma2) * share
        turned = crossed * sine
        store(cross, j, crossed)
        if any_lane(greater(2.0 * FADE_STRETCH, minimum(along, over))):
            (along, slope1), (over, slope2) = regularized_stretch(along), regularized_stretch(over)
            along, over = along * slope2, over * slope1
        store(turn1, j, turned * over)
        store(turn2, j, turned * along)
    for j in range(m0 + s - 1, m0 + n, s):  # idle slots
        turn1[j] = turn2[j] = cross[j] = 0.0


@kernel()
def scatter_forces(k0, m0, n, s, rx, ry, A, B, on1, on2, cross, f_next_row, f_int):
    """Scatter the forces of n slots' edges and elements to their nodes.

    f_next_row : scratch, what a row of elements gives to the nodes of the next; from m0 on, a row ahead of f_int. A
        row is read before the next is stored, all rows in one loop unless a row is shorter than eight slots.
    Without contraction uniform tension cancels digit by digit.
    """
    for c in range(3):
        for j in range(m0, m0 + s):
            f_next_row[c][j] = 0.0
    length = n if s >= WIDTH else s
    for start in range(0, n, length):
        # of the eight slots before; the first before a row is idle, and has nothing
        back_x = back_y = back_z = pull_x = pull_y = pull_z = turn_x = turn_y = turn_z = broadcast(0.0)
        for j in range(start, start + length, WIDTH):
            k, m, left = k0 + j, m0 + j, start + length - j
            crossed, pull1, pull2, r = load(cross, m), load(on1, m), load(on2, m), load_or_broadcast(rx, k)
            back_x, pull_x, turn_x = scatter_component(
                k, m, s, left, r, ry, crossed, pull1, pull2, A[0], B[0], f_next_row[0], f_int[0], back_x, pull_x, turn_x
            )
            back_y, pull_y, turn_y = scatter_component(
                k, m, s, left, r, ry, crossed, pull1, pull2, A[1], B[1], f_next_row[1], f_int[1], back_y, pull_y, turn_y
            )
            back_z, pull_z, turn_z = scatter_component(
                k, m, s, left, r, ry, crossed, pull1, pull2, A[2], B[2], f_next_row[2], f_int[2], back_z, pull_z, turn_z
            )


@kernel(forceinline=True)
def scatter_component(k, m, s, left, r, ry, crossed, pull1, pull2, A, B, f_next_row, f_int, last_X, last_pull, last_Y):
    """Nodal forces of eight slots, one component; the last three arguments are of the eight slots before."""
    a, b = load(A, m), load(B, m)
    X, Y, pulled2 = crossed * (b + load(B, m + s)), crossed * (a + load(A, m + 1)), pull2 * b
    Y = scale_terms(ry, k, Y)
    pulled, turned = pull1 * a, r * (X + shift_in_prev(last_X, X))
    over = scale_sum(ry, Y - shift_in_prev(last_Y, Y))
    own = (pulled + (pulled2 - shift_in_prev(last_pull, pulled2))) + (turned + over)
    masked_store(f_int, k, own + load(f_next_row, m), left)
    store(f_next_row, m + s, over - (pulled + turned))
    return X, pulled2, Y


@kernel()
def scatter_forces_last_row(k0, m0, n, on2, B, f_next_row, f_int):
    """Scatter the forces of the weft edges on the panel's last row to their nodes."""
    for c in range(3):
        for j in range(n):
            m = m0 + j
            f_int[c][k0 + j] = (on2[m] * B[c][m] - on2[m - 1] * B[c][m - 1]) + f_next_row[c][m]
