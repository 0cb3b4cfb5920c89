"""The fabric: yarn segments along the grid lines, crossovers at the nodes, trellis in between; total
Lagrangian (docs/theory-panel.md, "Yarn elements and forces", "Graded meshes").

Arrays are flat, by component, a row of s = nj + 1 slots for each i; node (i, j), the warp edge to
(i+1, j), the weft edge to (i, j+1) and the quadrilateral beside both share the slot k = i s + j. An
element row adds to the node rows below and above it; node rows between two blocks have two places for
this, f_int and f_int_above, so that the result does not depend on the order of the blocks.

Kernels work on the rows first .. last - 1 of a block. Three (look-up, trellis, scatter) go eight slots
at a time (`simd`) and may overrun scratch by up to seven slots, the panel's arrays not. Scratch begins
two rows before the block's first: one idle, one the last row of the block before; one follows the last.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    fma,
    item_or_scalar,
    load,
    load_or_broadcast,
    masked_store,
    maximum,
    minimum,
    reduce_add,
    rsqrt,
    shift_in_prev,
    store,
)
from shellfabric.state import REDO, WARP, WEFT, unit

ONE = np.uint64(1)


@kernel()
def scratch_slot(const, first, row):
    """Return the slot of the scratch where a row of the panel begins, for a block whose first row
    is `first`."""
    return (row - first + 2) * const.row_stride


@kernel(inline="always")
def slots_of(arrays, begin, n):
    """Return n slots from `begin` on, of each of three arrays."""
    x, y, z = arrays
    return x[begin : begin + n], y[begin : begin + n], z[begin : begin + n]


@unit()
def stretch_edges(state, const, work, first, last):
    """Compute edges of the rows first - 1 .. last of a block: vectors over their length at rest,
    stretches."""
    s = const.row_stride
    low = max(first - 1, 0)
    k = low * s
    m = scratch_slot(const, first, low)
    n = (last - low + 1) * s
    node = slots_of(state.u, k, n)
    edge_vectors(
        const.inv_dx,
        k,
        (1.0, 0.0),
        node,
        slots_of(state.u, k + s, n),
        slots_of(work.A, m, n),
        work.stretch[WARP][m : m + n],
        work.inv_stretch[WARP][m : m + n],
    )
    edge_vectors(
        const.inv_dy,
        k,
        (0.0, 1.0),
        node,
        slots_of(state.u, k + 1, n),
        slots_of(work.B, m, n),
        work.stretch[WEFT][m : m + n],
        work.inv_stretch[WEFT][m : m + n],
    )
    # the last slot of a row has joined two rows: no weft edge begins there
    for j in range(m + s - 1, m + n, s):
        work.B[0][j] = 0.0
        work.B[1][j] = 1.0
        work.B[2][j] = 0.0
        work.stretch[WEFT][j] = 1.0
        work.inv_stretch[WEFT][j] = 1.0
    repeat_rim(const, first, last, work.stretch[WARP])


@kernel(_nrt=False)
def edge_vectors(per_length, k, at_rest, begin, end, vector, stretch, inverse):
    """Compute vectors of edges over their length at rest, their stretches and the inverses of
    these.

    per_length : [1/m] inverse length at rest, one number or slots, from k on;  at_rest : (x, y) of
        the vector at rest
    begin, end : (x, y, z) [m] displacements of the nodes at both ends
    """
    x, y, z = begin
    x_end, y_end, z_end = end
    a, b, c = vector
    for j in range(stretch.size):
        scale = item_or_scalar(per_length, np.uint64(k + j))
        along = fma(x_end[j] - x[j], scale, at_rest[0])
        across = fma(y_end[j] - y[j], scale, at_rest[1])
        out = scale * (z_end[j] - z[j])
        square = fma(out, out, fma(across, across, along * along))
        one_over = rsqrt(square)
        a[j] = along
        b[j] = across
        c[j] = out
        stretch[j] = square * one_over
        inverse[j] = one_over


@kernel(_nrt=False)
def repeat_rim(const, first, last, x):
    """Repeat the first and the last row of warp edges of the panel beyond its rim, where the weft
    edges on it look."""
    s = const.row_stride
    if first == 0:
        for j in range(s):
            x[s + j] = x[2 * s + j]
    if last == const.ni:
        rim = scratch_slot(const, first, last)
        for j in range(s):
            x[rim + j] = x[rim - s + j]


@unit()
def average_crossing(state, const, work, first, last):
    """Average the stretch of the edges that cross each edge of a block's rows, and each warp edge
    of the row before."""
    average(const, first, last, work.stretch, work.mean_stretch)


@kernel(_nrt=False)
def average(const, first, last, x, mean):
    """Average x of each family over the edges that cross those of the other one."""
    mean_over_weft(const, first, max(first - 1, 0), last, x[WEFT], mean[WEFT])
    mean_over_warp(const, first, last, x[WARP], mean[WARP])


@kernel(_nrt=False)
def mean_over_weft(const, first, low, last, x, mean):
    """Average x, for the warp edges of the rows low .. last - 1, over the four weft edges at their
    two nodes; over two at the ends of a row.

    first : row of the block that the scratch x and mean is of
    """
    s = const.row_stride
    m = scratch_slot(const, first, low)
    n = (last - low) * s
    k = low * s
    before = x[m - 1 : m - 1 + n]
    behind = x[m : m + n]
    far_before = x[m + s - 1 : m + s - 1 + n]
    far_behind = x[m + s : m + s + n]
    out = mean[m : m + n]
    for j in range(n):
        share = item_or_scalar(const.mean_weight2, np.uint64(k + j))
        rest = 1.0 - share
        near = fma(share, before[j], rest * behind[j])
        far = fma(share, far_before[j], rest * far_behind[j])
        out[j] = 0.5 * (near + far)
    for j in range(m, m + n, s):
        end = j + s - 1
        mean[j] = 0.5 * (x[j] + x[j + s])
        mean[end] = 0.5 * (x[end - 1] + x[end + s - 1])


@kernel(_nrt=False)
def mean_over_warp(const, first, last, x, mean):
    """Average x, for the weft edges of the rows first .. last, over the four warp edges at their
    two nodes; those beyond the panel repeat its last row (`repeat_rim`)."""
    s = const.row_stride
    m = 2 * s
    n = (last - first + 1) * s
    k = first * s
    before = x[m - s : m - s + n]
    far_before = x[m - s + 1 : m - s + 1 + n]
    behind = x[m : m + n]
    far_behind = x[m + 1 : m + 1 + n]
    out = mean[m : m + n]
    for j in range(n):
        share = item_or_scalar(const.mean_weight1, np.uint64(k + j))
        out[j] = 0.5 * fma(
            share, before[j] + far_before[j], (1.0 - share) * (behind[j] + far_behind[j])
        )
    for j in range(s - 1, n, s):  # the last slot of a row is no edge
        out[j] = 1.0


@unit()
def share_forces(state, const, work, first, last):
    """Compute the forces N of a block's edges in the variational form: half of dW of their own
    cells, half of those they cross.

    The mean over crossing edges is its own transpose: what an edge gets is the mean of what these
    give.
    """
    s = const.row_stride
    repeat_rim(const, first, last, work.dW_crossing[WARP])
    mean_over_weft(const, first, first, last, work.dW_crossing[WEFT], work.N[WARP])
    mean_over_warp(const, first, last, work.dW_crossing[WARP], work.N[WEFT])
    m = 2 * s
    end = m + (last - first + 1) * s
    for family in range(2):
        own = work.dW_own[family][m:end]
        N = work.N[family][m:end]
        for j in range(N.size):
            N[j] = 0.5 * (N[j] + own[j])
    for j in range(m + s - 1, end, s):  # the last slot of a row is no weft edge
        work.N[WEFT][j] = 0.0


@kernel(_nrt=False, forceinline=True)
def bounded_by_tension(damping, N):
    """Bound the viscous force [N] of an edge by its tension: a slack yarn has none, and no yarn is
    pushed."""
    most = maximum(N, 0.0)
    return minimum(maximum(damping, 0.0 - most), most)


@kernel(_nrt=False, forceinline=True)
def edge_work(again, cv, length, stretch, N, kept):
    """Compute twice (work of N, work of the viscous force) [J] of an edge in a step: the trapezoid of
    the force over the change of stretch."""
    L, P, last = kept
    if again:
        d = last
    else:
        d = stretch - L
    part = length * d
    now = bounded_by_tension(cv * d, N)
    return part * (N + P), part * (now + bounded_by_tension(cv * last, P))


@kernel(_nrt=False)
def step_work(again, cv, k, length, stretch, N, kept):
    """Compute (work of N, work of the viscous force) [J] of the edges in a step.

    Eight sums side by side, of every eighth edge, and those behind the last eight: one order of
    adding on every processor.
    """
    L, P, D = kept
    tail = stretch.size - stretch.size % WIDTH
    works = broadcast(0.0)
    viscous_works = broadcast(0.0)
    for j in range(0, tail, WIDTH):
        each = edge_work(
            again,
            load_or_broadcast(cv, k + j),
            load(length, j),
            load(stretch, j),
            load(N, j),
            (load(L, j), load(P, j), load(D, j)),
        )
        works = works + each[0]
        viscous_works = viscous_works + each[1]
    work = reduce_add(works)
    viscous = reduce_add(viscous_works)
    for j in range(tail, stretch.size):
        one = edge_work(
            again,
            item_or_scalar(cv, np.uint64(k + j)),
            length[j],
            stretch[j],
            np.float64(N[j]),
            (L[j], np.float64(P[j]), np.float64(D[j])),
        )
        work += one[0]
        viscous += one[1]
    return 0.5 * work, 0.5 * viscous


@unit()
def pull_yarns(state, const, work, block, first, last):
    """Compute the axial forces of a block's edges over their stretch, and the work of the step.

    The pull is y (N + cv dL), dE/dLambda with y [m] the length of yarn of an edge, less what the
    trellis on both sides takes; |cv dL| is N at most. Summed over the steps the work equals, term by term, what central
    differences exchange with the kinetic energy. A step that is made again, since yarns failed in
    it, keeps its change of stretch.

    The trapezoid of a force whose slope changes by dK in a step is dK dL^2 / 12 more than its
    integral (Euler and Maclaurin). A yarn that snaps taut loses that much, and gets none of it
    back, as it slackens slowly.
    """
    s = const.row_stride
    again = state.block_damage[block] == REDO
    k = first * s
    m = 2 * s
    for family in range(2):
        n = (last - first) * s
        if family == WEFT and last == const.ni:
            n += s  # the weft on the far side of the panel has no row of its own
        beside = 1
        if family == WEFT:
            beside = s
        cv = (const.cv1, const.cv2)[family]
        length = state.yarn_length[family][k : k + n]
        stretch = work.stretch[family][m : m + n]
        N = work.T[family][m : m + n]
        if const.variational:
            N = work.N[family][m : m + n]
        kept = (
            state.stretch[family][k : k + n],
            state.N[family][k : k + n],
            state.dstretch[family][k : k + n],
        )
        done, damped = step_work(again, cv, k, length, stretch, N, kept)
        if not again:
            state.edge_work[block] += done
            state.viscous_work[block] += damped
        turned = work.trellis_turn[family]
        pull_edges(
            again,
            k,
            ((const.inv_dx, const.inv_dy)[family], cv, length),
            (stretch, work.inv_stretch[family][m : m + n], N),
            (turned[m : m + n], turned[m - beside : m - beside + n]),
            kept,
            work.f_over_stretch[family][m : m + n],
        )


@kernel(_nrt=False)
def pull_edges(again, k, factors, edges, turned, kept, on):
    """Compute the pull of edges over their stretch, r (y (N + cv dL) - turned) / l, into `on`; keep
    what the next step needs.

    factors : r = 1 / dX and cv, one number or slots, from k on; y
    edges, turned : l, 1 / l, N; what the trellis takes on both sides
    kept : stretch L, force P and change of stretch D of the last step
    """
    per_length, cv, length = factors
    stretch, inverse, N = edges
    one_side, other_side = turned
    L, P, D = kept
    for j in range(on.size):
        if again:
            d = np.float64(D[j])
        else:
            d = stretch[j] - L[j]
        # `bounded_by_tension`, with the one rounding that a taut yarn has without it
        most = maximum(N[j], 0.0)
        tension = fma(item_or_scalar(cv, np.uint64(k + j)), d, N[j])
        tension = minimum(maximum(tension, N[j] - most), N[j] + most)
        pull = length[j] * tension - (one_side[j] + other_side[j])
        per_stretch = item_or_scalar(per_length, np.uint64(k + j)) * inverse[j]
        on[j] = per_stretch * pull
        L[j] = stretch[j]
        P[j] = N[j]
        D[j] = d


@unit()
def scatter_forces(state, const, work, block, first, last):
    """Scatter the forces of a block's edges and elements to its nodes, and to the first row of
    nodes of the next block.

    Eight slots at a time: what a slot gives to the next one stays in registers. work.f_next_row is
    what a row of elements gives to the nodes of the next; a row is read before the next is stored,
    all rows in one loop unless a row is shorter than eight slots. A row of nodes in whose middle of
    a block the window begins or ends is at rest: it keeps the forces that it has. Without
    contraction uniform tension cancels digit by digit.
    """
    s = const.row_stride
    k0 = first * s
    m0 = 2 * s
    n = (last - first) * s
    at_rest = first > block * const.rows_per_block
    kept = work.inv_stretch[WARP]  # not needed any more
    for c in range(3):
        for j in range(s):
            work.f_next_row[c][m0 + j] = 0.0
            if at_rest:
                kept[c * s + j] = state.f_int[c][k0 + j]
    length = n
    if s < WIDTH:
        length = s
    for start in range(0, n, length):
        # of the eight slots before; the first before a row is idle, and has nothing
        nothing = broadcast(0.0)
        before = nothing, nothing, nothing
        last_x = last_y = last_z = before
        for j in range(start, start + length, WIDTH):
            k = k0 + j
            m = m0 + j
            left = start + length - j
            pulls = (
                load(work.trellis_cross, m),
                load(work.f_over_stretch[WARP], m),
                load(work.f_over_stretch[WEFT], m),
            )
            last_x = scatter_component(state, const, work, 0, k, m, left, pulls, last_x)
            last_y = scatter_component(state, const, work, 1, k, m, left, pulls, last_y)
            last_z = scatter_component(state, const, work, 2, k, m, left, pulls, last_z)
    if at_rest:
        for c in range(3):
            for j in range(s):
                state.f_int[c][k0 + j] = kept[c * s + j]
    hand_over(state, const, work, block, first, last)


@kernel(_nrt=False, forceinline=True)
def scatter_component(state, const, work, c, k, m, left, pulls, last):
    """Scatter the forces of eight slots, component c; `last` is what it returned for the eight
    slots before."""
    crossed, pull1, pull2 = pulls
    last_X, last_pull, last_Y = last
    A = work.A[c]
    B = work.B[c]
    f_next_row = work.f_next_row[c]
    s = const.row_stride
    a = load(A, m)
    b = load(B, m)
    X = crossed * (b + load(B, m + s))
    Y = load_or_broadcast(const.inv_dy, k) * (crossed * (a + load(A, m + 1)))
    pulled = pull1 * a
    pulled2 = pull2 * b
    turned = load_or_broadcast(const.inv_dx, k) * (X + shift_in_prev(last_X, X))
    over = Y - shift_in_prev(last_Y, Y)
    own = (pulled + (pulled2 - shift_in_prev(last_pull, pulled2))) + (turned + over)
    masked_store(state.f_int[c], k, own + load(f_next_row, m), left)
    store(f_next_row, m + s, over - (pulled + turned))
    return X, pulled2, Y


@kernel(_nrt=False)
def hand_over(state, const, work, block, first, last):
    """Hand over the forces on the row of nodes behind a block: to the next block, or on the rim of
    the panel with its weft."""
    s = const.row_stride
    k = last * s
    m = scratch_slot(const, first, last)
    if last == const.ni:
        on = work.f_over_stretch[WEFT]
        for c in range(3):
            B = work.B[c]
            for j in range(m, m + s):
                pull = on[j] * B[j] - on[j - 1] * B[j - 1]
                state.f_int[c][k - m + j] = pull + work.f_next_row[c][j]
    elif last == (block + 1) * const.rows_per_block:
        for c in range(3):
            copy_slots(work.f_next_row[c], m, s, state.f_int_above[c], k)


@kernel(_nrt=False)
def clear_forces(state, const, block, first, last):
    """Clear the forces of a block without a membrane on its nodes, and on the first row of the next."""
    s = const.row_stride
    for c in range(3):
        state.f_int[c][first * s : last * s] = 0.0
        if last == const.ni:
            state.f_int[c][last * s : (last + 1) * s] = 0.0
        elif last == (block + 1) * const.rows_per_block:
            state.f_int_above[c][last * s : (last + 1) * s] = 0.0


@kernel(_nrt=False)
def copy_slots(x, m, n, y, k):
    """Copy slots: y[k : k + n] becomes x[m : m + n]."""
    source = x[m : m + n]
    target = y[k : k + n]
    for j in range(n):
        target[j] = source[j]
