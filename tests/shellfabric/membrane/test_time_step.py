"""How much of the bound on the time step is taken: taut fabric and rings take less."""

import pytest
from panels import make_panel, table

from shellfabric.cell.model import CellModel
from shellfabric.membrane import time_step
from shellfabric.membrane.numerics import Numerics
from validation.models import variants as comparison


def test_without_viscosity_a_ring_is_followed():
    shares = [time_step.share(table(), xi) for xi in (0.0, 0.001, 0.0025, 0.1)]
    assert shares[0] < shares[1] < shares[2] == shares[3] == 1.0
    assert shares[0] <= 1.22 / 0.9 / 1.5


def test_taut_cloth_is_distinguished_from_crimped():
    straight = CellModel(
        comparison.with_straight_yarns(table().model.fabric), cell_model="decoupled"
    ).table(26)
    assert straight.tautness() > 0.95
    assert table().tautness() < 0.35
    assert time_step.share(straight, 0.1) == time_step.share(straight, 0.0) == pytest.approx(0.965)


@pytest.mark.parametrize(
    "changes", [{"cell_formulation": "equilibrium"}, {"numerics": Numerics(stretch_viscosity=0.0)}]
)
def test_the_contact_is_no_stiffer_for_a_shorter_step(changes):
    """A shorter step is taken than of the usual panel, whose contact has the stiffness of its own."""
    panel = make_panel(**changes)
    usual = make_panel()
    const = panel.constants()
    other = usual.constants()
    assert const.dt < 0.99 * panel.step_of_bound
    per_step = (usual.step_of_bound / panel.step_of_bound) ** 2
    assert const.point_law.stiffness == pytest.approx(
        per_step * other.point_law.stiffness, rel=1e-12
    )
