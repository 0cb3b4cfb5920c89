"""Uniform mesh and meshes that grow longer away from the impact point: error and cost, as candidates for the default.

    taskset -c 0 python benchmarks/default_mesh.py [--out FILE.json]

Seven scenes: the standard shots at one ply and at four plies, a pack of S-731, an oblique shot at S-726 and S-726 on a
backing block. Errors are against 2 elements a crossover everywhere. Cost is CPU time of one core, the least of two runs
(the reference is run once), with the table of the cell, over that of the uniform mesh of one element a crossover.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import replace
from math import inf, isnan, radians
from pathlib import Path

import numpy as np
from shell import machine, publish

from fabrics import catalogue
from fabrics.base.errors import InputError, UnstableError
from shellfabric.backing.block import Backing
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from validation.study import markdown

MESHES = {
    "1": {},
    "1 to 24, then 2": {"grading": ((24, 1), (inf, 2))},
    "1 to 16, 2 to 32, then 4": {"grading": ((16, 1), (32, 2), (inf, 4))},
    "1 to 10, 2 to 20, then 4": {"grading": ((10, 1), (20, 2), (inf, 4))},
}
REFERENCE = {"elements_per_crossover": 2}
QUANTITIES = ("residual velocity", "absorbed energy", "stop time", "deflection", "peak tension")


def ply(name, velocity, **changes):
    """A shot at a fabric, 400 us at the longest."""
    fabric = catalogue.load(name).with_effective_density()
    return ImpactSetup(fabric, velocity, end_time=400e-6, numerics=Numerics(threads=1), **changes)


SCENES = {
    "S-720, 92.5 m/s": lambda: ply("S-720", 92.5),
    "S-720, 160 m/s": lambda: ply("S-720", 160.0),
    "S-745, 240 m/s": lambda: ply("S-745", 240.0),
    "4 x S-728, 91 m/s": lambda: ply("S-728", 91.0, opening=0.12, plies=4),
    "4 x S-731, 300 m/s": lambda: ply("S-731", 300.0, opening=0.08, plies=4),
    "S-726, 96 m/s, 20 degrees oblique": lambda: ply(
        "S-726",
        96.0,
        opening=0.12,
        symmetry="half",
        projectile=Projectile(obliquity=radians(20), azimuth=radians(90)),
    ),
    "S-726 on a block, 150 m/s": lambda: ply(
        "S-726", 150.0, opening=0.1, backing=Backing(size=(0.1, 0.1, 0.06))
    ),
}


def run(setup, repeats):
    """({quantity: value}, CPU time [s]) of a shot with its table."""
    costs = []
    for _ in range(repeats):
        begun = time.process_time()
        result = simulation.run(setup)
        costs.append(time.process_time() - begun)
    left, found = max(0.0, result.residual_velocity), {"outcome": result.outcome}
    highest = float(np.max(result.peak_tension))
    if result.outcome == "perforated":
        energy = 0.5 * setup.projectile.mass * (setup.strike_velocity**2 - left**2)
        found |= {"residual velocity": left, "absorbed energy": energy}
    else:
        found |= {"deflection": float(result.step_history[:, 1].max()), "peak tension": highest}
        if result.outcome == "stopped":
            found["stop time"] = float(result.step_history[-1, 0])
    return found, min(costs)


def scene(setup):
    """{mesh: {"errors", "outcome", "cpu_s"}} of a shot, the reference among them."""
    run(replace(setup, end_time=1e-6), 1)  # compiled before
    run(replace(setup, end_time=1e-6, **MESHES["1 to 16, 2 to 32, then 4"]), 1)
    truth, cost = run(replace(setup, **REFERENCE), 1)
    found = {"2": {"errors": {}, "outcome": truth["outcome"], "cpu_s": cost}}
    for name, mesh in MESHES.items():
        try:
            values, cost = run(replace(setup, **mesh), 2)
        except (InputError, UnstableError) as problem:
            found[name] = {"failed": str(problem)}
            continue
        same = values["outcome"] == truth["outcome"]
        errors = {
            key: values[key] / truth[key] - 1
            for key in QUANTITIES
            if same and key in values and key in truth
        }
        found[name] = {"errors": errors, "outcome": values["outcome"], "cpu_s": cost}
    return found


def table(report):
    """Lines of Markdown: a row a scene and mesh."""
    rows = [
        [
            "scene",
            "sides, crossovers",
            *(f"{name}, %" for name in QUANTITIES),
            "CPU time, s",
            "cost",
        ]
    ]
    for name, meshes in report.items():
        for mesh, found in meshes.items():
            label = "1/2" if mesh == "2" else mesh
            if "failed" in found:
                why = (
                    "refused: the first zone is too small"
                    if "grading" in found["failed"]
                    else "failed"
                )
                rows.append([name, label, why, *[""] * (len(rows[0]) - 3)])
                continue
            errors = [found["errors"].get(key, float("nan")) for key in QUANTITIES]
            cells = [
                "reference" if mesh == "2" and not k else "-" if isnan(e) else f"{100 * e:+.2g}"
                for k, e in enumerate(errors)
            ]
            cost = found["cpu_s"] / meshes["1"]["cpu_s"]
            rows.append([name, label, *cells, f"{found['cpu_s']:.2f}", f"{cost:.2f}"])
    return markdown(rows)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--only", nargs="+", help="first words of the scenes")
    arguments.add_argument("--out", type=Path)
    chosen, report = arguments.parse_args(), {}
    for name, setup in SCENES.items():
        if chosen.only is None or any(name.startswith(word) for word in chosen.only):
            report[name] = scene(setup())
            print(name, json.dumps(report[name]), flush=True)
    print(table(report))
    publish({"machine": machine(), "scenes": report}, chosen.out)


if __name__ == "__main__":
    main()
