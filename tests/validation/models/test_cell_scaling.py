"""The effective stretch against cells solved with the changed length of yarn."""

import numpy as np
import pytest

from shellfabric.cell.model import CellModel
from validation.models.cell_scaling import QUANTITIES, errors, scaled, solved


def test_a_straight_yarn_that_presses_on_nothing_is_exact(straight):
    model = CellModel(straight(1.0), cell_model="decoupled")
    found = errors(model, [0.5, 0.9, 1.0, 1.2], np.linspace(0.001, 0.03, 7))
    assert found == pytest.approx(np.zeros_like(found), abs=1e-12)


def test_nothing_changes_at_the_length_at_rest(fabric):
    model = CellModel(fabric)
    stretch = np.linspace(0.98, 1.05, 15)
    exact = solved(model, stretch, 1.0, 1.0)
    table = scaled(model, stretch, 1.0, 1.0)
    for name in set(QUANTITIES) - {"C1"}:
        assert table[name] == pytest.approx(exact[name], rel=1e-12, abs=1e-12)


def test_the_error_is_of_first_order_in_the_yarn_gained(fabric):
    model = CellModel(fabric)
    strains = np.linspace(-0.01, 0.03, 17)
    small, large = errors(model, [0.99, 0.98], strains)[:, [0, 1, 2, 4]]
    assert np.all(small < 0.6 * large)
    assert np.all(large < 0.01)  # of the strength, at 2 %


def test_the_configurational_force_is_the_derivative_of_the_energy(fabric):
    model = CellModel(fabric)
    share = 0.97
    step = 1e-6
    stretch = np.array([1.0, 1.02, 1.04])
    for source in (solved, scaled):
        high, low = (source(model, stretch, 1.0, share + sign * step)["W"] for sign in (1, -1))
        expected = -(high - low) / (2 * step) / (2 * fabric.weave.w1)
        assert source(model, stretch, 1.0, share)["C1"] == pytest.approx(
            expected, rel=1e-4, abs=1e-4
        )
