"""The stress of the solid of a yarn and of its fibre bars, written once for UFL and for Numba (thesis
sections 3.4.1, 3.4.2, eqs. 3-2 to 3-16, erratum E-20; equations: docs/theory-cell.md, "The 3D
crossover: material").

The functions are plain arithmetic over the root, logarithm and rounded maximum that they are made
with: those of UFL (`unitcell3d.material.solid_law`) make what dolfinx compiles, those of Python
(`validation.models.solids.law_kernels`) what Numba compiles.

The moduli are secants of a state that other strains move: the law has no potential.
"""

LOOSE_WIDTH = 5e-3
PACKED_WIDTH = 2e-3


def make_modulus(smooth_max):
    """Make the secant modulus of a yarn across its fibres, of smooth_max(x, corner, width).

    Both corners of E_2 = a_E / (b_E - clip(V_f, Vf0, V_c)) are rounded by parabolas over half
    widths `LOOSE_WIDTH` and `PACKED_WIDTH` of V_f, which lower the corner by a quarter of that:
    0.4 % of E_2 at Vf0 and 8 % of E_c at V_c, where E_2 rises by a factor of 2 within 0.006 of V_f.
    """

    def transverse_modulus(V_f, Vf0, V_c, a_E, b_E):
        """Compute the secant modulus E_2 = E_3 [Pa] at the fibre volume fraction `V_f` (eqs. 3-10
        .. 3-14, rounded corners)."""
        loose = smooth_max(V_f, Vf0, LOOSE_WIDTH)
        return a_E / (b_E + smooth_max(-loose, -V_c, PACKED_WIDTH))

    return transverse_modulus


def make_factors(sqrt):
    """Make the factorisation F Q0 = Q R, of sqrt(x).

    With e1 along the fibre, e2 across and e3 through the yarn at rest, Q0 = [e1 e2 e3], R is upper
    triangular: q1 follows the fibre, q2 the layer, q3 is normal to the layer. R' R^-1 is triangular
    too, so that its diagonal integrates exactly: strains ln R_ii (eq. 3-8), shears R_ij / R_jj, the
    tangent of the angle that edge j has turned towards q_i. A rigid rotation changes Q alone.
    """

    def factors(f1, f2, f3):
        """Compute the columns q1, q2, q3 of Q, and R11, R22, R33, R12, R13, R23, from the edges
        f1, f2, f3, each of three components."""
        a0, a1, a2 = f1
        b0, b1, b2 = f2
        c0, c1, c2 = f3
        R11 = sqrt(a0 * a0 + a1 * a1 + a2 * a2)
        a0 = a0 / R11
        a1 = a1 / R11
        a2 = a2 / R11
        R12 = a0 * b0 + a1 * b1 + a2 * b2
        b0 = b0 - R12 * a0
        b1 = b1 - R12 * a1
        b2 = b2 - R12 * a2
        R22 = sqrt(b0 * b0 + b1 * b1 + b2 * b2)
        b0 = b0 / R22
        b1 = b1 / R22
        b2 = b2 / R22
        n0 = a1 * b2 - a2 * b1
        n1 = a2 * b0 - a0 * b2
        n2 = a0 * b1 - a1 * b0
        R13 = a0 * c0 + a1 * c1 + a2 * c2
        R23 = b0 * c0 + b1 * c1 + b2 * c2
        R33 = n0 * c0 + n1 * c1 + n2 * c2
        return (a0, a1, a2), (b0, b1, b2), (n0, n1, n2), (R11, R22, R33, R12, R13, R23)

    return factors


def make_local_stress(ln, transverse_modulus):
    """Make the stress in the frame of the fibre, of ln(x) and the modulus of `make_modulus`."""

    def local_stress(R, law):
        """Compute S11, S22, S33, S12, S13, S23 [Pa].

        Parameters
        ----------
        R : R11, R22, R33, R12, R13, R23
        law : E_a, a_E [Pa], b_E, Vf0, V_c [-], G [Pa]
        """
        R11, R22, R33, R12, R13, R23 = R
        E_a, a_E, b_E, Vf0, V_c, G = law
        V_f = Vf0 / (R22 * R33)
        E_2 = transverse_modulus(V_f, Vf0, V_c, a_E, b_E)
        S11 = E_a * V_f * ln(R11)
        S22 = E_2 * ln(R22)
        S33 = E_2 * ln(R33)
        return S11, S22, S33, G * R12 / R22, G * R13 / R33, G * R23 / R33

    return local_stress


def piola_columns(q1, q2, q3, R, S):
    """Compute P e1, P e2, P e3 [Pa], each of three components, from Q, R and S as `make_factors` and
    `make_local_stress` order them.

    J R^-T is lower triangular, and has no division by a shear.
    """
    R11, R22, R33, R12, R13, R23 = R
    S11, S22, S33, S12, S13, S23 = S
    L11 = R22 * R33
    L22 = R11 * R33
    L33 = R11 * R22
    L21 = -R12 * R33
    L32 = -R11 * R23
    L31 = R12 * R23 - R13 * R22
    A1 = S11 * L11 + S12 * L21 + S13 * L31
    A2 = S12 * L11 + S22 * L21 + S23 * L31
    A3 = S13 * L11 + S23 * L21 + S33 * L31
    B1 = S12 * L22 + S13 * L32
    B2 = S22 * L22 + S23 * L32
    B3 = S23 * L22 + S33 * L32
    C1 = S13 * L33
    C2 = S23 * L33
    C3 = S33 * L33
    along = (
        A1 * q1[0] + A2 * q2[0] + A3 * q3[0],
        A1 * q1[1] + A2 * q2[1] + A3 * q3[1],
        A1 * q1[2] + A2 * q2[2] + A3 * q3[2],
    )
    across = (
        B1 * q1[0] + B2 * q2[0] + B3 * q3[0],
        B1 * q1[1] + B2 * q2[1] + B3 * q3[1],
        B1 * q1[2] + B2 * q2[2] + B3 * q3[2],
    )
    through = (
        C1 * q1[0] + C2 * q2[0] + C3 * q3[0],
        C1 * q1[1] + C2 * q2[1] + C3 * q3[1],
        C1 * q1[2] + C2 * q2[2] + C3 * q3[2],
    )
    return along, across, through


def fibre_law(strain, compression, width):
    """Compute value and slope of s(e) [-].

    s is r e in compression, e beyond the width d of the kink, and between, with t = e / d, the cubic
    that joins both with continuous slope: s = r e (1 - t)^2 + e t (2 - t), largest slope 4/3.

    Parameters
    ----------
    strain : e
    compression, width : r, the fraction of the stiffness that slack fibres keep, and d
    """
    if strain <= 0.0:
        return compression * strain, compression
    if strain >= width:
        return strain, 1.0
    t = strain / width
    value = strain * (compression * (1.0 - t) ** 2 + t * (2.0 - t))
    slope = compression * (1.0 - 4.0 * t + 3.0 * t * t) + 4.0 * t - 3.0 * t * t
    return value, slope


def fibre_energy(strain, compression, width):
    """Compute the integral of s from 0 to e [-]; the parameters are those of `fibre_law`."""
    if strain <= 0.0:
        return 0.5 * compression * strain * strain
    if strain >= width:
        return 0.5 * strain * strain + width * width * (compression - 1.0) / 12.0
    t = strain / width
    slack = compression * (0.5 - t * (2.0 / 3.0 - 0.25 * t))
    return strain * strain * (slack + t * (2.0 / 3.0 - 0.25 * t))
