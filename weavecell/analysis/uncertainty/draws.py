"""One scene shot many times at panels whose yarns differ in strength: mean, scatter, probability of perforation.

Strengths are drawn as for the ballistic limit (`uncertainty.v50`): one of a Weibull distribution for every yarn of every
ply, from (seed, number of the draw, ply) alone, so that nothing depends on the number of workers. Every yarn is drawn,
so that the panel is whole, whatever part the scene models. All else is the scene's.

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
from fabrics.errors import InputError, UnstableError
from shellfabric.impact import pack as impact_pack
from shellfabric.impact import single_ply
from shellfabric.panel.model import Panel
from weavecell.analysis.uncertainty import v50
from weavecell.analysis.uncertainty.inputs import Scatter

if TYPE_CHECKING:
    from collections.abc import Callable

    from shellfabric.impact.pack import PackSetup
    from shellfabric.impact.single_ply import ImpactSetup

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


def drawn(panel: Panel, scatter: Scatter, seed: int, number: int) -> tuple[Panel, float]:
    """(whole panel with the strengths of a number, factor of its weakest yarn).

    Yarns have the length of the panel's sides, which those of an oblique weave have at most.
    """
    uniform = replace(panel, grading=None)
    lengths = tuple(count * side for count, side in zip(uniform.counts, uniform.spacing))
    _, strengths = v50.draw(panel.fabric, scatter, seed, number, uniform.yarn_counts, lengths)
    lines = strengths if panel.sides is None else v50.of_lines(strengths, panel)
    return replace(panel, strength_factors=lines), float(min(map(np.min, strengths)))


def whole(setup: ImpactSetup | PackSetup) -> ImpactSetup | PackSetup:
    """The set-up of the whole panel, which records nothing beside its samples, on one thread."""
    if isinstance(setup, impact_pack.PackSetup):
        return replace(setup, ply=whole(setup.ply))  # type: ignore[arg-type]
    numerics = replace(setup.numerics, threads=1)
    return replace(setup, symmetry="whole", history=None, snapshot_interval=None, numerics=numerics)


def fire(setup: ImpactSetup | PackSetup, scatter: Scatter, seed: int, number: int) -> Draw:
    """The shot of a number at the whole panel."""
    result: Any
    try:
        if isinstance(setup, impact_pack.PackSetup):
            pack = setup.pack(setup.ply.table(kept=True))
            count = len(pack.plies)
            found = [drawn(ply, scatter, seed, number * count + p) for p, ply in enumerate(pack.plies)]
            result = impact_pack.run(setup, pack=replace(pack, plies=tuple(ply for ply, _ in found)))
        else:
            found = [drawn(setup.panel(setup.table(kept=True)), scatter, seed, number)]
            result = single_ply.run(setup, panel=found[0][0])
        outcome = result.outcome
    except UnstableError as problem:
        if problem.result is None:
            raise
        result, outcome = problem.result, "unstable"
    warp, weft = np.max(np.atleast_2d(result.peak_tension), axis=0)
    return Draw(
        number, outcome, float(result.residual_velocity),
        float(result.strike_energy - result.energies["kinetic_projectile"][-1]), float(warp), float(weft),
        int(result.failed_segments[-1]), float(result.t[-1]), min(weakest for _, weakest in found),
        float(result.energy_error_max),
    )  # fmt: skip


def study(
    setup: ImpactSetup | PackSetup, scatter: Scatter, count: int, *, folder: FilePath, seed: int = 1,
    executor: str | Executor = "local", jobs: int = 1, resume: bool = True,
    report: Callable[[int, int], object] | None = None,
) -> Draws:  # fmt: skip
    """Shoot at `count` drawn panels.

    Parameters
    ----------
    setup : ImpactSetup or PackSetup; its symmetry is not used
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
    ply = setup.ply if isinstance(setup, impact_pack.PackSetup) else setup
    if count < 2:
        raise InputError(key="draws", value=count, allowed="at least 2")
    if not ply.failure:
        raise InputError("strengths are drawn, and the yarns do not fail", key="yarn_failure", allowed="true")
    given = whole(setup)
    arguments = [(given, replace(scatter, modulus=0.0, crimp=0.0), seed, number) for number in range(count)]
    found = run_cache.results(
        fire, arguments, folder=folder, executor=executor, jobs=jobs, batches=False, resume=resume, report=report
    )
    return Draws(tuple(found), scatter, seed)
