"""Run maps: each point is kept as soon as it is done, so that an interrupted study goes on where it was."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

from fabrics import run_cache
from fabrics.executors import open_executor
from validation.verification.stability.core import Axis, Found, Map, Outcome, explore, guarded
from validation.verification.study import known

MAPS: dict[str, dict[str, Any]] = tomllib.loads(
    resources.files("validation.verification.stability").joinpath("maps.toml").read_text("utf-8")
)
PAGE = MAPS.pop("page")
NAMES = tuple(MAPS)  # of the command line


def load(key: str, quick: bool = False) -> Map:
    """A map by its name, from maps.toml.

    Raises
    ------
    InputError : there is none of this name
    """
    known("--map", key, NAMES)
    entry = dict(MAPS[key])
    x, y = entry.pop("x"), entry.pop("y")
    run, scene, settings = _method(entry.pop("method")), entry.pop("scene", {}), entry.pop("settings")
    reference = entry.pop("reference", None)

    def scene_at(at_x, at_y):
        return {**scene, **_arguments(x, at_x), **_arguments(y, at_y)}

    def point(at_x, at_y):
        compared = {}
        if reference is not None:
            compared["reference"] = scene_at(reference.get("x", at_x), reference.get("y", at_y))
        return guarded(lambda: run(**settings, **compared, **scene_at(at_x, at_y)))

    axes = _axis(x, quick), _axis(y, quick)
    rows = axes[1].values if entry.pop("every_row", False) else ()
    lists: dict[str, Any] = {name: tuple(entry.pop(name)) for name in ("default", "sides") if name in entry}
    return Map(key, x=axes[0], y=axes[1], point=point, rows=rows, **lists, **entry)


def _method(name):
    """Function of a point, (**arguments) -> Outcome, imported when it is needed: some need further libraries."""
    match name:
        case "shot" | "time_step":
            from validation.verification.stability import shots as module
        case "pack":
            from validation.verification.stability import packs as module
        case "newton" | "bracket" | "printed_law":
            from validation.verification.stability import cell as module
        case "bias":
            from validation.verification.stability import coupons as module
        case "bars" | "load_step":
            from validation.verification.stability import unit_cell as module
    return getattr(module, name)


def _axis(entry, quick):
    values = entry["quick"] if quick and "quick" in entry else entry.get("values") or entry["choices"]
    return Axis(entry["name"], tuple(values), entry.get("unit", 1.0))


def _arguments(entry, value):
    """{argument: value} of a method at a place of an axis; a place of a reference may say its own."""
    if isinstance(value, dict):
        return value
    return entry["choices"][value] if "choices" in entry else {entry["key"]: value}


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
