"""The runner of studies: computes the cases of a study (`validation.study`) and writes its CSV.

    python -m validation study NAME ... [--quick]

`all` stands for all studies. The first line of the CSV says what made it (`validation.origin`); a file in
docs/reports/data takes committed code. What is computed is kept in results/studies/NAME, and taken from there by the
same code.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from fabrics.base import run_cache
from fabrics.base.errors import InputError, WeavecellError
from validation import cases, csv_file, golden, judges, origin, study
from validation.csv_file import DATA, Record
from validation.filling import merged
from validation.study import NAMES, Row, Study, of, record
from validation.values import Values

KEPT = Path("results/studies")
LONG_ENOUGH = 0.6  # [s] of CPU, after which a run that is timed is not repeated
MOST_RUNS = 5
NOTES = {
    "names": "of studies, or all",
    "quick": "few and short cases; the CSV goes to results/studies",
    "out": "folder of the CSV; docs/reports/data by default",
}


def solve(run: str, keywords: Values, warm: Values | None = None) -> Values:
    """Run a function of validation/cases: what it returns, or its error as "problem".

    With keywords of a `warm` run, which compiles what the case needs, it has "cpu_s" [s] as well: CPU time, the median
    of up to MOST_RUNS; that which the function tells, where it does.
    """
    function = cases.function(run)
    try:
        if warm is None:
            return function(**keywords)
        warm_up(function, warm)
        times: list[float] = []
        while len(times) < MOST_RUNS and sum(times) < LONG_ENOUGH:
            began = time.process_time()
            result = function(**keywords)
            times.append(result.get("cpu_s", time.process_time() - began))
        return result | {"cpu_s": statistics.median(times)}
    except RefusedWarmRun:
        raise
    except WeavecellError as problem:
        return {"problem": str(problem)}


class RefusedWarmRun(InputError):
    """A warm run that the study's file describes wrongly: no problem of the case, which would lose its cost."""


def warm_up(function: Callable[..., Values], warm: Values) -> None:
    """Run what compiles the kernels of a case.

    Raises
    ------
    RefusedWarmRun : its input is refused
    """
    try:
        function(**warm)
    except InputError as problem:
        raise RefusedWarmRun(f"is refused: {problem}", key="cost.warm") from problem


def timed(run: str, keywords: Values, warm: Values | None = None) -> Values:
    """Run `solve`: what it returns as "values", and the CPU time that all of it took, "spent" [s]."""
    began = time.process_time()
    values = solve(run, keywords, warm)
    return {"values": values, "spent": time.process_time() - began}


def solved(
    study: Study, rows: Sequence[Row], *, spent: dict[str, float] | None = None, **options: Any
) -> list[tuple[Row, Values, Values]]:
    """Solve cases of a study: (case, what it comes to, what its reference comes to or an empty
    dict).

    Parameters
    ----------
    study, rows : Study, and some of its cases
    spent : gets the CPU time [s] of each run, those of kept results as well
    options : executor and jobs of `run_cache.results`
    """
    content = study.content
    warm = content.get("cost", {}).get("warm")
    tasks = {}
    for row in rows:
        for table in (row.keywords, row.reference):
            if table is not None:
                tasks[repr(table)] = (
                    content["run"],
                    table,
                    None if warm is None else merged(table, warm),
                )

    def tell(done, total):
        if total > 2:
            print(f"{study.name}: {done} of {total}", file=sys.stderr, flush=True)

    folder = KEPT / study.name
    found = run_cache.results(timed, list(tasks.values()), folder=folder, report=tell, **options)
    known = {}
    for task, one in zip(tasks, found):
        known[task] = one["values"]
        if spent is not None:
            spent[task] = one["spent"]
    return [(row, known[repr(row.keywords)], known.get(repr(row.reference), {})) for row in rows]


def run(study: Study, *, quick: bool = False, **options: Any) -> list[Record]:
    """Compute the rows of a study's CSV; `options` of `solved`."""
    content = study.content
    rows = study.rows(quick)

    def solver(rows):
        return solved(study, rows, **options)

    if "map" in content:
        records = judges.mapped(study, rows, solver)
    elif "cost" in content:
        records = judges.charted(study, rows, solver)
    else:
        records = [record(*case) for case in solver(rows)]
    if quick:
        return records
    known = NAMES | {"of": of(records)}
    fits = []
    for name, columns in content.get("fits", {}).items():
        fit = {next(iter(records[0])): name}
        for column, expression in columns.items():
            fit[column] = eval(expression, known)
        fits.append(fit)
    return records + fits


def main(
    names: Sequence[str],
    *,
    quick: bool = False,
    jobs: int = 1,
    executor: str = "local",
    out: Path | None = None,
) -> int:
    """Run studies and write their CSVs; returns 1 where one does not come out as its file expects, else 0.

    Raises
    ------
    InputError : no such study, or code that no commit has, for docs/reports/data
    """
    if list(names) == ["all"]:
        names = study.all_names()
    folder = DATA
    words = ""
    if quick:
        folder = KEPT
        words = " --quick"
    origin.refuse_changes(out or folder)
    failed = 0
    for name in names:
        chosen = study.load(name)
        spent: dict[str, float] = {}
        records = run(chosen, quick=quick, spent=spent, jobs=jobs, executor=executor)
        path = (out or folder) / f"{name}.csv"
        headings = chosen.content.get("columns")
        places: list[int] = []
        if not quick:
            places = golden.places(chosen, csv_file.texts(records, headings))
        seconds = f"{sum(spent.values()):.3g}"
        made = origin.write(f"study {name}{words}", origin.inputs_of(chosen), seconds, places)
        csv_file.write(path, records, made, headings)
        print(f"{name}: {len(records)} rows in {path}")
        if quick:
            continue
        for expression in study.unmet(chosen, records):
            print(f"{name}: not as expected: {expression}")
            failed = 1
    return failed
