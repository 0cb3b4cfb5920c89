"""Explicit time integration: one driver for panel, pack of plies and coupon. It makes the steps of a model
up to the next sample, takes the sample, audits the energy, guards the run and calls the hooks, as
hook(solver), until the run is over. A model derives from `ExplicitSolver`.

Each energy is computed on its own; the energy error, the last, is their sum less that at the start.

Threads wait for each other at a barrier (`jit.barrier`), and in their kernel while the main thread
samples: waking takes longer than a step. A thread that has lost its core to other processes holds up
the others; a run that was left to choose its number of threads then goes on with one. No result
depends on the number of threads.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, NoReturn, Self, TypeAlias, TypeVar

import numpy as np

from fabrics.base.checks import FloatArray, IntArray, positive
from fabrics.base.errors import UnstableError
from shellfabric.guards import energy_gain_message
from shellfabric.jit import barrier

Result = TypeVar("Result")
# called with the solver after a sample; what it returns is not read
Hook: TypeAlias = Callable[[Any], object]

# why a kernel ends its steps; as the step kernels have it
RUNNING, STOPPED, PERFORATED, NOT_FINITE, CHECK, LOOK = range(6)
OUTCOMES = {RUNNING: "in flight", STOPPED: "stopped", PERFORATED: "perforated"}
# of the strike energy that may be exchanged from one check of the energy to the next
ENERGY_CHECK_SHARE = 0.05
# after so many seconds of steps with several threads the main thread must have had this share of
# the time on its processor, or the run goes on with one
BUSY_TIME = 0.05
BUSY_SHARE = 0.75


class ExplicitSolver:
    """One run of a model; the base class of the solvers.

    A model provides `steps`, `advance`, `observe`, `node_speeds`, `where` and, for checkpoints,
    `checkpoint_identity` and `checkpoint_arrays`. It sets `share` and `threads` and calls `_begin`
    when its state is made.

    Parameters
    ----------
    projectile : with energy(velocity) [J]
    strike_velocity : [m/s]
    end_time : [s]
    interval : [s] between samples
    energy_error_limit : share of the strike energy that the energy error may reach before the run
        counts as unstable

    Attributes
    ----------
    sample_names : of the columns of a sample: "t", then what `observe` returns
    energy_names : of the energies; the last is the energy error
    contacts : {energy: name in messages} of contacts, which can store and lose energy but not give
        any
    history_columns : number of columns of step_history
    counters : names of the numbers that a checkpoint keeps
    share : modelled part of the whole [-]
    samples : list of rows in the order of sample_names; energies are those of the whole
    step_history : list of (steps, history_columns) arrays, a row a step
    snapshots : list of what a hook takes
    steps_per_sample, last_step : steps from one sample to the next, and in all
    reason : why the kernels have ended, RUNNING where they have not
    checks : number of energy checks between samples
    exchange : share of the strike energy that may be exchanged between two checks; infinite for no
        checks
    wall_time : [s] spent in the kernels
    threads, reduces_threads : number of threads, and whether the run may go on with one where
        others use the processor

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    sample_names: tuple[str, ...] = ()
    energy_names: tuple[str, ...] = ()
    contacts: Mapping[str, str] = {"contact": "the contact"}
    counters: tuple[str, ...] = ("reason", "wall_time")
    history_columns = 0
    const: Any  # named tuples of the kernels; `const` has the time step dt [s]
    state: Any

    def __init__(
        self,
        projectile: Any,
        strike_velocity: float,
        end_time: float,
        *,
        interval: float,
        energy_error_limit: float,
    ) -> None:
        self.projectile = projectile
        self.strike_velocity = float(strike_velocity)
        self.end_time = float(end_time)
        self.interval = float(interval)
        positive(self, "strike_velocity", "end_time", "interval")
        self.energy_error_limit = energy_error_limit
        self.samples: list[FloatArray] = []
        self.step_history: list[FloatArray] = []
        self.snapshots: list[Any] = []
        self.reason = RUNNING
        self.wall_time = 0.0
        self.share = 1.0
        self.threads = 1
        self.checks = 0
        self.exchange = ENERGY_CHECK_SHARE
        self.energy_at_start = None
        self.reduces_threads = False
        self._threaded_time = np.zeros(2)
        self._shared = np.zeros(barrier.SLOTS, np.int64)

    def _begin(self, dt):
        """Set how many steps of `dt` [s] there are, and take the first sample."""
        self.steps_per_sample = max(1, round(self.interval / dt))
        self.last_step = int(np.ceil(self.end_time / dt))
        self._sample()

    # what a model provides

    @property
    def steps(self) -> int:
        """Steps made."""
        raise NotImplementedError

    @property
    def time(self) -> float:
        """[s]"""
        return self.steps * self.const.dt

    def advance(self, history: FloatArray) -> tuple[int, int]:
        """Make as many steps as there are rows in `history`, or fewer where the run ends or an
        energy check is due.

        Parameters
        ----------
        history : (steps, history_columns), filled; without rows the kernels are compiled and
            workers released

        Returns
        -------
        steps made, and why no more were: RUNNING, STOPPED, PERFORATED, NOT_FINITE, CHECK or LOOK
        """
        raise NotImplementedError

    def observe(self) -> tuple[dict[str, float], dict[str, float]]:
        """Return ({name: value}, {name: [J]}): what a sample has besides energies; all energies of
        the modelled part."""
        raise NotImplementedError

    def node_speeds(self) -> list[tuple[FloatArray, float]]:
        """Return [((n,) speeds [m/s] of the nodes, the highest that a run goes on with)] of each
        part."""
        raise NotImplementedError

    def where(self, part: int, node: int) -> str:
        """Say where the node of a part is."""
        raise NotImplementedError

    def energy_made(self) -> dict[str, float]:
        """Return {place, in words: [J]} of the energy error, of models with books of their own."""
        return {}

    def run_worker(self, shared: IntArray, me: int) -> None:
        """Run the share of thread number `me` in the steps of one call of `advance`."""

    def sampled(self) -> None:
        """Do what a model does after a sample that the guards have passed."""

    def look(self) -> int:
        """Tell whether a run is over that the kernels take for one that may be: PERFORATED or RUNNING."""
        return PERFORATED

    def guard_model(self) -> None:
        """Check the guards of the model's own."""

    def checkpoint_identity(self) -> tuple[Any, str]:
        """Return (what determines the run and its records, name of the module whose code does)."""
        raise NotImplementedError

    def checkpoint_arrays(self) -> dict[str, Any]:
        """Return {name: array, or named tuple of arrays} of the state, into which a checkpoint puts
        back what it has kept."""
        raise NotImplementedError

    def checkpoint_records(self) -> dict[str, list[Any]]:
        """Return {name: list of equal rows} of what has been recorded."""
        return {"samples": self.samples}

    @property
    def fabric_ended(self) -> bool:
        """Whether the fabric stays as it is while the run goes on: nothing more is recorded of
        it."""
        return False

    # the driver

    @property
    def ended(self) -> bool:
        """Whether the run is over."""
        return self.reason != RUNNING or self.steps >= self.last_step

    @property
    def outcome(self) -> str:
        """How it ended: "in flight", "stopped", "perforated" or "unstable"."""
        return OUTCOMES.get(self.reason, "unstable")

    @property
    def residual_velocity(self) -> float:
        """[m/s] along the normal at the end; 0 of a stopped projectile, which has turned back."""
        if self.outcome == OUTCOMES[STOPPED]:
            return 0.0
        return float(self.sample("v")[-1])

    @property
    def strike_energy(self) -> float:
        """[J] of the whole projectile."""
        return self.projectile.energy(self.strike_velocity)

    @property
    def allowed_exchange(self) -> float:
        """[J] energy that the modelled part may exchange between two checks of the energy."""
        return self.exchange * self.strike_energy * self.share

    @property
    def when(self) -> str:
        """Text that says how far the run has come."""
        return f"after {self.time * 1e6:.3g} us (step {self.steps})"

    @property
    def sample_spacing(self) -> float:
        """[s] from one sample to the next."""
        return self.steps_per_sample * self.const.dt

    def sample(self, name: str) -> FloatArray:
        """Return one column (n,) of the samples."""
        return np.array([row[self.sample_names.index(name)] for row in self.samples])

    def run(self, hooks: Iterable[Hook] = ()) -> Self:
        """Integrate to the end, or to where the run goes wrong.

        Raises
        ------
        UnstableError : a number that is not finite, an energy error beyond its limit, a contact
            that gains energy, or a node that is too fast (`guards.speed_limit`); samples and state
            stay as they are
        """
        try:
            with self._workers():
                while not self.ended:
                    self._advance_to_sample()
                    self._sample()
                    self._guard()
                    self.sampled()
                    for hook in hooks:
                        hook(self)
        except UnstableError:
            self.reason = NOT_FINITE
            raise
        return self

    @contextmanager
    def _workers(self):
        """Worker threads, released at the end whatever happens; all kernels are compiled before the
        steps begin."""
        with ThreadPoolExecutor(max(1, self.threads - 1)) as self._pool:
            self._start_workers()
            try:
                self.advance(self._rows(0))
                self._start_workers()
                yield
            finally:
                if self._shared[barrier.STOP]:  # an exception came before they were started again
                    self._start_workers()
                self.advance(self._rows(0))

    def _start_workers(self):
        """Have the workers wait for the next steps. They meet in new memory: some may not have left
        the old yet."""
        self._shared = np.zeros(barrier.SLOTS, np.int64)
        for me in range(1, self.threads):
            self._pool.submit(self.run_worker, self._shared, me)

    def _rows(self, count):
        return np.empty((count, self.history_columns))

    @contextmanager
    def _clock(self):
        """Adds to the wall time, and reduces the threads where the processor is shared."""
        start = time.perf_counter()
        used = time.thread_time()
        yield
        wall = time.perf_counter() - start
        self.wall_time += wall
        if self.threads > 1 and self.reduces_threads:
            self._threaded_time += wall, time.thread_time() - used
            if self._threaded_time[0] > BUSY_TIME:
                if self._threaded_time[1] < BUSY_SHARE * self._threaded_time[0]:
                    self.threads = 1
                self._threaded_time[:] = 0.0

    def _advance_to_sample(self):
        """Make the steps up to the next sample, or fewer where the run ends.

        On the way the energy is checked as often as `allowed_exchange` has been exchanged.
        """
        history = self._rows(min(self.steps_per_sample, self.last_step - self.steps))
        made = 0
        try:
            while made < len(history):
                with self._clock():
                    steps, self.reason = self.advance(history[made:])
                made += steps
                self._start_workers()
                if self.reason == LOOK:
                    self.reason = self.look()
                    if self.reason == RUNNING:
                        continue
                if self.reason != CHECK:
                    break
                self.reason = RUNNING
                if made < len(history):
                    self._check_energy()
        finally:
            self.step_history.append(history[:made])  # what was computed is kept

    def _check_energy(self):
        """Guard the run without recording a sample, unless a guard stops it."""
        self.checks += 1
        self._sample()
        self._guard()
        self._drop_sample()

    def _sample(self):
        """Take a sample."""
        observed, energies = self.observe()
        total = sum(energies.values())
        if self.energy_at_start is None:
            self.energy_at_start = total
        energies["error"] = total - self.energy_at_start
        self.energy_names = tuple(energies)
        self.sample_names = "t", *observed, *energies
        of_whole = [energy / self.share for energy in energies.values()]
        self.samples.append(np.array([self.time, *observed.values(), *of_whole]))

    def _drop_sample(self):
        """Forget the last sample."""
        self.samples.pop()

    def _guard(self):
        """Stop a run that has become unphysical, and say where."""
        row = dict(zip(self.sample_names, self.samples[-1]))
        parts = self.node_speeds()
        fastest = []
        for part, (speed, limit) in enumerate(parts):
            finite = np.isfinite(speed)
            if not finite.all():
                self.stop("a number is not finite", self.where(part, np.argmin(finite)))
            node = int(np.argmax(speed))
            fastest.append((speed[node] / limit, speed[node], part, node))
        excess, speed, *place = max(fastest)
        if self.reason == NOT_FINITE or not np.isfinite(self.samples[-1]).all():
            self.stop("a number is not finite", self.where(*place))
        for name, contact in self.contacts.items():
            message = energy_gain_message(row.get(name, 0.0), self.strike_energy)
            if message:
                self.stop(f"{contact} {message}", self.where(*place))
        if excess > 1:
            self.stop(f"a node moves at {speed:.3g} m/s", self.where(*place))
        self.guard_model()
        error = abs(row["error"]) / self.strike_energy
        if error > self.energy_error_limit:
            self.stop(
                f"the energy balance is off by {100 * error:.2g} % of the strike energy",
                self._place_of_error(self.where(*place)),
            )

    def _place_of_error(self, fastest):
        """Say where most of the energy error was made, and when, and which node is the fastest."""
        grown = np.abs(np.diff(self.sample("error")))
        last = int(np.argmax(grown)) + 1
        begin, end = 1e6 * self.sample("t")[last - 1 : last + 1]
        clauses = [f"grew most between {begin:.4g} and {end:.4g} us"]
        made = self.energy_made()
        if not made:
            return f"{fastest}, the fastest ({clauses[0]})"
        place = max(made, key=lambda name: abs(made[name]))
        clauses.insert(0, f"{made[place]:.3g} of {sum(made.values()):.3g} J")
        clauses.append(f"the fastest is {fastest}")
        return f"{place} ({'; '.join(clauses)})"

    def stop(self, message: str, where: str, when: str | None = None) -> NoReturn:
        """Stop the run: raise UnstableError."""
        raise UnstableError(message, where=where, when=when or self.when)


def run_to_end(
    solver: ExplicitSolver, hooks: Iterable[Hook], collect_result: Callable[[], Result]
) -> Result:
    """Run to the end and return collect_result(); an UnstableError carries it as `error.result`."""
    try:
        solver.run(hooks)
    except UnstableError as problem:
        problem.result = collect_result()
        raise
    return collect_result()
