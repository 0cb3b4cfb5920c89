"""The response of a crossover sampled over a rectangle of end displacements (thesis Figure 3-11).

The grid is a tensor product, its lines paths of continuation: a stem from rest to the corner
(lowest d1, lowest d2) and on along d2; from each of its states a row along d1. Where a tolerance is
given, lines are added half-way beside those that the interpolant misses by more when they are left
out (`interpolant.errors`), which is where contact sets in: new rows start from the stem, new
columns from the first row. Without friction the response does not depend on the path. With it the
surface is that of stretching the weft first and the warp then, and lines cannot be added.

Finished lines (`surface_line`) are kept in one file, written whole after each of them.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass, replace

import numpy as np

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.executors import open_executor
from fabrics.fabric import Fabric
from fabrics.surface import ResponseSurface
from meshing import crossover as mesher
from meshing.inputs import Size
from unitcell3d.identify.interpolant import FEWEST, QUANTITIES, errors
from unitcell3d.identify.surface_cache import Partial
from unitcell3d.identify.surface_line import Case, solve_line
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
    size: Size = "medium",
    friction: float = 0.0,
    partial: FilePath | None = None,
    resume: bool = False,
    executor: str | Executor = "local",
    jobs: int = 1,
    on_progress: Callable[[float, str], object] | None = None,
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
    partial : file (.h5) in which finished lines are kept, or None
    resume : go on from `partial` if it is there
    executor, jobs : as of `fabrics.base.executors.open_executor`, for the lines
    on_progress : called as on_progress(share, text) after each line
    provenance : text kept with the surface

    Returns
    -------
    Sampled

    Raises
    ------
    InputError : a range, number or size is not allowed, or `partial` is of another surface or of
        other code
    UnstableError : a line found no equilibrium; the others are kept in `partial`
    """
    axes = [_axis(name, span, n) for name, span, n in zip(("d1", "d2"), (d1, d2), points)]
    _check(tolerance, friction, jobs)
    mesher.build(fabric, size=size)  # bad input ends here, in this process
    done = Partial(
        partial, run_cache.stamp((fabric, size, tolerance, friction, axes), __name__), resume
    )
    with open_executor(executor, jobs, fresh=True) as pool:
        run = _Run(fabric, size, friction, done, pool, on_progress or _silent)
        new = axes
        axes = [axis[:0] for axis in axes]
        for _ in range(1 if tolerance is None else ROUNDS):
            axes = _add_lines(run, axes, new)
            surface = _assemble(done, axes, fabric, size, friction, provenance)
            new = _missing(surface, tolerance)
            if not any(axis.size for axis in new):
                break
    lines = done.lines
    return Sampled(
        surface,
        errors(surface),
        {name: float(line.seconds) for name, line in lines.items()},
        int(sum(line.iterations for line in lines.values())),
        int(sum(len(line.along) for line in lines.values())),
    )


def _check(tolerance, friction, jobs):
    if tolerance is not None and not 0 < tolerance < 1:
        raise InputError(key="tolerance", value=tolerance, allowed="above 0 and below 1")
    if tolerance is not None and friction:
        raise InputError(
            "a tolerance goes without friction, with which added lines would be of other paths"
        )
    Numerics(friction=friction)  # refuses what is not allowed
    if jobs < 1:
        raise InputError(key="jobs", value=jobs, allowed="at least 1")


def _axis(name, span, n):
    low, high = (float(end) for end in span)
    if not low < high:
        raise InputError(key=name, value=f"{low:g} to {high:g} m", allowed="a range that rises")
    if not FEWEST <= n <= MOST_LINES:
        raise InputError(key="points", value=n, allowed=f"{FEWEST} to {MOST_LINES}")
    return np.linspace(low, high, n)


def _silent(share, text):
    pass


def _add_lines(run, axes, new):
    """Solve the lines `new` (d1, d2) beside the lines `axes` there are; returns all lines."""
    if axes[0].size == 0:  # the first: a stem along d2 and rows
        x1, x2 = new
        stem = run([Case(1, x1[0], x2, keep=True)], 1 + x2.size)[0]
        stuck = [None] * x2.size
        if len(stem.stick_state):
            stuck = stem.stick_state
        cases = []
        for d, q, stick_state in zip(x2, stem.states, stuck):
            start = (x1[0], d)
            cases.append(Case(0, d, x1, start, q, stick_state, keep=d == x2[0]))
        run(cases, 1 + x2.size)
        return new
    x1, x2 = axes
    rows = np.union1d(x2, new[1])
    stem = run.kept(Case(1, x1[0], x2))
    row = run.kept(Case(0, x2[0], x1))
    cases = [Case(0, d, x1, *_below(stem, d)) for d in new[1]]
    cases += [Case(1, d, rows, *_below(row, d)) for d in new[0]]
    run(cases, len(run.done.lines) + len(cases))
    return [np.union1d(x1, new[0]), rows]


def _below(line, place):
    """Last state of a line before a place: ((d1, d2), unknowns)."""
    i = int(np.searchsorted(line.along, place)) - 1
    return Case(int(line.axis), line.fixed, line.along).at(line.along[i]), line.states[i]


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
            largest = np.abs(getattr(surface, name)).max()
            missed.append(found[name].lines[number] / largest)
        worst = np.max(missed, axis=0)
        wanted = np.zeros(axis.size - 1, bool)
        for i in np.flatnonzero(worst > tolerance):
            wanted[i - 1 : i + 1] = True
        middles = 0.5 * (axis[1:] + axis[:-1])
        new.append(middles[wanted][: MOST_LINES - axis.size])
    return new


def _assemble(done, axes, fabric, size, friction, provenance):
    values = {}
    for line in done.lines.values():
        case = Case(int(line.axis), line.fixed, line.along)
        values |= {case.at(place): row for place, row in zip(line.along, line.values)}
    table = np.array([[values[float(a), float(b)] for b in axes[1]] for a in axes[0]])
    made = f"3D crossover of {fabric.name}, {size} mesh"
    if friction:
        made += f", friction {friction:g}, weft stretched first"
    if provenance:
        made += f"; {provenance}"
    columns = {name: np.ascontiguousarray(table[:, :, i]) for i, name in enumerate(QUANTITIES)}
    return ResponseSurface(*axes, **columns, fabric=fabric.name, provenance=made)


class _Run:
    """Solves the cases that are not done yet and keeps them."""

    def __init__(self, fabric, size, friction, done, workers, on_progress):
        self.done = done
        self._fabric = fabric
        self._size = size
        self._friction = friction
        self._workers = workers
        self._on_progress = on_progress

    def kept(self, case):
        """The line of a case that is done."""
        return self.done.lines[case.name]

    def __call__(self, cases, total):
        """Lines of the cases; `total` is how many there will be in all, for the progress."""
        open_cases = [case for case in cases if case.name not in self.done.lines]
        problems = []
        for case, outcome in self._outcomes(open_cases):
            try:
                self.done.add(case.name, outcome())
            except UnstableError as problem:
                problems.append(problem)
            self._on_progress(len(self.done.lines) / total, case.name)
        if problems:
            raise problems[0]
        return [self.kept(case) for case in cases]

    def _outcomes(self, cases):
        """(case, function that returns its line or raises) as they come."""
        wanted = {case.name: replace(case, friction=self._friction) for case in cases}
        futures = {
            self._workers.submit(solve_line, self._fabric, self._size, wanted[case.name]): case
            for case in cases
        }
        try:
            for future in as_completed(futures):
                yield futures[future], future.result
        finally:
            for future in futures:
                future.cancel()
