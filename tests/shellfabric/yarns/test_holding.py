"""The friction that holds yarns: a range for a family of noses and the friction on one, from bisections, and what the
check says of it."""

import tomllib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from fabrics import catalogue
from fabrics.assumed import friction_between_yarns
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane import quality
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns import holding
from shellfabric.yarns.holding import (
    Bisection,
    find_factors,
    friction_of_plies,
    friction_to_hold,
    read_bisections,
)
from shellfabric.yarns.model import YarnZone, aim
from validation import study

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
    assert "by the fabric 0.071 to 0.13; theirs is 0.2" in found.meaning
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


def test_the_check_is_noted_where_a_smoother_nose_would_ask_for_more_than_the_yarns_have():
    """The friction on the nose is assumed, and the run has the middle of its range."""
    for smooth, status in ((0.19, "ok"), (0.21, "noted"), (None, "ok")):
        (found,) = quality.judge_friction((0.06, 0.12), 0.2, smooth)
        assert (found.value, found.status) == (0.12, status)
    assert (
        "up to 0.21 under a smoother nose"
        in quality.judge_friction((0.06, 0.12), 0.2, 0.21)[0].text
    )
    # what is doubtful stays so
    (found,) = quality.judge_friction((0.1, 0.23), 0.2, 0.4)
    assert found.doubtful


def test_the_table_has_the_rows_of_the_study():
    """Of each shot and nose the place that asks for most."""
    _, records = study.read(study.DATA / "yarns-holding.csv")
    worst = {}
    for row in records:
        key = row["family"], row["shot"], float(row["friction on the nose"])
        stops = max(float(row["stops"]), worst.get(key, (0, 0))[1])
        if stops == float(row["stops"]):
            worst[key] = float(row["passes"]), stops
    table = tomllib.loads((Path(holding.__file__).parent / "holding.toml").read_text("utf-8"))
    listed = {
        (family, f"{row['fabric']}, {row['velocity']:.0f} m/s", row["nose_friction"]): (
            row["passes"],
            row["stops"],
        )
        for family in ("flat", "round")
        for row in table[family]
    }
    of_study = {key for key in worst if key[0] == "round"}
    assert of_study == {key for key in listed if key[0] == "round"}
    assert all(listed[key] == worst[key] for key in of_study)
    for one in read_bisections():
        assert 0 <= one.passes < one.stops


@pytest.mark.parametrize("family", ["flat", "round", None])
def test_the_range_falls_with_the_friction_on_the_nose(family):
    """Between two noses it is that of the smoother one; beyond the roughest it stays."""
    ranges = [find_factors(family, nose) for nose in (0.0, 0.02, 0.05, 0.07, 0.1, 0.3)]
    for smoother, rougher in pairwise(ranges):
        assert smoother[0] >= rougher[0]
        assert smoother[1] >= rougher[1]
    assert ranges[0] == ranges[1] == find_factors(family)
    assert ranges[-1] == ranges[-2]
    if family == "round":
        assert ranges[-2][1] < 0.8 * ranges[0][1]


def test_each_shot_asks_by_its_smoother_nose(monkeypatch):
    rows = (
        Bisection("flat", ("a", 80.0), 0.0, 1.0, 1.2),
        Bisection("flat", ("a", 80.0), 0.1, 0.6, 0.7),
        # a rougher nose that asks for more, by the width of a bracket
        Bisection("flat", ("a", 95.0), 0.0, 1.4, 1.6),
        Bisection("flat", ("a", 95.0), 0.05, 0.8, 0.9),
        Bisection("flat", ("a", 95.0), 0.1, 0.85, 0.95),
        Bisection("round", ("c", 70.0), 0.0, 2.0, 2.5),
    )
    monkeypatch.setattr(holding, "read_bisections", lambda: rows)
    factors = find_factors.__wrapped__
    assert factors("flat", 0.0) == (1.0, 1.6)
    assert factors("flat", 0.04) == (1.0, 1.6)
    # of the slower shot no nose between was bisected
    assert factors("flat", 0.06) == (0.85, 1.2)
    assert factors("flat", 0.1) == (0.6, 0.95)
    assert factors(None, 0.1) == (0.6, 2.5)


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
    rough = replace(panel, projectile=replace(SPHERE, friction=0.12))
    for one, family in ((panel, "round"), (flat, "flat"), (chisel, None)):
        found = friction_to_hold(one, 110.0)
        assert found == pytest.approx(
            [k * (110 / 8165) ** (2 / 3) for k in find_factors(family)], rel=1e-4
        )
        assert friction_to_hold(one, 2**1.5 * 110.0) == pytest.approx([2 * mu for mu in found])
    # the case friction-rule-sphere passes with 0.2
    assert friction_to_hold(panel, 110.0)[1] > 0.2
    # of its own friction on the nose, or of another
    assert friction_to_hold(rough, 110.0) == friction_to_hold(panel, 110.0, 0.12)
    assert friction_to_hold(rough, 110.0)[1] < friction_to_hold(panel, 110.0)[1]
    assert friction_to_hold(rough, 110.0, 0.0) == friction_to_hold(panel, 110.0)
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
    cylinder = Projectile(mass=3e-3, radius=2.75e-3, edge_radius=0.3e-3)
    setup = ImpactSetup(
        catalogue.load(name), velocity, projectile=cylinder, opening=0.203, symmetry="quarter",
        end_time=700e-6,
    )  # fmt: skip
    table = setup.table(kept=True)
    outcomes = []
    for friction in friction_to_hold(setup.panel(table), velocity):
        resolved = replace(setup, crossovers=YarnZone(friction=friction).whole)
        outcomes.append(run_impact(resolved, table=table).outcome)
    assert outcomes == ["perforated", "stopped"]
