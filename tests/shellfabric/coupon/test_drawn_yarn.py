"""One yarn drawn through held crossovers: plateau, capstan, front of slip, the ends of the yarn, work, bending."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.friction.pull_out import PullOutLaw
from shellfabric.cell.model import CellModel
from shellfabric.coupon import contact_force
from shellfabric.coupon.pull_out import PullOut, follow


@pytest.fixture(scope="module")
def table(straight):
    """Straight yarns that press on one another nowhere."""
    return CellModel(straight(1.0), cell_model="decoupled").table(41)


@pytest.fixture(scope="module")
def crimped(tables):
    return tables["variational"]


@pytest.mark.parametrize("family, friction", [(None, 0.2), ("UHMWPE", 0.12), ("polyester", 0.3)])
def test_friction_that_is_not_given_is_of_the_fibre_family(table, family, friction):
    model = replace(table.model, fabric=replace(table.model.fabric, family=family))
    coupon = PullOut(replace(table, model=model), 10)
    assert coupon.friction == friction
    assert coupon.assumed_friction.low < friction < coupon.assumed_friction.high
    assert PullOut(replace(table, model=model), 10, mu=0.17).friction == 0.17


@pytest.mark.parametrize("n, threshold", [(1, 2.0), (10, 0.5), (20, 2.0)])
def test_all_crossovers_slide_at_their_threshold(table, n, threshold):
    found = follow(PullOut(table, n, mu=0.0, cohesion=threshold), 0.4e-3)
    assert found.sliding[-1] == n
    assert found.plateau == pytest.approx(n * threshold, rel=1e-9)
    assert found.peak == found.plateau


def test_the_front_of_slip_follows_the_shear_lag_of_a_straight_yarn(table):
    """Friction f a crossover, n of them slide under the load n f: the yarn there has stretched by the sum of the
    strains j f / EA, j = 1 .. n, over a spacing each, which the crosshead has moved."""
    warp = table.model.fabric.weave.warp
    n = 40
    f = 0.5
    coupon = PullOut(table, n, mu=0.0, cohesion=f)
    at = 20 * 21 / 2 * f / warp.EA * coupon.spacing
    found = follow(coupon, at, samples=1)
    assert found.load[-1] == pytest.approx(20 * f, rel=0.02)
    assert found.sliding[-1] in (19, 20)


def test_the_load_falls_as_the_tail_leaves_the_crossovers(table):
    n = 8
    threshold = 2.0
    coupon = PullOut(table, n, mu=0.0, cohesion=threshold)
    found = follow(coupon, 9.5 * coupon.spacing, samples=950)
    # half a spacing of tail, and one more a crossover
    for spacings, left in ((0.3, 0), (0.9, 1), (2.9, 3), (4.6, 5), (7.9, 8), (9.0, 8)):
        sample = round(100 * spacings)
        assert found.left[sample] == left
        assert found.load[sample] == pytest.approx(threshold * (n - left), rel=1e-6)


def test_no_yarn_is_lost_as_its_end_leaves_crossovers(table):
    """Under a load of up to two thirds of the strength: the end leaves a crossover when the crosshead has all of the
    yarn but the pieces ahead, stretched by the friction behind each."""
    n = 8
    warp = table.model.fabric.weave.warp
    threshold = warp.strength / 12
    coupon = PullOut(table, n, mu=0.0, cohesion=threshold)
    found = follow(coupon, 9 * coupon.spacing, samples=9000)
    for gone in range(1, n):
        at = found.displacement[np.argmax(found.left == gone)]
        pieces = 1 / (1 + threshold * np.arange(1, n - gone + 2) / warp.EA)
        wanted = n + 0.5 - pieces.sum()
        assert at / coupon.spacing == pytest.approx(wanted, abs=2e-3), gone


@pytest.mark.parametrize("mu", [0.1, 0.2])
def test_each_crossover_adds_its_cohesion_and_mu_times_the_contact_force_of_its_cell(crimped, mu):
    """From crossover to crossover T' = T + c0 + mu F_c, F_c of the cell at the mean stretch of the two segments."""
    n = 10
    cohesion = 0.1
    model = crimped.model
    found = follow(PullOut(crimped, n, mu=mu, cohesion=cohesion), 0.5e-3).plateau
    stretch = np.linspace(0.95, 1.01, 6001)
    cell = model.solve(stretch, np.ones_like(stretch))
    tension = cell["T1"]
    force = cell["F"]
    slack = np.flatnonzero(tension <= 0)[-1]
    load = 0.0
    x = None
    for _ in range(n):
        ahead = stretch[slack] if x is None else x
        for _ in range(50):
            about = ahead if x is None else 0.5 * (x + ahead)
            after = load + cohesion + mu * np.interp(about, stretch, force)
            ahead = np.interp(after, tension[slack:], stretch[slack:])
        load = after
        x = ahead
    assert found == pytest.approx(load, rel=0.02)


def test_friction_takes_the_work_of_the_crosshead_that_the_yarn_does_not_store(table):
    """Straight yarns store T^2 / 2 EA over a length."""
    warp = table.model.fabric.weave.warp
    n = 20
    threshold = 1.0
    coupon = PullOut(table, n, mu=0.0, cohesion=threshold)
    found = follow(coupon, 0.45e-3, samples=4000)
    work = np.sum(0.5 * (found.load[1:] + found.load[:-1]) * np.diff(found.displacement))
    tensions = threshold * np.arange(1, n + 1)
    stored = np.sum(tensions**2) * coupon.spacing / (2 * warp.EA)
    assert found.friction_work[-1] == pytest.approx(work - stored, rel=2e-3)


def test_the_law_of_a_crossover_comes_back_from_its_loads():
    """Loads of pulls with three thresholds, c0 + mu F_c, over the crossovers, at known contact forces."""
    table = CellModel(catalogue.load("S-726").with_effective_density()).table(81)
    forces = np.array([0.0, 1.0, 3.0])
    pulls = [PullOut(table, 10, mu=0.0, cohesion=0.1 + 0.2 * F) for F in forces]
    law = PullOutLaw.fit(forces, [follow(pull, 1.5e-3).peak / 10 for pull in pulls])
    assert (law.c0, law.mu_eff) == pytest.approx((0.1, 0.2), rel=1e-6)


def test_a_yarn_without_tension_is_not_held_by_stretched_crossing_yarns(crimped):
    """What the flexible yarns of the cell leave out: the load of a real yarn begins with their bending stiffness."""
    assert follow(PullOut(crimped, 16, 20.0, mu=0.2), 0.5e-3).peak < 1e-6


def test_a_pull_ends_where_the_yarn_breaks(crimped):
    """A capstan multiplies the load at each crossover."""
    with pytest.raises(InputError, match=r"crossings = 400: must be at most \d+ with") as refused:
        follow(PullOut(crimped, 400, mu=0.2, cohesion=0.1), 1e-3)
    most = int(str(refused.value).partition("at most ")[2].split()[0])
    assert follow(PullOut(crimped, most, mu=0.2, cohesion=0.1), 1e-3).peak > 0


def test_the_contact_force_of_flexible_yarns_is_that_of_the_cell(crimped):
    """As the limit of a small bending stiffness, except where both yarns are slack."""
    model = crimped.model
    stretch = np.linspace(0.99, 1.03, 9)
    expected = model.solve(*np.meshgrid(stretch, stretch, indexing="ij"))["F"]
    found = contact_force.contact_forces(
        model, (1e-13, 1e-13), stretch, stretch, 2.0 * expected.max()
    )
    assert found == pytest.approx(expected, abs=2e-3 * expected.max())
    assert contact_force.stiff_table(crimped, (0.0, 0.0)) is crimped.values["F"]


def test_a_yarn_without_tension_is_pressed_on_by_its_bending_stiffness(crimped):
    """Rigid yarns: K (h - h0) of the slack warp equals what the tension of the weft gives, T dS/dh = pi / 4 F."""
    model = crimped.model
    B = 1e-6
    stretch = np.array([1.002])
    force = contact_force.contact_forces(model, (B, 0.0), np.array([0.97]), stretch, 100.0)[0, 0]
    warp, weft = model.yarns
    stiffness = B * np.pi**4 / (16 * warp.w**3)
    lift = np.pi / 4 * force / stiffness
    fall = weft.h0 - contact_force.heights(weft, 0.0, stretch, np.array([force]))[0, 0]
    pressed = sum(contact_force.compression(yarn, np.array([force]))[0] for yarn in (warp, weft))
    assert force > 0.01
    assert lift == pytest.approx(fall - pressed, rel=0.05)


def test_a_pre_tension_holds_a_yarn_that_resists_bending(crimped):
    found = [
        follow(PullOut(crimped, 10, tension, mu=0.2, bending=(1e-6, 1e-6)), 0.5e-3).peak
        for tension in (0.0, 2.5, 5.0)
    ]
    assert abs(found[0]) < 0.1 * found[1]
    assert found[1] > 0.15
    assert found[2] > 1.3 * found[1]
