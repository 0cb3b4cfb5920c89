"""python -m validation.verification.fidelity survey|packs|trial [--trial NAME] [--out FOLDER] [--page docs/fidelity.md]

survey   every model of the ladder on standard and drawn scenes; --keep puts errors.json into the package
packs    every model of the ladder of packs on drawn packs; --keep puts errors_packs.json into the package
trial    20 random scenes of a trial, each answered to its targets and held against the full model

With --page the tables go into that page, between its marks. Runs are kept in the folder and not made twice;
--jobs and --executor say where they are made.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
from argparse import Namespace
from dataclasses import fields
from datetime import date
from importlib import resources
from pathlib import Path

from fabrics import run_cache
from fabrics.errors import WeavecellError
from fabrics.files import write_whole
from validation.verification.fidelity import cable_net, fit_error_database, leave_one_out, page, survey, trial
from weavecell.analysis.fidelity import error_database
from weavecell.analysis.fidelity.ladder import FULL, LADDER, PACK_LADDER


def _runs(function, arguments, options):
    def report(done, total):
        print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)

    return run_cache.results(
        function, arguments, folder=options.out, executor=options.executor, jobs=options.jobs, report=report
    )


def survey_command(options: Namespace) -> None:
    """Run the survey, print what it found, and keep it."""
    tasks = survey.tasks()
    found = dict(zip(tasks, _runs(survey.sample, tasks, options)))
    rows = survey.rows(found)
    standard = [place for place in survey.places() if place[0]]
    full = [{FULL: found[*place, FULL]} for place in standard]
    cable = [known | row for known, row in zip(full, _runs(cable_net.row, standard, options))]
    content = fit_error_database.of(rows) | {"others": {cable_net.NAME: cable_net.errors(cable)}}
    _keep(rows, content, error_database.FILE, "survey", options)
    lines = leave_one_out.table(leave_one_out.rows(rows, LADDER))
    print("\n".join(lines))
    page.put(options.page, "left out", lines)


def packs_command(options: Namespace) -> None:
    """Run the survey of packs, print what it found, and keep it."""
    rows = _runs(survey.pack_row, [(number,) for number in range(survey.PACK_COUNT)], options)
    rows = [row for row in rows if row is not None]
    content = fit_error_database.of(rows, PACK_LADDER) | {"others": {}}
    _keep(rows, content, error_database.PACK_FILE, "survey of packs", options)
    lines = leave_one_out.table(leave_one_out.rows(rows, PACK_LADDER))
    print("\n".join(lines))
    page.put(options.page, "packs left out", lines)


def _keep(rows, content, name, title, options):
    """Write what a survey found as a file `name`, and its table."""
    content = {"made": {"date": date.today().isoformat(), "scenes": len(rows)}} | content
    text = json.dumps(content, indent=1) + "\n"
    with write_whole(options.out / name) as file:
        file.write(text)
    if options.keep:
        with write_whole(Path(str(resources.files("weavecell.analysis.fidelity"))) / name) as file:
            file.write(text)
    lines = page.survey_table(error_database.Book(**content))
    print("\n".join(lines))
    page.put(options.page, title, lines)


def trial_command(options: Namespace) -> None:
    """Run a trial and print what it found."""
    places = [(options.trial, number) for number in range(trial.COUNT)]
    full = _runs(trial.truth, places, options)
    answers = _runs(trial.answer, places, options)
    rows = [trial.row(*given) for given in zip(*zip(*places), full, answers)]
    with write_whole(options.out / f"trial-{options.trial}.csv") as file:
        table = csv.writer(file)
        table.writerow([entry.name for entry in fields(trial.Row)] + ["met"])
        for row in rows:
            table.writerow([getattr(row, entry.name) for entry in fields(trial.Row)] + [row.met])
    lines = page.trial_table(rows)
    print("\n".join(lines))
    page.put(options.page, f"trial {options.trial}", lines)


COMMANDS = {"survey": survey_command, "packs": packs_command, "trial": trial_command}


def main() -> int | None:
    parser = argparse.ArgumentParser(
        prog="python -m validation.verification.fidelity", description=__doc__.splitlines()[0]
    )
    parser.add_argument("command", choices=tuple(COMMANDS))
    parser.add_argument("--trial", choices=tuple(trial.TRIALS), default="everything")
    parser.add_argument("--out", type=Path, default=Path("results/fidelity"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--executor", default="local", help="local, mpi, parsl, dask or MODULE:FUNCTION")
    parser.add_argument("--keep", action="store_true", help="make the survey's errors those that models are chosen by")
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        COMMANDS[options.command](options)
    except WeavecellError as problem:
        print(f"error: {problem}", file=sys.stderr)
        return problem.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
