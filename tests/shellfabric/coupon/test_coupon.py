"""Coupons: forces against a plain twin and its derivative, the bound on the stiffness."""

from dataclasses import replace

import numpy as np
import pytest
from panels import potential_grid

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.coupon import relaxation_kernels
from shellfabric.coupon.model import mesh_coupon


@pytest.fixture(scope="module")
def table():
    return CellModel(catalogue.load("S-728"), cell_formulation="variational").table(61)


def disc(x, y):
    return np.hypot(x, y) < 0.0071


@pytest.fixture(params=["bias", "cross", "fine", "unlike"])
def coupon(request, table):
    """A disc cut on the bias; a cross whose arms have lost their cross yarns; a disc of two elements a crossover; one
    whose warp and weft have unlike spacings."""
    if request.param == "unlike":
        weave = table.model.fabric.weave
        weave = replace(weave, weft_count=0.7 * weave.weft_count)
        model = replace(table.model, fabric=replace(table.model.fabric, weave=weave))
        return mesh_coupon(model.table(61), disc, 0.0071, angle=0.3)
    if request.param == "bias":
        return mesh_coupon(table, disc, 0.0071, angle=np.pi / 4)
    if request.param == "fine":
        return mesh_coupon(table, disc, 0.0071, angle=0.3, elements_per_crossover=2)
    w = table.model.fabric.weave.w1

    def cross(x, y):
        return ((abs(x) < 4.1 * w) | (abs(y) < 4.1 * w)) & (np.maximum(abs(x), abs(y)) < 8.1 * w)

    return mesh_coupon(table, cross, 8.1 * w, woven=lambda x, y: (abs(y) < 4 * w, abs(x) < 4 * w))


def crumpled(coupon, seed=1):
    """Stretched beyond the table, sheared and shaken."""
    rng = np.random.default_rng(seed)
    x = coupon.points @ np.array([[1.03, 0.12], [0.05, 1.01]])
    return x + rng.normal(scale=1.5e-5, size=x.shape)


def twin(coupon, x):
    """Energy from the definitions: the potential by its coefficients, every mean by a search of the edges."""
    table = coupon.table
    weave = coupon.weave
    shear = coupon.table.model.fabric.shear
    energy = 0.0
    lengths = [
        np.linalg.norm(x[e[:, 1]] - x[e[:, 0]], axis=1) / d
        for e, d in zip(coupon.edges, coupon.spacing)
    ]
    sides = set()
    for p, q, r, s in coupon.quads:
        sides |= {frozenset(side) for side in ((p, q), (s, r), (p, s), (q, r))}
    woven = [[frozenset(e) in sides for e in edges] for edges in coupon.edges]

    def potential(l1, l2):
        p, q = (
            (l - g[0]) / (g[1] - g[0]) for l, g in zip((l1, l2), (table.stretch1, table.stretch2))
        )
        p = max(p, 0)
        q = max(q, 0)
        i, j = (min(int(v), g.size - 2) for v, g in zip((p, q), (table.stretch1, table.stretch2)))
        basis = [[1, v, v * v] for v in (p - i, q - j)]
        return basis[0] @ table.spline[i, j].reshape(3, 3) @ basis[1]

    for m in (0, 1):
        yarn = weave.yarns[m]
        w = weave.w[m]
        S0 = weave.S0[m]
        for e, ends in enumerate(coupon.edges[m]):
            own = lengths[m][e]
            n = coupon.cells[m][e]
            if not woven[m][e]:
                energy += n * 0.5 * yarn.EA * max(2 * w * own - S0, 0) ** 2 / S0
                continue
            others = [
                k
                for k, o in enumerate(coupon.edges[1 - m])
                if woven[1 - m][k] and set(o) & set(ends)
            ]
            mean = np.mean(lengths[1 - m][others])
            energy += 0.5 * n * (potential(own, mean) if m == 0 else potential(mean, own))
    dX, dY = coupon.spacing
    for p, q, r, s in coupon.quads:
        a = x[q] - x[p] + x[r] - x[s]
        b = x[s] - x[p] + x[r] - x[q]
        gamma = np.arcsin(a @ b / np.linalg.norm(a) / np.linalg.norm(b))
        points, weights = np.polynomial.legendre.leggauss(30)
        energy += (
            dX
            * dY
            * weave.thickness
            * np.sum(0.5 * gamma * weights * shear.stress(0.5 * gamma * (1 + points)))
        )
    return energy


def test_energy_against_the_plain_twin(coupon):
    x = crumpled(coupon)
    assert sum(coupon.forces(x)[2]) == pytest.approx(twin(coupon, x), rel=1e-6)


def test_forces_are_the_gradient(coupon):
    x = crumpled(coupon)
    f = coupon.forces(x)[0]
    rng = np.random.default_rng(2)
    for node in rng.choice(len(x), 12, replace=False):
        for c in range(2):
            energies = []
            for sign in (1, -1):
                moved = x.copy()
                moved[node, c] += sign * 1e-9
                energies.append(sum(coupon.forces(moved)[2]))
            assert f[node, c] == pytest.approx(
                (energies[1] - energies[0]) / 2e-9, abs=2e-5 * abs(f).max()
            )


def test_the_bound_covers_the_stiffness(coupon):
    """No eigenvalue of the stiffness over the bound exceeds one, and it is not wasteful."""
    x = crumpled(coupon)
    bound = coupon.forces(x)[1]
    n = len(x)
    K = np.empty((2 * n, 2 * n))
    for k in range(2 * n):
        f = []
        for sign in (1, -1):
            moved = x.copy()
            moved.ravel()[k] += sign * 1e-9
            f.append(coupon.forces(moved)[0].ravel())
        K[:, k] = (f[1] - f[0]) / 2e-9
    held = bound > 0  # a node between slack yarns has no stiffness
    assert not K[~np.repeat(held, 2)].any()
    part = np.repeat(held, 2)
    K = K[np.ix_(part, part)]
    root = np.repeat(bound[held], 2) ** -0.5
    highest = np.linalg.eigvalsh(root[:, None] * 0.5 * (K + K.T) * root)[-1]
    assert 0.2 < highest < 1.0


def test_uniform_stretch_is_one_cell(table):
    """The energy of any coupon is that of its cells, whatever its outline and refinement; cross stretch is felt."""
    W = float(CellModel(table.model.fabric, cell_formulation="variational").solve(1.02, 1.01)["W"])
    for m in (1, 2):
        coupon = mesh_coupon(table, disc, 0.0071, elements_per_crossover=m)
        energy = coupon.forces(coupon.points * [1.02, 1.01])[2][0]
        assert energy == pytest.approx(len(coupon.quads) / m**2 * W, rel=1e-3)


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_an_element_lies_in_the_outline_with_all_its_corners(table, angle):
    """Of all elements of the grid those, and no others: a slanted outline cuts through some."""
    side = 2 * table.model.fabric.weave.w1

    def triangle(x, y):
        return (x > -0.0051) & (y > -0.0043) & (0.8 * x + y < 0.0037)

    coupon = mesh_coupon(table, triangle, 0.0071, angle=angle)
    corners = coupon.points[coupon.quads]
    assert triangle(*np.moveaxis(corners, -1, 0)).all()
    grid = side * np.arange(-20, 21)
    X, Y = np.meshgrid(grid, grid, indexing="ij")
    x, y = np.cos(angle) * X - np.sin(angle) * Y, np.sin(angle) * X + np.cos(angle) * Y
    within = triangle(x, y)
    whole = within[:-1, :-1] & within[1:, :-1] & within[:-1, 1:] & within[1:, 1:]
    assert len(coupon.quads) == whole.sum()


def test_angles_beyond_a_right_angle(table):
    """Yarns that have passed one another are seen as such."""
    coupon = mesh_coupon(table, lambda x, y: np.maximum(abs(x), abs(y)) < 0.003, 0.003)
    for gamma in (-0.3, 0.0, 1.2, 2.0):
        x, y = coupon.points.T
        sheared = np.stack([x + y * np.sin(gamma), y * np.cos(gamma)], axis=1)
        assert coupon.shear_angles(sheared) == pytest.approx(gamma, abs=1e-12)


def test_slack_yarns_carry_nothing(table):
    """Below the table the tension is zero whatever the other yarn does, and so it is at the table's lowest edge."""
    args = potential_grid(table)
    for other in np.linspace(0.95, 1.2, 40):
        assert abs(relaxation_kernels.potential(table.stretch1[0] - 0.01, other, *args)[1]) < 1e-12
        assert abs(relaxation_kernels.potential(other, table.stretch2[0], *args)[2]) < 1e-12


def test_stretches_of_warp_and_weft_are_those_of_their_directions(coupon):
    """Of an even motion: the length of each direction after it."""
    motion = np.array([[1.03, 0.12], [-0.05, 0.98]])
    found = coupon.stretches(coupon.points @ motion)
    for edges, spacing, stretch in zip(coupon.edges, coupon.spacing, found):
        along = coupon.points[edges[0, 1]] - coupon.points[edges[0, 0]]
        assert np.linalg.norm(along) == pytest.approx(spacing)
        assert stretch == pytest.approx(np.linalg.norm(along @ motion) / spacing)


def test_mean_tensions_against_the_plain_twin(coupon):
    """The hat about each segment over those beside it, by their widths; on outlines, at any angle and any length."""
    fabric = replace(coupon.table.model.fabric, failure_length=2.7e-3)
    wide = replace(
        coupon, table=replace(coupon.table, model=replace(coupon.table.model, fabric=fabric))
    )
    x = crumpled(wide)
    for family, (T, means) in enumerate(zip(wide.tensions(x), wide.mean_tensions(x))):
        middles = wide.points[wide.edges[family]].mean(axis=1)
        side = wide.spacing[1 - family]
        along = np.subtract(*wide.points[wide.edges[family][0, ::-1]])
        along /= np.linalg.norm(along)
        y = ((np.arange(4000) + 0.5) / 4000 - 0.5) * side  # of the fabric that a line stands for
        for k in range(0, T.size, 7):
            away = middles - middles[k]
            beside = abs(away @ along) < 1e-3 * side
            hat = np.maximum(
                0, 1 - abs(away[beside] @ (-along[1], along[0]) + y[:, None]) / 2.7e-3
            ).mean(axis=0)
            part = hat * wide.cells[family][beside]
            assert means[k] == pytest.approx(part @ T[beside] / part.sum(), rel=1e-3)
