"""The runner of studies: computes the cases of a study (`validation.study`) and writes its CSV.

    python -m validation study NAME ... [--quick]

`all` stands for all studies. The CSV has command, commit and date in its first line. What is computed is kept in
results/studies/NAME, and taken from there by the same code.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fabrics import run_cache
from fabrics.errors import WeavecellError
from validation import cases, judges, study
from validation.study import DATA, NAMES, Record, Row, Study, merged, of, record
from validation.values import Values
from weavecell.results import provenance

KEPT = Path("results/studies")
LONG_ENOUGH = 0.6  # [s] of CPU, after which a run that is timed is not repeated
MOST_RUNS = 5
NOTES = {
    "names": "of studies, or all",
    "quick": "few and short cases; the CSV goes to results/studies",
    "out": "folder of the CSV; docs/reports/data by default",
}


def solve(run: str, keywords: Values, warm: Values | None = None) -> Values:
    """What a function of validation/cases returns, or its error as "problem".

    With keywords of a `warm` run, which compiles what the case needs, it has "cpu_s" [s] as well: CPU time, the median
    of up to MOST_RUNS; that which the function tells, where it does.
    """
    function = cases.function(run)
    try:
        if warm is None:
            return function(**keywords)
        function(**warm)
        times: list[float] = []
        while len(times) < MOST_RUNS and sum(times) < LONG_ENOUGH:
            began = time.process_time()
            result = function(**keywords)
            times.append(result.get("cpu_s", time.process_time() - began))
        return result | {"cpu_s": statistics.median(times)}
    except WeavecellError as problem:
        return {"problem": str(problem)}


class Solver:
    """What the cases of a study come to, each with its reference: calling it with rows gives pairs of results.

    Parameters
    ----------
    study : Study
    options : executor and jobs of `run_cache.results`
    """

    def __init__(self, study: Study, **options: Any) -> None:
        self.study = study
        self.options = options

    def __call__(self, rows: Sequence[Row]) -> list[tuple[Values, Values]]:
        content = self.study.content
        warm = content.get("cost", {}).get("warm")
        tables = {
            repr(table): table
            for row in rows
            for table in (row.keywords, row.reference)
            if table is not None
        }
        arguments = [
            (content["run"], table, *([] if warm is None else [merged(table, warm)]))
            for table in tables.values()
        ]
        found = run_cache.results(
            solve, arguments, folder=KEPT / self.study.name, report=self._tell, **self.options
        )
        by_table = dict(zip(tables, found))
        return [
            (by_table[repr(row.keywords)], by_table.get(repr(row.reference), {})) for row in rows
        ]

    def _tell(self, done, total):
        if total > 2:
            print(f"{self.study.name}: {done} of {total}", file=sys.stderr, flush=True)


def run(study: Study, *, quick: bool = False, **options: Any) -> list[Record]:
    """The rows of a study's CSV; `options` of `Solver`."""
    content = study.content
    rows = study.rows(quick)
    solver = Solver(study, **options)
    if "map" in content:
        records = judges.mapped(study, rows, solver)
    elif "cost" in content:
        records = judges.charted(study, rows, solver)
    else:
        records = [record(row, *pair) for row, pair in zip(rows, solver(rows))]
    fits = {}
    if not quick:
        fits = content.get("fits", {})
    first = next(iter(records[0]))
    lookup = of(records)
    return records + [
        {first: name}
        | {
            column: eval(expression, NAMES | {"of": lookup})
            for column, expression in columns.items()
        }
        for name, columns in fits.items()
    ]


def main(
    names: Sequence[str],
    *,
    quick: bool = False,
    jobs: int = 1,
    executor: str = "local",
    out: Path | None = None,
) -> int:
    """Run studies and write their CSVs; returns 1 where one does not come out as its file expects, else 0."""
    failed = 0
    for name in study.all_names() if list(names) == ["all"] else names:
        chosen = study.load(name)
        stamp = provenance.stamp()
        records = run(chosen, quick=quick, jobs=jobs, executor=executor)
        path = (out or (KEPT if quick else DATA)) / f"{name}.csv"
        words = ""
        if quick:
            words = " --quick"
        command = f"python -m validation study {name}{words}"
        made = f"{command}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}"
        study.write(path, records, made, chosen.content.get("columns"))
        print(f"{name}: {len(records)} rows in {path}")
        for expression in [] if quick else study.unmet(chosen, records):
            print(f"{name}: not as expected: {expression}")
            failed = 1
    return failed
