"""Run random scenes: python -m tests.fuzz --seed SEED --count N --jobs JOBS --out FOLDER

Writes outcomes.csv (a row a scene), summary.txt and, under failed/, the files of every scene that did not end well.
Exit code 1 if there was a traceback, crash or timeout, a normal termination with an energy error above the limit, or
more guards than allowed. With --show INDEX it runs nothing and writes that scene's two files.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from fabrics.files import write_whole
from tests.fuzz import pool, runs, scenes, table


def main():
    options = _options()
    if options.show is not None:
        print(scenes.scene(options.seed, options.show).write(options.out))
        return 0
    wanted = options.only or range(options.first, options.first + options.count)
    rows = []
    runs.compile_kernels()
    for (seed, index), row in pool.outcomes(runs.outcome, [(options.seed, i) for i in wanted], jobs=options.jobs):
        rows.append({"seed": seed, "index": index} | row)
        if row["outcome"] not in ("ok", "rejected") or table.beyond_limit(rows[-1:]):
            print(table.describe(rows[-1]), flush=True)
            scenes.scene(seed, index).write(options.out / "failed")
        if len(rows) % 50 == 0:
            print(f"{len(rows)} of {len(wanted)} scenes", flush=True)
            table.write(rows, options.out / "outcomes.csv")
    table.write(rows, options.out / "outcomes.csv")
    text = table.summary(rows)
    with write_whole(options.out / "summary.txt") as file:
        file.write(text + "\n")
    print(text)
    found = table.failures(rows, options.guards)
    print("\n".join(f"FAILED: {one}" for one in found) or "passed")
    return 1 if found else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--seed",
        default="1",
        help="packs1 ...: packs of 2 to 8 plies; angled1 ...: at any angles; backed1 ...: before a block",
    )
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="index of the first scene")
    parser.add_argument("--only", type=int, nargs="+", help="indices to run, in place of --count")
    parser.add_argument("--show", type=int, metavar="INDEX", help="write this scene's files and run nothing")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--guards", type=int, default=5, help="number of runs that may be stopped by a guard")
    parser.add_argument("--out", type=Path, default=Path("results/fuzz"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
