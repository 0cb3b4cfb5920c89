"""One scene shot many times at panels whose yarns differ in strength: mean, scatter, probability of perforation.

Strengths are drawn as for the ballistic limit (`uncertainty.strengths`), from seed and number of the draw alone, so
that nothing depends on the number of workers. All else is the scene's.

The result of a single shot near the limit is a staircase in velocity and mesh, since yarns fail one by one; the mean
over draws is not. It has the standard error s / sqrt(n). The share of perforations has Wilson's interval.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, fields, replace
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import run_cache
from fabrics.checks import FilePath
from fabrics.errors import InputError
from shellfabric.impact.simulation import fired
from weavecell.studies import inputs, strengths
from weavecell.studies.inputs import Scatter

if TYPE_CHECKING:
    from collections.abc import Callable

    from shellfabric.impact.simulation import ImpactSetup

# of a Draw: unit, words
QUANTITIES = {
    "residual_velocity": ("m/s", "residual velocity"),
    "absorbed_energy": ("J", "absorbed energy"),
    "peak_tension_warp": ("N", "peak tension, warp"),
    "peak_tension_weft": ("N", "peak tension, weft"),
}
OUTCOMES = ("stopped", "perforated", "in flight", "unstable")
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Draw:
    """One shot at one drawn panel or pack.

    Parameters
    ----------
    number : from 0; with the seed it determines the strengths
    outcome : "stopped", "perforated", "in flight" or "unstable"
    residual_velocity : [m/s] along the panel's normal
    absorbed_energy : [J] that the projectile has lost
    peak_tension_warp, peak_tension_weft : [N] highest of any ply over the run
    failed : yarn segments at the end, of all plies
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
    failed: int
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
    """What the draws came to; those that became unstable count in none of the estimates.

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
        return tuple(one for one in self.draws if one.outcome != "unstable")

    def estimate(self, quantity: str) -> Estimate:
        """The Estimate of one of `QUANTITIES`; not a number of no draws, or of one its deviation."""
        values = np.array([getattr(one, quantity) for one in self.counted])
        nan = float("nan")
        deviation = float(values.std(ddof=1)) if values.size > 1 else nan
        return Estimate(float(values.mean()) if values.size else nan, deviation, deviation / sqrt(max(values.size, 1)))

    @property
    def outcomes(self) -> dict[str, int]:
        """{outcome: number of draws} of `OUTCOMES`."""
        return {name: sum(one.outcome == name for one in self.draws) for name in OUTCOMES}

    def probability(self) -> tuple[float, float, float]:
        """(share of perforations, low, high), with Wilson's interval of `CONFIDENCE`; (0, 0, 1) of no draws."""
        from scipy.stats import binomtest

        if not self.counted:
            return 0.0, 0.0, 1.0
        found = binomtest(self.outcomes["perforated"], len(self.counted))
        interval = found.proportion_ci(CONFIDENCE, method="wilson")
        return float(found.statistic), float(interval.low), float(interval.high)

    def summary(self) -> dict[str, Any]:
        """All of it as a flat dict of numbers, keys with their units."""
        share, low, high = self.probability()
        found: dict[str, Any] = {
            "draws": len(self.draws),
            **{name.replace(" ", "_"): count for name, count in self.outcomes.items()},
            "probability_of_perforation": share, "probability_low": low, "probability_high": high,
            "confidence": CONFIDENCE, "seed": self.seed, "weibull_shape": self.scatter.shape,
            "gauge_length_m": self.scatter.gauge_length,
        }  # fmt: skip
        for name, (unit, _) in QUANTITIES.items():
            suffix = unit.replace("/", "_")
            for part, value in vars(self.estimate(name)).items():
                found[f"{name}_{part}_{suffix}"] = value
        return found

    def columns(self) -> dict[str, list]:
        """{field of a Draw: its values}."""
        return {field.name: [getattr(one, field.name) for one in self.draws] for field in fields(Draw)}


def fire(setup: ImpactSetup, scatter: Scatter, seed: int, number: int) -> Draw:
    """The shot of a number at the whole panel."""
    drawn = strengths.drawn(setup, scatter, seed, number)
    result, problem = fired(setup, target=drawn.pack)
    warp, weft = result.peak_tension
    return Draw(
        number, "unstable" if problem else result.outcome, float(result.residual_velocity),
        float(result.strike_energy - result.energies["kinetic_projectile"][-1]), float(warp), float(weft),
        int(result.failed_segments[-1]), float(result.t[-1]), min(drawn.weakest), float(result.energy_error_max),
    )  # fmt: skip


def study(
    setup: ImpactSetup, scatter: Scatter, count: int, *, folder: FilePath, seed: int = 1,
    executor: str | Executor = "local", jobs: int = 1, resume: bool = True,
    report: Callable[[int, int], object] | None = None,
) -> Draws:  # fmt: skip
    """Shoot at `count` drawn panels.

    Parameters
    ----------
    setup : ImpactSetup; its symmetry is not used
    scatter : Scatter, of which shape and gauge_length count
    count : number of draws, at least 2
    folder : of kept runs, from which a later call goes on, also to more draws
    seed : of all that is drawn
    executor, jobs : as of `fabrics.executors.open_executor`
    resume : whether to take what the folder holds; else it is emptied first
    report : called as report(number done, number of all)

    Raises
    ------
    InputError : a value that is not allowed, or yarns that do not fail
    """
    if count < 2:
        raise InputError(key="draws", value=count, allowed="at least 2")
    alike, given = replace(scatter, modulus=0.0, crimp=0.0), inputs.alone(setup, symmetry="whole")
    strengths.check(given, alike)
    arguments = [(given, alike, seed, number) for number in range(count)]
    found = run_cache.results(
        fire, arguments, folder=folder, executor=executor, jobs=jobs, resume=resume, report=report
    )
    return Draws(tuple(found), scatter, seed)
