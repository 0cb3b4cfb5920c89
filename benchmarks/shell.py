"""Cost of the explicit shell: S-720, one ply, 6,241 elements, 250 us, one core; and with the size of the panel.

Run with nothing else on the machine:

    taskset -c 0 python benchmarks/shell.py [--repeats 9] [--out FILE.json]

Reported are medians of the marching alone (no table, no compilation, no audit). CPU time stands beside wall time: where
the two differ the machine was busy, and the wall time says nothing about the code. For the sizes, all rows are worked
on from the start, so that the cost is that of a panel in motion everywhere.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import time
from pathlib import Path

import numba
import numpy as np

from fabrics import catalogue
from shellfabric import march_kernels
from shellfabric.cell import CellModel
from shellfabric.panel import Panel

END = 250e-6


def machine():
    """What the figures were taken on."""
    names = [
        line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if "model name" in line
    ]
    return {
        "processor": names[0] if names else platform.processor(),
        "cores": os.cpu_count(),
        "cores_used": 1,
        "load_average": os.getloadavg()[0],
        "python": platform.python_version(),
        "numba": numba.__version__,
        "numpy": np.__version__,
    }


def march(panel, strike_velocity, steps, everywhere):
    """(wall, cpu) [s] of marching a fresh panel."""
    state, const, work = panel.state(strike_velocity), panel.constants(), panel.work()
    if everywhere:
        state.rows[:] = 0, const.ni
    fine = np.empty((steps, 3))
    march_kernels.advance(state, const, work, 0, fine)
    wall, cpu = time.perf_counter(), time.process_time()
    made, _ = march_kernels.advance(state, const, work, steps, fine)
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


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=9)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    fabric = catalogue.load("S-720").effective()
    tables = {form: CellModel(fabric, form=form).table(201) for form in ("equilibrium", "variational")}
    start = time.perf_counter()
    CellModel(fabric).table(201)
    report = {"machine": machine(), "table_201_s": round(time.perf_counter() - start, 3)}
    for form, table in tables.items():
        report[form] = measure(Panel(table), chosen.repeats)
    # the same steps on larger and smaller panels, all of it in motion
    report["sizes"] = [
        measure(Panel(tables["equilibrium"], (side, side)), 3, steps, everywhere=True)
        for side, steps in ((0.0815, 2000), (0.203, 1000), (0.407, 700), (0.815, 400), (2.6, 60))
    ]
    report["machine"]["load_average_after"] = os.getloadavg()[0]
    text = json.dumps(report, indent=2)
    print(text)
    if chosen.out:
        chosen.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
