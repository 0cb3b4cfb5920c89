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
    "changes",
    [
        {"cell_formulation": "equilibrium"},
        {"numerics": Numerics(stretch_viscosity=0.0)},
        {"numerics": Numerics(cfl=0.45)},
        {"elements_per_crossover": 6},
    ],
    ids=str,
)
def test_the_nose_presses_on_half_a_ply_of_solid_fibre_whatever_the_step(changes):
    """On every mesh: both families in series, each E_c times its fibre's density over its mass, on half of it."""
    panel = make_panel(**{"elements_per_crossover": 4} | changes)
    usual = make_panel(elements_per_crossover=4)
    const = panel.constants()
    other = usual.constants()
    assert const.dt < 0.99 * other.dt
    weave = panel.weave
    mass_of_families = [
        length * yarn.linear_density / weave.cell_area
        for length, yarn in zip(weave.S0, weave.yarns)
    ]
    E_c = panel.fabric.solid_laws[0].E_c
    give = sum(mass / yarn.fibre_density for mass, yarn in zip(mass_of_families, weave.yarns)) / E_c
    for one in (const, other):
        area = one.dx * one.dy / one.points_per_side**2
        assert one.point_law.stiffness / area == pytest.approx(2 / give, rel=1e-9)
        per_area = one.point_law.damping / area
        assert per_area == pytest.approx((2 / give * weave.areal_density) ** 0.5, rel=1e-9)


def test_the_contact_is_no_stiffer_than_the_step_bears():
    usual = make_panel(elements_per_crossover=4).constants()
    stiff = make_panel(elements_per_crossover=4, numerics=Numerics(nose_stiffness=1e3)).constants()
    law = stiff.point_law
    assert law.stiffness > usual.point_law.stiffness
    # as much at half of the step
    half = make_panel(
        elements_per_crossover=4, numerics=Numerics(nose_stiffness=1e3, cfl=0.45)
    ).constants()
    assert law.stiffness == half.point_law.stiffness
    assert law.stiffness * stiff.dt**2 / law.mass < 0.7
