"""Packs with sliding crossovers: pinned in the limit, energy, threads, resuming, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.cell.model import CellModel
from shellfabric.output import checkpoint
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.model import Pack
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel
from shellfabric.solver.pack_solver import PackSolver

GAP = 0.1e-3


@pytest.fixture(scope="module")
def table():
    return CellModel(catalogue.load("S-726").with_effective_density()).table(81)


def sliding(table, mu=0.2, cohesion=0.0, threads=1, **others):
    friction = CrossoverFriction(mu, cohesion)
    return SlidingPanel(
        table, (0.04, 0.04), numerics=Numerics(threads=threads), elements_per_crossover=1, friction=friction, **others
    )


def pinned(table):
    return Panel(table, (0.04, 0.04), numerics=Numerics(threads=1), elements_per_crossover=1)


def same(one, other):
    return all(np.array_equal(np.array(a), np.array(b)) for a, b in zip(one, other))


@pytest.mark.parametrize(
    ("velocity", "friction"), [pytest.param(60.0, 0.2, marks=pytest.mark.slow(300)), (60.0, 0.0), (300.0, 0.0)]
)
def test_an_infinite_threshold_is_the_pinned_pack(table, velocity, friction):
    held = PackSolver(Pack.stacked(pinned(table), 2, gap=GAP, friction=friction), velocity, 40e-6).run()
    stuck = PackSolver(Pack.stacked(sliding(table, mu=np.inf), 2, gap=GAP, friction=friction), velocity, 40e-6).run()
    assert (held.sample("failed_yarns")[-1] > 0) == (velocity > 200)
    assert stuck.stack.awake.all()
    for p in range(2):
        assert same(held.states[p], stuck.states[p])
    for name in held.sample_names:
        np.testing.assert_array_equal(held.sample(name), stuck.sample(name))
    assert stuck.sample("crossover_friction")[-1] == 0.0


def test_torn_plies_are_kept_apart_by_the_forces_that_act(table):
    """What is predicted of torn fabric is where it comes to; the forces of the slip were not in it."""
    run = PackSolver(Pack.stacked(sliding(table, mu=0.1), 2, gap=GAP), 300.0, 20e-6).run()
    assert run.sample("failed_yarns")[-1] > 0
    stops, places = run.stops, []
    for p, state in enumerate(run.states):
        nodes = stops.nodes[p, : stops.counts[p, 1]].copy()
        places.append((state.u, nodes, np.array(state.u)[:, nodes], (stops.x_next - stops.x)[p][:, nodes]))
    run.advance(np.empty((1, 3)))
    for u, nodes, before, predicted in places:
        assert np.abs(predicted).max() > 1e-6
        np.testing.assert_allclose(np.array(u)[:, nodes] - before, predicted, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("mu", "cohesion", "friction"),
    [(0.2, 0.0, 0.0), pytest.param(0.1, 0.0, 0.3, marks=pytest.mark.slow(300)), (0.0, 0.5, 0.0)],
)
def test_the_energy_balance_holds(table, mu, cohesion, friction):
    pack = Pack.stacked(sliding(table, mu, cohesion), 2, gap=GAP, friction=friction)
    run = PackSolver(pack, 150.0, 60e-6).run()
    rubbed = run.sample("crossover_friction")
    assert rubbed[-1] > 1e-4 * run.strike_energy
    assert np.all(np.diff(rubbed) > -1e-9 * run.strike_energy)
    assert np.abs(run.sample("error")).max() < 0.005 * run.strike_energy
    assert all(summary.pulled_out_length > 1e-5 for summary in run.slip_summaries())
    slip = run.ply_sample("slip")
    assert slip[-1].tolist() == [summary.pulled_out_length for summary in run.slip_summaries()]
    assert not slip[0].any()


def test_one_and_two_threads_are_the_same_to_the_bit(table):
    runs = [PackSolver(Pack.stacked(sliding(table, threads=n), 2, gap=GAP), 150.0, 40e-6) for n in (1, 2)]
    assert [run.threads for run in runs] == [1, 2]
    for run in runs:
        run.run()
    for p in range(2):
        assert same(runs[0].states[p], runs[1].states[p])
    np.testing.assert_array_equal(np.array(runs[0].samples), np.array(runs[1].samples))


def test_a_run_is_resumed_to_the_bit(table, tmp_path):
    def march():
        return PackSolver(Pack.stacked(sliding(table), 2, gap=GAP), 250.0, 40e-6)

    whole, first, second = march().run(), march(), march()

    def keep(solver):
        if len(solver.samples) == 11:
            checkpoint.write(solver, tmp_path / "c.h5")

    first.run((keep,))
    checkpoint.read(second, tmp_path / "c.h5")
    assert 0 < second.time < whole.time
    second.run()
    np.testing.assert_array_equal(np.array(second.samples), np.array(whole.samples))
    for one, other in zip(second.slips, whole.slips):
        assert same(one.share + one.q, other.share + other.q)
    other = PackSolver(Pack.stacked(sliding(table, mu=0.1), 2, gap=GAP), 250.0, 40e-6)
    with pytest.raises(InputError, match="another"):
        checkpoint.read(other, tmp_path / "c.h5")


@pytest.mark.parametrize("plies", [1, 2])
def test_yarns_that_have_left_count_as_failures(table, plies):
    """A shot that perforates: the neighbour's contact looks for edges where a yarn has gone, the nose for a way out."""
    run = PackSolver(Pack.stacked(sliding(table, mu=0.1, edge="free"), plies, gap=GAP), 350.0, 60e-6).run()
    gone = [summary.pulled_out_segments for summary in run.slip_summaries()]
    counted = [int(state.counter[2]) for state in run.states]
    assert all(pulled > 100 for pulled in gone)
    assert all(count >= pulled for count, pulled in zip(counted, gone))
    assert run.outcome in ("perforated", "in flight")
    assert np.abs(run.sample("error")).max() < 0.01 * run.strike_energy


def test_all_that_touches_a_ply_presses_its_yarns_on_each_other(table):
    run = PackSolver(Pack.stacked(sliding(table), 2, gap=GAP), 150.0, 20e-6).run()
    for p, (const, state) in enumerate(zip(run.consts, run.states)):
        first, last = state.active_rows
        rows = slice(first * const.row_stride, (last + 1) * const.row_stride)
        pressing, all_forces = run._slips[2].values[p].f_contact[2][rows], run._loaded_state(p).f_contact[2][rows]
        most = np.abs(all_forces).max()
        assert np.abs(all_forces - state.f_contact[2][rows]).max() > 0.01 * most
        np.testing.assert_allclose(pressing, all_forces, rtol=1e-9, atol=1e-12 * most)


def test_plies_slide_all_or_none(table):
    pack = Pack.stacked(sliding(table), 2, gap=GAP, stacking="alternating")
    assert len(pack.crossovers) == 2
    assert Pack.stacked(pinned(table), 2, gap=GAP).crossovers == ()
    with pytest.raises(InputError, match="crossovers = 'sliding'"):
        Pack((pack.plies[0], pinned(table)), pack.gaps)


def test_the_mass_of_one_family_bounds_stick_between_plies(table):
    free = Pack.stacked(sliding(table), 2, gap=GAP, stacking="alternating")
    held = replace(free, plies=(sliding(table, mu=np.inf),) * 2)
    step = held.time_step
    assert free._slip_constants(1.0, 1e5)[0] < held._slip_constants(1.0, 1e5)[0] * (step / free.time_step) ** 2
