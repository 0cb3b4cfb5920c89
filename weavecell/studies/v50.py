"""A ballistic limit that is a probability: repeated shots at panels of yarns that differ in
strength.

Each panel or pack is drawn anew (`strengths`).

A shot ends once its outcome is known. A projectile that has less than 1 % of its strike energy left
counts as stopped if no yarn has failed while a stress wave went to the edge and back. Were it to
perforate all the same, its residual velocity would be below a tenth of its strike velocity: by
v_r^2 = V^2 - V50^2 it was struck within 0.5 % of the limit.

Velocities are chosen in rounds of a given size from the outcomes of all rounds before: nothing
depends on the number of workers. The first round covers the deterministic limit by `FIRST` either
way; then velocities are spread evenly over the probabilities of the curve fitted so far, or, where
no stop is faster than a perforation, over the gap between them, or, where the shots determine no
curve, over the range fired so far.
Without scatter that is a search of the gap, and V50 goes to the deterministic limit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import nan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base import run_cache
from fabrics.base.errors import InputError, UndecidedError, UnstableError, WeavecellError
from fabrics.base.executors import open_executor
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.indicator import OK
from weavecell.studies import (
    assumed_range,
    ballistic_limit,
    choice,
    lambert_jonas,
    probit,
    protocol,
    strengths,
)
from weavecell.studies.assumed_range import AssumedRange
from weavecell.studies.ballistic_limit import Limit
from weavecell.studies.choice import Choice
from weavecell.studies.inputs import Scatter, read_scatter, scale_setup
from weavecell.studies.lambert_jonas import LambertJonas
from weavecell.studies.protocol import Series, SixShots

# the first shots lie this share of the deterministic limit to either side
FIRST = 0.25
# shots of a round, and the fewest
BATCH = 10
LEAST = 4
# later shots are placed between these probabilities
SPREAD = 0.05, 0.95
# share of the strike velocity, see `ballistic_limit.shoot`
STOPS_BELOW = 0.1
# shares of the lowest and the highest velocity so far, between which the next round lies
BEYOND = 0.5, 1.5
# V50 is repeated at the ends of so many of the largest contributors
LARGEST = 2
# share of the gap between stops and perforations, added beyond either end if yarns scatter
WIDER = 0.5


@dataclass(frozen=True)
class Shot:
    """One shot at one drawn panel.

    Parameters
    ----------
    number : from 0; with the seed it determines the panel
    velocity, residual : [m/s]
    perforated : bool
    modulus, crimp_warp, crimp_weft : [-] factors of the panel
    weakest : (warp, weft) [-] factor on the strength of the weakest yarn
    impact_point : (x, y) [m] from the middle of the opening; drawn where yarns are resolved
    balance : [-] error of the energy balance over the strike energy
    doubtful : names of the quality checks of the shot that are beyond their limits
    failure : why the shot has no outcome, or ""
    widened : why it was fired again with all yarns resolved, or ""
    """

    number: int
    velocity: float
    residual: float
    perforated: bool
    modulus: float
    crimp_warp: float
    crimp_weft: float
    weakest: tuple[float, float]
    impact_point: tuple[float, float]
    balance: float
    doubtful: tuple[str, ...] = ()
    failure: str = ""
    widened: str = ""

    @property
    def outcome(self) -> str:
        """ "perforated" or "stopped"."""
        return "perforated" if self.perforated else "stopped"

    @property
    def checks(self) -> str:
        """ "ok", or which of its quality checks are beyond their limits."""
        if not self.doubtful:
            return OK
        return f"doubtful: {', '.join(self.doubtful)}"


@dataclass(frozen=True)
class Study:
    """Shots, the curves fitted to them, and the deterministic limit.

    Parameters
    ----------
    deterministic : (low, high) [m/s] bracket of the limit without scatter
    shots : tuple of Shot, by number, that have an outcome
    curves : {link: probit.Curve}
    scatter : Scatter
    failures : why other shots have none: they became unstable, or neither stopped nor perforated
    assumed_range : of V50, or of the limit without scatter, over what is assumed; None if it was
        not asked for
    """

    deterministic: tuple[float, float]
    shots: tuple
    curves: dict
    scatter: Scatter
    failures: tuple[str, ...] = ()
    assumed_range: AssumedRange | None = None

    @cached_property
    def series(self) -> Series:
        """What short series of tests find, on the probit."""
        return protocol.series(self.curves["probit"])

    @cached_property
    def lambert_jonas(self) -> LambertJonas:
        """Lambert-Jonas fit to the residual velocities."""
        strikes = [shot.velocity for shot in self.shots]
        # one that is taken as stopped may have a little of its velocity left
        residuals = [shot.residual if shot.perforated else 0.0 for shot in self.shots]
        return lambert_jonas.fit(strikes, residuals)

    @property
    def six_shots(self) -> SixShots:
        """V50 of six of the shots."""
        return protocol.six_shots(*_outcomes(self.shots))

    @property
    def doubtful(self) -> int:
        """Number of shots with a quality check beyond its limit."""
        return sum(bool(shot.doubtful) for shot in self.shots)

    @property
    def widened(self) -> str:
        """How many shots were fired again with all yarns resolved, in words; "" if none was."""
        return ballistic_limit.count_widened([shot.widened for shot in self.shots])

    def summary(self) -> dict[str, Any]:
        """Return its numbers, {name with unit: value}."""
        widened = {"widened": self.widened} if self.widened else {}
        curve = self.curves["probit"]
        low, high = curve.intervals["V50"]
        return {
            "v50_m_s": curve.V50,
            "v50_low_m_s": low,
            "v50_high_m_s": high,
            "v50_reason": curve.reason,
            "v50_by_prior": curve.by_prior,
            "v50_more_shots": curve.more_shots,
            **self.six_shots.summary(),
            "confidence": curve.confidence,
            "standard_deviation_m_s": curve.deviation,
            "limit_without_scatter_m_s": sum(self.deterministic) / 2,
            "shots": len(self.shots),
            "perforated": sum(shot.perforated for shot in self.shots),
            "doubtful": self.doubtful,
            "without_outcome": len(self.failures),
            "energy_error_max": max((shot.balance for shot in self.shots), default=nan),
            "series_mean_m_s": self.series.mean,
            "series_deviation_m_s": self.series.deviation,
            "series_low_m_s": self.series.low,
            "series_high_m_s": self.series.high,
            "series_with_result": self.series.share,
            **widened,
        }


def fire(
    setup: ImpactSetup,
    scatter: Scatter,
    seed: int,
    number: int,
    velocity: float,
    stride: int | None = None,
) -> Shot:
    """Fire the shot of a number at its drawn panel; `stride` as in `strengths.draw_panel`."""
    drawn = strengths.draw_panel(setup, scatter, seed, number, stride)
    panel: dict[str, Any] = drawn.factors | {"weakest": drawn.weakest}
    panel["impact_point"] = drawn.pack.plies[0].impact_point
    try:
        (shot,) = ballistic_limit.shoot(drawn.pack, (velocity,), stops_below=STOPS_BELOW)
    # the study goes on without this shot, and counts it
    except (UndecidedError, UnstableError) as problem:
        failure = f"shot {number} of seed {seed}, {velocity:.1f} m/s: {problem}"
        return Shot(number, velocity, nan, False, **panel, balance=nan, failure=failure)
    panel["doubtful"] = tuple(check.name for check in shot.checks if check.doubtful)
    left = shot.residual_velocity
    through = shot.perforated
    panel["widened"] = shot.widened
    return Shot(number, velocity, left, through, **panel, balance=shot.balance)


def deterministic(setup: ImpactSetup, tolerance: float) -> Limit:
    """Search the limit of `ballistic_limit.critical_velocity` without scatter, on the part that the
    set-up models; its shots have no wall time, so that what is kept of a study is the same to the
    bit wherever it was computed."""
    # runs of a study share the processors: one thread each
    numerics = replace(setup.numerics, threads=1)
    found = ballistic_limit.critical_velocity(
        replace(setup, numerics=numerics).target(), tolerance=tolerance
    )
    return replace(found, shots=tuple(replace(shot, wall_time=0.0) for shot in found.shots))


def grade_mesh(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with the mesh of a study if it names none: elements of a failure length,
    twice as long as those of a shot, as far as anything can come under the nose of nearly all drawn
    panels, and of four crossovers far from it.

    A pack has the mesh of a shot.
    """
    named = setup.grading is not None or setup.elements_per_crossover is not None
    named = named or setup.crossovers is not None
    if setup.plies > 1 or named:
        return setup
    crimped = replace(setup, symmetry="whole")
    # drawn panels may have more crimp, and draw in more fabric: four deviations cover nearly all
    if setup.surface is None:
        crimp = 1 + 4 * read_scatter().crimp
        crimped = scale_setup(crimped, crimp_warp=crimp, crimp_weft=crimp)
    fine = crimped.graded(1.0, 4)
    return replace(setup, grading=fine.grading, elements_per_crossover=fine.elements_per_crossover)


def as_fired(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up that the shots of a study model: the whole panel, on its mesh."""
    return replace(grade_mesh(setup), symmetry="whole")


def usual_batch(shots: int) -> int:
    """Return the shots of a round: as many as BATCH, but half of few shots, so that outcomes decide
    velocities at least once, and at least LEAST."""
    return max(min(BATCH, shots // 2), LEAST)


def plan(velocity: ArrayLike, perforated: ArrayLike, count: int, scatters: bool) -> np.ndarray:
    """Choose the velocities (count,) [m/s] of the next round, from those of the shots so far and
    their outcomes."""
    V = np.asarray(velocity, float)
    hit = np.asarray(perforated, bool)
    least = BEYOND[0] * V.min()
    most = BEYOND[1] * V.max()
    # nothing brackets V50 yet: go on below, or above, all shots so far
    if hit.all():
        return np.linspace(least, V.min(), count, endpoint=False)
    if not hit.any():
        return np.linspace(most, V.max(), count, endpoint=False)[::-1]
    low = V[~hit].max()
    high = V[hit].min()
    # stops and perforations are apart, and a fit would have no width: fill the gap first
    if low < high:
        wider = 0.0
        if scatters:
            wider = WIDER * (high - low)
        placed = np.linspace(low - wider, high + wider, count + 2)[1:-1]
    else:
        curve = probit.fit(V, hit)
        placed = curve.velocity(np.linspace(*SPREAD, count))
        # the fit failed: spread the shots over what is known
        if curve.reason:
            placed = np.linspace(V.min(), V.max(), count)
    return np.clip(placed, least, most)


def study(
    setup: ImpactSetup,
    scatter: Scatter,
    *,
    shots: int,
    batch: int | None = None,
    seed: int = 1,
    tolerance: float = 1.0,
    stride: int | None = None,
    report: Callable[[int, int], object] = lambda done, total: None,
    **runs: Any,
) -> Study:
    """Fire shots, in rounds of `batch`, and fit the curves.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity; what it records is not used. Where it names no mesh
        that is the one of `grade_mesh`
    scatter : Scatter
    shots : how many
    batch : shots of a round; None takes `usual_batch`
    seed : of all that is drawn
    tolerance : [m/s] of the deterministic limit
    stride : as in `strengths.draw_panel`, of studies whose panels are drawn alike
    report, runs : as in `run_cache.results`, with the folder of the shots

    Raises
    ------
    InputError, UnstableError : as `ballistic_limit.critical_velocity` and `strengths.draw_panel` before
        the first shot, or too few shots
    """
    if batch is None:
        batch = usual_batch(shots)
    for key, value in (("shots", shots), ("batch", batch)):
        if value < LEAST:
            raise InputError(key=key, value=value, allowed=f"at least {LEAST}")
    # refused before the first shot
    strengths.check(setup, scatter)
    setup = _as_fired(setup)
    scatters = scatter != Scatter(gauge_length=scatter.gauge_length)
    fired: list[Shot] = []
    with open_executor(runs.get("executor", "local"), runs.get("jobs", 1)) as pool:
        # one pool serves all rounds: starting workers takes longer than many a shot
        runs["executor"] = pool
        (limit,) = run_cache.results(deterministic, [(setup, tolerance)], **runs)
        bracket = limit.low, limit.high
        while (begun := len(fired)) < shots:
            count = min(batch, shots - begun)
            # the first round has no outcomes to go by, only the limit without scatter
            if known := [shot for shot in fired if not shot.failure]:
                struck, perforated = _outcomes(known)
                velocities = plan(struck, perforated, count, scatters)
            else:
                velocities = 0.5 * sum(bracket) * np.linspace(1 - FIRST, 1 + FIRST, count)
            drawn = []
            for number, velocity in enumerate(velocities, begun):
                shot = setup, scatter, seed, number, round(float(velocity), 6)
                # one study alone finds its kept shots by these five
                drawn.append(shot if stride is None else (*shot, stride))
            fired += run_cache.results(
                fire,
                drawn,
                report=partial(lambda begun, done, _: report(begun + done, shots), begun),
                **runs,
            )
    counted = tuple(shot for shot in fired if not shot.failure)
    failures = tuple(shot.failure for shot in fired if shot.failure)
    curves = {link: _curve(counted, link) for link in probit.LINKS}
    return Study(bracket, counted, curves, scatter, failures)


def choose_yarns(setup: ImpactSetup, *, tolerance: float = 1.0, **runs: Any) -> Choice:
    """Choose between pinned and resolved yarns by the limit without scatter, that of `study` with pinned
    yarns, which finds it in its folder.

    Parameters
    ----------
    setup : set-up with `instead`
    tolerance, runs : as in `study`
    """
    pinned = choice.with_pinned(setup)
    (limit,) = run_cache.results(deterministic, [(_as_fired(pinned), tolerance)], **runs)
    return choice.choose_by_limit(setup, limit)


def _as_fired(setup):
    """The set-up on the mesh of a study, without what names no kept shot."""
    return replace(grade_mesh(setup), strike_velocity=1.0, history=None, snapshot_interval=None)


def _outcomes(shots):
    """(strike velocities [m/s], whether each perforated) of shots."""
    return [shot.velocity for shot in shots], [shot.perforated for shot in shots]


def _curve(shots, link="probit"):
    return probit.fit(*_outcomes(shots), link=link)


def run_assumed_range(
    setup: ImpactSetup,
    result: Study,
    *,
    again: bool,
    seed: int,
    tolerance: float = 1.0,
    report: Callable[[int, int], object] = lambda done, total: None,
    **runs: Any,
) -> AssumedRange | None:
    """Compute the range over what is assumed: of the limit without scatter, or of V50 itself.

    The limit is searched with each end of what is assumed. V50 then takes the ends of the LARGEST
    contributors to its range: the drawn panels of the study are shot at again, at velocities that
    are to the limit as those of the study.

    Parameters
    ----------
    setup, seed, tolerance, runs : as in `study`
    result : what `study` returned
    again : whether V50 is computed
    report : called as report(searches done, searches), and then as report(shots done, shots)
    """
    setup = _as_fired(setup)
    ends = assumed_range.changes(setup)
    middle = 0.5 * sum(result.deterministic)

    def limit_of(changed):
        (of_one,) = run_cache.results(search_limit, [(changed, tolerance)], **runs)
        return of_one

    each = [(change(setup), tolerance) for of_one in ends.values() for change in of_one.values()]
    # they run beside each other
    run_cache.results(search_limit, each, report=report, **runs)
    nominal = assumed_range.VariedRun("nominal", "", middle)
    limits = assumed_range.run_ends("limit without scatter", setup, ends, nominal, limit_of)
    curve = result.curves["probit"]
    if not again or limits is None or curve.reason:
        return limits

    def v50_of(changed):
        problem, limit = limit_of(changed)
        if limit is None:
            return problem, None
        places = [(s.number, round(limit / middle * s.velocity, 6)) for s in result.shots]
        arguments = [(changed, result.scatter, seed, *place) for place in places]
        shots = run_cache.results(fire, arguments, report=report, **runs)
        other = _curve([shot for shot in shots if not shot.failure])
        return other.reason, None if other.reason else other.V50

    largest = {name: ends[name] for name in list(limits.widths)[:LARGEST]}
    nominal = assumed_range.VariedRun("nominal", "", curve.V50)
    return assumed_range.run_ends("V50", setup, largest, nominal, v50_of)


def search_limit(setup: ImpactSetup, tolerance: float) -> tuple[str, float | None]:
    """Search the limit without scatter: ("", [m/s]), or (why there is none, None)."""
    try:
        return "", deterministic(setup, tolerance).velocity
    except WeavecellError as problem:
        return str(problem), None
