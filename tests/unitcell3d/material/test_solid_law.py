"""The solid yarn law against its closed forms, one hexahedron at a time."""

import numpy as np
import pytest
import ufl
from equations import assert_tangent
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from fabrics.solid import SolidLaw
from fabrics.yarn_stress_kernels import LOOSE_WIDTH, PACKED_WIDTH
from tests.meshing.hexahedra import CUBE
from unitcell3d.assembly import compat
from unitcell3d.assembly.compat import Assembler, HexSpace
from unitcell3d.material.solid_law import forms, transverse_modulus

LAW = SolidLaw(E_a=1e6, E_c=2e9, K_r=0.02, K_G=1e-3, V_c=1.0, Vf0=0.7)
PARAMETERS = np.array([[LAW.E_a, LAW.a_E, LAW.b_E, LAW.Vf0, LAW.V_c, LAW.G]])


@pytest.fixture(scope="module")
def cube():
    space = HexSpace.build(CUBE, np.arange(8)[None])
    return space, Assembler(space, *forms(space, space.cell_constants(PARAMETERS)))


def stress(cube, F):
    """First Piola-Kirchhoff stress of the unit cube under the uniform gradient F, from its nodal forces."""
    space, solid = cube
    space.set_displacement(CUBE @ (F - np.eye(3)).T)
    return solid.residual().T @ CUBE


def modulus(V_f):
    """The rounded law evaluated through UFL, as numbers."""
    return float(transverse_modulus(ufl.as_ufl(V_f), LAW.Vf0, LAW.V_c, LAW.a_E, LAW.b_E)(()))


def test_modulus_is_the_published_one_away_from_its_corners():
    """Capped beyond packing (erratum E-20): the hyperbola alone diverges at b_E."""
    for V_f in (0.5, 0.65, 0.72, 0.8, 0.9, 0.99, 1.01, LAW.b_E, 1.3):
        assert modulus(V_f) == pytest.approx(float(LAW.transverse_modulus(V_f)), rel=1e-12)


def test_modulus_and_its_slope_are_continuous_at_the_rounded_corners():
    """Across each join the value changes by no more than slope times distance; unrounded, the slope at V_c jumps."""
    for corner, width in ((LAW.Vf0, LOOSE_WIDTH), (LAW.V_c, PACKED_WIDTH)):
        for join in (corner - width, corner + width):
            step = 1e-7
            below = modulus(join - step)
            at = modulus(join)
            above = modulus(join + step)
            assert above - at == pytest.approx(at - below, abs=2e-3 * LAW.E_c * step / width)


@pytest.mark.parametrize(
    "stretch", [(1.02, 1, 1), (1, 0.8, 1), (1, 1, 0.75), (1.03, 0.9, 0.85), (0.99, 1.2, 1.1)]
)
def test_stretches_give_secant_stress_of_logarithmic_strain(cube, stretch):
    """Eqs. 3-2, 3-10 .. 3-15: Cauchy stress E_i ln(stretch_i), Poisson's ratios zero."""
    a, b, c = stretch
    V_f = LAW.Vf0 / (b * c)
    E_2 = modulus(V_f)
    cauchy = np.array([LAW.E_a * V_f * np.log(a), E_2 * np.log(b), E_2 * np.log(c)])
    expected = a * b * c * cauchy / np.array(stretch)
    assert_allclose(stress(cube, np.diag(stretch)), np.diag(expected), rtol=1e-10, atol=1e-3)


def test_shear_is_elastic_with_G(cube):
    """Simple shear of the layers: sigma_12 = G gamma (eq. 3-16)."""
    for i, j in ((0, 1), (0, 2), (1, 2)):
        F = np.eye(3)
        F[i, j] = 0.2
        P = stress(cube, F)
        assert (P @ F.T)[i, j] == pytest.approx(LAW.G * 0.2, rel=1e-10)


def test_rotation_turns_the_stress_which_is_symmetric_and_makes_none(cube):
    F = np.array([[1.01, 0.1, 0.05], [0.02, 0.85, 0.1], [0.03, -0.04, 0.9]])
    Q = Rotation.from_rotvec([0.45, 0.9, -0.45]).as_matrix()
    assert abs(stress(cube, Q)).max() < 1e-6  # Pa, against moduli of 1e6 .. 2e9
    assert_allclose(stress(cube, Q @ F), Q @ stress(cube, F), rtol=1e-9, atol=1e-3)
    cauchy = stress(cube, F) @ F.T
    assert_allclose(cauchy, cauchy.T, rtol=1e-10)


def test_tangent_is_the_derivative_and_unsymmetric(cube):
    space, solid = cube
    rng = np.random.default_rng(4)
    u = CUBE @ np.diag([0.02, -0.1, -0.15]) + 0.02 * rng.standard_normal((8, 3))
    direction = rng.standard_normal((8, 3))
    space.set_displacement(u)
    K = np.zeros((24, 24))
    np.add.at(K, (solid.rows, solid.columns), solid.tangent())
    assert abs(K - K.T).max() > 1e-3 * abs(K).max()

    def residual(u):
        space.set_displacement(u)
        return solid.residual()

    assert_tangent(K, residual, u, direction, 1e-4, 1e-8)


def test_residual_and_tangent_are_signed_before_either_is_compiled(monkeypatch, cube):
    space, _ = cube
    made = forms(space, space.cell_constants(PARAMETERS))
    signed = []
    old = compat._form

    def compiled(form):
        signed.append([one._signature is not None for one in made])
        return old(form)

    monkeypatch.setattr(compat, "_form", compiled)
    Assembler(space, *made)
    assert signed == [[True, True]] * 2
