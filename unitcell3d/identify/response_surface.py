"""The response of a crossover sampled over a rectangle of end displacements (thesis Figure 3-11).

The grid is a tensor product, its lines paths of continuation: a stem from rest to the corner
(lowest d1, lowest d2) and on along d2; from each of its states a row along d1. Where a tolerance is
given, lines are added half-way beside those that the interpolant misses by more when they are left
out (`interpolant.errors`), which is where contact sets in: new rows start from the stem, new
columns from the first row. Without friction the response does not depend on the path. With it the
surface is that of stretching the weft first and the warp then, and lines cannot be added.

Each line (`surface_line`) is kept in a file of its own as soon as it is solved (`fabrics.base.run_cache`).
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.executors import open_executor
from fabrics.fabric import Fabric
from fabrics.surface import ResponseSurface
from meshing import crossover as mesher
from meshing.inputs import Size
from unitcell3d.identify.interpolant import FEWEST, QUANTITIES, errors
from unitcell3d.identify.surface_line import Case, Line, solve_line
from unitcell3d.model.crossover import Numerics

POINTS = (21, 21)
MAX_DISPLACEMENT = 0.03e-3  # m
MOST_LINES = 65  # in one direction
ROUNDS = 6
FORCES = ("T1", "T2", "F_c")


@dataclass(frozen=True)
class Sampled:
    """What `sample` found.

    Parameters
    ----------
    surface : ResponseSurface
    errors : {quantity: interpolant.Error}
    seconds : {line: wall time [s]}, of resumed lines too
    iterations : tangents factorised
    solves : equilibria found at points of the grid
    """

    surface: ResponseSurface
    errors: dict
    seconds: dict
    iterations: int
    solves: int


def sample(
    fabric: Fabric,
    *,
    d1: tuple[float, float] = (0.0, MAX_DISPLACEMENT),
    d2: tuple[float, float] = (0.0, MAX_DISPLACEMENT),
    points: tuple[int, int] = POINTS,
    tolerance: float | None = None,
    size: Size,
    friction: float = 0.0,
    folder: FilePath | None = None,
    resume: bool = False,
    executor: str | Executor = "local",
    jobs: int = 1,
    on_progress: Callable[[float], object] | None = None,
    provenance: str = "",
) -> Sampled:
    """Sample T1, T2, F_c, h1, h2 of a fabric's crossover over a rectangle.

    Parameters
    ----------
    fabric : Fabric, with solid laws
    d1, d2 : (lowest, highest) [m] end displacements per end
    points : number of lines in each direction, evenly spread; to begin with, where there is a
        tolerance
    tolerance : [-] of the largest T1, T2, F_c: add lines until none that is left out is missed by
        more, or there are `MOST_LINES`; None: no more lines
    size : of the mesh
    friction : [-] Coulomb's coefficient between the yarns; not with a tolerance
    folder : where finished lines are kept, or None
    resume : begin with the lines of the folder; otherwise it is emptied first
    executor, jobs : as in `fabrics.base.executors.open_executor`, for the lines
    on_progress : called as on_progress(share) after each line
    provenance : text kept with the surface

    Returns
    -------
    Sampled

    Raises
    ------
    InputError : a range, number or size is not allowed
    UnstableError : a line found no equilibrium; those that were finished are kept
    """
    axes = check(d1, d2, points, tolerance, friction)
    mesher.build(fabric, size=size)  # bad input ends here, in this process
    with (
        TemporaryDirectory() as spare,
        open_executor(executor, jobs, fresh=True) as pool,
    ):
        kept = Path(folder or spare)
        if not resume:
            run_cache.RunCache(kept).clear()
        lines = _Lines(fabric, size, friction, kept, pool, on_progress)
        new = axes
        axes = [axis[:0] for axis in axes]
        for _ in range(1 if tolerance is None else ROUNDS):
            axes = _add_lines(lines, axes, new)
            surface = _assemble(lines, axes, provenance)
            new = _missing(surface, tolerance)
            if not any(axis.size for axis in new):
                break
    found = lines.found.values()
    return Sampled(
        surface,
        errors(surface),
        {case.name: line.seconds for case, line in found},
        sum(line.iterations for _, line in found),
        sum(len(line.along) for _, line in found),
    )


def check(
    d1: tuple[float, float],
    d2: tuple[float, float],
    points: tuple[int, int],
    tolerance: float | None,
    friction: float,
) -> list[np.ndarray]:
    """Refuse what `sample` does not take; return the places [m] of the first lines of both axes."""
    axes = [_axis(name, span, n) for name, span, n in zip(("d1", "d2"), (d1, d2), points)]
    if tolerance is not None and not 0 < tolerance < 1:
        raise InputError(key="tolerance", value=tolerance, allowed="above 0 and below 1")
    if tolerance is not None and friction:
        raise InputError(
            "a tolerance goes without friction, with which added lines would be of other paths"
        )
    Numerics(friction=friction)  # refuses what is not allowed
    return axes


def _axis(name, span, n):
    low, high = (float(end) for end in span)
    if not low < high:
        raise InputError(key=name, value=f"{low:g} to {high:g} m", allowed="a range that rises")
    if not FEWEST <= n <= MOST_LINES:
        raise InputError(key="points", value=n, allowed=f"{FEWEST} to {MOST_LINES}")
    return np.linspace(low, high, n)


def _add_lines(lines, axes, new):
    """Solve the lines `new` (d1, d2) beside the lines `axes` there are; returns all lines."""
    friction = lines.friction
    if axes[0].size == 0:  # the first: a stem along d2 and rows
        x1, x2 = new
        total = 1 + x2.size
        [stem] = lines.solve([Case(1, x1[0], x2, keep=True, friction=friction)], total)
        stuck = [None] * x2.size
        if friction:
            stuck = stem.stick_state
        cases = []
        for d, q, stick_state in zip(x2, stem.states, stuck):
            keep = d == x2[0]
            cases.append(Case(0, d, x1, (x1[0], d), q, stick_state, keep, friction))
        lines.solve(cases, total)
        return new
    x1, x2 = axes
    rows = np.union1d(x2, new[1])
    stem = Case(1, x1[0], x2)
    row = Case(0, x2[0], x1)
    cases = [Case(0, d, x1, *lines.state_before(stem, d)) for d in new[1]]
    cases += [Case(1, d, rows, *lines.state_before(row, d)) for d in new[0]]
    lines.solve(cases, len(lines.found) + len(cases))
    return [np.union1d(x1, new[0]), rows]


def _missing(surface, tolerance):
    """Lines half-way beside those that are missed by more than the tolerance when they are left
    out: (d1, d2)."""
    if tolerance is None:
        return [np.empty(0), np.empty(0)]
    found = errors(surface)
    new = []
    for number, axis in enumerate((surface.d1, surface.d2)):
        missed = []
        for name in FORCES:
            largest = abs(getattr(surface, name)).max()
            missed.append(found[name].lines[number] / largest)
        worst = np.max(missed, axis=0)
        wanted = np.zeros(axis.size - 1, bool)
        for i in np.flatnonzero(worst > tolerance):
            wanted[i - 1 : i + 1] = True
        middles = 0.5 * (axis[1:] + axis[:-1])
        new.append(middles[wanted][: MOST_LINES - axis.size])
    return new


def _assemble(lines, axes, provenance):
    values = {}
    for case, line in lines.found.values():
        values |= {case.at(place): row for place, row in zip(line.along, line.values)}
    table = np.array([[values[float(a), float(b)] for b in axes[1]] for a in axes[0]])
    fabric = lines.fabric.name
    made = f"3D crossover of {fabric}, {lines.size} mesh"
    if lines.friction:
        made += f", friction {lines.friction:g}, weft stretched first"
    if provenance:
        made += f"; {provenance}"
    columns = {name: np.ascontiguousarray(table[:, :, i]) for i, name in enumerate(QUANTITIES)}
    return ResponseSurface(*axes, **columns, fabric=fabric, provenance=made)


@dataclass
class _Lines:
    """Solves the lines of a surface; `found` has those that are done: {name: (Case, Line)}."""

    fabric: Fabric
    size: Size
    friction: float
    folder: Path
    pool: Executor
    on_progress: Callable[[float], object] | None
    found: dict[str, tuple[Case, Line]] = field(default_factory=dict)

    def solve(self, cases, total):
        """Lines of the cases; `total` is how many there will be in all, for the progress."""
        before = len(self.found)

        def tell(done, _):
            if self.on_progress is not None:
                self.on_progress((before + done) / total)

        tasks = [(self.fabric, self.size, case) for case in cases]
        lines = run_cache.results(
            solve_line, tasks, folder=self.folder, executor=self.pool, report=tell
        )
        for case, line in zip(cases, lines):
            self.found[case.name] = (case, line)
        return lines

    def state_before(self, case, place):
        """Last state of a solved line before a place: ((d1, d2), unknowns)."""
        case, line = self.found[case.name]
        i = int(np.searchsorted(line.along, place)) - 1
        return case.at(line.along[i]), line.states[i]
