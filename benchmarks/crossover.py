"""Cost of the 3D crossover: biaxial paths of S-720 to fibre failure, response surface, memory over 1,000 solves.

Run with nothing else on the machine:

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/crossover.py [--size medium] [--out FILE.json]

CPU time stands beside wall time: where the two differ the machine was busy, and the wall time says nothing about the
code. Tangents are counted with those of steps that failed.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path

from fabrics import catalogue
from meshing import crossover as mesher
from unitcell3d.assembly.linear_solver import DirectSolver
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify.response_surface import sample
from unitcell3d.model.crossover import CrossoverModel, Load
from unitcell3d.solver.load_stepping import continue_to, rest_state
from unitcell3d.solver.newton import Newton

RATIOS = ((1, 1), (1, 0), (0, 1))
SWEEP = 50  # solves up a path and down again in the measurement of memory


def paths(fabric, size):
    """Per path: wall and CPU time [s], steps, tangents, failure tension [N]."""
    taken = []
    factor = DirectSolver.factor
    DirectSolver.factor = lambda solver: (taken.append(1), factor(solver))
    mesh = mesher.build(fabric, size=size)
    biaxial_and_platens.biaxial(
        mesh, fabric, (1, 1), max_displacement=1e-6
    )  # compiled before the clock starts
    rows = []
    for ratio in RATIOS:
        taken.clear()
        wall, cpu = time.perf_counter(), time.process_time()
        history = biaxial_and_platens.biaxial(mesh, fabric, ratio)
        rows.append(
            {
                "ratio": ratio,
                "wall_s": time.perf_counter() - wall,
                "cpu_s": time.process_time() - cpu,
                "steps": len(history["path"]),
                "tangents": len(taken),
                "T_N": [history["T1"][-1], history["T2"][-1]],
                "failed": history.failed,
            }
        )
    DirectSolver.factor = factor
    return rows


def surface(fabric, size, jobs):
    """The surface of 21 x 21 points: wall time [s], equilibria, tangents, errors of left-out lines."""
    wall = time.perf_counter()
    found = sample(fabric, size=size, jobs=jobs)
    return {
        "wall_s": time.perf_counter() - wall,
        "lines_s": sum(found.seconds.values()),
        "processes": jobs,
        "equilibria": found.solves,
        "tangents": found.iterations,
        "left_out_rms": {name: error.rms for name, error in found.errors.items()},
    }


def memory(fabric, solves):
    """Resident memory [MiB] after each tenth of `solves` equilibria up and down a path, new solvers included."""
    mesh = mesher.build(fabric, size="coarse")
    model = CrossoverModel(mesh, fabric)
    low, high = Load((6e-6, 6e-6)), Load((25e-6, 25e-6))
    shares = [(i + 1) / SWEEP for i in range(SWEEP)]
    seen, done = [], 0
    solver = Newton(model)
    q = rest_state(model, solver, Load()).q
    q = [
        found
        for _, found in continue_to(model, solver, q, Load(), low, [0.1 * i for i in range(1, 11)])
    ][-1].q
    while done < solves:
        solver.close()
        solver = Newton(model)
        for start, end in ((low, high), (high, low)):
            for _, found in continue_to(model, solver, q, start, end, shares):
                q, done = found.q, done + 1
        seen.append(resident())
    solver.close()
    return {"solves": done, "resident_MiB": seen}


def resident():
    """[MiB] of this process."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE") / 2**20


def main():
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="medium")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", choices=("paths", "surface", "memory"), help="one of the three")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    fabric = catalogue.load("S-720")
    parts = {
        "paths": lambda: paths(fabric, options.size),
        "surface": lambda: surface(fabric, options.size, options.jobs),
        "memory": lambda: memory(fabric, 1000),
    }
    found = {"size": options.size, "cores": os.cpu_count(), "load_average": os.getloadavg()[0]}
    found |= {name: part() for name, part in parts.items() if options.only in (None, name)}
    found["load_average_after"] = os.getloadavg()[0]
    text = json.dumps(found, indent=2)
    print(text)
    if options.out is not None:
        options.out.write_text(text + "\n")


if __name__ == "__main__":
    main()
