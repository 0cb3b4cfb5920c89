"""Graded panels against the uniform one: error, cost, and what comes back of a wave from where zones meet.

    taskset -c 0 python benchmarks/graded.py [--fabric S-720] [--parts shots limit waves pack refined] [--out FILE.json]

Shots: the fabric's two published ones, with the same panel as a whole run of `impact`; errors are against the uniform
panel of one element a crossover. Cost is CPU time of one shot on one core, audits included, the least of two; ratios of
it hold on a busy machine too. Limit: the critical velocity, bisected to 0.5 m/s. Waves: a pulse u = cos^2 along taut
straight yarns, 100 elements of one crossover and then longer ones; the share of its energy that is found before them
once it should be through. Pack: four plies of S-726 at a velocity that they hold and at one that perforates them; every
ply has the same grading. Refined: elements shorter than a crossover about the impact point alone against the same
everywhere, of shots that perforate cloth of straight, decoupled yarns and S-720.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
from shell import machine, publish

from fabrics import catalogue
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellModel
from shellfabric.loop import ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import Pack
from validation.models.variants import with_straight_yarns
from weavecell.studies.ballistic_limit import critical_velocity

ZONES = {
    "1": None,
    "1 to 10, then 2": ((10, 1), (inf, 2)),
    "1 to 10, 2 to 20, then 4": ((10, 1), (20, 2), (inf, 4)),
    "1 to 16, then 2": ((16, 1), (inf, 2)),
    "1 to 16, 2 to 32, then 4": ((16, 1), (32, 2), (inf, 4)),
    "1 to 24, 2 to 40, then 4": ((24, 1), (40, 2), (inf, 4)),
    "1 to 32, then 2": ((32, 1), (inf, 2)),
    "2": ((inf, 2),),
}
SHOTS = {
    "S-720": (92.5, 155.0),
    "S-726": (96.0, 174.0),
    "S-728": (76.0, 170.0),
    "S-731": (116.0, 132.0),
}
PULSES = {
    "1": None,
    "1/2, 1": ((100, 1 / 2), (inf, 1)),
    "1/3, 1": ((100, 1 / 3), (inf, 1)),
    "1, 2": ((100, 1), (inf, 2)),
    "1, 4": ((100, 1), (inf, 4)),
    "1, 2, 4": ((100, 1), (116, 2), (inf, 4)),
}
LENGTHS = (8, 16, 32, 64)  # of the pulse, in crossovers
REFINED = {
    "1": {},
    "2": {"elements_per_crossover": 2},
    "3": {"elements_per_crossover": 3},
    "1/2 to 10, 1 to 20, then 2": {"grading": ((10, 1 / 2), (20, 1), (inf, 2))},
    "1/3 to 10, 1 to 16, then 2": {"grading": ((10, 1 / 3), (16, 1), (inf, 2))},
    "1/3 to 10, 1 to 20, 2 to 40, then 4": {"grading": ((10, 1 / 3), (20, 1), (40, 2), (inf, 4))},
    "1/4 to 10, 1 to 20, 2 to 40, then 4": {"grading": ((10, 1 / 4), (20, 1), (40, 2), (inf, 4))},
}
REFINED_SHOTS = {
    "straight, decoupled": (170.0,),
    "S-720": (160.0, 180.0, 220.0),
}  # strike velocities [m/s]
PACK = "S-726", 4, (158.0, 300.0)  # fabric, plies, strike velocities [m/s]
PACK_ZONES = (
    "1",
    "1 to 16, then 2",
    "1 to 16, 2 to 32, then 4",
    "1 to 24, 2 to 40, then 4",
    "1 to 32, then 2",
)


def shot(panel, strike_velocity):
    """One shot to its end: what comes of it and its CPU time."""
    costs = []
    for _ in range(2):
        begun = time.process_time()
        march = PackSolver(panel, strike_velocity, 1.5e-3).run()
        costs.append(time.process_time() - begun)
    return {
        "outcome": march.outcome,
        "time_us": 1e6 * march.time,
        "residual_velocity": float(march.sample("v")[-1]),
        "deflection_mm": 1e3 * float(march.sample("z").max()),
        "peak_N": [float(peak) for peak in march.state.peak_tension],
        "balance": float(np.abs(march.sample("error")).max() / march.strike_energy),
        "cpu_s": min(costs),
    }


def refined_shots():
    """Shots that perforate, on meshes that are as fine everywhere or about the impact point alone."""
    fabric, found = catalogue.load("S-720").with_effective_density(), {}
    tables = {
        "straight, decoupled": CellModel(with_straight_yarns(fabric), cell_model="decoupled").table(
            201
        ),
        "S-720": CellModel(fabric).table(201),
    }
    for cloth, velocities in REFINED_SHOTS.items():
        for name, mesh in REFINED.items():
            panel = Panel(tables[cloth], numerics=Numerics(threads=1), **mesh)
            PackSolver(panel, velocities[0], 1e-6).run()  # compiled before
            shots = [absorbing(panel, v) for v in velocities]
            found.setdefault(cloth, {})[name] = {"elements": panel.elements, "shots": shots}
            print(cloth, name, json.dumps(found[cloth][name]), flush=True)
    return found


def absorbing(panel, strike_velocity):
    """`shot` with the energy that the cloth has taken."""
    found = shot(panel, strike_velocity)
    mass, left = panel.projectile.mass, found["residual_velocity"]
    return found | {"absorbed_J": 0.5 * mass * (strike_velocity**2 - left * abs(left))}


def fitting(panel):
    """The zones of which the first holds all of the fabric that comes under the nose, with their names."""
    found = []
    for name, zones in ZONES.items():
        try:
            replace(panel, grading=zones)
            found.append((name, zones))
        except InputError as problem:
            print(name, problem, flush=True)
    return found


def shots(panel, velocities):
    """Both shots on every panel."""
    found = {}
    for name, zones in fitting(panel):
        graded = replace(panel, grading=zones)
        PackSolver(graded, velocities[0], 1e-6).run()  # compiled before
        found[name] = {"elements": graded.elements, "shots": [shot(graded, v) for v in velocities]}
        print(name, json.dumps(found[name]), flush=True)
    return found


def pack_shot(pack, strike_velocity):
    """One shot at a pack to its end: what comes of it and its CPU time."""
    costs = []
    for _ in range(2):
        begun = time.process_time()
        solver = PackSolver(pack, strike_velocity, 600e-6).run()
        costs.append(time.process_time() - begun)
    return {
        "outcome": solver.outcome,
        "time_us": 1e6 * solver.time,
        "residual_velocity": float(solver.sample("v")[-1]),
        "deflection_mm": 1e3 * float(solver.ply_sample("deflection").max()),
        "peak_N": [float(peak) for peak in solver.peak_tensions[..., 0].max(axis=0)],
        "failed_by_ply": [float(count) for count in solver.ply_sample("cut_yarns")[-1]],
        "deepest": float(solver.deepest.max()),
        "balance": float(np.abs(solver.sample("error")).max() / solver.strike_energy),
        "cpu_s": min(costs),
    }


def pack_shots():
    """Both shots at a pack of every grading."""
    name, plies, velocities = PACK
    fabric = catalogue.load(name).with_effective_density()
    panel, found = Panel(CellModel(fabric).table(201), numerics=Numerics(threads=1)), {}
    for zones in PACK_ZONES:
        pack = Pack.stacked(replace(panel, grading=ZONES[zones]), plies)
        PackSolver(pack, velocities[0], 1e-6).run()  # compiled before
        found[zones] = {
            "elements": pack.elements,
            "shots": [pack_shot(pack, v) for v in velocities],
        }
        print(zones, json.dumps(found[zones]), flush=True)
    return found


def limits(panel):
    """The critical velocity of every panel and the CPU time of its bisection."""
    found = {}
    for name, zones in fitting(panel):
        begun = time.process_time()
        limit = critical_velocity(replace(panel, grading=zones), tolerance=0.5)
        found[name] = {"critical_velocity": limit.velocity, "cpu_s": time.process_time() - begun}
        print(name, json.dumps(found[name]), flush=True)
    return found


def straight_table(fabric):
    """The table of a cell of straight yarns that hardly have a weft."""
    warp = replace(fabric.weave.warp, crimp=0.0)
    weft = replace(warp, linear_density=1e-6 * warp.linear_density)
    model = CellModel(
        replace(fabric, weave=replace(fabric.weave, warp=warp, weft=weft), shear=None),
        cell_model="decoupled",
    )
    return model.table(201)


def behind(table, zones, crossovers):
    """Share of the kinetic energy of a pulse that is found before the zones' border once it should be through."""
    edge = ("clamped", "free")
    numerics = Numerics(stretch_viscosity=0.0, threads=1)
    panel = Panel(
        table, (0.8, 0.0203), boundary=edge, yarn_failure=False, grading=zones, numerics=numerics
    )
    solver = PackSolver(panel, 1.0, 1.0)
    state, const, solver.exchange = solver.state, solver.const, np.inf  # no checks of the energy
    state.projectile_position[2] = -1.0
    state.first_row = 0
    state.end_row = const.ni
    X, weave, d = panel.coordinates()[0], panel.weave, 2 * panel.weave.w1
    if zones is not None and zones[0][1] < 1:  # a pulse is as many of the smallest elements long
        crossovers *= zones[0][1]
    speed = (weave.warp.EA * weave.warp_count / weave.areal_density) ** 0.5
    start, half, k = 50 * d, 0.5 * crossovers * d, np.pi / (crossovers * d)
    at = lambda x: np.clip(x - start, -half, half)  # noqa: E731
    state.u[0][: X.size] = (0.01 * X + 1e-6 * np.cos(k * at(X)) ** 2).ravel()
    state.v[0][: X.size] = (
        speed * 1e-6 * k * np.sin(2 * k * at(X + 0.5 * speed * const.dt))
    ).ravel()
    ply_kernels.initial_forces(state, const, panel.work())
    solver.advance(np.empty((int((100 + crossovers) * d / speed / const.dt), 3)))
    kinetic = (state.mass[: X.size] * state.v[0][: X.size] ** 2).reshape(X.shape).sum(axis=1)
    return float(kinetic[X[:, 0] < 99 * d].sum() / kinetic.sum())


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parts = ("shots", "limit", "waves", "pack", "refined")
    arguments.add_argument("--fabric", default="S-720", choices=SHOTS)
    arguments.add_argument("--parts", nargs="+", choices=parts, default=parts)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    fabric = catalogue.load(chosen.fabric).with_effective_density()
    panel = Panel(CellModel(fabric).table(201), numerics=Numerics(threads=1))
    report = {"machine": machine(), "fabric": chosen.fabric}
    if "waves" in chosen.parts:
        table = straight_table(fabric)
        report["waves"] = {
            name: {length: behind(table, zones, length) for length in LENGTHS}
            for name, zones in PULSES.items()
        }
    if "shots" in chosen.parts:
        report["shots"] = shots(panel, SHOTS[chosen.fabric])
    if "limit" in chosen.parts:
        report["limit"] = limits(panel)
    if "pack" in chosen.parts:
        report["pack"] = pack_shots()
    if "refined" in chosen.parts:
        report["refined"] = refined_shots()
    publish(report, chosen.out)


if __name__ == "__main__":
    main()
