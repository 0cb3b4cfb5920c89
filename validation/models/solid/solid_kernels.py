"""The solid of a yarn in explicit dynamics: hexahedra with one integration point and elastic hourglass control.

The law is that of the thesis, section 3.4.2, with the branches of erratum E-20; a frame follows the fibre. With
e1 along the mesh edges of the fibre, e2 across and e3 through the yarn at rest, and f_i = F e_i,

    F Q0 = Q R,     V_f = Vf0 / (R_22 R_33),     P e_i = Q (J S R^-T)_i                          (eqs. 3-7, 3-9)
    S_11 = E_a V_f ln R_11,   S_22, S_33 = E_2(V_f) ln R_22, ln R_33,   S_ij = G R_ij / R_jj     (eqs. 3-2, 3-8 .. 3-16)

F is the mean over the element, and its modes without energy are held (`backing.brick_kernels`). S_22 and S_33 have a
viscous part eta d(ln R)/dt, eta = xi (E_2 rho)^(1/2) L.

An element is gone with half of its bars. In a yarn that has been cut it is gone as well once its fibres are folded to a
tenth of their length or it has no volume left; in a whole yarn that makes the run unstable (docs/theory-panel.md,
"Woven solid yarns").
"""

import math

import numpy as np

from shellfabric.backing.brick_kernels import brick_nodes, hourglass, mean_deformation
from shellfabric.jit.compile import kernel

LOOSE_WIDTH = 5e-3  # half widths in V_f of the parabolas that round the two corners of E_2
PACKED_WIDTH = 2e-3
FOLDED = 0.1  # length along the fibre over that at rest
# of the sums that a yarn keeps
SOLID, DAMPED, VISCOUS, BARS, HOURGLASS, FAILED, KINETIC = 0, 1, 2, 3, 4, 5, 6  # DAMPED: of the solid's work
SUMS = 7


@kernel(fastmath={"contract"})
def smooth_max(x, corner, width):
    """max(x, corner), a parabola within `width` of the corner; and its slope."""
    if x <= corner - width:
        return corner, 0.0
    if x >= corner + width:
        return x, 1.0
    rise = x - corner + width
    return corner + rise * rise / (4.0 * width), rise / (2.0 * width)


@kernel(fastmath={"contract"})
def transverse_modulus(V_f, Vf0, V_c, a_E, b_E):
    """Secant modulus E_2 [Pa] at the fibre volume fraction V_f, and dE_2 / dV_f (eqs. 3-10 .. 3-14)."""
    loose, rise = smooth_max(V_f, Vf0, LOOSE_WIDTH)
    packed, fall = smooth_max(-loose, -V_c, PACKED_WIDTH)
    E_2 = a_E / (b_E + packed)
    return E_2, E_2 * E_2 / a_E * rise * fall


@kernel(fastmath={"contract"})
def triangular(f):
    """Factors of F Q0 = Q R.

    Parameters
    ----------
    f : (3, 3), f[c, i] the component c of F e_i

    Returns
    -------
    q1, q2, q3 : the columns of Q, each of three components
    R11, R22, R33, R12, R13, R23
    """
    R11 = math.sqrt(f[0, 0] * f[0, 0] + f[1, 0] * f[1, 0] + f[2, 0] * f[2, 0])
    a0, a1, a2 = f[0, 0] / R11, f[1, 0] / R11, f[2, 0] / R11
    R12 = a0 * f[0, 1] + a1 * f[1, 1] + a2 * f[2, 1]
    b0, b1, b2 = f[0, 1] - R12 * a0, f[1, 1] - R12 * a1, f[2, 1] - R12 * a2
    R22 = math.sqrt(b0 * b0 + b1 * b1 + b2 * b2)
    b0, b1, b2 = b0 / R22, b1 / R22, b2 / R22
    c0, c1, c2 = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    R13 = a0 * f[0, 2] + a1 * f[1, 2] + a2 * f[2, 2]
    R23 = b0 * f[0, 2] + b1 * f[1, 2] + b2 * f[2, 2]
    R33 = c0 * f[0, 2] + c1 * f[1, 2] + c2 * f[2, 2]
    return (a0, a1, a2), (b0, b1, b2), (c0, c1, c2), R11, R22, R33, R12, R13, R23


@kernel(fastmath={"contract"})
def piola(f, law, last2, last3, per_time, eta2, eta3, P):
    """First Piola-Kirchhoff stress of the law, P[c, i] the component c of P e_i [Pa].

    Parameters
    ----------
    f : (3, 3) as for `triangular`
    law : (6,) E_a, a_E [Pa], b_E, Vf0, V_c [-], G [Pa]
    last2, last3 : ln R_22, ln R_33 a time 1 / per_time ago; their rates are those of the velocities half a step ago
    per_time : [1/s]
    eta2, eta3 : [Pa^(1/2) s] times E_2^(1/2) the viscous moduli
    P : (3, 3) filled

    Returns
    -------
    e2, e3 : ln R_22, ln R_33; NaN where the brick is inverted
    viscous : [W/m3] dissipated, per volume at rest
    """
    q1, q2, q3, R11, R22, R33, R12, R13, R23 = triangular(f)
    e2, e3 = math.log(R22), math.log(R33)
    V_f = law[3] / (R22 * R33)
    E_2 = transverse_modulus(V_f, law[3], law[4], law[1], law[2])[0]
    root = math.sqrt(E_2)
    rate2, rate3 = (e2 - last2) * per_time, (e3 - last3) * per_time
    V2, V3 = eta2 * root * rate2, eta3 * root * rate3
    S11, S22, S33 = law[0] * V_f * math.log(R11), E_2 * e2 + V2, E_2 * e3 + V3
    S12, S13, S23 = law[5] * R12 / R22, law[5] * R13 / R33, law[5] * R23 / R33
    # J R^-T, lower triangular
    L11, L22, L33 = R22 * R33, R11 * R33, R11 * R22
    L21, L32, L31 = -R12 * R33, -R11 * R23, R12 * R23 - R13 * R22
    A1, A2, A3 = (
        S11 * L11 + S12 * L21 + S13 * L31,
        S12 * L11 + S22 * L21 + S23 * L31,
        S13 * L11 + S23 * L21 + S33 * L31,
    )
    B1, B2, B3 = S12 * L22 + S13 * L32, S22 * L22 + S23 * L32, S23 * L22 + S33 * L32
    C1, C2, C3 = S13 * L33, S23 * L33, S33 * L33
    for c in range(3):
        P[c, 0] = A1 * q1[c] + A2 * q2[c] + A3 * q3[c]
        P[c, 1] = B1 * q1[c] + B2 * q2[c] + B3 * q3[c]
        P[c, 2] = C1 * q1[c] + C2 * q2[c] + C3 * q3[c]
    return e2, e3, R11 * R22 * R33 * (V2 * rate2 + V3 * rate3)


@kernel(fastmath={"contract"})
def brick_intact(alive, i, j, k, ny, nz):
    """Whether three of the four bars on the edges of a brick are whole: with half of its fibres gone it is torn."""
    bar = (i * (ny + 1) + j) * (nz + 1) + k
    return int(alive[bar]) + int(alive[bar + 1]) + int(alive[bar + nz + 1]) + int(alive[bar + nz + 2]) >= 3


@kernel(fastmath={"contract"})
def brick_folded(f):
    """Whether a brick's fibres are folded to FOLDED, or it has no volume left; f as for `triangular`."""
    if f[0, 0] * f[0, 0] + f[1, 0] * f[1, 0] + f[2, 0] * f[2, 0] < FOLDED * FOLDED:
        return True
    volume = (
        f[0, 0] * (f[1, 1] * f[2, 2] - f[2, 1] * f[1, 2])
        - f[1, 0] * (f[0, 1] * f[2, 2] - f[2, 1] * f[0, 2])
        + f[2, 0] * (f[0, 1] * f[1, 2] - f[1, 1] * f[0, 2])
    )
    return volume <= 0.0


@kernel(fastmath={"contract"})
def solid_forces(shape, x, bricks, law, dt, alive, last, torn, material, force, sums):
    """Add the internal forces of the bricks of one yarn. A brick is torn, and gone, with half of its bars, or folded.

    Parameters
    ----------
    shape : first node and bricks along, across and through; nodes and bricks are numbered with k fastest
    x : (n, 3) [m]
    bricks : at rest, (gradient, volume, twist, control, viscous)
        gradient : (m, 8, 3) [1/m] b of each brick;  volume : (m,) [m3]
        twist : (m, 4, 3) [m] c;  control : (m, 4, 3) [N/m3] K
        viscous : (m, 2) [kg^(1/2) m^(-1/2)] xi rho^(1/2) L across and through
    law : (6,) as for `piola`
    dt : [s] since the last call; 0 at the first, for no rates
    alive : (b,) bool, bars that are whole, numbered as their first nodes
    last : (m, 2) ln R_22, ln R_33 at the last call; overwritten
    torn : (m,) bool, bricks that are gone; overwritten
    material, force : (n, 3) [N] of the law, and of the hourglass control; added to
    sums : (SUMS,) DAMPED and FAILED [J] are added to, HOURGLASS [J] is overwritten
    """
    (first, nx, ny, nz), (gradient, volume, twist, control, viscous) = shape, bricks
    nodes = np.empty(8, np.int64)
    f, P, D, H = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((4, 3))
    places, own = np.empty((8, 3)), np.empty((8, 3))
    per_time = 1.0 / dt if dt > 0.0 else 0.0
    lost = stored = 0.0
    cut = not alive.all()
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                m = (i * ny + j) * nz + k
                if torn[m]:
                    continue
                brick_nodes(first, i, j, k, ny, nz, nodes)
                for a in range(8):
                    n = nodes[a]
                    for c in range(3):
                        places[a, c] = x[n, c]
                        own[a, c] = 0.0
                b = gradient[m]
                mean_deformation(places, b, f)
                energy = hourglass(f, places, twist[m], control[m], H, D, own)
                if not brick_intact(alive, i, j, k, ny, nz) or (cut and brick_folded(f)):
                    torn[m] = True
                    sums[FAILED] += energy
                    continue
                e2, e3, loss = piola(f, law, last[m, 0], last[m, 1], per_time, viscous[m, 0], viscous[m, 1], P)
                last[m, 0], last[m, 1] = e2, e3
                lost += loss * volume[m] * dt
                stored += energy
                for a in range(8):
                    n = nodes[a]
                    for c in range(3):
                        material[n, c] += volume[m] * (P[c, 0] * b[a, 0] + P[c, 1] * b[a, 1] + P[c, 2] * b[a, 2])
                        force[n, c] += own[a, c] + D[c, 0] * b[a, 0] + D[c, 1] * b[a, 1] + D[c, 2] * b[a, 2]
    sums[DAMPED] += lost
    sums[HOURGLASS] = stored
