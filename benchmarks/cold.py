"""Cost of the first shot of a new environment: S-720, one ply, 92.5 m/s, from empty caches, by stage.

Run with nothing else on the machine:

    python benchmarks/cold.py [--end-time 250e-6] [--out FILE.json]

All kernels are compiled into an empty folder, which is removed; processes that compile count with the process that
started them. Wall and CPU time [s] of each stage, and of the same shot in a second process, which loads what the first
has compiled.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]


def cpu():
    """[s] of this process and of those that it has waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def stages(end_time):
    """{stage: (wall, cpu)} [s] of one shot in this process."""
    found, last = {}, [time.perf_counter(), cpu()]

    def note(name):
        now = [time.perf_counter(), cpu()]
        found[name] = tuple(round(b - a, 2) for a, b in zip(last, now))
        last[:] = now

    from fabrics import catalogue
    from shellfabric.impact import simulation
    from shellfabric.solver.pack_solver import PackSolver

    note("import")
    setup = simulation.ImpactSetup(
        catalogue.load("S-720").with_effective_density(), 92.5, end_time=end_time
    )
    table = setup.table()
    note("table")
    panel = setup.panel(table)
    solver = PackSolver(panel, setup.strike_velocity, end_time)
    note("state and first sample")
    solver.run()
    note("run")
    simulation.collect_result(setup, solver)
    note("result")
    return found


def process(end_time, folder):
    """The stages in a process of its own, with its kernels in `folder`."""
    command = [sys.executable, __file__, "--child", "--end-time", str(end_time)]
    environment = {
        name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
    }
    environment |= {"NUMBA_CACHE_DIR": folder, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    found = json.loads(done.stdout)
    total = [round(sum(times), 2) for times in zip(*found.values())]
    return {"total": total, **found}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--end-time", type=float, default=250e-6)
    arguments.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    if chosen.child:
        print(json.dumps(stages(chosen.end_time)))
        return
    with tempfile.TemporaryDirectory() as folder:
        report = {"columns": ["wall_s", "cpu_s"]}
        report |= {name: process(chosen.end_time, folder) for name in ("cold", "warm")}
    report["load_average"] = os.getloadavg()[0]
    text = json.dumps(report, indent=1)
    print(text)
    if chosen.out:
        chosen.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
