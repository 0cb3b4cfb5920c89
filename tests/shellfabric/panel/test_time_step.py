"""How much of the bound on the time step is taken: what is usual keeps its step, and no contact is stiffer for it."""

import pytest

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.panel import time_step as panel_time_step
from shellfabric.panel.model import Numerics, Panel
from validation.models import variants as comparison

FABRIC = catalogue.load("S-720").with_effective_density()


def panel(form="variational", viscosity=Numerics.stretch_viscosity, **choices):
    table = CellModel(FABRIC, form=form, **choices).table(26)
    return Panel(table, (0.05, 0.05), numerics=Numerics(stretch_viscosity=viscosity))


def bound(panel):
    xi = panel.numerics.stretch_viscosity
    return panel.numerics.cfl * panel.critical_step * ((1 + xi**2) ** 0.5 - xi)


def test_without_viscosity_a_ring_is_followed():
    shares = [panel_time_step.share(panel().table, xi) for xi in (0.0, 0.001, 0.0025, 0.1)]
    assert shares[0] < shares[1] < shares[2] == shares[3] == 1.0
    assert shares[0] <= 1.22 / 0.9 / 1.5


def test_taut_cloth_is_distinguished_from_crimped():
    straight = CellModel(comparison.with_straight_yarns(FABRIC), model="decoupled").table(26)
    assert straight.tautness() > 0.95
    assert panel().table.tautness() < 0.35
    assert panel_time_step.share(straight, 0.1) == panel_time_step.share(straight, 0.0) == pytest.approx(0.965)


def test_the_contact_is_no_stiffer_for_a_shorter_step():
    for one in (panel("equilibrium"), panel(viscosity=0.0)):
        const, mass = one.constants(), one.weave.areal_density * one.spacing[0] * one.spacing[1]
        assert const.dt < bound(one)
        whole = const.point_law.stiffness * const.points_per_side**2
        assert whole == pytest.approx(Numerics.penalty * mass / bound(one) ** 2, rel=1e-12)
