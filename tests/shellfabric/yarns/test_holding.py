"""The friction that holds yarns: a range for a family of noses, from bisections, and what the check says of it."""

from dataclasses import replace

import pytest

from fabrics import catalogue
from fabrics.assumed import friction_between_yarns
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane import quality
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.holding import (
    BISECTIONS,
    find_factors,
    friction_of_plies,
    friction_to_hold,
)
from shellfabric.yarns.model import YarnZone, aim

SPHERE = Projectile(mass=0.69e-3, radius=2.78e-3, shape="sphere")
FLAT = Projectile(mass=0.69e-3, radius=2.78e-3)
PINNED = ImpactSetup(
    catalogue.load("S-726"), 45.0, projectile=SPHERE, opening=0.04, symmetry="whole",
    impact_point=aim(catalogue.load("S-726").weave), elements_per_crossover=1, table_size=51,
)  # fmt: skip


def check(result):
    return {one.name: one for one in result.checks}.get("friction to hold yarns")


def test_a_pinned_run_that_stops_a_nose_names_the_friction_that_this_takes():
    """Not one that is in flight; the friction that yarns have decides whether it is doubtful."""
    table = PINNED.table(kept=True)
    stopped = run_impact(replace(PINNED, end_time=250e-6), table=table)
    assert stopped.outcome == "stopped"
    found = check(stopped)
    ratio = (45.0 / 8165.0) ** (2 / 3)
    assert found.value == pytest.approx(find_factors("round")[1] * ratio, rel=1e-3)
    assert not found.doubtful
    assert "by the fabric 0.088 to 0.15; theirs is 0.2" in found.meaning
    flying = run_impact(replace(PINNED, end_time=20e-6), table=table)
    assert check(flying) is None
    slippery = replace(PINNED, yarn_friction=0.12, end_time=250e-6)
    assert check(run_impact(slippery, table=table)).doubtful


@pytest.mark.parametrize(
    "theirs, status", [(0.05, "doubtful"), (0.15, "doubtful"), (0.21, "noted"), (0.3, "noted")]
)
def test_the_check_is_doubtful_up_to_the_end_of_the_range(theirs, status):
    """Below the range the nose passes, inside it is not known."""
    (found,) = quality.judge_friction((0.1, 0.2), theirs)
    assert (found.value, found.limit, found.status) == (0.2, theirs, status)
    assert quality.judge_friction(None, theirs) == []


def test_the_range_of_a_family_encloses_its_bisections():
    ends = {}
    for family, rows in BISECTIONS.items():
        low, high = find_factors(family)
        for row in rows:
            ratio = (row["velocity"] / row["wave_speed"]) ** (2 / 3)
            assert low * ratio <= row["passes"] * (1 + 1e-12)
            assert row["passes"] < row["stops"] <= high * ratio * (1 + 1e-12)
        ends[family] = low, high
    assert ends["flat"] == pytest.approx((1.93, 3.09), abs=0.01)
    assert ends["round"] == pytest.approx((2.83, 4.85), abs=0.01)
    assert find_factors(None) == (ends["flat"][0], ends["round"][1])


def test_the_friction_that_holds_yarns_by_nose_and_ply():
    panel = PINNED.panel(PINNED.plain_table())
    wide = replace(panel, projectile=replace(SPHERE, radius=8e-3))
    assert friction_to_hold(wide, 110.0) is None
    flat = replace(panel, projectile=FLAT)
    chisel = replace(
        panel,
        projectile=Projectile(
            mass=0.69e-3, radius=2.78e-3, shape="chisel", flat_width=2.6e-3, flat_angle=0.61
        ),
    )
    for one, family in ((panel, "round"), (flat, "flat"), (chisel, None)):
        found = friction_to_hold(one, 110.0)
        assert found == pytest.approx(
            [k * (110 / 8165) ** (2 / 3) for k in find_factors(family)], rel=1e-4
        )
        assert friction_to_hold(one, 2**1.5 * 110.0) == pytest.approx([2 * mu for mu in found])
    # the case friction-rule-sphere passes with 0.2
    assert friction_to_hold(panel, 110.0)[1] > 0.2
    # of a pack, the ply that asks for most
    assert friction_of_plies((wide, flat, panel), 110.0) == friction_to_hold(panel, 110.0)
    assert friction_of_plies((wide, wide), 110.0) is None


def test_the_checks_of_pinned_yarns_assume_the_friction_of_resolved_ones():
    """Pinned ones of each fibre family, one that is given, and resolved ones without a fabric."""
    usual = friction_between_yarns()
    assert YarnZone().friction == quality.CHECKS["friction to hold yarns"].limit == usual.value
    assert YarnZone().friction_range == (usual.low, usual.high)
    assert YarnZone(friction=usual.value).friction_range == ()
    slippery = replace(catalogue.load("S-728"), family="UHMWPE")
    for fabric, own in ((catalogue.load("S-728"), usual.value), (slippery, 0.12)):
        setup = replace(PINNED, fabric=fabric)
        assert setup.panel().friction_between_yarns == own
        (found,) = quality.judge_friction((0.08, 0.17), setup.panel().friction_between_yarns)
        assert (found.limit, found.note) == pytest.approx((own, 0.75 * own))
        assert found.doubtful == (own == 0.12)
    assert replace(PINNED, yarn_friction=0.17).panel().friction_between_yarns == 0.17


@pytest.mark.slow
@pytest.mark.parametrize(("name", "velocity"), [("S-728", 96.0), ("S-720", 90.0)])
def test_with_the_friction_of_the_range_resolved_yarns_stop_a_nose_as_pinned_ones_do(
    name, velocity
):
    """With the upper end of the range; with the lower one they let it pass."""
    fabric = catalogue.load(name)
    cylinder = Projectile(mass=3e-3, radius=2.75e-3, edge_radius=0.3e-3)
    setup = ImpactSetup(
        fabric, velocity, projectile=cylinder, opening=0.203, symmetry="whole", end_time=700e-6,
        impact_point=aim(fabric.weave),
    )  # fmt: skip
    table = setup.table(kept=True)
    outcomes = []
    for friction in friction_to_hold(setup.panel(table), velocity):
        resolved = replace(setup, crossovers=YarnZone(friction=friction))
        outcomes.append(run_impact(resolved, table=table).outcome)
    assert outcomes == ["perforated", "stopped"]
