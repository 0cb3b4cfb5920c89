"""Fibres that fail: the strength of a yarn, what is left of it, and that nothing comes back."""

from dataclasses import replace

import numpy as np
import pytest

from unitcell3d.cases import load_path
from unitcell3d.cases import single_yarn as cases_single_yarn
from unitcell3d.material.fibres import FADE, LARGEST_RISE, Fibres
from unitcell3d.model.crossover import Numerics


def straightened(mesh, crimp=1e-9):
    """A crossover whose yarns are straight: every vertical section moved to one level."""
    points = mesh.points.copy()
    for grid in mesh.grids:
        points[grid, 2] -= points[grid][..., 2].mean(axis=2, keepdims=True)
    return replace(mesh, points=points, S0=tuple(2 * w * (1 + crimp) for w in mesh.w))


def test_straight_yarn_breaks_at_its_strength_and_holds_nothing_afterwards(tiny, s720):
    """Peak E A_s e_f within 0.1 %; afterwards the fraction of slack fibres and the solid's E_a are left."""
    yarn = s720.weave.warp
    record = cases_single_yarn.pull(straightened(tiny), s720, failure=True, rows=8)
    assert record.failed == ""
    peak = record["T"].max()
    assert peak == pytest.approx(yarn.failure_strain * yarn.E * yarn.A_s, rel=1e-3)
    after = record["T"][record["broken"] > 0.5]
    assert after.size
    assert after.max() < 5e-3 * peak
    assert record["broken"][-1] == 1
    # what the yarn had stored is gone: the work up to the peak against what the last state could give back
    stored = 0.5 * peak * record["d"][np.argmax(record["T"])]
    assert 0.5 * after[-1] * record["d"][-1] < 0.01 * stored
    whole = cases_single_yarn.pull(straightened(tiny), s720, rows=4)
    assert whole["T"][-1] == pytest.approx(peak, rel=2e-3)
    assert np.all(whole["broken"] == 0)


def test_crimped_yarn_breaks_where_its_worst_fibre_fails(tiny, s720):
    """The worst bar fails first, at 1 % less than the strength of the straight yarn: straightening bends it."""
    record = cases_single_yarn.pull(tiny, s720, failure=True, rows=12)
    peak = int(np.argmax(record["T"]))
    # of the bars that are still whole there
    assert record["fibre_strain_max"][peak] == pytest.approx(
        s720.weave.warp.failure_strain, rel=2e-3
    )
    assert 0.97 < record["T"][peak] / s720.weave.warp.strength < 1
    assert record["T"][-1] < 0.01 * record["T"][peak]


def test_damage_grows_from_the_failure_strain_and_never_heals(tiny, s720):
    fibres = Fibres(tiny, s720, failure=True)
    limit = s720.weave.warp.failure_strain
    for strain, damage in (
        (0.99 * limit, 0),
        (limit * (1 + 0.4 * FADE), 0.4),
        (0.0, 0.4),
        (limit * (1 + FADE), 1),
    ):
        x = tiny.points * (1 + strain)
        before = fibres.damage.copy()
        while fibres.fail(x):
            assert (fibres.damage - before).max() <= LARGEST_RISE + 1e-12
            before = fibres.damage.copy()
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
    low = tiny.grids[0][0]
    high = tiny.grids[0][1]
    x[high] = x[low] + (x[high] - x[low]) * (1 + limit * (1 + 0.3 * FADE))
    x[high[0]] = x[low[0]] + (tiny.points[high[0]] - tiny.points[low[0]]) * (1 + limit * (1 + FADE))
    assert fibres.fail(x)
    assert set(np.round(fibres.damage, 6)) == {0.0, LARGEST_RISE}


@pytest.fixture(scope="module")
def broken_run(tiny, s720):
    """(record, Fibres at its end) of a crossover that is pulled until both yarns have failed."""
    held = []
    of_run = Fibres.broken

    def broken(fibres):
        held[:] = [fibres]
        return of_run(fibres)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Fibres, "broken", broken)
        record = load_path.along(tiny, s720, [(40e-6, 40e-6)], failure=True)
    return record, held[0]


@pytest.fixture(scope="module")
def broken_crossover(broken_run):
    return broken_run[0]


def test_the_yarns_of_a_crossover_break_one_after_the_other(broken_crossover, s720):
    """The weft first; the warp, no longer bent over it, loses tension, is pulled straight and breaks by itself."""
    record = broken_crossover
    assert record.failed == ""
    T1 = record["T1"]
    T2 = record["T2"]
    weft = int(np.argmax(T2))
    assert T2[weft] == pytest.approx(0.96 * s720.weave.weft.strength, rel=0.02)
    assert record["fibre_strain_max"][weft, 1] == pytest.approx(0.03, rel=2e-3)
    assert T2[weft + 1 :].max() < 0.01 * T2[weft]
    assert T1[weft + 1] < 0.75 * T1[weft]
    assert record["F_c"][weft + 1] < 0.1 * record["F_c"][weft]
    warp = int(np.argmax(T1))
    assert warp > weft
    assert T1[-1] < 0.01 * T1[warp]


def test_every_fibre_of_a_broken_yarn_has_broken(broken_run, tiny):
    """A fibre goes on beyond the end as its mirror image through the thickness (a two-fold axis, theory-cell.md): one
    that breaks there is relieved here, and recoils whole.

    So the share of broken bars is no measure. Where all bars of a fibre are strained alike, which of them fail in the
    instant of the break is decided by their order: with steps of equal length the weft loses 41 of its 48 bars, since
    the fibre beneath the side breaks in one bar of its upper half; with steps equal in x it lost all 48.
    """
    record, fibres = broken_run
    intact = 0
    for yarn, grid in enumerate(tiny.grids):
        damage = fibres.damage[fibres.yarn == yarn].reshape(grid.shape[0] - 1, *grid.shape[1:])
        whole = (damage < 1).all(axis=0)
        assert not (whole & whole[:, ::-1]).any()
        # those that stayed whole are relieved, not on the way to their strength
        intact += whole.sum()
    assert intact <= 1
    assert record["fibre_strain_max"][-1].max() < 0.5 * fibres._limit.min()
    assert np.all(record["broken"][-1] > 0.8)
