"""Discretisation uncertainty from a pair of meshes."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.boundary import Grip
from weavecell.report import chapters_discretisation as chapters
from weavecell.studies import mesh_uncertainty
from weavecell.studies.mesh_uncertainty import Shot
from weavecell.studies.window import FACTORS, QUANTITIES, Window


@pytest.fixture(scope="module")
def setup(fabric):
    """One element per crossover."""
    mesh = {"elements_per_crossover": 1, "table_size": 51}
    # whole crossovers, so that no element is longer than a crossover
    opening = 48 * 2 * fabric.weave.w[0]
    return ImpactSetup(fabric, 40.0, opening=opening, end_time=120e-6, audit_interval=20e-6, **mesh)


@pytest.fixture(scope="module")
def table(setup):
    return setup.table()


def test_index_of_a_result_of_second_order():
    """phi = 1 + h^2: the interval of the coarser of two meshes holds the limit with the safety factor of 3."""
    coarse = 1 + 0.2**2
    fine = 1 + 0.1**2
    assert mesh_uncertainty.index(coarse - fine) == pytest.approx(3 * 0.2**2)


def test_the_finer_mesh_has_half_the_side_near_the_impact_point(setup, table):
    finer = mesh_uncertainty.finer(setup, table)
    assert finer.grading == ((mesh_uncertainty.REACH, 0.5), (inf, 1.0))
    assert finer.panel(table).spacing[0] == pytest.approx(0.5 * setup.panel(table).spacing[0])
    setup = replace(setup, elements_per_crossover=None)
    graded = replace(setup, grading=((8, 1), (inf, 2)))
    assert mesh_uncertainty.finer(graded, table).grading == ((8.0, 0.5), (16.0, 1.0), (inf, 2.0))
    assert (
        mesh_uncertainty.finer(replace(setup, elements_per_crossover=2), table).grading[0][1]
        == 0.25
    )
    zones = replace(setup, plies=2).meshed.grading
    pack = mesh_uncertainty.finer(replace(setup, plies=2), table)
    (near, side), *_ = zones
    assert pack.plies == 2
    assert pack.grading == ((near, side / 2), *((2 * until, side) for until, side in zones))
    # fabric from anywhere may come under the nose
    for boundary in (Grip(50.0), "free", ("clamped", "free")):
        loose = replace(setup, boundary=boundary)
        finer = mesh_uncertainty.finer(loose, table)
        assert finer.grading is None
        assert finer.elements_per_crossover == 2 * loose.meshed.elements_per_crossover
    with pytest.raises(InputError, match="uncertainty = "):
        mesh_uncertainty.finer(replace(setup, elements_per_crossover=5), table)


def test_intervals_of_a_shot(setup, table):
    result = run_impact(setup, table=table)
    finer = run_impact(mesh_uncertainty.finer(setup, table), table=table)
    pair = compared(result, finer)
    assert pair.same_outcome
    assert pair.meshes == ("1 element per crossover", "sides of 1/2 to 10, 1 crossovers")
    found = by_name(pair)
    values = [
        found[name].value for name in ("residual velocity", "absorbed energy", "peak tension, warp")
    ]
    assert values == [result.residual_velocity, result.absorbed_energy, result.peak_tension[0]]
    for one in pair.intervals:
        assert one.uncertainty >= (4 - 1e-12) * abs(one.other - one.value)
    tensions = [found[f"peak tension, {family}"] for family in ("warp", "weft")]
    share = max(abs(one.other / one.value - 1) for one in tensions)
    for one in tensions:
        assert one.uncertainty == pytest.approx(4 * share * one.value)
    text = chapters.summary(pair)["discretisation"]
    assert text["results"]["absorbed energy"]["uncertainty"] == found["absorbed energy"].uncertainty
    assert len(chapters.section(pair).tables) == 1


def compared(one, other):
    """The DiscretisationPair of two results, of which the second is of the finer mesh."""
    return mesh_uncertainty.compare(Shot(one), Shot(other))


def by_name(pair):
    return {one.name: one for one in pair.intervals}


def result_of(setup, outcome, residual):
    panel = np.array([[0.0, 1e-3, residual, 0.0]])
    return SimpleNamespace(
        setup=setup,
        outcome=outcome,
        residual_velocity=residual,
        step_history=panel,
        time=panel[:, 0],
        deflection=panel[:, 1],
        max_deflection=1e-3,
        peak_tension=(10.0, 20.0),
        strike_energy=2.4,
        absorbed_energy=1.6,
        rigidity=None,
    )


def window_of(result, *residuals):
    """Window of a made-up shot, without scatter where no residual velocities are given; None but of a perforation."""
    values = zip(FACTORS, residuals or 5 * [result.residual_velocity])
    keys = [key for key, *_ in QUANTITIES.values()]
    rows = [
        dict(zip(keys, (v, 1.0, 4)), strike_velocity_m_s=40 * f, outcome="perforated")
        for f, v in values
    ]
    return Window(40.0, tuple(rows)) if result.outcome == "perforated" else None


def test_standard_errors_of_both_meshes_add_up_as_roots_of_squares(setup):
    """Of 3 and 4 come 5; the errors stand in the order of the meshes."""
    middle = (20.0, 20.0, 20.0 + 5.0 / 4, 20.0, 20.0)  # of whose mean the standard error is known
    unit = window_of(result_of(setup, "perforated", 20.0), *middle).mean("residual_velocity")[1]
    shots = []
    for mean, error in ((20.0, 3.0), (22.0, 4.0)):
        values = mean + error / unit * (np.array(middle) - np.mean(middle))
        result = result_of(setup, "perforated", mean)
        shots.append(Shot(result, None, window_of(result, *values)))
    pair = mesh_uncertainty.compare(*shots)
    residual = pair.intervals[0]
    assert residual.uncertainty == pytest.approx(4 * 2.0 + 5.0)
    assert residual.standard_errors == pytest.approx((3, 4))
    assert (residual.value, residual.other) == pytest.approx((20, 22))
    assert pair.errors["residual_velocity"] == pytest.approx((4 * 2.0 + 5.0) / 40)


def test_means_over_a_window_replace_the_values_of_a_perforation(setup):
    """d is the difference of the means, and the standard errors are added; shots that stop on one mesh are told."""
    one, other = (result_of(setup, "perforated", 20.0) for _ in range(2))
    one = Shot(one, None, window_of(one, 20, 20, 25, 20, 20))
    other = Shot(other, None, window_of(other))
    other.window.shots[0]["outcome"] = "stopped"
    pair = mesh_uncertainty.compare(one, other)
    residual = pair.intervals[0]
    error = np.sqrt((4 * 1 + 4**2) / 3 / 5)
    assert (residual.value, residual.other, *residual.standard_errors) == pytest.approx(
        (21.0, 20.0, error, 0.0)
    )
    assert residual.uncertainty == pytest.approx(4 * 1 + error)
    assert pair.errors["residual_velocity"] == pytest.approx((4 * 1 + error) / 40)
    text = chapters.words(pair)
    assert (
        "outcomes in the window depend on the mesh: 5 perforated, and 1 stopped, 4 perforated on the finer"
        in text
    )
    assert (
        "V50 of one ply: 0 of 1 within, bias"
        in text.partition("standard error, 5 shots at 36.8 to 43.2 m/s, 5 perforated:")[2]
    )
    assert "MIXED outcomes" in chapters.words(mesh_uncertainty.compare(other, one))
    assert compared(one.result, other.result).errors["residual_velocity"] == inf


def test_residual_velocities_that_agree_by_chance_have_the_uncertainty_of_their_histories(setup):
    """v(t) of the two meshes cross at the end: 3 m/s apart before, equal then."""
    one, other = (result_of(setup, "in flight", 20.0) for _ in range(2))
    t = np.linspace(0, 1e-4, 201)
    bump = np.sin(np.pi * t / t[-1])
    for result, size in ((one, 0.0), (other, 3.0)):
        result.step_history = np.column_stack([t, 40 * t, 40 - 20 * t / t[-1] + size * bump, 0 * t])
    found = by_name(compared(one, other))
    assert (
        found["residual velocity"].value == found["residual velocity"].other == pytest.approx(20.0)
    )
    assert found["residual velocity"].uncertainty == pytest.approx(4 * 3.0, rel=1e-3)
    # of the whole projectile, whatever moves along its axis
    assert found["absorbed energy"].value == 1.6
    assert found["absorbed energy"].uncertainty == pytest.approx(
        4 * 2.4 * (33**2 - 30**2) / 40**2, rel=0.02
    )


def test_what_a_stopped_projectile_leaves_has_no_error(setup):
    one = result_of(setup, "stopped", 0.0)
    other = result_of(setup, "stopped", -0.1)
    other.step_history = np.array([[0.0, 2e-3, 5.0, 0.0]])
    other.deflection = np.array([2e-3])
    other.max_deflection = 2e-3
    found = by_name(compared(one, other))
    assert found["residual velocity"].uncertainty == found["absorbed energy"].uncertainty == 0.0
    assert found["peak deflection"].uncertainty == pytest.approx(4 * 1.0)


def test_outcomes_that_differ_have_no_interval(setup):
    pair = compared(result_of(setup, "stopped", 0.0), result_of(setup, "perforated", 12.0))
    assert not pair.same_outcome
    assert pair.intervals == ()
    said = "the outcome depends on the mesh: stopped, and perforated on the finer one"
    assert said in chapters.words(pair)


def test_the_peak_deflection_is_that_of_the_fabric(setup):
    """As max_deflection_m and the report have it, and no travel of the projectile; its norm is of these histories."""
    one = result_of(setup, "stopped", 0.0)
    other = result_of(setup, "stopped", 0.0)
    t = np.linspace(0.0, 1e-4, 5)
    for result, depths in ((one, [0, 4, 9, 8, 8]), (other, [0, 4, 10, 9, 8])):
        result.time, result.deflection = t, 1e-3 * np.array(depths)
        result.max_deflection = result.deflection.max()
        result.step_history = np.column_stack([t, 0.1 * t, 40 - t, 0 * t])
    found = by_name(compared(one, other))
    deflection = found["peak deflection"]
    assert deflection.value == pytest.approx(9.0)
    assert deflection.other == pytest.approx(10.0)
    assert deflection.uncertainty == pytest.approx(mesh_uncertainty.index(1.0))
