"""python -m validation.fidelity survey|trial [--out results/fidelity] [--jobs N] [--page docs/fidelity.md]

survey   every model of the ladder on standard scenes of six fabrics; --keep puts errors.json into the package
trial    20 random scenes, each answered as it asks and held against the full model

With --page the tables go into that page, between its marks. Runs are kept in the folder and not made twice.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
from dataclasses import fields
from datetime import date
from importlib import resources
from pathlib import Path

import numpy as np

from fabrics.errors import WeavecellError
from fabrics.files import write_whole
from validation.fidelity import book, page, scenes, survey, trial
from validation.scatter import pool

COUNT, SEED = 20, 20


def _runs(function, arguments, options):
    def report(done, total):
        print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)

    with pool.executor("processes", options.jobs) as workers:
        return pool.results(function, arguments, folder=options.out, workers=workers, report=report)


def survey_command(options):
    """Run the survey, print what it found, and keep it."""
    rows = [row for rows in _runs(survey.runs, [(name,) for name in scenes.KEVLAR], options) for row in rows]
    made = {"date": date.today().isoformat(), "scenes": len(rows), "fabrics": list(scenes.KEVLAR)}
    content = {"made": made, "models": survey.errors(rows)}
    text = json.dumps(content, indent=1) + "\n"
    with write_whole(options.out / book.FILE) as file:
        file.write(text)
    if options.keep:
        with write_whole(Path(str(resources.files("validation.fidelity"))) / book.FILE) as file:
            file.write(text)
    lines = page.survey_table(content["models"])
    print("\n".join(lines))
    page.put(options.page, "survey", lines)


def trial_command(options):
    """Run the trial and print what it found."""
    rows = _runs(trial.row, [(number, SEED) for number in range(COUNT)], options)
    with write_whole(options.out / "trial.csv") as file:
        table = csv.writer(file)
        names = list(rows[0].found)
        head = [entry.name for entry in fields(trial.Row) if entry.name not in ("promised", "found")] + ["met"]
        table.writerow(head + [f"{kind} {name}" for kind in ("estimated", "found") for name in names])
        for row in rows:
            errors = [part[name] for part in (row.promised, row.found) for name in names]
            table.writerow([getattr(row, key) for key in head] + errors)
    lines = page.trial_table(rows)
    print("\n".join(lines))
    met, share = sum(row.met for row in rows), np.median([row.seconds / row.full_seconds for row in rows])
    print(f"within what was asked: {met} of {len(rows)}; cost over that of the full model, median: {share:.3f}")
    page.put(options.page, "trial", lines)


def main():
    parser = argparse.ArgumentParser(prog="python -m validation.fidelity", description=__doc__.splitlines()[0])
    parser.add_argument("command", choices=("survey", "trial"))
    parser.add_argument("--out", type=Path, default=Path("results/fidelity"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="make the survey's errors those that models are chosen by")
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        (survey_command if options.command == "survey" else trial_command)(options)
    except WeavecellError as problem:
        print(f"error: {problem}", file=sys.stderr)
        return problem.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
