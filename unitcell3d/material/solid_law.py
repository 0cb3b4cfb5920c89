"""The yarn as a solid with a fibre volume fraction, in UFL (thesis section 3.4.2, errata E-20).

A frame follows the fibre. With e1 the mesh edge along the yarn, e2 across and e3 through it (made
orthonormal in that order, Q0 = [e1 e2 e3]), the deformed edges factor as

    F Q0 = Q R,    R upper triangular,

so that q1 follows the fibre, q2 the layer, and q3 is normal to the layer. Because R' R^-1 is
triangular too, its diagonal integrates exactly: the logarithmic strains are (eq. 3-8)

    e_i = ln R_ii,    shear g_ij = R_ij / R_jj  (tangent of the angle that edge j has turned towards q_i).

    V_f   = Vf0 / (R_22 R_33)                           (eqs. 3-7, 3-9: exp(e_1) / J)
    E_1   = E_a V_f                                     (eq. 3-2)
    E_2   = E_3 = a_E / (b_E - clip(V_f, Vf0, V_c))     (eqs. 3-10 .. 3-14, capped at V_c: erratum E-20)
    sigma = Q S Q^T,  S_ii = E_i e_i,  S_ij = G g_ij    (eqs. 3-15, 3-16; Poisson's ratios 0)

A rigid rotation changes Q alone. The moduli are secants of a state that other strains move, so the
law has no potential and its tangent is unsymmetric; UFL differentiates it. The two corners of E_2
are rounded by parabolas over half widths `LOOSE_WIDTH` and `PACKED_WIDTH` of V_f, which lower the
corner by a quarter of that: 0.4 % of E_2 at Vf0 and 8 % of E_c at V_c, where E_2 rises by a factor
of 2 within 0.006 of V_f.
"""

from __future__ import annotations

from typing import Any

import ufl

LOOSE_WIDTH = 5e-3
PACKED_WIDTH = 2e-3

# degrees of Gauss rules: 2 x 2 x 2 points and one point in a brick
FULL = 3
ONE_POINT = 1


def smooth_max(x: Any, corner: Any, width: float) -> Any:
    """Compute max(x, corner) with a parabola within `width` of the corner; works on UFL
    expressions."""
    rounded = corner + (x - corner + width) ** 2 / (4 * width)
    return ufl.conditional(
        x <= corner - width, corner, ufl.conditional(x >= corner + width, x, rounded)
    )


def transverse_modulus(V_f: Any, Vf0: Any, V_c: Any, a_E: Any, b_E: Any) -> Any:
    """Compute the secant modulus E_2 = E_3 [Pa] at the fibre volume fraction `V_f` (eqs. 3-10 ..
    3-14, rounded corners)."""
    loose = smooth_max(V_f, Vf0, LOOSE_WIDTH)
    return a_E / (b_E + smooth_max(-loose, -V_c, PACKED_WIDTH))


def fibre_frame(mesh: Any) -> tuple[Any, Any, Any]:
    """Compute the orthonormal e1 (along the fibre), e2, e3 at each point of the undeformed mesh."""
    jacobian = ufl.Jacobian(mesh)
    along, across = (ufl.as_vector([jacobian[i, j] for i in range(3)]) for j in range(2))
    e1 = along / ufl.sqrt(ufl.dot(along, along))
    across = across - ufl.dot(across, e1) * e1
    e2 = across / ufl.sqrt(ufl.dot(across, across))
    return e1, e2, ufl.cross(e1, e2)


def first_piola(grad_u: Any, frame: Any, parameters: Any) -> Any:
    """Compute the first Piola-Kirchhoff stress [Pa].

    Parameters
    ----------
    grad_u : displacement gradient
    frame : e1, e2, e3 of `fibre_frame`
    parameters : E_a, a_E, b_E, Vf0, V_c, G
    """
    E_a, a_E, b_E, Vf0, V_c, G = parameters
    f1, f2, f3 = (e + ufl.dot(grad_u, e) for e in frame)
    R11 = ufl.sqrt(ufl.dot(f1, f1))
    q1 = f1 / R11
    R12 = ufl.dot(q1, f2)
    v2 = f2 - R12 * q1
    R22 = ufl.sqrt(ufl.dot(v2, v2))
    q2 = v2 / R22
    q3 = ufl.cross(q1, q2)
    R13, R23, R33 = (ufl.dot(q, f3) for q in (q1, q2, q3))

    V_f = Vf0 / (R22 * R33)
    E_2 = transverse_modulus(V_f, Vf0, V_c, a_E, b_E)
    S11 = E_a * V_f * ufl.ln(R11)
    S22 = E_2 * ufl.ln(R22)
    S33 = E_2 * ufl.ln(R33)
    S12 = G * R12 / R22
    S13 = G * R13 / R33
    S23 = G * R23 / R33

    # P = J sigma F^-T = Q (J S R^-T) Q0^T; R^-T is lower triangular and J R^-T has no division by a
    # shear
    L11 = R22 * R33
    L22 = R11 * R33
    L33 = R11 * R22
    L21 = -R12 * R33
    L32 = -R11 * R23
    L31 = R12 * R23 - R13 * R22
    columns = (
        (
            S11 * L11 + S12 * L21 + S13 * L31,
            S12 * L11 + S22 * L21 + S23 * L31,
            S13 * L11 + S23 * L21 + S33 * L31,
        ),
        (S12 * L22 + S13 * L32, S22 * L22 + S23 * L32, S23 * L22 + S33 * L32),
        (S13 * L33, S23 * L33, S33 * L33),
    )
    stress = 0
    for (s1, s2, s3), e in zip(columns, frame):
        stress = stress + ufl.outer(s1 * q1 + s2 * q2 + s3 * q3, e)
    return stress


def forms(space: Any, parameters: Any, integration: int = FULL) -> tuple[Any, Any]:
    """Return residual and tangent of the solid as UFL forms.

    Parameters
    ----------
    space : compat.HexSpace
    parameters : coefficient E_a, a_E [Pa], b_E, Vf0, V_c [-], G [Pa] of each cell
        (`compat.HexSpace.cell_constants`)
    integration : FULL or ONE_POINT, which leaves zero-energy modes and is there to show them
    """
    u = space.displacement
    v = ufl.TestFunction(space.displacements)
    du = ufl.TrialFunction(space.displacements)
    points = ufl.Measure("dx", domain=space.mesh, metadata={"quadrature_degree": integration})
    stress = first_piola(ufl.grad(u), fibre_frame(space.mesh), [parameters[i] for i in range(6)])
    residual = ufl.inner(stress, ufl.grad(v)) * points
    return residual, ufl.derivative(residual, u, du)
