"""The two loadings of a crossover: biaxial extension to fibre failure, and compression between
rigid plates.

Two readings of "the fibres fail at 3 %" differ, because a yarn that is bent over the other strains
its fibres unevenly: the worst bar, and the mean over the fibres of a yarn. A path ends at the mean;
`failure` reports both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from fabrics.plate_curve import PLATEN_PRESSURE
from meshing.crossover import Crossover
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.load_stepping import Steps
from unitcell3d.solver.newton import Equilibrium
from unitcell3d.solver.path_following import Hook, follow
from unitcell3d.solver.recorded import crossover_row, fibre_row

MIN_PLATE_GAP = 0.5  # of the plates' distance at rest


def biaxial(
    crossover: Crossover,
    fabric: Fabric,
    ratio: Sequence[float] = (1.0, 1.0),
    *,
    max_displacement: float | None = None,
    beyond: float = 1.0,
    pressed: float | None = None,
    numerics: Numerics | None = None,
    steps: Steps | None = None,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Stretch a crossover along d1 : d2 = `ratio` until the mean fibre strain of a yarn is its
    failure strain.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric : Fabric
    ratio : (d1, d2) [-] proportions of the end displacements; 0 holds a yarn's ends
    max_displacement : [m] larger of the two end displacements at the end of the path, instead of
        fibre failure
    beyond : [-] that mean strain at the end of the path over the failure strain; above 1 fibres
        that fail go on
    pressed : [-] contact force over the one at which a fibre first fails, with which the path ends
        too; None: the path does not look at it
    numerics, steps, hooks : see `model.crossover.Numerics`, `load_stepping.Steps`,
        `path_following.follow`

    Returns
    -------
    Record, with the columns of `row`

    Raises
    ------
    InputError : the ratio stretches no yarn, or `max_displacement` is not positive
    """
    if max_displacement is not None and not max_displacement > 0:
        raise InputError(key="max_displacement", value=max_displacement, allowed="positive")
    stop: Callable[[dict], float] | None
    d, stop = path_to_failure(fabric, ratio, beyond, pressed)
    if max_displacement is not None:
        d *= max_displacement / abs(d).max()
        stop = None
    model = CrossoverModel(crossover, fabric, numerics)
    end = Load((float(d[0]), float(d[1])))
    shares = d / abs(d).max()
    facts = {"case": f"biaxial {shares[0]:g} : {shares[1]:g}"}
    return follow(
        model, [Load(), end], row(model), steps=steps, stop=stop, facts=facts, hooks=hooks
    )


def path_to_failure(
    fabric: Fabric, ratio: Sequence[float], beyond: float = 1.0, pressed: float | None = None
) -> tuple[FloatArray, Callable[[dict], float]]:
    """Return the farthest end (2,) [m] of a path along d1 : d2 = `ratio`, and what reaches 1 where it
    is to end; parameters and errors as of `biaxial`."""
    shares = _proportions(ratio)
    # no path goes on longer than to a straight yarn
    straight = displacements_at_failure(fabric, beyond)
    farthest = min(d / part for d, part in zip(straight, shares) if part > 0)
    limits = np.array([yarn.failure_strain for yarn in fabric.weave.yarns])
    stop = _worst_yarn(beyond * limits)
    if pressed is not None:
        stop = _worst_yarn_or_force(limits, beyond, pressed)
    return farthest * shares, stop


def row(model: CrossoverModel) -> Callable[[Equilibrium, Load], dict[str, Any]]:
    """Return the function that records a state of a crossover: loads, forces, heights, and strains
    of the fibres."""
    return lambda state, load: crossover_row(model, state, load) | fibre_row(model, state, load)


def _proportions(ratio):
    """(2,) ratio of the end displacements, the larger of them 1."""
    try:
        shares = np.array([float(part) for part in ratio])
    except (TypeError, ValueError):
        shares = np.array([])
    if shares.shape != (2,) or not np.all(np.isfinite(shares)) or shares.max() <= 0:
        allowed = "two numbers, one of them at least above 0"
        raise InputError(key="ratio", value=tuple(shares), allowed=allowed)
    return shares / abs(shares).max()


def displacements_at_failure(fabric: Fabric, beyond: float = 1.0) -> tuple[float, ...]:
    """Compute the end displacements (d1, d2) [m] at which warp and weft are straight and at
    `beyond` times their failure strain."""
    return tuple(
        w * ((1 + yarn.crimp) * (1 + beyond * yarn.failure_strain) - 1)
        for w, yarn in zip(fabric.weave.w, fabric.weave.yarns)
    )


def _worst_yarn(limits):
    return lambda row: float(np.max(row["fibre_strain_mean"] / limits))


def _worst_yarn_or_force(limits, beyond, pressed):
    """As `_worst_yarn` with `beyond` times the limits, or 1 where the contact force is so many times that at them."""
    strain = _worst_yarn(limits)
    seen = {}

    def share(row):
        reached = strain(row)
        seen[reached] = row["F_c"]
        if reached <= 1:
            return reached / beyond
        strains = sorted(seen)
        at_limit = np.interp(1.0, strains, [seen[one] for one in strains])
        return max(reached / beyond, row["F_c"] / (pressed * at_limit))

    return share


def plate_compression(
    crossover: Crossover,
    fabric: Fabric,
    *,
    pressure: float = PLATEN_PRESSURE,
    min_plate_gap: float = MIN_PLATE_GAP,
    numerics: Numerics | None = None,
    steps: Steps | None = None,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Press a crossover between two rigid plates, the yarns' ends held in the plane at their
    spacing.

    The plates stand at equal distances above and below the middle plane, as the two-fold axis of
    the weave requires, so that the higher yarn is touched first.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric : Fabric
    pressure : [Pa] mean on the area of the cell at the end of the path, by default the highest of
        the thesis
    min_plate_gap : [-] share of the first distance of the plates at which the path ends too
    numerics, steps, hooks : see `model.crossover.Numerics`, `load_stepping.Steps`,
        `path_following.follow`

    Returns
    -------
    Record, with the columns of `row`

    Raises
    ------
    InputError : the pressure is not positive, or the share is not between 0 and 1
    """
    if not pressure > 0:
        raise InputError(key="pressure", value=pressure, allowed="positive")
    if not 0 < min_plate_gap < 1:
        raise InputError(key="min_plate_gap", value=min_plate_gap, allowed="between 0 and 1")
    model = CrossoverModel(crossover, fabric, numerics)
    rest = model.plates.at_rest
    force = pressure * fabric.weave.cell_area
    return follow(
        model,
        [Load(plates=rest), Load(plates=min_plate_gap * rest)],
        row(model),
        steps=steps,
        stop=lambda row: float(np.mean(row["F_plate"])) / force,
        facts={"case": "plates"},
        hooks=hooks,
    )


@dataclass(frozen=True)
class Failure:
    """Where a biaxial path first meets a criterion: yarn (0 warp, 1 weft), d1, d2 [m], T1, T2 and
    F_c [N]."""

    criterion: str
    yarn: int
    d: tuple
    T: tuple
    F_c: float


def failure(record: Record, fabric: Fabric) -> list[Failure]:
    """Find the failure by the worst bar and by the mean of the bars, without those that the path
    did not reach."""
    limits = np.array([yarn.failure_strain for yarn in fabric.weave.yarns])
    worst = record["fibre_strain_max"] / limits
    mean = record["fibre_strain_mean"] / limits
    # the path ends within a tolerance of the mean's limit
    last = min(1.0, max(mean[-1].max(), 0.998))
    found = []
    for criterion, ratios, limit in (("worst bar", worst, 1.0), ("mean of bars", mean, last)):
        ratio = ratios.max(axis=1)
        if ratio.max() < limit:
            continue
        yarn = int(np.argmax(ratios[np.argmax(ratio >= limit)]))
        columns = ("d1", "d2", "T1", "T2", "F_c")
        d1, d2, T1, T2, F_c = (first_reached(record[c], ratio, limit) for c in columns)
        found.append(Failure(criterion, yarn, (d1, d2), (T1, T2), F_c))
    return found


def first_reached(column: FloatArray, quantity: FloatArray, value: float) -> float:
    """Interpolate `column` (n,) at the first place where `quantity` (n,), which reaches `value`,
    does so."""
    i = int(np.argmax(quantity >= value))
    if i == 0:
        return float(column[0])
    share = (value - quantity[i - 1]) / (quantity[i] - quantity[i - 1])
    return float(column[i - 1] + share * (column[i] - column[i - 1]))
