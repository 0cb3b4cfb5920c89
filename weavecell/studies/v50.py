"""A ballistic limit that is a probability: shots at panels of which all that nobody gave is drawn.

Each panel or pack is drawn anew (`strengths`): strengths of its yarns, place and roll, and each friction
that nobody gave. The answer is the plane of `drawn`, which knows place and frictions of each shot.

A shot ends once its outcome is known. A projectile that has less than 1 % of its strike energy left
counts as stopped if no yarn has failed while a stress wave went to the edge and back. Were it to
perforate all the same, its residual velocity would be below a tenth of its strike velocity: by
v_r^2 = V^2 - V50^2 it was struck within 0.5 % of the limit.

Shots are fired in rounds of a given size, whose velocities follow from the outcomes of all rounds before:
nothing depends on the number of workers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import nan
from typing import Any

import numpy as np

from fabrics.base import run_cache
from fabrics.base.errors import InputError, UndecidedError, UnstableError
from fabrics.base.executors import open_executor
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.indicator import OK
from weavecell.studies import ballistic_limit, drawn, lambert_jonas, places, protocol, strengths
from weavecell.studies.drawn import LimitPosterior, Outcomes
from weavecell.studies.inputs import Scatter, read_scatter, scale_setup
from weavecell.studies.lambert_jonas import LambertJonas
from weavecell.studies.protocol import SixShots
from weavecell.studies.unknown import find_unknown

# shots of a round, and the fewest of a study. Of 16 in rounds of 4 V50 is off by 3.4 m/s, of 2 by 2.5, one by
# one by 2.3
BATCH = 2
LEAST = 4
# share of the strike velocity, see `ballistic_limit.shoot`
STOPS_BELOW = 0.1
POPULATION = 256  # panels of which V10, V50 and V90 are those of the plane


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
    frictions : {column: [-] where nobody gave it, else None}
    balance : [-] error of the energy balance over the strike energy
    doubtful : names of the quality checks of the shot that are beyond their limits
    failure : why the shot has no outcome, or ""
    widened : why it was fired again with all yarns resolved, or ""
    deflection : [m] the largest
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
    frictions: dict[str, float | None]
    balance: float
    doubtful: tuple[str, ...] = ()
    failure: str = ""
    widened: str = ""
    deflection: float = nan

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
    """Shots, and what they tell of the limit over all that is drawn.

    Parameters
    ----------
    shots : tuple of Shot, by number, that have an outcome
    posterior : LimitPosterior; None where outcomes are all alike
    scatter : Scatter
    unknown : {what is assumed: (low, high)} of the frictions that were drawn
    failures : why other shots have none: they became unstable, or neither stopped nor perforated
    """

    shots: tuple
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
        found: dict[str, Any] = {"v10_m_s": None, "v50_m_s": None, "v90_m_s": None}
        if self.posterior is not None:
            for name, span in self.posterior.velocities.items():
                found[f"{name.lower()}_m_s"] = span.value
                found[f"{name.lower()}_low_m_s"] = span.low
                found[f"{name.lower()}_high_m_s"] = span.high
            found["shares"] = {name: share.value for name, share in self.posterior.shares.items()}
        return {
            **found,
            **self.six_shots.summary(),
            "confidence": drawn.CONFIDENCE,
            "shots": len(self.shots),
            "perforated": sum(shot.perforated for shot in self.shots),
            "doubtful": self.doubtful,
            "without_outcome": len(self.failures),
            "energy_error_max": max((shot.balance for shot in self.shots), default=nan),
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
    panel_of = strengths.draw_panel(setup, scatter, seed, number, stride)
    panel: dict[str, Any] = panel_of.factors | {"weakest": panel_of.weakest}
    panel["impact_point"] = panel_of.pack.plies[0].impact_point
    panel["frictions"] = panel_of.frictions
    try:
        (shot,) = ballistic_limit.shoot(panel_of.pack, (velocity,), stops_below=STOPS_BELOW)
    # the study goes on without this shot, and counts it
    except (UndecidedError, UnstableError) as problem:
        failure = f"shot {number} of seed {seed}, {velocity:.1f} m/s: {problem}"
        return Shot(number, velocity, nan, False, **panel, balance=nan, failure=failure)
    panel["doubtful"] = tuple(check.name for check in shot.checks if check.doubtful)
    left = shot.residual_velocity
    through = shot.perforated
    panel["widened"] = shot.widened
    panel["deflection"] = shot.deflection
    return Shot(number, velocity, left, through, **panel, balance=shot.balance)


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
    """Return the set-up that the shots of a study model: the whole panel of resolved yarns, unless the
    input pins them, on its mesh."""
    if setup.instead is not None:
        setup = places.resolve(setup)
    return replace(grade_mesh(setup), symmetry="whole")


def study(
    setup: ImpactSetup,
    scatter: Scatter,
    *,
    shots: int,
    batch: int = BATCH,
    seed: int = 1,
    guess: float | None = None,
    stride: int | None = None,
    report: Callable[[int, int], object] = lambda done, total: None,
    **runs: Any,
) -> Study:
    """Fire shots, in rounds of `batch`, and fit the plane of limits.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity; what it records is not used
    scatter : Scatter
    shots : how many
    batch : shots of a round
    seed : of all that is drawn
    guess : [m/s] of the limit; None takes `ballistic_limit.first_guess`
    stride : as in `strengths.draw_panel`, of studies whose panels are drawn alike
    report, runs : as in `run_cache.results`, with the folder of the shots

    Raises
    ------
    InputError : as `strengths.draw_panel` before the first shot, or too few shots
    """
    for key, value, least in (("shots", shots, LEAST), ("batch", batch, 1)):
        if value < least:
            raise InputError(key=key, value=value, allowed=f"at least {least}")
    # refused before the first shot
    strengths.check(setup, scatter)
    setup = replace(as_fired(setup), strike_velocity=1.0, history=None, snapshot_interval=None)
    guess = guess or ballistic_limit.first_guess(setup.target(setup.table(kept=True)))
    known = [strengths.draw_known(setup, seed, number) for number in range(max(shots, POPULATION))]
    names = tuple(known[0])
    table = np.array([[*one.values()] for one in known]).reshape(len(known), len(names))
    fired: list[Shot] = []
    outcomes = None
    with open_executor(runs.get("executor", "local"), runs.get("jobs", 1)) as pool:
        # one pool serves all rounds: starting workers takes longer than many a shot
        runs["executor"] = pool
        while (begun := len(fired)) < shots:
            numbers = range(begun, min(begun + batch, shots))
            velocities = drawn.place(outcomes, table[numbers], guess)
            arguments = []
            for number, velocity in zip(numbers, velocities):
                shot = setup, scatter, seed, number, round(float(velocity), 6)
                # one study alone finds its kept shots by these five
                arguments.append(shot if stride is None else (*shot, stride))
            fired += run_cache.results(
                fire,
                arguments,
                report=partial(lambda begun, done, _: report(begun + done, shots), begun),
                **runs,
            )
            counted = tuple(shot for shot in fired if not shot.failure)
            if counted:
                outcomes = Outcomes(
                    names,
                    table[[shot.number for shot in counted]],
                    np.array([shot.velocity for shot in counted]),
                    np.array([shot.perforated for shot in counted]),
                )
    posterior = None
    if outcomes is not None and outcomes.mixed:
        posterior = LimitPosterior(drawn.fit(outcomes, guess), table[:POPULATION])
    failures = tuple(shot.failure for shot in fired if shot.failure)
    return Study(counted, posterior, scatter, find_unknown(setup), failures)


def _outcomes(shots):
    """(strike velocities [m/s], whether each perforated) of shots."""
    return [shot.velocity for shot in shots], [shot.perforated for shot in shots]
