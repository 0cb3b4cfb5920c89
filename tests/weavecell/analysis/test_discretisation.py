"""Discretisation uncertainty from a pair of meshes."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.impact.pack import PackSetup
from shellfabric.impact.single_ply import ImpactSetup, run
from shellfabric.panel.boundary import Grip
from validation.verification import discretisation as study
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
    assert discretisation.index(coarse, fine) == pytest.approx(3 * 0.2**2)


def test_the_finer_mesh_has_half_the_side_near_the_impact_point(setup, table):
    finer = discretisation.finer(setup, table)
    assert finer.grading == ((discretisation.REACH, 0.5), (inf, 1.0))
    assert finer.panel(table).spacing[0] == pytest.approx(0.5 * setup.panel(table).spacing[0])
    graded = replace(setup, grading=((8, 1), (inf, 2)))
    assert discretisation.finer(graded, table).grading == ((8.0, 0.5), (inf, 2.0))
    assert discretisation.finer(replace(setup, elements_per_crossover=2), table).grading[0][1] == 0.25
    pack = discretisation.finer(PackSetup(setup, 2), table)
    assert (pack.plies, pack.ply.grading) == (2, finer.grading)


def test_edges_that_no_graded_panel_has_are_refined_everywhere(setup, table):
    gripped = replace(setup, edge=Grip(50.0))
    finer = discretisation.finer(gripped, table)
    assert (finer.grading, finer.elements_per_crossover) == (None, 2)


def test_a_mesh_that_cannot_be_halved_is_refused(setup, table):
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
        assert one.uncertainty == pytest.approx(4 * abs(one.finer - one.value))
        assert one.contains(one.finer)
    text = chapters.summary(pair)["discretisation"]
    assert text["results"]["absorbed energy"]["uncertainty"] == found["absorbed energy"].uncertainty
    assert len(chapters.section(pair).tables) == 1


def result_of(setup, outcome, residual):
    panel = np.array([[0.0, 1e-3, residual, 0.0]])
    return SimpleNamespace(
        setup=setup, outcome=outcome, residual_velocity=residual, step_history=panel, peak_tension=(10.0, 20.0),
        strike_energy=2.4,
    )  # fmt: skip


def test_outcomes_that_differ_have_no_interval(setup):
    pair = discretisation.compare(result_of(setup, "stopped", 0.0), result_of(setup, "perforated", 12.0))
    assert (pair.same_outcome, pair.intervals) == (False, ())
    assert "the outcome depends on the mesh: stopped, and perforated on the finer one" in chapters.words(pair)
    assert "depends on the mesh" in chapters.section(pair).lead


def test_coverage_counts_what_lies_outside():
    inside = study.Row("a", 100.0, ("stopped",) * 3, (("peak deflection", "mm", 10.0, 10.4, 0.5),), (1.0, 3.0, 9.0))
    outside = replace(inside, results=(("peak deflection", "mm", 10.0, 10.6, 0.5),))
    flipped = replace(inside, outcomes=("stopped", "stopped", "perforated"))
    undecided = replace(inside, outcomes=("stopped", "perforated", "perforated"), results=())
    assert [row.covered for row in (inside, outside, flipped, undecided)] == [True, False, False, False]
    text = study.tables([inside, outside, flipped, undecided])
    assert "| 4 | 1 | 1 of 3 | 4.0 |" in text
    assert "peak deflection: 10 ± 0.5, 10.6 mm" in text
