"""Plies of one crossover on each other between two rigid plates (thesis sections 2.2.1 and
3.4.3.2).

The plies stand crossing on crossing, the warp of each ply under the weft of the next: the pack then
has the symmetries of one ply (two mirror planes, and the two-fold axis at the middle of the pack,
which turns ply p into ply N + 1 - p), so that a quarter of a crossover is enough. The platens stand
at equal distances above and below the middle.

Between plies the lower face of each weft meets the upper face of the warp under it, with the
contact of a crossover.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from fabrics.plate_curve import PLATEN_PRESSURE, PlateCurve
from meshing.crossover import Crossover
from unitcell3d.assembly import constraints
from unitcell3d.cases.biaxial_and_platens import MIN_PLATE_GAP
from unitcell3d.contact.surfaces import Plates, SurfacePairs, facing
from unitcell3d.model import submeshes
from unitcell3d.model.crossover import Load, Numerics, YarnsModel, check
from unitcell3d.solver.path_following import Hook, follow

# m between the plates: in steps of 22 um slack plies pass through each other
LONGEST_STEP = 6e-6


class StackModel(YarnsModel):
    """Aligned plies of a quarter crossover between plates.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover, a quarter
    fabric : Fabric
    plies : number
    numerics : Numerics

    Raises
    ------
    InputError : another domain
    """

    plates: Plates

    def __init__(
        self, crossover: Crossover, fabric: Fabric, plies: int, numerics: Numerics | None = None
    ) -> None:
        check(crossover, fabric)
        if crossover.domain != "quarter":
            raise InputError(
                key="domain", value=crossover.domain, allowed="quarter: aligned plies are symmetric"
            )
        pitch = np.ptp(crossover.points[:, 2])
        mesh = submeshes.stacked(crossover, plies, pitch)
        points = np.ascontiguousarray(mesh.points)
        warps = mesh.grids[0::2]
        wefts = mesh.grids[1::2]
        crossings = [facing(points, warp, weft, True) for warp, weft in zip(warps, wefts)]
        between = [
            facing(points, weft, warp, True, families=(1, 0))
            for warp, weft in zip(warps, wefts[1:])
        ]
        opposite = [2 * (plies - 1 - ply) + family for ply in range(plies) for family in (0, 1)]
        held = constraints.build(
            mesh.grids, len(points), quarter=True, families=mesh.families, opposite=opposite
        )
        plates = Plates(points, [warps[-1][:, :, -1]], [wefts[0][:, :, 0]])
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
    mesh: Crossover,
    fabric: Fabric,
    plies: int = 2,
    *,
    pressure: float = PLATEN_PRESSURE,
    min_plate_gap: float = MIN_PLATE_GAP,
    numerics: Numerics | None = None,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Press plies between two rigid platens, the yarns' ends held in the plane at their spacing.

    Parameters
    ----------
    mesh : meshing.crossover.Crossover, a quarter
    fabric : Fabric
    plies : number
    pressure : [Pa] mean on the area of the cell at the end, by default the greatest of the thesis
    min_plate_gap : [-] share of the first distance of the platens at which the path ends at the
        latest
    numerics, hooks : see `path_following.follow`

    Returns
    ------- Record, with the columns of `recorded.MEANINGS` that belong to a stack; the path also
    ends, as failed, where platens have closed by a tenth and press nothing

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
    model = StackModel(mesh, fabric, plies, numerics)
    rest = model.plates.at_rest
    facts = {
        "case": f"{plies} plies",
        "plies": plies,
        "cell_area": fabric.weave.cell_area,
        "pressure_asked": float(pressure),
    }
    return follow(
        model,
        [Load(plates=rest), Load(plates=min_plate_gap * rest)],
        lambda state, load: _row(model, state, load),
        rows=int(np.ceil(2 * (1 - min_plate_gap) * rest / LONGEST_STEP)),
        stop=lambda row: row["pressure"] / pressure,
        facts=facts,
        hooks=hooks,
    )


def _row(model, state, load):
    rest = model.plates.at_rest
    plies = model.plies
    quarters = model.copies[1]
    force = quarters * float(np.mean(state.plates))
    if force <= 0 and load.plates < 0.9 * rest:
        raise UnstableError(
            "the yarns have passed through each other",
            when=f"plates {2e3 * load.plates:.4g} mm apart",
        )
    closure = 2 * (rest - load.plates)
    pairs = quarters * model.surfaces.forces
    return {
        "distance": 2 * load.plates,
        "closure": closure,
        "closure_ply": closure / plies,
        "force": force,
        "pressure": force / model.fabric.weave.cell_area,
        "F_c": pairs[:plies].copy(),
        "F_between": pairs[plies:].copy(),
        "deepest": model.surfaces.deepest,
    }


def law_closure(fabric: Fabric, record: Record) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Compute the pressure law of the thesis beside a record: what one pack of as many plies closes
    since its first pressure.

    Returns
    -------
    pressure, closure_law, closure : [Pa], [m], [m] of the rows inside the law's pressures, closures
        from its first on

    Raises
    ------
    InputError : the fabric has no measured areal density
    """
    if fabric.areal_density_measured is None:
        raise InputError(
            f"fabric {fabric.name} has no measured areal density, which the pressure law needs"
        )
    law = PlateCurve.pressure_law(fabric.areal_density_measured, int(record.facts["plies"]))
    P = record["pressure"]
    c = record["closure"]
    rising = np.concatenate([[True], P[1:] > np.maximum.accumulate(P)[:-1]]) & (P > 0)
    first = np.interp(np.log(law.pressure[0]), np.log(P[rising]), c[rising])
    inside = rising & (law.pressure[0] <= P) & (law.pressure[-1] >= P)
    return P[inside], law.at(P[inside]), c[inside] - first
