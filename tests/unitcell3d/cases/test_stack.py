"""Plies between plates: one as the crossover's own case, two in balance, packs beside the pressure law, shifted."""

import numpy as np
import pytest

from meshing import patch
from unitcell3d.cases import biaxial_and_platens, stack
from unitcell3d.model.shifted_stack import ShiftedModel

PRESSURE = 0.3e6


@pytest.fixture(scope="module")
def one(tiny, s720):
    return stack.stack_compression(tiny, s720, 1, pressure=PRESSURE)


def test_one_ply_is_the_crossover_between_plates(one, tiny, s720):
    """The same path by another way of stepping: distance and contact force at the same pressure."""
    history = biaxial_and_platens.plate_compression(tiny, s720, pressure=PRESSURE)
    assert one.failed == ""
    assert one["pressure"][-1] == pytest.approx(PRESSURE, rel=1e-3)
    distance = np.interp(
        PRESSURE * s720.weave.cell_area, history.F_plate.mean(axis=1), 2 * history.plates
    )
    assert one["distance"][-1] == pytest.approx(distance, abs=1e-6)


def test_two_plies_pass_the_force_on_and_each_closes_about_as_much_as_alone(one, tiny, s720):
    """Nothing else holds a slack crossing; the outer faces of yarns meet a yarn instead of a plate."""
    two = stack.stack_compression(tiny, s720, 2, pressure=PRESSURE)
    assert two.failed == ""
    assert two["F_between"][-1, 0] == pytest.approx(two["force"][-1], rel=0.02)
    assert two["F_c"][-1] == pytest.approx(two["force"][-1] * np.ones(2), rel=0.1)
    assert two["pressure"][-1] == pytest.approx(PRESSURE, rel=1e-3)
    assert two["closure_ply"][-1] == pytest.approx(one["closure_ply"][-1], rel=0.1)


def test_pressure_law_stands_beside(one, s720):
    pressure, law, closure = stack.law_closure(s720, one)
    assert pressure[0] >= 10 / 0.019**2
    assert pressure[-1] <= 1.001 * PRESSURE
    assert closure.shape == law.shape
    assert np.all(np.diff(law) > 0)
    assert np.all(np.diff(closure) > 0)


def test_shifted_plies_nest(s720):
    """Half a crossing along both yarns: a ply's crests over the holes of the next, 14 % thinner than crest on crest."""
    mesh = patch.build(s720, (2, 2), size=(3, 2, 2))
    aligned, nested = (ShiftedModel(mesh, s720, 2, shift) for shift in ((0.0, 0.0), (0.5, 0.5)))
    tops = [mesh.points[grid, 2].max() for grid in mesh.grids]
    crests = max(tops[:2]) + max(
        tops[2:]
    )  # of a warp and of a weft, which meet where plies are aligned
    assert 2 * aligned.plates.at_rest == pytest.approx(crests + 2 * max(tops), rel=1e-6)
    assert nested.plates.at_rest == pytest.approx(0.86 * aligned.plates.at_rest, rel=0.02)
    # each exposed crossing of the upper ply lies over four of the lower one
    assert len(aligned.surfaces.pairs) == 8 + 4
    assert len(nested.surfaces.pairs) == 8 + 16


@pytest.mark.slow(35)
def test_shifted_plies_under_pressure(s720):
    mesh = patch.build(s720, (2, 2), size=(3, 2, 2))
    record = stack.stack_compression(mesh, s720, 2, shift=(0.5, 0.5), pressure=0.05e6)
    assert record.failed == ""
    assert np.all(np.diff(record["force"]) > 0)
    assert record["F_between"][-1, 0] >= 0.98 * record["force"][-1]
