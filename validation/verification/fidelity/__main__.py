"""python -m validation.verification.fidelity survey|trial [--trial NAME] [--out FOLDER] [--page PAGE]

survey   every model of the ladder on standard and drawn scenes; --keep puts errors.json into the package
trial    20 random scenes of a trial, of packs 40, each answered to its targets and held against the full
         model, packs against a third mesh

With --page the tables go into that page, between its marks. Runs are kept in the folder and not made twice;
--jobs and --executor say where they are made.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import fields
from datetime import date
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any, Literal

from fabrics import run_cache
from fabrics.files import write_whole
from validation.program import program, publish, write_csv
from validation.verification.fidelity import fit_error_database, leave_one_out, page, survey, trial
from validation.verification.study import known
from weavecell.analysis.fidelity import error_database
from weavecell.analysis.fidelity.ladder import FULL, LADDER

Tables = dict[str, list[str]]


def report(done: int, total: int) -> None:
    """Say how many runs are done."""
    print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)


def surveyed(runs: Callable[..., Any], out: Path, keep: bool) -> Tables:
    """Run the survey, and write what it found as errors.json, into the package too if it is to be kept; its tables."""
    tasks = survey.tasks()
    found = dict(zip(tasks, runs(survey.sample, tasks)))
    rows = survey.rows(found)
    standard = [place for place in survey.places() if place[0]]
    full = [{FULL: found[*place, FULL]} for place in standard]
    cable = [known | row for known, row in zip(full, runs(survey.of_cable_net, standard))]
    content = {
        "made": {"date": date.today().isoformat(), "scenes": len(rows)}, **fit_error_database.of(rows),
        "others": {survey.CABLE: survey.cable_errors(cable)},
    }  # fmt: skip
    for folder in [out] + [Path(str(resources.files("weavecell.analysis.fidelity")))] * keep:
        with write_whole(folder / error_database.FILE) as file:
            file.write(json.dumps(content, indent=1) + "\n")
    answered = leave_one_out.table(leave_one_out.rows(rows, LADDER))
    return {"survey": page.survey_table(error_database.Book(**content)), "left out": answered}


def tried(runs: Callable[..., Any], out: Path, name: str) -> Tables:
    """Run a trial, write its rows, and its table."""
    places = [(name, number) for number in range(trial.count(name))]
    rows = [trial.row(*given) for given in zip(*zip(*places), runs(trial.truth, places), runs(trial.answer, places))]
    names = [entry.name for entry in fields(trial.Row)]
    table = [[*names, "met"], *([*(getattr(row, name) for name in names), row.met] for row in rows)]
    write_csv(out / f"trial-{name}.csv", table)
    return {f"trial {name}": page.trial_table(rows)}


def main(
    command: Literal["survey", "trial"], *, trial: str = "refined", out: Path = Path("results/fidelity"),
    jobs: int = 1, executor: str = "local", keep: bool = False, page: Path | None = None,
) -> None:  # fmt: skip
    known("--trial", trial, TRIALS)
    runs = partial(run_cache.results, folder=out, executor=executor, jobs=jobs, report=report)
    tables = surveyed(runs, out, keep) if command == "survey" else tried(runs, out, trial)
    for name, lines in tables.items():
        marks = f"<!-- {name} of weavecell.analysis.fidelity -->", "<!-- end of the table -->"
        publish("\n".join(lines), page, marks)


TRIALS = tuple(trial.TRIALS)

if __name__ == "__main__":
    program(main, trial=f"one of {', '.join(TRIALS)}", keep="make the survey's errors those that models are chosen by")
