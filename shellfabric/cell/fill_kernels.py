"""The table of a cell by Newton's method on force and heights together, from the solution of the cell
before.

`crossover_kernels` solves one cell by nested iterations within brackets, which cannot fail. Along a
row of a table the solution changes little: here the contact force F and both heights h_i are unknowns
beside each other, F_i(h_i) = F with the contact force F_i of a yarn at its height, and thesis eq.
4-13, from which the step of F follows with h_i eliminated. Where steps do not become small or leave
the range, or compression depends on the strain of the yarns, the nested iterations solve the cell.
What depends on one stretch alone is computed once a row or column. Results agree but for rounding.
"""

import math

import numpy as np

from shellfabric.cell.crossover_kernels import (
    VARIATIONAL,
    cell,
    compression,
    contact_force,
    filled_height,
    forces_of_cell,
    may_part,
    slack_height,
    work_share,
)
from shellfabric.cell.yarn_kernels import elliptic, floating, lone_yarn, tension
from shellfabric.jit.compile import entry, kernel

_MAX_STEPS = 12
_SMALL = 1e-9  # relative step after which the error, which is of its square, is that of rounding


@kernel()
def force_at_height(w, h, yarn, crossover):
    """Compute the contact force of a yarn at the height h and its slope: those of `contact_force`,
    with one elliptic integral."""
    if crossover.straight or crossover.form != VARIATIONAL or h <= 0.0:
        F, slope, _ = contact_force(w, h, yarn, crossover)
        return F, slope
    k = 0.5 * math.pi * h / w
    E, K_minus_E = elliptic(k * k)
    dS = yarn.turning * (-2.0 * K_minus_E / k)
    T, dT = tension(floating(4.0 * w / math.pi * E, w, yarn.turning), dS, yarn)
    curvature = T * math.pi / w * (K_minus_E / (k * k) + E / (1.0 + k * k))
    slope = dT * dS + yarn.turning * curvature
    q = work_share(crossover.form)
    return T * dS / q, slope / q


@kernel()
def close_cell(w, free, crossover, start):
    """Solve for (F, h1, h2) of a cell in contact, from those of another; F = -1 if the steps do not
    converge."""
    F, h1, h2 = start
    warp = crossover.warp
    weft = crossover.weft
    if warp.stiffening > 0.0 or weft.stiffening > 0.0:
        return -1.0, 0.0, 0.0
    full = filled_height(crossover) - crossover.gap
    for _ in range(_MAX_STEPS):
        F1, s1 = force_at_height(w[0], h1, warp, crossover)
        F2, s2 = force_at_height(w[1], h2, weft, crossover)
        d1, e1 = compression(F, warp.a, warp.b, warp.shift)
        d2, e2 = compression(F, weft.a, weft.b, weft.shift)
        if not (s1 > 0.0 and s2 > 0.0):
            break
        miss1 = (F - F1) / s1
        miss2 = (F - F2) / s2
        dF = -(h1 + h2 + d1 + d2 - full + miss1 + miss2) / (1.0 / s1 + 1.0 / s2 + e1 + e2)
        dh1 = miss1 + dF / s1
        dh2 = miss2 + dF / s2
        F = F + dF
        h1 = h1 + dh1
        h2 = h2 + dh2
        if not (F > 0.0 and h1 >= free[0] and h2 >= free[1]):
            break
        if abs(dF) <= _SMALL * F and abs(dh1) <= _SMALL * w[0] and abs(dh2) <= _SMALL * w[1]:
            return F, h1, h2
    return -1.0, 0.0, 0.0


@entry(nogil=True)
def fill(stretches1, stretches2, crossover, out):
    """Fill out (8, n1, n2), values as in `crossover_kernels.cell`, on a grid of stretches; False if
    a cell failed."""
    warp = crossover.warp
    weft = crossover.weft
    n2 = stretches2.size
    free2 = np.empty(n2)
    alone2 = np.empty(n2)
    stored2 = np.empty(n2)
    for j in range(n2):
        free2[j] = slack_height(stretches2[j] * weft.w, weft, crossover)
        alone2[j], stored2[j] = lone_yarn(stretches2[j], weft)
    parts = may_part(crossover)
    full = filled_height(crossover)
    for i in range(stretches1.size):
        free1 = slack_height(stretches1[i] * warp.w, warp, crossover)
        alone1, stored1 = lone_yarn(stretches1[i], warp)
        last = (-1.0, 0.0, 0.0)
        guess = 1.0
        for j in range(n2):
            w = stretches1[i] * warp.w, stretches2[j] * weft.w
            free = free1, free2[j]
            apart = parts and free1 + free2[j] + crossover.gap >= full
            stored = stored1 + stored2[j]
            values = (alone1, alone2[j], alone1, alone2[j], 0.0, free1, free2[j], stored)
            if crossover.coupled and not apart:
                found = (-1.0, 0.0, 0.0)
                if last[0] > 0.0:
                    found = close_cell(w, free, crossover, last)
                if found[0] > 0.0:
                    values = forces_of_cell(w, crossover, found)
                else:
                    values = cell(stretches1[i], stretches2[j], crossover, guess)
                    if values[4] < 0.0:
                        return False
                guess = max(values[4], 1e-6)
            last = (values[4], values[5], values[6])
            for c in range(8):
                out[c, i, j] = values[c]
    return True
