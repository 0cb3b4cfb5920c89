"""The backing block: the law, the patch test, waves, contact, each in closed form or against a plain twin."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm, logm

from fabrics import backings
from fabrics.base.errors import InputError, UnstableError
from fabrics.materials import Isotropic, load
from shellfabric.block import block_kernels, brick_kernels
from shellfabric.block import contact_kernels as backing_contact_kernels
from shellfabric.block.block import Backing, graded
from shellfabric.block.hex8 import CORNERS, PATTERNS, Bricks
from shellfabric.block.state import BlockRow
from shellfabric.projectile.projectile import Projectile

BACKING = load("backing")
ELASTIC = Isotropic(BACKING.density, BACKING.modulus, BACKING.poisson)
SMALL = Backing(
    material=ELASTIC,
    size=(0.012, 0.012, 0.008),
    min_size=1e-3,
    refined_depth=4e-3,
    growth=1.3,
    hourglass=0.1,
)


def rotation(axis, angle):
    axis = np.asarray(axis) / np.linalg.norm(axis)
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return expm(angle * K)


def law_of(material):
    return replace(SMALL, material=material, viscosity=0.0).block(1e-9).row.law


def nodal(block, dt=0.0):
    """Internal forces (n, 3) [N] of the bricks at the places as they are, `dt` [s] after the last call."""
    block_kernels.forces(block.row, dt)
    total = np.zeros_like(block.x)
    np.add.at(total, block.bricks, block.row.own)
    return total


def plain_hencky(F, C, alpha, material):
    """P, C, alpha by matrix functions."""
    b = F @ C @ F.T
    e = 0.5 * np.real(logm(b))
    dev = e - np.trace(e) / 3 * np.eye(3)
    q = 2 * material.shear * np.sqrt(1.5) * np.linalg.norm(dev)
    if q > material.yield_stress + material.hardening * alpha:
        step = (q - material.yield_stress - material.hardening * alpha) / (
            3 * material.shear + material.hardening
        )
        alpha = alpha + step
        dev = dev * (1 - 3 * material.shear * step / q)
        G = np.linalg.inv(F)
        C = G @ expm(2 * (dev + np.trace(e) / 3 * np.eye(3))) @ G.T
    tau = material.bulk * np.trace(e) * np.eye(3) + 2 * material.shear * dev
    return tau @ np.linalg.inv(F).T, C, alpha


@pytest.mark.parametrize("material", [ELASTIC, BACKING, replace(BACKING, hardening=3e7)])
def test_law_equals_its_plain_twin(material):
    random = np.random.default_rng(1)
    P = np.empty((3, 3))
    for _ in range(10):
        C = np.eye(3)
        alpha = 0.0
        twin = C.copy(), alpha
        for _ in range(3):
            F = rotation(random.normal(size=3), 2.0) @ (
                np.eye(3) + 0.25 * random.uniform(-1, 1, (3, 3))
            )
            _, _, alpha = block_kernels.hencky(F, C, alpha, law_of(material), 0.0, 0.0, P)
            expected, *twin = plain_hencky(F, *twin, material)
            assert P == pytest.approx(expected, rel=1e-8, abs=1.0)
            assert alpha == pytest.approx(twin[1], abs=1e-12)
            assert C == pytest.approx(twin[0], abs=1e-9)


BOX = np.array([1.3e-4, 1.2e-4, 4e-5])  # [m]
MODULI = (7e5, 4e7, 4e7)  # [Pa]
SHEAR = 1e6  # [Pa]


@pytest.mark.parametrize("mode", range(4))
@pytest.mark.parametrize("direction", range(3))
def test_hourglass_control_has_the_energy_of_the_full_rule(mode, direction):
    """A box in one hourglass mode: the energy of sigma = M epsilon without Poisson's ratio at 2 x 2 x 2 points."""
    x = 0.5 * CORNERS * BOX
    size = 1e-9
    energy = 0.0
    f = np.empty((3, 3))
    bricks = Bricks.of(x[None])
    x[:, direction] += size * PATTERNS[mode]
    stiff = np.where(np.arange(3) == direction, MODULI[direction], SHEAR)
    for point in CORNERS / np.sqrt(3):
        factors = 1 + CORNERS * point
        slopes = np.stack(
            [CORNERS[:, i] * np.delete(factors, i, axis=1).prod(axis=1) for i in range(3)], axis=1
        )
        strains = size * PATTERNS[mode] @ slopes / (4 * BOX)
        energy += 0.5 * np.sum(stiff * strains**2) * BOX.prod() / 8
    brick_kernels.mean_deformation(x, bricks.gradient[0], f)
    scratch = (np.empty((4, 3)), np.empty((3, 3)), np.empty((8, 3)))
    control = bricks.control(MODULI, SHEAR)[0]
    assert brick_kernels.hourglass(f, x, bricks.twist[0], control, *scratch) == pytest.approx(
        energy, rel=1e-3
    )


def test_patch_test():
    """A uniform deformation of the graded block leaves no force on an inner node; P F^-1 is Hencky's."""
    block = SMALL.block(1e-9)
    F = np.eye(3) + np.array([[0.05, 0.1, 0], [0, -0.1, 0.03], [0.02, 0, 0.08]])
    block.x[:] = block.rest @ F.T
    total = nodal(block)
    inner = block.nodes[1:-1, 1:-1, 1:-1].ravel()
    assert abs(total[inner]).max() < 1e-10 * abs(block.row.own).max()
    assert block.row.hourglass_energy.max() < 1e-20
    P = plain_hencky(F, np.eye(3), 0.0, ELASTIC)[0]
    assert total.T @ block.rest == pytest.approx(P * block.row.volume.sum(), rel=1e-9)


def column(material, n=200, outer_boundary="fixed", h=1e-3, **changes):
    """A column of one brick's width, held sideways: uniaxial strain."""
    backing = Backing(
        material,
        size=(2 * h, 2 * h, n * h),
        min_size=h,
        refined_depth=n * h,
        growth=1.0,
        outer_boundary=outer_boundary,
        **changes,
    )
    block = backing.block(0.4 * h / material.wave_speed)
    block.row.free[:, :2] = 0.0
    bottom = block.nodes[:, :, -1].ravel()
    block.row.free[:, 2] = 1.0
    block.row.free[bottom, 2] = 0.0 if outer_boundary == "fixed" else 1.0
    kept = block.row.dashpot[bottom, 2].copy()
    block.row.dashpot[:] = 0.0
    block.row.dashpot[bottom, 2] = kept
    return block


@pytest.mark.parametrize("name", [None, *backings.list_names()])
def test_a_wave_runs_at_c_L_with_its_stress(name):
    """Face driven at v: sigma = rho c_L v behind a front at c_L t, c_L = ((K + 4 G / 3) / rho)^(1/2)."""
    given = backings.load(name) if name else ELASTIC
    material = Isotropic(given.density, given.modulus, given.poisson)
    block = column(material, 100, hourglass=0.0)
    v = 1e-2
    face = block.nodes[:, :, 0].ravel()
    block.row.free[face, 2] = 0.0
    block.v[face, 2] = v
    while block.time < 60e-3 / material.wave_speed:
        block.advance()
        block.x[face, 2] += block.dt * v
        block.v[face, 2] = v
    speed = block.v[block.nodes[0, 0], 2]
    front = np.interp(-0.5 * v, -speed, np.arange(len(speed)) * 1e-3)
    assert front == pytest.approx(given.wave_speed * block.time, rel=1e-2)
    strain = np.diff(block.x[block.nodes[0, 0], 2]) / 1e-3 - 1
    stress = -(material.bulk + 4 / 3 * material.shear) * strain[5:40].mean()
    assert stress == pytest.approx(material.density * given.wave_speed * v, rel=1e-2)


def test_absorbing_faces_take_a_wave_in_and_fixed_ones_throw_it_back():
    left = {}
    for far in ("fixed", "absorbing"):
        block = column(ELASTIC, 60, far)
        z = block.rest[:, 2]
        block.v[:, 2] = 0.05 * np.exp(-(((z - 0.03) / 0.005) ** 2))
        start = 0.5 * np.sum(block.mass * block.v[:, 2] ** 2)
        while block.time < 2.2 * 0.06 / ELASTIC.wave_speed:
            block.advance()
        energies = block.energies()
        left[far] = (energies["kinetic"] + energies["elastic"]) / start
        # the start stands half a step off
        assert sum(energies.values()) == pytest.approx(start, rel=4e-3)
    assert left["fixed"] > 0.6  # viscosity takes the rest
    assert left["absorbing"] < 0.05


@pytest.mark.parametrize(
    "material, viscosity, size, part",
    [(ELASTIC, 1.0, 0.05, "viscous"), (BACKING, 0.0, 0.4, "plastic")],
)
def test_what_bricks_take_is_the_work_of_their_forces(material, viscosity, size, part):
    """Bent and squeezed faster and faster in ten steps, by forces at their mean over each step."""
    block = replace(SMALL, material=material, viscosity=viscosity).block(1e-7)
    random = np.random.default_rng(4)
    bend = block.rest @ random.uniform(-1, 1, (3, 3)) + 50.0 * block.rest[:, [1, 2, 0]] ** 2
    before = nodal(block)
    work = 0.0
    for n in range(1, 11):
        step = bend * size * (n**2 - (n - 1) ** 2) / 100
        block.x += step
        after = nodal(block, 1e-6)
        work += 0.5 * ((before + after) * step).sum()
        before = after
    told = block.energies()
    assert told[part] > 0.1 * work
    assert sum(
        told[name] for name in ("elastic", "plastic", "hourglass", "viscous")
    ) == pytest.approx(work, rel=3e-3)


@pytest.mark.slow(15)
def test_hertz():
    """A rigid ball pressed slowly: F = 4/3 E* R^(1/2) d^(3/2) within 4 % at 7 bricks over the radius of the contact.

    The force comes from below as the mesh is refined (0.936 at 5 bricks, 0.963 at 7). Far faces take the waves in.
    """
    R = 0.02
    depth = 1e-4
    time = 2.5e-4
    backing = Backing(
        ELASTIC,
        size=(0.1, 0.1, 0.05),
        min_size=2e-4,
        refined_depth=2e-3,
        growth=1.45,
        outer_boundary="absorbing",
        contact_damping=0.3,
    )
    block = backing.block(0.9 * backing.longest_step)
    ball = Projectile(shape="sphere", radius=R)
    position = np.zeros(3)
    speed = np.zeros(3)
    found = []
    while block.time < 1.4 * time:
        share = min(block.time / time, 1)
        speed[2] = depth * np.pi / 2 / time * np.sin(np.pi * share) if share < 1 else 0.0
        found.append(-4 * block.strike(position, speed, ball)[2])
        block.advance()
        position[2] += block.dt * speed[2]
    hertz = 4 / 3 * ELASTIC.modulus / (1 - ELASTIC.poisson**2) * np.sqrt(R) * depth**1.5
    assert np.mean(found[-50:]) == pytest.approx(hertz, rel=0.05)
    assert np.std(found[-50:]) < 0.01 * hertz


def test_points_press_as_a_plate_and_give_what_they_take():
    """A plane of points pushed into the face: forces are penalty times depth, and sum to what the block gets."""
    block = replace(SMALL, outer_boundary="fixed").block(1e-7)
    side = np.linspace(0.2e-3, 5.8e-3, 24)
    places = np.stack([*np.meshgrid(side, side), np.full((24, 24), 2e-5)], axis=-1).reshape(-1, 3)
    still = np.zeros_like(places)
    stiffness = np.full(len(places), 1e4)
    forces = block.press(places, still, stiffness)
    assert forces == pytest.approx(np.tile([0, 0, -0.2], (len(places), 1)), abs=1e-12)
    # internal sign
    assert block.row.outer.sum(axis=0) == pytest.approx([0, 0, -0.2 * len(places)], rel=1e-12)
    assert block.energies()["contact"] == pytest.approx(0.5 * 1e4 * 4e-10 * len(places), rel=1e-12)
    # nothing within the thickness kept, nothing off the block
    away = block.press(places - [0, 0, 2e-5 + 1e-4], still, stiffness / 1e4, thickness=1e-4)
    assert abs(away).max() < 1e-9
    assert not block.press(places + np.eye(3)[0], still, stiffness).any()


def test_a_point_beside_a_facet_that_is_twisted_is_found_where_it_is():
    """Newton's steps from the middle of this facet, out of a shot, circle within it: the point is 3 mm beside it."""
    grid = np.array(
        [
            [[4.0, 4.0], [4.2, 6.5], [4.0, 8.0]],
            [[6.5, 4.0], [6.68, 6.629], [5.968, 7.526]],
            [[8.0, 3.9], [7.67, 5.822], [7.498, 7.344]],
        ]
    )
    x = np.zeros((3, 3, 2, 3))
    x[..., :2] = grid[:, :, None]
    x[..., 1, 2] = 1.0
    column = np.array([1, 1])
    place = np.zeros(2)
    nodes = np.zeros(4, np.int64)
    x = x.reshape(-1, 3)
    block = BlockRow.empty()._replace(nx=2, ny=2, nz=1, x=x, gone=np.zeros(4, bool))
    for point in ((4.523, 4.206), (5.074, 4.189), (4.964, 4.108)):
        column[:] = 1
        assert backing_contact_kernels.locate(np.array(point), block, column, place, nodes)
        w = np.zeros(4)
        backing_contact_kernels.weights(*place, w)
        assert tuple(column) == (0, 0)
        assert w @ x[nodes, :2] == pytest.approx(np.array(point), abs=1e-9)


def test_a_point_high_above_a_steep_facet_is_not_at_it():
    """On a slope of 84 degrees a point 20 mm above is 2 mm beside what the facet would be if it went on; a force at the
    place straight below, along the normal, would turn facet and point with nothing to pay for it."""
    block = SMALL.block(1e-7)
    fast = np.array([[0.0, 0.0, 1e6]])
    block.x[:, 2] += 10 * block.rest[:, 0]

    def push(above):
        point = np.array([[0.5e-3, 0.5e-3, 5e-3 - above]])
        block.press(point, fast, np.ones(1), thickness=3e-3)
        block.points.offset[:] = 0.0  # what came by the slope is no step
        return np.linalg.norm(block.press(point, fast, np.ones(1), thickness=3e-3))

    assert push(2e-3) == pytest.approx(3e-3 - 2e-3 * np.cos(np.arctan(10)), rel=1e-6)
    assert push(20e-3) == 0.0


def test_points_follow_a_face_that_moves_and_erodes():
    block = SMALL.block(1e-7)
    point = np.array([[0.4e-3, 0.4e-3, 1e-5]])
    still = 0 * point

    def push(at, velocity):
        return block.press(at, velocity, np.ones(1))

    assert push(point, still)[0, 2] < 0
    block.x[:, 0] -= 2.0e-3  # the block moves under the point: it lies over another column
    assert push(point, still)[0, 2] == pytest.approx(-1e-5, rel=1e-9)
    assert tuple(block.points.columns[0]) == (2, 0)
    block.gone.reshape(block.shape)[2, 0, :2] = True  # two bricks deep
    assert not push(point, still).any()
    deeper = point + np.array([0, 0, 2e-3])
    at_once = np.array([[0, 0, 2e-3 / block.dt]])
    assert push(deeper, at_once)[0, 2] == pytest.approx(-1e-5, rel=1e-6)


def test_a_brick_turned_inside_out_is_reported():
    block = SMALL.block(1e-6)
    block.x[block.nodes[0, 0, 0], 2] += 0.05
    block.x[block.nodes[1, 1, 0], 2] += 0.05
    with pytest.raises(UnstableError, match="inside out, at the block's brick"):
        block.advance()


def test_the_grid_grows_as_asked():
    places = graded(0.15, 1e-3, 8e-3, 1.25)
    steps = np.diff(places)
    assert (places[0], places[-1]) == pytest.approx((0, 0.15))
    assert steps[:8] == pytest.approx(1e-3)
    ratios = steps[8:] / steps[7:-1]
    assert ratios.max() <= 1.25 + 1e-9
    assert ratios == pytest.approx(ratios[0])
    assert np.prod(Backing().count) < 40_000


@pytest.mark.parametrize(
    "key, value",
    [
        ("outer_boundary", "soft"),
        ("size", (0.1, 0.1)),
        ("growth", 0.9),
        ("hourglass", -1),
        ("penalty", 0),
    ],
)
def test_bad_input_is_reported(key, value):
    with pytest.raises(InputError, match=key):
        Backing(**{key: value})
    with pytest.raises(InputError):
        Backing().block(1.0)
