"""One ply whose yarns slide at the crossovers and in the clamps (clamps.toml): outcomes, and slip at the clamps."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from itertools import product

import numpy as np

from shellfabric.sliding.model import grid
from shellfabric.solver.pack_solver import PackSolver
from validation.measured.rows import HERE, Case, case_of
from validation.values import Values, largest

END_TIME = "3 ms"


def shots() -> list[tuple[Values, Case]]:
    """(what is varied with the outcome of the test, the case) of all shots."""
    found = []
    for group in tomllib.loads((HERE / "clamps.toml").read_text("utf-8"))["shots"]:
        of_test = zip(group["velocities"], group["tested"])
        varied = product(group["friction"], group["aims"], group["clamps"], of_test)
        for friction, aim, force, (velocity, tested) in varied:
            boundary = f'{{ clamp_force = "{force} N" }}'
            if force == "rigid":
                boundary = "clamped"
            changes = {
                "projectile.strike_velocity": f"{velocity} m/s",
                "panel.crossovers": "sliding",
                "panel.crossover_friction": f"{friction}",
                "panel.symmetry": "whole",
                "panel.boundary": boundary,
                "run.end_time": END_TIME,
            }
            if aim == "on":
                changes["panel.impact_point"] = '["0 mm", "0 mm"]'
            row = {
                "input": group["input"],
                "friction": friction,
                "clamp [N]": force,
                "struck": aim,
                "velocity": velocity,
                "tested": tested,
            }
            found.append((row, case_of("", group["input"], tuple(changes.items()))))
    return found


def fire(case: Case) -> Values:
    """One shot: outcome, residual velocity, largest slip of warp and weft at the clamps, deflection, energy error."""
    setup = case.setup()
    solver = PackSolver(setup.target(), setup.strike_velocity, setup.end_time).run()
    warp, weft = (np.abs(grid(passed, solver.panel)) for passed in solver.passed_lengths(0))
    return {
        "outcome": solver.outcome,
        "residual_velocity": solver.residual_velocity,
        "slip": [1e3 * float(warp[[0, -1]].max()), 1e3 * float(weft[:, [0, -1]].max())],
        "error": 100 * largest(solver.sample("error")) / solver.strike_energy,
    }


def settings(shots: Sequence[tuple[Values, Values]]) -> list[Values]:
    """A row a setting: tests met, energy error, and of each velocity outcome and slip at the clamps.

    shots : what is varied, and what `fire` returns
    """
    found: dict[str, Values] = {}
    for varied, shot in shots:
        setting = {key: varied[key] for key in ("input", "friction", "clamp [N]", "struck")}
        row = found.setdefault(repr(setting), setting | {"tests met": 0})
        velocity = f"{varied['velocity']} m/s"
        outcome = shot["outcome"]
        row["tests met"] += outcome == varied["tested"]
        row[velocity] = outcome
        if outcome == "perforated":
            row[velocity] += f", {shot['residual_velocity']:.0f} m/s left"
        slips = [round(slip, 2) for slip in shot["slip"]]
        row[f"slip at {velocity}, warp / weft [mm]"] = slips
        row["energy error [%]"] = max(shot["error"], row.get("energy error [%]", 0.0))
    return list(found.values())
