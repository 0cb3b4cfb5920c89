"""Fibre bars on the mesh edges along a yarn, in explicit dynamics (thesis section 3.4.1, App. B.1).

    strain e = l / L - 1,    force N = E A [ s(e) + s'(e) xi (L / c) de/dt ]      (eq. 4-7: nominal)

with s = r e in compression (r: fraction of the stiffness left to slack fibres), e beyond the width d of the kink, and
between, with t = e / d, the cubic that joins both with continuous slope, s = r e (1 - t)^2 + e t (2 - t). The viscous
part is a damping ratio xi on the highest mode along a taut yarn, c^2 = E / rho; erratum E-18: it is no part of the
elastic state. A bar fails at a strain of its own, which is strain beyond crimp, since bars lie on the crimped path; its
energy goes to a term of its own, its mass stays.
"""

import math

from shellfabric.jit.compile import kernel
from validation.models.solid.solid_kernels import BARS, FAILED, VISCOUS


@kernel()
def fibre_law(e, r, d):
    """s(e), its slope, and its integral [-]."""
    if e <= 0.0:
        return r * e, r, 0.5 * r * e * e
    if e >= d:
        return e, 1.0, 0.5 * e * e + d * d * (r - 1.0) / 12.0
    t = e / d
    value = e * (r * (1.0 - t) ** 2 + t * (2.0 - t))
    slope = r * (1.0 - 4.0 * t + 3.0 * t * t) + 4.0 * t - 3.0 * t * t
    rise = r * (0.5 - t * (2.0 / 3.0 - 0.25 * t)) + t * (2.0 / 3.0 - 0.25 * t)
    return value, slope, e * e * rise


@kernel()
def bar_forces(first, bars, sheet, x, v, length, stiffness, law, dt, alive, force, sums):
    """Add the internal forces of the bars of one yarn; bars that are strained too far fail first.

    Parameters
    ----------
    first : number of the first node; bar m joins the nodes first + m and first + m + sheet
    bars, sheet : bars of the yarn; nodes, and so bars, of a section
    x, v : (n, 3) [m], [m/s] places, and velocities of half a step ago
    length : (bars,) [m] at rest
    stiffness : (sheet,) [N] E A
    law : (4,) r, d [-], xi / c [s/m], failure strain [-]
    dt : [s] for what the viscous forces take
    alive : (bars,) bool, overwritten
    force : (n, 3) [N] added to
    sums : (solid_kernels.SUMS,) BARS [J] is overwritten; VISCOUS and FAILED [J] are added to
    """
    stored = lost = 0.0
    for m in range(bars):
        if not alive[m]:
            continue
        p, q = first + m, first + m + sheet
        d0, d1, d2 = x[q, 0] - x[p, 0], x[q, 1] - x[p, 1], x[q, 2] - x[p, 2]
        now = math.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        strain = now / length[m] - 1.0
        value, slope, energy = fibre_law(strain, law[0], law[1])
        E_A = stiffness[m % sheet]
        if strain >= law[3]:
            alive[m] = False
            sums[FAILED] += E_A * length[m] * energy
            continue
        stored += E_A * length[m] * energy
        closing = d0 * (v[q, 0] - v[p, 0]) + d1 * (v[q, 1] - v[p, 1]) + d2 * (v[q, 2] - v[p, 2])
        rate = closing / (now * length[m])
        drag = slope * law[2] * length[m] * rate
        lost += E_A * length[m] * drag * rate * dt
        pull = E_A * (value + drag) / now
        force[p, 0] -= pull * d0
        force[p, 1] -= pull * d1
        force[p, 2] -= pull * d2
        force[q, 0] += pull * d0
        force[q, 1] += pull * d1
        force[q, 2] += pull * d2
    sums[BARS] = stored
    sums[VISCOUS] += lost
