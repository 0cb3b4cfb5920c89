"""Friction between plies: Coulomb's limit, what yields below it, its work, momentum, energy."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import collide, grid, momenta
from numpy.testing import assert_allclose
from test_ply_contact import Flat, tear

from shellfabric.plies import friction
from shellfabric.plies.frame_kernels import BEHIND
from shellfabric.plies.model import Pack, PlyContact

MU = 0.3


class Sliding(Flat):
    """Two flat plies pressed together by a hundredth of their thickness; the front one is moved along its plane.

    The rear ply is the larger, so that no point leaves it.
    """

    def __init__(self, ply, mu, **numbers):
        super().__init__(replace(ply, symmetry="whole"), friction=mu, **numbers)
        self.place(0.01)

    def move(self, v_x, v_y, steps=1):
        """(2, 3) [N] on the front and on the rear ply after steps at a velocity [m/s]."""
        front = self.states[0]
        for _ in range(steps):
            for u, v, speed in zip(front.u, front.v, (v_x, v_y)):
                grid(self.consts[0], u)[:] += self.consts[0].dt * speed
                grid(self.consts[0], v)[:] = speed
            forces = self.press()
        return np.array([force.sum(axis=(0, 1)) for force in forces])

    @property
    def work(self):
        return self.contact.pressure.friction_work.sum()


@pytest.mark.parametrize("points", [1, 2])
@pytest.mark.parametrize("alone", [True, False])
def test_sliding_plies_take_the_friction_coefficient_times_the_normal_force(ply, points, alone):
    """From the first step on: nothing has to be wound up."""
    pair = Sliding(ply, MU, points=points)
    pair = pair.alone() if alone else pair
    v = np.array([30.0, -40.0])
    on_front, on_rear = pair.move(*v)
    assert_allclose(on_front[:2], -MU * abs(on_front[2]) * v / 50, rtol=1e-6)
    assert_allclose(on_front, -on_rear, atol=1e-12 * abs(on_front[2]))
    before = pair.work
    pair.move(*v, 4)
    assert pair.work - before == pytest.approx(
        MU * abs(on_front[2]) * 50 * 4 * pair.consts[0].dt, rel=0.01
    )


def test_points_yield_slowly_below_the_limit(ply):
    """As dampers, of which nothing is left when the motion ends: by a hundredth of the limit, at a hundredth of the
    velocity at which it is reached."""
    pair = Sliding(ply, MU)
    normal = abs(pair.move(0.0, 0.0)[0, 2])
    const = pair.consts[0]
    damping = pair.contact.pressure.stick_damping[0] * 4 * const.ni * const.nj
    limit = MU * normal / damping
    # [m/s], at the pressure of a hundredth of the thickness of solid fibre
    assert 1.0 < limit < 20.0
    assert pair.move(0.01 * limit, 0.0)[0, 0] == pytest.approx(-0.01 * MU * normal, rel=1e-3)
    assert abs(pair.move(0.0, 0.0)[0, 0]) < 1e-9 * normal


@pytest.mark.parametrize("points, spread", [(1, 0.0), (2, (1 + 1 / 64) ** 2 - (1 - 1 / 128) ** 2)])
def test_the_patch_of_a_graded_pack_is_rubbed_in_proportion_to_its_mass(ply, points, spread):
    """Across zones: friction accelerates all nodes of a flat ply alike, but for what the spline's points next to a
    border give to the node behind it, of two a side 1/32 of theirs: 1/64 too much on the side of the short elements,
    and 1/128 too little on the other, where they are twice as long, in either direction."""
    zones = (7, 1), (np.inf, 2)
    graded = replace(ply, boundary="free", symmetry="whole", opening=(0.034, 0.034), grading=zones)
    pair = Sliding(graded, MU, points=points)
    pair.move(15.0, 0.0, 20)
    inner = (slice(2, -2), slice(2, pair.consts[0].nj - 1))
    mass = grid(pair.consts[0], pair.states[0].mass)[inner]
    force = pair.force(0, BEHIND)[inner][..., 0]
    assert mass.max() > 3.9 * mass.min()
    assert abs(np.ptp(force / mass) / abs(np.median(force / mass)) - spread) < (
        2e-2 if points == 1 else 5e-4
    )


def test_torn_fabric_is_rubbed_too(ply):
    pair = Sliding(ply, MU)
    tear(pair, 1, slice(3, 6))
    on_front, _ = pair.move(30.0, 0.0)
    assert on_front[0] == pytest.approx(-MU * abs(on_front[2]), rel=1e-6)


def rubbing(ply, mu, **numbers):
    """A free ply before another, at which it can fly obliquely."""
    free = replace(ply, boundary="free", symmetry="whole")
    return Pack.stacked(
        free, 2, stacking="alternating", gap=20e-6, contact=PlyContact(**numbers), friction=mu
    )


FLIGHT = 15.0, 5.0, 20.0  # [m/s]


@pytest.mark.parametrize("mu", [0.1, 0.5])
@pytest.mark.parametrize("points", [1, 2])
def test_rubbing_plies_keep_momentum_and_make_no_energy(ply, mu, points):
    smooth, _, _ = collide(rubbing(ply, 0.0, points=points), FLIGHT, 200)
    solver, before, energy = collide(rubbing(ply, mu, points=points), FLIGHT, 200)
    sums = momenta(solver)
    assert_allclose(sums.sum(axis=0), before, atol=1e-12 * abs(before).max())
    carried = smooth.states[1].mass @ smooth.states[1].v[0]
    assert sums[1, 0] > carried + 0.05 * before[0]  # the rear ply is taken along
    assert abs(solver.sample("error")[-1]) < 1e-6 * energy
    assert smooth.sample("ply_friction")[-1] == 0.0
    assert solver.sample("ply_friction")[-1] > 1e-3 * energy


def test_stick_is_stable_at_any_coefficient(ply):
    """All points stick, so that all dampers of friction act at once: energy is lost, none is made.

    At half the step, as time integration alone is off by 0.7e-6 of the energy at the whole one, without friction.
    """
    solver, _, energy = collide(rubbing(ply, 1e3, courant=0.225), FLIGHT, 1200)
    assert abs(solver.sample("error")[-1]) < 1e-6 * energy
    assert solver.sample("ply_friction")[-1] > 0.0
    kinetic = solver.sample("kinetic_fabric")
    assert kinetic[-1] < kinetic[0]


def test_the_damping_leaves_the_plies_their_time_step():
    for cfl in (0.9, 0.45):
        assert 2 * friction.stick_damping(cfl, 2.0, 3.0) * 3 / 2 == pytest.approx(1 - cfl**2)
