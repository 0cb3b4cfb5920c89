"""Interpolation in the table of the crossover cell: tensions (bilinear), potential and its gradient
(biquadratic).

Beyond the table, which ends 2 % above the strength, come lines beside a yarn that has failed: they
stand for a part of its fibres and are drawn out far. The local coordinates p, q are cut off at 1;
what is beyond, a and b, extrapolates as docs/theory-cell.md says ("Beyond the table"). Forces are
continuous and those of one potential; the tangent stays positive and, for five fabrics, below the
largest of the table, which the time step is made for.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    broadcast,
    floor,
    fma,
    gather8_indexed,
    gather_rows4,
    greater,
    head_mask,
    load,
    maximum,
    minimum,
    reduce_max,
    store,
    store_int32,
    to_int32,
    where,
)
from shellfabric.state import unit


@kernel(forceinline=True)
def saturated(over, reach):
    """Compute g of a way beyond the table, and its slope."""
    part = 1.0 / (1.0 + over / reach)
    return over * part, part * part


@unit("number", l1="n", l2="n", grid="7 numbers", table="cells, 4", reaches="2 numbers", T="n")
def bilinear_tensions(m0, n, l1, l2, grid, table, reaches, T):
    """Interpolate one tension [N] bilinearly at n pairs of stretches. Returns the largest, at least
    0.

    grid : where the table begins, cells per stretch and number of the last cell, of both stretches;
        cells along the second. Below the table its edge, which is exact there; above it linear, but
        for `reaches`, the cells to which either stretch counts beyond it.
    """
    x0, rx, top1, y0, ry, top2, across = grid
    greatest = broadcast(0.0)
    for j in range(0, n, WIDTH):
        m = m0 + j
        p = maximum((load(l1, m) - x0) * rx, 0.0)
        q = maximum((load(l2, m) - y0) * ry, 0.0)
        cell1 = floor(minimum(p, top1))
        cell2 = floor(minimum(q, top2))
        c = gather_rows4(table, to_int32(fma(cell1, across, cell2)))
        p = p - cell1
        q = q - cell2
        if any_lane(greater(maximum(p, q), 1.0)):
            p = minimum(p, 1.0) + saturated(maximum(p - 1.0, 0.0), reaches[0])[0]
            q = minimum(q, 1.0) + saturated(maximum(q - 1.0, 0.0), reaches[1])[0]
        tension = fma(q, fma(c[3], p, c[2]), fma(c[1], p, c[0]))
        store(T, m, tension)
        greatest = maximum(greatest, where(head_mask(n - j), tension, 0.0))
    return reduce_max(greatest)


@kernel(forceinline=True)
def gradient(p, q, c):
    """Compute W_p and W_q at eight places in the table."""
    flat1 = fma(q, fma(q, c[6], c[4]), c[0])
    turn1 = fma(q, fma(q, c[7], c[5]), c[1])
    flat2 = fma(p, fma(p, c[5], c[4]), c[2])
    turn2 = fma(p, fma(p, c[7], c[6]), c[3])
    return fma(p + p, turn1, flat1), fma(q + q, turn2, flat2)


@kernel(forceinline=True)
def mixed(p, q, c):
    """Compute W_pq."""
    return (c[4] + 2.0 * p * c[5]) + 2.0 * q * (c[6] + 2.0 * p * c[7])


@kernel(forceinline=True)
def gradient_beyond(p, q, c, beyond):
    """Compute `gradient` at eight places, of which some are beyond the table."""
    reach1, reach2, t1, t2, k1, k2 = beyond
    over1 = maximum(p - 1.0, 0.0)
    over2 = maximum(q - 1.0, 0.0)
    p = minimum(p, 1.0)
    q = minimum(q, 1.0)
    force1, force2 = gradient(p, q, c)
    far1, slope1 = saturated(over1, reach1)
    far2, slope2 = saturated(over2, reach2)
    both = mixed(p, q, c)
    force1 = (
        where(greater(over1, 0.0), slope1 * (force1 - t1) + (t1 + k1 * over1), force1)
        + slope1 * far2 * both
    )
    force2 = (
        where(greater(over2, 0.0), slope2 * (force2 - t2) + (t2 + k2 * over2), force2)
        + slope2 * far1 * both
    )
    return force1, force2


@unit(
    "4 numbers",
    l1="n",
    l2="n",
    grid="7 numbers",
    table="cells, 8",
    beyond="6 numbers",
    factors="2 numbers",
    spots="n int32",
    N1="n",
    N2="n",
)
def potential_forces(m0, n, l1, l2, grid, table, beyond, factors, spots, N1, N2):
    """Compute the gradient of the biquadratic potential, N = factor dW/d(local coordinate).

    beyond : reach1, reach2, t1, t2, k1, k2 (see above);  factors : of N1 and of N2

    Below the table its edge, which is exact there. table (cells, 8) : of p, p p, q, q q, p q, p p
    q, p q q, p p q q. Returns the largest p and q, the places in the table in units of its cells,
    and the largest N1 and N2, at least 0.

    A piece of spots.size slots at a time, in two loops: the first finds places in the table, which
    are kept in spots, N1 and N2, and the second what stands there. In one loop the rows wait for
    their number and the sums for the rows, and what waits fills all the buffers that a processor has
    for it.
    """
    far1 = broadcast(0.0)
    far2 = broadcast(0.0)
    high1 = broadcast(0.0)
    high2 = broadcast(0.0)
    x0, rx, top1, y0, ry, top2, across = grid
    for start in range(m0, m0 + n, spots.size):
        stop = min(start + spots.size, m0 + n)
        for j in range(start, stop, WIDTH):
            p = maximum((load(l1, j) - x0) * rx, 0.0)
            q = maximum((load(l2, j) - y0) * ry, 0.0)
            cell1 = floor(minimum(p, top1))
            cell2 = floor(minimum(q, top2))
            store_int32(spots, j - start, to_int32(fma(cell1, across, cell2)))
            store(N1, j, p - cell1)
            store(N2, j, q - cell2)
            far1 = maximum(far1, where(head_mask(stop - j), p, 0.0))
            far2 = maximum(far2, where(head_mask(stop - j), q, 0.0))
        for j in range(start, stop, WIDTH):
            p = load(N1, j)
            q = load(N2, j)
            c = gather8_indexed(table, spots, j - start)
            force1, force2 = gradient(p, q, c)
            if any_lane(greater(maximum(p, q), 1.0)):
                force1, force2 = gradient_beyond(p, q, c, beyond)
            force1 = factors[0] * force1
            force2 = factors[1] * force2
            store(N1, j, force1)
            store(N2, j, force2)
            high1 = maximum(high1, where(head_mask(stop - j), force1, 0.0))
            high2 = maximum(high2, where(head_mask(stop - j), force2, 0.0))
    return reduce_max(far1), reduce_max(far2), reduce_max(high1), reduce_max(high2)


@kernel(forceinline=True)
def potential_at(p, q, over1, over2, c, level, beyond):
    """Compute the potential [J] at local coordinates that are at most 1, and beyond them; of one
    place or of eight."""
    reach1, reach2, t1, t2, k1, k2 = beyond
    far1 = saturated(over1, reach1)[0]
    far2 = saturated(over2, reach2)[0]
    one = c[0] + q * (c[4] + q * c[6])
    two = c[1] + q * (c[5] + q * c[7])
    W = level + q * (c[2] + q * c[3]) + p * (one + p * two)
    turn2 = c[3] + p * (c[6] + p * c[7])
    slope1 = one + 2.0 * p * two
    slope2 = c[2] + p * (c[4] + p * c[5]) + 2.0 * q * turn2
    W = W + far1 * (slope1 - t1) + over1 * (t1 + 0.5 * k1 * over1)
    W = W + far2 * (slope2 - t2) + over2 * (t2 + 0.5 * k2 * over2)
    return W + far1 * far2 * mixed(p, q, c)


@kernel()
def potential(l1, l2, grid, table, beyond, level):
    """Compute the biquadratic potential [J] at a pair of stretches, for `potential_forces`.

    level : (cells,) [J] of 1
    """
    x0, rx, top1, y0, ry, top2, across = grid
    p = max((l1 - x0) * rx, 0.0)
    q = max((l2 - y0) * ry, 0.0)
    cell1 = math.floor(min(p, top1))
    cell2 = math.floor(min(q, top2))
    m = np.int64(cell1 * across + cell2)
    p = p - cell1
    q = q - cell2
    return potential_at(
        min(p, 1.0), min(q, 1.0), max(p - 1.0, 0.0), max(q - 1.0, 0.0), table[m], level[m], beyond
    )


@kernel()
def max_value(m0, n, values):
    """Find the largest of n values, at least 0."""
    found = broadcast(0.0)
    for j in range(0, n, WIDTH):
        found = maximum(found, where(head_mask(n - j), load(values, m0 + j), 0.0))
    return reduce_max(found)
