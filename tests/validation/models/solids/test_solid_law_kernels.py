"""The law of solid yarns for Numba: against itself in UFL and in numpy's factorisation, and its closed forms."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fabrics import catalogue, yarn_stress_kernels
from tests.meshing.hexahedra import CUBE
from validation.models.solids import law_kernels

SOLID = catalogue.load("S-720").solid_laws[0]
LAW = (SOLID.E_a, SOLID.a_E, SOLID.b_E, SOLID.Vf0, SOLID.V_c, SOLID.G)
STILL = (0.0, 0.0)


def gradients(count):
    """Random F Q0 (3, 3): sheared, pressed to the packing of the fibres and beyond, and turned."""
    random = np.random.default_rng(1)
    for _ in range(count):
        stretch = np.eye(3) + np.diag(random.uniform([-0.03, -0.2, -0.35], [0.05, 0.1, 0.1]))
        shear = 0.1 * np.triu(random.normal(size=(3, 3)), 1)
        turn = Rotation.from_rotvec(random.normal(size=3)).as_matrix()
        yield turn @ (stretch + shear)


def stress(f):
    """P of the kernel without viscosity."""
    P = np.empty((3, 3))
    law_kernels.damped_stress(f, LAW, STILL, 0.0, STILL, 1.0, P)
    return P


def plain_stress(f, law=LAW):
    """P of the law by numpy's QR factorisation, the corners of E_2 rounded by hand."""
    E_a, a_E, b_E, Vf0, V_c, G = law
    Q, R = np.linalg.qr(f)
    sign = np.diag(np.sign(np.diag(R)))
    Q = Q @ sign
    R = sign @ R

    def rounded(value, corner, width):
        inside = np.clip(value - corner + width, 0, 2 * width)
        return corner + inside**2 / (4 * width) + max(value - corner - width, 0)

    V_f = Vf0 / (R[1, 1] * R[2, 2])
    E_2 = a_E / (b_E + rounded(-rounded(V_f, Vf0, 5e-3), -V_c, 2e-3))
    shear = np.triu(G * R / np.diag(R), 1)
    S = shear + shear.T + np.diag(np.array([E_a * V_f, E_2, E_2]) * np.log(np.diag(R)))
    return np.linalg.det(R) * Q @ S @ np.linalg.inv(R).T


def test_the_law_equals_its_plain_twin():
    for f in gradients(30):
        assert stress(f) == pytest.approx(plain_stress(f), rel=1e-9, abs=1e-6)


def test_the_law_equals_that_of_the_quasi_static_crossover():
    pytest.importorskip("dolfinx")
    from unitcell3d.assembly.compat import Assembler, HexSpace
    from unitcell3d.material.solid_law import forms

    space = HexSpace.build(CUBE, np.arange(8)[None])
    solid = Assembler(space, *forms(space, space.cell_constants(np.array([LAW]))))
    for f in gradients(12):
        space.set_displacement(CUBE @ (f - np.eye(3)).T)
        P = solid.residual().T @ CUBE
        assert np.abs(stress(f) - P).max() < 1e-12 * np.abs(P).max()


def test_a_stretch_through_the_yarn_has_the_secant_modulus():
    P = stress(np.diag([1.0, 1.0, 0.8]))
    E_2 = float(SOLID.transverse_modulus(SOLID.Vf0 / 0.8))
    assert P[2, 2] == pytest.approx(E_2 * np.log(0.8), rel=1e-12)


@pytest.mark.parametrize("V_f", [0.6, 0.696, 0.703, 0.8, 0.99, 0.9985, 1.001, 1.2])
def test_the_slope_of_the_modulus_is_its_derivative(V_f):
    rest = (SOLID.Vf0, SOLID.V_c, SOLID.a_E, SOLID.b_E)
    up = law_kernels.transverse_modulus(V_f + 1e-7, *rest)
    down = law_kernels.transverse_modulus(V_f - 1e-7, *rest)
    slope = law_kernels.modulus_slope(V_f, *rest)
    assert slope == pytest.approx((up - down) / 2e-7, rel=1e-5, abs=1.0)


def test_no_direction_is_stiffer_than_the_bound():
    """The bound times the size of a change of F is not passed by the change of P, edge by edge."""
    random = np.random.default_rng(7)
    for f in gradients(20):
        bounds = law_kernels.moduli_bound(f, LAW)
        for edge in range(3):
            step = np.zeros((3, 3))
            step[:, edge] = 1e-7 * random.normal(size=3)
            change = (stress(f + step) - stress(f - step))[:, edge]
            assert change @ step[:, edge] <= 1.01 * 2 * bounds[edge] * (
                step[:, edge] @ step[:, edge]
            )


def test_viscosity_damps_the_highest_mode_by_its_ratio():
    """On a row of bricks of the height L: c / c_critical = eta / (L (E rho)^(1/2)) = xi."""
    L, density, xi, rate = 1e-4, 1008.0, 0.1, 1e4
    eta = (0.0, xi * np.sqrt(density) * L)
    P = np.empty((3, 3))
    loss = law_kernels.damped_stress(np.eye(3), LAW, (0.0, -rate * 1e-9), 1e9, eta, 1.0, P)[2]
    E_2 = law_kernels.transverse_modulus(SOLID.Vf0, *(SOLID.Vf0, SOLID.V_c, SOLID.a_E, SOLID.b_E))
    assert P[2, 2] == pytest.approx(xi * L * np.sqrt(E_2 * density) * rate, rel=1e-9)
    assert loss == pytest.approx(P[2, 2] * rate, rel=1e-9)


def test_the_energy_of_a_fibre_is_the_integral_of_its_force():
    for strain in (-0.02, -1e-6, 2e-5, 7e-5, 1.2e-4, 0.02):
        at = yarn_stress_kernels.fibre_energy
        slope = (at(strain + 1e-8, 1e-3, 1e-4) - at(strain - 1e-8, 1e-3, 1e-4)) / 2e-8
        value = yarn_stress_kernels.fibre_law(strain, 1e-3, 1e-4)[0]
        assert value == pytest.approx(slope, rel=1e-4, abs=1e-9)
