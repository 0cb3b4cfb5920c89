"""The runs: one yarn of S-720 pulled through the crossover, one choice changed at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.friction.pull_out import FRICTION, FRICTION_RANGE, PullOutLaw
from meshing import crossover
from unitcell3d.cases import pull_out
from unitcell3d.model.crossover import Numerics


@dataclass(frozen=True)
class Case:
    """One run.

    Parameters
    ----------
    fabric : name
    pulled : 0 pulls the warp, 1 the weft
    friction : [-] Coulomb's coefficient
    size : hexahedra along, across and through a quarter of each yarn
    loads : of the largest end displacement of the crossing yarn
    rows : states along the pull
    slip : [m] over which friction sets in
    pressures : [Pa] of platens, in place of the end displacements; () for none
    """

    fabric: str = "S-720"
    pulled: int = 0
    friction: float = FRICTION
    size: tuple[int, int, int] = (8, 6, 2)
    loads: tuple[float, ...] = (1.0,)
    rows: int = pull_out.ROWS
    slip: float = Numerics.slip
    pressures: tuple[float, ...] = ()


BASE = Case()
LAW = replace(BASE, loads=pull_out.LOADS)
WEFT = replace(LAW, pulled=1, loads=(0.5, 1.0))
PLATENS = replace(BASE, loads=(), pressures=(1e6, 2e6, 4e6))
FRICTIONLESS = replace(BASE, friction=0.0)
FINER = replace(BASE, size=(10, 8, 3))
VARIANTS: dict[str, Case] = {
    f"friction {FRICTION_RANGE[0]:g}": replace(BASE, friction=FRICTION_RANGE[0]),
    f"friction {FRICTION_RANGE[1]:g}": replace(BASE, friction=FRICTION_RANGE[1]),
    "coarser mesh, 6 x 4 x 2": replace(BASE, size=(6, 4, 2)),
    "finer mesh, 10 x 8 x 3": FINER,
    "half the load step": replace(BASE, rows=2 * BASE.rows),
    "half the regularisation slip": replace(BASE, slip=0.5 * BASE.slip),
}


def run(case: Case) -> dict[str, Any]:
    """One run: a dict of numbers and lists, for a file."""
    fabric = catalogue.load(case.fabric)
    largest = pull_out.displacements(fabric, case.pulled)[-1] / pull_out.LOADS[-1]
    built = crossover.build(fabric, domain="whole", size=case.size)
    numerics = Numerics(friction=case.friction, slip=case.slip)
    record = pull_out.pull_out(
        built, fabric, [share * largest for share in case.loads], pressures=case.pressures, pulled=case.pulled,
        numerics=numerics, rows=case.rows,
    )  # fmt: skip
    F_c, T_f = pull_out.thresholds(record)
    paths = [record["load"] == number for number in np.unique(record["load"])]
    return {
        "F_c": F_c.tolist(),
        "T_f": T_f.tolist(),
        "geometric": [float(np.abs(record["P_geometric"][of]).max()) for of in paths],
        "mobilised": [float(record["mobilised"][of].max()) for of in paths],
        "pull": [record["pull"][of].tolist() for of in paths],
        "P": [record["P"][of].tolist() for of in paths],
        "force": [record["F_c"][of].tolist() for of in paths],
        "iterations": int(record["iterations"].sum()),
        "states": len(record["path"]),
        "seconds": float(record["seconds"].sum()),
        "failed": record.failed,
    }


def law(case: Case, found: dict[str, Any]) -> PullOutLaw:
    """The law fitted to a run."""
    return PullOutLaw.fit(found["F_c"], found["T_f"], friction=case.friction)


def gather(runs: Callable[[Case], dict[str, Any]]) -> dict[str, Any]:
    """All results of the study."""
    whole = runs(LAW)
    last = {key: whole[key][-1:] for key in ("F_c", "T_f", "mobilised", "pull")}
    return {
        "law": whole,
        "weft": runs(WEFT),
        "platens": runs(PLATENS),
        "frictionless": runs(FRICTIONLESS),
        "variants": {"as it stands": whole | last} | {name: runs(case) for name, case in VARIANTS.items()},
    }
