"""The law of a yarn's solid for Numba: the stress of `fabrics.yarn_stress_kernels`, and what explicit
dynamics needs besides, a viscous stress and a bound of the stiffness.

S_22 and S_33 have a viscous part eta d(ln R)/dt with eta = xi (E_2 rho)^(1/2) L, which damps the
highest mode through a brick of the height L by the ratio xi.
"""

import math

from fabrics.yarn_stress_kernels import (
    LOOSE_WIDTH,
    PACKED_WIDTH,
    make_factors,
    make_local_stress,
    make_modulus,
    piola_columns,
)
from shellfabric.jit.compile import kernel


@kernel(fastmath={"contract"})
def smooth_max(x, corner, width):
    """Compute max(x, corner) with a parabola within `width` of the corner."""
    if x <= corner - width:
        return corner
    if x >= corner + width:
        return x
    return corner + (x - corner + width) ** 2 / (4 * width)


transverse_modulus = kernel(fastmath={"contract"})(make_modulus(smooth_max))
factors = kernel(fastmath={"contract"})(make_factors(math.sqrt))
local_stress = kernel(fastmath={"contract"})(make_local_stress(math.log, transverse_modulus))
columns = kernel(fastmath={"contract"})(piola_columns)


@kernel(fastmath={"contract"})
def edges_of(f):
    """Return the edges F e1, F e2, F e3 of f : (3, 3), f[c, i] the component c of F e_i."""
    return (
        (f[0, 0], f[1, 0], f[2, 0]),
        (f[0, 1], f[1, 1], f[2, 1]),
        (f[0, 2], f[1, 2], f[2, 2]),
    )


@kernel(fastmath={"contract"})
def fill(P, found):
    """Fill P : (3, 3) with its columns."""
    for c in range(3):
        P[c, 0] = found[0][c]
        P[c, 1] = found[1][c]
        P[c, 2] = found[2][c]


@kernel(fastmath={"contract"})
def elastic_stress(f, law, P):
    """Compute the first Piola-Kirchhoff stress [Pa] without viscosity; f, law and P as in
    `damped_stress`."""
    edges = edges_of(f)
    q1, q2, q3, R = factors(edges[0], edges[1], edges[2])
    fill(P, columns(q1, q2, q3, R, local_stress(R, law)))


@kernel(fastmath={"contract"})
def damped_stress(f, law, last, per_time, eta, elastic, P):
    """Compute the first Piola-Kirchhoff stress, P[c, i] the component c of P e_i [Pa].

    Parameters
    ----------
    f : (3, 3), f[c, i] the component c of F e_i
    law : E_a, a_E [Pa], b_E, Vf0, V_c [-], G [Pa]
    last : ln R_22, ln R_33 a time 1 / per_time ago; their rates are those of the velocities half a
        step ago
    per_time : [1/s]
    eta : (2,) [Pa^(1/2) s] of S_22 and S_33, times E_2^(1/2) the viscous moduli
    elastic : [-] share of the elastic stress: 0 for the viscous stress alone
    P : (3, 3) filled

    Returns
    -------
    e2, e3 : ln R_22, ln R_33; NaN where the brick is inverted
    viscous : [W/m3] dissipated, per volume at rest
    """
    edges = edges_of(f)
    q1, q2, q3, R = factors(edges[0], edges[1], edges[2])
    S11, S22, S33, S12, S13, S23 = local_stress(R, law)
    e2 = math.log(R[1])
    e3 = math.log(R[2])
    _, a_E, b_E, Vf0, V_c, _ = law
    root = math.sqrt(transverse_modulus(Vf0 / (R[1] * R[2]), Vf0, V_c, a_E, b_E))
    rate2 = (e2 - last[0]) * per_time
    rate3 = (e3 - last[1]) * per_time
    drag2 = eta[0] * root * rate2
    drag3 = eta[1] * root * rate3
    S22 = elastic * S22 + drag2
    S33 = elastic * S33 + drag3
    S = (elastic * S11, S22, S33, elastic * S12, elastic * S13, elastic * S23)
    fill(P, columns(q1, q2, q3, R, S))
    return e2, e3, R[0] * R[1] * R[2] * (drag2 * rate2 + drag3 * rate3)


@kernel(fastmath={"contract"})
def smooth_slope(x, corner, width):
    """Compute the slope of `smooth_max` in x."""
    return min(max((x - corner + width) / (2 * width), 0.0), 1.0)


@kernel(fastmath={"contract"})
def modulus_slope(V_f, Vf0, V_c, a_E, b_E):
    """Compute dE_2 / dV_f [Pa] of `transverse_modulus`."""
    loose = smooth_max(V_f, Vf0, LOOSE_WIDTH)
    rise = smooth_slope(V_f, Vf0, LOOSE_WIDTH) * smooth_slope(-loose, -V_c, PACKED_WIDTH)
    E_2 = transverse_modulus(V_f, Vf0, V_c, a_E, b_E)
    return E_2 * E_2 / a_E * rise


@kernel(fastmath={"contract"})
def moduli_bound(f, law):
    """Bound the moduli of P over F at a state along, across and through the yarn, (3,) [Pa]; NaN
    where the brick is inverted."""
    edges = edges_of(f)
    R = factors(edges[0], edges[1], edges[2])[3]
    E_a, a_E, b_E, Vf0, V_c, G = law
    R11, R22, R33 = R[:3]
    V_f = Vf0 / (R22 * R33)
    E_2 = transverse_modulus(V_f, Vf0, V_c, a_E, b_E)
    strains = abs(math.log(R22)) + abs(math.log(R33))
    across = E_2 + strains * modulus_slope(V_f, Vf0, V_c, a_E, b_E) * V_f + 2.0 * G
    turned = 2.0 * E_2 * strains  # what the stress across the fibre gives where the fibre turns
    along = E_a * V_f * (1.0 + abs(math.log(R11))) + turned + 2.0 * G
    J = R11 * R22 * R33
    return along * J / R11**2, across * J / R22**2, across * J / R33**2
