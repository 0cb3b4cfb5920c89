"""Run maps: each point is kept as soon as it is done, so that an interrupted study goes on where it was."""

from __future__ import annotations

import shutil
from importlib import import_module

from fabrics import run_cache
from fabrics.errors import InputError
from fabrics.executors import open_executor
from validation.verification.stability.core import explore

MAPS = {
    "time-step": "time_step",
    "viscosity": "viscosity",
    "hourglass": "hourglass",
    "penalty": "penalty",
    "edge-radius": "edge_radius",
    "newton": "newton",
    "bracket": "bracket",
    "printed-law": "printed_law",
    "bars": "bars",
    "load-step": "load_step",
    "plies": "plies",
    "bias": "bias",
}  # of the command line: file here


def load(key, quick=False):
    """A map by its name.

    Raises
    ------
    InputError : there is none of this name
    """
    if key not in MAPS:
        raise InputError(key="--map", value=key, allowed=f"one of {', '.join(MAPS)}")
    return import_module(f"validation.verification.stability.{MAPS[key]}").chart(quick)


def solve(key, x, y):
    """Outcome of one point of a map."""
    return load(key).point(x, y)


def run(key, folder, *, quick=False, resume=False, executor="local", jobs=1, report=None):
    """Run all points of a map, and look for its edges; a core.Found.

    Parameters
    ----------
    key : of MAPS
    folder : Path in which points are kept
    quick : fewer points
    resume : take points that are done from the folder
    executor, jobs : as of `fabrics.executors.open_executor`
    report : called as report(number done, number of all)
    """
    chart = load(key, quick)
    if not resume:
        shutil.rmtree(folder, ignore_errors=True)

    with open_executor(executor, jobs) as pool:

        def many(points):
            return run_cache.results(
                solve, [(key, *point) for point in points], folder=folder, executor=pool, jobs=jobs,
                report=report if len(points) > 1 else None,
            )  # fmt: skip

        return explore(chart, many, 2 if quick else 5)
