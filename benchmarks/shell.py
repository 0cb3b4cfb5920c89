"""Cost of the explicit shell: S-720, one ply, 6,241 elements, 250 us; with the size of the panel.

Run with nothing else on the machine:

    python benchmarks/shell.py [--repeats 9] [--parts one sizes] [--out FILE.json]

Reported are medians of the marching alone (no table, no compilation, no audit). What is measured on one core keeps to
one. CPU time stands beside wall time: where the two differ the machine was busy, and the wall time says nothing about
the code. For the sizes, all rows are worked on from the start, so that the cost is that of a panel in motion
everywhere, and the first steps are left out: in these each tension is the highest so far, and all are looked up.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import time
from contextlib import contextmanager
from pathlib import Path

import numba
import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.loop import ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics

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
        solver.state.first_row = 0
        solver.state.end_row = solver.const.ni
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


def sizes(table):
    """The same steps on larger and smaller panels, all of it in motion, and the dearest element over the cheapest."""
    found = [
        measure(Panel(table, (side, side)), 5, steps, everywhere=True) for side, steps in SIZES
    ]
    cost = [entry["cpu_ns_per_element_step"] for entry in found]
    return {"sizes": found, "dearest_over_cheapest": round(max(cost) / min(cost), 3)}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=9)
    parts = ("one", "sizes")
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
    report["machine"]["load_average_after"] = os.getloadavg()[0]
    publish(report, chosen.out)


if __name__ == "__main__":
    main()
