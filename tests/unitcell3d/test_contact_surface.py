"""Contact on the C1 surface: the surface, the closest point and the pressure against plain twins; the tangent."""

import numpy as np
import pytest
from scipy.optimize import minimize

from unitcell3d.contact_kernels import (
    contact_pass,
    evaluate,
    overlap_weight,
    plate_pass,
    pressure,
    project,
    surface_stencil,
)

NI, NJ = 6, 5
GRID = np.arange(NI * NJ).reshape(NI, NJ)
AXES = np.array([0, 1])
FREE, MIRROR = np.array([False, False]), np.array([True, True])
PENALTY, TOE = 1e4, 1e-3


@pytest.fixture
def wavy():
    """A curved master with unequal spacing; its rows i = 0, j = 0 on planes x = 0, y = 0."""
    i, j = np.meshgrid(np.arange(NI), np.arange(NJ), indexing="ij")
    x, y = i + 0.03 * i * j, 0.9 * j + 0.02 * j * i**2 / 5
    return np.stack([x, y, 0.3 * np.cos(0.4 * x) + 0.2 * np.cos(0.5 * y)], axis=-1).reshape(-1, 3)


def surface_at(x, xi, mirror):
    nodes, weights, values = np.empty(16, np.int64), np.empty((6, 16, 3)), np.empty((6, 3))
    surface_stencil(np.asarray(xi, float), GRID, AXES, mirror, nodes, weights, np.empty((4, 3, 4)))
    evaluate(x, nodes, weights, values)
    return values


def plain_surface(x, xi, mirror):
    """Catmull-Rom on a grid that really has its phantom rows."""
    nodes = x[GRID]
    low = [2 * nodes[0] - nodes[1], nodes[1] * [-1, 1, 1]][int(mirror[0])]
    nodes = np.concatenate([low[None], nodes, 2 * nodes[-1:] - nodes[-2:-1]])
    low = [2 * nodes[:, 0] - nodes[:, 1], nodes[:, 1] * [1, -1, 1]][int(mirror[1])]
    nodes = np.concatenate([low[:, None], nodes, 2 * nodes[:, -1:] - nodes[:, -2:-1]], axis=1)
    M = 0.5 * np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]])
    cell = np.clip(np.floor(xi).astype(int), 0, [NI - 2, NJ - 2])
    t = np.asarray(xi) - cell
    wi, wj = (np.array([1, s, s**2, s**3]) @ M for s in t)
    return np.einsum("a,b,abc->c", wi, wj, nodes[cell[0] : cell[0] + 4, cell[1] : cell[1] + 4])


@pytest.mark.parametrize("mirror", [FREE, MIRROR])
def test_surface_equals_the_plain_twin(wavy, mirror):
    for xi in ((0.3, 0.2), (2.5, 1.7), (4.6, 3.9), (5.3, 4.2), (0.0, 0.0)):
        assert np.allclose(surface_at(wavy, xi, mirror)[0], plain_surface(wavy, xi, mirror), atol=1e-13)
        step = 1e-6
        for k, shift in ((1, (step, 0)), (2, (0, step))):
            if min(xi) < step:
                continue
            ahead, behind = (plain_surface(wavy, np.add(xi, np.multiply(s, shift)), mirror) for s in (1, -1))
            assert np.allclose(surface_at(wavy, xi, mirror)[k], (ahead - behind) / (2 * step), atol=1e-8)


def test_surface_goes_through_the_nodes_and_is_smooth_across_cells(wavy):
    for i in range(1, NI - 1):
        for j in range(1, NJ - 1):
            assert np.allclose(surface_at(wavy, (i, j), MIRROR)[0], wavy[GRID[i, j]], atol=1e-14)
            left, right = surface_at(wavy, (i - 1e-12, j), MIRROR), surface_at(wavy, (i + 1e-12, j), MIRROR)
            assert np.allclose(left[:3], right[:3], atol=1e-10)


def test_surface_is_level_on_symmetry_planes(wavy):
    assert surface_at(wavy, (0.0, 1.3), MIRROR)[1, 2] == pytest.approx(0, abs=1e-14)
    assert surface_at(wavy, (2.3, 0.0), MIRROR)[2, 2] == pytest.approx(0, abs=1e-14)


def test_projection_finds_the_closest_point(wavy):
    rng = np.random.default_rng(2)
    scratch = np.empty(16, np.int64), np.empty((6, 16, 3)), np.empty((6, 3)), np.empty((4, 3, 4))
    for _ in range(20):
        point = surface_at(wavy, rng.uniform(0.2, [4.8, 3.8]), MIRROR)[0] + [0, 0, rng.uniform(-0.2, 0.2)]
        xi = np.array([2.5, 2.0])
        assert project(point, wavy, GRID, AXES, MIRROR, xi, *scratch)
        plain = minimize(
            lambda s, point=point: np.sum((plain_surface(wavy, s, MIRROR) - point) ** 2),
            xi + 0.01,
            method="Nelder-Mead",
            options={"xatol": 1e-9, "fatol": 1e-18},
        )
        assert np.allclose(xi, plain.x, atol=1e-6)


def test_pressure_has_the_toe():
    assert pressure(1e-9, PENALTY, TOE) == (0.0, 0.0)
    for gap in (-0.3 * TOE, -TOE, -5 * TOE):
        depth = -gap
        expected = PENALTY * depth**2 / (2 * TOE) if depth < TOE else PENALTY * (depth - TOE / 2)
        p, slope = pressure(gap, PENALTY, TOE)
        assert p == pytest.approx(expected, rel=1e-14)
        step = 1e-9
        difference = (pressure(gap + step, PENALTY, TOE)[0] - pressure(gap - step, PENALTY, TOE)[0]) / (2 * step)
        assert slope == pytest.approx(difference, rel=1e-5)


def test_overlap_fades_beyond_free_edges_only():
    assert overlap_weight(3.0, 5, True, True) == (1.0, 0.0)
    assert overlap_weight(5.5, 5, True, True)[0] == 0.0
    assert overlap_weight(-0.2, 5, False, True) == (1.0, 0.0)
    weight, slope = overlap_weight(5.2, 5, True, True)
    ahead, behind = overlap_weight(5.2 + 1e-7, 5, True, True)[0], overlap_weight(5.2 - 1e-7, 5, True, True)[0]
    assert 0 < weight < 1
    assert slope == pytest.approx((ahead - behind) / 2e-7, rel=1e-6)


def touch(x, slaves, mirror, tangent=False):
    n, s = len(x), len(slaves)
    areas, xi = np.linspace(0.5, 1.0, s), np.full((s, 2), 2.0)
    gaps, stencils, forces, resultant = np.empty(s), np.full((s, 17), -1), np.zeros((n, 3)), np.zeros(3)
    values = np.zeros((n * n, 3, 3))

    def run(places, forces):
        contact_pass(
            x,
            slaves,
            areas,
            GRID,
            AXES,
            mirror,
            1.0,
            PENALTY,
            TOE,
            xi,
            gaps,
            stencils,
            forces,
            places,
            values,
            resultant,
        )

    run(np.empty((0, 17, 17), np.int64), forces)
    if tangent:
        run(stencils[:, :, None] * n + stencils[:, None, :], np.zeros((n, 3)))
        return forces, values.reshape(n, n, 3, 3).transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)
    return forces, gaps, resultant


@pytest.fixture
def pressed(wavy):
    """Slave points that penetrate within the toe and beyond it, one that slides off the edge, one clear of contact."""
    places = [(0.3, 0.4), (2.2, 1.6), (3.7, 2.5), (5.15, 2.2), (4.4, 4.3), (1.5, 3.1)]
    depths = [0.0005, 0.01, 0.03, 0.01, 0.02, -0.01]
    points = []
    for xi, depth in zip(places, depths):
        S = surface_at(wavy, xi, FREE)
        normal = np.cross(S[1], S[2])
        points.append(S[0] - depth * normal / np.linalg.norm(normal))
    return np.concatenate([wavy, points]), np.arange(len(wavy), len(wavy) + len(points)), depths


def test_gap_is_the_signed_distance(pressed):
    x, slaves, depths = pressed
    assert np.allclose(touch(x, slaves, FREE)[1], -np.array(depths), atol=1e-12)


def test_forces_balance(pressed):
    """Action is reaction: no net force, no net moment, on a surface without symmetry planes."""
    x, slaves, _ = pressed
    forces, _, resultant = touch(x, slaves, FREE)
    size = np.abs(forces).max()
    assert size > 1
    assert np.abs(forces.sum(axis=0)).max() < 1e-12 * size
    assert np.abs(np.cross(x, forces).sum(axis=0)).max() < 1e-11 * size
    # `forces` are internal forces: minus the contact's push on the slaves
    assert np.allclose(forces[slaves].sum(axis=0), -resultant, rtol=1e-12)


@pytest.mark.parametrize("mirror", [FREE, MIRROR])
def test_tangent_is_the_derivative(pressed, mirror):
    x, slaves, _ = pressed
    direction = np.random.default_rng(3).standard_normal(x.shape)
    K = touch(x, slaves, mirror, tangent=True)[1]
    step = 1e-6
    ahead, behind = (touch(x + s * step * direction, slaves, mirror)[0] for s in (1, -1))
    difference = (ahead - behind).ravel() / (2 * step)
    assert np.abs(K @ direction.ravel() - difference).max() < 1e-7 * np.abs(difference).max()


def test_plate_pushes_back():
    x = np.array([[0, 0, 0.10], [0, 0, 0.0995], [0, 0, 0.08]])
    forces, values = np.zeros((3, 3)), np.zeros((3, 3, 3))
    areas = np.array([1.0, 2.0, 3.0])
    force = plate_pass(x, np.arange(3), areas, 0.099, 1.0, PENALTY, TOE, forces, np.arange(3), values)
    expected = [pressure(0.099 - z, PENALTY, TOE)[0] * a for z, a in zip(x[:, 2], areas)]
    assert force == pytest.approx(sum(expected))
    assert np.allclose(forces[:, 2], expected)
    assert np.allclose(values[:, 2, 2], [-pressure(0.099 - z, PENALTY, TOE)[1] * a for z, a in zip(x[:, 2], areas)])
