"""What is recorded of the states of a path: the meanings of all columns, and what every case of a
crossover has.

Index 0 is warp, 1 is weft. A column with several numbers a state has their number as its second
axis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fabrics.base.record import Record, columns
from unitcell3d.solver.newton import Equilibrium

MEANINGS = {
    "path": "[-] share of the path",
    "load": "[-] pull-out: number of the transverse load",
    "d": "[m] yarn: displacement of each end",
    "d1": "[m] end displacement of the warp, per end of a crossing",
    "d2": "[m] end displacement of the weft, per end of a crossing",
    "gamma": "[rad] shear angle between the yarns",
    "pull": "[m] displacement of the pulled yarn along its axis",
    "plates": "[m] half the distance of the platens; infinite without platens",
    "distance": "[m] stack: distance of the platens",
    "closure": "[m] stack: approach of the platens since they touched",
    "closure_ply": "[m] stack: closure of one ply",
    "strain": "[-] yarn: strain of the distance of the ends",
    "T": "[N] yarn: tension of the whole yarn",
    "T_taut": "[N] yarn: tension in closed form, without bending",
    "T1": "[N] tension of the whole warp, from the reactions; of a pulled yarn at the end that is pulled",
    "T2": "[N] tension of the whole weft, as T1",
    "P": "[N] axial force that the pulled yarn takes from the crossing yarn",
    "P_geometric": "[N] part of P that normal pressures take",
    "moment": "[N m] moment of a crossing, conjugate to gamma",
    "tau": "[Pa] moment over cell area and shell thickness",
    "force": "[N] stack: force on a platen, per crossover",
    "pressure": "[Pa] stack: force on the area of the cell",
    "F_c": "[N] contact force of a crossing; stack: (n, plies), the lowest ply first",
    "F_between": "(n, plies - 1) [N] stack: contact force between plies",
    "F_side": "(n, 2) [N] contact force of a warp, of a weft, with its parallel neighbour",
    "F_plate": "(n, 2) [N] force on the upper and the lower platen",
    "side_gap": "(n, 2) [m] between the edges of parallel warps, of wefts; infinite where they do not pass each other",
    "h": "[m] yarn: height of the centreline",
    "h1": "[m] height of the warp's centreline",
    "h2": "[m] height of the weft's centreline",
    "thickness": "[m] from the lowest to the highest node",
    "d_c": "[m] compression of one yarn, half of the loss of h1 + h2",
    "d_yarns": "(n, 2) [m] compression of each yarn by itself: what its axis has approached its contact face",
    "deepest": "[m] largest penetration",
    "mobilised": "[-] mobilised share of Coulomb's limit, 1 in full sliding",
    "fibre_strain_mean": "(n, yarns) [-] mean strain of the fibre bars of each yarn",
    "fibre_strain_max": "(n, yarns) [-] strain of the worst whole bar of each yarn; -1 if all have failed",
    "broken": "(n, yarns) [-] share of the fibre bars of each yarn that has failed; shear: of all yarns",
    "astray": "[m] yarn: amplitude of displacements that alternate from node to node along it",
    "iterations": "[-] tangents factorised",
    "seconds": "[s] wall time",
}


def record(
    rows: Sequence[Mapping[str, Any]],
    facts: Mapping[str, Any],
    last: Mapping[str, Any],
    failed: str,
) -> Record:
    """The Record of rows, dicts whose keys are names of `MEANINGS`."""
    found = columns(rows)
    meanings = {name: MEANINGS.get(name, "") for name in found}
    return Record(found, meanings, dict(facts), dict(last), failed)


def crossover_row(model: Any, state: Equilibrium, load: Any) -> dict[str, Any]:
    """Loads, tensions, contact forces, heights and compression of a crossover.

    Parameters
    ----------
    model : a model.crossover.YarnsModel with `heights`
    state : newton.Equilibrium
    load : of the model, with `d` and `plates`
    """
    rest = model.heights(model.points)
    heights = model.heights(model.positions(state.q, load))
    T1, T2 = model.tensions(state.forces)
    return {
        "d1": load.d[0],
        "d2": load.d[1],
        "plates": load.plates,
        "T1": T1,
        "T2": T2,
        "F_c": model.copies[1] * state.contact,
        "F_plate": model.copies[1] * state.plates,
        "h1": heights[0],
        "h2": heights[1],
        "d_c": 0.5 * (rest.sum() - heights.sum()),
    }


def fibre_row(model: Any, state: Equilibrium, load: Any) -> dict[str, Any]:
    """Strains of the fibres of warp and weft of a crossover, and what each yarn is compressed by
    itself."""
    x = model.positions(state.q, load)
    strains, means = model.fibre_strains(x)
    return {
        "d_yarns": model.half_thicknesses(model.points) - model.half_thicknesses(x),
        "fibre_strain_max": model.fibres.worst(strains),
        "fibre_strain_mean": means,
        "broken": model.fibres.broken(),
    }
