"""Discretisation uncertainty of an impact from a pair of meshes: the grid convergence index of ASME V&V 20.

The scene is run on its own mesh and on one whose elements near the impact point have half the side. With the
difference d of a result between the two,

    U = F_s d r^p / (r^p - 1),    r = 2,

is the uncertainty of the result on the scene's own mesh. Two meshes show no order of convergence, so that p is the
formal order of the elements, 2, and F_s = 3, the factor that goes with an order which is assumed (P. J. Roache,
Verification and Validation in Computational Science and Engineering, 1998; ASME V&V 20-2009, section 2-4). The interval
of a result phi is phi - U to phi + U.

The difference of a single number can vanish by chance where two solutions cross. So d is a norm of the difference of
the solutions: of the residual velocity, the absorbed energy and the deflection the largest difference of their
histories, up to the end of the shorter run, and of peak tensions the larger of the relative differences of warp and
weft. What a projectile that stops leaves (no velocity, and all its energy absorbed) has no error.

A result that is not there on one of the meshes, or an outcome that is different on them, has no uncertainty: the
outcome depends on the mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf, isnan
from typing import Any

import numpy as np

from fabrics.errors import InputError
from shellfabric.cell.model import CellTable
from shellfabric.impact.simulation import ImpactResult, ImpactSetup
from weavecell.analysis.fidelity import quantities

RATIO, ORDER, SAFETY = 2, 2.0, 3.0
REACH = 10.0  # [crossovers] from the impact point up to which elements are halved, at least
MOST_ELEMENTS = 8  # a crossover, of the finer mesh
_LATEST = 60.0  # [crossovers] of REACH that is tried before the whole panel is refined


@dataclass(frozen=True)
class Interval:
    """A result and its discretisation uncertainty.

    Parameters
    ----------
    name, unit : of the result
    value, finer : on the scene's mesh and on the finer one
    uncertainty : U, in the same unit
    """

    name: str
    unit: str
    value: float
    finer: float
    uncertainty: float


@dataclass(frozen=True)
class Discretisation:
    """What the pair of meshes gives.

    Parameters
    ----------
    meshes : descriptions of the scene's mesh and the finer one
    outcomes : on both
    intervals : of the results that both meshes have; none where the outcomes differ
    """

    meshes: tuple[str, str]
    outcomes: tuple[str, str]
    intervals: tuple[Interval, ...]

    @property
    def same_outcome(self) -> bool:
        """Whether both meshes have the same outcome."""
        return self.outcomes[0] == self.outcomes[1]


def index(difference: float) -> float:
    """Uncertainty U of a result from its difference d on the two meshes, see the module."""
    return SAFETY * difference * RATIO**ORDER / (RATIO**ORDER - 1)


def finer(setup: ImpactSetup, table: CellTable) -> ImpactSetup:
    """The set-up with half the element side within REACH of the impact point, or further where the projectile needs it.

    Where the panel cannot be graded (edges that are held by friction) all its elements are halved. No snapshots are
    taken and no histories recorded.

    Parameters
    ----------
    setup : of the scene
    table : of its cell

    Raises
    ------
    InputError : the finer mesh would have more than MOST_ELEMENTS elements along a crossover
    """
    setup = replace(setup, snapshot_interval=None, history=None)
    ply = setup.meshed
    if ply.grading is not None:
        (until, side), *rest = ply.grading
        side = Fraction(side).limit_denominator(MOST_ELEMENTS) / RATIO
        _check(1 / side)
        return replace(setup, grading=((float(until), float(side)), *rest))
    count = ply.resolved_elements_per_crossover
    _check(RATIO * count)
    reach = REACH
    while reach <= _LATEST:
        zones = ((reach, 1 / (RATIO * count)), (inf, 1 / count))
        graded = replace(ply, elements_per_crossover=None, grading=zones)
        if _can_be_meshed(graded, table):
            return replace(setup, elements_per_crossover=None, grading=graded.grading)
        reach *= 1.5
    return replace(setup, elements_per_crossover=RATIO * count)


def _check(count: float | Fraction) -> None:
    if count > MOST_ELEMENTS:
        allowed = f"at most {MOST_ELEMENTS // RATIO} elements per crossover, which the finer mesh doubles"
        raise InputError(key="--uncertainty", value=f"a finer mesh of {count} elements per crossover", allowed=allowed)


def _can_be_meshed(ply: ImpactSetup, table: CellTable) -> bool:
    """Whether the panel can be graded so."""
    try:
        ply.panel(table)
    except InputError:
        return False
    return True


def in_words(setup: ImpactSetup) -> str:
    """The mesh of a set-up."""
    ply = setup.meshed
    if ply.grading is None:
        count = ply.resolved_elements_per_crossover
        return f"{count} element{'s' * (count > 1)} per crossover"
    return (
        "sides of "
        + ", ".join(
            f"{Fraction(side).limit_denominator(MOST_ELEMENTS)}{'' if until == inf else f' to {until:g}'}"
            for until, side in ply.grading
        )
        + " crossovers"
    )


def run_pair(
    setup: ImpactSetup, shoot: Callable[..., tuple[Any, Any, Any, Any]]
) -> tuple[tuple[Any, Any, Any], Discretisation]:
    """Run a scene on its mesh and on the finer one.

    Parameters
    ----------
    setup : of the scene
    shoot : called as shoot(setup, table, name of the mesh), gives (record, snapshots, failure, result)

    Returns
    -------
    shot : (record, snapshots, failure) on the scene's mesh
    pair : Discretisation; where the run on the scene's mesh became unstable, of it alone

    Raises
    ------
    InputError : as `finer`; nothing has been run
    """
    table = setup.table(kept=True)
    refined = finer(setup, table)
    record, snapshots, failure, result = shoot(setup, table)
    other = result if failure is not None else shoot(refined, table, "finer mesh")[3]
    return (record, snapshots, failure), compare(result, other)


def compare(result: ImpactResult, refined: ImpactResult) -> Discretisation:
    """The pair of results, ImpactResult, of the scene's mesh and the finer one."""
    values, others = quantities.of(result), quantities.of(refined)
    ply = result.setup.meshed
    energy = result.strike_energy
    rows = [("residual velocity", "m/s", ply.strike_velocity, "residual_velocity", None),
            ("absorbed energy", "J", energy, "absorbed_energy", None),
            ("peak deflection", "mm", 1e3, "deflection", None),
            ("peak tension, warp", "N", 1.0, "peak_tension", 0),
            ("peak tension, weft", "N", 1.0, "peak_tension", 1)]  # fmt: skip
    apart = _apart(result, refined, values, others)
    found = []
    for name, unit, scale, key, part in rows:
        a, b = (one[key] if part is None else one[key][part] for one in (values, others))
        if not (isnan(a) or isnan(b)):
            off = max(abs(b - a), apart[key] * (1.0 if part is None else abs(a)))
            found.append(Interval(name, unit, scale * a, scale * b, index(scale * off)))
    outcomes = values["outcome"], others["outcome"]
    kept = tuple(found) if outcomes[0] == outcomes[1] else ()
    return Discretisation((in_words(result.setup), in_words(refined.setup)), outcomes, kept)


def _apart(result, refined, values, others):
    """{name: norm of the difference of the solutions}, in the units of `quantities.of`; of tensions over themselves."""
    (t, z, v), (tf, zf, vf) = (one.step_history[:, :3].T for one in (result, refined))
    common = t <= tf[-1]
    z, v = z[common], v[common] / result.setup.strike_velocity
    zf, vf = (np.interp(t[common], tf, one) for one in (zf, vf / refined.setup.strike_velocity))
    moving = values["outcome"] != "stopped"
    tensions = [abs(b / a - 1) for a, b in zip(values["peak_tension"], others["peak_tension"]) if a > 0]
    return {
        "residual_velocity": float(np.max(np.abs(vf - v), initial=0.0)) if moving else 0.0,
        "absorbed_energy": float(np.max(np.abs(vf**2 - v**2), initial=0.0)) if moving else 0.0,
        "deflection": float(np.max(np.abs(zf - z), initial=0.0)),
        "peak_tension": max(tensions, default=0.0),
    }
