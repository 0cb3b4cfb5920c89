"""Plies of unlike fabrics on each other: thickness, law and gap of each pair, whichever is in front."""

from itertools import pairwise

import numpy as np
import pytest
from conftest_tools import Pressed, grid

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies import frame_kernels
from shellfabric.plies.model import Pack, PlyContact
from tests.shellfabric.panels import make_panel

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
    knobs = PlyContact(damping=0.0)
    pack = Pack(tuple(panels), gaps[: len(panels) - 1], contact=knobs)
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
    wanted = area * float(pack.laws[moved].pressure_at(closure))
    assert forces[moved, 1] == pytest.approx(-wanted, rel=0.02)
    assert forces[moved + 1, 0] == pytest.approx(wanted, rel=0.02)
    others = np.delete(forces.ravel(), [2 * moved + 1, 2 * moved + 2])
    assert abs(others).max() == 0.0
    pressures = [float(law.pressure_at(closure)) for law in pack.laws]
    assert pressures[0] != pytest.approx(pressures[1], rel=0.05)


def test_front_and_rear_can_be_exchanged(unlike):
    """Two plies press on each other alike, whichever is in front: up to the edges of their elements."""
    closure = 8e-6
    forward, _ = press(unlike[:2], 0, closure)
    backward, _ = press(unlike[1::-1], 0, closure)
    assert backward[0, 1] == pytest.approx(forward[0, 1], rel=0.02)
    assert forward[0, 1] < 0


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
