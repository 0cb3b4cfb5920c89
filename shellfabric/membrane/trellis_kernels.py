"""Trellis shear of the woven membrane: the three-zone law and the shear forces of quadrilaterals.

The formulation, with what happens to fabric that is drawn together, is in `membrane_kernels`.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    broadcast,
    copysign,
    fabs,
    fma,
    greater,
    load,
    load_or_broadcast,
    maximum,
    minimum,
    rsqrt,
    sqrt,
    store,
    where,
)
from shellfabric.membrane.membrane_kernels import scratch_slot
from shellfabric.state import unit

# a locked trellis stays within the time step: with f of the stretches it adds G2 t (1 / f1^2 + 1 / f2^2) / 4
# to the D of theory-panel.md, where 2 G2 t = D (eq. 4-49)
FADE_STRETCH = 0.8  # stretch below which the trellis fades out
# P(z) of asin(x) = x + x z P(z), z = x^2 <= 1/4: interpolated at Chebyshev points, to 1e-13
_Z = 0.125 * (1 - np.cos(np.pi * (np.arange(12) + 0.5) / 12))
_P = (np.arcsin(np.sqrt(_Z)) / np.sqrt(_Z) - 1) / _Z
ARCSINE = tuple(np.polynomial.Polynomial.fit(_Z, _P, 11).convert().coef)


@kernel()
def trellis_law(gamma, G1, G2, gamma1, gamma2):
    """Compute the trellis stress, odd in the shear angle gamma, and its integral: three zones (eq.
    4-35, erratum E-11)."""
    g = abs(gamma)
    rise = (G2 - G1) / (gamma2 - gamma1)
    middle = min(max(g - gamma1, 0.0), gamma2 - gamma1)
    beyond = max(g - gamma2, 0.0)
    stress = G1 * g + 0.5 * rise * middle * middle + (G2 - G1) * beyond
    energy = 0.5 * G1 * g * g + rise * middle**3 / 6.0
    energy += 0.5 * rise * (gamma2 - gamma1) ** 2 * beyond + 0.5 * (G2 - G1) * beyond * beyond
    return math.copysign(stress, gamma), energy


@kernel()
def shear_energy(sine, V, G1, G2, gamma1, gamma2):
    """Compute the energy V U of the trellis in one quadrilateral."""
    return V * trellis_law(math.asin(min(max(sine, -0.999), 0.999)), G1, G2, gamma1, gamma2)[1]


@kernel(forceinline=True)
def arcsine_terms(z, z2, m):
    """Sum four terms of P from that of z^m on, over z^m (Estrin's scheme)."""
    return fma(z2, fma(z, ARCSINE[m + 3], ARCSINE[m + 2]), fma(z, ARCSINE[m + 1], ARCSINE[m]))


@kernel(forceinline=True)
def arcsine(sine):
    """Compute eight arcsines, sizes: x + x z P(z), z = x^2, up to sine 1/2; pi/2 less twice that of
    sqrt((1 - x) / 2) above."""
    x = minimum(fabs(sine), 0.999)
    high = greater(x, 0.5)
    root = x
    z = x * x
    if any_lane(high):
        z = where(high, fma(x, -0.5, broadcast(0.5)), z)
        root = where(high, sqrt(z), x)
    z2 = z * z
    z4 = z2 * z2
    P = fma(z4, arcsine_terms(z, z2, 8), arcsine_terms(z, z2, 4))
    P = fma(z4, P, arcsine_terms(z, z2, 0))
    angle = fma(root * z, P, root)
    return where(high, fma(angle, -2.0, broadcast(0.5 * math.pi)), angle)


@kernel()
def shear_slope(sine, G1, G2, gamma1, gamma2):
    """Compute dU/d(sin gamma) = tau / cos(gamma) of eight angles. Yarns closer to each other than
    2.6 degrees count as that.

    `trellis_law` written without branches.
    """
    x = minimum(fabs(sine), 0.999)
    angle = arcsine(x)
    cosine = 1.0 - x * x
    span = gamma2 - gamma1
    middle = minimum(maximum(angle - gamma1, 0.0), span)
    stress = fma((0.5 * (G2 - G1) / span) * middle, middle, G1 * angle)
    stress = fma(maximum(angle - gamma2, 0.0), G2 - G1, stress)
    return copysign(stress * rsqrt(cosine), sine)


@kernel(forceinline=True)
def regularized_stretch(stretch):
    """Compute the regularized stretch f of the sum of two stretches, and its slope (see above)."""
    short = minimum(stretch, 2.0 * FADE_STRETCH)
    missing = 2.0 * FADE_STRETCH - short
    return fma((0.25 / FADE_STRETCH) * missing, missing, stretch), (0.5 / FADE_STRETCH) * short


@kernel()
def regularized_stretch_scalar(stretch):
    """Compute `regularized_stretch` of one sum, without the slope."""
    missing = max(2.0 * FADE_STRETCH - stretch, 0.0)
    return stretch + 0.25 / FADE_STRETCH * missing * missing


@kernel(forceinline=True)
def shear_sines(work, j, s):
    """Compute the sines of eight quadrilaterals, over f of the two warp and of the two weft edges'
    stretches, and these, summed."""
    A = work.A
    B = work.B
    l1, l2 = work.stretch
    dot = (load(A[0], j) + load(A[0], j + 1)) * (load(B[0], j) + load(B[0], j + s))
    dot = fma(load(A[1], j) + load(A[1], j + 1), load(B[1], j) + load(B[1], j + s), dot)
    dot = fma(load(A[2], j) + load(A[2], j + 1), load(B[2], j) + load(B[2], j + s), dot)
    along = load(l1, j) + load(l1, j + 1)
    over = load(l2, j) + load(l2, j + s)
    product = along * over
    if any_lane(greater(2.0 * FADE_STRETCH, minimum(along, over))):
        product = regularized_stretch(along)[0] * regularized_stretch(over)[0]
    share = 1.0 / product
    return dot * share, share, along, over


@unit()
def trellis_forces(state, const, work, first, last):
    """Shear forces of a block's elements and of the row before them, which shares their first weft
    edges.

    Into work.trellis_turn -dE/dLambda that an element gives to each of its two warp and its two
    weft edges, and into work.trellis_cross dE/d(a.b) over four, a and b being doubled.
    """
    s = const.row_stride
    low = max(first - 1, 0)
    m = scratch_slot(const, first, low)
    end = scratch_slot(const, first, last)
    turn1, turn2 = work.trellis_turn
    cross = work.trellis_cross
    next_sine, next_share, next_along, next_over = shear_sines(work, m, s)
    for j in range(m, end, WIDTH):
        sine = next_sine
        share = next_share
        along = next_along
        over = next_over
        # looked up one step ahead: their load and division take long, and the law waits for them
        next_sine, next_share, next_along, next_over = shear_sines(work, j + WIDTH, s)
        volume = load_or_broadcast(const.trellis_volume, low * s + j - m)
        slope = shear_slope(sine, const.G1, const.G2, const.gamma1, const.gamma2)
        crossed = volume * slope * share
        turned = crossed * sine
        store(cross, j, crossed)
        if any_lane(greater(2.0 * FADE_STRETCH, minimum(along, over))):
            along, slope1 = regularized_stretch(along)
            over, slope2 = regularized_stretch(over)
            along = along * slope2
            over = over * slope1
        store(turn1, j, turned * over)
        store(turn2, j, turned * along)
    for j in range(m + s - 1, end, s):
        clear_slot(work, j)  # idle
    # beyond the panel there is no trellis
    if first == 0:
        for j in range(s, 2 * s):
            clear_slot(work, j)
    if last == const.ni:
        for j in range(end, end + s):
            clear_slot(work, j)


@kernel()
def clear_slot(work, j):
    """Clear the slot j of the scratch, at which no element stands."""
    work.trellis_turn[0][j] = 0.0
    work.trellis_turn[1][j] = 0.0
    work.trellis_cross[j] = 0.0
