"""The weave in its own cell: stretched biaxially and sheared in its plane (thesis section 4.3.2).

Shear turns the yarns against each other at constant distances along each, as a picture frame does: the end
displacements d1, d2 are those of the beginning, so the yarns have the tension that the user's stretch gives them. Ends
and sides go with the trellis, contact is frictionless: what resists is the compaction of the yarns alone, where each is
squeezed under the other's arch, and where parallel neighbours meet edge to edge.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.record import Record, columns
from meshing.crossover import Crossover
from meshing.patch import Patch
from unitcell3d.model.crossover import Numerics
from unitcell3d.model.periodic_cell import CellLoad, CellModel
from unitcell3d.solver import path_following
from unitcell3d.solver.load_stepping import Hook

MEANINGS = {
    "path": "[-] share of the path",
    "d1": "[m] end displacement of the warp, per end of a crossing",
    "d2": "[m] the same of the weft",
    "gamma": "[rad] shear angle between the yarns",
    "T1": "[N] tension of a warp",
    "T2": "[N] tension of a weft",
    "moment": "[N m] per crossing, conjugate to gamma",
    "tau": "[Pa] moment over cell area and shell thickness",
    "F_c": "[N] contact force of a crossing",
    "F_side": "(n, 2) [N] contact force of a warp, of a weft, with its parallel neighbour",
    "side_gap": "(n, 2) [m] between the edges of parallel warps, of wefts; infinite where they do not pass each other",
    "thickness": "[m] from the lowest to the highest node",
    "deepest": "[m] largest penetration",
    "fibre_strain_mean": "(n, 2) [-] of the fibres of warp and weft",
    "fibre_strain_max": "(n, 2) [-] of the worst whole fibre of warp and weft",
    "broken": "[-] share of the fibre bars that has failed",
    "iterations": "[-] tangents factorised",
    "seconds": "[s] wall time",
}
STEEPEST = 1.2  # rad: beyond it the trellis is all but closed
ROWS_TO_STRETCH = 6


def shear(
    mesh: Crossover | Patch,
    fabric: Fabric,
    gamma: float = 0.6,
    *,
    stretch: Sequence[float] = (0.0, 0.0),
    numerics: Numerics | None = None,
    rows: int = 30,
    failure: bool = False,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Shear the weave to the angle `gamma` [rad], after stretching it by `stretch` : (d1, d2) [m] per end.

    Parameters
    ----------
    mesh : meshing.crossover.Crossover, a whole one, or meshing.patch.Patch of 2 x 2
    fabric : Fabric
    numerics, failure : as of a `model.crossover.YarnsModel`
    rows, hooks : see `path_following.follow`

    Returns
    -------
    Record, with the meanings `MEANINGS`

    Raises
    ------
    InputError : another mesh, or an angle that is not allowed
    """
    if not 0 < gamma <= STEEPEST:
        raise InputError(key="gamma", value=gamma, allowed=f"above 0 and at most {STEEPEST} rad")
    model = CellModel(mesh, fabric, numerics, failure=failure)
    d = tuple(float(part) for part in stretch)
    loads, counts = [CellLoad(model.w)], []
    if any(d):
        loads.append(CellLoad(model.w, d))
        counts.append(ROWS_TO_STRETCH)
    loads.append(CellLoad(model.w, d, float(gamma)))
    return _followed(model, loads, [*counts, rows], "shear", hooks)


def biaxial(
    mesh: Crossover | Patch,
    fabric: Fabric,
    d: Sequence[float],
    *,
    numerics: Numerics | None = None,
    rows: int = 20,
    failure: bool = False,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Stretch the weave in its own cell to the end displacements `d` : (2,) [m]; parameters as of `shear`."""
    model = CellModel(mesh, fabric, numerics, failure=failure)
    loads = [CellLoad(model.w), CellLoad(model.w, tuple(map(float, d)))]
    return _followed(model, loads, [rows], "cell biaxial", hooks)


def _followed(model, loads, counts, case, hooks):
    fabric = model.fabric
    smeared = fabric.weave.cell_area * fabric.weave.thickness
    families = np.asarray(model.crossover.families)

    def row(state, load):
        x = model.positions(state.q, load)
        strains, means = model.fibre_strains(x)
        worst, pairs = model.fibres.worst(strains), model.surfaces
        moment = model.moment(state.forces, load)
        side = pairs.forces[pairs.crossings :].reshape(2, -1)
        T1, T2 = model.tensions(state.forces, load)
        return {
            "d1": load.d[0],
            "d2": load.d[1],
            "gamma": load.gamma,
            "T1": T1,
            "T2": T2,
            "moment": moment,
            "tau": moment / smeared,
            "F_c": float(np.mean(np.abs(pairs.forces[: pairs.crossings]))),
            "F_side": side.mean(axis=1),
            "side_gap": np.array(
                [min(float(pair.gaps[0][0]) for pair in of) for of in _by_family(pairs)]
            ),
            "thickness": model.thickness(x),
            "deepest": pairs.deepest,
            "fibre_strain_mean": np.array([means[families == family].mean() for family in (0, 1)]),
            "fibre_strain_max": np.array([worst[families == family].max() for family in (0, 1)]),
            "broken": float(np.mean(model.fibres.damage > 0)),
        }

    found = path_following.follow(model, loads, row, rows=counts, hooks=hooks)
    u = (found.x - model.points)[: len(model.crossover.points)]
    facts = {
        "fabric": fabric.name,
        "case": case,
        "crossings": model.crossings,
        "cell_area": fabric.weave.cell_area,
        "shell_thickness": fabric.weave.thickness,
        "width": [2 * section.half_width for section in model.crossover.sections],
        "spacing": [2 * w for w in model.w[::-1]],
    }
    return Record(columns(found.rows), MEANINGS, facts, {"u": u}, found.failed)


def _by_family(pairs):
    """The pairs of parallel neighbours: of warps, of wefts."""
    edges = pairs.pairs[pairs.crossings :]
    half = len(edges) // 2
    return edges[:half], edges[half:]
