"""The runs of the study, beside each other and one file each; what they say of limits, errors and time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue, run_cache
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.units import si
from validation.verification.cost_accuracy.core import non_dominated
from validation.verification.crossover_convergence.axes import BASE, CONTENT, METHOD, Axis, axes
from validation.verification.crossover_convergence.cases import Case, solve
from validation.verification.richardson import extrapolate

MARGIN = 0.1  # a method is worth more time if it takes a tenth off the error: times are no better known
MEASURED = ("warp only", "equibiaxial")  # paths whose forces at the end the errors are taken of
LAW = {"a": "m", "b": "m N^(1/3)"}


@dataclass(frozen=True)
class Entry:
    """One row of the study's table.

    Parameters
    ----------
    axis, label, x : which choice, and its number on an axis with a limit, or None
    case : cases.Case
    result : dict of `cases.solve`
    change : {quantity: [-] from the base over the base}
    error : [-] largest of the errors in the forces, against the reference; None of another model, or of a failed path
    """

    axis: str
    label: str
    x: float | None
    case: object
    result: dict
    change: dict
    error: float | None


@dataclass(frozen=True)
class Study:
    """What the study found.

    Parameters
    ----------
    fabric : name
    paths : {name: (d1, d2)} [m]
    base : `Entry` of the base
    axes : of `axes.Axis`
    entries : of `Entry`, axis by axis
    limits : {axis: {quantity: Extrapolation}} of the axes with a limit
    reference : {quantity: (value, half width)}, the base put right by each of the limits
    best : entries of the methods that none other beats in CPU time and error, cheapest first
    """

    fabric: str
    paths: dict
    base: Entry
    axes: list
    entries: list
    limits: dict
    reference: dict
    best: list

    def of(self, name: str) -> list[Entry]:
        """Entries of one axis."""
        return [entry for entry in self.entries if entry.axis == name]


def scene() -> tuple[Fabric, dict[str, Any]]:
    """(fabric, {path: (d1, d2)} [m]) of the study's data file."""
    paths = {name: tuple(si(end[d], "m", key=d) for d in ("d1", "d2")) for name, end in CONTENT["paths"].items()}
    return catalogue.load(CONTENT["fabric"]), paths


def run(
    out: Path, *, level: str = "full", only: Sequence[str] | None = None, resume: bool = False, executor: str = "local",
    jobs: int = 1, report: Callable[..., object] | None = None,
) -> Study:  # fmt: skip
    """Solve all cases of the study.

    Parameters
    ----------
    out : folder; a file for each case goes to its cases/
    level : "quick", "full" or "fine": how fine the finest mesh is
    only : names of axes, or None for all
    resume : take the cases that are done from their files, unless these are of other code
    executor, jobs : as of `fabrics.executors.open_executor`
    report : called as report(number done, number of all)

    Returns
    -------
    Study

    Raises
    ------
    InputError : an axis that there is none of
    """
    fabric, paths = scene()
    chosen = axes(level)
    for name in only or ():
        if name not in [axis.name for axis in chosen]:
            raise InputError(key="axis", value=name, allowed=f"one of {', '.join(axis.name for axis in chosen)}")
    chosen = [axis for axis in chosen if only is None or axis.name in only]
    # the dearest first
    cases = sorted({BASE} | {case for axis in chosen for case in axis.cases.values()}, key=lambda c: -np.prod(c.size))
    found = run_cache.results(
        solve, [(fabric, paths, case) for case in cases], folder=Path(out) / "cases", executor=executor, jobs=jobs,
        fresh=True, resume=resume, report=report,
    )  # fmt: skip
    results = dict(zip(cases, found))
    return judge(fabric.name, paths, chosen, results)


def judge(
    fabric: str, paths: dict[str, tuple[float, float]], chosen: list[Axis], results: dict[Case, dict[str, Any]]
) -> Study:
    """The Study of solved cases {case: result}."""
    base = results[BASE]
    limits = {axis.name: _limits(axis, results) for axis in chosen if axis.x is not None}
    reference = _reference(base, chosen, limits, results)

    def entry(axis, label, x, case, kind):
        result = results[case]
        error = _error(result, reference) if kind == METHOD else None
        return Entry(axis, label, x, case, result, _changes(result, base), error)

    entries = [
        entry(axis.name, label, None if axis.x is None else axis.x[label], case, axis.kind)
        for axis in chosen
        for label, case in axis.cases.items()
    ]
    methods = [entry for entry in entries if entry.error is not None]
    unique = list({entry.case: entry for entry in methods}.values())
    best = non_dominated([entry.result["cpu"] for entry in unique], [entry.error for entry in unique], MARGIN)
    first = entry("base", "base", None, BASE, METHOD)
    return Study(fabric, paths, first, chosen, entries, limits, reference, [unique[i] for i in best])


def name(study: Study, entry: Entry) -> str:
    """What a reader calls an entry."""
    return "the base" if entry.case == study.base.case else f"{entry.axis}: {entry.label}"


def quantities(result: dict[str, Any]) -> dict[str, float]:
    """{name: value} of a result: the forces at the paths' ends, and a, b of the law."""
    law = result["law"] or {}
    return result["values"] | {name: law[name] for name in LAW if name in law}


def measured(name: str) -> bool:
    """Whether a quantity is one that the errors are taken of."""
    return name.split(", ")[-1] in MEASURED


def _limits(axis, results):
    """{quantity: Extrapolation} to x = 0, from the cases of an axis whose paths all went through."""
    done = sorted(
        (
            (axis.x[label], quantities(results[case]))
            for label, case in axis.cases.items()
            if not results[case]["failed"]
        ),
        key=lambda pair: -pair[0],
    )
    if len(done) < 3:
        return {}
    x = [number for number, _ in done]
    found = {}
    for name in done[0][1]:
        values = [each[name] for _, each in done]
        found[name] = extrapolate(x, values, noise=NOISE * abs(values[-1]))
    return found


NOISE = 1e-6  # of a force: what load steps of other sizes leave (Newton's tolerance is 1e-8)


def _reference(base, chosen, limits, results):
    """{quantity: (value, half width)}: the finest mesh's limit, moved by what each other limit moves the base.

    The half width adds up what each extrapolation is unsure of: its scatter, and a quarter of its own step beyond the
    last value.
    """
    found = {}
    for name, value in quantities(base).items():
        total, unsure = value, 0.0
        for axis in chosen:
            limit = limits.get(axis.name, {}).get(name)
            if limit is None or not axis.counted:
                continue
            last = min(axis.x, key=lambda label: axis.x[label] if not results[axis.cases[label]]["failed"] else np.inf)
            finest = quantities(results[axis.cases[last]])[name]
            total += limit.limit - value
            unsure += limit.scatter + 0.25 * abs(limit.limit - finest)
        found[name] = (total, unsure)
    return found


def _changes(result, base):
    before, after = quantities(base), quantities(result)
    return {name: after[name] / before[name] - 1 for name in after}


def _error(result, reference):
    if result["failed"]:
        return None
    values = result["values"]
    return max(abs(values[name] / reference[name][0] - 1) for name in values if measured(name))
