"""Histories along yarns and at edges of the plies of a pack: by number of the ply, and by momentum."""

import numpy as np
import pytest

from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.output import checkpoint
from shellfabric.output.histories import EDGES, LIFT, HistoryRequest
from shellfabric.panel.model import Numerics

QUICK = {"opening": 0.04, "table_size": 61, "end_time": 40e-6, "numerics": Numerics(threads=1)}
GAP = 50e-6


@pytest.fixture(scope="module")
def shoot(fabric):
    def make(plies, measure, hooks=(), resume=None, **changes):
        setup = ImpactSetup(fabric, 120.0, history=measure, plies=plies, ply_gap=GAP, **QUICK | changes)
        return run(setup, hooks=hooks, resume=resume)

    return make


def assert_same(one, other):
    np.testing.assert_array_equal(one.t, other.t)
    assert len(one.yarns) == len(other.yarns)
    for yarn, same in zip(one.yarns, other.yarns):
        assert (yarn.family, yarn.offset) == (same.family, same.offset)
        for name in ("tension", "place", "deflection"):
            np.testing.assert_array_equal(getattr(yarn, name), getattr(same, name))
    for name in EDGES:
        np.testing.assert_array_equal(one.edges[name], other.edges[name])


def test_plies_are_followed_by_their_numbers(shoot):
    every = shoot(3, HistoryRequest(2e-6)).histories
    last, first = shoot(3, HistoryRequest(2e-6, plies=(3, 1))).histories
    assert len(every) == 3
    assert_same(last, every[2])
    assert_same(first, every[0])
    assert every[0].yarns[0].deflection.max() > every[2].yarns[0].deflection.max() > 0
    assert shoot(2, None, end_time=4e-6).histories == ()


def test_reactions_of_all_plies_take_up_the_momentum(shoot):
    """The lift of all edges, summed over the steps, is what projectile and plies have lost: to the last digits."""
    momentum = []

    def weigh(solver):
        cloth = 0.0
        for _, _, state in solver.parts:
            loose = state.inverse_mass > 0
            cloth += float(state.mass[loose] @ state.v[2][loose])
        momentum.append((solver.const.projectile_mass * solver.stack.projectile_velocity[2] + cloth) / solver.share)

    result = shoot(2, HistoryRequest(1e-9), hooks=[weigh], end_time=60e-6)
    start = 120.0 * result.setup.projectile.mass
    t = result.histories[0].t
    lift = sum(ply.edges[name][:, LIFT] for ply in result.histories for name in EDGES)
    taken = t[0] * np.concatenate([[0.0], np.cumsum(lift[:-1])])
    lost = start - np.array(momentum)
    assert lost[-1] > 0.05 * start
    np.testing.assert_allclose(taken, lost, atol=1e-9 * start)


def test_resumed_records_are_the_same_bit_for_bit(shoot, tmp_path):
    path, measure = tmp_path / "run.h5", HistoryRequest(1e-6, plies=(2,))

    def interrupt(solver):
        if solver.time > 20e-6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        shoot(2, measure, hooks=[checkpoint.Checkpoints(path, 8e-6), interrupt])
    assert_same(shoot(2, measure, resume=path).histories[0], shoot(2, measure).histories[0])
    with pytest.raises(InputError, match="another run"):
        shoot(2, HistoryRequest(1e-6), resume=path)


@pytest.mark.parametrize("plies", [(), (0,), (1.5,), (4,)])
def test_bad_plies_are_refused(shoot, plies):
    with pytest.raises(InputError, match="plies"):
        shoot(3, HistoryRequest(1e-6, plies=plies))
