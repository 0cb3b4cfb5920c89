"""The load of a pull-out as a quasi-static quantity: that of any velocity of the crosshead."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.friction.pull_out import PullOutLaw
from shellfabric.cell.model import CellModel
from shellfabric.coupon import pull_out_curve
from shellfabric.coupon.pull_out import PullOut
from shellfabric.panel.numerics import Numerics
from shellfabric.sliding.model import CrossoverFriction


@pytest.fixture(scope="module")
def table():
    return CellModel(catalogue.load("S-726").with_effective_density()).table(81)


def follow(table, velocity, cohesion=0.1, crossings=20):
    friction = CrossoverFriction(0.0, cohesion)
    coupon = PullOut(table, crossings, velocity, friction=friction, numerics=Numerics(threads=1))
    return pull_out_curve.follow(coupon, 1.5e-3)


@pytest.mark.parametrize("velocity", [0.25, 2.0, 8.0])
def test_the_peak_is_that_of_any_velocity(table, velocity):
    """20 crossovers of 0.1 N: 2 N. A crosshead that starts with all of its velocity gives 3.53 N at 8 m/s."""
    found = follow(table, velocity)
    assert found.peak == pytest.approx(2.0, rel=0.01)
    assert found.energy_error < 1e-4
    late = (found.displacement > 0.9 * found.displacement[found.left == 0].max()) & (
        found.left == 0
    )
    assert found.load[late] == pytest.approx(2.0, rel=0.01)


def test_yarns_without_crimp_do_not_ring(straight):
    table = CellModel(straight(1.0), cell_model="decoupled").table(41)
    assert follow(table, 8.0).peak == pytest.approx(2.0, rel=0.01)


def test_the_law_of_a_crossover_comes_back_from_its_loads(table):
    """Loads of pulls with three thresholds, c0 + mu F_c, over the crossovers, at known contact forces."""
    forces = np.array([0.0, 1.0, 3.0])
    thresholds = [follow(table, 2.0, 0.1 + 0.2 * F, 10).peak / 10 for F in forces]
    law = PullOutLaw.fit(forces, thresholds)
    assert (law.c0, law.mu_eff) == pytest.approx((0.1, 0.2), rel=0.02)
