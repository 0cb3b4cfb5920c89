"""A ballistic limit that is a probability: shots at panels of which all that nobody gave is drawn.

Each panel or pack is drawn anew (`strengths`): strengths of its yarns, place and roll, and each friction
that nobody gave. The answer is the plane of `go_no_go`, which knows place and frictions of each shot.

Shots are fired in rounds of a given size, whose velocities follow from the outcomes of all rounds before:
nothing depends on the number of workers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, partial
from math import nan
from typing import Any

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError
from fabrics.base.executors import open_executor
from shellfabric.impact.setup import ImpactSetup
from weavecell.runs import go_no_go, table
from weavecell.runs.go_no_go import LimitPosterior, Outcomes
from weavecell.runs.measurement import Measurement, measure_known, rank
from weavecell.runs.span import CONFIDENCE
from weavecell.runs.table import Draw, Row, Shot
from weavecell.studies import ballistic_limit, lambert_jonas, protocol, strengths
from weavecell.studies.inputs import Scatter
from weavecell.studies.lambert_jonas import LambertJonas
from weavecell.studies.protocol import SixShots
from weavecell.studies.unknown import find_unknown

# shots of a round, and the fewest of a study. Of 16 in rounds of 4 V50 is off by 3.4 m/s, of 2 by 2.5, one by
# one by 2.3
BATCH = 2
LEAST = 4
USUAL = 16
MANY = 32  # shots that tell by how much what is drawn moves the limit; fewer tell its order at best
MOST_WITHIN = 64  # shots at most of a study that goes on until its interval is narrow enough
POPULATION = 128  # panels of which V10, V50 and V90 are those of the plane


@dataclass(frozen=True)
class Study:
    """Shots, and what they tell of the limit over all that is drawn.

    Parameters
    ----------
    shots : tuple of Shot, by number, that have an outcome
    posterior : LimitPosterior; None where outcomes are all alike
    scatter : Scatter
    unknown : {what is assumed: (low, high)} of the frictions that were drawn
    failures : why other shots have none: they became unstable, or neither stopped nor perforated
    """

    shots: tuple[Shot, ...]
    posterior: LimitPosterior | None
    scatter: Scatter
    unknown: dict[str, tuple[float, float]] = field(default_factory=dict)
    failures: tuple[str, ...] = ()

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
        fired = [(shot.velocity, shot.perforated) for shot in self.shots]
        return protocol.six_shots(*zip(*fired))

    @cached_property
    def measurements(self) -> tuple[Measurement, ...]:
        """What measurements leave of the V50 of a cloth, what narrows it most first."""
        words = "V50 of a cloth", "m/s"
        return rank(measure_known(self.posterior, self.unknown, LimitPosterior.cloths, *words))

    @property
    def doubtful(self) -> int:
        """Number of shots with a quality check beyond its limit."""
        return sum(bool(shot.doubtful) for shot in self.shots)

    def summary(self) -> dict[str, Any]:
        """Return its numbers, {name with unit: value}."""
        found: dict[str, Any] = {"v10_m_s": None, "v50_m_s": None, "v90_m_s": None}
        if self.posterior is not None:
            cloths = self.posterior.cloths()
            for name, span in (*self.posterior.velocities.items(), ("v50_of_cloth", cloths)):
                found[f"{name.lower()}_m_s"] = span.value
                found[f"{name.lower()}_low_m_s"] = span.low
                found[f"{name.lower()}_high_m_s"] = span.high
            found["shares"] = {name: share.value for name, share in self.posterior.shares.items()}
        return {
            **found,
            **self.six_shots.summary(),
            "confidence": CONFIDENCE,
            "shots": len(self.shots),
            "perforated": sum(shot.perforated for shot in self.shots),
            "doubtful": self.doubtful,
            "without_outcome": len(self.failures),
            "energy_error_max": max((shot.balance for shot in self.shots), default=nan),
        }


def study(
    setup: ImpactSetup,
    scatter: Scatter,
    *,
    shots: int,
    batch: int = BATCH,
    seed: int = 1,
    within: float = 0.0,
    stride: int | None = None,
    folder: FilePath,
    report: Callable[[int, int], object] = lambda done, total: None,
    **runs: Any,
) -> Study:
    """Fire shots, in rounds of `batch`, and fit the plane of limits.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity; what it records is not used
    scatter : Scatter
    shots : how many, at most
    batch : shots of a round
    seed : of all that is drawn
    within : [-] half width of the interval of V50, over V50, at which no more shots are fired; 0 fires all
    stride : as in `strengths.draw_panel`, of studies whose panels are drawn alike
    folder, report, runs : as in `run_cache.results`

    Raises
    ------
    InputError : as `strengths.draw_panel` before the first shot, or too few shots
    """
    for key, value, least in (("shots", shots, LEAST), ("batch", batch, 1)):
        if value < least:
            raise InputError(key=key, value=value, allowed=f"at least {least}")
    # refused before the first shot
    strengths.check(setup, scatter)
    fired_at = table.as_fired(setup)
    guess = ballistic_limit.first_guess(fired_at.target(fired_at.table(kept=True)))
    population = draw_population(fired_at, seed)
    series = Series(tuple(strengths.draw_known(fired_at, seed, 0)), guess, shots, batch)
    posterior = None

    def choose(coarse: LimitPosterior) -> tuple[ImpactSetup, float]:
        return fired_at, 1.0

    draw = partial(Draw, scatter, seed, stride=stride)
    for outcomes in series.fire(choose, draw, report, folder=folder, **runs):
        last = len(series.fired) == shots
        if outcomes.mixed and (within or last) and len(series.fired) >= min(LEAST, shots):
            posterior = go_no_go.fit(outcomes, guess, population)
            span = posterior.velocities["V50"]
            if span.half <= within * span.value:
                report(shots, shots)
                break
    counted, failures = series.sort()
    return Study(counted, posterior, scatter, find_unknown(setup), failures)


def draw_population(setup: ImpactSetup, seed: int) -> FloatArray:
    """Draw what is known of the panels (m, names) whose limits are asked for."""
    known = [strengths.draw_known(setup, seed, number) for number in range(POPULATION)]
    return np.array([[*one.values()] for one in known]).reshape(POPULATION, len(known[0]))


@dataclass
class Series:
    """Drawn shots, whose velocities follow from the outcomes of those before.

    Parameters
    ----------
    names : of what is known of each panel
    guess : [m/s] of the limit
    shots, batch : how many, at most, and those of a round
    varied : whether shots are fired at packs of several counts of plies
    fired : (plies over those of the guess, known (names,), Shot) of each so far
    """

    names: tuple[str, ...]
    guess: float
    shots: int
    batch: int
    varied: bool = False
    fired: list[tuple[float, FloatArray, Shot]] = field(default_factory=list)

    def fire(
        self,
        choose: Callable[[LimitPosterior], tuple[ImpactSetup, float]],
        draw: Callable[..., Draw],
        report: Callable[[int, int], object],
        **runs: Any,
    ) -> Iterator[Outcomes]:
        """Fire round after round, and yield the Outcomes of all shots so far after each.

        Parameters
        ----------
        choose : of the posterior so far the set-up of the next round, and its plies over those of the guess
        draw : Draw of a number
        """
        with open_executor(runs.get("executor", "local"), runs.get("jobs", 1)) as pool:
            # one pool serves all rounds: starting workers takes longer than many a shot
            runs["executor"] = pool
            while (begun := len(self.fired)) < self.shots:
                numbers = range(begun, min(begun + self.batch, self.shots))
                coarse = go_no_go.fit(self.list_outcomes(), self.guess, draws=go_no_go.COARSE)
                setup, times = choose(coarse)
                draws = [draw(number=number) for number in numbers]
                known = [self._list_known(setup, one) for one in draws]
                velocities = go_no_go.place(coarse, np.array(known), times)
                rows = [
                    Row(setup, round(float(velocity), 2), one)
                    for one, velocity in zip(draws, velocities)
                ]
                tell = partial(lambda begun, done, _: report(begun + done, self.shots), begun)
                shots = table.run(rows, report=tell, **runs)
                self.fired += [(times, *one) for one in zip(known, shots)]
                yield self.list_outcomes()

    def _list_known(self, setup, draw):
        """Return (names,) what is known of a drawn panel; 0 of what makes no difference to it."""
        found = strengths.draw_known(setup, draw.seed, draw.number)
        return np.array([found.get(name, 0.0) for name in self.names])

    def list_outcomes(self) -> Outcomes:
        """Return the Outcomes of the shots that have one."""
        counted = [one for one in self.fired if not one[2].failure]
        times = np.array([times for times, *_ in counted])
        return Outcomes(
            self.names,
            np.array([known for _, known, _ in counted]).reshape(len(counted), len(self.names)),
            np.array([shot.velocity for *_, shot in counted]),
            np.array([shot.perforated for *_, shot in counted], bool),
            times if self.varied else None,
        )

    def sort(self) -> tuple[tuple[Shot, ...], tuple[str, ...]]:
        """Return the shots that have an outcome, and why the others have none."""
        shots = [shot for *_, shot in self.fired]
        counted = tuple(shot for shot in shots if not shot.failure)
        return counted, tuple(shot.failure for shot in shots if shot.failure)
