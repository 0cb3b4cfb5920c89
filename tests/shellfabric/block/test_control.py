"""The hourglass control of a block: its energy, its forces, its flow, and corners that cannot fold."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fabrics import backings
from fabrics.materials import Isotropic
from shellfabric.block import block_kernels, brick_kernels, control_kernels, dent
from shellfabric.block.block import Backing
from shellfabric.block.hex8 import CORNERS, PATTERNS, Bricks

CLAY = backings.load("Roma Plastilina No. 1")
ELASTIC = Isotropic(CLAY.density, CLAY.modulus, 0.3)
BOX = np.array([1.3e-3, 1.2e-3, 0.7e-3])  # [m]


def springs(x, rest, material, factor=1.0, shape=None):
    """(W [J], hourglass forces (8, 3) [N]) of a brick at x, at rest at `rest`."""
    brick = Bricks.of(rest[None])
    F, inverse, D = np.empty((3, 3, 3))
    q, forces = np.empty((4, 3)), np.zeros((8, 3))
    brick_kernels.mean_deformation(x, brick.gradient[0], F)
    block_kernels.inverse(F, inverse)
    shape = brick.twist[0] if shape is None else shape
    weight = factor * brick.control_weights[0]
    moduli = (material.shear, material.modulus - material.shear)
    control_kernels.mode_offsets(F, x, shape, q)
    energy = control_kernels.control_energy(inverse, q, weight, moduli)
    D[:] = 0.0
    control_kernels.control_forces(inverse, q, shape, weight, moduli, D, forces)
    return energy, forces + brick.gradient[0] @ D.T


def corners(x, rest):
    """(U [J] of f G = 1 Pa, forces (8, 3) [N]) of the corners of a brick."""
    brick = Bricks.of(rest[None])
    F, inverse, D = np.empty((3, 3, 3))
    forces = np.zeros((8, 3))
    brick_kernels.mean_deformation(x, brick.gradient[0], F)
    swelling = np.log(block_kernels.inverse(F, inverse))
    D[:] = 0.0
    volume = brick.volume[0]
    energy = control_kernels.corner_forces(
        x, swelling, inverse, volume, volume / 8, np.empty((2, 3, 3)), D, forces
    )
    return energy, forces + brick.gradient[0] @ D.T


@pytest.mark.parametrize("stretches", [(1, 1, 1), (1.6, 1.3, 0.3), (0.7, 2.0, 0.9)])
@pytest.mark.parametrize("mode", range(4))
@pytest.mark.parametrize("direction", range(3))
def test_springs_have_the_energy_of_the_full_rule_at_any_stretch(stretches, mode, direction):
    """A stretched box in one mode: sigma = M epsilon without Poisson's ratio, slopes along the edges as they are."""
    rest = 0.5 * CORNERS * BOX
    long = BOX * stretches
    size = 1e-8
    x = 0.5 * CORNERS * long
    x[:, direction] += size * PATTERNS[mode]
    stiff = np.where(np.arange(3) == direction, ELASTIC.modulus, ELASTIC.shear)
    energy = 0.0
    for point in CORNERS / np.sqrt(3):
        factors = 1 + CORNERS * point
        slopes = np.stack(
            [CORNERS[:, i] * np.delete(factors, i, axis=1).prod(axis=1) for i in range(3)], axis=1
        )
        strains = size * PATTERNS[mode] @ slopes / (4 * long)
        energy += 0.5 * np.sum(stiff * strains**2) * BOX.prod() / 8
    assert springs(x, rest, ELASTIC)[0] == pytest.approx(energy, rel=1e-6)


def bent_brick(seed=3):
    """(places, places at rest) of a brick that is far from its shape at rest, in no symmetry."""
    random = np.random.default_rng(seed)
    rest = 0.5 * CORNERS * BOX
    F = np.diag([1.4, 1.1, 0.5]) + random.uniform(-0.2, 0.2, (3, 3))
    return (rest + 0.08 * BOX * random.uniform(-1, 1, (8, 3))) @ F.T, rest


@pytest.mark.parametrize("part", [lambda x, rest: springs(x, rest, ELASTIC), corners])
def test_forces_are_the_slopes_of_the_energy_which_is_blind_to_rotation(part):
    x, rest = bent_brick()
    energy, forces = part(x, rest)
    step = 1e-9
    slopes = np.empty((8, 3))
    for at in np.ndindex(8, 3):
        move = np.zeros((8, 3))
        move[at] = step
        slopes[at] = (part(x + move, rest)[0] - part(x - move, rest)[0]) / (2 * step)
    assert energy > 0
    assert forces == pytest.approx(slopes, abs=1e-5 * abs(slopes).max())
    assert abs(forces.sum(axis=0)).max() < 1e-12 * abs(forces).max()
    turned = x @ Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix().T
    assert part(turned, rest)[0] == pytest.approx(energy, rel=1e-12)


def test_a_corner_inside_out_bears_a_finite_force_that_opens_it():
    """The energy goes on as a parabola below LEAST_SHARE: continuous, as is its slope."""
    rest = 0.5 * CORNERS * BOX
    found = []
    for share in (0.5, 0.0501, 0.0499, -0.5):
        x = rest.copy()
        # three edges meet at a corner; it moves along one of them
        x[4, 2] = x[0, 2] + share * BOX[2]
        found.append(corners(x, rest))
    energies = [energy for energy, _ in found]
    pushes = [forces[4, 2] for _, forces in found]
    assert np.all(np.diff(energies) > 0)
    assert np.all(np.diff(pushes) < 0)
    assert pushes[1] == pytest.approx(pushes[2], rel=0.02)


def test_a_corner_below_the_least_share_goes_on_along_the_tangent_and_the_curvature():
    """Two corners have the share of the edge that is shortened, six have 1, all over that of the mean."""
    rest = 0.5 * CORNERS * BOX
    x = rest.copy()
    x[4, 2] = x[0, 2] + 0.01 * BOX[2]
    brick = Bricks.of(rest[None])
    swelling = np.linalg.det(x.T @ brick.gradient[0])
    least = control_kernels.LEAST_SHARE
    step = 1e-4

    def energy(share):
        return 0.5 * np.log(share) ** 2

    def along_the_parabola(share):
        beside = energy(least + step), energy(least - step)
        slope = (beside[0] - beside[1]) / (2 * step)
        curvature = (beside[0] - 2 * energy(least) + beside[1]) / step**2
        off = share - least
        return energy(least) + slope * off + 0.5 * curvature * off**2

    assert 0.01 / swelling < 0.4 * least
    wanted = 2 * along_the_parabola(0.01 / swelling) + 6 * energy(1 / swelling)
    assert corners(x, rest)[0] == pytest.approx(BOX.prod() / 8 * wanted, rel=1e-5)


@pytest.mark.parametrize(
    ("stress", "flowed", "keep"), [(0.5e5, 0.0, 1.0), (0.5e5, 0.1, 1 / 1.2), (3e5, 0.1, 1 / 3)]
)
def test_hourglass_stress_relaxes_with_the_flow_and_stays_below_the_flow_stress(
    stress, flowed, keep
):
    """3 f G d(alpha) is a fifth of the flow stress of 1e5 Pa; a stress of three times that is cut to it."""
    assert control_kernels.kept_share(stress, 1e5, flowed, 2e5) == pytest.approx(keep, rel=1e-12)


def pushed(hourglass):
    """Clay whose middle node of the face is driven in fast, after 0.25 ms."""
    block = Backing(
        CLAY,
        size=(0.06, 0.06, 0.03),
        min_size=5e-3,
        refined_depth=0.02,
        growth=1.3,
        hourglass=hourglass,
    ).block(1e-6)
    face = block.nodes[:3, :3, 0]
    block.v[face, 2] = np.array([[90.0, 35, 5], [35, 20, 5], [5, 5, 0]])
    start = 0.5 * float(block.mass @ (block.v**2).sum(axis=1))
    for _ in range(250):
        block.advance()
    return block, start


def test_bricks_that_are_driven_in_do_not_fold_and_springs_stay_below_the_flow_stress():
    block, start = pushed(0.1)
    free, _ = pushed(0.0)
    assert dent.folding(free) > 1
    assert dent.folding(block) < 0.9
    told = block.energies()
    assert sum(told.values()) == pytest.approx(start, rel=5e-3)
    assert told["plastic"] > 0.2 * start
    stress = np.sqrt(6 * 0.1 * CLAY.shear * block.row.hourglass_energy / block.row.volume)
    # at most the rate of a wave across a brick
    rate = 90 / 5e-3
    highest = CLAY.yield_stress * (1 + rate / CLAY.reference_rate) ** CLAY.rate_exponent
    assert 0.3 * CLAY.yield_stress < stress.max() < 1.2 * highest


def test_elastic_springs_keep_their_shape():
    block = replace(pushed(0.1)[0].backing, material=ELASTIC).block(1e-6)
    at_rest = block.row.shape.copy()
    block.v[block.nodes[0, 0, 0], 2] = 1.0
    for _ in range(20):
        block.advance()
    assert block.row.hourglass_energy.max() > 0
    assert np.array_equal(block.row.shape, at_rest)
