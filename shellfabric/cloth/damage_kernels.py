"""Forces of damaged elements: edges of which yarns have failed, or are crossed by yarns that have.

See `membrane_kernels` for the intact fraction alpha and the crossed fraction kappa. All edges have been computed as
whole ones, eight at once; where an element beside eight of them has a failed yarn, these are computed again.
"""

import numpy as np
from numba import types
from numba.extending import overload

from shellfabric.cell.crossover_kernels import yarn_alone
from shellfabric.cloth.membrane_kernels import ONE
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, equal_bytes, movemask
from shellfabric.state import unit

WARP, WEFT = 0, 1
_ALL = 2**WIDTH - 1  # bits of eight that are whole


@kernel(_nrt=False, forceinline=True)
def damage_near(flags, k, s, before, behind):
    """Whether a yarn has failed in an element beside the eight slots from k on: in the rows of elements from `before`
    theirs to `behind` theirs, and in the columns to one beyond them on both sides."""
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
    """Whether a yarn of the eight edges of a family from (i, j) on, or one that crosses them, may have failed."""
    s = const.row_stride
    return damage_near(state.element_flag, i * s + j, s, 1, 1 if family == WARP else 0)


def crossing_weight(split, k, before, alone):
    """Weight of the piece of a crossing line before (or behind) the node k, relative to the mean of the two."""


@overload(crossing_weight, inline="always")
def _crossing_weight(split, k, before, alone):
    if isinstance(split, types.Float):
        return lambda split, k, before, alone: 1.0
    return lambda split, k, before, alone: (
        1.0 if alone else 2.0 * (split[k] if before else 1.0 - split[k])
    )


@kernel()
def sum_crossing(const, family, i, j, alpha, x, shift):
    """Of the edges of the other family that cross edge (i, j): sum of their weights w, sum w alpha, and sum w alpha x.

    alpha has the panel's slots, x scratch that lies `shift` slots behind them. A weight is one but on graded panels.
    """
    count, present, total = 0.0, 0.0, 0.0
    split = const.mean_weight2 if family == WARP else const.mean_weight1
    s, back = const.row_stride, 1 if family == WARP else const.row_stride
    k = i * s + j
    inner = j > 0 if family == WARP else i > 0
    outer = j < const.nj if family == WARP else i < const.ni
    for end in range(2):
        m = k + end * (s if family == WARP else 1)
        for side in range(2):
            if (side == 0 and inner) or (side == 1 and outer):
                at = np.uint64(m - back if side == 0 else m)
                w = crossing_weight(split, np.uint64(m), side == 0, not (inner and outer))
                count += w
                present += w * alpha[at]
                total += w * alpha[at] * x[np.uint64(np.int64(at) - shift)]
    return count, present, total


@unit(later=True, x="n", mean="n")
def damaged_means(const, state, family, first, last, shift, x, mean):
    """Mean of x over the crossing edges, weighted by their intact fraction, for damaged edges of the rows first ..
    last - 1."""
    columns = const.row_stride if family == WARP else const.nj
    for i in range(first, last):
        for start in range(0, columns, WIDTH):
            if not edges_damaged(const, state, family, i, start):
                continue
            for j in range(start, min(start + WIDTH, columns)):
                _, present, total = sum_crossing(
                    const, family, i, j, state.intact_fraction[1 - family], x, shift
                )
                if present > 0.0:
                    mean[np.uint64(i * const.row_stride + j - shift)] = total / present


@unit(later=True, L="n", F="n")
def damaged_forces(const, state, family, first, last, shift, L, F):
    """F = kappa F + (1 - kappa) T_alone of damaged edges; 0 where the yarns themselves have failed."""
    w, S0, EA = yarn_properties(const, family)
    columns = const.row_stride if family == WARP else const.nj
    for i in range(first, last):
        for start in range(0, columns, WIDTH):
            if not edges_damaged(const, state, family, i, start):
                continue
            for j in range(start, min(start + WIDTH, columns)):
                m = np.uint64(i * const.row_stride + j - shift)
                if state.intact_fraction[family][np.uint64(i * const.row_stride + j)] == 0.0:
                    F[m] = 0.0
                    continue
                count, present, _ = sum_crossing(
                    const, family, i, j, state.intact_fraction[1 - family], L, shift
                )
                if present < count:
                    crossed = present / count
                    alone = yarn_alone(L[m], w, S0, EA)[0]
                    F[m] = crossed * F[m] + (1.0 - crossed) * alone


@unit(later=True, L="n", own="n", shared="n", N="n")
def damaged_gradient(const, state, family, first, last, shift, L, own, shared, N):
    """The variational force of damaged edges: own share, and, of each crossing edge, the share `shared` that it
    gives."""
    w, S0, EA = yarn_properties(const, family)
    other, columns = (
        state.intact_fraction[1 - family],
        const.row_stride if family == WARP else const.nj,
    )
    for i in range(first, last):
        for start in range(0, columns, WIDTH):
            if not edges_damaged(const, state, family, i, start):
                continue
            for j in range(start, min(start + WIDTH, columns)):
                m = np.uint64(i * const.row_stride + j - shift)
                if state.intact_fraction[family][np.uint64(i * const.row_stride + j)] == 0.0:
                    N[m] = 0.0
                    continue
                count, present, total = sum_crossing(const, family, i, j, other, shared, shift)
                crossed = present / count
                alone = yarn_alone(L[m], w, S0, EA)[0] if present < count else 0.0
                N[m] = 0.5 * (crossed * own[m] + total / count) + (1.0 - crossed) * alone


@unit(later=True, turn1="n", turn2="n", cross="n")
def damaged_trellis(const, state, first, last, shift, turn1, turn2, cross):
    """Shear forces of damaged elements, scaled by the intact fractions of both families."""
    s = const.row_stride
    for i in range(first, last):
        for start in range(0, const.nj, WIDTH):
            if not damage_near(state.element_flag, i * s + start, s, 0, 0):
                continue
            for j in range(start, min(start + WIDTH, const.nj)):
                m, left = (
                    i * s + j - shift,
                    trellis_intact_fraction(const, state, np.uint64(i * s + j)),
                )
                turn1[m] *= left
                turn2[m] *= left
                cross[m] *= left


@kernel()
def trellis_intact_fraction(const, state, k):
    """Intact fraction of the trellis of element k."""
    warp, weft = state.intact_fraction[WARP], state.intact_fraction[WEFT]
    return 0.25 * (warp[k] + warp[k + ONE]) * (weft[k] + weft[k + np.uint64(const.row_stride)])


@kernel()
def yarn_properties(const, family):
    """(w, S0, EA) of a family."""
    return (const.w1, const.S01, const.EA1) if family == WARP else (const.w2, const.S02, const.EA2)
