"""The yarn as a solid with a fibre volume fraction, in UFL: the law of
`fabrics.yarn_stress_kernels` on the frame of a mesh.

The law has no potential and its tangent is unsymmetric; UFL differentiates it.
"""

from __future__ import annotations

from typing import Any

import ufl

from fabrics import yarn_stress_kernels
from fabrics.yarn_stress_kernels import piola_columns

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


transverse_modulus = yarn_stress_kernels.make_modulus(smooth_max)
_factors = yarn_stress_kernels.make_factors(ufl.sqrt)
_local_stress = yarn_stress_kernels.make_local_stress(ufl.ln, transverse_modulus)


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
    edges = []
    for e in frame:
        f = e + ufl.dot(grad_u, e)
        edges.append([f[c] for c in range(3)])
    q1, q2, q3, R = _factors(*edges)
    columns = piola_columns(q1, q2, q3, R, _local_stress(R, parameters))
    stress = 0
    for column, e in zip(columns, frame):
        stress = stress + ufl.outer(ufl.as_vector(column), e)
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
