"""Cost of the explicit shell: S-720, one ply, 6,241 elements, 250 us; with the size of the panel, threads.

Run with nothing else on the machine:

    python benchmarks/shell.py [--repeats 9] [--parts one sizes threads] [--out FILE.json]

Reported are medians of the marching alone (no table, no compilation, no audit). What is measured on one core keeps to
one. CPU time stands beside wall time: where the two differ the machine was busy, and the wall time says nothing about
the code. For the sizes, all rows are worked on from the start, so that the cost is that of a panel in motion
everywhere, and the first steps are left out: in these each tension is the highest so far, and all are looked up.
Threads are compared in pairs of runs, alternated, on 4 x the size, and their results to the bit.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.panel.model import Panel
from shellfabric.panel.numerics import Numerics
from shellfabric.solver import ply_kernels
from shellfabric.solver.pack_solver import PackSolver

END = 250e-6
FORMS = ("equilibrium", "variational")
SIZES = (
    (0.0815, 600),
    (0.203, 1000),
    (0.407, 300),
    (0.815, 100),
    (2.6, 20),
)  # side [m], steps, in which nothing fails
FIRST = 50  # steps of a panel in motion everywhere that are not counted


def publish(report, path):
    """Print a report as JSON, and write it to a file where one is given."""
    text = json.dumps(report, indent=2)
    print(text)
    if path:
        path.write_text(text + "\n", encoding="utf-8")


def machine():
    """What the figures were taken on."""
    names = [
        line.split(":")[1].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if "model name" in line
    ]
    return {
        "processor": names[0] if names else platform.processor(),
        "cores": os.cpu_count(),
        "load_average": os.getloadavg()[0],
        "python": platform.python_version(),
        "numba": numba.__version__,
        "numpy": np.__version__,
    }


@contextmanager
def one_core():
    """Keep to one core, where the system can."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def march(panel, strike_velocity, steps, everywhere):
    """(wall, cpu) [s] of marching a fresh panel."""
    solver = PackSolver(panel, strike_velocity, END)
    solver.threads, solver.exchange = 1, np.inf  # no checks of the energy
    if everywhere:
        solver.state.active_rows[:] = 0, solver.const.ni
        solver.advance(np.empty((FIRST, 3)))
    fine = np.empty((steps, 3))
    wall, cpu = time.perf_counter(), time.process_time()
    made, _ = solver.advance(fine)
    return (time.perf_counter() - wall) / made * steps, (time.process_time() - cpu) / made * steps


def measure(panel, repeats, steps=None, everywhere=False):
    """Medians over `repeats` runs at 92.5 m/s, which neither stop nor perforate in the time."""
    steps = steps or round(END / panel.time_step)
    runs = [march(panel, 92.5, steps, everywhere) for _ in range(repeats)]
    wall, cpu = (statistics.median(column) for column in zip(*runs))
    per = 1e9 / (steps * panel.elements)
    return {
        "elements": panel.elements,
        "steps": steps,
        "wall_s": round(wall, 4),
        "cpu_s": round(cpu, 4),
        "wall_ns_per_element_step": round(wall * per, 2),
        "cpu_ns_per_element_step": round(cpu * per, 2),
        "least_cpu_ns_per_element_step": round(min(run[1] for run in runs) * per, 2),
    }


def audit(panel, repeats=50):
    """ns per element of the energies of one audit, of which a run has one every 2 us."""
    state, const, out = panel.state(92.5), panel.constants(), np.empty(5)
    ply_kernels.energies(state, const, out)
    cpu = time.process_time()
    for _ in range(repeats):
        ply_kernels.energies(state, const, out)
    return round((time.process_time() - cpu) / repeats * 1e9 / panel.elements, 1)


def with_knobs(panel, **knobs):
    return replace(panel, numerics=replace(panel.numerics, **knobs))


def sizes(table):
    """The same steps on larger and smaller panels, all of it in motion, and the dearest element over the cheapest."""
    found = [
        measure(Panel(table, (side, side)), 5, steps, everywhere=True) for side, steps in SIZES
    ]
    cost = [entry["cpu_ns_per_element_step"] for entry in found]
    return {"sizes": found, "dearest_over_cheapest": round(max(cost) / min(cost), 3)}


def threads(table, repeats):
    """Marching of a whole run on one and on two cores, audits and hand-over of work to the threads in between."""
    panel = Panel(table, (0.406, 0.406))
    walls, ends = {1: [], 2: []}, {}
    for _ in range(repeats):
        for count in walls:
            run = PackSolver(with_knobs(panel, threads=count), 92.5, END).run()
            walls[count].append(run.wall_time)
            ends[count] = run.state
    same = all(np.array_equal(one, two) for one, two in zip(ends[1], ends[2]))
    middle = {count: statistics.median(wall) for count, wall in walls.items()}
    return {
        "elements": panel.elements,
        "wall_s_one": round(middle[1], 4),
        "wall_s_two": round(middle[2], 4),
        "one_over_two": round(middle[1] / middle[2], 3),
        "same_bits": same,
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=9)
    parts = ("one", "sizes", "threads")
    arguments.add_argument("--parts", nargs="+", choices=parts, default=parts)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    fabric = catalogue.load("S-720").with_effective_density()
    tables = {form: CellModel(fabric, cell_formulation=form).table(201) for form in FORMS}
    report = {"machine": machine()}
    with one_core():
        start = time.perf_counter()
        CellModel(fabric).table(201)
        report["table_201_s"] = round(time.perf_counter() - start, 3)
        if "one" in chosen.parts:
            for form, table in tables.items():
                panel = Panel(table, numerics=Numerics(threads=1))
                report[form] = measure(panel, chosen.repeats) | {
                    "audit_ns_per_element": audit(panel)
                }
        if "sizes" in chosen.parts:
            report["size"] = {form: sizes(table) for form, table in tables.items()}
    if "threads" in chosen.parts:
        enough = len(os.sched_getaffinity(0)) > 1
        report["two_cores"] = {
            form: threads(table, 5) if enough else None for form, table in tables.items()
        }
    report["machine"]["load_average_after"] = os.getloadavg()[0]
    publish(report, chosen.out)


if __name__ == "__main__":
    main()
