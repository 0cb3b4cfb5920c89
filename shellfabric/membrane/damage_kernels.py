"""Forces of blocks in which yarns have failed: each edge has its intact fraction alpha for a weight.

The mean of alpha over the edges that cross an edge is its crossed fraction kappa (`membrane_kernels`).
Weighted by alpha, the means of a whole block are those of a damaged one, and so are the forces that
edges share: both take the same sums. What is not crossed bears as a straight yarn, which is looked at
edge by edge.
"""

import numpy as np

from shellfabric.cell.yarn_kernels import yarn_alone
from shellfabric.jit.compile import kernel
from shellfabric.membrane.membrane_kernels import (
    ONE,
    average,
    copy_slots,
    repeat_rim,
    scratch_slot,
    share_forces,
)
from shellfabric.state import RESOLVED, WARP, WEFT, unit


@unit(later=True)
def damaged_means(state, const, work, first, last):
    """Compute the intact fractions of a block's edges and of those that cross them; mean stretches
    of the crossing edges, weighted by their intact fractions, or 1 where none is left."""
    s = const.row_stride
    low = max(first - 1, 0)
    begin = scratch_slot(const, first, low)
    end = end_of_block(const, first, last)
    for family in range(2):
        copy_slots(state.intact_fraction[family], low * s, end - begin, work.intact[family], begin)
    repeat_rim(const, first, last, work.intact[WARP])
    average(const, first, last, work.intact, work.mean_intact)
    weighted = work.N  # not needed yet
    for family in range(2):
        for j in range(s, end):
            weighted[family][j] = work.intact[family][j] * work.stretch[family][j]
    average(const, first, last, weighted, work.mean_stretch)
    for family in range(2):
        present = work.mean_intact[family]
        mean = work.mean_stretch[family]
        for j in range(s, end):
            if present[j] > 0.0:
                mean[j] /= present[j]
            else:
                mean[j] = 1.0


@kernel()
def end_of_block(const, first, last):
    """Return the slot of the scratch behind the row of weft edges at the far end of a block."""
    return scratch_slot(const, first, last + 1)


@unit(later=True)
def damaged_gradient(state, const, work, first, last):
    """Compute the variational force of damaged edges: own share, and, of each crossing edge, the
    share that it gives."""
    end = end_of_block(const, first, last)
    for family in range(2):
        weigh(work.dW_crossing[family], work.intact[family], const.row_stride, end)
        weigh(work.dW_own[family], work.mean_intact[1 - family], const.row_stride, end)
    share_forces(state, const, work, first, last)
    for family in range(2):
        bear_alone(const, work, family, end, work.N[family])


@unit(later=True)
def damaged_tensions(const, work, first, last):
    """Compute T = kappa T + (1 - kappa) T_alone of damaged edges; 0 where the yarns themselves have
    failed."""
    end = end_of_block(const, first, last)
    for family in range(2):
        weigh(work.T[family], work.mean_intact[1 - family], const.row_stride, end)
        bear_alone(const, work, family, end, work.T[family])


@kernel(_nrt=False)
def weigh(x, weight, begin, end):
    """Multiply x by a weight."""
    for j in range(begin, end):
        x[j] *= weight[j]


@kernel(_nrt=False)
def bear_alone(const, work, family, end, force):
    """Add what edges bear in which crossing yarns have failed, (1 - kappa) T_alone; failed edges
    bear nothing."""
    w, S0, EA = yarn_properties(const, family)
    intact = work.intact[family]
    crossed = work.mean_intact[1 - family]
    for j in range(2 * const.row_stride, end):
        if intact[j] == 0.0:
            force[j] = 0.0
        elif crossed[j] < 1.0:
            alone = yarn_alone(work.stretch[family][j], w, S0, EA)[0]
            force[j] += (1.0 - crossed[j]) * alone


@unit(later=True)
def damaged_trellis(state, const, work, first, last):
    """Shear forces of damaged elements, scaled by the intact fractions of both families."""
    s = const.row_stride
    low = max(first - 1, 0)
    shift = (first - 2) * s
    for k in range(low * s, last * s):
        left = trellis_intact_fraction(const, state, np.uint64(k))
        work.trellis_turn[WARP][k - shift] *= left
        work.trellis_turn[WEFT][k - shift] *= left
        work.trellis_cross[k - shift] *= left


@kernel()
def trellis_intact_fraction(const, state, k):
    """Compute the intact fraction of the trellis of element k: 0 where its yarns are resolved, which
    bear shear by themselves."""
    if state.element_flag[k] & RESOLVED:
        return 0.0
    warp = state.intact_fraction[WARP]
    weft = state.intact_fraction[WEFT]
    return 0.25 * (warp[k] + warp[k + ONE]) * (weft[k] + weft[k + np.uint64(const.row_stride)])


@kernel()
def yarn_properties(const, family):
    """Return (w, S0, EA) of a family."""
    if family == WARP:
        return (const.w1, const.S01, const.EA1)
    return (const.w2, const.S02, const.EA2)
