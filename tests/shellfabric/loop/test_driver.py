"""The driver on a model with a closed form: a mass on a spring, shot off at its rest position.

Central differences put it at x(n) = v0 dt sin(n a) / sin(a), with cos(a) = 1 - (w dt)^2 / 2, and conserve the energy
m v(n-1/2) v(n+1/2) / 2 + k x(n)^2 / 2 exactly.
"""

import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fabrics.base.errors import UnstableError
from shellfabric.jit.barrier import STOP
from shellfabric.loop import checkpoint
from shellfabric.loop import driver as driver
from shellfabric.loop.driver import (
    CHECK,
    NOT_FINITE,
    RUNNING,
    STOPPED,
    ExplicitSolver,
    run_to_end,
)
from shellfabric.loop.hooks import Every, Snapshots

# the frequency is 200 / s, so that half a period has 157 steps
MASS = 2e-3
STIFFNESS = 80.0
V0 = 50.0
DT = 1e-4
W = (STIFFNESS / MASS) ** 0.5
ENERGY = 0.5 * MASS * V0**2


class Oscillator(ExplicitSolver):
    """A mass on a spring; `disturb` is called before every step with the solver."""

    history_columns = 2

    def __init__(self, end_time=0.1, *, interval=1e-3, disturb=None, ends=True):
        shot = SimpleNamespace(energy=lambda v: 0.5 * MASS * v**2)
        super().__init__(shot, V0, end_time, interval=interval, energy_error_limit=0.05)
        self.const = SimpleNamespace(dt=DT)
        self.ends = ends
        self.disturb = disturb or (lambda solver: None)
        self.x, self.v, self.counter = np.zeros(1), np.array([V0]), np.zeros(1, np.int64)
        self.contact = np.zeros(1)
        self.node_limit = np.inf
        self.state = SimpleNamespace(projectile_velocity=np.zeros(3))
        self._begin(DT)

    steps = property(lambda self: int(self.counter[0]))

    def advance(self, history):
        self._shared[STOP] = len(history) == 0 or self._shared[STOP]
        exchanged = 0.0
        for made, row in enumerate(history, 1):
            self.disturb(self)
            before = self.spring
            self.v -= DT * STIFFNESS / MASS * self.x
            self.x += DT * self.v
            self.counter += 1
            row[:] = self.x[0], self.v[0]
            exchanged += abs(self.spring - before)
            if self.ends and self.v[0] <= 0:
                return made, STOPPED
            if exchanged > self.allowed_exchange:
                return made, CHECK
        return len(history), RUNNING

    @property
    def spring(self):
        return 0.5 * STIFFNESS * self.x[0] ** 2

    def observe(self):
        after = self.v[0] - DT * STIFFNESS / MASS * self.x[0]
        kinetic = 0.5 * MASS * self.v[0] * after
        energies = {"kinetic": kinetic, "spring": self.spring, "contact": self.contact[0]}
        return {"v": 0.5 * (self.v[0] + after), "z": self.x[0]}, energies

    def node_speeds(self):
        return [(abs(self.v), self.node_limit)]

    def where(self, part, node):
        return f"mass {node} of part {part}"

    def checkpoint_identity(self):
        return (self.strike_velocity, self.steps_per_sample), "shellfabric.loop.driver"

    def checkpoint_arrays(self):
        return {"x": self.x, "v": self.v, "counter": self.counter, "contact": self.contact}


def position(step):
    a = np.arccos(1 - (W * DT) ** 2 / 2)
    return V0 * DT * np.sin(step * a) / np.sin(a)


def at(step, change):
    """A disturbance before one step."""
    return lambda solver: change(solver) if solver.steps == step else None


def test_the_run_is_that_of_the_closed_form():
    solver = Oscillator().run()
    steps = np.round(solver.sample("t") / DT)
    assert solver.outcome == "stopped"
    assert solver.time == pytest.approx(0.5 * np.pi / W, abs=2 * DT)
    assert solver.sample("z") == pytest.approx(position(steps), rel=1e-12)
    history = np.concatenate(solver.step_history)
    assert history[:, 0] == pytest.approx(position(np.arange(1, solver.steps + 1)), rel=1e-12)
    assert abs(solver.sample("error")).max() < 1e-12 * ENERGY
    assert solver.sample("kinetic")[0] == pytest.approx(ENERGY, rel=1e-12)
    assert solver.wall_time > 0


def test_samples_are_a_whole_number_of_steps_apart_and_one_is_at_the_end():
    solver = Oscillator(4.25e-3, interval=1.04e-3).run()
    assert solver.steps_per_sample == 10
    assert np.round(solver.sample("t") / DT).tolist() == [0, 10, 20, 30, 40, 43]
    assert [len(part) for part in solver.step_history] == [10, 10, 10, 10, 3]
    assert solver.outcome == "in flight"
    assert solver.ended


def test_energies_are_those_of_the_whole():
    class Half(Oscillator):
        """The modelled half of two such masses."""

        def _begin(self, dt):
            self.share = 0.5
            super()._begin(dt)

    assert Half(5e-3).run().sample("spring") == pytest.approx(
        2 * Oscillator(5e-3).run().sample("spring"), rel=1e-12
    )


def push(solver, factor):
    solver.v *= factor


DISTURBED = {
    "not finite": (lambda solver: push(solver, np.nan), "a number is not finite"),
    "a node": (
        lambda solver: setattr(solver, "node_speeds", lambda: [(np.array([np.nan, 1.0]), np.inf)]),
        "a number is not finite",
    ),
    "energy": (
        lambda solver: push(solver, 1.1),
        "the energy balance is off by .* % of the strike energy",
    ),
    "contact": (
        lambda solver: solver.contact.__isub__(0.02 * ENERGY),
        "the contact has given 2 % .* never took",
    ),
    "node": (lambda solver: setattr(solver, "node_limit", 0.5 * V0), "a node moves at"),
    "kernel": (
        lambda solver: setattr(solver, "advance", lambda history: (0, NOT_FINITE)),
        "not finite",
    ),
}


@pytest.mark.parametrize("name", DISTURBED)
def test_a_guard_ends_the_run_and_says_where(name):
    change, message = DISTURBED[name]
    solver = Oscillator(10e-3, disturb=at(15, change))
    with pytest.raises(UnstableError, match=message) as caught:
        solver.run()
    assert solver.outcome == "unstable"
    assert "mass 0 of part 0" in str(caught.value)
    assert "after" in str(caught.value)
    assert 15 < solver.steps <= 30
    assert sum(map(len, solver.step_history)) == solver.steps  # what was computed is kept


@pytest.mark.parametrize(
    "change",
    [
        lambda solver: push(solver, 1.005),
        lambda solver: solver.contact.__isub__(0.009 * ENERGY),
        lambda solver: setattr(solver, "node_limit", 1.1 * V0),
    ],
)
def test_no_guard_minds_what_is_within_its_limit(change):
    assert Oscillator(10e-3, disturb=at(15, change)).run().outcome == "stopped"


def test_an_energy_error_is_found_between_samples():
    """The next sample is the end; with checks off it is found there."""
    seldom = {
        "end_time": 7e-3,
        "interval": 7e-3,
        "disturb": at(20, lambda solver: push(solver, 1.2)),
    }
    solver = Oscillator(**seldom)
    with pytest.raises(UnstableError, match="energy balance"):
        solver.run()
    assert solver.checks > 0
    assert 20 < solver.steps < 50
    assert len(solver.samples) == 2  # the start, and the check that has found it
    late = Oscillator(**seldom)
    late.exchange = np.inf
    with pytest.raises(UnstableError, match="energy balance"):
        late.run()
    assert late.steps == 70
    assert late.checks == 0


def test_checks_leave_no_trace():
    often = Oscillator()
    never = Oscillator()
    often.exchange = 1e-3
    never.exchange = np.inf
    assert often.run().checks > 10
    assert never.run().checks == 0
    assert_array_equal(often.samples, never.samples)
    assert_array_equal(np.concatenate(often.step_history), np.concatenate(never.step_history))


def test_a_failed_run_hands_on_its_result():
    solver = Oscillator(disturb=at(15, lambda solver: push(solver, 2.0)))
    with pytest.raises(UnstableError) as caught:
        run_to_end(solver, (), lambda: len(solver.samples))
    assert caught.value.result == len(solver.samples) > 1
    whole = Oscillator()
    assert run_to_end(whole, (), lambda: whole.outcome) == "stopped"


@pytest.mark.parametrize(
    "interval, steps", [(2e-3, [20, 40, 50]), (1e-4, [10, 20, 30, 40, 50]), (1, [50])]
)
def test_snapshots_are_at_the_samples_nearest_the_multiples(interval, steps):
    solver = Oscillator(5e-3).run((Snapshots(interval, lambda solver: solver.steps),))
    assert solver.snapshots == steps


class Threaded(Oscillator):
    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.threads = 3
        self.begun = []
        self.released = 0

    def run_worker(self, shared, me):
        self.begun.append(me)
        deadline = time.monotonic() + 3000
        while not shared[STOP] and time.monotonic() < deadline:
            time.sleep(1e-4)
        self.released += bool(shared[STOP])

    def advance(self, history):
        try:
            return super().advance(history)
        finally:
            self._shared[STOP] = 1


class Clock:
    """Stands for the module `time`: each call of the kernel takes 60 ms, and the processor for `share` of them."""

    def __init__(self, share):
        self.share = share
        self.reads = 0
        self.monotonic = time.monotonic
        self.sleep = time.sleep

    def perf_counter(self):
        self.reads += 1
        return 0.06 * self.reads

    def thread_time(self):
        return self.share * 0.06 * self.reads


@pytest.mark.parametrize(
    "share, reduces, threads", [(0.5, True, 1), (0.95, True, 3), (0.5, False, 3)], ids=str
)
def test_threads_of_a_run_on_a_shared_processor(monkeypatch, share, reduces, threads):
    """Workers wait for every call of the kernel: to compile, for the first of five intervals, after each."""
    solver = Threaded(5e-3)
    solver.reduces_threads = reduces
    solver.exchange = np.inf
    monkeypatch.setattr(driver, "time", Clock(share))
    solver.run()
    assert solver.threads == threads
    assert sorted(solver.begun) == sorted((2 if threads == 1 else 7) * [1, 2])
    assert solver.released == len(solver.begun)
    assert_array_equal(solver.samples, Oscillator(5e-3).run().samples)


def test_workers_are_released_where_a_hook_fails():
    def wrong(solver):
        raise LookupError

    solver = Threaded(5e-3)
    before = threading.active_count()
    with pytest.raises(LookupError):
        solver.run((wrong,))
    assert threading.active_count() == before
    assert solver.released == len(solver.begun)


def test_checkpoints_are_as_far_apart_as_asked_for(tmp_path, monkeypatch):
    """The clock goes on by a second a sample, of which there are a hundred; no run goes on for more than half a
    minute without one."""
    clock = [0.0]
    written = []
    monkeypatch.setattr(checkpoint, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    monkeypatch.setattr(
        checkpoint, "write", lambda solver, path: written.append(len(solver.samples))
    )

    def tick(solver):
        clock[0] += 1.0

    for least_wall, expected in (
        (200.0, [32, 62, 92]),
        (20.0, [22, 42, 62, 82]),
        (0.0, list(range(2, 102))),
    ):
        written.clear()
        Oscillator(ends=False).run(
            (checkpoint.Checkpoints(tmp_path / "run.h5", 1e-3, least_wall), tick)
        )
        assert written == expected


def test_an_ended_run_stays_ended_when_it_is_read_again(tmp_path):
    checkpoint.write(Oscillator().run(), tmp_path / "run.h5")
    again = Oscillator()
    checkpoint.read(again, tmp_path / "run.h5")
    assert again.ended
    assert again.run().steps == again.steps
    assert Every(1e-3).due(again)
