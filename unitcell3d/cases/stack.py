"""Plies of one crossover on each other between two rigid plates (thesis sections 2.2.1 and 3.4.3.2).

"aligned" plies stand crossing on crossing, the warp of each ply under the weft of the next: the pack then has the
symmetries of one ply (two mirror planes, and the two-fold axis at the middle of the pack, which turns ply p into ply
N + 1 - p), so that a quarter of a crossover is enough. The plates stand at equal distances above and below the middle.

Between plies the lower face of each weft meets the upper face of the warp under it, with the contact of a crossover.
"shifted" plies have no such symmetry (`model.shifted_stack`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from fabrics.plate_curve import PLATEN_PRESSURE, PlateCurve
from fabrics.record import Record, columns
from meshing.crossover import Crossover
from meshing.patch import Patch
from unitcell3d.assembly import constraints
from unitcell3d.cases.biaxial_and_platens import MIN_PLATE_GAP
from unitcell3d.contact.pairs import OuterPlates, SurfacePairs, facing
from unitcell3d.model import submeshes
from unitcell3d.model.crossover import Load, Numerics, YarnsModel, check
from unitcell3d.model.periodic_cell import CellLoad
from unitcell3d.model.shifted_stack import ShiftedModel
from unitcell3d.solver import path_following
from unitcell3d.solver.load_stepping import Hook

MEANINGS = {
    "path": "[-] share of the path",
    "distance": "[m] of the plates",
    "closure": "[m] by which they have approached since they touched",
    "closure_ply": "[m] of it in each ply",
    "force": "[N] on a plate, per crossover",
    "pressure": "[Pa] on the area of the cell",
    "F_c": "(n, plies) [N] contact force of each ply's crossing, the lowest first",
    "F_between": "(n, plies - 1) [N] contact force between plies",
    "deepest": "[m] largest penetration",
    "iterations": "[-] tangents factorised",
    "seconds": "[s] wall time",
}

LONGEST_STEP = 6e-6  # m between the plates: in steps of 22 um slack plies pass through each other


class StackModel(YarnsModel):
    """Aligned plies of a quarter crossover between plates.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover, a quarter
    fabric : Fabric
    plies : number
    numerics : model.crossover.Numerics

    Raises
    ------
    InputError : another domain
    """

    def __init__(
        self, crossover: Crossover, fabric: Fabric, plies: int, numerics: Numerics | None = None
    ) -> None:
        check(crossover, fabric)
        if crossover.domain != "quarter":
            raise InputError(
                key="domain", value=crossover.domain, allowed="quarter: aligned plies are symmetric"
            )
        pitch = np.ptp(crossover.points[:, 2])
        mesh = submeshes.stacked(
            crossover, [(0.0, 0.0, (ply - (plies - 1) / 2) * pitch) for ply in range(plies)]
        )
        points = np.ascontiguousarray(mesh.points)
        warps, wefts = mesh.grids[0::2], mesh.grids[1::2]
        crossings = [facing(points, warp, weft, True) for warp, weft in zip(warps, wefts)]
        between = [
            facing(points, weft, warp, True, families=(1, 0))
            for warp, weft in zip(warps, wefts[1:])
        ]
        opposite = [2 * (plies - 1 - ply) + family for ply in range(plies) for family in (0, 1)]
        held = constraints.build(
            mesh.grids, len(points), quarter=True, families=mesh.families, opposite=opposite
        )
        plates = OuterPlates(points, [warps[-1]], [wefts[0]])
        self.plies = plies
        super().__init__(
            mesh,
            fabric,
            numerics,
            held,
            SurfacePairs(crossings + between),
            plates,
            copies=(2.0, 4.0),
        )


def stack_compression(
    mesh: Crossover | Patch,
    fabric: Fabric,
    plies: int = 2,
    *,
    shift: Sequence[float] = (0.0, 0.0),
    pressure: float = PLATEN_PRESSURE,
    min_plate_gap: float = MIN_PLATE_GAP,
    numerics: Numerics | None = None,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Press plies between two rigid plates, the yarns' ends held in the plane at their spacing.

    Parameters
    ----------
    mesh : meshing.crossover.Crossover, a quarter, for aligned plies; meshing.patch.Patch of 2 x 2 for shifted ones
    fabric : Fabric
    plies : number
    shift : (x, y) [crossings] of each ply against the one under it; (0, 0): aligned
    pressure : [Pa] mean on the area of the cell at the end, by default the greatest of the thesis
    min_plate_gap : [-] share of the first distance of the plates at which the path ends at the latest
    numerics, hooks : see `path_following.follow`

    Returns
    -------
    Record, with the meanings `MEANINGS`; the path also ends, as failed, where plates have closed by a tenth and press
    nothing

    Raises
    ------
    InputError : a value is not allowed
    """
    if not pressure > 0:
        raise InputError(key="pressure", value=pressure, allowed="positive")
    if not 0 < min_plate_gap < 1:
        raise InputError(key="min_plate_gap", value=min_plate_gap, allowed="between 0 and 1")
    if not (isinstance(plies, int | np.integer) and plies >= 1):
        raise InputError(key="plies", value=plies, allowed="a whole number from 1 on")
    model, load = _model(mesh, fabric, plies, shift, numerics)
    rest, area = model.plates.at_rest, fabric.weave.cell_area
    loads = [replace(load, plates=share * rest) for share in (1.0, min_plate_gap)]
    rows = int(np.ceil(2 * (1 - min_plate_gap) * rest / LONGEST_STEP))
    found = path_following.follow(
        model,
        loads,
        lambda state, load: _row(model, plies, area, state, load),
        rows=rows,
        stop=lambda row: row["pressure"] / pressure,
        hooks=hooks,
    )
    u = (found.x - model.points)[: len(model.crossover.points)]
    stacking = f"shifted by {shift[0]:g}, {shift[1]:g} crossings" if any(shift) else "aligned"
    facts = {
        "fabric": fabric.name,
        "case": f"{plies} plies, {stacking}",
        "plies": plies,
        "stacking": stacking,
        "shift": list(shift),
        "cell_area": area,
    }
    return Record(columns(found.rows), MEANINGS, facts, {"u": u}, found.failed)


def _model(mesh, fabric, plies, shift, numerics):
    """The model of aligned or shifted plies, and its load without plates."""
    if any(shift):
        return ShiftedModel(mesh, fabric, plies, shift, numerics), CellLoad(mesh.w)
    return StackModel(mesh, fabric, plies, numerics), Load()


def _row(model, plies, area, state, load):
    shifted = isinstance(model, ShiftedModel)
    copies, inside = (1 / model.crossings, model.inside) if shifted else (model.copies[1], plies)
    rest, pairs = model.plates.at_rest, copies * model.surfaces.forces
    force = copies * float(np.mean(state.plates))
    if force <= 0 and load.plates < 0.9 * rest:
        raise UnstableError(
            "the yarns have passed through each other",
            when=f"plates {2e3 * load.plates:.4g} mm apart",
        )
    return {
        "distance": 2 * load.plates,
        "closure": 2 * (rest - load.plates),
        "closure_ply": 2 * (rest - load.plates) / plies,
        "force": force,
        "pressure": force / area,
        "F_c": pairs[:inside].reshape(plies, -1).sum(axis=1),
        "F_between": pairs[inside:].reshape(plies - 1, -1).sum(axis=1)
        if plies > 1
        else np.zeros(0),
        "deepest": model.surfaces.deepest,
    }


def law_closure(fabric: Fabric, record: Record) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The pressure law of the thesis beside a record: what one pack of as many plies closes since its first pressure.

    Returns
    -------
    pressure, closure_law, closure : [Pa], [m], [m] of the rows inside the law's pressures, closures from its first on

    Raises
    ------
    InputError : the fabric has no measured areal density
    """
    if fabric.areal_density_measured is None:
        raise InputError(
            f"fabric {fabric.name} has no measured areal density, which the pressure law needs"
        )
    law = PlateCurve.pressure_law(fabric.areal_density_measured, int(record.facts["plies"]))
    P, c = record["pressure"], record["closure"]
    rising = np.concatenate([[True], P[1:] > np.maximum.accumulate(P)[:-1]]) & (P > 0)
    first = np.interp(np.log(law.pressure[0]), np.log(P[rising]), c[rising])
    inside = rising & (law.pressure[0] <= P) & (law.pressure[-1] >= P)
    return P[inside], law.at(P[inside]), c[inside] - first
