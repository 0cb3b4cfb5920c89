"""The explicit patch of solid yarns: laws against those of the quasi-static crossover, invariants, balances, twins."""

import numpy as np
import pytest

pytest.importorskip("gmsh")

from fabrics import catalogue
from fabrics.errors import InputError, UnstableError
from meshing import crossover, patch
from shellfabric.backing.hex8 import CORNERS, PATTERNS, Bricks
from shellfabric.projectile.projectile import Projectile
from validation.models.solid import fibre_kernels, solid_kernels, yarn_contact_kernels
from validation.models.solid import step_kernels as solid_step_kernels
from validation.models.solid.model import SolidPatch, _corners
from validation.models.solid.numerics import PatchNumerics
from validation.models.solid.solver import SolidSolver

FABRIC = catalogue.load("S-720")
SIZE = (2, 2, 1)


@pytest.fixture(scope="module")
def mesh():
    return patch.build(FABRIC, (4, 4), size=SIZE)


def struck(mesh, **changes):
    """A march of the small patch, 2 us at 60 m/s."""
    keys = ("failure", "clamped")
    own = {key: changes.pop(key) for key in keys if key in changes}
    numerics = PatchNumerics(**changes.pop("numerics", {}))
    end = changes.pop("end_time", 2e-6)
    return SolidSolver(SolidPatch(mesh, FABRIC, numerics=numerics, **own), 60.0, end, **changes)


def rotation(axis, angle):
    axis = np.asarray(axis) / np.linalg.norm(axis)
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def forces_of(const, state, x, dt=0.0):
    """Internal forces (n, 3) and sums at given places, from rest."""
    state.x[:] = x
    state.v[:] = 0
    state.projectile_position[2] = -1.0
    solid_step_kernels.forces(state, const, dt)
    return state.f_material + state.f_other


# the law


def law_of(Vf0=0.7):
    solid = FABRIC.solid_laws[0]
    return np.array([solid.E_a, solid.a_E, solid.b_E, Vf0, solid.V_c, solid.G])


def plain_piola(f, law):
    """P of the law by numpy's QR factorisation."""
    E_a, a_E, b_E, Vf0, V_c, G = law
    Q, R = np.linalg.qr(f)
    sign = np.diag(np.sign(np.diag(R)))
    Q, R = Q @ sign, sign @ R
    V_f = Vf0 / (R[1, 1] * R[2, 2])
    rounded = lambda v, c, w: c if v <= c - w else v if v >= c + w else c + (v - c + w) ** 2 / (4 * w)  # noqa: E731
    E_2 = a_E / (b_E + rounded(-rounded(V_f, Vf0, 5e-3), -V_c, 2e-3))
    S = G * (R / np.diag(R))
    S = np.triu(S, 1) + np.triu(S, 1).T + np.diag(np.array([E_a * V_f, E_2, E_2]) * np.log(np.diag(R)))
    return np.linalg.det(R) * Q @ S @ np.linalg.inv(R).T


def gradients(count=30):
    random = np.random.default_rng(1)
    for _ in range(count):
        F = np.eye(3) + np.diag(random.uniform([-0.03, -0.2, -0.35], [0.05, 0.1, 0.1]))
        yield rotation(random.normal(size=3), random.uniform(0, 3)) @ (F + 0.1 * np.triu(random.normal(size=(3, 3)), 1))


def test_law_equals_its_plain_twin():
    P = np.empty((3, 3))
    for f in gradients():
        solid_kernels.piola(f, law_of(), 0.0, 0.0, 0.0, 0.0, 0.0, P)
        assert P == pytest.approx(plain_piola(f, law_of()), rel=1e-9, abs=1e-6)


def test_law_equals_that_of_the_quasi_static_crossover():
    pytest.importorskip("dolfinx")
    from unitcell3d.assembly.compat import Assembler, HexSpace
    from unitcell3d.material.solid_law import forms

    cube = 0.5 * (CORNERS + 1.0)
    space = HexSpace.build(cube, np.arange(8)[None])
    solid = Assembler(space, *forms(space, space.cell_constants(law_of()[None])))
    P = np.empty((3, 3))
    for f in gradients(12):
        space.set_displacement(cube @ (f - np.eye(3)).T)
        solid_kernels.piola(f, law_of(), 0.0, 0.0, 0.0, 0.0, 0.0, P)
        assert P == pytest.approx(solid.residual().T @ cube, rel=1e-9, abs=1e-4)


def test_slope_of_the_modulus():
    law = law_of()
    for V_f in (0.6, 0.696, 0.703, 0.8, 0.99, 0.9985, 1.001, 1.2):
        (up, _), (down, _) = (
            solid_kernels.transverse_modulus(V_f + e, law[3], law[4], *law[1:3]) for e in (1e-7, -1e-7)
        )
        slope = solid_kernels.transverse_modulus(V_f, law[3], law[4], *law[1:3])[1]
        assert slope == pytest.approx((up - down) / 2e-7, rel=1e-5, abs=1.0)


def test_viscous_stress_damps_the_highest_mode_as_asked():
    """eta of the kernel on a row of bricks of height L: c / c_critical = eta / (L sqrt(E rho)) = xi."""
    P, rest = np.empty((3, 3)), np.empty((3, 3))
    law, L, density, xi, rate = law_of(), 1e-4, 1008.0, 0.1, 1e4
    solid_kernels.piola(np.eye(3), law, 0.0, 0.0, 0.0, 0.0, 0.0, rest)
    loss = solid_kernels.piola(np.eye(3), law, 0.0, -rate * 1e-9, 1e9, 0.0, xi * np.sqrt(density) * L, P)[2]
    E_2 = solid_kernels.transverse_modulus(law[3], law[3], law[4], *law[1:3])[0]
    assert (P - rest)[2, 2] == pytest.approx(xi * L * np.sqrt(E_2 * density) * rate, rel=1e-9)
    assert loss == pytest.approx((P - rest)[2, 2] * rate, rel=1e-9)


# the brick


def skewed(seed=2):
    """One brick of a yarn tip's proportions, skewed."""
    random = np.random.default_rng(seed)
    return 0.5 * CORNERS * [1.3e-4, 1.2e-4, 3e-5] + 4e-6 * random.normal(size=(8, 3))


def one_brick(corners):
    """Geometry and control of a lone brick, its nodes numbered as in the grid of a yarn."""
    bricks = Bricks.of(corners[None])
    return bricks, bricks.control((7e5, 4e7, 4e7), 1e6)


ORDER = [0, 4, 3, 7, 1, 5, 2, 6]  # corners of a brick as nodes of a 2 x 2 x 2 grid, k fastest


def brick_forces(x, bricks, control, law):
    """material, force (8, 3) by corner, and sums."""
    material, force, sums = np.zeros((8, 3)), np.zeros((8, 3)), np.zeros(solid_kernels.SUMS)
    solid_kernels.solid_forces(
        (0, 1, 1, 1), x[ORDER], (bricks.gradient, bricks.volume, bricks.twist, control, np.zeros((1, 2))), law, 0.0,
        np.ones(4, bool), np.zeros((1, 2)), np.zeros(1, bool), material, force, sums,
    )  # fmt: skip
    back = np.argsort(ORDER)
    return material[back], force[back], sums


def plain_hourglass(x, bricks, control):
    """Energy of the hourglass control from its definition."""
    f = x.T @ bricks.gradient[0]
    q = PATTERNS @ x - bricks.twist[0] @ f.T
    return 0.5 * np.sum(control[0] * (q @ f) ** 2)


def test_mean_gradients_reproduce_linear_fields_and_volumes():
    corners = skewed()
    bricks, _ = one_brick(corners)
    frame = corners.T @ bricks.gradient[0]
    assert frame.T @ frame == pytest.approx(np.eye(3), abs=1e-12)  # F = 1 gives the frame itself
    assert bricks.gradient[0].sum(axis=0) == pytest.approx(0, abs=1e-9)
    hull = pytest.importorskip("scipy.spatial").ConvexHull(0.5 * CORNERS * [1, 2, 3])
    assert Bricks.of((0.5 * CORNERS * [1, 2, 3])[None]).volume[0] == pytest.approx(hull.volume, rel=1e-12)


def test_brick_forces_equal_their_plain_twins():
    corners = skewed()
    bricks, control = one_brick(corners)
    x = corners @ rotation([1, 2, 3], 0.7).T + 3e-6 * np.random.default_rng(3).normal(size=(8, 3))
    material, force, sums = brick_forces(x, bricks, control, law_of())
    P = plain_piola(x.T @ bricks.gradient[0], law_of())
    assert material == pytest.approx(bricks.volume[0] * bricks.gradient[0] @ P.T, rel=1e-8, abs=1e-9)
    assert sums[solid_kernels.HOURGLASS] == pytest.approx(plain_hourglass(x, bricks, control), rel=1e-9)
    slope = np.empty((8, 3))
    for a in range(8):
        for c in range(3):
            step = np.zeros((8, 3))
            step[a, c] = 1e-9
            slope[a, c] = plain_hourglass(x + step, bricks, control) - plain_hourglass(x - step, bricks, control)
    assert force == pytest.approx(slope / 2e-9, rel=1e-5, abs=1e-7 * np.abs(force).max())


def test_brick_gives_no_momentum_and_no_moment():
    corners = skewed()
    bricks, control = one_brick(corners)
    x = corners + 5e-6 * np.random.default_rng(4).normal(size=(8, 3))
    for part in brick_forces(x, bricks, control, law_of())[:2]:
        scale = np.abs(part).max()
        assert part.sum(axis=0) == pytest.approx(0, abs=1e-12 * scale)
        assert np.cross(x, part).sum(axis=0) == pytest.approx(0, abs=1e-12 * scale * 1e-4)


def test_hourglass_control_is_blind_to_linear_motion():
    corners = skewed()
    bricks, control = one_brick(corners)
    x = corners @ np.array([[1.1, 0.3, 0.0], [0.1, 0.8, 0.2], [0.0, -0.4, 0.9]]).T + [1e-3, 0, 2e-3]
    _, force, sums = brick_forces(x, bricks, control, law_of())
    assert np.abs(force).max() < 1e-12
    assert sums[solid_kernels.HOURGLASS] < 1e-25


@pytest.mark.parametrize("mode", range(4))
@pytest.mark.parametrize("direction", range(3))
def test_hourglass_control_has_the_energy_of_the_full_rule(mode, direction):
    """A box in one hourglass mode: the energy of sigma = M epsilon without Poisson's ratio at 2 x 2 x 2 points."""
    box, moduli, shear, size = np.array([1.3e-4, 1.2e-4, 4e-5]), (7e5, 4e7, 4e7), 1e6, 1e-9
    bricks, control = one_brick(0.5 * CORNERS * box)
    x = 0.5 * CORNERS * box
    x[:, direction] += size * PATTERNS[mode]
    points = CORNERS / np.sqrt(3)
    energy = 0.0
    for point in points:
        others = [
            np.prod(np.delete([1 + CORNERS[:, c] * point[c] for c in range(3)], i, axis=0), axis=0) for i in range(3)
        ]
        slopes = np.stack([CORNERS[:, i] * others[i] / 8 * 2 / box[i] for i in range(3)], axis=1)
        along = size * PATTERNS[mode] @ slopes
        stiff = [moduli[direction] if c == direction else shear for c in range(3)]
        energy += 0.5 * np.sum(stiff * along**2) * box.prod() / 8
    assert brick_forces(x, bricks, control, law_of())[2][solid_kernels.HOURGLASS] == pytest.approx(energy, rel=1e-3)


def test_bricks_of_a_patch_are_in_equilibrium_under_uniform_stress(mesh):
    """The patch test in its local form: what a uniform stress does about an inner node sums to nothing."""
    grid = patch.build(FABRIC, (2, 2), size=(2, 2, 2)).grids[0]
    points = patch.build(FABRIC, (2, 2), size=(2, 2, 2)).points
    corners = _corners(grid)
    bricks = Bricks.of(points[corners])
    frame = np.einsum("mac,mai->mci", points[corners], bricks.gradient)  # columns e1, e2, e3
    pull = bricks.volume[:, None, None] * np.einsum("mai,mci->mac", bricks.gradient, frame)
    total = np.zeros_like(points)
    np.add.at(total, corners, pull)
    inner = grid[1:-1, 1:-1, 1:-1].ravel()
    assert np.abs(total[inner]).max() < 1e-12 * np.abs(pull).max()


# fibres


def test_fibre_law_equals_that_of_the_quasi_static_crossover_and_stores_its_work():
    bars = pytest.importorskip("unitcell3d.material.fibre_kernels")
    for e in (-0.02, -1e-9, 2e-5, 7e-5, 1e-4, 0.02):
        value, slope, _ = fibre_kernels.fibre_law(e, 1e-3, 1e-4)
        assert (value, slope) == pytest.approx(bars.fibre_law(e, 1e-3, 1e-4), rel=1e-12)
        up, down = (fibre_kernels.fibre_law(e + s, 1e-3, 1e-4)[2] for s in (1e-8, -1e-8))
        assert value == pytest.approx((up - down) / 2e-8, rel=1e-4, abs=1e-8)


def test_a_bar_fails_at_its_strain_and_its_energy_is_kept():
    x = np.array([[0, 0, 0], [1.0301e-3, 0, 0]])
    alive, force, sums = np.ones(1, bool), np.zeros((2, 3)), np.zeros(solid_kernels.SUMS)
    fibre_kernels.bar_forces(
        0, 1, 1, x, np.zeros((2, 3)), np.array([1e-3]), np.array([100.0]), np.array([1e-3, 1e-4, 0, 0.03]), 0.0, alive,
        force, sums,
    )  # fmt: skip
    assert not alive[0]
    assert not force.any()
    assert sums[solid_kernels.FAILED] == pytest.approx(0.5 * 100 * 0.0301**2 * 1e-3, rel=1e-5)


# contact


def test_contact_pressure_equals_that_of_the_quasi_static_crossover():
    theirs = pytest.importorskip("unitcell3d.contact.surface_contact_kernels")
    for depth in (1e-8, 4e-7, 5e-7, 3e-6):
        p, _, _ = yarn_contact_kernels.pressure(depth, 1e14, 5e-7)
        assert p == pytest.approx(theirs.pressure(-depth, 1e14, 5e-7)[0], rel=1e-12)
        up, down = (yarn_contact_kernels.pressure(depth + s, 1e14, 5e-7)[1] for s in (1e-11, -1e-11))
        assert p == pytest.approx((up - down) / 2e-11, rel=1e-4)


def find_closest_points(const, state, x):
    yarn_contact_kernels.find_closest_points(
        x, const.crossing_node, const.crossing_start, const.warp_over, const.cp_bounds, const.crossing_shape,
        state.closest_point,
    )  # fmt: skip


def contact_of(const, state, x, settle=True):
    """Contact forces and energy at given places."""
    if settle:
        find_closest_points(const, state, x)
    force, out, rest = np.zeros_like(x), np.zeros_like(state.contact_energy), np.zeros_like(state.wait_steps)
    yarn_contact_kernels.crossings(
        const.crossing_order, const.colour_start, (x, np.zeros_like(x), const.inverse_mass), state.brick_failed,
        (const.crossing_node, const.crossing_brick, const.crossing_start, const.warp_over, const.cp_bounds),
        const.crossing_shape, const.contact_penalty,
        (const.contact_area, const.contact_damping, state.closest_point.copy(), rest), (0.0, 0.0), force, out,
    )  # fmt: skip
    return force, out[:, 0].sum()


def pressed(mesh, shift=3e-6):
    """Constants, state and places of the patch with all warps shifted into the wefts on one side."""
    const, state = SolidPatch(mesh, FABRIC).ready(1.0)
    x = mesh.points.copy()
    x[: mesh.grids[mesh.families.index(1)].flat[0], 2] -= shift
    return const, state, x


def slaves(const, state, x):
    """Gap, share and area of every node of every crossing at converged feet, one at a time."""
    find_closest_points(const, state, x)
    cell, ny, nz = const.crossing_shape[0], const.crossing_shape[3], const.crossing_shape[4]
    nodes, weights, S = np.empty(16, np.int64), np.empty(16), np.empty((3, 3))
    for c, way in np.ndindex(len(const.warp_over), 2):
        faces, side = ((0, nz), -1.0) if const.warp_over[c] else ((nz, 0), 1.0)
        for i, j in np.ndindex(cell + 1, ny + 1):
            s = i * (ny + 1) + j
            xi, (low, high) = state.closest_point[c, way, s], const.cp_bounds[c, 1 - way]
            node = (
                const.crossing_node[c, way]
                + ((const.crossing_start[c, way] + i) * (ny + 1) + j) * (nz + 1)
                + faces[way]
            )
            first = const.crossing_node[c, 1 - way]
            yarn_contact_kernels.surface_point(
                x, first, const.crossing_shape[2 - way], ny, nz, faces[1 - way], *xi, nodes, weights, S
            )
            normal = side * np.cross(S[1], S[2])
            share = yarn_contact_kernels.side_weight(xi[1], ny)[0] if low < xi[0] < high else 0.0
            yield (x[node] - S[0]) @ normal / np.linalg.norm(normal), share, const.contact_area[c, way, s]


def test_contact_forces_are_the_slope_of_their_energy(mesh):
    """With the shares as they are: what a node loses of its share as it slides off a side is not followed."""
    const, state, x = pressed(mesh)
    force, stored = contact_of(const, state, x)
    held = [share * area for _, share, area in slaves(const, state, x)]

    def energy(x):
        gaps = (gap for gap, _, _ in slaves(const, state, x))
        return sum(a * yarn_contact_kernels.pressure(-g, 5e13, 5e-7)[1] for g, a in zip(gaps, held) if g < 0)

    assert stored == pytest.approx(energy(x), rel=1e-9)
    way = np.random.default_rng(5).normal(size=x.shape)
    assert np.sum(force * way) == pytest.approx((energy(x + 1e-10 * way) - energy(x - 1e-10 * way)) / 2e-10, rel=1e-5)


def test_contact_makes_no_momentum_and_no_moment(mesh):
    const, state, x = pressed(mesh)
    force, _ = contact_of(const, state, x)
    scale = np.abs(force).sum()
    assert scale > 1.0
    assert force.sum(axis=0) == pytest.approx(0, abs=1e-12 * scale)
    assert np.cross(x, force).sum(axis=0) == pytest.approx(0, abs=1e-9 * scale * 1e-3)


def test_contact_turns_with_the_weave(mesh):
    const, state, x = pressed(mesh)
    turn = rotation([1, 2, 0.5], 0.8)
    assert contact_of(const, state, x @ turn.T)[0] == pytest.approx(contact_of(const, state, x)[0] @ turn.T, abs=1e-6)


def plain_surface(points, xi):
    """Catmull-Rom surface through a grid (p, q, 3), straight on beyond its ends."""

    def line(values, t):
        padded = np.concatenate([[2 * values[0] - values[1]], values, [2 * values[-1] - values[-2]]])
        i = int(np.clip(np.floor(t), 0, len(values) - 2))
        t = t - i
        a, b, c, d = padded[i : i + 4]
        return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)

    return line(np.array([line(row, xi[1]) for row in points]), xi[0])


def test_surface_equals_its_plain_twin(mesh):
    grid = mesh.grids[1]
    nx, ny, nz = (n - 1 for n in grid.shape)
    nodes, weights, S = np.empty(16, np.int64), np.empty(16), np.empty((3, 3))
    for xi in ((0.3, 0.2), (5.7, 1.5), (nx - 0.1, ny + 0.4), (7.0, -0.3)):
        yarn_contact_kernels.surface_point(mesh.points, grid[0, 0, 0], nx, ny, nz, nz, *xi, nodes, weights, S)
        twin = plain_surface(mesh.points[grid[:, :, -1]], xi)
        assert S[0] == pytest.approx(twin, abs=1e-15)
        assert weights @ mesh.points[nodes] == pytest.approx(twin, abs=1e-15)
        for way, step in enumerate(np.eye(2) * 1e-5):
            ahead, behind = (plain_surface(mesh.points[grid[:, :, -1]], xi + s * step) for s in (1, -1))
            assert S[1 + way] == pytest.approx((ahead - behind) / 2e-5, abs=1e-9)


def test_a_clear_contact_rests_no_longer_than_it_may(mesh):
    """With and without rests the run is the same but for the feet of clear nodes, which are found again."""
    marched = []
    for reach in (1.0, 1e6):  # m: so far that nothing ever rests
        march = struck(mesh, end_time=1e-6, threads=1)
        pace = march._set_time_step
        march._set_time_step = lambda left, pace=pace, march=march, reach=reach: (pace(left), _widen(march, reach))[0]
        marched.append(march.run())
    assert marched[0].state.x == pytest.approx(marched[1].state.x, abs=1e-10)
    assert marched[1].state.wait_steps.max() == 0


def _widen(march, reach):
    march.state.step_sizes[1] *= reach


# the whole


def test_a_turned_patch_is_free_of_stress(mesh):
    const, state = SolidPatch(mesh, FABRIC).ready(1.0)
    x = mesh.points @ rotation([0.3, 1, 0.2], 1.0).T + [1e-3, 0, 0]
    at_rest = np.abs(forces_of(const, state, mesh.points)).max()  # what the rest overlap of coarse facets leaves
    assert np.abs(forces_of(const, state, x)).max() < 1e-6 + 1.001 * at_rest


def test_mass_is_that_of_the_yarns(mesh):
    weave = FABRIC.weave
    length = [mesh.count[1 - k] * weave.S0[k] for k in (0, 1)]
    whole = sum(mesh.count[k] * weave.yarns[k].linear_density * length[k] for k in (0, 1))
    assert SolidPatch(mesh, FABRIC).constants().mass.sum() == pytest.approx(whole, rel=2e-3)  # chords of the arches


def test_momentum_of_a_free_patch_and_its_projectile_is_kept(mesh):
    march = struck(mesh, clamped=False, threads=1).run()
    fabric = march.const.mass @ march.state.v
    shot = march.const.projectile_mass * march.state.projectile_velocity
    assert np.abs(fabric[2]) > 1e-6
    assert fabric + shot == pytest.approx([0, 0, march.const.projectile_mass * 60.0], abs=1e-15)


def test_energy_balances_and_better_with_shorter_steps(mesh):
    off = []
    for cfl in (0.8, 0.4):
        march = struck(mesh, end_time=4e-6, threads=1, numerics={"cfl": cfl}).run()
        taken = march.strike_energy - march.sample("kinetic_projectile")[-1]
        assert march.sample("hourglass")[-1] < 0.05 * taken
        off.append(np.abs(march.sample("error")).max() / taken)
    assert off[0] < 0.01
    assert off[1] < 0.9 * off[0]


def test_steps_are_stable_where_the_bound_says_so(mesh):
    """Steps of the bound (2 / w of the row sums) pass, of 2.5 times are lost: it is safe, and near."""
    struck(mesh, threads=1, numerics={"cfl": 1.0}).run()
    march = struck(mesh, threads=1)
    pace = march._set_time_step

    def hasty(left):
        steps = max(int(pace(left) * 0.8 / 2.5), 1)
        march.state.step_sizes[0] = left / steps
        return steps

    march._set_time_step = hasty
    with pytest.raises(UnstableError, match=r"node \d+ of w|inverted|balance"):
        march.run()


def test_an_overstretched_patch_tears():
    """Fast enough to break yarns: bars fail, bricks tear, and the balance holds.

    Nodes of torn yarns get under a neighbour's face from the side; pushed out, they make a third of all the energy.
    """
    mesh = patch.build(FABRIC, (6, 6), size=SIZE)
    march = SolidSolver(SolidPatch(mesh, FABRIC, Projectile(radius=1.2e-3)), 150.0, 9.6e-6, threads=1).run()
    assert march.sample("failed_bars")[-1] > 0
    assert march.state.brick_failed.any()
    taken = march.strike_energy - march.sample("kinetic_projectile")[-1]
    assert np.abs(march.sample("error")).max() < 0.02 * taken


def test_the_loose_end_of_a_cut_yarn_may_fold_up():
    """Where yarns tear as fast as here, the ends fold until a brick is inverted: it is gone before."""
    mesh = patch.build(FABRIC, (4, 4), size=(3, 3, 1))
    march = SolidSolver(SolidPatch(mesh, FABRIC, Projectile(radius=1.2e-3)), 500.0, 6e-6, threads=1).run()
    assert np.isfinite(march.state.x).all()
    assert np.abs(march.sample("error")).max() < 1e-3 * march.strike_energy


def test_a_brick_is_folded_by_its_length_or_its_volume():
    rng = np.random.default_rng(4)
    for _ in range(100):
        f = rng.normal(size=(3, 3)) * [rng.choice([0.05, 1.0]), 1.0, 1.0]
        short, inverted = np.linalg.norm(f[:, 0]) < solid_kernels.FOLDED, np.linalg.det(f) < 0
        assert solid_kernels.brick_folded(f) == (short or inverted)


def test_only_a_cut_yarn_folds(mesh):
    """A whole yarn is taut: where it turns inside out the run is unstable, and hides nothing."""
    const, state = SolidPatch(mesh, FABRIC, failure=False).ready(60.0)
    sheet = mesh.grids[0][2].ravel()
    x = state.x.copy()
    x[sheet] += 2.5 * (x[mesh.grids[0][0].ravel()] - x[sheet])  # beyond the end of the yarn
    forces_of(const, state, x)
    assert not state.brick_failed.any()
    state.bar_intact[-1 + const.first_bar[1]] = False  # at the other end of the same yarn
    forces_of(const, state, x)
    assert state.brick_failed[: 4 * SIZE[1] * SIZE[2]].any()
    assert not state.brick_failed[4 * SIZE[1] * SIZE[2] :].any()


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda mesh: SolidPatch(mesh, catalogue.load("S-728")), "solid|meshed"),
        (lambda mesh: SolidPatch(crossover.build(FABRIC, size="coarse"), FABRIC), "whole"),
        (lambda mesh: PatchNumerics(cfl=2), "at most 1"),
        (lambda mesh: PatchNumerics(penalty=-1), "above 0"),
        (lambda mesh: SolidSolver(SolidPatch(mesh, FABRIC), 0, 1e-6), "above 0"),
    ],
)
def test_bad_input_is_reported(mesh, make, told):
    with pytest.raises(InputError, match=told):
        make(mesh)


# against the quasi-static crossover


def pull(solid_patch, d, time=60e-6):
    """Ends of a lone crossover drawn apart by d [m] each, damped to rest; (T1, T2, F_c) [N].

    The ends obey the weave's two-fold axis: axial and vertical motion odd through the thickness, that across even.
    """
    const, state = solid_patch.ready(0.0)
    state.projectile_position[2] = -1.0
    mass, dt, t, step = const.mass[:, None], 0.0, 0.0, 0
    grids = solid_patch.mesh.grids
    while t < time:
        if step % 50 == 0:
            dt = 1.4 / solid_patch.frequency(const, state)[0]
        solid_step_kernels.forces(state, const, dt)
        state.v[:] -= dt * (state.f_material + state.f_other) / mass
        state.v[:] *= 1 - 2e5 * dt
        drive = np.pi / time * np.sin(2 * np.pi * t / time) if t < time / 2 else 0.0
        for axial, grid in enumerate(grids):
            for face, sign in ((grid[-1], 1.0), (grid[0], -1.0)):
                v, flip = state.v[face], state.v[face][:, ::-1]
                held = 0.5 * (v - flip)
                held[..., 1 - axial] = 0.5 * (v + flip)[..., 1 - axial]
                held[..., axial] += sign * d[axial] * drive
                state.v[face] = held
        state.x[:] += dt * state.v
        t, step = t + dt, step + 1
    T = [(state.f_material + state.f_other)[grid[-1]][..., axial].sum() for axial, grid in enumerate(grids)]
    contact = contact_of(const, state, state.x)[0]
    return *T, -contact[grids[0]][..., 2].sum()


@pytest.mark.slow(90)
@pytest.mark.xfail(
    reason="missed since the 3D crossover's contact stands at Gauss points: 0.2 to 0.5 % in T and 1.0 to 1.1 % in F_c; "
    "the patch's contact stands at the nodes, with which the crossover's agreed to 0.3 %",
    strict=True,
)
@pytest.mark.parametrize("d", [(2e-5, 2e-5), (2.5e-5, 0.0)])
def test_a_crossover_pulled_slowly_is_the_quasi_static_one(d):
    """Same mesh, one point and control against eight points: within 0.5 % in tension and contact force."""
    pytest.importorskip("dolfinx")
    from unitcell3d.cases import biaxial_and_platens
    from unitcell3d.model.crossover import Numerics

    size = (5, 5, 2)
    soft = Numerics(penalty=1e14)  # that of the patch: an explicit step allows none as hard as the default here
    theirs = biaxial_and_platens.biaxial(
        crossover.build(FABRIC, size=size), FABRIC, d, max_displacement=max(d), numerics=soft
    )
    found = pull(SolidPatch(crossover.build(FABRIC, domain="whole", size=size), FABRIC, failure=False), d)
    assert found == pytest.approx((theirs.T1[-1], theirs.T2[-1], theirs.F_c[-1]), rel=5e-3)
