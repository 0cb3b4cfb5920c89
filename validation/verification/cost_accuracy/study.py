"""Run scenes: each case is kept as soon as it is done, so that an interrupted study goes on where it was."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

from fabrics import run_cache
from validation.verification.cost_accuracy.core import Chart, Method, Quantity, Sample, Scene, judge, timed
from validation.verification.study import known

_CONTENT: dict[str, Any] = tomllib.loads(
    resources.files("validation.verification.cost_accuracy").joinpath("scenes.toml").read_text("utf-8")
)
METHODS: dict[str, list[Any]] = _CONTENT.pop("methods")
PAGE: dict[str, str] = _CONTENT.pop("page")
NAMES = (*_CONTENT, "crossover-path")  # of the command line


def load(key: str, quick: bool = False) -> Scene:
    """A standard scene by its name, from scenes.toml; `quick` takes coarser references.

    Raises
    ------
    InputError : there is none of this name
    """
    known("--scene", key, NAMES)
    if key == "crossover-path":
        from validation.verification.cost_accuracy import crossover_path

        return crossover_path.scene(quick)
    entry = _CONTENT[key]
    module, words = _module(entry["module"]), _words(entry["case"])
    base = module.read(entry["case"])
    methods = [
        Method(choice, name, base.changed(**changes))
        for kind in entry["methods"] for choice, name, changes, *fine in METHODS[kind] if not (quick and fine)
    ]  # fmt: skip
    reference = base.changed(**entry.get("reference", {}))
    meshes = [(1 / n, reference.changed(elements=n)) for n in entry.get("quick" if quick else "meshes", ())]
    finer = [(meshes[0][1], meshes[0][1].changed(**changes)) for changes in entry.get("finer", ())]
    return Scene(
        key, entry["title"].format(**words), entry["text"].format(**words),
        tuple(Quantity(*each) for each in entry["quantities"]), tuple(methods), module.run, module.warm, tuple(meshes),
        tuple(finer), module.exact(base) if entry["module"] == "struck_yarn" else None,
    )  # fmt: skip


def case_of(key: str) -> dict[str, Any]:
    """What scenes.toml says of the case of a scene."""
    return _CONTENT[key]["case"]


def _words(entry):
    """The numbers of a case as its text has them, without units, and its velocities."""
    words = {name: value.split()[0] if isinstance(value, str) else value for name, value in entry.items()}
    *first, last = [text.split()[0] for text in entry.get("velocities", [entry.get("velocity", "-")])]
    return words | {"speed": [*first, last][0], "speeds": f"{', '.join(first)} and {last} m/s"}


def _module(name):
    """The file of a kind of case, imported when it is needed: a scene needs no other's."""
    match name:
        case "struck_yarn":
            from validation.verification.cost_accuracy import struck_yarn as module
        case "shots":
            from validation.verification.cost_accuracy import shots as module
        case "coupons":
            from validation.verification.cost_accuracy import coupons as module
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
