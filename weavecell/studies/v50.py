"""A ballistic limit that is a probability: repeated shots at panels of yarns that differ in strength.

Each panel or pack is drawn anew (`strengths`).

A shot ends once its outcome is known. A projectile that has less than 1 % of its strike energy left counts as stopped
if no yarn has failed while a stress wave went to the edge and back. Were it to perforate all the same, its residual
velocity would be below a tenth of its strike velocity: by v_r^2 = V^2 - V50^2 it was struck within 0.5 % of the limit.

Velocities are chosen in rounds of a given size from the outcomes of all rounds before: nothing depends on the number
of workers. The first round covers the deterministic limit by `FIRST` either way; then velocities are spread evenly over
the probabilities of the curve fitted so far, or, where no stop is faster than a perforation, over the gap between them.
Without scatter that is a search of the gap, and V50 goes to the deterministic limit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics import run_cache
from fabrics.errors import InputError, UnstableError
from fabrics.executors import open_executor
from shellfabric.impact import ballistic_limit, lambert_jonas
from shellfabric.impact.lambert_jonas import LambertJonas
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel import boundary
from weavecell.studies import probit, protocol, strengths
from weavecell.studies.inputs import Scatter, changed_setup, published
from weavecell.studies.protocol import Series

FIRST = 0.25  # of the deterministic limit, either way
SPREAD = 0.05, 0.95  # probabilities between which the later shots are placed
STOPS_BELOW = 0.1  # of the strike velocity, see `ballistic_limit.shoot`
WIDER = 0.5  # of the gap between stops and perforations, beyond either end, where yarns scatter


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
    balance : [-] error of the energy balance over the strike energy
    doubtful : names of the quality checks of the shot that are beyond their limits
    """

    number: int
    velocity: float
    residual: float
    perforated: bool
    modulus: float
    crimp_warp: float
    crimp_weft: float
    weakest: tuple[float, float]
    balance: float
    doubtful: tuple[str, ...] = ()


@dataclass(frozen=True)
class Study:
    """Shots, the curves fitted to them, and the deterministic limit.

    Parameters
    ----------
    deterministic : (low, high) [m/s] bracket of the limit without scatter
    shots : tuple of Shot, by number
    curves : {link: probit.Curve}
    scatter : Scatter
    """

    deterministic: tuple[float, float]
    shots: tuple
    curves: dict
    scatter: Scatter

    @cached_property
    def series(self) -> Series:
        """What short series of tests find, on the probit."""
        return protocol.series(self.curves["probit"])

    @cached_property
    def fit(self) -> LambertJonas | None:
        """Lambert-Jonas fit to the residual velocities; None of fewer than four perforations."""
        through = [(shot.velocity, shot.residual) for shot in self.shots if shot.perforated]
        return lambert_jonas.fit(*zip(*through)) if len(through) > 3 else None

    @property
    def doubtful(self) -> int:
        """Number of shots with a quality check beyond its limit."""
        return sum(bool(shot.doubtful) for shot in self.shots)

    def summary(self) -> dict[str, Any]:
        """Its numbers, {name with unit: value}."""
        curve = self.curves["probit"]
        low, high = curve.intervals["V50"]
        return {
            "v50_m_s": curve.V50,
            "v50_low_m_s": low,
            "v50_high_m_s": high,
            "confidence": curve.confidence,
            "standard_deviation_m_s": curve.deviation,
            "limit_without_scatter_m_s": sum(self.deterministic) / 2,
            "shots": len(self.shots),
            "perforated": sum(shot.perforated for shot in self.shots),
            "doubtful": self.doubtful,
            "energy_error_max": max(shot.balance for shot in self.shots),
            **{
                f"series_{name}_m_s": getattr(self.series, name)
                for name in ("mean", "deviation", "low", "high")
            },
            "series_with_result": self.series.share,
        }


def fire(setup: ImpactSetup, scatter: Scatter, seed: int, number: int, velocity: float) -> Shot:
    """The shot of a number at its drawn panel."""
    drawn = strengths.drawn(setup, scatter, seed, number)
    try:
        (shot,) = ballistic_limit.shoot(drawn.pack, (velocity,), stops_below=STOPS_BELOW)
    except UnstableError as problem:
        raise UnstableError(str(problem), when=f"shot {number} of seed {seed}") from None
    left, through, weakest, balance = (
        shot.residual_velocity,
        shot.perforated,
        drawn.weakest,
        shot.balance,
    )
    doubtful = tuple(check.name for check in shot.checks if check.doubtful)
    return Shot(
        number,
        velocity,
        left,
        through,
        **drawn.factors,
        weakest=weakest,
        balance=balance,
        doubtful=doubtful,
    )


def deterministic(setup: ImpactSetup, tolerance: float) -> tuple[float, float]:
    """(low, high) [m/s] of `ballistic_limit.critical_velocity` without scatter, on the part that the set-up models."""
    numerics = replace(setup.numerics, threads=1)
    limit = ballistic_limit.critical_velocity(
        replace(setup, numerics=numerics).target(), tolerance=tolerance
    )
    return limit.low, limit.high


def graded(setup: ImpactSetup) -> ImpactSetup:
    """The set-up with the mesh of a study where it names none: elements of a failure length, twice as long as those of
    a shot, as far as anything can come under the nose of nearly all drawn panels, and of four crossovers far from it.

    A pack has the mesh of a shot. Edges that are not clamped or no lines of the grid (oblique weaves, round openings,
    impacts off the middle), oblique shots and sliding crossovers have the uniform mesh; so has
    `elements_per_crossover = 1`.
    """
    named = (
        setup.grading is not None
        or setup.elements_per_crossover is not None
        or setup.crossovers is not None
    )
    clamped = all(side == "clamped" for pair in boundary.sides(setup.edge) for side in pair)
    stepped = setup.weave_angle != 0 or setup.round or any(setup.struck_at)
    if setup.plies > 1 or named:
        return setup
    if not clamped or setup.projectile.roaming or stepped:
        return replace(setup, elements_per_crossover=setup.resolved_elements_per_crossover)
    crimped = replace(setup, symmetry="whole")
    if setup.surface is None:
        crimp = 1 + 4 * published().crimp
        crimped = changed_setup(crimped, crimp_warp=crimp, crimp_weft=crimp)
    return replace(setup, grading=crimped.graded(1.0, 4).grading)


def plan(velocity: ArrayLike, perforated: ArrayLike, count: int, scatters: bool) -> np.ndarray:
    """(count,) [m/s] velocities of the next round, from those of the shots so far and their outcomes."""
    V, hit = np.asarray(velocity, float), np.asarray(perforated, bool)
    if hit.all():
        return np.linspace(0.5, 1.0, count, endpoint=False) * V.min()
    if not hit.any():
        return np.linspace(1.5, 1.0, count, endpoint=False)[::-1] * V.max()
    low, high = V[~hit].max(), V[hit].min()
    if low < high:
        wider = WIDER * (high - low) if scatters else 0.0
        return np.linspace(low - wider, high + wider, count + 2)[1:-1]
    return probit.fit(V, hit).velocity(np.linspace(*SPREAD, count))


def study(
    setup: ImpactSetup,
    scatter: Scatter,
    *,
    shots: int,
    batch: int = 10,
    seed: int = 1,
    tolerance: float = 1.0,
    report: Callable[[int, int], object] = lambda done, total: None,
    **runs: Any,
) -> Study:
    """Fire shots, in rounds of `batch`, and fit the curves.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity; what it records is not used. Where it names no mesh that is
        the one of `graded`
    scatter : Scatter
    shots : how many
    batch : shots of a round
    seed : of all that is drawn
    tolerance : [m/s] of the deterministic limit
    report, runs : as of `run_cache.results`, with the folder of the shots

    Raises
    ------
    InputError, UnstableError : as `ballistic_limit.critical_velocity` and `strengths.drawn`, or too few shots
    """
    for key, value in (("shots", shots), ("batch", batch)):
        if value < 4:
            raise InputError(key=key, value=value, allowed="at least 4")
    strengths.check(setup, scatter)
    setup = replace(
        graded(setup), strike_velocity=1.0, history=None, snapshot_interval=None
    )  # which name no kept shot
    scatters = scatter != Scatter(gauge_length=scatter.gauge_length)
    fired: list[Shot] = []
    with open_executor(runs.get("executor", "local"), runs.get("jobs", 1)) as pool:
        runs["executor"] = pool
        (bracket,) = run_cache.results(deterministic, [(setup, tolerance)], **runs)
        while (begun := len(fired)) < shots:
            count = min(batch, shots - begun)
            if fired:
                velocities = plan(
                    [s.velocity for s in fired], [s.perforated for s in fired], count, scatters
                )
            else:
                velocities = 0.5 * sum(bracket) * np.linspace(1 - FIRST, 1 + FIRST, count)
            fired += run_cache.results(
                fire,
                [
                    (setup, scatter, seed, begun + k, round(float(V), 6))
                    for k, V in enumerate(velocities)
                ],
                report=partial(lambda begun, done, _: report(begun + done, shots), begun),
                **runs,
            )
    V, hit = [shot.velocity for shot in fired], [shot.perforated for shot in fired]
    curves = {link: probit.fit(V, hit, link=link) for link in probit.LINKS}
    return Study(bracket, tuple(fired), curves, scatter)
