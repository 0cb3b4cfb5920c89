"""Threads that march together: the same bits with any number of them, and how many there are."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from threading import Thread

import numpy as np
import pytest
from numba import njit

from fabrics.errors import InputError
from shellfabric.impact.ballistic_limit import shoot
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.jit import barrier
from shellfabric.output import checkpoint
from shellfabric.panel.model import Numerics
from shellfabric.solver.pack_solver import PackSolver


@njit(nogil=True)
def _meetings(shared, written, me, count):
    sums = np.empty(written.shape[0])
    for m in range(written.shape[0]):
        written[m, me] = me + 1.0
        barrier.barrier_wait(shared, count)
        sums[m] = written[m].sum()
    return sums


def setup(fabric, threads, **changes):
    """An S-720 panel of 40 x 40 crossovers as a whole, in many blocks, through which the projectile goes."""
    knobs = {"block": 100, "threads": threads} | changes.pop("numerics", {})
    settings = {"opening": 0.0508, "table_size": 61, "symmetry": "half", "end_time": 20e-6} | changes
    return ImpactSetup(fabric, 260.0, numerics=Numerics(**knobs), **settings)


def march(fabric, threads, **changes):
    chosen = setup(fabric, threads, **changes)
    return PackSolver(chosen.panel(), chosen.strike_velocity, chosen.end_time).run()


def assert_same(one, other):
    for name, mine, theirs in zip(one.state._fields, one.state, other.state):
        np.testing.assert_array_equal(mine, theirs, err_msg=name)
    np.testing.assert_array_equal(one.samples, other.samples)
    np.testing.assert_array_equal(np.concatenate(one.step_history), np.concatenate(other.step_history))


@pytest.mark.parametrize("form", ["equilibrium", "variational"])
@pytest.mark.parametrize("changes", [{}, {"elements_per_crossover": 2, "numerics": {"failure_time": 1e-6}}])
def test_results_do_not_depend_on_the_number_of_threads(fabric, form, changes):
    """With contact and failure, after each audit, to the bit; more threads than blocks at the start included."""
    alone = march(fabric, 1, form=form, **changes)
    assert alone.state.failed[0].any()
    for threads in (2, 3):
        together = march(fabric, threads, form=form, **changes)
        assert together.threads == threads
        assert_same(alone, together)


def test_a_run_goes_on_with_another_number_of_threads(fabric, tmp_path):
    whole = run(setup(fabric, 1))
    with pytest.raises(KeyboardInterrupt):

        def interrupt(march):
            checkpoint.write(march, tmp_path / "run.h5")
            if march.time > 10e-6:
                raise KeyboardInterrupt

        run(setup(fabric, 2), hooks=[interrupt])
    resumed = run(setup(fabric, 3), resume=tmp_path / "run.h5")
    for name in ("step_history", "failed_segments"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name), err_msg=name)
    for name in ("nodes", "tension"):
        np.testing.assert_array_equal(getattr(resumed.last[0], name), getattr(whole.last[0], name), err_msg=name)
    assert resumed.failed_segments[-1] > 0


def test_nobody_is_left_waiting(fabric):
    """The threads that wait for the next steps are let go where something goes wrong between two."""
    chosen, told = setup(fabric, 2), []
    march(fabric, 2, end_time=1e-9)  # compiled before the time that the thread is given begins

    def wrong(march):
        raise LookupError(march.steps)

    def fire():
        try:
            PackSolver(chosen.panel(), chosen.strike_velocity, chosen.end_time).run((wrong,))
        except LookupError as problem:
            told.append(problem.args[0])

    thread = Thread(target=fire, daemon=True)
    thread.start()
    thread.join(300)
    assert not thread.is_alive()
    assert told[0] > 0


def test_threads_of_shots_beside_each_other(fabric):
    """Shots with several threads each can be under way at once, and are what they are alone."""
    panel = setup(fabric, 2).panel()
    shots = [shoot(panel, (230.0, 260.0), jobs=workers) for workers in (1, 2)]
    assert [replace(shot, wall_time=0.0) for shot in shots[0]] == [replace(shot, wall_time=0.0) for shot in shots[1]]


def test_how_many(monkeypatch):
    """A large panel takes the processors that the process is allowed to use, not those of the machine."""
    monkeypatch.setattr("os.cpu_count", lambda: 64)
    monkeypatch.setattr("os.sched_getaffinity", lambda process: {0, 3, 5, 6, 9}, raising=False)
    assert barrier.threads_for(3, 10) == barrier.threads_for(3, barrier.MIN_ELEMENTS_THREADED) == 3
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED - 1) == 1
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED) == 5
    monkeypatch.delattr("os.sched_getaffinity")  # a system without it
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED) == 64
    monkeypatch.setattr("os.cpu_count", lambda: None)
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED) == 1
    with pytest.raises(InputError, match="threads"):
        Numerics(threads=0)


def test_nobody_passes_the_barrier_alone():
    """Sums of what each thread has written before it came are complete behind the barrier, a thousand times over."""
    count, shared, written = 3, np.zeros(barrier.SLOTS, np.int64), np.zeros((1000, 3))
    _meetings(shared, written, 0, 1)  # compiled
    written[:] = 0.0
    with ThreadPoolExecutor(count) as pool:
        seen = [pool.submit(_meetings, shared, written, me, count) for me in range(count)]
        for sums in seen:
            np.testing.assert_array_equal(sums.result(), np.full(1000, 6.0))
