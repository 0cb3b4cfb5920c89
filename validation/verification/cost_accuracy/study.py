"""Run scenes: each case is kept as soon as it is done, so that an interrupted study goes on where it was."""

from __future__ import annotations

import shutil
from importlib import import_module

from fabrics import run_cache
from fabrics.errors import InputError
from validation.verification.cost_accuracy.core import judge, timed

SCENES = {
    "struck-yarn": "struck_yarn",
    "ply-stopped": "ply_stopped",
    "ply-perforated": "ply_perforated",
    "four-ply-pack": "four_ply_pack",
    "bias-extension": "bias_extension",
    "biaxial-coupon": "biaxial_coupon",
    "crossover-path": "crossover_path",
}  # of the command line: file here


def scene(key, quick=False):
    """A standard scene by its name.

    Raises
    ------
    InputError : there is none of this name
    """
    if key not in SCENES:
        raise InputError(key="--scene", value=key, allowed=f"one of {', '.join(SCENES)}")
    return import_module(f"validation.verification.cost_accuracy.{SCENES[key]}").scene(quick)


def solve(key, case):
    """Sample of one case of a scene."""
    found = scene(key)
    return timed(found.run, found.warm, case)


def run(key, folder, *, quick=False, resume=False, report=None):
    """Solve all cases of a scene, one after the other, and judge them; a Chart.

    Parameters
    ----------
    key : of SCENES
    folder : Path in which cases are kept
    quick : coarser references
    resume : take cases that are done from the folder
    report : called as report(number done, number of all)
    """
    found = scene(key, quick)
    if not resume:
        shutil.rmtree(folder, ignore_errors=True)
    arguments = [(key, case) for case in found.cases]
    samples = run_cache.results(solve, arguments, folder=folder, report=report)
    return judge(found, dict(zip(found.cases, samples)))
