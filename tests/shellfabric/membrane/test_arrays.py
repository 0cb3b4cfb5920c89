"""Arrays of a panel at rest: masses, yarn, what edges hold, strengths, blocks."""

import numpy as np
import pytest
from conftest_tools import grid
from numpy.testing import assert_allclose, assert_array_equal
from panels import make_panel

from shellfabric.cell.model import CellModel
from shellfabric.membrane import criterion_kernels
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from tests import unlike

SYMMETRIES = ("quarter", "half", "whole")


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_mass_and_yarn_are_those_of_the_modelled_area(symmetry):
    """Areal density and yarns per metre times the area; nodes and yarns on rims and planes of symmetry by half."""
    panel = make_panel(symmetry=symmetry)
    const = panel.constants()
    state = panel.state(50.0)
    mass = grid(const, state.mass)
    corner = 0.25 * panel.weave.areal_density * const.dx * const.dy
    # of 24 x 24 crossovers as a whole
    area = np.prod([2 * w * 24 for w in panel.weave.w]) * panel.share
    assert state.mass.sum() == pytest.approx(panel.weave.areal_density * area, rel=1e-12)
    assert_allclose(mass[1:-1, 1:-1], 4 * corner, rtol=1e-14)
    assert_allclose(mass[[0, 0, -1, -1], [0, -1, 0, -1]], corner, rtol=1e-14)
    for count, length, intact in zip(
        (panel.weave.warp_count, panel.weave.weft_count), state.yarn_length, state.intact_fraction
    ):
        assert length.sum() == pytest.approx(count * area, rel=1e-12)
        assert_array_equal(intact, length != 0)
    assert not grid(const, state.yarn_length[0])[-1].any()
    assert not grid(const, state.yarn_length[1])[:, -1].any()
    assert const.projectile_mass == pytest.approx(panel.projectile.mass * panel.share, rel=1e-14)
    assert const.free_dofs == (*(0.0 if mirrored else 1.0 for mirrored in panel.mirrors), 1.0)


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("edge", [("clamped", "clamped"), ("free", "free"), ("clamped", "free")])
def test_held_nodes_have_no_inverse_mass(symmetry, edge):
    panel = make_panel(symmetry=symmetry, boundary=edge)
    const = panel.constants()
    state = panel.state(50.0)
    free = np.ones((const.ni + 1, const.nj + 1), bool)
    for axis, (side, mirrored) in enumerate(zip(edge, panel.mirrors)):
        if side == "clamped":
            np.moveaxis(free, axis, 0)[-1] = False
            np.moveaxis(free, axis, 0)[0] &= mirrored
    assert_allclose(
        grid(const, state.inverse_mass) * grid(const, state.mass), free, rtol=0, atol=1e-15
    )
    # beyond the panel there is nothing
    assert not state.inverse_mass[(const.ni + 1) * const.row_stride :].any()
    assert_array_equal(state.dt_over_mass, const.dt * state.inverse_mass)


def test_strength_of_each_yarn():
    factors = tuple(
        np.random.default_rng(3).uniform(0.7, 1.3, count) for count in make_panel().yarn_counts
    )
    const = make_panel(strength_factors=factors).constants()
    for lines, factor, mean, half in zip(
        (const.warp_lines, const.weft_lines),
        factors,
        make_panel().strengths,
        (const.half_strength1, const.half_strength2),
    ):
        assert_allclose(lines.strength, factor * mean, rtol=1e-15)
        assert half == 0.5 * lines.strength.min()
    assert np.isposinf(make_panel(yarn_failure=False).constants().warp_lines.strength).all()


def test_each_family_has_the_rates_of_its_own_strain_at_failure():
    """Loaded at 300 / s each is damaged to 1 at 1.15 of its strength, the weft after a larger strain than the warp."""
    table = CellModel(unlike.fabric()).table(21)
    law = make_panel(table=table, rate_dependence=True).constants().rate_law
    loads = np.linspace(0.95, 1.15, 4001)
    step = loads[1] - loads[0]
    for family, strain in enumerate((0.03, 0.0393)):
        kept = np.array([0.0, 0.0, 7.0])
        for load in 0.5 * (loads[1:] + loads[:-1]):
            kept[1] = criterion_kernels.damage.py_func(
                law, family, step * strain / 300, kept, 1, load
            )
        assert kept[1] == pytest.approx(1, rel=0.01)


@pytest.mark.parametrize("contact_points", [2, 3, 4])
def test_friction_is_kept_of_each_contact_point(contact_points):
    """However many eights their shape functions fill."""
    numerics = Numerics(threads=1, contact_points=contact_points)
    panel = make_panel(numerics=numerics, projectile=Projectile(friction=0.2))
    state = panel.state(50.0)
    points = panel.constants().points_per_side ** 2
    assert points == contact_points**2
    assert state.friction_slip.shape == (state.in_contact.size, points, 3)
    assert state.last_contact_force.shape == (points, state.in_contact.size + 8)
