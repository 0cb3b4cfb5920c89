"""Run scenes: each case is kept as soon as it is done, so that an interrupted study goes on where it was."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import run_cache
from validation.verification.cost_accuracy.core import Chart, Sample, judge, timed
from validation.verification.study import known

if TYPE_CHECKING:
    from validation.verification.cost_accuracy.core import Scene

NAMES = (
    "struck-yarn",
    "ply-stopped",
    "ply-perforated",
    "four-ply-pack",
    "bias-extension",
    "biaxial-coupon",
    "crossover-path",
)  # of the command line


def load(key: str, quick: bool = False) -> Scene:
    """A standard scene by its name.

    Raises
    ------
    InputError : there is none of this name
    """
    known("--scene", key, NAMES)
    return _module(key).scene(quick)


def _module(key):
    """The file of a scene, imported when it is needed: the libraries of some may not be installed."""
    match key:
        case "struck-yarn":
            from validation.verification.cost_accuracy import struck_yarn as module
        case "ply-stopped":
            from validation.verification.cost_accuracy import ply_stopped as module
        case "ply-perforated":
            from validation.verification.cost_accuracy import ply_perforated as module
        case "four-ply-pack":
            from validation.verification.cost_accuracy import four_ply_pack as module
        case "bias-extension":
            from validation.verification.cost_accuracy import bias_extension as module
        case "biaxial-coupon":
            from validation.verification.cost_accuracy import biaxial_coupon as module
        case "crossover-path":
            from validation.verification.cost_accuracy import crossover_path as module
    return module


def solve(key: str, case: Any) -> Sample:
    """Sample of one case of a scene."""
    found = load(key)
    return timed(found.run, found.warm, case)


def run(
    key: str, folder: Path, *, quick: bool = False, resume: bool = False, report: Callable[..., object] | None = None
) -> Chart:
    """Solve all cases of a scene, one after the other, and judge them; a Chart.

    Parameters
    ----------
    key : of NAMES
    folder : Path in which cases are kept
    quick : coarser references
    resume : take cases that are done from the folder
    report : called as report(number done, number of all)
    """
    found = load(key, quick)
    arguments = [(key, case) for case in found.cases]
    samples = run_cache.results(solve, arguments, folder=folder, resume=resume, report=report)
    return judge(found, dict(zip(found.cases, samples)))
