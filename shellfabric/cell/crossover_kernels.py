"""The biaxial crossover, solved as one monotone equation in the contact force (docs/theory-cell.md,
"Unit cell"; thesis section 4.3.1; errata E-05, E-06, E-09, E-10).

    r(F) = h_1(F) + h_2(F) + d_1(F) + d_2(F) + g - h_01 - h_02 = 0   (eq. 4-13)

has one root at most, since heights and compressions rise with F. Contact is lost exactly where r(0)
>= 0 at the free heights. Where a weave has floats, a yarn changes sides over a share f of its way
alone (`yarn_kernels.floating`): F, the mean over the crossings, is f times as much in both forms.
Yarns that are straight from crossing to crossing press at the crossing alone: both forms then have
one F, that of q = 1, and differ in the forces N.
"""

import math

from shellfabric.cell.yarn_kernels import (
    arc,
    arc_curvature,
    floating,
    free_height,
    lone_yarn,
    straight_arc,
    straight_curvature,
    straight_free_height,
    strain_energy,
    tension,
    turning_length,
)
from shellfabric.jit.compile import entry, kernel

EQUILIBRIUM = 0
VARIATIONAL = 1
_MAX_STEPS = 200


@kernel()
def may_part(crossover):
    """Tell whether contact can be lost: no law of compression is the printed one, which has d(0) =
    -infinity (erratum E-05)."""
    warp = crossover.warp
    weft = crossover.weft
    printed1 = warp.a > 0.0 and warp.shift == 0.0
    printed2 = weft.a > 0.0 and weft.shift == 0.0
    return not (printed1 or printed2)


@kernel()
def filled_height(crossover):
    """Return the height [m] of both yarns together at which the cell is full."""
    return crossover.warp.h0 + crossover.weft.h0


@kernel()
def work_share(form):
    """Return q, the force that does work on a change of height over the contact force."""
    if form == VARIATIONAL:
        return 0.25 * math.pi
    return 1.0


@kernel()
def share_of_work(crossover):
    """Return q of a crossover."""
    if crossover.straight:
        return 1.0
    return work_share(crossover.form)


@kernel()
def length(w, h, yarn, crossover):
    """Compute the length S of a yarn whose centreline has the height h, and dS/dh."""
    if crossover.straight:
        S, dS = straight_arc(w, h)
    else:
        S, dS = arc(w, h)
    return floating(S, w, yarn.turning), yarn.turning * dS


@kernel()
def length_curvature(w, h, yarn, crossover):
    """Compute d2S/dh2 of the same."""
    if crossover.straight:
        return yarn.turning * straight_curvature(w, h)
    return yarn.turning * arc_curvature(w, h)


@kernel()
def slack_height(w, yarn, crossover):
    """Compute the height at which a yarn has its own length S0; 0 if it is stretched flat."""
    if crossover.straight:
        return straight_free_height(w, turning_length(yarn.S0, w, yarn.turning))
    return free_height(w, turning_length(yarn.S0, w, yarn.turning))


@kernel()
def contact_force(w, h, yarn, crossover):
    """Compute the contact force of one yarn at height h, its slope dF/dh, and the tension."""
    S, dS = length(w, h, yarn, crossover)
    T, dT = tension(S, dS, yarn)
    if crossover.straight:
        return T * dS, dT * dS + T * length_curvature(w, h, yarn, crossover), T
    if crossover.form == EQUILIBRIUM:
        k = 0.5 * math.pi * h / w
        root = math.sqrt(1.0 + k * k)
        sine = k / root
        slope = 2.0 * (dT * sine + T * 0.5 * math.pi / (w * root**3))
        return yarn.turning * (2.0 * T * sine), yarn.turning * slope, T
    q = work_share(crossover.form)
    return T * dS / q, (dT * dS + T * length_curvature(w, h, yarn, crossover)) / q, T


@kernel()
def stiffness_factor(S, yarn):
    """Return 1 + s e, by which a yarn of the length S withstands compression more than at rest."""
    return 1.0 + yarn.stiffening * max(S - yarn.S0, 0.0) / yarn.S0


@kernel()
def carried_force(w, h, F, yarn, crossover):
    """Compute the contact force that a yarn at height h carries if F compresses it, and its slopes
    by h and by F."""
    force, slope, _ = contact_force(w, h, yarn, crossover)
    if yarn.stiffening == 0.0 or crossover.form == EQUILIBRIUM:
        return force, slope, 0.0
    S, dS = length(w, h, yarn, crossover)
    curvature = length_curvature(w, h, yarn, crossover)
    factor = stiffness_factor(S, yarn)
    growth = yarn.stiffening / yarn.S0
    at_rest = F / factor
    stored = compression_energy(at_rest, yarn.a, yarn.b, yarn.shift)
    work = at_rest * compression(at_rest, yarn.a, yarn.b, yarn.shift)[1]
    # the force that would compress a yarn at rest as much falls with the length
    fall = at_rest * growth * dS / factor
    force += growth * stored * dS
    slope += growth * (stored * curvature - work * fall * dS)
    return force, slope, growth * work / factor * dS


@kernel()
def height(w, F, yarn, lowest, crossover):
    """Solve for the height at which the yarn carries the contact force F > 0, from its free height
    `lowest`, and the slope dh/dF.

    Newton's method kept within a bracket; the force rises with the height from zero at `lowest`.
    """
    low = lowest
    high = lowest + 0.05 * w
    while carried_force(w, high, F, yarn, crossover)[0] < F:
        low = high
        high = 2.0 * high
    h = high
    for _ in range(_MAX_STEPS):
        force, slope, _ = carried_force(w, h, F, yarn, crossover)
        if force > F:
            high = h
        else:
            low = h
        step = (force - F) / slope
        h -= step
        if not low <= h <= high:
            h = 0.5 * (low + high)
        if abs(step) <= 1e-14 * w or high - low <= 1e-15 * w:
            break
    _, slope, own = carried_force(w, h, F, yarn, crossover)
    return h, (1.0 - own) / slope


@kernel()
def compression(F, a, b, shift):
    """Compute d_c and its slope dd_c/dF at the contact force F > 0 (eqs. 4-12, 4-28)."""
    if a == 0.0:
        return 0.0, 0.0
    root = (F + shift) ** (-1.0 / 3.0)
    return a - b * root, b / 3.0 * root / (F + shift)


@kernel()
def compression_energy(F, a, b, shift):
    """Compute the work of the contact force up to F: the integral of F dd_c."""
    if a == 0.0:
        return 0.0
    d = a - b * (F + shift) ** (-1.0 / 3.0)
    return F * d - (a * F - 1.5 * b * ((F + shift) ** (2.0 / 3.0) - shift ** (2.0 / 3.0)))


@kernel()
def compression_at_height(F, w, h, yarn, crossover):
    """Compute d_c of a yarn at height h, and its slopes by F and by h."""
    if yarn.stiffening == 0.0:
        d, slope = compression(F, yarn.a, yarn.b, yarn.shift)
        return d, slope, 0.0
    S, dS = length(w, h, yarn, crossover)
    factor = stiffness_factor(S, yarn)
    d, slope = compression(F / factor, yarn.a, yarn.b, yarn.shift)
    return d, slope / factor, -slope * F / factor**2 * yarn.stiffening * dS / yarn.S0


@kernel()
def stored_by_compression(F, S, yarn):
    """Compute the work of compression of a yarn of the length S up to the contact force F."""
    factor = stiffness_factor(S, yarn)
    return factor * compression_energy(F / factor, yarn.a, yarn.b, yarn.shift)


@kernel()
def residual(F, w, free, crossover):
    """Compute r(F) and its slope; w, free : (warp, weft) half lengths and free heights."""
    warp = crossover.warp
    weft = crossover.weft
    h1, c1 = height(w[0], F, warp, free[0], crossover)
    h2, c2 = height(w[1], F, weft, free[1], crossover)
    d1, e1, f1 = compression_at_height(F, w[0], h1, warp, crossover)
    d2, e2, f2 = compression_at_height(F, w[1], h2, weft, crossover)
    slope = c1 + c2 + e1 + e2 + f1 * c1 + f2 * c2
    return h1 + h2 + d1 + d2 + crossover.gap - warp.h0 - weft.h0, slope


@kernel()
def closing_force(w, free, crossover, guess):
    """Find the root of r(F); 0 if contact is lost; -1 if none was found.

    r(0) is the gap at the free heights when the law of compression starts from zero.
    """
    parted = free[0] + free[1] + crossover.gap >= filled_height(crossover)
    if parted and may_part(crossover):
        return 0.0
    low = 0.0
    high = max(guess, 1e-6)
    while residual(high, w, free, crossover)[0] < 0.0:
        low = high
        high = 4.0 * high
        if high > 1e12:
            return -1.0
    F = high
    for _ in range(_MAX_STEPS):
        r, slope = residual(F, w, free, crossover)
        if r > 0.0:
            high = F
        else:
            low = F
        if abs(r) <= 1e-14 * (crossover.warp.w + crossover.weft.w):
            return F
        step = r / slope
        F -= step
        if not low < F < high:
            if low > 0.0:
                F = math.sqrt(low * high)
            else:
                F = 0.125 * high
        if abs(step) <= 1e-14 * F or high - low <= 1e-15 * high or high < 1e-14:
            return F
    return -1.0


@kernel()
def forces_of_cell(w, crossover, solution):
    """Compute (T1, T2, N1, N2, F, h1, h2, W) of a cell in contact, whose solution is (F, h1, h2);
    see `cell`."""
    warp = crossover.warp
    weft = crossover.weft
    F, h1, h2 = solution
    S1, dS1 = length(w[0], h1, warp, crossover)
    S2, dS2 = length(w[1], h2, weft, crossover)
    T1, _ = tension(S1, dS1, warp)
    T2, _ = tension(S2, dS2, weft)
    if crossover.form == VARIATIONAL:
        # what balances the contact force: the fibres' tension and the growth of the work
        if warp.stiffening > 0.0:
            T1 = share_of_work(crossover) * F / dS1
        if weft.stiffening > 0.0:
            T2 = share_of_work(crossover) * F / dS2
    W = strain_energy(S1, warp) + strain_energy(S2, weft)
    stored = stored_by_compression(F, S1, warp) + stored_by_compression(F, S2, weft)
    W += share_of_work(crossover) * stored
    N1 = T1
    N2 = T2
    if crossover.form == VARIATIONAL:
        # S is homogeneous of degree one in (w, h), so that dS/d(2w) = (S - h dS/dh) / 2w
        N1 = T1 * (S1 - h1 * dS1) / (2.0 * w[0])
        N2 = T2 * (S2 - h2 * dS2) / (2.0 * w[1])
    return T1, T2, N1, N2, F, h1, h2, W


@kernel()
def cell(stretch1, stretch2, crossover, guess):
    """Solve one crossover at given stretches: (T1, T2, N1, N2, F, h1, h2, W).

    T are the yarn tensions, N the forces conjugate to the cell lengths: T in the equilibrium form
    (erratum E-15), and the gradient of W, N = T dS/d(2w), in the variational form. W is the energy
    of the yarns and of their compression.
    """
    warp = crossover.warp
    weft = crossover.weft
    alone1, energy1 = lone_yarn(stretch1, warp)
    alone2, energy2 = lone_yarn(stretch2, weft)
    w = stretch1 * warp.w, stretch2 * weft.w
    free = slack_height(w[0], warp, crossover), slack_height(w[1], weft, crossover)
    F = 0.0
    if crossover.coupled:
        F = closing_force(w, free, crossover, guess)
    if F == 0.0:
        return alone1, alone2, alone1, alone2, 0.0, free[0], free[1], energy1 + energy2
    h1 = height(w[0], F, warp, free[0], crossover)[0]
    h2 = height(w[1], F, weft, free[1], crossover)[0]
    return forces_of_cell(w, crossover, (F, h1, h2))


@entry(nogil=True)
def solve_many(stretch1, stretch2, crossover, out):
    """Fill out (8, n) with `cell` at n pairs of stretches. False if a cell failed."""
    for i in range(stretch1.size):
        values = cell(stretch1[i], stretch2[i], crossover, 1.0)
        for c in range(8):
            out[c, i] = values[c]
        if values[4] < 0.0:
            return False
    return True


@entry()
def tension_bound_table(low, high, over, top, unit, out):
    """Tabulate the tension bounds where forces do not exceed N, row N / unit of out (n, 2):
    max(out[0], N + out[1]).

    low, high (cells,) [N] : between which the forces of a cell of the table lie; over, top (cells,)
    [N] : by which a tension is at most above the force beside it, and its own most. Of cells that a
    step cuts, the tension is at most N and what it is above its force; of those that lie below it,
    their own.
    """
    last = out.shape[0] - 1
    out[:] = 0.0
    for m in range(low.size):
        begin = min(max(int(low[m] / unit), 0), last)
        end = min(max(int(high[m] / unit), 0), last)
        for step in range(begin, end + 1):
            out[step, 1] = max(out[step, 1], over[m])
        if end < last:
            out[end + 1, 0] = max(out[end + 1, 0], top[m])
    for step in range(last):
        out[step + 1, 0] = max(out[step + 1, 0], out[step, 0])
