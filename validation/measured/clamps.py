"""One ply whose yarns slide at the crossovers and in the clamps (clamps.toml): outcomes, and slip at the clamps."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from itertools import product

import numpy as np

from shellfabric.sliding.model import grid
from shellfabric.solver.pack_solver import PackSolver
from validation.measured.rows import HERE, Case, case_of
from validation.values import Values

END_TIME = "3 ms"


def shots() -> list[tuple[Values, Case]]:
    """(what is varied with the outcome of the test, the case) of all shots."""
    found = []
    for group in tomllib.loads((HERE / "clamps.toml").read_text("utf-8"))["shots"]:
        shots_of_test = zip(group["velocities"], group["tested"])
        varied = product(group["friction"], group["aims"], group["clamps"], shots_of_test)
        for mu, aim, force, (velocity, tested) in varied:
            changes = {
                "projectile.strike_velocity": f"{velocity} m/s",
                "panel.crossovers": "sliding",
                "panel.crossover_friction": f"{mu}",
                "panel.symmetry": "whole",
                "panel.boundary": "clamped"
                if force == "rigid"
                else f'{{ clamp_force = "{force} N" }}',
                "run.end_time": END_TIME,
            }
            changes |= {"panel.impact_point": '["0 mm", "0 mm"]'} if aim == "on" else {}
            case = case_of("", group["input"], tuple(changes.items()))
            row = {
                "input": group["input"],
                "friction": mu,
                "clamp [N]": force,
                "struck": aim,
                "velocity": velocity,
            }
            found.append((row | {"tested": tested}, case))
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
        "error": 100 * float(np.abs(solver.sample("error")).max()) / solver.strike_energy,
    }


def settings(varied: Sequence[Values], shots: Sequence[Values]) -> list[Values]:
    """A row a setting: tests met, energy error, and of each velocity outcome and slip at the clamps."""
    found: dict[str, Values] = {}
    for row, shot in zip(varied, shots):
        setting = {key: row[key] for key in ("input", "friction", "clamp [N]", "struck")}
        one = found.setdefault(repr(setting), setting | {"tests met": 0})
        left = ""
        if shot["outcome"] == "perforated":
            left = f", {shot['residual_velocity']:.0f} m/s left"
        one["tests met"] += shot["outcome"] == row["tested"]
        one[f"{row['velocity']} m/s"] = f"{shot['outcome']}{left}"
        one[f"slip at {row['velocity']} m/s, warp / weft [mm]"] = [
            round(slip, 2) for slip in shot["slip"]
        ]
        one["energy error [%]"] = max(shot["error"], one.get("energy error [%]", 0.0))
    return list(found.values())
