"""Friction between plies: Coulomb's limit, stick, its work, momentum, energy."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import collide
from test_ply_contact import Flat

from shellfabric.plies import contact_simd_kernels as lanes
from shellfabric.plies import friction
from shellfabric.plies.model import Pack, PlyContact

MU = 0.3


class Sliding(Flat):
    """Two flat plies pressed together by a tenth of their thickness; the front one is moved along its plane.

    The rear ply is the larger, so that no point leaves it.
    """

    def __init__(self, ply, mu, **knobs):
        super().__init__(replace(ply, symmetry="whole"), friction=mu, **knobs)
        self.states[0].u[2][: self.nodes] = 0.1 * self.thickness
        self.move(0.0, 0.0, 40)

    def move(self, v_x, v_y, steps):
        """Move the front ply at a velocity [m/s]; returns the work of friction [J]."""
        before, front = self.energy(lanes.FRICTION_WORK), self.states[0]
        for _ in range(steps):
            for u, v, speed in zip(front.u, front.v, (v_x, v_y)):
                u[: self.nodes] += self.consts[0].dt * speed
                v[: self.nodes] = speed
            self.press()
        return self.energy(lanes.FRICTION_WORK) - before

    @property
    def forces(self):
        """(2, 3) [N] on the front and on the rear ply."""
        return np.array([[f.sum() for f in force] for force in (self.pair.f_front, self.pair.f_rear)])


@pytest.mark.parametrize("knobs", [{}, {"points": 2}, {"form": "facets"}, {"form": "nodes"}])
def test_sliding_plies_take_the_friction_coefficient_times_the_normal_force(ply, knobs):
    pair = Sliding(ply, MU, **knobs)
    normal = abs(pair.forces[0, 2])
    v = np.array([30.0, -40.0])
    pair.move(*v, 30)  # past the elastic slip
    on_front, on_rear = pair.forces
    np.testing.assert_allclose(on_front[:2], -MU * abs(on_front[2]) * v / 50, rtol=2e-3)
    np.testing.assert_allclose(on_front, -on_rear, atol=1e-12 * normal)
    if pair.pack.contact.form == "smooth":  # kept of points eight at once, and of those one at a time
        assert pair.pair.normal_force.sum() == pytest.approx(abs(on_front[2]), rel=1e-12)
    work = pair.move(*v, 4)
    assert work == pytest.approx(MU * abs(on_front[2]) * 50 * 4 * pair.consts[0].dt, rel=0.02)


def test_points_stick_below_the_limit_and_come_back(ply):
    """Within the elastic slip the force is that of the spring, and is gone when the slip is."""
    pair = Sliding(ply, MU)
    normal, points = abs(pair.forces[0, 2]), np.count_nonzero(pair.pair.normal_force)
    limit = MU * normal / points / pair.pair.slip_stiffness  # [m] of slip
    speed = 0.2 * limit / pair.consts[0].dt
    pair.move(speed, 0.0, 2)
    assert pair.forces[0, 0] == pytest.approx(-0.4 * MU * normal, rel=1e-2)
    pair.move(-speed, 0.0, 2)
    assert abs(pair.forces[0, 0]) < 1e-2 * MU * normal


@pytest.mark.parametrize(("points", "spread"), [(1, 0.0), (2, (1 + 1 / 64) ** 2 - (1 - 1 / 128) ** 2)])
def test_the_patch_of_a_graded_pack_is_rubbed_in_proportion_to_its_mass(ply, points, spread):
    """Across zones: friction accelerates all nodes of a flat ply alike, but for what the spline's points next to a
    border give to the node behind it, of two a side 1/32 of theirs: 1/64 too much on the side of the short elements,
    and 1/128 too little on the other, where they are twice as long, in either direction."""
    zones = (7, 1), (np.inf, 2)
    graded = replace(ply, edge="free", symmetry="whole", opening=(0.034, 0.034), grading=zones)
    pair = Sliding(graded, MU, points=points)
    pair.move(15.0, 0.0, 20)
    const, front = pair.consts[0], pair.states[0]
    shape = (const.ni + 1, const.row_stride)
    inner = (slice(2, -2), slice(2, const.nj - 1))
    mass, force = (x[: pair.nodes].reshape(shape)[inner] for x in (front.mass, pair.pair.f_front[0]))
    assert mass.max() > 3.9 * mass.min()
    assert abs(np.ptp(force / mass) / abs(np.median(force / mass)) - spread) < (2e-2 if points == 1 else 5e-4)


def rubbing(ply, mu, **knobs):
    """A free ply before another, at which it can fly obliquely."""
    free = replace(ply, edge="free", symmetry="whole")
    return Pack.stacked(free, 2, stacking="alternating", gap=20e-6, contact=PlyContact(**knobs), friction=mu)


FLIGHT = 15.0, 5.0, 20.0  # [m/s]


@pytest.mark.parametrize("mu", [0.1, 0.5])
@pytest.mark.parametrize("points", [1, 2])
def test_rubbing_plies_keep_momentum_and_make_no_energy(ply, mu, points):
    smooth, _, _ = collide(rubbing(ply, 0.0, points=points), FLIGHT, 200)
    solver, before, energy = collide(rubbing(ply, mu, points=points), FLIGHT, 200)
    sums = np.array([[state.mass @ v for v in state.v] for state in solver.states])
    np.testing.assert_allclose(sums.sum(axis=0), before, atol=1e-12 * np.abs(before).max())
    carried = smooth.states[1].mass @ smooth.states[1].v[0]
    assert sums[1, 0] > carried + 0.05 * before[0]  # the rear ply is taken along
    assert abs(solver.sample("error")[-1]) < 1e-6 * energy
    assert smooth.sample("ply_friction")[-1] == 0.0
    assert solver.sample("ply_friction")[-1] > 1e-3 * energy


def test_the_elastic_slip_is_stable_at_any_coefficient(ply):
    """All points stick, so that all springs and dampers of friction act at once: energy is lost, none is made.

    At half the step, as time integration alone is off by 0.7e-6 of the energy at the whole one, without friction.
    """
    solver, _, energy = collide(rubbing(ply, 1e3, courant=0.225), FLIGHT, 1200)
    assert abs(solver.sample("error")[-1]) < 1e-6 * energy
    assert solver.sample("ply_friction")[-1] > 0.0
    kinetic = solver.sample("kinetic_fabric")
    assert kinetic[-1] < kinetic[0]


def test_the_constants_leave_the_plies_their_time_step():
    for cfl, zeta in ((0.9, 0.7), (0.45, 0.7), (0.9, 0.0)):
        k, c = friction.slip_constants(cfl, 2.0, 3.0, 1e3, zeta)
        assert k * 9 / 2 + 2 * c * 3 / 2 == pytest.approx(1 - cfl**2)
    k, _ = friction.slip_constants(0.1, 2.0, 3.0, 0.04, 0.7)
    assert k == pytest.approx(0.04)  # no stiffer than the normal contact
