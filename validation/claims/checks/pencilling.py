"""Pencilling: depth and shape of the crater behind light and heavy targets (thesis section 6.5, Table 6-2).

The plies are free at their edges: section 6.5 links pencilling to the in-plane mobility of plies that bunch up around
the projectile, which clamped plies are kept from. `edge` "clamped" gives the other case.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from validation.claims.registry import Found, Run, RunResult, check
from validation.claims.runs import cloth
from validation.published.pencilling.study import FABRIC, Case, march

CASES = {1: (1, 5.0, 1.155), 2: (1, 1.0, 1.155), 3: (1, 5.0, 0.231), 4: (1, 1.0, 0.231), 5: (4, 1.0, 1.155)}


def case(number: int, edge: str = "free", mass: None = None, **changes: Any) -> Run:
    """A run of Table 6-2; 0 is the bare block. `mass` [kg/m2] in all instead of the table's."""
    if number not in CASES:
        return Run.of("pencil", plies=0, modulus=1.0, mass=0.0)
    plies, modulus, listed = CASES[number]
    return Run.of("pencil", plies=plies, modulus=modulus, mass=mass or listed, edge=edge, **changes)


def _cases(*numbers):
    return lambda edge="free", mass=None: {f"case{n}": case(n, edge, mass) for n in numbers}


@check(lambda number, edge="free": {"run": case(number, edge)})
def completes(run: RunResult, number: int, edge: str = "free") -> Found:
    """Whether a run comes to its end, and mass and modulus of the plies that it marches."""
    plies = march(Case(*CASES[number]), edge=edge).pack.plies
    weight = sum(ply.masses().sum() / np.prod([n * d for n, d in zip(ply.counts, ply.spacing)]) for ply in plies)
    return {
        "completes": run["outcome"] == "stopped",
        "balance": run["balance"],
        "areal density of the plies": float(weight),
        "stiffness over S-728": plies[0].fabric.weave.warp.EA / cloth(FABRIC).weave.warp.EA,
        "note": f"{1e3 * run['depth']:.1f} mm deep after {1e6 * run['t'][-1]:.0f} us; wall at "
        f"{np.degrees(run['steepness']):.0f} degrees; balance {100 * run['balance']:.2f} %",
    }


@check(_cases(0, 1, 2, 5))
def equal_mass(
    case0: RunResult,
    case1: RunResult,
    case2: RunResult,
    case5: RunResult,
    edge: str = "free",
    mass: float | None = None,
) -> Found:
    depth = {n: run["depth"] for n, run in ((0, case0), (1, case1), (2, case2), (5, case5))}
    return {
        "one ply over four, stiff": depth[1] / depth[5],
        "one ply over four": depth[2] / depth[5],
        "bare over one ply": depth[0] / depth[2],
        "note": "bare, 1, 2, 5: " + ", ".join(f"{1e3 * value:.1f}" for value in depth.values()) + " mm",
    }


@check(_cases(3, 4, 5))
def light(case3: RunResult, case4: RunResult, case5: RunResult, edge: str = "free") -> Found:
    depth = [run["depth"] for run in (case3, case4, case5)]
    return {
        "light, stiff, over four plies": depth[0] / depth[2],
        "light over four plies": depth[1] / depth[2],
        "note": "3, 4, 5: " + ", ".join(f"{1e3 * value:.1f}" for value in depth) + " mm",
    }


@check(_cases(1, 2, 4))
def mass_over_modulus(case1: RunResult, case2: RunResult, case4: RunResult, edge: str = "free") -> Found:
    mass, modulus = abs(case4["depth"] - case2["depth"]), abs(case2["depth"] - case1["depth"])
    return {
        "mass less modulus": mass - modulus,
        "note": f"{1e3 * mass:.1f} mm by the mass, {1e3 * modulus:.1f} mm by the modulus",
    }


@check(_cases(4, 5))
def steeper(case4: RunResult, case5: RunResult, edge: str = "free") -> Found:
    return {
        "difference of the walls": case4["steepness"] - case5["steepness"],
        "note": f"walls at {np.degrees(case4['steepness']):.0f} and {np.degrees(case5['steepness']):.0f} degrees; "
        f"{1e3 * case4['half_width']:.1f} and {1e3 * case5['half_width']:.1f} mm to half depth",
    }


@check(lambda number: {edge: case(number, edge) for edge in ("free", "clamped")})
def constrained(free: RunResult, clamped: RunResult, number: int) -> Found:
    """Depth and wall of the crater behind plies that are held in their plane at the edges, over free ones."""
    return {
        "depth, clamped over free": clamped["depth"] / free["depth"],
        "wall, clamped less free": clamped["steepness"] - free["steepness"],
        "note": f"{1e3 * clamped['depth']:.1f} and {1e3 * free['depth']:.1f} mm deep; walls at "
        f"{np.degrees(clamped['steepness']):.0f} and {np.degrees(free['steepness']):.0f} degrees",
    }


@check(lambda number, factor: {"same": case(number), "layer": case(number, layer=factor)})
def shear_layer(same: RunResult, layer: RunResult, number: int, factor: float) -> Found:
    """Wall of the crater with a ply next to the block that touches and locks at `factor` times the shear angles."""
    return {
        "change of the wall": layer["steepness"] - same["steepness"],
        "note": f"walls at {np.degrees(layer['steepness']):.1f} and {np.degrees(same['steepness']):.1f} degrees, "
        f"{1e3 * layer['depth']:.2f} and {1e3 * same['depth']:.2f} mm deep with and without the layer",
    }
