"""One scene shot many times at panels whose yarns differ in strength: mean, scatter, probability of perforation.

Strengths are drawn as for V50 (`strengths`), from seed and number of the draw alone, so that nothing depends on the
number of workers. All else is the scene's.

The result of a single shot near the limit is a staircase in velocity and mesh, since yarns fail one by one; the mean
over draws is not. It has the standard error s / sqrt(n). The share of perforations has Wilson's interval.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import run_cache
from fabrics.errors import InputError
from shellfabric.impact.simulation import fired
from weavecell.studies import inputs, strengths
from weavecell.studies.inputs import Scatter

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup

QUANTITIES = {  # of a Draw: unit, words
    "residual_velocity": ("m/s", "residual velocity"),
    "absorbed_energy": ("J", "absorbed energy"),
    "peak_tension_warp": ("N", "peak tension, warp"),
    "peak_tension_weft": ("N", "peak tension, weft"),
    "cut_yarns": ("", "cut yarns"),
}
OUTCOMES = ("stopped", "perforated", "in flight", "unstable")
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Draw:
    """One shot at one drawn panel or pack.

    Parameters
    ----------
    number : from 0; with the seed it determines the strengths
    outcome : of OUTCOMES
    residual_velocity : [m/s] along the panel's normal
    absorbed_energy : [J] that the projectile has lost
    peak_tension_warp, peak_tension_weft : [N] highest of any ply over the run
    cut_yarns : at the end, of all plies
    time : [s] end of the run
    weakest : [-] factor on the strength of the weakest yarn
    balance : [-] largest error of the energy balance over the strike energy
    """

    number: int
    outcome: str
    residual_velocity: float
    absorbed_energy: float
    peak_tension_warp: float
    peak_tension_weft: float
    cut_yarns: float
    time: float
    weakest: float
    balance: float


@dataclass(frozen=True)
class Estimate:
    """Mean of n draws, standard deviation (of n - 1) and standard error of the mean."""

    mean: float
    deviation: float
    error: float


@dataclass(frozen=True)
class Draws:
    """All draws; those that became unstable count in none of the estimates.

    Parameters
    ----------
    draws : tuple of Draw, by number
    scatter : Scatter of the strengths
    seed : of all that was drawn
    """

    draws: tuple[Draw, ...]
    scatter: Scatter
    seed: int

    @property
    def counted(self) -> tuple[Draw, ...]:
        """Draws that did not become unstable."""
        return tuple(draw for draw in self.draws if draw.outcome != "unstable")

    def estimate(self, quantity: str) -> Estimate:
        """The Estimate of one of `QUANTITIES`; not a number of no draws, or of one its deviation."""
        values = np.array([getattr(draw, quantity) for draw in self.counted])
        deviation = float(values.std(ddof=1)) if values.size > 1 else nan
        return Estimate(
            float(values.mean()) if values.size else nan,
            deviation,
            deviation / sqrt(max(values.size, 1)),
        )

    @property
    def outcomes(self) -> dict[str, int]:
        """{outcome: number of draws} of `OUTCOMES`."""
        return {name: sum(draw.outcome == name for draw in self.draws) for name in OUTCOMES}

    def probability(self) -> tuple[float, float, float]:
        """(share of perforations, low, high), with Wilson's interval of `CONFIDENCE`; (NaN, 0, 1) of no draws."""
        from scipy.stats import binomtest

        if not self.counted:
            return nan, 0.0, 1.0
        test = binomtest(self.outcomes["perforated"], len(self.counted))
        interval = test.proportion_ci(CONFIDENCE, method="wilson")
        return float(test.statistic), float(interval.low), float(interval.high)

    def summary(self) -> dict[str, Any]:
        """All of it as a flat dict of numbers, keys with their units."""
        share, low, high = self.probability()
        return {
            "draws": len(self.draws),
            **{outcome.replace(" ", "_"): count for outcome, count in self.outcomes.items()},
            "probability_of_perforation": share,
            "probability_low": low,
            "probability_high": high,
            "confidence": CONFIDENCE,
            "seed": self.seed,
            "weibull_shape": self.scatter.shape,
            "gauge_length_m": self.scatter.gauge_length,
            **{
                f"{name}_{part}_{unit.replace('/', '_')}".rstrip("_"): value
                for name, (unit, _) in QUANTITIES.items()
                for part, value in vars(self.estimate(name)).items()
            },
        }


def fire(setup: ImpactSetup, scatter: Scatter, seed: int, number: int) -> Draw:
    """The shot of a number at the whole panel."""
    drawn = strengths.drawn(setup, scatter, seed, number)
    result, problem = fired(setup, target=drawn.pack)
    warp, weft = result.peak_tension
    return Draw(
        number=number,
        outcome="unstable" if problem else result.outcome,
        residual_velocity=float(result.residual_velocity),
        absorbed_energy=result.absorbed_energy,
        peak_tension_warp=float(warp),
        peak_tension_weft=float(weft),
        cut_yarns=float(result.cut_yarns[-1]),
        time=float(result.t[-1]),
        weakest=min(drawn.weakest),
        balance=float(result.energy_error_max),
    )


def study(setup: ImpactSetup, scatter: Scatter, count: int, *, seed: int = 1, **runs: Any) -> Draws:
    """Shoot at `count` drawn panels.

    Parameters
    ----------
    setup : ImpactSetup; its symmetry is not used
    scatter : Scatter, of which shape and gauge_length count
    count : number of draws, at least 2
    seed : of all that is drawn
    runs : folder, executor, jobs, report of `run_cache.results`; of the runs in the folder a later call goes on

    Raises
    ------
    InputError : a value that is not allowed, or yarns that do not fail
    """
    if count < 2:
        raise InputError(key="draws", value=count, allowed="at least 2")
    strengths_alone, whole = (
        replace(scatter, modulus=0.0, crimp=0.0),
        inputs.alone(setup, symmetry="whole"),
    )
    strengths.check(whole, strengths_alone)
    draws = run_cache.results(
        fire, [(whole, strengths_alone, seed, number) for number in range(count)], **runs
    )
    return Draws(tuple(draws), scatter, seed)
