"""Sums over the edges of the other family that cross an edge, with the weights of graded panels."""

import numpy as np
from numba import types
from numba.extending import overload

from shellfabric.jit.compile import kernel

WARP = 0


def crossing_weight(split, k, before, alone):
    """Weight of the piece of a crossing line before (or behind) the node k, relative to the mean of the two."""


@overload(crossing_weight, inline="always")
def _crossing_weight(split, k, before, alone):
    if isinstance(split, types.Float):
        return lambda split, k, before, alone: 1.0
    return lambda split, k, before, alone: 1.0 if alone else 2.0 * (split[k] if before else 1.0 - split[k])


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
