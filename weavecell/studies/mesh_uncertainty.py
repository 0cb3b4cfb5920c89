"""Discretisation uncertainty of an impact from pairs of meshes: the grid convergence index of ASME
V&V 20-2009 (section 2-4; P. J. Roache, Verification and Validation in Computational Science and
Engineering, 1998).

The element side near the impact point of the finer mesh is half of the other's, r = 2. With the
difference d of a result between the two, and its interval phi - U to phi + U on the coarser mesh,

    U = F_s d r^p / (r^p - 1) = 4 d.

Two meshes show no order: p is the formal order of the elements, 2, and F_s = 3, as goes with an
assumed order. `run_pair` states it on the scene's own mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import hypot, inf
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fabrics.base.door import option
from fabrics.base.errors import InputError, UnstableError
from shellfabric.cell.model import CellTable
from shellfabric.impact.result import ImpactResult
from shellfabric.impact.setup import ImpactSetup

if TYPE_CHECKING:
    from weavecell.studies.window import Window

# ratio of the element sides of two meshes
RATIO = 2
ORDER = 2.0
SAFETY = 3.0
# [crossovers] from the impact point up to which elements are halved: at least, at most
REACH = 10.0
LATEST = 60.0
# elements along a crossover of the finest mesh
MOST_ELEMENTS = 8


@dataclass(frozen=True)
class Shot:
    """A run, why it became unstable, or None, in which case the result is what it had computed, and
    its window, or None of one that did not perforate."""

    result: ImpactResult
    failure: UnstableError | None = None
    window: Window | None = None


# called as shoot(setup, table of the cell, name of the mesh)
Shoot: TypeAlias = Callable[..., Shot]


@dataclass(frozen=True)
class Interval:
    """A result on the mesh that counts, on the other mesh, and its discretisation uncertainty, all
    in its unit; of means also their standard errors on these meshes, otherwise 0."""

    name: str
    unit: str
    value: float
    other: float
    uncertainty: float
    standard_errors: tuple[float, ...] = (0.0, 0.0)


@dataclass(frozen=True)
class Discretisation:
    """What two meshes give.

    Parameters
    ----------
    setup : of the run that counts
    meshes, outcomes : of both runs, the mesh that counts first
    intervals : of the results; none where the outcomes differ
    errors : {quantity: [-] uncertainty}
    windows : of the mesh that counts and of the other; None of a shot that did not perforate
    """

    setup: ImpactSetup
    meshes: tuple[str, ...] = ()
    outcomes: tuple[str, ...] = ()
    intervals: tuple[Interval, ...] = ()
    errors: Mapping[str, float] = field(default_factory=dict)
    windows: tuple[Window | None, ...] = (None,)

    @property
    def same_outcome(self) -> bool:
        """Whether both meshes have the same outcome."""
        return len(set(self.outcomes)) == 1


def index(difference: float) -> float:
    """Compute the uncertainty U of a result from its difference d on two meshes, see the module."""
    return SAFETY * difference * RATIO**ORDER / (RATIO**ORDER - 1)


def finer(setup: ImpactSetup, table: CellTable) -> ImpactSetup:
    """Return the set-up with half the element side within REACH of the impact point, or further if
    the projectile needs it; of a graded mesh with half the side of the first zone, and all zones
    twice as far out. All elements are halved if fabric from anywhere may come under the
    projectile, and if the panel cannot be graded so.

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
        raise InputError(key=option("uncertainty", ""), value=asked, allowed=allowed)
    if not setup.keeps_its_middle:
        return halve_elements(setup)
    reach = min(zones[0][0], REACH)
    # zones have to end where whole elements do, and beyond all that can come under the projectile
    while reach <= LATEST:
        graded = _with(setup, ((reach, 1 / count), *((2 * until, side) for until, side in zones)))
        if _can_be_meshed(graded, table):
            return graded
        reach *= 1.5
    return halve_elements(setup)


def halve_elements(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with half the side of all elements."""
    return _with(setup, tuple((until, side / RATIO) for until, side in _zones(setup)))


def _zones(setup):
    """((until, side), ...) [crossovers] of the mesh of a set-up, graded or not."""
    ply = setup.meshed
    return ply.grading or ((inf, 1 / (ply.elements_per_crossover or 1)),)


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


def describe_mesh(setup: ImpactSetup) -> str:
    """Describe the mesh of a set-up."""
    zones = _zones(setup)
    if len(zones) == 1 and zones[0][1] <= 1:
        count = round(1 / zones[0][1])
        return f"{count} element{'s' * (count > 1)} per crossover"
    sides = []
    for until, side in zones:
        words = str(Fraction(side).limit_denominator(MOST_ELEMENTS))
        if until < inf:
            words += f" to {until:g}"
        sides.append(words)
    return f"sides of {', '.join(sides)} crossovers"


def run_pair(setup: ImpactSetup, shoot: Shoot) -> tuple[Shot, Discretisation]:
    """Run a scene on its mesh, which counts, and on the finer one; where its run became unstable,
    on its mesh alone.

    Raises
    ------
    InputError : as `finer`; nothing has been run
    """
    table = setup.table(kept=True)
    # its shapes and histories are shown nowhere
    refined = replace(finer(setup, table), snapshot_interval=None, history=None)
    shot = shoot(setup, table)
    other = shot
    if shot.failure is None:
        other = shoot(refined, table, "finer mesh")
    return shot, compare(shot, other)


def compare(coarse: Shot, fine: Shot) -> Discretisation:
    """Compare the pair of shots, of which the coarser mesh counts."""
    counted = coarse.result
    errors = {}
    for name, norm in differences(coarse.result, fine.result).items():
        errors[name] = index(norm)
    scales = {
        "residual_velocity": counted.setup.strike_velocity,
        "absorbed_energy": counted.strike_energy,
    }
    jumps = any(shot.window is not None and shot.window.jump for shot in (coarse, fine))
    if coarse.window and fine.window and not jumps:
        for quantity, scale in scales.items():
            mean, error = coarse.window.mean(quantity)
            other_mean, other_error = fine.window.mean(quantity)
            difference = index(abs(other_mean - mean))
            errors[quantity] = (difference + hypot(error, other_error)) / scale
    shots = [coarse, fine]
    comparison = Discretisation(
        counted.setup,
        meshes=tuple(describe_mesh(shot.result.setup) for shot in shots),
        outcomes=tuple(shot.result.outcome for shot in shots),
        errors=errors,
        windows=tuple(shot.window for shot in shots),
    )
    # a mean over a jump would measure where the jump lies
    if not comparison.same_outcome or jumps:
        return comparison
    intervals = []
    for (quantity, scale, interval), (_, _, other) in zip(*map(_results, shots)):
        uncertainty = errors[quantity] * scale
        spread = interval.standard_errors + other.standard_errors
        intervals.append(
            replace(interval, other=other.value, uncertainty=uncertainty, standard_errors=spread)
        )
    return replace(comparison, intervals=tuple(intervals))


def _results(shot):
    """(quantity, what its uncertainty is a share of, its Interval on this mesh alone) of each
    result of a shot."""
    result = shot.result
    strike = result.setup.strike_velocity
    residual = (max(result.residual_velocity, 0.0), 0.0)
    absorbed = (result.absorbed_energy, 0.0)
    if shot.window is not None:
        residual = shot.window.mean("residual_velocity")
        absorbed = shot.window.mean("absorbed_energy")
    yield "residual_velocity", strike, _single("residual velocity", "m/s", *residual)
    yield "absorbed_energy", result.strike_energy, _single("absorbed energy", "J", *absorbed)
    # deflection and tension of a torn panel depend on when its last yarn failed
    if result.outcome == "perforated":
        return
    deepest = 1e3 * result.max_deflection
    yield "deflection", deepest, _single("peak deflection", "mm", deepest)
    for family, tension in zip(("warp", "weft"), result.peak_tension):
        yield "peak_tension", tension, _single(f"peak tension, {family}", "N", tension)


def _single(name, unit, value, error=0.0):
    """The Interval of a result that has not been compared."""
    return Interval(name, unit, value, value, inf, (error,))


def differences(coarse: ImpactResult, fine: ImpactResult) -> dict[str, float]:
    """Compute {quantity: [-] norm of the difference of the solutions}, over velocity and energy of
    the strike, the largest deflection and the peak tensions; infinite if the outcomes differ, 0 of
    what a projectile that has stopped or a panel that is perforated does not have. Velocity and
    energy of a projectile that perforates have none: infinite.

    The difference of a single number can vanish by chance where two solutions cross. So it is a
    norm: of deflection, and of velocity and absorbed energy of a projectile that is still in
    flight, the largest difference of the histories up to the end of the shorter run; of peak
    tensions the larger relative difference of warp and weft. Of a projectile that perforates
    velocity and energy are means over a window of strike velocities (`window`): d is the difference
    of the means, and to U is added the root of the sum of the squares of their standard errors.
    Where outcomes differ, no result has an uncertainty.
    """
    (t, _, v), (tf, _, vf) = (result.step_history[:, :3].T for result in (coarse, fine))
    common = t <= tf[-1]
    strike = coarse.setup.strike_velocity
    deepest = coarse.max_deflection
    other_deepest = fine.max_deflection
    shared = coarse.time[coarse.time <= fine.time[-1]]
    depth = np.interp(shared, fine.time, fine.deflection) - coarse.deflection[: shared.size]
    # the peak may lie between two samples of the histories
    depths = np.append(depth, other_deepest - deepest)
    ends = (max(result.residual_velocity, 0.0) for result in (coarse, fine))
    speeds = zip((v[common], np.interp(t[common], tf, vf)), ends)
    speed, other = (np.append(history, end) / strike for history, end in speeds)
    tensions = [abs(b / a - 1) for a, b in zip(coarse.peak_tension, fine.peak_tension) if a > 0]
    holds = coarse.outcome != "perforated"
    moves = {"stopped": 0.0, "perforated": inf}
    norms = {
        "residual_velocity": moves.get(coarse.outcome, np.abs(other - speed).max()),
        "absorbed_energy": moves.get(coarse.outcome, np.abs(other**2 - speed**2).max()),
        "deflection": holds and np.abs(depths).max() / deepest,
        "peak_tension": holds and max(tensions, default=0.0),
    }
    if coarse.outcome != fine.outcome:
        return dict.fromkeys(norms, inf)
    return {name: float(norm) for name, norm in norms.items()}
