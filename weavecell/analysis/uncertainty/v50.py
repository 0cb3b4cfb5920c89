"""A ballistic limit that is a probability: repeated shots at panels of yarns that differ in strength.

Each panel is drawn anew. A yarn has one strength T_u all along, of a Weibull distribution of shape m,

    F(T) = 1 - exp(-(L / L0) (T / T0)^m)

over its length L in the panel; at the gauge length L0 its mean T0 Gamma(1 + 1/m) is the strength of the fabric's yarn,
so that a longer yarn is weaker by (L0 / L)^(1/m). Since the drawn value, that of the weakest place of the whole yarn,
is held against its tension everywhere, the yarn is taken as weak where the projectile strikes: the limit is on the safe
side. Modulus, and the crimp of either family, are one log-normal value a panel. Every yarn is drawn: panels are whole.

On a graded panel (`shellfabric.panel.grading`) the yarns are drawn as on the uniform one; a line that stands for
several yarns has the strength of the weakest of them.

A shot ends once its outcome is known. A projectile that has less than 1 % of its strike energy left counts as stopped
if no yarn has failed while a stress wave went to the edge and back. Were it to perforate all the same, its residual
velocity would be below a tenth of its strike velocity: by v_r^2 = V^2 - V50^2 it was struck within 0.5 % of the limit.

A panel is drawn from (seed, number of the shot) alone, and velocities are chosen in rounds of a given size from the
outcomes of all rounds before: nothing depends on the number of workers. The first round covers the deterministic limit
by `FIRST` either way; then velocities are spread evenly over the probabilities of the curve fitted so far, or, where no
stop is faster than a perforation, over the gap between them. Without scatter that is a search of the gap, and V50
goes to the deterministic limit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from math import gamma, inf, log, sqrt
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fabrics import run_cache
from fabrics.checks import FilePath
from fabrics.errors import InputError, UnstableError
from fabrics.executors import open_executor
from fabrics.fabric import Fabric
from shellfabric.impact import ballistic_limit
from shellfabric.impact.single_ply import ImpactSetup
from shellfabric.panel import grading as grading_of_panels
from shellfabric.panel.model import Numerics, Panel
from weavecell.analysis.uncertainty import probit
from weavecell.analysis.uncertainty.inputs import Scatter, changed

Grading: TypeAlias = tuple[tuple[float, float], ...] | None

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


def draw(
    fabric: Fabric, scatter: Scatter, seed: int, number: int, counts: Sequence[int], lengths: Sequence[float]
) -> tuple[dict[str, float], tuple[np.ndarray, ...]]:
    """A panel's factors, from its number alone.

    Parameters
    ----------
    fabric : Fabric, whose crimp bounds what is drawn
    counts : (warp, weft) yarns
    lengths : (warp, weft) [m] of a yarn in the panel

    Returns
    -------
    ({"modulus", "crimp_warp", "crimp_weft": factor}, (warp, weft) (n,) factors on the strength of each yarn)
    """
    random = np.random.default_rng([seed, number])
    normal = random.standard_normal(3)
    factors = {
        name: _log_normal(spread, z)
        for name, spread, z in zip(
            ("modulus", "crimp_warp", "crimp_weft"), (scatter.modulus, scatter.crimp, scatter.crimp), normal
        )
    }
    uniform = tuple(random.uniform(size=count) for count in counts)
    m = scatter.shape
    if m == inf:
        return factors, tuple(np.ones(count) for count in counts)
    return factors, tuple(
        (scatter.gauge_length / L) ** (1 / m) / gamma(1 + 1 / m) * (-np.log1p(-u)) ** (1 / m)
        for L, u in zip(lengths, uniform)
    )


def _log_normal(spread, z):
    """Mean 1, standard deviation `spread`, from a standard normal z."""
    variance = log(1 + spread**2)
    return float(np.exp(sqrt(variance) * z - 0.5 * variance))


def drawn_panel(
    fabric: Fabric, scatter: Scatter, seed: int, number: int, opening: float, grading: Grading = None
) -> tuple[Panel, dict, tuple]:
    """(whole panel of the number, its factors, strength factors of its yarns)."""
    plain = ImpactSetup(fabric, 1.0, opening=opening, symmetry="whole", numerics=Numerics(threads=1), table_size=11)
    shape = plain.panel()
    lengths = tuple(count * step for count, step in zip(shape.counts, shape.spacing))
    factors, strengths = draw(fabric, scatter, seed, number, shape.yarn_counts, lengths)
    drawn = replace(plain, fabric=changed(fabric, **factors), table_size=201, grading=grading)
    panel = drawn.panel(drawn.table())  # each panel has a cell of its own
    lines = strengths if panel.sides is None else of_lines(strengths, panel)
    return replace(panel, strength_factors=lines), factors, strengths


def of_lines(strengths: Sequence[np.ndarray], panel: Panel) -> tuple[np.ndarray, ...]:
    """(warp, weft) strength factors of the lines of a graded panel, from those of all yarns."""
    found = []
    for factors, x, w, lines in zip(strengths, panel.lines()[::-1], panel.weave.w[::-1], panel.yarn_lines[::-1]):
        axes = np.rint(x[lines.yarn >= 0] / (2 * w))
        found.append(grading_of_panels.weakest(factors, axes))
    return tuple(found)


def fire(
    fabric: Fabric, scatter: Scatter, seed: int, number: int, velocity: float, opening: float, grading: Grading = None
) -> Shot:
    """The shot of a number."""
    panel, factors, strengths = drawn_panel(fabric, scatter, seed, number, opening, grading)
    try:
        (shot,) = ballistic_limit.shoot(panel, (velocity,), stops_below=STOPS_BELOW)
    except UnstableError as problem:
        raise UnstableError(str(problem), when=f"shot {number} of seed {seed}") from None
    return Shot(
        number, velocity, shot.residual_velocity, shot.perforated, **factors,
        weakest=(float(strengths[0].min()), float(strengths[1].min())), balance=shot.balance,
    )  # fmt: skip


def deterministic(fabric: Fabric, opening: float, tolerance: float, grading: Grading = None) -> tuple[float, float]:
    """(low, high) [m/s] of `ballistic_limit.critical_velocity` without scatter; yarns and shot have a quarter's
    symmetry."""
    panel = ImpactSetup(fabric, 1.0, opening=opening, numerics=Numerics(threads=1), grading=grading).panel()
    found = ballistic_limit.critical_velocity(panel, tolerance=tolerance)
    return found.low, found.high


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
    return _curve(V, hit).velocity(np.linspace(*SPREAD, count))


def _curve(V, hit):
    return probit.fit(V, hit)


def study(
    fabric: Fabric, scatter: Scatter, *, shots: int, folder: FilePath, batch: int = 10, seed: int = 1,
    opening: float = 0.203, grading: Grading = None, tolerance: float = 1.0, executor: str | Executor = "local",
    jobs: int = 1, report: Callable[[float, str], object] | None = None,
) -> Study:  # fmt: skip
    """Fire shots, in rounds of `batch`, and fit the curves.

    Parameters
    ----------
    fabric : Fabric
    scatter : Scatter
    shots : how many
    folder : Path of the runs
    batch : shots of a round
    seed : of all that is drawn
    opening : [m]
    grading : ((until, side), ...) [crossovers] of all panels, or None for elements of one size (see `panel.grading`)
    tolerance : [m/s] of the deterministic limit
    executor, jobs : as of `fabrics.executors.open_executor`
    report : called as report(share of the work done, text)

    Raises
    ------
    InputError, UnstableError : as `ballistic_limit.critical_velocity`, or too few shots
    """
    for key, value in (("shots", shots), ("batch", batch)):
        if value < 4:
            raise InputError(key=key, value=value, allowed="at least 4")
    report = report or (lambda share, text: None)
    with open_executor(executor, jobs) as pool:
        runs: dict[str, Any] = {"folder": folder, "executor": pool, "jobs": jobs}
        (bracket,) = run_cache.results(deterministic, [(fabric, opening, tolerance, grading)], **runs)
        middle = 0.5 * sum(bracket)
        found: list[Shot] = []
        scatters = scatter != Scatter(gauge_length=scatter.gauge_length)
        while len(found) < shots:
            count = min(batch, shots - len(found))
            if found:
                velocities = plan([s.velocity for s in found], [s.perforated for s in found], count, scatters)
            else:
                velocities = middle * np.linspace(1 - FIRST, 1 + FIRST, count)
            progress = _shots_done(report, len(found), shots)
            begun = len(found)
            found += run_cache.results(
                fire,
                [
                    (fabric, scatter, seed, begun + k, round(float(V), 6), opening, grading)
                    for k, V in enumerate(velocities)
                ],
                report=progress,
                **runs,
            )
    V, hit = [s.velocity for s in found], [s.perforated for s in found]
    curves = {link: probit.fit(V, hit, link=link) for link in probit.LINKS}
    return Study(bracket, tuple(found), curves, scatter)


def _shots_done(report: Callable[[float, str], object], begun: int, shots: int) -> Callable[[int, int], object]:
    """Progress of one batch as progress of all shots, of which `begun` were done before it."""
    return lambda done, total: report((begun + done) / shots, f"{begun + done} shots")
