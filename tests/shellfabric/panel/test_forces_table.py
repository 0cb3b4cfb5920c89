"""A force of a user's own: springs to the ground at the nodes of a ply, in one file, by `panel.forces`."""

import pickle
from dataclasses import replace
from math import inf

import numpy as np
import pytest
from conftest_tools import Interrupted, far_from_nose
from numpy.testing import assert_allclose, assert_array_equal

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from shellfabric.jit.table import Row, array, number
from shellfabric.output import checkpoint
from shellfabric.panel.forces import Module
from shellfabric.panel.numerics import Numerics
from shellfabric.plies.model import Pack
from shellfabric.solver.pack_solver import PackSolver
from shellfabric.state import unit

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


def ground(stiffness):
    """What makes a panel's springs, of a stiffness [N/m]."""

    def make(panel):
        row = Springs(stiffness=stiffness, calls=np.zeros(1))
        smallest = panel.weave.areal_density * min(panel.spacing) ** 2
        return Module("ground", springs, row, stiffness=0.25 * stiffness / smallest)

    return make


def panel(grading, stiffness, **changes):
    options = {"opening": 0.04, "elements_per_crossover": 1, "table_size": 41, "grading": grading}
    setup = ImpactSetup(S726, 100.0, end_time=30e-6, numerics=Numerics(threads=1), **options)
    return replace(setup.panel(), modules=(ground(stiffness),), **changes)


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
    assert run.modules[0][-1].own.calls[0] == run.steps + 1


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
    rows = [modules[-1].own for modules in run.modules]
    assert rows[0] is not rows[1]
    assert "ground" in run.energy_names


def test_a_run_with_a_module_goes_on_from_a_checkpoint(tmp_path):
    """To the last bit, with what the module keeps."""
    whole = PackSolver(panel(None, 2e3), 100.0, 30e-6).run()
    half = PackSolver(panel(None, 2e3), 100.0, 30e-6)

    def interrupt(run):
        if run.time > 15e-6:
            raise Interrupted

    with pytest.raises(Interrupted):
        half.run((interrupt,))
    checkpoint.write(half, tmp_path / "half.h5")
    rest = PackSolver(panel(None, 2e3), 100.0, 30e-6)
    checkpoint.read(rest, tmp_path / "half.h5")
    rest.run()
    assert_array_equal(rest.state.u, whole.state.u)
    assert_array_equal(rest.sample("ground"), whole.sample("ground"))
    assert rest.modules[0][-1].own.calls[0] == whole.modules[0][-1].own.calls[0]


def test_a_copy_of_a_state_finds_the_units_of_its_process():
    state = panel(None, 2e3).state(1.0)
    copy = pickle.loads(pickle.dumps(state))
    assert_array_equal(copy.modules.cell, state.modules.cell)
    assert copy.modules.own[-1] != state.modules.own[-1]
    assert_allclose(copy.u, state.u)


class Wall(Row):
    """A spring that the nose meets in place of the membrane."""

    stiffness = number("N/m", "of the modelled part of the spring")
    energy = array("1", "J", "that it holds", kept=True)


@unit("number", own=Wall)
def nothing(state, const, own, first, last, acting):
    """No energy: the spring is no force on the ply."""
    return 0.0


@unit("number", own=Wall)
def push_nose(state, const, own, first, last, acting):
    """Energy [J] of the spring; its force on the nose."""
    depth = max(state.projectile_position[2], 0.0)
    own.energy[0] = 0.5 * own.stiffness * depth**2
    state.f_contact_nose[2] = -own.stiffness * depth
    return own.energy[0]


def third_and_rest(own):
    """The energy of a wall under a name that a ply has, and under one of its own."""
    return {"contact": own.energy[0] / 3, "wall_spring": 2 * own.energy[0] / 3}


def test_a_nose_meets_a_module_in_place_of_the_membrane():
    """A mass on a spring stops after a quarter of its period; the books have the energy, the ply stays at rest."""

    def wall(panel):
        row = Wall(stiffness=1e6, energy=np.zeros(1))
        return Module("wall", nothing, row, nose=push_nose, books=third_and_rest)

    struck = replace(panel(None, 0.0), modules=(wall,))
    run = PackSolver(struck, 100.0, 300e-6).run()
    period = 2 * np.pi * np.sqrt(struck.projectile.mass / (1e6 / run.share))
    start = run.time - 0.25 * period - struck.time_step
    assert run.outcome == "stopped"
    assert 0.0 <= start + struck.time_step < 2 * struck.time_step
    assert np.abs(run.state.u).max() == 0.0
    assert run.sample("contact")[-1] == pytest.approx(run.strike_energy / 3, rel=1e-3)
    assert run.sample("wall_spring")[-1] == pytest.approx(2 * run.strike_energy / 3, rel=1e-3)
    assert abs(run.sample("error")).max() < 1e-6 * run.strike_energy
