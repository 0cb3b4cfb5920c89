"""Discretisation uncertainty from a pair of meshes."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.panel.boundary import Grip
from weavecell.analysis import discretisation
from weavecell.report import chapters_discretisation as chapters


@pytest.fixture(scope="module")
def setup():
    fabric = catalogue.load("S-720").with_effective_density()
    return ImpactSetup(fabric, 40.0, opening=0.06, end_time=120e-6, table_size=51, audit_interval=20e-6)


@pytest.fixture(scope="module")
def table(setup):
    return setup.table()


def test_index_of_a_result_of_second_order():
    """phi = 1 + h^2: the interval of the coarser of two meshes holds the limit with the safety factor of 3."""
    coarse, fine = 1 + 0.2**2, 1 + 0.1**2
    assert discretisation.index(coarse - fine) == pytest.approx(3 * 0.2**2)


def test_the_finer_mesh_has_half_the_side_near_the_impact_point(setup, table):
    finer = discretisation.finer(setup, table)
    assert finer.grading == ((discretisation.REACH, 0.5), (inf, 1.0))
    assert finer.panel(table).spacing[0] == pytest.approx(0.5 * setup.panel(table).spacing[0])
    graded = replace(setup, grading=((8, 1), (inf, 2)))
    assert discretisation.finer(graded, table).grading == ((8.0, 0.5), (inf, 2.0))
    assert discretisation.finer(replace(setup, elements_per_crossover=2), table).grading[0][1] == 0.25
    (near, side), *outside = replace(setup, plies=2).meshed.grading
    pack = discretisation.finer(replace(setup, plies=2), table)
    assert (pack.plies, pack.grading) == (2, ((near, side / 2), *outside))
    gripped = discretisation.finer(replace(setup, edge=Grip(50.0)), table)  # which no graded panel has
    assert (gripped.grading, gripped.elements_per_crossover) == (None, 2)
    with pytest.raises(InputError, match="--uncertainty"):
        discretisation.finer(replace(setup, elements_per_crossover=5), table)


def test_intervals_of_a_shot(setup, table):
    result = run(setup, table=table)
    finer = run(discretisation.finer(setup, table), table=table)
    pair = discretisation.compare(result, finer)
    assert pair.same_outcome
    assert pair.meshes == ("1 element per crossover", "sides of 1/2 to 10, 1 crossovers")
    found = {one.name: one for one in pair.intervals}
    assert found["residual velocity"].value == pytest.approx(result.residual_velocity)
    assert found["absorbed energy"].value == pytest.approx(
        result.strike_energy * (1 - (result.residual_velocity / 40.0) ** 2)
    )
    assert found["peak tension, warp"].value == result.peak_tension[0]
    for one in pair.intervals:
        assert one.uncertainty >= (4 - 1e-12) * abs(one.finer - one.value)
    tensions = [found[f"peak tension, {family}"] for family in ("warp", "weft")]
    share = max(abs(one.finer / one.value - 1) for one in tensions)
    for one in tensions:
        assert one.uncertainty == pytest.approx(4 * share * one.value)
    text = chapters.summary(pair)["discretisation"]
    assert text["results"]["absorbed energy"]["uncertainty"] == found["absorbed energy"].uncertainty
    assert len(chapters.section(pair).tables) == 1


def result_of(setup, outcome, residual):
    panel = np.array([[0.0, 1e-3, residual, 0.0]])
    return SimpleNamespace(
        setup=setup, outcome=outcome, residual_velocity=residual, step_history=panel, ply_tensions=[(10.0, 20.0)],
        strike_energy=2.4,
    )  # fmt: skip


def test_residual_velocities_that_agree_by_chance_have_the_uncertainty_of_their_histories(setup):
    """v(t) of the two meshes cross at the end: 3 m/s apart before, equal then."""
    one, other = (result_of(setup, "perforated", 20.0) for _ in range(2))
    t = np.linspace(0, 1e-4, 201)
    bump = np.sin(np.pi * t / t[-1])
    for result, size in ((one, 0.0), (other, 3.0)):
        result.step_history = np.column_stack([t, 40 * t, 40 - 20 * t / t[-1] + size * bump, 0 * t])
    found = {each.name: each for each in discretisation.compare(one, other).intervals}
    assert found["residual velocity"].value == found["residual velocity"].finer == pytest.approx(20.0)
    assert found["residual velocity"].uncertainty == pytest.approx(4 * 3.0, rel=1e-3)
    assert found["absorbed energy"].uncertainty == pytest.approx(4 * 2.4 * (33**2 - 30**2) / 40**2, rel=0.02)


def test_what_a_stopped_projectile_leaves_has_no_error(setup):
    one, other = result_of(setup, "stopped", 0.0), result_of(setup, "stopped", -0.1)
    other.step_history = np.array([[0.0, 2e-3, 5.0, 0.0]])
    found = {each.name: each for each in discretisation.compare(one, other).intervals}
    assert found["residual velocity"].uncertainty == found["absorbed energy"].uncertainty == 0.0
    assert found["peak deflection"].uncertainty == pytest.approx(4 * 1.0)


def test_outcomes_that_differ_have_no_interval(setup):
    pair = discretisation.compare(result_of(setup, "stopped", 0.0), result_of(setup, "perforated", 12.0))
    assert (pair.same_outcome, pair.intervals) == (False, ())
    assert "the outcome depends on the mesh: stopped, and perforated on the finer one" in chapters.words(pair)
    assert "depends on the mesh" in chapters.section(pair).lead
