"""Plies between plates: one as the crossover's own case, two in balance, packs beside the pressure law."""

import numpy as np
import pytest

from unitcell3d.cases import biaxial_and_platens, stack

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
        PRESSURE * s720.weave.cell_area, history["F_plate"].mean(axis=1), 2 * history["plates"]
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
