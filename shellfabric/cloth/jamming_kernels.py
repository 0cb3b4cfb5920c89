"""Jamming: resistance of cloth to in-plane compression once neighbouring yarns touch.

A crossover has no stiffness when its yarns go slack, and nothing in the source's cell keeps an element from being
pressed flat, where the trellis, which acts along unit vectors, tears it apart. Where yarns do not fail, as in the
source's study of pencilling, cloth does bunch up about the projectile so far. A segment of stretch l below l_j stores

    U = y K / 2 ln(l / l_j)^2,     N = dU/dl / y = K ln(l / l_j) / l        (pressure negative)

with y [m] the length of yarn that it stands for. The source has no such term; K = 0 leaves it out.
"""

import math

import numpy as np

from shellfabric.cloth.bending_kernels import segment
from shellfabric.jit.compile import kernel


@kernel(_nrt=False)
def family(state, const, number, first, last, acting):
    """Energy of one family's segments in the node rows first .. last; adds their forces to state.g0 if `acting`."""
    total, K, limit = 0.0, const.jam[0], const.jam[1]
    rest, step = (const.dx, const.s) if number == 0 else (const.dy, 1)
    rows = min(last + 1, const.ni) if number == 0 else last + 1
    columns = const.nj + 1 if number == 0 else const.nj
    for i in range(first, rows):
        for j in range(columns):
            k = np.uint64(i * const.s + j)
            part = state.intact[number][k]
            if part == 0.0:
                continue
            t, length = segment(state, const, number, k)
            stretch = length / rest
            if stretch >= limit:
                continue
            closed = math.log(stretch / limit)
            yarn = part * state.y[number][k]
            total += 0.5 * yarn * K * closed * closed
            if acting:
                far = np.uint64(np.int64(k) + step)
                push = yarn * K * closed / (stretch * rest)
                for c in range(3):
                    state.g0[c][k] += push * t[c]
                    state.g0[c][far] -= push * t[c]
    return total


@kernel(_nrt=False)
def jam(state, const, first, last, acting):
    """Energy of all segments in the node rows first .. last; adds their forces to state.g0 if `acting`."""
    if const.jam[0] == 0.0:
        return 0.0
    return family(state, const, 0, first, last, acting) + family(state, const, 1, first, last, acting)
