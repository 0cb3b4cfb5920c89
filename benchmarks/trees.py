"""Two or more trees of the code beside each other: cold start, and the cost of a step, of one ply and of a pack.

    python benchmarks/trees.py cold TREE TREE [--plies 3] [--rounds 2]
    python benchmarks/trees.py march TREE TREE [--plies 4] [--velocity 300] [--rounds 4]

The trees take turns, each in a process of its own, so that a busy machine slows them all. `cold` is CPU time [s] of all
processes of a first shot from an empty cache (60 us of S-720), then of a second one. `march` is CPU time [ns] of an
element and step with all rows in motion, the best of three, of kernels that stay compiled between rounds; the ratio of
each round is to the first tree of that round. A fast projectile tears the plies.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FABRIC = "S-720"
REPEATS = 3


def used_cpu():
    """CPU time [s] of this process and of those that it has waited for."""
    parts = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(part.ru_utime + part.ru_stime for part in parts)


def shoot(plies, velocity):
    """One short shot: CPU time, wall time, memory, the last velocity to the bit."""
    start = time.perf_counter()
    from fabrics import catalogue
    from shellfabric.impact.run import run_impact
    from shellfabric.impact.setup import ImpactSetup

    setup = ImpactSetup(catalogue.load(FABRIC), velocity, end_time=60e-6, plies=plies)
    result = run_impact(setup)
    return {
        "cpu_s": round(used_cpu(), 2),
        "wall_s": round(time.perf_counter() - start, 2),
        "peak_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
        "v": repr(float(result.velocity[-1])),
    }


def march(plies, velocity, skip, steps):
    """CPU time [ns] of an element and step, the best of some marches in which every row is worked on."""
    import numpy as np

    from fabrics import catalogue
    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.loop.pack_solver import PackSolver
    from shellfabric.membrane.numerics import Numerics
    from shellfabric.plies.model import Pack

    setup = ImpactSetup(catalogue.load(FABRIC), velocity, numerics=Numerics(threads=1))
    panel = setup.panel(setup.table())
    target = panel if plies == 1 else Pack.stacked(panel, plies)
    found = []
    for _ in range(REPEATS):
        solver = PackSolver(target, velocity, 1.0)
        solver.exchange = np.inf  # no audits
        solver.advance(np.empty((0, 3)))
        for state, const in zip(solver.states, solver.consts):
            state.first_row = 0
            state.end_row = const.ni
        if plies > 1:
            solver.stack.awake[:] = True
        solver.advance(np.empty((skip, 3)))
        start = time.process_time()
        made, _ = solver.advance(np.empty((steps, 3)))
        spent = time.process_time() - start
        found.append(1e9 * spent / made / panel.elements / plies)
    return {"ns": round(min(found), 2)}


def in_tree(tree, cache, arguments):
    """What this file finds in a process of its own that runs the code of a tree."""
    command = [sys.executable, str(Path(__file__).resolve()), *map(str, arguments), "--child"]
    environment = os.environ | {"PYTHONPATH": str(Path(tree).resolve()), "NUMBA_CACHE_DIR": cache}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)


def compare_cold(chosen, arguments):
    """Print a line for each shot: of each round and tree one from an empty cache, and one after it."""
    for _ in range(chosen.rounds):
        for tree in chosen.trees:
            with tempfile.TemporaryDirectory() as cache:
                for what in ("cold", "warm"):
                    print(tree, what, in_tree(tree, cache, arguments), flush=True)


def compare_march(chosen, arguments):
    """Print the times of all rounds, and the medians of their ratios to the first tree."""
    times = {tree: [] for tree in chosen.trees}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(chosen.rounds):
            for number, tree in enumerate(chosen.trees):
                cache = str(Path(folder) / str(number))
                times[tree].append(in_tree(tree, cache, arguments)["ns"])
    first = times[chosen.trees[0]]
    for tree, found in times.items():
        ratios = [own / other for own, other in zip(found, first)]
        print(tree, found, f"ratio {statistics.median(ratios):.3f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("cold", "march"))
    parser.add_argument("trees", nargs="*")
    parser.add_argument("--plies", type=int, default=1)
    parser.add_argument("--velocity", type=float, help="[m/s]; 92.5 of one ply, 150 of a pack")
    parser.add_argument("--skip", type=int, default=50, help="steps that are not counted")
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    velocity = chosen.velocity or (92.5 if chosen.plies == 1 else 150.0)
    if chosen.child:
        if chosen.what == "cold":
            found = shoot(chosen.plies, velocity)
        else:
            found = march(chosen.plies, velocity, chosen.skip, chosen.steps)
        print(json.dumps(found))
        return
    arguments = [chosen.what, "--plies", chosen.plies, "--velocity", velocity]
    arguments += ["--skip", chosen.skip, "--steps", chosen.steps]
    if chosen.what == "cold":
        compare_cold(chosen, arguments)
    else:
        compare_march(chosen, arguments)


if __name__ == "__main__":
    main()
