"""Forces of damaged elements: edges of which yarns have failed, or are crossed by yarns that have.

See `membrane_kernels` for the intact fraction alpha and the crossed fraction kappa. All edges have
been computed as whole ones, eight at once; where an element beside eight of them has a failed yarn,
these are computed again.
"""

import numpy as np

from shellfabric.cell.crossover_kernels import yarn_alone
from shellfabric.cloth.membrane_kernels import ONE, WARP, WEFT
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, equal_bytes, item_or_scalar, movemask
from shellfabric.state import unit

_ALL = 2**WIDTH - 1  # bits of eight that are whole


@kernel(_nrt=False, forceinline=True)
def damage_near(flags, k, s, before, behind):
    """Whether a yarn has failed in an element beside the eight slots from k on: in the rows of
    elements from `before` theirs to `behind` theirs, and in the columns to one beyond them on both
    sides."""
    for row in range(-before, behind + 1):
        m = k + row * s
        if m >= 0:
            whole = movemask(equal_bytes(flags, max(m - 1, 0), 0)) & movemask(
                equal_bytes(flags, m + 1, 0)
            )
            if whole != _ALL:
                return True
    return False


@kernel(_nrt=False, forceinline=True)
def edges_damaged(const, state, family, i, j):
    """Whether a yarn of the eight edges of a family from (i, j) on, or one that crosses them, may
    have failed."""
    s = const.row_stride
    behind = 0
    if family == WARP:
        behind = 1
    return damage_near(state.element_flag, i * s + j, s, 1, behind)


@kernel()
def sum_crossing(const, family, i, j, alpha, x, shift):
    """Of the edges of the other family that cross edge (i, j): sum of their weights w, sum w alpha,
    and sum w alpha x.

    alpha has the panel's slots, x scratch that lies `shift` slots behind them. A weight is one but
    on graded panels, and where only one line crosses.
    """
    s = const.row_stride
    k = i * s + j
    if family == WARP:
        split = const.mean_weight2
        back = 1
        far = s
        inner = j > 0
        outer = j < const.nj
    else:
        split = const.mean_weight1
        back = s
        far = 1
        inner = i > 0
        outer = i < const.ni
    count = 0.0
    present = 0.0
    total = 0.0
    for end in range(2):
        node = k + end * far
        before = 1.0
        behind = 1.0
        if inner and outer:
            before = 2.0 * item_or_scalar(split, np.uint64(node))
            behind = 2.0 - before
        if inner:
            at = np.uint64(node - back)
            count += before
            present += before * alpha[at]
            total += before * alpha[at] * x[np.uint64(node - back - shift)]
        if outer:
            at = np.uint64(node)
            count += behind
            present += behind * alpha[at]
            total += behind * alpha[at] * x[np.uint64(node - shift)]
    return count, present, total


@kernel()
def edges_in_row(const, family):
    """Edges of a family in a row of slots: the last slot has no weft edge."""
    if family == WARP:
        return const.row_stride
    return const.nj


@unit(later=True)
def damaged_means(state, const, work, family, first, last):
    """Mean stretch of the crossing edges, weighted by their intact fraction, for damaged edges of a
    block: of the rows that `average_crossing` has."""
    columns = edges_in_row(const, family)
    shift = (first - 2) * const.row_stride
    intact = state.intact_fraction[1 - family]
    stretch = work.stretch[1 - family]
    if family == WARP:
        low = max(first - 1, 0)
    else:
        low = first
    for i in range(low, last_row(family, last)):
        for start in range(0, columns, WIDTH):
            if not edges_damaged(const, state, family, i, start):
                continue
            for j in range(start, min(start + WIDTH, columns)):
                _, present, total = sum_crossing(const, family, i, j, intact, stretch, shift)
                if present > 0.0:
                    at = np.uint64(i * const.row_stride + j - shift)
                    work.mean_stretch[1 - family][at] = total / present


@kernel()
def last_row(family, last):
    """One behind the last row of edges that the element rows up to `last` - 1 need."""
    if family == WARP:
        return last
    return last + 1


@unit(later=True)
def damaged_forces(state, const, work, family, first, last):
    """T = kappa T + (1 - kappa) T_alone of damaged edges; 0 where the yarns themselves have
    failed."""
    w, S0, EA = yarn_properties(const, family)
    columns = edges_in_row(const, family)
    shift = (first - 2) * const.row_stride
    own = state.intact_fraction[family]
    other = state.intact_fraction[1 - family]
    stretch = work.stretch[family]
    T = work.T[family]
    for i in range(first, last_row(family, last)):
        for start in range(0, columns, WIDTH):
            if not edges_damaged(const, state, family, i, start):
                continue
            for j in range(start, min(start + WIDTH, columns)):
                k = np.uint64(i * const.row_stride + j)
                m = np.uint64(i * const.row_stride + j - shift)
                if own[k] == 0.0:
                    T[m] = 0.0
                    continue
                count, present, _ = sum_crossing(const, family, i, j, other, stretch, shift)
                if present < count:
                    crossed = present / count
                    alone = yarn_alone(stretch[m], w, S0, EA)[0]
                    T[m] = crossed * T[m] + (1.0 - crossed) * alone


@unit(later=True)
def damaged_gradient(state, const, work, family, first, last):
    """The variational force of damaged edges: own share, and, of each crossing edge, the share that
    it gives."""
    w, S0, EA = yarn_properties(const, family)
    columns = edges_in_row(const, family)
    shift = (first - 2) * const.row_stride
    intact = state.intact_fraction[family]
    other = state.intact_fraction[1 - family]
    given = work.dW_crossing[1 - family]
    N = work.N[family]
    for i in range(first, last_row(family, last)):
        for start in range(0, columns, WIDTH):
            if not edges_damaged(const, state, family, i, start):
                continue
            for j in range(start, min(start + WIDTH, columns)):
                k = np.uint64(i * const.row_stride + j)
                m = np.uint64(i * const.row_stride + j - shift)
                if intact[k] == 0.0:
                    N[m] = 0.0
                    continue
                count, present, total = sum_crossing(const, family, i, j, other, given, shift)
                crossed = present / count
                N[m] = 0.5 * (crossed * work.dW_own[family][m] + total / count)
                if present < count:
                    alone = yarn_alone(work.stretch[family][m], w, S0, EA)[0]
                    N[m] += (1.0 - crossed) * alone


@unit(later=True)
def damaged_trellis(state, const, work, first, last):
    """Shear forces of damaged elements, scaled by the intact fractions of both families."""
    s = const.row_stride
    shift = (first - 2) * s
    for i in range(max(first - 1, 0), last):
        for start in range(0, const.nj, WIDTH):
            if not damage_near(state.element_flag, i * s + start, s, 0, 0):
                continue
            for j in range(start, min(start + WIDTH, const.nj)):
                left = trellis_intact_fraction(const, state, np.uint64(i * s + j))
                m = i * s + j - shift
                work.trellis_turn[WARP][m] *= left
                work.trellis_turn[WEFT][m] *= left
                work.trellis_cross[m] *= left


@kernel()
def trellis_intact_fraction(const, state, k):
    """Intact fraction of the trellis of element k."""
    warp = state.intact_fraction[WARP]
    weft = state.intact_fraction[WEFT]
    return 0.25 * (warp[k] + warp[k + ONE]) * (weft[k] + weft[k + np.uint64(const.row_stride)])


@kernel()
def yarn_properties(const, family):
    """(w, S0, EA) of a family."""
    if family == WARP:
        return (const.w1, const.S01, const.EA1)
    return (const.w2, const.S02, const.EA2)
