"""One yarn of the crossover's cell: the length of its centreline, and its tension. All yarns have the
half length w. A yarn that floats on is straight there (`floating`).

Cosine, with k = pi h / 2 w:    S = (4 w / pi) E(-k^2)    (thesis eqs. 4-1, 4-3)
Straight to the next crossing:  S = 2 sqrt(w^2 + h^2)     (Kawabata, Niwa and Kawai 1973)

Tension at the strain e = (S - S0) / S0:    EA e          (eq. 4-7)
With a foot of the width s, the slack:      EA (e - s (1 - exp(-e / s)))

The curve with a foot begins without stiffness, as fibres that are not parallel yet.
"""

import math

from shellfabric.jit.compile import kernel

_MAX_STEPS = 200


@kernel()
def elliptic(k2):
    """Compute E(-k2) and K(-k2) - E(-k2) by the arithmetic-geometric mean; the difference keeps its
    digits at small k2."""
    a = 1.0
    b = math.sqrt(1.0 + k2)
    total = -0.5 * k2
    power = 0.5
    c2 = k2
    while c2 > 1e-17 * a * a:
        c = 0.5 * (a - b)
        mean = 0.5 * (a + b)
        b = math.sqrt(a * b)
        a = mean
        power *= 2.0
        c2 = c * c
        total += power * c2
    K = 0.5 * math.pi / a
    return K * (1.0 - total), K * total


@kernel()
def arc(w, h):
    """Compute S and dS/dh of a yarn (eq. 4-3; the derivative is twice the printed eq. 4-24, erratum
    E-09)."""
    k = 0.5 * math.pi * h / w
    E, K_minus_E = elliptic(k * k)
    if k > 0.0:
        slope = -2.0 * K_minus_E / k
    else:
        slope = 0.0
    return 4.0 * w / math.pi * E, slope


@kernel()
def arc_curvature(w, h):
    """Compute d2S/dh2 of a yarn."""
    k = 0.5 * math.pi * h / w
    E, K_minus_E = elliptic(k * k)
    # S'' = (pi / w) d/dk (E - K) / k, with dE/dk = (E - K) / k and dK/dk = (E / (1 + k^2) - K) / k
    if k > 0.0:
        return math.pi / w * (K_minus_E / (k * k) + E / (1.0 + k * k))
    return 0.25 * math.pi**2 / w


@kernel()
def straight_arc(w, h):
    """Compute S and dS/dh of a yarn that is straight from crossing to crossing."""
    side = math.sqrt(w * w + h * h)
    return 2.0 * side, 2.0 * h / side


@kernel()
def straight_curvature(w, h):
    """Compute d2S/dh2 of the same."""
    side = math.sqrt(w * w + h * h)
    return 2.0 * w * w / side**3


@kernel()
def floating(S, w, turning):
    """Return the length of a yarn that is of the length S where it changes sides, over the share
    `turning` of its way, and straight on the rest."""
    return turning * S + (1.0 - turning) * 2.0 * w


@kernel()
def turning_length(S0, w, turning):
    """Return the length S of which `floating` makes S0."""
    return (S0 - (1.0 - turning) * 2.0 * w) / turning


@kernel()
def straight_free_height(w, S0):
    """Compute the height at which the same has its own length S0; 0 if it is stretched flat."""
    half = 0.5 * S0
    return math.sqrt(max((half - w) * (half + w), 0.0))


@kernel()
def free_height(w, S0):
    """Compute the height at which a cosine has the yarn's own length S0, without tension; 0 if it is
    stretched straight."""
    excess = S0 / (2.0 * w) - 1.0
    if excess <= 0.0:
        return 0.0
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
def tension(S, dS, yarn):
    """Compute T of a yarn of the length S >= S0, and its slope where S has the slope dS."""
    T = yarn.EA * (S - yarn.S0) / yarn.S0
    slope = yarn.EA * dS / yarn.S0
    if yarn.slack > 0.0:
        missing = math.expm1((yarn.S0 - S) / (yarn.S0 * yarn.slack))
        T += yarn.EA * yarn.slack * missing
        slope *= -missing
    return T, slope


@kernel()
def strain_energy(S, yarn):
    """Compute the energy of a yarn of the length S >= S0: the work of its tension from S0 on."""
    longer = S - yarn.S0
    W = 0.5 * (yarn.EA * longer / yarn.S0) * longer
    if yarn.slack > 0.0:
        foot = yarn.S0 * yarn.slack
        W -= yarn.EA * yarn.slack * (longer + foot * math.expm1(-longer / foot))
    return W


@kernel()
def lone_yarn(stretch, yarn):
    """Compute tension and energy of a yarn of the cell that crosses nothing."""
    S = 2.0 * stretch * yarn.w
    if S <= yarn.S0:
        return 0.0, 0.0
    return tension(S, 0.0, yarn)[0], strain_energy(S, yarn)


@kernel()
def yarn_alone(stretch, w0, S0, EA):
    """Compute tension and energy of a yarn that crosses nothing (erratum E-14: 2 w - S0, the full
    lengths)."""
    slack = 2.0 * stretch * w0 - S0
    if slack <= 0.0:
        return 0.0, 0.0
    return EA * slack / S0, 0.5 * EA * slack * slack / S0
