"""One yarn pulled through held crossings: plateau, front of slip, wave speed, energy, and the ends of the yarn."""

import numpy as np
import pytest

from shellfabric.cell.model import CellModel
from shellfabric.coupon import pull_out
from shellfabric.coupon.pull_out import PullOut
from shellfabric.panel.numerics import Numerics
from shellfabric.sliding import contact_force
from shellfabric.sliding.model import CrossoverFriction

NUMERICS = Numerics(threads=1)


@pytest.fixture(scope="module")
def table(straight):
    """Straight yarns that press on one another nowhere."""
    return CellModel(straight(1.0), cell_model="decoupled").table(41)


@pytest.fixture(scope="module")
def crimped(tables):
    return tables["variational"]


def pulled(
    table, n, threshold, end=60e-6, velocity=2.0, numerics=NUMERICS, interval=1e-6, **others
):
    friction = CrossoverFriction(mu=others.pop("mu", 0.0), cohesion=threshold)
    coupon = PullOut(table, n, velocity, friction=friction, numerics=numerics, **others)
    return pull_out.run(coupon, end, interval=interval)


def arrival(n, fabric):
    """[s] a longitudinal wave over n spacings of a free yarn."""
    yarn = fabric.weave.warp
    return n * 2 * fabric.weave.w1 / (yarn.EA / yarn.linear_density) ** 0.5


@pytest.mark.parametrize(("n", "threshold"), [(10, 0.5), (20, 0.5), (20, 2.0), (10, 5.0)])
def test_all_crossings_slide_at_their_threshold(table, n, threshold):
    found = pulled(table, n, threshold, end=200e-6)
    late = found.time > 100e-6
    assert found.sliding[-1] == n
    # the yarn still rings: the mean is the plateau
    assert found.load[late].mean() == pytest.approx(n * threshold, rel=0.03)
    assert found.energy_error < 0.005


def test_the_front_of_slip_travels_at_the_wave_speed_of_a_free_yarn(table):
    found = pulled(table, 100, 0.0, end=18e-6, together=True, interval=1e-7)
    reached = [found.time[np.argmax(found.sliding >= n)] for n in (25, 75)]
    expected = arrival(50, table.model.fabric)
    assert reached[1] - reached[0] == pytest.approx(expected, rel=0.03)
    assert found.sliding[-1] == 100


@pytest.mark.parametrize(("together", "stiffness"), [(True, 1.0), (False, 0.75)])
def test_the_load_before_the_front_has_come_back_is_that_of_an_infinite_yarn(
    table, together, stiffness
):
    """sqrt(EA rho) V. One yarn alone has 3/4 of its stiffness, see PullOut."""
    yarn = table.model.fabric.weave.warp
    found = pulled(table, 100, 0.0, end=12e-6, together=together)
    assert found.load[-1] == pytest.approx(
        2.0 * (stiffness * yarn.EA * yarn.linear_density) ** 0.5, rel=0.003
    )


def test_nothing_slides_where_the_threshold_is_infinite(table):
    found = pulled(table, 10, np.inf, end=1e-6)
    assert found.sliding[-1] == 0


def test_the_load_falls_as_the_tail_leaves_the_crossings(table):
    n, threshold, velocity = 8, 2.0, 20.0
    side = 2 * table.model.fabric.weave.w1
    found = pulled(table, n, threshold, end=5.2 * side / velocity, velocity=velocity)
    moved = found.displacement / side
    plateau = [found.load[(moved > a) & (moved < a + 0.5)].mean() for a in (0.9, 2.9, 4.6)]
    left = [
        np.floor(a + 0.5) for a in (0.9, 2.9, 4.6)
    ]  # half a spacing of tail, and one more a crossing
    expected = [threshold * (n - lost) for lost in left]
    assert plateau == pytest.approx(expected, rel=0.02)
    assert found.energy_error < 0.005


@pytest.mark.parametrize("mu", [0.1, 0.2])
def test_each_crossing_adds_its_cohesion_and_mu_times_the_contact_force_of_its_cell(crimped, mu):
    """From crossing to crossing T' = T + c0 + mu F_c, F_c of the cell at the mean stretch of the two segments."""
    n, cohesion, model = 10, 0.1, crimped.model
    found = pulled(crimped, n, cohesion, end=200e-6, mu=mu, together=True).load[100:].mean()
    stretch = np.linspace(0.95, 1.01, 601)
    cell = model.solve(stretch, np.ones_like(stretch))
    tension, force = cell["T1"], cell["F"]
    load, x = 0.0, np.interp(0.0, tension, stretch)
    for _ in range(n):
        ahead = x
        for _ in range(50):
            after = load + cohesion + mu * np.interp(0.5 * (x + ahead), stretch, force)
            ahead = np.interp(after, tension, stretch)
        load, x = after, ahead
    assert found == pytest.approx(load, rel=0.1)


def test_a_yarn_without_tension_is_not_held_by_stretched_crossing_yarns(crimped):
    """What the flexible yarns of the cell leave out: the load of a real yarn begins with their bending stiffness."""
    found = pulled(crimped, 16, 0.0, end=150e-6, mu=0.2, pre_tension=20.0, velocity=0.5)
    assert found.load[-1] < 0.05 * found.load[0]


def test_the_contact_force_of_flexible_yarns_is_that_of_the_cell(crimped):
    """As the limit of a small bending stiffness, but where both yarns are slack."""
    model, stretch = crimped.model, np.linspace(0.99, 1.03, 9)
    expected = model.solve(*np.meshgrid(stretch, stretch, indexing="ij"))["F"]
    found = contact_force.contact_forces(
        model, (1e-13, 1e-13), stretch, stretch, 2.0 * expected.max()
    )
    assert found == pytest.approx(expected, abs=2e-3 * expected.max())
    assert contact_force.stiff_table(crimped, (0.0, 0.0)) is crimped.values["F"]


def test_a_yarn_without_tension_is_pressed_on_by_its_bending_stiffness(crimped):
    """Rigid yarns: K (h - h0) of the slack warp equals what the tension of the weft gives, T dS/dh = pi / 4 F."""
    model, B = crimped.model, 1e-6
    stretch = np.array([1.002])
    force = contact_force.contact_forces(model, (B, 0.0), np.array([0.97]), stretch, 100.0)[0, 0]
    warp, weft = model.yarn_tuples
    stiffness = B * np.pi**4 / (16 * warp[0] ** 3)
    lift = np.pi / 4 * force / stiffness
    fall = weft[3] - contact_force.heights(weft, 0.0, stretch, np.array([force]))[0, 0]
    pressed = sum(contact_force.compression(yarn, np.array([force]))[0] for yarn in (warp, weft))
    assert force > 0.01
    assert lift == pytest.approx(fall - pressed, rel=0.05)


def test_a_pre_tension_holds_a_yarn_that_resists_bending(crimped):
    friction = CrossoverFriction(0.2, 0.0, (1e-6, 1e-6))
    found = [
        pull_out.run(PullOut(crimped, 10, 2.0, tension, friction, NUMERICS), 300e-6)
        .load[200:]
        .mean()
        for tension in (0.0, 2.5, 5.0)
    ]
    assert abs(found[0]) < 0.1 * found[1]
    assert found[1] > 0.15
    assert found[2] > 1.3 * found[1]
