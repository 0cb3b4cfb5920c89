"""Run maps: each point is kept as soon as it is done, so that an interrupted study goes on where it was."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from fabrics import run_cache
from fabrics.executors import open_executor
from validation.verification.stability.core import Found, Map, Outcome, explore
from validation.verification.study import known

NAMES = (
    "time-step",
    "viscosity",
    "hourglass",
    "penalty",
    "edge-radius",
    "newton",
    "bracket",
    "printed-law",
    "bars",
    "load-step",
    "plies",
    "bias",
)  # of the command line


def load(key: str, quick: bool = False) -> Map:
    """A map by its name.

    Raises
    ------
    InputError : there is none of this name
    """
    known("--map", key, NAMES)
    return _module(key).chart(quick)


def _module(key):
    """The file of a map, imported when it is needed: the libraries of some may not be installed."""
    match key:
        case "time-step":
            from validation.verification.stability import time_step as module
        case "viscosity":
            from validation.verification.stability import viscosity as module
        case "hourglass":
            from validation.verification.stability import hourglass as module
        case "penalty":
            from validation.verification.stability import penalty as module
        case "edge-radius":
            from validation.verification.stability import edge_radius as module
        case "newton":
            from validation.verification.stability import newton as module
        case "bracket":
            from validation.verification.stability import bracket as module
        case "printed-law":
            from validation.verification.stability import printed_law as module
        case "bars":
            from validation.verification.stability import bars as module
        case "load-step":
            from validation.verification.stability import load_step as module
        case "plies":
            from validation.verification.stability import plies as module
        case "bias":
            from validation.verification.stability import bias as module
    return module


def solve(key: str, x: Any, y: Any) -> Outcome:
    """Outcome of one point of a map."""
    return load(key).point(x, y)


def run(
    key: str, folder: Path, *, quick: bool = False, resume: bool = False, executor: str = "local", jobs: int = 1,
    report: Callable[..., object] | None = None,
) -> Found:  # fmt: skip
    """Run all points of a map, and look for its edges; a core.Found.

    Parameters
    ----------
    key : of NAMES
    folder : Path in which points are kept
    quick : fewer points
    resume : take points that are done from the folder
    executor, jobs : as of `fabrics.executors.open_executor`
    report : called as report(number done, number of all)
    """
    chart = load(key, quick)
    if not resume:
        run_cache.RunCache(folder).clear()
    with open_executor(executor, jobs) as pool:

        def many(points):
            return run_cache.results(
                solve, [(key, *point) for point in points], folder=folder, executor=pool, jobs=jobs,
                report=report if len(points) > 1 else None,
            )  # fmt: skip

        return explore(chart, many, 2 if quick else 5)
