"""Parts of a user's own (`parts.Part`), each in one file: springs to the ground at the nodes of a ply, a wall that the
nose meets, and plates that act in three phases of a step with steps of their own."""

import pickle
from dataclasses import replace
from functools import partial
from math import inf

import numpy as np
import pytest
from conftest_tools import Interrupted, far_from_nose
from numpy.testing import assert_allclose, assert_array_equal

from fabrics import catalogue
from fabrics.base.errors import InputError, UnstableError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.jit.compile import kernel
from shellfabric.jit.table import Row, array, number, tally, total
from shellfabric.loop import checkpoint, pack_solver
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import quality
from shellfabric.membrane.indicator import Indicator
from shellfabric.membrane.numerics import Numerics
from shellfabric.parts import Part, own_steps
from shellfabric.plies.model import Pack
from shellfabric.state import unit
from shellfabric.subcycle_kernels import subcycle

S726 = catalogue.load("S-726").with_effective_density()


class Springs(Row):
    """Springs from the nodes to where they are at rest."""

    stiffness = number("N/m", "of the spring of a node")
    calls = array("1", "-", "how often forces were asked for", kept=True)


@unit("number", own=Springs)
def springs(state, const, own, first, last, acting):
    """Energy [J] of the springs of the node rows first .. last; adds their forces if `acting`."""
    energy = 0.0
    own.calls[0] += acting
    for c in range(3):
        for k in range(first * const.row_stride, (last + 1) * const.row_stride):
            energy += 0.5 * own.stiffness * state.u[c][k] ** 2
            if acting:
                state.f_int[c][k] -= own.stiffness * state.u[c][k]
    return energy


class Ground(Part):
    """The springs of a panel, of a stiffness [N/m]."""

    name = energy = "ground"
    forces = springs

    def __init__(self, panel, stiffness):
        self.row = Springs(stiffness=stiffness, calls=np.zeros(1))
        smallest = panel.weave.areal_density * min(panel.spacing) ** 2
        self.stiffness = 0.25 * stiffness / smallest


def panel(grading, stiffness, **changes):
    options = {"opening": 0.04, "elements_per_crossover": 1, "table_size": 41, "grading": grading}
    setup = ImpactSetup(S726, 100.0, end_time=30e-6, numerics=Numerics(threads=1), **options)
    return replace(setup.panel(), parts=(partial(Ground, stiffness=stiffness),), **changes)


GRADED = ((8, 0.5), (inf, 1))
grids = pytest.mark.parametrize("grading", [None, GRADED], ids=["uniform", "graded"])


@grids
def test_the_work_of_a_nose_goes_into_springs_too(grading):
    """Energy is conserved, and the springs store what their definition gives."""
    run = PackSolver(panel(grading, 2e3), 100.0, 30e-6).run()
    stored = run.sample("ground")
    by_hand = sum(0.5 * 2e3 * (u**2).sum() for u in run.state.u) / run.share
    assert stored[-1] == pytest.approx(by_hand, rel=1e-12)
    assert stored[-1] > 0.02 * run.strike_energy
    assert abs(run.sample("error")).max() < 1e-3 * run.strike_energy
    assert run.part("ground").row.calls[0] == run.steps + 1


def test_stiff_springs_shorten_the_time_step():
    """To what the highest frequency of both together leaves."""
    soft = panel(None, 0.0)
    stiff = panel(None, 1e6)
    added = 0.25 * 1e6 / (soft.weave.areal_density * min(soft.spacing) ** 2)
    assert stiff.critical_step == pytest.approx((soft.critical_step**-2 + added) ** -0.5, rel=1e-12)
    assert stiff.time_step < soft.time_step
    run = PackSolver(stiff, 100.0, 20e-6).run()
    assert abs(run.sample("error")).max() < 1e-3 * run.strike_energy


def test_each_ply_of_a_pack_has_springs_of_its_own():
    """A ply that moves as a whole swings as its springs and masses do."""
    run = far_from_nose(Pack.stacked(panel(None, 2e3), 2, gap=1e-3))
    rows = [parts[-1].row for parts in run.parts]
    assert rows[0] is not rows[1]
    assert "ground" in run.energy_names


def resumed(begin, folder):
    """The run of a solver that `begin` makes, interrupted at half of its time and gone on with by another."""
    half = begin()

    def interrupt(run):
        if run.time > 0.5 * run.end_time:
            raise Interrupted

    with pytest.raises(Interrupted):
        half.run((interrupt,))
    checkpoint.write(half, folder / "half.h5")
    rest = begin()
    checkpoint.read(rest, folder / "half.h5")
    return rest.run()


def test_a_run_with_a_part_goes_on_from_a_checkpoint(tmp_path):
    """To the last bit, with what the part keeps."""

    def begin():
        return PackSolver(panel(None, 2e3), 100.0, 30e-6)

    whole = begin().run()
    rest = resumed(begin, tmp_path)
    assert_array_equal(rest.state.u, whole.state.u)
    assert_array_equal(rest.sample("ground"), whole.sample("ground"))
    assert rest.part("ground").row.calls[0] == whole.part("ground").row.calls[0]


def test_a_copy_of_a_state_finds_the_units_of_its_process():
    state = panel(None, 2e3).state(1.0)
    copy = pickle.loads(pickle.dumps(state))
    assert_array_equal(copy.parts.forces, state.parts.forces)
    assert copy.parts.own[-1] != state.parts.own[-1]
    assert_allclose(copy.u, state.u)


class Wall(Row):
    """A spring that the nose meets in place of the membrane."""

    stiffness = number("N/m", "of the modelled part of the spring")
    energy = array("1", "J", "that it holds", kept=True)


@unit(own=Wall)
def push_nose(state, const, own):
    """The force of the spring on the nose, and its energy."""
    depth = max(state.projectile_position[2], 0.0)
    own.energy[0] = 0.5 * own.stiffness * depth**2
    state.f_contact_nose[2] = -own.stiffness * depth


class Stop(Part):
    """A wall; its energy under a name that a ply has, and under one of its own."""

    name = "wall"
    nose = push_nose

    def __init__(self, panel):
        self.row = Wall(stiffness=1e6, energy=np.zeros(1))

    def energies(self):
        stored = self.row.energy[0]
        return {"contact": stored / 3, "wall_spring": 2 * stored / 3}


def test_a_nose_meets_a_part_in_place_of_the_membrane():
    """A mass on a spring stops after a quarter of its period; the books have the energy, the ply stays at rest."""
    struck = replace(panel(None, 0.0), parts=(Stop,))
    run = PackSolver(struck, 100.0, 300e-6).run()
    period = 2 * np.pi * np.sqrt(struck.projectile.mass / (1e6 / run.share))
    start = run.time - 0.25 * period - struck.time_step
    assert run.outcome == "stopped"
    assert 0.0 <= start + struck.time_step < 2 * struck.time_step
    assert np.abs(run.state.u).max() == 0.0
    assert run.sample("contact")[-1] == pytest.approx(run.strike_energy / 3, rel=1e-3)
    assert run.sample("wall_spring")[-1] == pytest.approx(2 * run.strike_energy / 3, rel=1e-3)
    assert abs(run.sample("error")).max() < 1e-6 * run.strike_energy


def test_only_one_part_stands_in_for_the_membrane():
    with pytest.raises(ValueError, match="2 parts are to stand in"):
        replace(panel(None, 0.0), parts=(Stop, Stop)).state(100.0)


class Plates(Row):
    """Two plates on a stiff spring; the first is pushed by the nose and holds on to a node, both by a spring."""

    spring = number("N/m", "to the nose, and to the node")
    stiff = number("N/m", "between the plates")
    mass = number("kg", "of each plate")
    steps = tally("-", "of their own in one of the run")
    x = array("2", "m", "places of the plates", kept=True)
    v = array("2", "m/s", "velocities", kept=True)
    push = total("N", "force of the nose on the first plate", kept=True)
    stored = total("J", "in the springs", kept=True)
    moving = total("J", "kinetic energy", kept=True)


@unit("number", own=Plates)
def hold_ply(state, const, own, first, last, acting):
    """Energy [J] of a spring a fifth as stiff from each node to the ground; adds its forces if `acting`."""
    energy = 0.0
    stiffness = 0.2 * own.spring
    for k in range(first * const.row_stride, (last + 1) * const.row_stride):
        energy += 0.5 * stiffness * state.u[2][k] ** 2
        if acting:
            state.f_int[2][k] -= stiffness * state.u[2][k]
    return energy


@unit(own=Plates)
def push_plate(state, const, own):
    """The force of the spring between nose and first plate."""
    depth = max(state.projectile_position[2] - own.x[0], 0.0)
    own.push = own.spring * depth
    own.stored = 0.5 * own.push * depth
    state.f_contact_nose[2] = -own.push


@unit(own=Plates)
def move_plates(state, const, own):
    """Give the impulses of nose and node to the first plate, and move both in steps of their own."""
    gap = own.x[0] - state.u[2][0]
    state.f_int[2][0] += own.spring * gap
    own.stored += 0.5 * own.spring * gap**2 + 0.5 * own.stiff * (own.x[0] - own.x[1]) ** 2
    before = own.v[0]
    own.v[0] += const.dt * (own.push - own.spring * gap) / own.mass
    own.moving = 0.5 * own.mass * (before * own.v[0] + own.v[1] ** 2)
    subcycle(step_plates, (own,), own.steps, const.dt)


@kernel()
def step_plates(body, dt, left):
    """A step of the stiff spring alone, by velocity Verlet."""
    (own,) = body
    for half in range(2):
        force = own.stiff * (own.x[1] - own.x[0])
        own.v[0] += 0.5 * dt * force / own.mass
        own.v[1] -= 0.5 * dt * force / own.mass
        if half == 0:
            own.x[0] += dt * own.v[0]
            own.x[1] += dt * own.v[1]


class TwoPlates(Part):
    """A part with all that a part can have."""

    name = "plates"
    energy = "held_ply"
    forces = hold_ply
    nose = push_plate
    after = move_plates
    meets_nose = True
    contacts = {"plate_springs": "the contact with the plates"}  # noqa: RUF012

    def __init__(self, panel, spring=2e5):
        self.stiffness = 0.25 * spring / panel.weave.areal_density / min(panel.spacing) ** 2
        found = {"spring": spring, "stiff": 1e3 * spring, "mass": 5e-5}
        self.row = Plates(**Plates.zeros() | found)
        self.begun = 0

    def cut(self, state):
        for hold in (state.inverse_mass, state.dt_over_mass):
            hold[5] = 0.0

    def begin(self, state, const, stack):
        own = self.row
        own.steps = own_steps(const.dt, 0.05 * (own.mass / own.stiff) ** 0.5)
        self.begun += 1

    def identity(self):
        return self.name, self.row.spring

    def energies(self):
        return {"plate_springs": float(self.row.stored), "plate_motion": float(self.row.moving)}

    def samples(self):
        return {"plate": float(self.row.x[0])}

    def show(self, state):
        state.T[0][7] = 1e3 * self.row.x[0]

    def speeds(self, strike_velocity):
        return abs(self.row.v), 10 * strike_velocity

    def where(self, node):
        return f"plate {node + 1}"

    def guard(self, state):
        if self.row.x[0] > 1.2e-3:
            return "a plate has left its frame", f"at {1e3 * self.row.x[0]:.3g} mm"
        return None

    def indicators(self):
        return (Indicator("plates apart", abs(np.ptp(self.row.x)), 1e-3, "m"),)

    def result(self, clock, steps):
        return {"plates": (clock[-1], len(steps))}


def with_plates(end_time=34e-6, **options):
    """A solver of a panel with plates."""
    struck = replace(panel(None, 0.0), parts=(partial(TwoPlates, **options),))
    return PackSolver(struck, 100.0, end_time)


@pytest.fixture(scope="module")
def plates():
    return with_plates().run()


def test_a_part_of_three_phases_and_own_steps_keeps_the_energy(plates):
    """Nose, plates, ply and ground share it; all that the part says of itself is asked for."""
    part = plates.part("plates")
    E = plates.strike_energy
    assert part.row.steps > 3
    for name in ("held_ply", "plate_springs", "plate_motion", "kinetic_fabric"):
        assert plates.sample(name)[-1] > 1e-4 * E, name
    assert abs(plates.sample("error")).max() < 5e-6 * E
    assert plates.sample("plate")[-1] == part.row.x[0] > 1e-4
    assert plates.ply_sample("energy")[-1, 0] > plates.sample("plate_motion")[-1]
    assert part.begun == 1
    assert not np.array(plates.state.u)[:, 5].any()  # it holds a node
    assert plates.state.T[0][7] == 1e3 * part.row.x[0]
    assert "plates apart" in [one.name for one in quality.of_solver(plates)]
    assert "plate_springs" in plates.contacts
    assert part.row in plates.checkpoint_arrays().values()


def test_a_part_of_three_phases_goes_on_from_a_checkpoint(plates, tmp_path):
    """To the last bit; a part that is another one is another run."""
    rest = resumed(with_plates, tmp_path)
    assert_array_equal(rest.state.u, plates.state.u)
    assert_array_equal(rest.samples, plates.samples)
    for name in Plates.kept():
        assert_array_equal(
            getattr(rest.part("plates").row, name), getattr(plates.part("plates").row, name)
        )
    with pytest.raises(InputError):
        checkpoint.read(with_plates(spring=1e5), tmp_path / "half.h5")


def test_messages_name_the_nodes_and_the_guard_of_a_part():
    broken = with_plates()
    broken.part("plates").row.v[0] = np.nan
    with pytest.raises(UnstableError, match="not finite, at plate 1"):
        broken.run()
    far = with_plates(80e-6)
    with pytest.raises(UnstableError, match="a plate has left its frame"):
        far.run()


class Watch(Row):
    """What a part of a run counts."""

    calls = tally("-", "steps in which it was called", kept=True)


class Watcher(Part):
    """A part that a run has once, behind its last ply: it steps in Python, and changes nothing but a radius."""

    name = "watcher"
    of_ply = False
    ply = -1
    steps_in_python = True

    def __init__(self, pack, consts, velocity):
        self.row = Watch(calls=np.zeros((), np.int64))
        self.velocity = velocity

    def seen(self, const, ply):
        return const._replace(body_depth=2 * const.body_depth)

    def step(self, state):
        self.row.calls = int(self.row.calls) + 1
        self.place = float(state.projectile_position[2])

    def energies(self):
        return {"shear": 3.0, "watched": 2.0}


def test_energies_of_a_part_of_the_run_are_not_those_of_a_ply(monkeypatch, tmp_path):
    """It is called after each step, and its count goes on from a checkpoint."""

    def begin():
        return PackSolver(panel(None, 2e3), 100.0, 20e-6)

    plain = begin().run()
    monkeypatch.setattr(pack_solver, "OF_A_RUN", (lambda *given: (Watcher(*given),),))
    watched = begin().run()
    watcher = watched.part("watcher")
    assert watcher.velocity == 100.0
    assert watcher.row.calls == watched.steps
    assert watcher.place == watched.state.projectile_position[2]
    assert watched.const.body_depth == 2 * plain.const.body_depth
    assert_array_equal(watched.ply_samples, plain.ply_samples)
    assert watched.sample("watched") * watched.share == pytest.approx(2.0, rel=1e-12)
    more = (watched.sample("shear") - plain.sample("shear")) * watched.share
    assert more == pytest.approx(3.0, rel=1e-12)
    assert resumed(begin, tmp_path).part("watcher").row.calls == watched.steps
