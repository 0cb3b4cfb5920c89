"""One yarn of the crossover's cell: the length of its profile, and its tension. All yarns have the half length w.

Cosine profile (thesis eq. 4-1), with k = pi h / 2 w:  S = (4 w / pi) E(-k^2)          (eq. 4-3)
Straight segments from crossing to crossing (Kawabata's):     S = 2 sqrt(w^2 + h^2),  dS/dh = 2 h / sqrt(w^2 + h^2)

The slope of the second is 2 sin(alpha) at its end: there the balance F = 2 T sin(alpha) (eq. 4-8) is the gradient of
the energy, which it is not where the yarn stays a cosine.

Tension at the strain e = (S - S0) / S0: EA e (eq. 4-7). With a toe, of a bundle whose fibres are linear and have the
slacks s that are exponentially distributed about their mean e_t, each taut from e = s on:

    T = EA int_0^e (e - s) exp(-s / e_t) ds / e_t = EA [e - e_t (1 - exp(-e / e_t))],    dT/de = EA [1 - exp(-e / e_t)]
    U / S0 = EA e^2 / 2 - e_t T

Its asymptote is the straight line of slope EA through e_t; e_t = 0 is eq. 4-7, to the bit.
"""

import math

from shellfabric.jit.compile import kernel

COSINE, STRAIGHT = 0, 1
_MAX_STEPS = 200


@kernel()
def elliptic(k2):
    """E(-k2) and K(-k2) - E(-k2) by the arithmetic-geometric mean; the difference keeps its digits at small k2."""
    a, b = 1.0, math.sqrt(1.0 + k2)
    total, power, c2 = -0.5 * k2, 0.5, k2
    while c2 > 1e-17 * a * a:
        c = 0.5 * (a - b)
        a, b = 0.5 * (a + b), math.sqrt(a * b)
        power *= 2.0
        c2 = c * c
        total += power * c2
    K = 0.5 * math.pi / a
    return K * (1.0 - total), K * total


@kernel()
def arc(w, h, profile=COSINE):
    """S and dS/dh of a yarn (eq. 4-3; the derivative is twice the printed eq. 4-24, erratum E-09)."""
    if profile == STRAIGHT:
        half = math.sqrt(w * w + h * h)
        return 2.0 * half, 2.0 * h / half
    k = 0.5 * math.pi * h / w
    E, K_minus_E = elliptic(k * k)
    slope = -2.0 * K_minus_E / k if k > 0.0 else 0.0
    return 4.0 * w / math.pi * E, slope


@kernel()
def arc_curvature(w, h, profile):
    """d2S/dh2 of a yarn."""
    if profile == STRAIGHT:
        return 2.0 * w * w / (w * w + h * h) ** 1.5
    k = 0.5 * math.pi * h / w
    E, K_minus_E = elliptic(k * k)
    # S'' = (pi / w) d/dk (E - K) / k, with dE/dk = (E - K) / k and dK/dk = (E / (1 + k^2) - K) / k
    return (
        math.pi / w * (K_minus_E / (k * k) + E / (1.0 + k * k))
        if k > 0.0
        else 0.25 * math.pi**2 / w
    )


@kernel()
def free_height(w, S0, profile=COSINE):
    """Height at which the yarn has its own length S0, without tension; 0 where it is stretched straight."""
    excess = S0 / (2.0 * w) - 1.0
    if excess <= 0.0:
        return 0.0
    if profile == STRAIGHT:
        return w * math.sqrt(excess * (2.0 + excess))
    k = 2.0 * math.sqrt(excess)
    for _ in range(_MAX_STEPS):
        # convex and rising in k: after the first step Newton comes down from above
        E, K_minus_E = elliptic(k * k)
        step = (2.0 / math.pi * E - 1.0 - excess) * k / (-2.0 / math.pi * K_minus_E)
        k -= step
        if abs(step) <= 4e-16 * k:
            break
    return 2.0 * w * k / math.pi


@kernel()
def tension(S, dS, S0, EA, toe):
    """T of a yarn of the length S >= S0, and its slope where S has the slope dS."""
    if toe == 0.0:
        return EA * (S - S0) / S0, EA * dS / S0
    e = max((S - S0) / S0, 0.0)
    missing = math.expm1(-e / toe)
    return EA * (e + toe * missing), -EA * missing * dS / S0


@kernel()
def energy(S, S0, EA, toe, T):
    """Stored by a yarn of the length S >= S0 that has the tension T."""
    if toe == 0.0:
        return 0.5 * T * (S - S0)
    e = max((S - S0) / S0, 0.0)
    return S0 * (0.5 * EA * e * e - toe * T)


@kernel()
def yarn_alone(stretch, w0, S0, EA, toe=0.0):
    """Tension and energy of a yarn that crosses nothing (erratum E-14: 2 w - S0, the full lengths)."""
    slack = 2.0 * stretch * w0 - S0
    if slack <= 0.0:
        return 0.0, 0.0
    if toe == 0.0:
        return EA * slack / S0, 0.5 * EA * slack * slack / S0
    T, _ = tension(S0 + slack, 0.0, S0, EA, toe)
    return T, energy(S0 + slack, S0, EA, toe, T)
