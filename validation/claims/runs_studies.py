"""The computations that checks share and that are runs of other studies, as `runs` has them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue
from meshing import patch
from validation.models.solid.model import SolidPatch
from validation.models.solid.solver import SolidSolver
from validation.published.pencilling.study import Case, bare, shoot

if TYPE_CHECKING:
    from validation.claims.registry import RunResult


def pencil(
    *, plies: int, modulus: float, mass: float, elements: int = 2, edge: str = "free", layer: Any = None
) -> RunResult:
    """One run of Table 6-2 before its block; without plies the block alone.

    Parameters
    ----------
    plies, modulus, mass : of `study.Case`
    elements, edge, layer : of `study.march`
    """
    found = bare() if plies == 0 else shoot(Case(plies, modulus, mass), elements=elements, edge=edge, layer=layer)
    return {
        "outcome": found.outcome,
        "depth": found.depth,
        "crater": found.crater,
        "steepness": found.steepness,
        "half_width": found.half_width,
        "balance": found.balance,
        "t": found.t,
        "z": found.z,
    }


def solids(*, fabric: str, velocity: float, count: int, time: float) -> RunResult:
    """A patch of solid yarns under impact: seconds of marching, its mass before and after, and what has failed."""
    given = catalogue.load(fabric)
    mesh = patch.build(given, (count, count), size=(5, 5, 2))
    run = SolidSolver(SolidPatch(mesh, given), velocity, time, threads=1)
    before = float(run.const.mass.sum())
    run.run()
    after = float(run.const.mass.sum())
    side = count / run.patch.fabric.weave.warp_count
    return {
        "seconds": run.wall_time,
        "time": run.time,
        "side": side,
        "mass": np.array([before, after]),
        "failed_bars": float(run.sample("failed_bars")[-1]),
        "energies": {name: run.sample(name) for name in run.energy_names},
    }


# name: (function, rough cost, to begin with the longest)
RUNS = {"solids": (solids, 15), "pencil": (pencil, 90)}
