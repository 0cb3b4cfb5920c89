"""Fibres that fail: the strength of a yarn, what is left of it, and that nothing comes back."""

from dataclasses import replace

import numpy as np
import pytest

from meshing import crossover as mesher
from unitcell3d import cases_path, cases_yarn
from unitcell3d.fibres import FADE, Fibres
from unitcell3d.model import Numerics


def straightened(mesh, crimp=1e-9):
    """A crossover whose yarns are straight: every vertical section moved to one level."""
    points = mesh.points.copy()
    for grid in mesh.grids:
        points[grid, 2] -= points[grid][..., 2].mean(axis=2, keepdims=True)
    return replace(mesh, points=points, S0=tuple(2 * w * (1 + crimp) for w in mesh.w))


def test_straight_yarn_breaks_at_its_strength_and_holds_nothing_afterwards(tiny, s720):
    """Peak E A_s e_f within 0.1 %; afterwards the fraction of slack fibres and the solid's E_a are left."""
    yarn = s720.weave.warp
    record = cases_yarn.pull(straightened(tiny), s720, failure=True, rows=8)
    assert record.failed == ""
    peak = record["T"].max()
    assert peak == pytest.approx(yarn.failure_strain * yarn.E * yarn.A_s, rel=1e-3)
    after = record["T"][record["broken"] > 0]
    assert after.size
    assert after.max() < 5e-3 * peak
    assert record["broken"][-1] == 1
    # what the yarn had stored is gone: the work up to the peak against what the last state could give back
    stored = 0.5 * peak * record["d"][np.argmax(record["T"])]
    assert 0.5 * after[-1] * record["d"][-1] < 0.01 * stored
    whole = cases_yarn.pull(straightened(tiny), s720, rows=4)
    assert whole["T"][-1] == pytest.approx(peak, rel=2e-3)
    assert np.all(whole["broken"] == 0)


def test_crimped_yarn_breaks_where_its_worst_fibre_fails(tiny, s720):
    """The worst bar fails first, at 1 % less than the strength of the straight yarn: straightening bends it."""
    record = cases_yarn.pull(tiny, s720, failure=True, rows=12)
    peak = int(np.argmax(record["T"]))
    # of the bars that are still whole there
    assert record["fibre_strain_max"][peak] == pytest.approx(s720.weave.warp.failure_strain, rel=2e-3)
    assert 0.97 < record["T"][peak] / s720.weave.warp.strength < 1
    assert record["T"][-1] < 0.01 * record["T"][peak]


def test_damage_grows_from_the_failure_strain_and_never_heals(tiny, s720):
    fibres = Fibres(tiny, s720, failure=True)
    limit = s720.weave.warp.failure_strain
    for strain, damage in ((0.99 * limit, 0), (limit * (1 + 0.4 * FADE), 0.4), (0.0, 0.4), (limit * (1 + FADE), 1)):
        x = tiny.points * (1 + strain)
        fibres.fail(x)
        assert fibres.damage == pytest.approx(damage, abs=1e-6)
    numerics = Numerics()
    intact = Fibres(tiny, s720).stiffness(numerics)
    assert fibres.stiffness(numerics) == pytest.approx(numerics.slack_stiffness * intact)
    assert not Fibres(tiny, s720).fail(2 * tiny.points)


def test_the_most_overstrained_fail_first(tiny, s720):
    """A bar that is overstrained by less than half as much as the worst waits for the next equilibrium."""
    fibres = Fibres(tiny, s720, failure=True)
    limit = s720.weave.warp.failure_strain
    x = tiny.points.copy()
    low, high = tiny.grids[0][0], tiny.grids[0][1]
    x[high] = x[low] + (x[high] - x[low]) * (1 + limit * (1 + 0.3 * FADE))
    x[high[0]] = x[low[0]] + (tiny.points[high[0]] - tiny.points[low[0]]) * (1 + limit * (1 + FADE))
    assert fibres.fail(x)
    assert set(np.round(fibres.damage, 6)) == {0.0, 1.0}


@pytest.mark.slow
def test_tension_of_a_crossover_drops_where_its_fibres_fail(s720):
    mesh = mesher.build(s720, size=(4, 3, 2))
    reach = [(60e-6, 60e-6)]
    record = cases_path.along(mesh, s720, reach, failure=True)
    peak = int(np.argmax(record["T1"] + record["T2"]))
    assert 0 < peak < len(record["T1"]) - 1
    assert record["broken"][peak].max() < 0.05
    assert record["T1"][-1] + record["T2"][-1] < 0.6 * (record["T1"][peak] + record["T2"][peak])
