"""Cost of packs: 16 plies of S-720, 6,241 elements each, 400 us; and a pack against its plies alone.

Run with nothing else on the machine:

    python benchmarks/pack.py [--repeats 3] [--plies 16] [--velocity 170] [--out FILE.json]
    python benchmarks/pack.py --friction 0.2

Marching alone is timed (no table, no compilation, no audit), on one core. A projectile that has stopped is held where
it is until the 400 us are over. CPU time stands beside wall time: where the
two differ the machine was busy. "over_single" is the cost of an element and step of the pack over that of a single ply
all of which is in motion. "every_ply_in_touch" is the same for plies that are pressed together everywhere, over the
first steps: the most that contact can cost. With --friction the aligned pack alone is timed, with and without friction
between its plies.
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

import numpy as np
from shell import END, machine, one_core, publish
from shell import march as march_single

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.jit.table import Rows
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import Pack

LONG = 400e-6


def clocked(march, steps):
    """(wall, cpu) [s] of a number of steps, and how many were made."""
    fine = np.empty((steps, 3))
    wall, cpu = time.perf_counter(), time.process_time()
    made, _ = march.advance(fine)
    return time.perf_counter() - wall, time.process_time() - cpu, made


def whole(pack, velocity, end):
    """One run for `end` [s], at the end of which a projectile that has stopped is still held where it is."""
    march = PackSolver(pack, velocity, end)
    march.exchange = np.inf
    march.advance(np.empty((0, 3)))
    steps, wall, cpu = round(end / pack.time_step), 0.0, 0.0
    while march.steps < steps:
        one, two, made = clocked(march, steps - march.steps)
        wall, cpu = wall + one, cpu + two
        # it would end here; the benchmark is the cost of the whole time
        if march.stack.projectile_velocity[2] <= 0:
            hold(march)
        elif made == 0:
            break
    return wall, cpu, march.steps


def hold(march):
    """Let the projectile go on at a crawl, with a mass that nothing stops. One that is stopped anew in every step ends
    the march in every step, and at each end all tensions are looked up that no step has needed."""
    march.stack.projectile_velocity[2] = 1e-3
    consts = Rows([const._replace(projectile_mass=1e9) for const in march.consts])
    march._plies = march._plies[0], consts


def pressed(pack, steps):
    """Cost of the first steps of plies that touch everywhere: all are deflected, and 0.02 mm into each other."""
    march = PackSolver(pack, 1e-3, 1.0)
    march.exchange = np.inf
    march.advance(np.empty((0, 3)))
    march.stack.projectile_position[:, 2] -= 1.0
    march.stack.awake[:] = True
    for p, (state, const) in enumerate(zip(march.states, march.consts)):
        state.first_row = 0
        state.end_row = const.ni
        state.u[2][: (const.ni + 1) * const.row_stride] = 5e-3 - p * (pack.gaps[0] + 2e-5)
    clocked(march, 2)
    return clocked(march, steps)


def cost(pack, velocity, repeats):
    """{name: number} of a pack: ns for an element and step of a whole run, and of plies that touch everywhere."""
    runs = [whole(pack, velocity, LONG) for _ in range(repeats)]
    touching = [pressed(pack, 50) for _ in range(repeats)]
    return {
        "ns_per_element_step": round(
            1e9 * statistics.median(run[1] for run in runs) / runs[0][2] / pack.elements, 2
        ),
        "every_ply_in_touch_ns": round(
            1e9 * statistics.median(run[1] for run in touching) / touching[0][2] / pack.elements, 2
        ),
    }


def with_friction(panel, chosen, report):
    """Cost with and without friction between plies, into the report."""
    for name, friction in (("frictionless", 0.0), ("friction", chosen.friction)):
        pack = Pack.stacked(panel, chosen.plies, friction=friction)
        report[name] = cost(pack, chosen.velocity, chosen.repeats)
    ratios = {
        key: report["friction"][key] / report["frictionless"][key] for key in report["friction"]
    }
    report["over_frictionless"] = {key: round(ratio, 2) for key, ratio in ratios.items()}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=3)
    arguments.add_argument("--plies", type=int, default=16)
    arguments.add_argument("--velocity", type=float, default=170.0)
    arguments.add_argument("--friction", type=float)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    panel = Panel(
        CellModel(catalogue.load("S-720").with_effective_density()).table(201),
        numerics=Numerics(threads=1),
    )
    report = {"machine": machine(), "plies": chosen.plies, "elements_of_a_ply": panel.elements}
    if chosen.friction is not None:
        with one_core():
            with_friction(panel, chosen, report)
        publish(report, chosen.out)
        return
    with one_core():
        single = [
            march_single(panel, 92.5, round(END / panel.time_step), True)[1]
            for _ in range(chosen.repeats)
        ]
        per = 1e9 / (round(END / panel.time_step) * panel.elements)
        report["single_ns"] = round(statistics.median(single) * per, 2)
        for stacking in ("aligned", "alternating"):
            pack = Pack.stacked(panel, chosen.plies, stacking=stacking)
            runs = [whole(pack, chosen.velocity, LONG) for _ in range(chosen.repeats)]
            wall, cpu = (statistics.median(run[c] for run in runs) for c in (0, 1))
            ns = 1e9 * cpu / runs[0][2] / pack.elements
            touching = pressed(pack, 50)
            most = 1e9 * touching[1] / touching[2] / pack.elements
            report[stacking] = {
                "steps": runs[0][2],
                "wall_s": round(wall, 3),
                "cpu_s": round(cpu, 3),
                "ns_per_element_step": round(ns, 2),
                "over_single": round(ns / report["single_ns"], 2),
                "every_ply_in_touch_ns": round(most, 2),
                "every_ply_in_touch_over_single": round(most / report["single_ns"], 2),
            }
    publish(report, chosen.out)


if __name__ == "__main__":
    main()
