"""The computations of packs of 3D crossovers that checks share: see `runs`. They need dolfinx and gmsh."""

from __future__ import annotations

import numpy as np

from fabrics import catalogue
from validation.claims.registry import RunResult

ROWS = 30  # of the loading, and of the unloading


def released(
    *, fabric: str, plies: int, friction: float, closed: float, size: tuple[int, int, int] = (4, 3, 2)
) -> RunResult:
    """Aligned plies between plates that close and open again: closure [m] and pressure [Pa] of both branches.

    Parameters
    ----------
    fabric, plies : name, number
    friction : [-] Coulomb's coefficient between yarns, and between yarns and plates
    closed : [-] share of the first distance of the plates by which they close
    size : of the mesh of a quarter yarn
    """
    from meshing import crossover as mesher
    from unitcell3d.cases.stack import StackModel
    from unitcell3d.model.crossover import Load, Numerics
    from unitcell3d.solver import path_following

    given = catalogue.load(fabric)
    model = StackModel(mesher.build(given, size=tuple(size)), given, plies, Numerics(friction=friction))
    rest, area = model.plates.at_rest, given.weave.cell_area

    def row(state, load):
        force = model.copies[1] * float(np.mean(state.plates))
        return {"closure": 2 * (rest - load.plates), "pressure": force / area}

    loads = [Load(plates=share * rest) for share in (1.0, 1.0 - closed, 1.0)]
    found = path_following.follow(model, loads, row, rows=(ROWS, ROWS))
    closure, pressure = (np.array([row[key] for row in found.rows]) for key in ("closure", "pressure"))
    turn = int(np.argmax(closure))
    return {
        "loading": np.array([closure[: turn + 1], pressure[: turn + 1]]),
        "unloading": np.array([closure[turn:], pressure[turn:]]),
        "failed": found.failed,
    }


# name: (function, rough cost, to begin with the longest)
RUNS = {"released": (released, 25)}
