"""The runs of the study: cases, the critical velocity of a case, and its shots about 1.5 times it.

The meshes of a pack or ply are `default`, that of ImpactSetup.meshed, `finer`, with half of its element side about the
impact point (`mesh_uncertainty.finer`), and `coarser`, with one element per crossover everywhere. Cases that are
compared share one window of strike velocities, about 1.5 times the critical velocity of the first of them. Their
bisections begin at one velocity, which depends on fabric and plies alone: where outcomes are mixed, where a bisection
ends depends on where it begins.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from statistics import median
from typing import Any

import weavecell as wc
from fabrics import catalogue, run_cache
from fabrics.errors import UndecidedError, UnstableError
from fabrics.variants import with_failure_length
from shellfabric.impact import ballistic_limit, simulation
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.numerics import Numerics
from validation.published.packs import limits
from weavecell.studies import mesh_uncertainty, sweep
from weavecell.studies.window import Window

FACTORS = 0.92, 0.94, 0.96, 0.98, 1.0, 1.02, 1.04, 1.06, 1.08
MULTIPLE = 1.5  # of the critical velocity: middle of the window
TOLERANCE, PACK_TOLERANCE = 0.25, 1.0  # [m/s] of the bracket of the critical velocity of one ply, and of packs
VISCOUS = "viscous energy"  # the indicator of `quality`


@dataclass(frozen=True)
class Case:
    """A ply or pack on a mesh.

    Parameters
    ----------
    fabric : name of one of the catalogue
    plies : number of plies
    mesh : "coarser", "default" or "finer"
    opening : [m] side of the square opening
    table_size : of the cell's table, as of ImpactSetup
    projectile : name of one of weavecell's, or "" for the default
    size, mass : of all lengths of the weave, and of the yarns' linear density, over those of the data sheet
    failure_length : [m] of the fabric; None takes its own
    cfl : Courant factor
    """

    fabric: str
    plies: int = 1
    mesh: str = "default"
    opening: float = 0.203
    table_size: int = 201
    projectile: str = ""
    size: float = 1.0
    mass: float = 1.0
    failure_length: float | None = None
    cfl: float = Numerics.cfl


@dataclass(frozen=True)
class Limit:
    """Critical velocity and half the width of its bracket [m/s], and why there is none."""

    velocity: float
    half_width: float
    problem: str = ""


@dataclass(frozen=True)
class Measured:
    """What a case came to; its window is None where the critical velocity in its middle is not known."""

    case: Case
    limit: Limit
    window: Window | None = None

    def mean(self, quantity: str) -> tuple[float, float]:
        """(mean, standard error) of one of `window.QUANTITIES`, or "critical_velocity" and half its bracket, in its
        unit; NaN where it is not known."""
        if quantity == "critical_velocity":
            return self.limit.velocity, self.limit.half_width
        return (nan, nan) if self.window is None else self.window.mean(quantity)

    @property
    def cpu(self) -> float:
        """[s] of one shot of the window, the median: the first shot of a process may compile."""
        return nan if self.window is None else median(shot["cpu_s"] for shot in self.window.shots)

    @property
    def viscous(self) -> float:
        """[-] largest share of viscous energy until the first failure, of all shots of the window."""
        return nan if self.window is None else max(shot[VISCOUS] for shot in self.window.shots)

    @property
    def elements(self) -> int:
        """Of the modelled part, of all plies."""
        return 0 if self.window is None else self.window.shots[0]["elements"]

    @property
    def not_perforated(self) -> int:
        """Number of shots of the window that did not perforate."""
        return 0 if self.window is None else len(self.window.shots) - self.window.outcomes["perforated"]


def setup(case: Case, velocity: float = 100.0) -> ImpactSetup:
    """The set-up of a shot at a case, at a strike velocity [m/s].

    Raises
    ------
    InputError : as ImpactSetup and `mesh_uncertainty.finer`
    """
    fabric = catalogue.load(case.fabric).with_effective_density()
    if (case.size, case.mass) != (1, 1):
        fabric = limits.changed(fabric, limits.Case((case.fabric,), size=case.size, mass=case.mass))
    if case.failure_length is not None:
        fabric = with_failure_length(fabric, case.failure_length)
    shot = ImpactSetup(
        fabric, velocity, opening=case.opening, table_size=case.table_size, plies=case.plies,
        end_time=ballistic_limit.UNDECIDED, numerics=Numerics(threads=1, cfl=case.cfl),
    )  # fmt: skip
    if case.projectile:
        shot = replace(shot, projectile=wc.setup(fabric, velocity, projectile=case.projectile).projectile)
    if case.mesh == "coarser":
        return replace(shot, elements_per_crossover=1)
    return mesh_uncertainty.finer(shot, shot.plain_table()) if case.mesh == "finer" else shot


def critical_velocity(case: Case) -> Limit:
    """The critical velocity of a case; InputError as `setup` and `ballistic_limit.critical_velocity`."""
    shot, tolerance = setup(case), TOLERANCE if case.plies == 1 else PACK_TOLERANCE
    try:
        result = ballistic_limit.critical_velocity(shot.target(shot.table(kept=True)), tolerance=tolerance)
    except (UnstableError, UndecidedError) as problem:
        return Limit(nan, nan, str(problem))
    return Limit(result.velocity, result.half_width)


def fire(case: Case, velocity: float) -> dict[str, Any]:
    """The row of one shot of the window: that of `sweep.row_of`, its velocity, CPU time, elements and viscous share."""
    shot = setup(case, velocity)
    table = shot.table(kept=True)
    began = time.process_time()
    result, problem = simulation.fired(shot, table=table)
    row = {"strike_velocity_m_s": velocity, "cpu_s": time.process_time() - began}
    row["elements"] = sum(panel.elements for panel in result.panels)
    row[VISCOUS] = next(check.value for check in result.checks if check.name == VISCOUS)
    return row | sweep.row_of(result, problem)


def measure(groups: Sequence[Sequence[Case]], folder: Path, jobs: int = 1) -> list[list[Measured]]:
    """Critical velocity and window of all cases; every bisection and every shot is kept as soon as it is done.

    Parameters
    ----------
    groups : cases that share the window of the first of them
    folder, jobs : as of `run_cache.results`

    Raises
    ------
    InputError : as `critical_velocity`
    """
    cases = [(case,) for group in groups for case in group]
    velocities = run_cache.results(critical_velocity, cases, folder=folder, jobs=jobs)
    limit_of = {case: limit for (case,), limit in zip(cases, velocities)}
    middles = {case: round(MULTIPLE * limit_of[group[0]].velocity, 1) for group in groups for case in group}
    shots = [(case, round(factor * middle, 3)) for case, middle in middles.items() if middle > 0 for factor in FACTORS]
    rows = run_cache.results(fire, shots, folder=folder, jobs=jobs)
    by_case: dict[Case, list[dict[str, Any]]] = {}
    for (case, _), row in zip(shots, rows):
        by_case.setdefault(case, []).append(row)
    windows = {case: Window(middles[case], tuple(own)) for case, own in by_case.items()}
    return [[Measured(case, limit_of[case], windows.get(case)) for case in group] for group in groups]
