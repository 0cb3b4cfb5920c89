"""Friction between plies: Coulomb's limit, stick below it, its work, momentum, energy."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import collide, grid, momenta
from numpy.testing import assert_allclose
from test_ply_contact import Flat, tear

from shellfabric.contact import friction
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

    @property
    def mass(self):
        """[kg] of the front ply."""
        return self.states[0].mass.sum()

    @property
    def stiffness(self):
        """[N/m] of all points that stick."""
        pressure = self.contact.pressure
        const = self.consts[0]
        areas = pressure.area_ratio[: const.ni * const.nj].sum()
        return pressure.points_per_side**2 * areas * pressure.stick_stiffness[0]

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


GRADINGS = [None, ((np.inf, 0.5),), ((6, 0.5), (np.inf, 1))]
MESHES = pytest.mark.parametrize(
    "grading, courant, points",
    [(g, 0.45, 2) for g in GRADINGS] + [(None, 0.15, 2), (None, 0.45, 1)],
)


def on_mesh(ply, grading, courant, points):
    return Sliding(replace(ply, grading=grading), MU, courant=courant, points=points)


@MESHES
@pytest.mark.parametrize("alone", [True, False])
@pytest.mark.parametrize("speed", [1.0, 10.0, 100.0])
def test_sliding_plies_take_the_friction_coefficient_times_the_normal_force(
    ply, grading, courant, points, alone, speed
):
    """Once the elastic slip has been wound up, at any speed, on any mesh, with any step."""
    pair = on_mesh(ply, grading, courant, points)
    pair = pair.alone() if alone else pair
    v = speed * np.array([0.6, -0.8])
    dt = pair.consts[0].dt
    winding = MU * abs(pair.move(0.0, 0.0)[0, 2]) / pair.stiffness / (speed * dt)
    on_front, on_rear = pair.move(*v, int(winding) + 2)
    assert_allclose(on_front[:2], -MU * abs(on_front[2]) * v / speed, rtol=1e-6)
    assert_allclose(on_front, -on_rear, atol=1e-12 * abs(on_front[2]))
    before = pair.work
    pair.move(*v, 4)
    assert pair.work - before == pytest.approx(MU * abs(on_front[2]) * speed * 4 * dt, rel=1e-6)


@MESHES
def test_stick_is_as_stiff_on_every_mesh_and_does_not_creep(ply, grading, courant, points):
    """By the share of the stiffness across the surface that Mindlin's contacts have; as much after a hundred steps."""
    pair = on_mesh(ply, grading, courant, points)
    lengths = [np.ptp(x) for x in pair.pack.plies[0].lines()]
    steepest = pair.pack.contact_laws[0].steepest * np.prod(lengths)
    assert pair.stiffness == pytest.approx(friction.STIFFNESS * steepest, rel=1e-6)
    limit = MU * abs(pair.move(0.0, 0.0)[0, 2])
    wound = 0.5 * limit / pair.stiffness
    pair.move(wound / (10 * pair.consts[0].dt), 0.0, 10)
    before = pair.work
    for steps in (1, 100):
        assert pair.move(0.0, 0.0, steps)[0, 0] == pytest.approx(-0.5 * limit, rel=1e-6)
    assert pair.work == pytest.approx(before, rel=1e-6)


def test_friction_turns_with_the_motion_over_twice_the_elastic_slip(ply):
    """Hysteresis: forward till it slides, back till it slides; what is lost is friction times slip."""
    pair = Sliding(ply, MU)
    limit = MU * abs(pair.move(0.0, 0.0)[0, 2])
    elastic = limit / pair.stiffness
    speed = 0.01 * elastic / pair.consts[0].dt
    drag = 0.03 * limit  # more than the damper's part
    assert pair.move(speed, 0.0, 200)[0, 0] == pytest.approx(-limit, rel=1e-6)
    before = pair.work
    for steps, part in ((50, -0.5), (50, 0.0), (50, 0.5), (60, 1.0)):
        assert abs(pair.move(-speed, 0.0, steps)[0, 0] - part * limit) < drag
    assert pair.work - before == pytest.approx(0.1 * elastic * limit, rel=0.5)
    assert pair.move(-speed, 0.0, 1)[0, 0] == pytest.approx(limit, rel=1e-6)
    before = pair.work
    pair.move(-speed, 0.0, 100)
    assert pair.work - before == pytest.approx(elastic * limit, rel=1e-6)


@MESHES
@pytest.mark.parametrize("speed", [30.0, 100.0])
def test_a_sliding_ply_comes_to_rest_and_stays(ply, grading, courant, points, speed):
    """As a rigid one under its weight: at mu N / m, after v^2 m / 2 mu N; its energy is what friction takes."""
    pair = on_mesh(ply, grading, courant, points)
    dt = pair.consts[0].dt
    limit = MU * abs(pair.move(0.0, 0.0)[0, 2])
    stop = speed * pair.mass / limit
    elastic = limit / pair.stiffness
    v = speed
    x = 0.0
    places = []
    lost = []
    for _ in range(int((stop + 4e-6) / dt)):
        last = v
        force = pair.move(v, 0.0)[0, 0]
        x += dt * v
        v += dt / pair.mass * force
        places.append(x)
        lost.append(pair.work)
    assert abs(x - 0.5 * speed * stop) < 2 * elastic + speed * dt
    assert np.ptp(places[-int(1e-6 / dt) :]) < elastic
    assert np.diff(lost).min() > -1e-12 * lost[-1]
    energy = lost[-1] + 0.5 * force**2 / pair.stiffness + 0.5 * pair.mass * v * last
    # the damper lags by half a step, which is booked with the contact
    assert energy == pytest.approx(0.5 * pair.mass * speed**2, rel=5e-3)


def test_a_point_lets_its_spring_go_where_nothing_presses(ply):
    """Back by no step of its own; the energy that it held is counted as lost."""
    pair = Sliding(ply, MU)
    limit = MU * abs(pair.move(0.0, 0.0)[0, 2])
    wound = 0.5 * limit / pair.stiffness
    pair.move(wound / (10 * pair.consts[0].dt), 0.0, 10)
    before = pair.work
    # along the branch of parting
    grid(pair.consts[0], pair.states[0].u[2])[:] -= 0.008 * pair.thickness
    assert abs(pair.move(0.0, 0.0)[0, 2]) == 0.0
    assert pair.work - before == pytest.approx(0.25 * limit * wound, rel=1e-6)
    grid(pair.consts[0], pair.states[0].u[2])[:] += 0.008 * pair.thickness
    on_front = pair.move(0.0, 0.0)[0]
    assert abs(on_front[0]) < 1e-9 * abs(on_front[2])


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


@pytest.mark.parametrize("cfl", [0.95, 0.9, 0.45, 0.05])
@pytest.mark.parametrize("stiffness", [1e-3, 0.1, 1e3])
def test_stick_leaves_the_plies_their_time_step(cfl, stiffness):
    spring, damper = friction.stick(cfl, 2.0, 3.0, 2.0 / 9.0 * stiffness)
    assert spring > 0
    assert damper > 0
    assert cfl**2 + spring * 9 / 2 + 2 * damper * 3 / 2 < 1
