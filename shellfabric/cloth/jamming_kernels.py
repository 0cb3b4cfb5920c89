"""Jamming: resistance of fabric to in-plane compression once neighbouring yarns touch.

A crossover has no stiffness when its yarns go slack, and nothing in the cell of the thesis keeps an element from being
pressed flat, where the trellis, which acts along unit vectors, tears it apart. Where yarns do not fail, as in the
thesis's study of pencilling, fabric does bunch up about the projectile so far. A segment of stretch l below l_j stores

    U = y K / 2 ln(l / l_j)^2,     N = dU/dl / y = K ln(l / l_j) / l        (pressure negative)

with y [m] the length of whole yarn that it stands for. The thesis has no such term; K = 0 leaves it out.
"""

import math

import numpy as np

from shellfabric.cloth.bending_kernels import rest_length, segment_tangent
from shellfabric.jit.compile import kernel
from shellfabric.state import unit


@unit("number")
def family_jamming(state, const, number, first, last, acting):
    """Energy of one family's segments in the node rows first .. last; adds their forces to state.f_int if `acting`."""
    total, K, limit = 0.0, const.jamming[0], const.jamming[1]
    step = const.row_stride if number == 0 else 1
    rows = min(last + 1, const.ni) if number == 0 else last + 1
    columns = const.nj + 1 if number == 0 else const.nj
    for i in range(first, rows):
        for j in range(columns):
            k = np.uint64(i * const.row_stride + j)
            yarn = state.yarn_length[number][k]  # of what is left of it
            if yarn == 0.0:
                continue
            t, length = segment_tangent(state, const, number, k)
            rest = (
                rest_length(const.dx, const.inv_dx, k)
                if number == 0
                else rest_length(const.dy, const.inv_dy, k)
            )
            stretch = length / rest
            if stretch >= limit:
                continue
            closed = math.log(stretch / limit)
            total += 0.5 * yarn * K * closed * closed
            if acting:
                far = np.uint64(np.int64(k) + step)
                push = yarn * K * closed / (stretch * rest)
                for c in range(3):
                    state.f_int[c][k] += push * t[c]
                    state.f_int[c][far] -= push * t[c]
    return total


@kernel(_nrt=False)
def jamming_forces(law, state, const, first, last, acting):
    """Energy of all segments in the node rows first .. last; adds their forces to state.f_int if `acting`.

    law : const.jamming
    """
    if law[0] == 0.0:
        return 0.0
    return family_jamming(state, const, 0, first, last, acting) + family_jamming(
        state, const, 1, first, last, acting
    )
