"""Run random scenes: python -m tests.fuzz --seed SEED --count N --jobs JOBS --out FOLDER

Writes outcomes.csv (a row a scene) and, under failed/, the files of every scene that went wrong. Exit code 1 if there
was a traceback or time-out, a normal termination with an energy error above the limit, or more guards than allowed.
Scenes that the folder has of the same code are not run again. With --show INDEX it writes that scene's files alone.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

from fabrics.base import run_cache
from fabrics.base.files import write_whole
from tests.fuzz import runs, scenes

BATCH = 100  # scenes that processes run before fresh ones start, so that memory cannot pile up


def main():
    options = _options()
    if options.show is not None:
        print(scenes.scene(options.seed, options.show).write(options.out))
        return 0
    chosen = [scenes.scene(options.seed, i) for i in options.only or range(options.count)]
    rows = []
    for first in range(0, len(chosen), BATCH):
        tasks = [(scene,) for scene in chosen[first : first + BATCH]]
        rows += run_cache.results(
            runs.outcome, tasks, folder=options.out / "runs", jobs=options.jobs, fresh=True
        )
        print(runs.summary(rows), flush=True)
    for scene, row in zip(chosen, rows):
        if runs.is_wrong(row) or row["outcome"] == "guard":
            scene.write(options.out / "failed")
    with write_whole(options.out / "outcomes.csv") as file:
        table = csv.DictWriter(file, sorted({name for row in rows for name in row}))
        table.writeheader()
        table.writerows(rows)
    found = runs.failures(rows, options.guards)
    print("\n".join(found) or "passed")
    return 1 if found else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    seeds = (
        "packs1 ...: packs of 2 to 8 plies; angled1 ...: at any angles; backed1 ...: before a block"
    )
    parser.add_argument("--seed", default="1", help=seeds)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--only", type=int, nargs="+", help="indices to run, in place of --count")
    parser.add_argument(
        "--show", type=int, metavar="INDEX", help="write this scene's files and run nothing"
    )
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument(
        "--guards", type=int, default=5, help="number of runs that may be stopped by a guard"
    )
    parser.add_argument("--out", type=Path, default=Path("results/fuzz"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
