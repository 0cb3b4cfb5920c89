"""Cost of a ballistic limit: each fabric's critical velocity by bisection to 1 m/s, table of the cell included.

Run with nothing else on the machine:

    taskset -c 0 python benchmarks/critical_velocity.py [FABRIC ...] [--jobs 1] [--repeats 3] [--out FILE.json]

Reported are medians of the time from a fabric to its bracket (one table, then shots) and of the scan about the bracket
with its default range. The kernels are compiled before (warm), by one shot that is not counted. CPU time stands beside
wall time: where it is the smaller, at one worker, the machine was busy.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from pathlib import Path

from shell import machine, publish

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from weavecell.studies import ballistic_limit, limit_scan

FABRICS = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")


def bisect(fabric, jobs):
    """(Limit, times) of one search; times in s: table, wall and CPU of the search, wall and CPU of the scan."""
    wall, cpu = time.perf_counter(), time.process_time()
    panel = ImpactSetup(fabric, 1.0).panel()
    table = time.perf_counter() - wall
    found = ballistic_limit.critical_velocity(panel, jobs=jobs)
    searched = time.perf_counter(), time.process_time()
    found = limit_scan.scan(panel, found, jobs=jobs)
    scanned = time.perf_counter() - searched[0], time.process_time() - searched[1]
    return found, (table, searched[0] - wall, searched[1] - cpu, *scanned)


def measure(name, jobs, repeats):
    """The limit of a fabric and the medians of its cost."""
    runs = [bisect(catalogue.load(name).with_effective_density(), jobs) for _ in range(repeats)]
    found = runs[0][0]
    table, wall, cpu, scan_wall, scan_cpu = (
        round(statistics.median(column), 3) for column in zip(*(times for _, times in runs))
    )
    return {
        "critical_velocity": round(found.velocity, 2) if found.single else None,
        "mixed_zone": [round(end, 2) for end in found.mixed_zone] if found.mixed_zone else None,
        "bracket": [round(found.low, 2), round(found.high, 2)],
        "shots": len(found.shots),
        "table_s": table,
        "wall_s": wall,
        "cpu_s": cpu,
        "scan_wall_s": scan_wall,
        "scan_cpu_s": scan_cpu,
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("fabrics", nargs="*", default=FABRICS, metavar="FABRIC")
    arguments.add_argument("--jobs", type=int, default=1)
    arguments.add_argument("--repeats", type=int, default=3)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    ballistic_limit.shoot(
        ImpactSetup(catalogue.load("S-720").with_effective_density(), 1.0).panel(), [200.0]
    )
    report = {"machine": machine() | {"cores_used": chosen.jobs}, "fabrics": {}}
    for name in chosen.fabrics:
        report["fabrics"][name] = measure(name, chosen.jobs, chosen.repeats)
    report["machine"]["load_average_after"] = os.getloadavg()[0]
    publish(report, chosen.out)


if __name__ == "__main__":
    main()
