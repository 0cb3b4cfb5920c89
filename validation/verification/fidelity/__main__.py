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
from dataclasses import dataclass, fields
from datetime import date
from importlib import resources
from pathlib import Path
from typing import Literal

from fabrics import run_cache
from fabrics.files import write_whole
from validation.program import program, write_csv
from validation.verification.fidelity import cable_net, fit_error_database, leave_one_out, page, survey, trial
from validation.verification.fidelity.trial import TRIALS
from validation.verification.study import known
from weavecell.analysis.fidelity import error_database
from weavecell.analysis.fidelity.ladder import FULL, LADDER


@dataclass(frozen=True)
class Study:
    """What is run, kept in the folder `out` and put into a page.

    Parameters
    ----------
    drawn : name of a trial
    keep : make the survey's errors those that models are chosen by
    jobs, executor : as of `fabrics.executors.open_executor`
    """

    drawn: str
    out: Path
    jobs: int
    executor: str
    keep: bool
    page: Path | None

    def _runs(self, function, arguments):
        def report(done, total):
            print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)

        return run_cache.results(
            function, arguments, folder=self.out, executor=self.executor, jobs=self.jobs, report=report
        )

    def survey(self) -> None:
        """Run the survey, print what it found, and keep it."""
        tasks = survey.tasks()
        found = dict(zip(tasks, self._runs(survey.sample, tasks)))
        rows = survey.rows(found)
        standard = [place for place in survey.places() if place[0]]
        full = [{FULL: found[*place, FULL]} for place in standard]
        cable = [known | row for known, row in zip(full, self._runs(cable_net.row, standard))]
        content = fit_error_database.of(rows) | {"others": {cable_net.NAME: cable_net.errors(cable)}}
        self._keep(rows, content, error_database.FILE, "survey")
        lines = leave_one_out.table(leave_one_out.rows(rows, LADDER))
        print("\n".join(lines))
        page.put(self.page, "left out", lines)

    def _keep(self, rows, content, name, title):
        """Write what a survey found as a file `name`, and its table."""
        content = {"made": {"date": date.today().isoformat(), "scenes": len(rows)}} | content
        text = json.dumps(content, indent=1) + "\n"
        with write_whole(self.out / name) as file:
            file.write(text)
        if self.keep:
            with write_whole(Path(str(resources.files("weavecell.analysis.fidelity"))) / name) as file:
                file.write(text)
        lines = page.survey_table(error_database.Book(**content))
        print("\n".join(lines))
        page.put(self.page, title, lines)

    def trial(self) -> None:
        """Run a trial and print what it found."""
        places = [(self.drawn, number) for number in range(trial.count(self.drawn))]
        full = self._runs(trial.truth, places)
        answers = self._runs(trial.answer, places)
        rows = [trial.row(*given) for given in zip(*zip(*places), full, answers)]
        names = [entry.name for entry in fields(trial.Row)]
        table = [[*names, "met"], *([*(getattr(row, name) for name in names), row.met] for row in rows)]
        write_csv(self.out / f"trial-{self.drawn}.csv", table)
        lines = page.trial_table(rows)
        print("\n".join(lines))
        page.put(self.page, f"trial {self.drawn}", lines)


def main(
    command: Literal["survey", "trial"], *, trial: str = "everything", out: Path = Path("results/fidelity"),
    jobs: int = 1, executor: str = "local", keep: bool = False, page: Path | None = None,
) -> None:  # fmt: skip
    known("--trial", trial, tuple(TRIALS))
    out.mkdir(parents=True, exist_ok=True)
    getattr(Study(trial, out, jobs, executor, keep, page), command)()


if __name__ == "__main__":
    program(main, trial=f"one of {', '.join(TRIALS)}", keep="make the survey's errors those that models are chosen by")
