"""The fabric: yarn segments along the grid lines, crossovers at the nodes, trellis in between; total Lagrangian.

Equations, trellis of fabric that is drawn together, failed yarns, graded panels: docs/theory-panel.md, "Yarn elements
and forces". Displacements u are stored, so that fabric at rest is exactly at rest. The edge from a node to the next
one along its line is a segment of yarn of the stretch Lambda; <> is the mean over its four crossing segments.

    equilibrium form   T1 = T1(Lambda1, <Lambda2>),   T2 = T2(<Lambda1>, Lambda2)           forces along the segments
    variational form   E = 1/2 sum_warp n W(Lambda1, <Lambda2>) + 1/2 sum_weft n W(<Lambda1>, Lambda2)
    trellis            sin(gamma) = a.b / f(<Lambda1>) f(<Lambda2>),  f = Lambda, or c / 2 + Lambda^2 / 2 c below c
    failed yarns       N_e = kappa_e N + (1 - kappa_e) T_alone,  force alpha_e N_e   (alpha intact, kappa crossed part)

c = FADE_STRETCH is such that a locked trellis stays within the time step: it adds G2 t (1 / f1^2 + 1 / f2^2) / 4 to the
D of `panel.grid`, where 2 G2 t = D (eq. 4-49). On graded panels the pieces of a crossing line before and behind a node
count by their length, so that a mean is its own transpose; constants become arrays of slots (`load_or_broadcast`).

Scheme. Arrays are flat, by component, a row of s = nj + 1 slots for each i; node (i, j), the warp edge to (i+1, j), the
weft edge to (i, j+1) and the quadrilateral beside both share the slot k = i s + j. Weft edges and quadrilaterals leave
the last slot of a row idle. An element row adds to the node rows below and above it; node rows between two blocks have
two places for this, f_int and f_int_above, so that the result does not depend on the order of the blocks. Every loop
runs over a block of rows, eight slots at a time (`simd`). Scratch may be overrun by up to seven slots, the panel's
arrays may not. Scratch begins two rows before the block's first: one is idle, one repeats the last row of the block
before; another row follows the block's last.
"""

import numpy as np
from numba import types
from numba.extending import overload

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    fma,
    head_mask,
    load,
    load_or_broadcast,
    masked_store,
    reduce_add,
    rsqrt,
    shift_in_next,
    shift_in_prev,
    store,
    where,
)
from shellfabric.state import unit

ONE = np.uint64(1)
# of state.element_flag; DRAWN_OUT: torn, and twice its size
WARP_FAILED, WEFT_FAILED, ERODED, DRAWN_OUT = 1, 2, 4, 8


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


@unit(u="3 x n", inv_length="2 x per slot", A="3 x n", B="3 x n", l1="n", i1="n", l2="n", i2="n")
def edge_vectors(k0, m0, n, s, u, inv_length, A, B, l1, i1, l2, i2):
    """Edges of n slots from k0 on, relative to their length at rest, their stretches and the inverses of these.

    Into scratch from m0 on; A, l1, i1 those of the warp, B, l2, i2 of the weft.

    inv_length : (warp, weft) [1/m] of an edge at rest: floats, or arrays of slots
    """
    rx, ry = inv_length
    next_x, next_y, next_z = load(u[0], k0), load(u[1], k0), load(u[2], k0)
    for j in range(0, n, WIDTH):
        k, m = k0 + j, m0 + j
        x, y, z, r = next_x, next_y, next_z, load_or_broadcast(rx, k)
        next_x, next_y, next_z = load(u[0], k + WIDTH), load(u[1], k + WIDTH), load(u[2], k + WIDTH)
        a, b, c = (
            fma(load(u[0], k + s) - x, r, 1.0),
            r * (load(u[1], k + s) - y),
            r * (load(u[2], k + s) - z),
        )
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


@unit(split="per slot", x="n", mean="n")
def crossing_means_warp(k0, m0, n, s, split, x, mean):
    """For n warp edges the mean of x over the weft edges that cross them: four, or two at the ends of a row."""
    for j in range(m0, m0 + n, WIDTH):
        k = k0 + j - m0
        store(
            mean,
            j,
            mean_crossing_warp(
                split, k, load(x, j - 1), load(x, j), load(x, j + s - 1), load(x, j + s)
            ),
        )
    for j in range(m0, m0 + n, s):
        end = j + s - 1
        mean[j], mean[end] = 0.5 * (x[j] + x[j + s]), 0.5 * (x[end - 1] + x[end + s - 1])


@unit(split="per slot", x="n", mean="n")
def crossing_means_weft(k0, m0, n, s, split, x, mean):
    """For n weft edges the mean of x over the warp edges that cross them; rows beyond the panel repeat its last."""
    for j in range(m0, m0 + n, WIDTH):
        k = k0 + j - m0
        store(
            mean,
            j,
            mean_crossing_weft(
                split, k, load(x, j - s), load(x, j - s + 1), load(x, j), load(x, j + 1)
            ),
        )
    for j in range(m0 + s - 1, m0 + n, s):
        mean[j] = 1.0


@unit(split="per slot", own="n", given="n", N="n")
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


@unit(split="per slot", own="n", given="n", N="n")
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


@unit(
    "2 numbers", r="per slot", cv="per slot", edges="4 x n", y="n", kept="n; n; n float32", on="n"
)
def yarn_forces(k0, m0, n, back, again, r, cv, edges, y, kept, on):
    """Update n edges of one family, and compute their axial force over the stretch, r = 1 / dX, into `on`.

    edges : scratch, from m0 on: stretch l, its inverse, what the trellis takes `turned`, force N [N]
    kept : of the panel, from k0 on, overwritten: stretch L, force P and change of stretch D of the last step

    The pull is y (N + cv dL), dE/dLambda with y [m] the length of yarn of an edge, less what the trellis on both sides
    takes. Returns the work of N and of the viscous force. The work of a step is the trapezoid of the force over the
    change of stretch. Summed over the steps it equals, term by term, what central differences exchange with the kinetic
    energy. `again`: in a step that has been made before yarns failed in it.

    The trapezoid of a force whose slope changes by dK in a step is dK dL^2 / 12 more than its integral (Euler and
    Maclaurin). A yarn that snaps taut loses that much, and gets none of it back, as it slackens slowly.
    """
    work, viscous = broadcast(0.0), broadcast(0.0)
    l, inverse, turned, N = edges
    L, P, D = kept
    for j in range(0, n, WIDTH):
        k, m, left = k0 + j, m0 + j, n - j
        stretch, force, length, last = load(l, m), load(N, m), load(y, k), load(D, k)
        d = last if again else stretch - load(L, k)
        part = length * d if left >= WIDTH else where(head_mask(left), length * d, 0.0)
        work = fma(part, force + load(P, k), work)
        viscous = fma(scale_terms(cv, k, part), d + last, viscous)
        pull = length * fma(load_or_broadcast(cv, k), d, force) - (
            load(turned, m) + load(turned, m - back)
        )
        store(on, m, load_or_broadcast(r, k) * load(inverse, m) * pull)
        masked_store(L, k, stretch, left)
        masked_store(P, k, force, left)
        masked_store(D, k, d, left)
    return 0.5 * reduce_add(work), scale_sum(cv, 0.5 * reduce_add(viscous))


@unit(
    inv_length="2 x per slot",
    A="3 x n",
    B="3 x n",
    on1="n",
    on2="n",
    cross="n",
    f_next_row="3 x n",
    f_int="3 x n",
)
def scatter_forces(k0, m0, n, s, inv_length, A, B, on1, on2, cross, f_next_row, f_int):
    """Scatter the forces of n slots' edges and elements to their nodes.

    inv_length : as for `edge_vectors`
    f_next_row : scratch, what a row of elements gives to the nodes of the next; from m0 on, a row ahead of f_int. A
        row is read before the next is stored, all rows in one loop unless a row is shorter than eight slots.
    Without contraction uniform tension cancels digit by digit.
    """
    rx, ry = inv_length
    for c in range(3):
        for j in range(m0, m0 + s):
            f_next_row[c][j] = 0.0
    length = n if s >= WIDTH else s
    for start in range(0, n, length):
        # of the eight slots before; the first before a row is idle, and has nothing
        nothing = broadcast(0.0)
        last_x = last_y = last_z = nothing, nothing, nothing
        for j in range(start, start + length, WIDTH):
            k, m, left, r = k0 + j, m0 + j, start + length - j, load_or_broadcast(rx, k0 + j)
            pulls = load(cross, m), load(on1, m), load(on2, m)
            last_x = scatter_component(
                k, m, s, left, r, ry, pulls, A[0], B[0], f_next_row[0], f_int[0], last_x
            )
            last_y = scatter_component(
                k, m, s, left, r, ry, pulls, A[1], B[1], f_next_row[1], f_int[1], last_y
            )
            last_z = scatter_component(
                k, m, s, left, r, ry, pulls, A[2], B[2], f_next_row[2], f_int[2], last_z
            )


@kernel(_nrt=False, forceinline=True)
def scatter_component(k, m, s, left, r, ry, pulls, A, B, f_next_row, f_int, last):
    """Nodal forces of eight slots, one component; `last` is what it returned for the eight slots before."""
    (crossed, pull1, pull2), (last_X, last_pull, last_Y) = pulls, last
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
