"""Packs with sliding crossovers: pinned in the limit, torn plies, yarns that leave, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fabrics.base.errors import InputError
from shellfabric.plies import near_kernels
from shellfabric.plies.model import Pack
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel
from shellfabric.solver.pack_solver import PackSolver

GAP = 0.1e-3


def whole_crossovers(ply):
    """[m] an opening of about 40 mm that pinned and sliding panels of the fabric fill with the same elements."""
    return tuple(42 * 2 * w for w in ply.fabric.weave.w)


def sliding(ply, mu=0.2, **others):
    chosen = {
        "numerics": ply.numerics,
        "elements_per_crossover": 1,
        "friction": CrossoverFriction(mu),
    } | others
    return SlidingPanel(ply.table, whole_crossovers(ply), **chosen)


def pinned(ply):
    return replace(ply, opening=whole_crossovers(ply))


@pytest.mark.slow(300)
def test_an_infinite_threshold_is_the_pinned_pack_that_rubs(ply):
    held, stuck = (
        Pack.stacked(panel, 2, gap=GAP, friction=0.2)
        for panel in (pinned(ply), sliding(ply, mu=np.inf))
    )
    held, stuck = (PackSolver(pack, 60.0, 40e-6).run() for pack in (held, stuck))
    # a pinned panel divides its opening into equal sides, a sliding one takes the spacing of the weave: round-off
    for one, other in zip(held.states, stuck.states):
        assert_allclose(one.u[2], other.u[2], rtol=0, atol=1e-9 * np.abs(one.u[2]).max())
    for name in held.sample_names:
        most = np.abs(held.sample(name)).max()
        assert_allclose(held.sample(name), stuck.sample(name), atol=1e-7 * most, err_msg=name)


def test_torn_plies_are_kept_apart_by_the_forces_that_act(ply):
    """What the guard predicts is where its nodes come to."""
    run = PackSolver(Pack.stacked(sliding(ply, mu=0.1), 2, gap=GAP), 300.0, 20e-6).run()
    assert run.sample("cut_yarns")[-1] > 0
    guard = run.contact
    looked_at = 0
    for _ in range(200):
        run.advance(np.empty((1, 3)))
        nodes = guard.node_list[: guard.count[near_kernels.NODES]]
        for p, state in enumerate(run.states):
            own = nodes[nodes // guard.slots == p]
            i, j = np.divmod(own - guard.base[p], guard.shape[p, 0])
            moved = np.array(state.u)[:, i * run.consts[p].row_stride + j]
            assert_allclose(guard.rest[:, own] + moved, guard.y[:, own], rtol=0, atol=1e-14)
            looked_at += own.size
    assert looked_at > 0


@pytest.mark.parametrize("plies", [1, 2])
def test_yarns_that_have_left_count_as_failures(ply, plies):
    """A shot that perforates: the neighbour's contact looks for edges where a yarn has gone, the nose for a way out."""
    run = PackSolver(
        Pack.stacked(sliding(ply, mu=0.1, boundary="free"), plies, gap=GAP), 350.0, 60e-6
    ).run()
    gone = [summary.pulled_out_segments for summary in run.slip_summaries()]
    counted = [int(state.counter[2]) for state in run.states]
    assert all(pulled > 100 for pulled in gone)
    assert run.ply_sample("slip")[-1].tolist() == [
        summary.pulled_out_length for summary in run.slip_summaries()
    ]
    assert all(count >= pulled for count, pulled in zip(counted, gone))
    assert run.outcome in ("perforated", "in flight")
    assert np.abs(run.sample("error")).max() < 0.01 * run.strike_energy


def test_all_that_touches_a_ply_presses_its_yarns_on_each_other(ply):
    run = PackSolver(Pack.stacked(sliding(ply), 2, gap=GAP), 150.0, 20e-6).run()
    for p, (const, state) in enumerate(zip(run.consts, run.states)):
        first, last = state.active_rows
        rows = slice(first * const.row_stride, (last + 1) * const.row_stride)
        pressing = run._slips[2].values[p].f_contact[2][rows]
        all_forces = run._loaded_state(p).f_contact[2][rows]
        most = np.abs(all_forces).max()
        assert np.abs(all_forces - state.f_contact[2][rows]).max() > 0.01 * most
        assert_allclose(pressing, all_forces, rtol=1e-9, atol=1e-12 * most)


def test_plies_slide_all_or_none(ply):
    pack = Pack.stacked(sliding(ply), 2, gap=GAP, stacking="alternating")
    assert len(pack.crossovers) == 2
    assert Pack.stacked(pinned(ply), 2, gap=GAP).crossovers == ()
    with pytest.raises(InputError, match="crossovers = 'sliding'"):
        Pack((pack.plies[0], pinned(ply)), pack.gaps)


def test_the_mass_of_one_family_bounds_stick_between_plies(ply):
    free = Pack.stacked(sliding(ply), 2, gap=GAP, stacking="alternating")
    held = replace(free, plies=(sliding(ply, mu=np.inf),) * 2)
    assert free._stick_damping(1.0) * free.time_step < held._stick_damping(1.0) * held.time_step
