"""The plastic flow of isotropic solids: that of a block behind the fabric, and that of metal. From a
trial stress q the increment d of the effective plastic strain alpha in a step of dt solves

    q - 3 G d = flow stress(alpha + d, d / dt)                                        (1)

    clay and gelatine   (sigma_y + H alpha) (1 + rate / reference)^m                    (2)
    metals              (A + B alpha^n) (1 + C ln(1 + rate / reference)) (1 - (w / w_m)^s)   (3)

(3) is that of Johnson and Cook (1983), with ln(1 + x) for ln x, so that it has no end below the
reference rate. w is the plastic work of a unit of volume, which stays as heat, w_m what melts it
(`fabrics.metals.Metal.melting_work`).
"""

import math

from shellfabric.jit.compile import kernel

LEAST_SOFTENED = 1e-3  # share of its flow stress that molten metal keeps


@kernel()
def flow_increment(q, hard, law, dt):
    """Compute the increment d [-] of the effective plastic strain in a step of dt [s] from a trial
    stress q [Pa] above `hard` [Pa], eq. (2):

    q - 3 G d = (hard + H d) (1 + d / c)^m,  c = dt reference rate;  Newton's iteration on s = ln(1 + d / c) from
    above: from the increment without rate, or from the rate at which q itself is the flow stress.
    """
    G = law.shear_modulus
    H = law.hardening
    m = law.rate_exponent
    c = dt * law.reference_rate
    most = (q - hard) / (3.0 * G + H)
    if m == 0.0 or c == 0.0:
        return most
    s = min(math.log1p(most / c), math.log(q / hard) / m)
    for _ in range(60):
        grown = math.exp(s)
        factor = math.exp(m * s)
        d = c * (grown - 1.0)
        over = q - 3.0 * G * d - (hard + H * d) * factor
        change = over / (3.0 * G * c * grown + (m * (hard + H * d) + H * c * grown) * factor)
        s = max(s + change, 0.0)
        if abs(change) < 1e-12:
            break
    return c * math.expm1(s)


@kernel()
def metal_flow_stress(law, alpha, rate, heat):
    """Compute the flow stress [Pa] of a metal, eq. (3), at an effective plastic strain, its rate
    [1/s] and the plastic work [J/m3] so far."""
    found = law.yield_stress
    if alpha > 0.0:
        found += law.hardening * alpha**law.hardening_exponent
    if law.rate_coefficient > 0.0:
        found *= 1.0 + law.rate_coefficient * math.log1p(rate / law.reference_rate)
    if heat > 0.0:
        softened = 1.0 - (heat / law.melting_work) ** law.softening_exponent
        found *= max(softened, LEAST_SOFTENED)
    return found


@kernel()
def metal_flow_increment(q, law, alpha, heat, dt):
    """Compute the increment d [-] of the effective plastic strain of a metal in a step of dt [s]
    from a trial stress q [Pa], eq. (3); 0 if it does not flow.

    The slope of alpha^n is infinite at 0, so that Newton's iteration is not safe: the secant
    between bounds, whose end that stays is weighed less each time (Illinois rule).
    """
    stiff = 3.0 * law.shear_modulus
    low = 0.0
    over_low = q - metal_flow_stress(law, alpha, 0.0, heat)
    if over_low <= 0.0:
        return 0.0
    high = q / stiff
    over_high = -metal_flow_stress(law, alpha + high, high / dt, heat)
    d = high
    for _ in range(60):
        d = low + (high - low) * over_low / (over_low - over_high)
        over = q - stiff * d - metal_flow_stress(law, alpha + d, d / dt, heat)
        if abs(over) < 1e-9 * q:
            break
        if over > 0.0:
            low = d
            over_low = over
            over_high *= 0.5
        else:
            high = d
            over_high = over
            over_low *= 0.5
    return d
