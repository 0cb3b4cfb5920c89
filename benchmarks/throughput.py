"""Shots a second of a V50 study and of a sweep of strike velocities, and where their time goes.

Run with nothing else on the machine:

    python benchmarks/throughput.py [--shots 20] [--jobs 2] [--out FILE.json]

The V50 study is that of S-720 with published scatter: each shot has a whole panel and a cell of its own. The sweep has
one panel of a quarter. Wall time of all shots beside each other, and CPU time of the parts of one; before, one shot of
each that is not counted.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from fabrics import catalogue, variants
from shellfabric.impact import ballistic_limit
from shellfabric.impact.single_ply import ImpactSetup
from weavecell.analysis.uncertainty import inputs, v50

FABRIC, OPENING, VELOCITIES = "S-720", 0.203, (95.0, 135.0)


def parts(fabric, scatter, shots):
    """Medians of the CPU time [s] of a V50 shot: table of its cell by either method, panel, time integration."""
    rows = []
    for number, velocity in enumerate(np.linspace(*VELOCITIES, shots)):
        marks = [time.process_time()]
        setup = ImpactSetup(fabric, 1.0)
        for method in ("nested", "newton"):
            setup.table(method=method)
            marks.append(time.process_time())
        panel, _, _ = v50.drawn_panel(fabric, scatter, 1, number, OPENING)
        marks.append(time.process_time())
        ballistic_limit.shoot(panel, (float(velocity),))
        marks.append(time.process_time())
        rows.append(np.diff(marks))
    names = ("table, nested", "table, newton", "panel with its table", "shot")
    return {name: round(float(statistics.median(column)), 4) for name, column in zip(names, zip(*rows))}


def study(fabric, scatter, shots, jobs):
    """Wall time [s] of V50 shots beside each other."""
    start = time.perf_counter()
    with ThreadPoolExecutor(jobs) as pool:
        velocities = np.linspace(*VELOCITIES, shots)
        list(pool.map(lambda k: v50.fire(fabric, scatter, 2, k, float(velocities[k]), OPENING), range(shots)))
    return time.perf_counter() - start


def sweep(fabric, shots, jobs):
    """Wall time [s] of a sweep of strike velocities at one panel."""
    start = time.perf_counter()
    ballistic_limit.shoot(
        ImpactSetup(fabric, 1.0).panel(), [float(v) for v in np.linspace(*VELOCITIES, shots)], jobs=jobs
    )
    return time.perf_counter() - start


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--shots", type=int, default=20)
    arguments.add_argument("--jobs", type=int, default=2)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    fabric, scatter = variants.with_linear_density(catalogue.load(FABRIC)), inputs.published()
    v50.fire(fabric, scatter, 1, 0, 110.0, OPENING)
    sweep(fabric, 1, 1)
    report = {"load_average": os.getloadavg()[0], "cpu_s": parts(fabric, scatter, min(chosen.shots, 5))}
    for name, wall in (
        ("v50", study(fabric, scatter, chosen.shots, chosen.jobs)),
        ("sweep", sweep(fabric, chosen.shots, chosen.jobs)),
    ):
        report[name] = {"wall_s": round(wall, 2), "wall_s_of_1000": round(1000 * wall / chosen.shots, 1)}
    text = json.dumps(report, indent=1)
    print(text)
    if chosen.out:
        chosen.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
