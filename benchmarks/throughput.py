"""Shots a second of a V50 study and of a sweep of strike velocities, and where their time goes.

Run with nothing else on the machine:

    python benchmarks/throughput.py [--shots 20] [--jobs 2] [--out FILE.json]

The V50 study is that of S-720 with published scatter: each shot has a whole panel and a cell of its own, in processes
as `weavecell v50` starts them. The sweep has one panel of a quarter, and threads. Both on uniform and on graded panels.
Wall time of all shots beside each other, and CPU time of the parts of one; before, some shots that are not counted.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np

from fabrics import catalogue, variants
from fabrics.base.executors import open_executor
from shellfabric.impact.setup import ImpactSetup
from weavecell.runs import table
from weavecell.studies import ballistic_limit, inputs, strengths

FABRIC, OPENING, VELOCITIES = (
    "S-720",
    0.203,
    (120.0, 160.0),
)  # [m], [m/s] about V50, half of which perforate
MESHES = {
    "uniform": None,
    "1 to 10, 2 to 20, then 4": ((10, 1), (20, 2), (inf, 4)),
    "1 to 10, 2 to 16, 4 to 32, then 8": ((10, 1), (16, 2), (32, 4), (inf, 8)),
}


def parts(fabric, scatter, shots, grading):
    """Medians of the CPU time [s] of a V50 shot: table of its cell, panel, time integration."""
    rows = []
    for number, velocity in enumerate(np.linspace(*VELOCITIES, shots)):
        marks = [time.process_time()]
        setup = ImpactSetup(fabric, 1.0)
        setup.table()
        marks.append(time.process_time())
        panel = strengths.draw_panel(
            replace(setup, opening=OPENING, grading=grading), scatter, 1, number
        ).pack
        marks.append(time.process_time())
        ballistic_limit.shoot(panel, (float(velocity),))
        marks.append(time.process_time())
        rows.append(np.diff(marks))
    names = ("table", "panel with its table", "shot")
    return {
        name: round(float(statistics.median(column)), 4) for name, column in zip(names, zip(*rows))
    }


def study(setup, scatter, shots, pool, jobs):
    """Wall time [s] of V50 shots beside each other, in processes that have fired some before."""
    for count in (4 * jobs, shots):
        start, velocities = time.perf_counter(), np.linspace(*VELOCITIES, count)
        rows = [(setup, float(V), table.Draw(scatter, 2, k)) for k, V in enumerate(velocities)]
        list(pool.map(table.fire, *zip(*rows)))
    return time.perf_counter() - start


def sweep(fabric, shots, grading, jobs):
    """Wall time [s] of a sweep of strike velocities at one panel."""
    panel = ImpactSetup(fabric, 1.0, grading=grading).panel()
    ballistic_limit.shoot(panel, [VELOCITIES[0]])
    start = time.perf_counter()
    ballistic_limit.shoot(panel, [float(v) for v in np.linspace(*VELOCITIES, shots)], jobs=jobs)
    return time.perf_counter() - start


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--shots", type=int, default=20)
    arguments.add_argument("--jobs", type=int, default=2)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    fabric, scatter = variants.with_linear_density(catalogue.load(FABRIC)), inputs.read_scatter()
    report = {"load_average": os.getloadavg()[0]}
    with open_executor("local", chosen.jobs) as pool:
        for name, grading in MESHES.items():
            setup = ImpactSetup(fabric, 1.0, opening=OPENING, grading=grading)
            table.fire(setup, VELOCITIES[0], table.Draw(scatter, 1, 0))
            report[name] = {"cpu_s": parts(fabric, scatter, min(chosen.shots, 6), grading)}
            for kind, wall in (
                ("v50", study(setup, scatter, chosen.shots, pool, chosen.jobs)),
                ("sweep", sweep(fabric, chosen.shots, grading, chosen.jobs)),
            ):
                report[name][f"{kind}_wall_s_of_1000"] = round(1000 * wall / chosen.shots, 1)
    text = json.dumps(report, indent=1)
    print(text)
    if chosen.out:
        chosen.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
