"""Discretisation uncertainty of an impact from pairs of meshes: the grid convergence index of ASME V&V 20.

The element side near the impact point of the finer mesh is half that of the other. With the difference d of a result
between the two,

    U = F_s d r^p / (r^p - 1)  on the coarser mesh,    U = F_s d / (r^p - 1)  on the finer one,    r = 2.

Two meshes show no order of convergence, so that p is the formal order of the elements, 2, and F_s = 3, the factor that
goes with an order which is assumed (P. J. Roache, Verification and Validation in Computational Science and Engineering,
1998; ASME V&V 20-2009, section 2-4): U is 4 d and d. The interval of a result phi is phi - U to phi + U.

The difference of a single number can vanish by chance where two solutions cross. So d is a norm of the difference of
the solutions: of the deflection, and of the velocity and the absorbed energy of a projectile that is still in flight,
the largest difference of their histories, up to the end of the shorter run, and of peak tensions the larger of the
relative differences of warp and weft. What a projectile that stops leaves (no velocity, and all its energy absorbed)
has no error. Residual velocity and absorbed energy of one that perforates are means over a window of strike velocities
(`window`): d is the difference of the means on the two meshes, and to U is added the root of the sum of the squares of
their standard errors. Where the outcomes on the meshes differ, the outcome depends on the mesh, and no result has an
uncertainty.

`run_pair` states the uncertainty on the scene's own mesh. `climb` takes finer and finer meshes, until the uncertainties
on the last are within targets.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import hypot, inf
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fabrics.base.errors import InputError, UnstableError
from shellfabric.cell.model import CellTable
from shellfabric.impact.simulation import ImpactResult, ImpactSetup
from shellfabric.panel.model import SYMMETRIES
from weavecell.studies import rigidity

if TYPE_CHECKING:
    from weavecell.studies.window import Window

RATIO, ORDER, SAFETY = 2, 2.0, 3.0
REACH, LATEST = (
    10.0,
    60.0,
)  # [crossovers] from the impact point up to which elements are halved: at least, at most
MOST_ELEMENTS = 8  # a crossover, of the finest mesh


@dataclass(frozen=True)
class Shot:
    """A run, why it became unstable, or None, in which case the result is what it had computed, and its window, or None
    of one that did not perforate."""

    result: ImpactResult
    failure: UnstableError | None = None
    window: Window | None = None


Shoot: TypeAlias = Callable[
    ..., Shot
]  # called as shoot(setup, table of the cell, name of the mesh)


@dataclass(frozen=True)
class Interval:
    """A result on the mesh that counts, on the other mesh, and its discretisation uncertainty, all in its unit; of
    means also their standard errors on these meshes, otherwise 0."""

    name: str
    unit: str
    value: float
    other: float
    uncertainty: float
    standard_errors: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Discretisation:
    """What two meshes or more give.

    Parameters
    ----------
    setup : of the run that counts
    meshes, outcomes : of all runs, in their order
    intervals : of the results; none where the outcomes of the last two differ
    targets, errors : {quantity: [-] at most} and {quantity: [-] uncertainty} of `climb`
    windows : of the mesh that counts and of the other; None of a shot that did not perforate
    """

    setup: ImpactSetup
    meshes: tuple[str, ...]
    outcomes: tuple[str, ...]
    intervals: tuple[Interval, ...]
    targets: Mapping[str, float] = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)
    windows: tuple[Window | None, ...] = (None,)

    @property
    def same_outcome(self) -> bool:
        """Whether the last two meshes have the same outcome."""
        return len(set(self.outcomes[-2:])) == 1

    @property
    def confirmed(self) -> bool:
        """Whether all uncertainties are within their targets."""
        return all(self.errors.get(name, inf) <= share for name, share in self.targets.items())


def index(difference: float, *, of_finer: bool = False) -> float:
    """Uncertainty U of a result from its difference d on two meshes, see the module."""
    return SAFETY * difference * (1.0 if of_finer else RATIO**ORDER) / (RATIO**ORDER - 1)


def finer(setup: ImpactSetup, table: CellTable) -> ImpactSetup:
    """The set-up with half the element side within REACH of the impact point, or further where the projectile needs it;
    of a graded mesh with half the side of the first zone, and all zones twice as far out. Where the panel cannot be
    graded so (edges that are held by friction) all its elements are halved.

    Raises
    ------
    InputError : it would have more than MOST_ELEMENTS elements along a crossover
    """
    zones = _zones(setup)
    count = RATIO / zones[0][1]
    if count > MOST_ELEMENTS * (1 + 1e-9):
        asked = f"a finer mesh of {count:g} elements per crossover"
        allowed = (
            f"at most {MOST_ELEMENTS // RATIO} elements per crossover, which the finer mesh doubles"
        )
        raise InputError(key="--uncertainty", value=asked, allowed=allowed)
    reach = min(zones[0][0], REACH)
    while reach <= LATEST:
        graded = _with(setup, ((reach, 1 / count), *((2 * until, side) for until, side in zones)))
        if _can_be_meshed(graded, table):
            return graded
        reach *= 1.5
    return halved(setup)


def halved(setup: ImpactSetup) -> ImpactSetup:
    """The set-up with half the side of all elements."""
    return _with(setup, tuple((until, side / RATIO) for until, side in _zones(setup)))


def _zones(setup):
    """((until, side), ...) [crossovers] of the mesh of a set-up, graded or not."""
    ply = setup.meshed
    return ply.grading or ((inf, 1 / ply.resolved_elements_per_crossover),)


def _with(setup, zones):
    """The set-up with these zones."""
    zones = tuple((float(until), float(side)) for until, side in zones)
    if len(zones) == 1 and zones[0][1] <= 1:
        return replace(setup, elements_per_crossover=round(1 / zones[0][1]), grading=None)
    return replace(setup, elements_per_crossover=None, grading=zones)


def _can_be_meshed(setup, table):
    try:
        setup.panel(table)
    except InputError:
        return False
    return True


def smallest_part(setup: ImpactSetup) -> ImpactSetup:
    """The set-up with the smallest part of the panel that shot, edges and weave let stand for all of it."""
    parts = (replace(setup, symmetry=symmetry) for symmetry in SYMMETRIES)
    return next((part for part in parts if _can_be_meshed(part, part.plain_table())), setup)


def in_words(setup: ImpactSetup) -> str:
    """The mesh of a set-up."""
    zones = _zones(setup)
    if len(zones) == 1 and zones[0][1] <= 1:
        count = round(1 / zones[0][1])
        return f"{count} element{'s' * (count > 1)} per crossover"
    sides = [
        f"{Fraction(side).limit_denominator(MOST_ELEMENTS)}{'' if until == inf else f' to {until:g}'}"
        for until, side in zones
    ]
    return f"sides of {', '.join(sides)} crossovers"


def run_pair(setup: ImpactSetup, shoot: Shoot) -> tuple[Shot, Discretisation]:
    """Run a scene on its mesh, which counts, and on the finer one; where its run became unstable, on its mesh alone.

    Raises
    ------
    InputError : as `finer`; nothing has been run
    """
    table = setup.table(kept=True)
    refined = replace(finer(setup, table), snapshot_interval=None, history=None)
    shot = shoot(setup, table)
    other = shot if shot.failure is not None else shoot(refined, table, "finer mesh")
    return shot, compare(shot, other)


def climb(
    setup: ImpactSetup, targets: Mapping[str, float], shoot: Shoot, *, fixed: Collection[str] = ()
) -> tuple[Shot, Discretisation]:
    """Run a scene on its mesh and on finer ones, until the uncertainty of each result with a target is within it.

    The part of the panel is the smallest, and a flat steel projectile is an elastic bar where its contact is too short
    for a rigid one, unless "symmetry" and "projectile" are `fixed`. The last run counts.
    """
    setup = setup if "symmetry" in fixed else smallest_part(setup)
    table, projectile = setup.table(kept=True), setup.projectile
    meshes: tuple[str, ...] = ()
    outcomes: tuple[str, ...] = ()
    before: Shot | None = None
    while True:
        shot = shoot(setup, table, f"{projectile.body} {len(meshes) + 1}")
        result = shot.result
        rigid = None
        if "projectile" not in fixed and projectile.bar is None:
            rigid = rigidity.of_shot(result)
        if rigid and not rigid.enough:
            bar = replace(setup, projectile=replace(projectile, body="elastic_bar"))
            return climb(bar, targets, shoot, fixed={"symmetry", "projectile"})
        meshes, outcomes = (*meshes, in_words(setup)), (*outcomes, result.outcome)
        levels = Discretisation(setup, meshes, outcomes, (), targets, windows=(shot.window,))
        if before is not None and shot.failure is None:
            pair = compare(before, shot, of_finer=True)
            levels = replace(
                levels, intervals=pair.intervals, errors=pair.errors, windows=pair.windows
            )
        if levels.confirmed:
            return shot, levels
        before = shot if shot.failure is None else None
        try:
            setup = finer(setup, table)
        except InputError:
            return shot, levels


def compare(coarse: Shot, fine: Shot, *, of_finer: bool = False) -> Discretisation:
    """The pair of shots, of which the coarser mesh counts, or the finer."""
    result, other_result = coarse.result, fine.result
    errors = {
        name: index(norm, of_finer=of_finer)
        for name, norm in differences(result, other_result).items()
    }
    scales = {
        "residual_velocity": result.setup.strike_velocity,
        "absorbed_energy": result.strike_energy,
    }
    if coarse.window and fine.window:
        for quantity, scale in scales.items():
            (mean, error), (other_mean, other_error) = (
                coarse.window.mean(quantity),
                fine.window.mean(quantity),
            )
            difference = index(abs(other_mean - mean), of_finer=of_finer)
            errors[quantity] = (difference + hypot(error, other_error)) / scale
    counts, other = (fine, coarse) if of_finer else (coarse, fine)
    rows = zip(_rows(counts), _rows(other)) if result.outcome == other_result.outcome else ()
    intervals = tuple(
        Interval(name, unit, value, second, errors[quantity] * scale, (error, other_error))
        for (name, unit, quantity, scale, value, error), (*_, second, other_error) in rows
    )
    meshes, outcomes = zip(
        *((in_words(shot.result.setup), shot.result.outcome) for shot in (coarse, fine))
    )
    windows = counts.window, other.window
    return Discretisation(
        counts.result.setup, meshes, outcomes, intervals, errors=errors, windows=windows
    )


def _rows(shot):
    """(name, unit, quantity, what its uncertainty is a share of, value, its standard error) of each result there is."""
    result = shot.result
    strike, energy, deepest = (
        result.setup.strike_velocity,
        result.strike_energy,
        1e3 * result.max_deflection,
    )
    left, (warp, weft) = max(result.residual_velocity, 0.0), result.peak_tension
    velocities, energies = (left, 0.0), (result.absorbed_energy, 0.0)
    if shot.window is not None:
        velocities, energies = map(shot.window.mean, ("residual_velocity", "absorbed_energy"))
    yield "residual velocity", "m/s", "residual_velocity", strike, *velocities
    yield "absorbed energy", "J", "absorbed_energy", energy, *energies
    if result.outcome != "perforated":
        yield "peak deflection", "mm", "deflection", deepest, deepest, 0.0
        yield "peak tension, warp", "N", "peak_tension", warp, warp, 0.0
        yield "peak tension, weft", "N", "peak_tension", weft, weft, 0.0


def differences(coarse: ImpactResult, fine: ImpactResult) -> dict[str, float]:
    """{quantity: [-] norm of the difference of the solutions}, over velocity and energy of the strike, the largest
    deflection and the peak tensions; infinite where the outcomes differ, 0 of what a projectile that has stopped or a
    panel that is perforated does not have. Velocity and energy of a projectile that perforates have none: infinite."""
    (t, _, v), (tf, _, vf) = (result.step_history[:, :3].T for result in (coarse, fine))
    common, strike = t <= tf[-1], coarse.setup.strike_velocity
    deepest, other_deepest = coarse.max_deflection, fine.max_deflection
    shared = coarse.t[coarse.t <= fine.t[-1]]
    depth = np.interp(shared, fine.t, fine.deflection) - coarse.deflection[: shared.size]
    depths = np.append(depth, other_deepest - deepest)
    ends = (max(result.residual_velocity, 0.0) for result in (coarse, fine))
    speeds = zip((v[common], np.interp(t[common], tf, vf)), ends)
    speed, other = (np.append(history, end) / strike for history, end in speeds)
    tensions = [abs(b / a - 1) for a, b in zip(coarse.peak_tension, fine.peak_tension) if a > 0]
    holds, moves = coarse.outcome != "perforated", {"stopped": 0.0, "perforated": inf}
    norms = {
        "residual_velocity": moves.get(coarse.outcome, np.abs(other - speed).max()),
        "absorbed_energy": moves.get(coarse.outcome, np.abs(other**2 - speed**2).max()),
        "deflection": holds and np.abs(depths).max() / deepest,
        "peak_tension": holds and max(tensions, default=0.0),
    }
    return {
        name: float(norm) if coarse.outcome == fine.outcome else inf for name, norm in norms.items()
    }
