"""Plies of unlike fabrics on each other: thickness, law and gap of each pair, whichever is in front."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace as Given

import numpy as np
import pytest
from conftest_tools import Pressed, bring, grid

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.loop import ply_audit
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import edges, quality
from shellfabric.membrane.boundary import Grip, PullIn
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies import frame_kernels
from shellfabric.plies.model import Pack, PlyContact
from tests.shellfabric.panels import UNDAMPED, make_panel

NAMES = "S-728", "S-726", "S-731"
GAPS = 20e-6, 50e-6


@pytest.fixture(scope="module")
def unlike():
    """Three panels of 20 mm, whose thicknesses, spacings and laws are all different."""
    panels = []
    for name in NAMES:
        cell = CellModel(catalogue.load(name).with_effective_density()).table(21)
        panels.append(make_panel(0.02, table=cell, symmetry="whole", numerics=Numerics(threads=1)))
    return panels


def press(panels, moved, closure, gaps=GAPS):
    """Forces [N] along z on each ply from the plies before and behind it, where one flat ply is moved
    onto the next by more than their gap, and the pack."""
    numbers = PlyContact(damping=0.0)
    pack = Pack(tuple(panels), gaps[: len(panels) - 1], contact=numbers)
    pressed = Pressed(pack)
    lift = gaps[moved] + closure
    grid(pressed.consts[moved], pressed.states[moved].u[2])[:] = lift
    pressed.press(2)
    sides = frame_kernels.BEFORE, frame_kernels.BEHIND
    forces = [[pressed.force(p, side)[..., 2].sum() for side in sides] for p in range(len(panels))]
    return np.array(forces), pack


@pytest.mark.parametrize("moved", [0, 1])
def test_the_force_is_that_of_the_mean_thickness_and_of_the_law_of_the_pair(unlike, moved):
    """Flat plies, closed by d: the force is A p(d), of the law of these two and of their gap; the third ply bears
    none of it."""
    closure = 8e-6
    forces, pack = press(unlike, moved, closure)
    area = np.prod([np.ptp(x) for x in unlike[0].lines()])
    wanted = area * float(pack.contact_laws[moved].pressure_at(closure))
    assert forces[moved, 1] == pytest.approx(-wanted, rel=0.02)
    assert forces[moved + 1, 0] == pytest.approx(wanted, rel=0.02)
    others = np.delete(forces.ravel(), [2 * moved + 1, 2 * moved + 2])
    assert abs(others).max() == 0.0
    pressures = [float(law.pressure_at(closure)) for law in pack.contact_laws]
    assert pressures[0] != pytest.approx(pressures[1], rel=0.05)


def test_front_and_rear_can_be_exchanged(unlike):
    """Two plies press on each other alike, whichever is in front: up to the edges of their elements."""
    closure = 8e-6
    forward, _ = press(unlike[:2], 0, closure)
    backward, _ = press(unlike[1::-1], 0, closure)
    assert backward[0, 1] == pytest.approx(forward[0, 1], rel=0.02)
    assert forward[0, 1] < 0


SLIPPING = [
    pytest.param((Grip(6.0), Grip(11.0)), id="grips"),
    pytest.param(
        (PullIn(0.4e-3, 4e-6, 22e-6, 16e-3), (Grip(7.0), "clamped")), id="pulled and gripped"
    ),
]


@pytest.mark.parametrize("boundary", SLIPPING)
def test_yarn_ends_that_slip_take_what_other_plies_push_them_by(unlike, boundary):
    """The contact between plies books its work on them, so energy balances only if they move by it."""
    plies = tuple(replace(ply, boundary=boundary) for ply in unlike)
    solver = PackSolver(Pack(plies, GAPS, friction=0.3), 200.0, 30e-6).run()
    pushes = [abs(state.slip_push).max() for state in solver.states]
    assert min(pushes) > 0.1
    assert solver.ply_sample("pull_in")[-1].min() > 1e-4
    assert abs(solver.sample("error")).max() < 1e-3 * solver.strike_energy


def test_places_at_rest_are_apart_by_mean_thickness_and_gap(unlike):
    pack = Pack(tuple(unlike), GAPS)
    thickness = [ply.weave.thickness for ply in unlike]
    assert len(set(np.round(thickness, 7))) == 3
    apart = [0.5 * (one + other) + gap for (one, other), gap in zip(pairwise(thickness), GAPS)]
    assert np.diff(pack.places) == pytest.approx(apart, rel=1e-12)


def test_laws_of_pairs_are_of_their_two_fabrics_in_either_order(unlike):
    forward = Pack(tuple(unlike), GAPS).laws
    backward = Pack(tuple(unlike[::-1]), GAPS[::-1]).laws
    for one, other in zip(forward, backward[::-1]):
        closures = np.linspace(1e-6, 0.9 * one.travel, 7)
        assert other.pressure_at(closures) == pytest.approx(one.pressure_at(closures), rel=1e-9)


def test_the_step_goes_by_the_lighter_of_two_plies(unlike):
    """Where the contact of plies bounds the step it is the same, whichever of two is in front."""
    stiff = PlyContact(stiffness=50.0)
    one, other = (
        Pack(tuple(plies), GAPS[:1], contact=stiff).time_step
        for plies in (unlike[:2], unlike[1::-1])
    )
    assert one == pytest.approx(other, rel=1e-12)
    assert one < min(ply.time_step for ply in unlike[:2])
    assert unlike[0].weave.areal_density != pytest.approx(unlike[1].weave.areal_density, rel=0.1)


def test_the_deepest_closure_is_over_the_mean_thickness_of_two():
    pressure = Given(max_closure=np.array([3e-5, 5e-5, 0.0]))
    solver = Given(contact=Given(thickness=np.array([2e-4, 4e-4, 6e-4]), pressure=pressure))
    assert PackSolver.deepest.fget(solver) == pytest.approx([0.1, 0.1])


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_reactions_of_warp_and_weft_are_their_own_yarns_tensions(unlike, symmetry):
    """A panel of S-726, stretched evenly: at its edges each family has the force of the cell at these stretches."""
    panel = replace(
        unlike[1], symmetry=symmetry, opening=(0.02, 0.0213), trellis=False, numerics=UNDAMPED
    )
    assert panel.spacing[0] != pytest.approx(panel.spacing[1], rel=0.05)
    stretches = 1.012, 1.02
    (state,), _ = Pack.of(panel).states(1.0)
    const = panel.constants()
    x = np.stack([*panel.coordinates(), np.zeros(np.add(panel.counts, 1))], axis=-1)
    bring(panel, state, x * np.array([*stretches, 1.0]))
    found = ply_audit.edge_reactions(panel, const, state, edges.ends(panel))
    force = panel.table.model.solve(*stretches)
    assert found == pytest.approx((float(force["N1"]), float(force["N2"])), rel=0.01)
    assert found[0] != pytest.approx(found[1], rel=0.1)


def test_energies_of_the_contact_of_plies_add_up_to_its_work():
    """What is rubbed and what is lost with dropped elements stand by themselves; collisions are the guard's."""
    pressure = Given(
        work=np.array([70.0, 30.0]),
        friction_work=np.array([11.0, 2.0]),
        lost_energy=np.array([5.0, 1.5]),
    )
    contact = Given(pressure=pressure, guard=Given(work=7.0))
    found = PackSolver._contact_energies(Given(contact=contact))
    assert found == {
        "ply_contact": 80.5,
        "ply_contact_lost": 6.5,
        "ply_friction": 13.0,
        "ply_collisions": 7.0,
    }


def test_checks_of_mesh_and_cell_are_those_of_the_worst_ply():
    """Each ply beside its own spacing, strength and law, wherever it is in the pack."""
    panels = []
    for name, known in zip(NAMES, (3.0, 5.0, 4.0)):
        fabric = catalogue.load(name)
        laws = tuple(replace(law, F_range=(0.0, known)) for law in fabric.laws)
        cell = CellModel(fabric, laws).table(21)
        panels.append(make_panel(0.02, table=cell, symmetry="whole", numerics=Numerics(threads=1)))
    alone = {}
    in_a_pack = []
    for chosen in (panels[:1], panels[1:2], panels[2:], panels, panels[::-1]):
        solver = PackSolver(Pack(tuple(chosen), GAPS[: len(chosen) - 1]), 100.0, 1e-6)
        for panel, _, state in solver.plies:
            state.peak_tension[:] = [0.7 * yarn.strength for yarn in panel.weave.yarns]
        found = {one.name: one.value for one in quality.of_solver(solver)}
        if len(chosen) > 1:
            in_a_pack.append(found)
            continue
        for name, value in found.items():
            alone.setdefault(name, []).append(value)
    for name in ("contact point spacing", "element side", "contact force over fitted range"):
        assert len(set(alone[name])) == 3
        for found in in_a_pack:
            assert found[name] == pytest.approx(max(alone[name])), name
