"""Contact on the C1 surface: the surface, the closest point and the pressure against plain twins; the tangent."""

import numpy as np
import pytest
from equations import assert_tangent, dense, slope
from numpy.testing import assert_allclose
from scipy.optimize import minimize

from unitcell3d.contact.kernel_arguments import (
    Blocks,
    ContactLaw,
    Face,
    PassState,
    PlateFace,
    SlavePoints,
)
from unitcell3d.contact.plate_contact_kernels import plate_pass, update_plate_anchors
from unitcell3d.contact.surface_contact_kernels import contact_pass, overlap_weight, pressure
from unitcell3d.contact.surface_kernels import evaluate, nodes_of, project, surround, weights_of

NI = 6
NJ = 5
GRID = np.arange(NI * NJ).reshape(NI, NJ)
AXES = np.array([0, 1])
FREE = np.array([False, False])
MIRROR = np.array([True, True])
PENALTY = 1e4
TOE = 1e-3
PLACES = ((0.3, 0.2), (2.5, 1.7), (4.6, 3.9), (5.3, 4.2), (0.0, 0.0))


@pytest.fixture
def wavy():
    """A curved master with unequal spacing; its rows i = 0, j = 0 on planes x = 0, y = 0."""
    i, j = np.meshgrid(np.arange(NI), np.arange(NJ), indexing="ij")
    x = i + 0.03 * i * j
    y = 0.9 * j + 0.02 * j * i**2 / 5
    return np.stack([x, y, 0.3 * np.cos(0.4 * x) + 0.2 * np.cos(0.5 * y)], axis=-1).reshape(-1, 3)


def ringed(x, mirror):
    ring = np.empty((NI + 2, NJ + 2, 3))
    surround(x, GRID, AXES, mirror, ring)
    return ring


def surface_at(x, xi, mirror):
    values = np.empty((6, 3))
    evaluate(ringed(x, mirror), np.asarray(xi, float), np.empty((3, 4)), np.empty((3, 4)), values)
    return values


def plain_surface(x, xi, mirror):
    """Mean of the Catmull-Rom and the cubic B-spline on a grid that really has its phantom rows."""
    nodes = x[GRID]
    low = [2 * nodes[0] - nodes[1], nodes[1] * [-1, 1, 1]][int(mirror[0])]
    nodes = np.concatenate([low[None], nodes, 2 * nodes[-1:] - nodes[-2:-1]])
    low = [2 * nodes[:, 0] - nodes[:, 1], nodes[:, 1] * [1, -1, 1]][int(mirror[1])]
    nodes = np.concatenate([low[:, None], nodes, 2 * nodes[:, -1:] - nodes[:, -2:-1]], axis=1)
    catmull_rom = 0.5 * np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]])
    b_spline = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6
    cell = np.clip(np.floor(xi).astype(int), 0, [NI - 2, NJ - 2])
    t = np.asarray(xi) - cell
    wi, wj = (np.array([1, s, s**2, s**3]) @ (catmull_rom + b_spline) / 2 for s in t)
    return np.einsum("a,b,abc->c", wi, wj, nodes[cell[0] : cell[0] + 4, cell[1] : cell[1] + 4])


@pytest.mark.parametrize("mirror", [FREE, MIRROR])
def test_surface_equals_the_plain_twin(wavy, mirror):
    for xi in PLACES:
        assert_allclose(
            surface_at(wavy, xi, mirror)[0], plain_surface(wavy, xi, mirror), atol=1e-13
        )
        for k, direction in enumerate(np.eye(2), 1):
            along = slope(lambda s: plain_surface(wavy, s, mirror), np.array(xi), direction, 1e-3)
            assert_allclose(surface_at(wavy, xi, mirror)[k], along, atol=1e-11)


@pytest.mark.parametrize("mirror", [FREE, MIRROR])
def test_weights_of_the_nodes_make_the_surface(wavy, mirror):
    """Also: over each cell they integrate to a quarter for each of its corners, as those of a bilinear face."""
    nodes = np.empty(16, np.int64)
    weights = np.empty((3, 16, 3))
    work = np.empty((4, 3, 4))
    for xi in PLACES:
        cell = [int(np.clip(np.floor(p), 0, n - 2)) for p, n in zip(xi, (NI, NJ))]
        nodes_of(GRID, *cell, nodes)
        weights_of(np.array(xi), GRID, AXES, mirror, weights, work)
        for k in range(3):
            found = np.einsum("mc,mc->c", weights[k], wavy[nodes])
            assert_allclose(found, surface_at(wavy, xi, mirror)[k], atol=1e-12)
    places, shares = np.polynomial.legendre.leggauss(4)
    for i in (0, 2, NI - 2):
        for j in (0, NJ - 2):
            total = np.zeros(NI * NJ)
            nodes_of(GRID, i, j, nodes)
            for a, wa in zip(places, shares):
                for b, wb in zip(places, shares):
                    weights_of(
                        np.array([i + 0.5 + 0.5 * a, j + 0.5 + 0.5 * b]),
                        GRID,
                        AXES,
                        mirror,
                        weights,
                        work,
                    )
                    np.add.at(total, nodes, wa * wb / 4 * weights[0, :, 2])
            corners = GRID[i : i + 2, j : j + 2].ravel()
            assert_allclose(total[corners], 0.25, atol=1e-14)
            assert_allclose(np.delete(total, corners), 0, atol=1e-14)


def test_projection_finds_the_closest_point(wavy):
    rng = np.random.default_rng(2)
    scratch = np.empty((3, 4)), np.empty((3, 4)), np.empty((6, 3))
    for _ in range(20):
        point = surface_at(wavy, rng.uniform(0.2, [4.8, 3.8]), MIRROR)[0] + [
            0,
            0,
            rng.uniform(-0.2, 0.2),
        ]
        xi = np.array([2.5, 2.0])
        assert project(point, ringed(wavy, MIRROR), xi, *scratch)

        def squared(s, point=point):
            return np.sum((plain_surface(wavy, s, MIRROR) - point) ** 2)

        plain = minimize(
            squared, xi + 0.01, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-18}
        )
        assert_allclose(xi, plain.x, atol=1e-6)


def test_pressure_has_the_toe():
    assert pressure(1e-9, PENALTY, TOE) == (0.0, 0.0)
    for gap in (-0.3 * TOE, -TOE, -5 * TOE):
        depth = -gap
        expected = PENALTY * depth**2 / (2 * TOE) if depth < TOE else PENALTY * (depth - TOE / 2)
        p, slope = pressure(gap, PENALTY, TOE)
        assert p == pytest.approx(expected, rel=1e-14)
        step = 1e-9
        difference = (
            pressure(gap + step, PENALTY, TOE)[0] - pressure(gap - step, PENALTY, TOE)[0]
        ) / (2 * step)
        assert slope == pytest.approx(difference, rel=1e-5)


def test_overlap_fades_beyond_free_edges_only():
    assert overlap_weight(3.0, 5, True, True) == (1.0, 0.0)
    assert overlap_weight(5.5, 5, True, True)[0] == 0.0
    assert overlap_weight(-0.2, 5, False, True) == (1.0, 0.0)
    weight, slope = overlap_weight(5.2, 5, True, True)
    ahead = overlap_weight(5.2 + 1e-7, 5, True, True)[0]
    behind = overlap_weight(5.2 - 1e-7, 5, True, True)[0]
    assert 0 < weight < 1
    assert slope == pytest.approx((ahead - behind) / 2e-7, rel=1e-6)


SHAPES = np.array([[0.62, 0.17, 0.04, 0.17], [0.25, 0.25, 0.25, 0.25]])
FRICTION = 0.4
SLIP = 0.02


def touch(x, quads, mirror, tangent=False, friction=0.0, away=(0.0, 0.0)):
    """Forces, gaps and resultant of one pass, or forces and tangent; points stuck last `away` from where they are."""
    n = len(x)
    s = len(quads) * len(SHAPES)
    areas = np.linspace(0.5, 1.0, s)
    xi = np.full((s, 2), 2.0)
    master = (NI - 1) * (NJ - 1)
    gaps = np.empty(s)
    codes = np.full(s, -1)
    forces = np.zeros((n, 3))
    resultant = np.zeros(3)
    values = np.zeros((n * n, 3, 3))
    anchors = touch.anchors + np.array(away) if friction else xi.copy()

    slave = SlavePoints(quads, SHAPES, areas)
    state = PassState(xi, anchors, gaps, codes)
    law = ContactLaw(PENALTY, TOE, friction, SLIP)

    def run(row_of, places, forces):
        blocks = Blocks(row_of, places, values)
        contact_pass(x, slave, Face(GRID, AXES, mirror, 1.0), law, state, forces, blocks, resultant)

    run(np.empty(0, np.int64), np.empty((0, 20, 20), np.int64), forces)
    if not friction:
        touch.anchors = xi.copy()
    if tangent:
        stencils = []
        row_of = np.full(len(quads) * master, -1)
        for row, code in enumerate(np.unique(codes[codes >= 0])):
            nodes = np.empty(16, np.int64)
            nodes_of(GRID, *divmod(code % master, NJ - 1), nodes)
            stencils.append([*quads[code // master], *nodes])
            row_of[code] = row
        stencils = np.array(stencils)
        run(row_of, stencils[:, :, None] * n + stencils[:, None, :], np.zeros((n, 3)))
        return forces, dense(values, n)
    return forces, gaps, resultant


@pytest.fixture
def pressed(wavy):
    """Slave faces: one deep in the master, one within the toe, one that slides off an edge, one clear of contact, one
    that slides off a corner, over one side by more than over the other."""
    middles = [(0.7, 0.8), (2.2, 1.6), (5.1, 2.2), (1.5, 3.1), (NI - 0.88, NJ - 0.95)]
    depths = [0.03, 0.0005, 0.02, -0.05, 0.025]
    points = []
    for (i, j), depth in zip(middles, depths):
        for a, b in ((-0.1, -0.1), (0.1, -0.12), (0.11, 0.1), (-0.1, 0.1)):
            S = surface_at(wavy, (i + a, j + b), FREE)
            normal = np.cross(S[1], S[2])
            points.append(S[0] - depth * normal / np.linalg.norm(normal))
    return (
        np.concatenate([wavy, points]),
        len(wavy) + np.arange(4 * len(middles)).reshape(-1, 4),
        depths,
    )


def test_gap_is_the_signed_distance(pressed):
    x, quads, depths = pressed
    gaps = touch(x, quads, FREE)[1].reshape(len(quads), -1)
    # the faces are flat
    for face in (0, 2, 3):
        assert_allclose(gaps[face], -depths[face], rtol=0, atol=2e-3)
    assert np.all(-gaps[1] < TOE)
    assert np.any(gaps[1] < 0)


@pytest.mark.parametrize("friction", [0.0, FRICTION])
def test_forces_balance(pressed, friction):
    """Action is reaction: no net force, on a surface without symmetry planes, and no net moment.

    Friction acts on both sides of the penetration, which leaves a moment of friction times penetration.
    """
    x, quads, depths = pressed
    touch(x, quads, FREE)
    forces, _, resultant = touch(x, quads, FREE, friction=friction, away=(0.05, -0.01))
    size = abs(forces).max()
    assert size > 1
    assert abs(forces.sum(axis=0)).max() < 1e-12 * size
    moment = abs(np.cross(x, forces).sum(axis=0)).max()
    assert moment < (
        1e-11 * size if friction == 0 else 1.1 * friction * max(depths) * np.linalg.norm(resultant)
    )
    # `forces` are internal forces: minus the contact's push on the slaves
    assert_allclose(forces[quads.ravel()].sum(axis=0), -resultant, rtol=1e-12)


@pytest.mark.parametrize("mirror", [FREE, MIRROR])
@pytest.mark.parametrize(
    "away", [None, (1e-3, 2e-3), (0.3, -0.2)], ids=["frictionless", "sticking", "sliding"]
)
def test_tangent_is_the_derivative(pressed, mirror, away):
    x, quads, _ = pressed
    x = x.copy()
    touch(x, quads, mirror)  # where the points stuck
    friction = {} if away is None else {"friction": FRICTION, "away": away}
    direction = np.random.default_rng(3).standard_normal(x.shape)
    K = touch(x, quads, mirror, tangent=True, **friction)[1]
    assert_tangent(K, lambda x: touch(x, quads, mirror, **friction)[0], x, direction, 2e-7)


def test_friction_is_coulombs(pressed):
    """Below the regularisation slip the traction grows in proportion; beyond it, it is the coefficient times p."""
    x, quads, _ = pressed
    deep = quads[0]
    push = touch(x, quads, FREE)[0][deep].sum(axis=0)

    def pull(away):
        forces = touch(x, quads, FREE, friction=FRICTION, away=(away, 0.0))[0]
        return np.linalg.norm(forces[deep].sum(axis=0) - push)

    assert pull(4e-4) == pytest.approx(2 * pull(2e-4), rel=1e-6)
    for away in (0.1, 0.2):
        assert pull(away) == pytest.approx(FRICTION * np.linalg.norm(push), rel=1e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_plate_pushes_back_and_rubs(side):
    """Coulomb's friction, its tangent, and anchors that follow what has slid to within the regularisation slip."""
    x = np.array([[0.003, 0.004, 0.1003], [0.3, 0.4, 0.11], [0.3, 0.4, 0.08], [0, 0, 0.0995]]) * [
        1,
        1,
        side,
    ]
    areas = np.array([1.0, 2.0, 3.0, 4.0])
    nodes = np.arange(4)
    anchors = np.zeros((4, 2))
    face = PlateFace(nodes, areas, side, anchors)

    def run(x):
        forces = np.zeros((4, 3))
        values = np.zeros((4, 3, 3))
        force = plate_pass(
            x, face, side * 0.099, ContactLaw(PENALTY, TOE, FRICTION, SLIP), forces, nodes, values
        )
        return forces, values, force

    forces, values, force = run(x)
    expected = [pressure(0.099 - abs(z), PENALTY, TOE)[0] * a for z, a in zip(x[:, 2], areas)]
    assert force == pytest.approx(sum(expected))
    assert side * forces[:, 2] == pytest.approx(expected)
    assert np.linalg.norm(forces[0, :2]) == pytest.approx(
        FRICTION * abs(forces[0, 2]) * 0.005 / SLIP
    )
    assert np.linalg.norm(forces[1, :2]) == pytest.approx(FRICTION * abs(forces[1, 2]))
    assert np.all(forces[2] == 0)
    blocks = np.zeros((12, 12))
    for node in nodes:
        blocks[3 * node : 3 * node + 3, 3 * node : 3 * node + 3] = values[node]
    assert_tangent(
        blocks, lambda x: run(x)[0], x, np.random.default_rng(0).standard_normal((4, 3)), 1e-6
    )
    update_plate_anchors(x, face, side * 0.099, SLIP)
    assert np.allclose(anchors[[0, 3]], 0)
    assert np.linalg.norm(x[1, :2] - anchors[1]) == pytest.approx(SLIP)
    assert np.allclose(anchors[2], x[2, :2])
