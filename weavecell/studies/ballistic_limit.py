"""Critical velocity (ballistic limit) of a panel or pack: the velocity between the last stop and
the first perforation.

A shot of a deterministic model either stops or perforates, so that two shots with different
outcomes bracket the critical velocity (thesis section 5.2.3, Figure 5-51). The bracket is found
from a first guess by steps that grow, then halved until it is as narrow as the tolerance. Panel and
table of the cell are made once for all shots, a shot ends as soon as its outcome is known, and the
residual velocities are kept for a Lambert-Jonas fit (`lambert_jonas`).

Shots can be fired beside each other: while one is under way, those that would follow from either of
its outcomes are begun, and given up if they turn out not to be needed. The shots that count, and
the result, are the same with any executor and number of workers.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from math import inf, log, sqrt

import numpy as np

from fabrics.base import run_cache
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, UndecidedError, UnstableError
from fabrics.base.executors import cancel, open_executor
from fabrics.yarn import striking_velocity
from shellfabric.impact.attempts import Attempt
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.driver import STOPPED
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import indicator, quality
from shellfabric.membrane.model import Panel
from shellfabric.plies.model import Pack
from weavecell.studies import inputs
from weavecell.studies.bracket import STEP, Bracket

UNDECIDED = 5e-3  # [s] after which a shot that has neither stopped nor perforated is given up
# [s] a shot that has neither stopped nor perforated by then is given up
_AUDIT = 10e-6
# [s] between audits, which nothing but the guards of the solver uses
# one ply is first tried at this share of the velocity that fails a lone yarn at once; the share
# rises with this power of the number of plies (177 and 237 m/s of two and four plies of S-728, 140
# of one). Only the number of shots depends on both
_GUESS = 0.17
_RISES = 1 / 3


@dataclass(frozen=True)
class Shot:
    """One shot.

    Parameters
    ----------
    strike_velocity, residual_velocity : [m/s]; the residual velocity of a projectile that stops is
        0
    outcome : "stopped" or "perforated"
    time : [s] from strike to stop or perforation
    cut_yarns : of the whole panel, of all plies
    peak_tension : (warp, weft) [N] the highest of any ply, in its own weave
    balance : [-] error of the energy balance over the strike energy, the worst of the run
    wall_time : [s] of the time integration
    checks : tuple of Indicator
    deflection : [m] the largest; NaN of a shot that perforates
    """

    strike_velocity: float
    residual_velocity: float
    outcome: str
    time: float
    cut_yarns: float
    peak_tension: tuple[float, float]
    balance: float
    wall_time: float
    checks: tuple = ()
    deflection: float = 0.0

    @property
    def perforated(self) -> bool:
        return self.outcome == "perforated"

    @property
    def status(self) -> str:
        """ "ok", "noted" or "doubtful": that of its worst check."""
        return indicator.status(self.checks)


@dataclass(frozen=True)
class Limit:
    """The critical velocity, in a bracket.

    Parameters
    ----------
    low, high : [m/s] the fastest shot that stopped and the slowest that perforated, of the
        bisection
    shots : tuple of Shot, in the order in which they were fired
    """

    low: float
    high: float
    shots: tuple[Shot, ...]

    @property
    def velocity(self) -> float:
        """[m/s] middle of the bracket."""
        return 0.5 * (self.low + self.high)

    @property
    def half_width(self) -> float:
        """[m/s] of the bracket."""
        return 0.5 * (self.high - self.low)

    @property
    def ends(self) -> tuple[Shot, ...]:
        """The shots at the ends of the bracket, and of the zone of mixed outcomes, by strike
        velocity."""
        velocities = sorted({self.low, self.high, *(self.mixed_zone or ())})
        return tuple(shot for v in velocities for shot in self.shots if shot.strike_velocity == v)

    @property
    def highest_stop(self) -> float:
        """[m/s] strike velocity of the fastest shot that stopped, of all shots."""
        return max(
            (shot.strike_velocity for shot in self.shots if not shot.perforated), default=self.low
        )

    @property
    def lowest_perforation(self) -> float:
        """[m/s] strike velocity of the slowest shot that perforated, of all shots."""
        return min(
            (shot.strike_velocity for shot in self.shots if shot.perforated), default=self.high
        )

    @property
    def mixed_zone(self) -> tuple[float, float] | None:
        """(lowest perforation, highest stop) [m/s] where a shot stopped that was faster than one
        that perforated;
        None if the shots know of a single limit. A bisection alone never finds one; see
        `limit_scan`."""
        zone = self.lowest_perforation, self.highest_stop
        if zone[0] < zone[1]:
            return zone
        return None

    @property
    def single(self) -> bool:
        """Whether the shots know of one limit only: none stopped that was faster than one that
        perforated."""
        return self.mixed_zone is None


class KeptShots:
    """Shots of a panel in a folder, from which an interrupted search goes on.

    Parameters
    ----------
    folder : of the shots; None keeps nothing
    setup : whose panel they are fired at
    """

    def __init__(self, folder: FilePath | None, setup: ImpactSetup) -> None:
        self._cache = None
        if folder is not None:
            self._cache = run_cache.RunCache(folder)
        self._setup = inputs.use_one_thread(setup, strike_velocity=1.0)

    def of(self, velocity: float, stops_below: float) -> Shot | None:
        """Return the shot at a velocity, if there is one."""
        if self._cache is None:
            return None
        with suppress(KeyError):
            return self._cache[self._key(velocity, stops_below)]
        return None

    def keep(self, shot: Shot, velocity: float, stops_below: float) -> None:
        """Keep a shot."""
        if self._cache is not None:
            self._cache[self._key(velocity, stops_below)] = shot

    def _key(self, velocity, stops_below):
        return run_cache.key((self._setup, float(velocity), float(stops_below)), __name__)


def first_guess(panel: Panel | Pack) -> float:
    """Guess a velocity [m/s] to begin with: a share of that which fails the weaker yarn at once, by
    Smith's theory."""
    plies = Pack.of(panel).plies
    own = {id(ply.fabric): ply.fabric for ply in plies}.values()
    alone = inf
    for fabric in own:
        for yarn in fabric.weave.yarns:
            alone = min(alone, striking_velocity(yarn.wave_speed, yarn.failure_strain))
    return _GUESS * alone * len(plies) ** _RISES


def critical_velocity(
    panel: Panel | Pack,
    *,
    tolerance: float = 1.0,
    guess: float | None = None,
    step: float = STEP,
    highest: float = 1000.0,
    executor: str | Executor = "local",
    jobs: int = 1,
    report: Callable[..., object] | None = None,
    kept: KeptShots | None = None,
) -> Limit:
    """Bisect for the critical velocity of a panel or pack.

    Parameters
    ----------
    panel : Panel or Pack; its table of the cell serves all shots
    tolerance : [m/s] at most between a stop and a perforation
    guess : [m/s] where to begin; `first_guess` if None
    step : first factor from the guess towards the other outcome: the better the guess, the nearer
        to 1
    highest : [m/s] beyond which no shot is fired; nor is one below the tolerance
    executor : as in `fabrics.base.executors.open_executor`; "local": threads of this process
    jobs : shots that are under way beside each other
    report : called as report(share of the work done, Shot) after each shot
    kept : shots that are not fired again, to which each is added

    Returns
    -------
    Limit

    Raises
    ------
    InputError : a panel with no limit between `tolerance` and `highest`
    UndecidedError : a shot that neither stops nor perforates within UNDECIDED; its `shots` are
        those before it
    UnstableError : a shot became unphysical; its attribute `shots` holds those that had ended
    """
    guess = guess or first_guess(panel)
    _check(tolerance=tolerance, highest=highest, jobs=jobs, guess=guess)
    if not step > 1:
        raise InputError(key="step", value=step, allowed="above 1")
    bracket = Bracket(min(max(guess, tolerance), highest), tolerance, highest, factor=step)
    shots: list[Shot] = []
    with _Range(panel, executor, jobs, kept=kept) as shooting:
        while bracket.width > tolerance:
            if bracket.exhausted:
                always = "lets the projectile through"
                if bracket.low > 0:
                    always = "stops the projectile"
                raise InputError(
                    f"the panel {always} at any velocity from {tolerance:g} to {highest:g} m/s"
                )
            wanted = bracket.predict(jobs, tolerance)
            shooting.only(wanted)
            shots.append(_result(shooting, wanted[0], shots))
            bracket = bracket.update(shots[-1].perforated)
            if report is not None:
                report(_measure_progress(bracket, tolerance), shots[-1])
    return Limit(bracket.low, bracket.high, tuple(shots))


def shoot(
    panel: Panel | Pack,
    velocities: Sequence[float] | FloatArray,
    *,
    executor: str | Executor = "local",
    jobs: int = 1,
    report: Callable[..., object] | None = None,
    stops_below: float = 0.0,
    kept: KeptShots | None = None,
) -> tuple[Shot, ...]:
    """Fire shots at given velocities; a tuple of Shot, in their order.

    Parameters
    ----------
    panel, executor, jobs, report, kept : as in `critical_velocity`
    velocities : (n,) [m/s] strike velocities
    stops_below : share of the strike velocity below which a projectile counts as stopped where no
        yarn has failed for as long as a stress wave takes to an edge and back. The outcome is then
        known sooner; time and peak tensions are those up to then

    Raises
    ------
    InputError, UndecidedError, UnstableError : as in `critical_velocity`
    """
    _check(jobs=jobs, **{f"velocities[{i}]": v for i, v in enumerate(velocities)})
    shots: list[Shot] = []
    with _Range(panel, executor, jobs, stops_below, kept) as shooting:
        shooting.only(velocities)
        for number, velocity in enumerate(velocities, 1):
            shots.append(_result(shooting, velocity, shots))
            if report is not None:
                report(number / len(velocities), shots[-1])
    return tuple(shots)


def _check(**values):
    for key, value in values.items():
        if not 0 < value < inf:
            raise InputError(key=key, value=value, allowed="above 0")


def _measure_progress(bracket, tolerance):
    """Share of the bisection that is done; one whose bracket is open has hardly begun."""
    if not bracket.closed:
        return 0.05
    first = bracket.guess * (STEP - 1)
    return min(
        1.0,
        max(0.1, 1 - log(max(bracket.width / tolerance, 1.0)) / log(max(first / tolerance, 2.0))),
    )


def _result(shooting, velocity, before):
    """The shot at a velocity; an error names its velocity and carries the shots before it."""
    try:
        return shooting.result(velocity)
    except UndecidedError as problem:
        problem.shots = tuple(before)
        raise
    except UnstableError as problem:
        named = UnstableError(str(problem), when=f"of the shot at {velocity:.4g} m/s")
        named.shots = tuple(before)
        raise named from None


class _GivenUp(Exception):
    """Ends a shot that is no longer wanted."""


class _Range:
    """Shots at one panel, each begun when it is first wanted and kept until it is requested.

    Locally threads suffice: the kernels hold no lock. Shots that are fired beside each other have
    one thread each, unless the panel sets more. A shot of another process cannot be given up: one
    that is no longer wanted goes on to its end.
    """

    def __init__(self, panel, executor, jobs, stops_below=0.0, kept=None):
        self.threads = executor == "local"
        self.kept = kept
        if jobs > 1 or not self.threads:
            self.panel = _use_one_thread(panel)
        else:
            self.panel = panel
        self.stops_below = stops_below
        if self.threads:
            self.opened = ThreadPoolExecutor(jobs)
        else:
            self.opened = open_executor(executor, jobs)
        # {velocity: (future, event that gives it up, or None)}
        self.pending = {}

    def __enter__(self):
        self.pool = self.opened.__enter__()
        return self

    def __exit__(self, *problem):
        self.only(())
        return self.opened.__exit__(*problem)

    def only(self, velocities):
        """Begin the shots that are wanted and not under way; give up those that are under way and
        not wanted."""
        for velocity in set(self.pending) - set(velocities):
            future, give_up = self.pending.pop(velocity)
            if give_up is not None:
                give_up.set()
            cancel(future)
        for velocity in velocities:
            if velocity not in self.pending:
                self.pending[velocity] = self._begun(velocity)

    def _begun(self, velocity):
        """(future, event that gives it up, or None) of a shot: one that is kept, or one that is
        fired."""
        shot = None
        if self.kept is not None:
            shot = self.kept.of(velocity, self.stops_below)
        if shot is not None:
            known: Future = Future()
            known.set_result(shot)
            return known, None
        give_up = None
        if self.threads:
            give_up = threading.Event()
        fire = _fire
        if self.stops_below > 0:
            fire = partial(_fire, stops_below=self.stops_below)
        return self.pool.submit(fire, self.panel, velocity, give_up), give_up

    def result(self, velocity):
        """Wait for a shot."""
        shot = self.pending[velocity][0].result()
        del self.pending[velocity]
        if self.kept is not None:
            self.kept.keep(shot, velocity, self.stops_below)
        return shot


def _use_one_thread(panel):
    """The pack with one thread where no number is given; plies that are one stay one."""
    pack = Pack.of(panel)
    own = {id(ply): ply for ply in pack.plies}
    for key, ply in own.items():
        own[key] = replace(ply, numerics=replace(ply.numerics, threads=ply.numerics.threads or 1))
    return replace(pack, plies=tuple(own[id(ply)] for ply in pack.plies))


def _round_trip(panel):
    """[s] of a stress wave from the impact point to the further edge and back: sqrt 2 longer than
    along a lone yarn."""
    longest = 0.0
    for ply in Pack.of(panel).plies:
        for x, yarn in zip(ply.lines(), ply.weave.yarns):
            longest = max(longest, 2 * sqrt(2) * abs(x).max() / yarn.wave_speed)
    return longest


def _fire(panel, velocity, give_up, stops_below=0.0):
    quiet = 0.0
    if stops_below > 0:
        quiet = _round_trip(panel)

    def hook(solver):
        if give_up is not None and give_up.is_set():
            raise _GivenUp
        if stops_below > 0 and not solver.ended and solver.sample("v")[-1] < stops_below * velocity:
            lost = solver.sample("failure_dissipation")[solver.sample("t") >= solver.time - quiet]
            if lost[0] == lost[-1]:
                solver.reason = STOPPED

    def shoot_once(attempt):
        solver = PackSolver(attempt.target, velocity, UNDECIDED, interval=_AUDIT)
        solver.stack.after_stop = 0.0
        return solver.run((hook,))

    attempt = Attempt(Pack.of(panel))
    while True:
        solver = shoot_once(attempt)
        following = attempt.follow(solver)
        if following is None:
            break
        attempt = following
    if solver.outcome == "in flight":
        problem = f"the projectile struck at {velocity:.4g} m/s has neither stopped nor perforated"
        raise UndecidedError(
            f"{problem} after {1e3 * UNDECIDED:g} ms; such a panel has no critical velocity"
        )
    peaks = np.array([state.peak_tension for state in solver.states])
    return Shot(
        strike_velocity=float(velocity),
        residual_velocity=solver.residual_velocity,
        outcome=solver.outcome,
        time=solver.time,
        cut_yarns=float(solver.sample("cut_yarns")[-1]),
        peak_tension=tuple(map(float, peaks.max(axis=0))),
        balance=float(abs(solver.sample("error")).max()) / solver.strike_energy,
        wall_time=solver.wall_time,
        checks=quality.of_solver(solver),
        deflection=solver.largest_deflection,
    )
