"""The weave in its own cell: stretched biaxially and sheared in its plane (thesis section 4.3.2).

Shear turns the yarns against each other at constant distances along each, as a picture frame does:
the end displacements d1, d2 are those of the beginning, so the yarns have the tension that the
user's stretch gives them. Ends and sides go with the trellis, contact is frictionless: what resists
is the compaction of the yarns alone, where each is squeezed under the other's arch, and where
parallel neighbours meet edge to edge.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.base.errors import InputError
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from meshing.patch import Patch
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.model.crossover import Numerics
from unitcell3d.model.periodic_cell import CellLoad, CellModel
from unitcell3d.solver.path_following import Hook, follow

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
    """Shear the weave to the angle `gamma` [rad], after stretching it by `stretch` : (d1, d2) [m]
    per end.

    Parameters
    ----------
    mesh : meshing.crossover.Crossover, a whole one, or meshing.patch.Patch of 2 x 2
    fabric : Fabric
    numerics, failure : as in a `model.crossover.YarnsModel`
    rows, hooks : see `path_following.follow`

    Returns
    -------
    Record, with the columns of `recorded.MEANINGS` that belong to a cell

    Raises
    ------
    InputError : another mesh, or an angle that is not allowed
    """
    if not 0 < gamma <= STEEPEST:
        raise InputError(key="gamma", value=gamma, allowed=f"above 0 and at most {STEEPEST} rad")
    model = CellModel(mesh, fabric, numerics, failure=failure)
    d = tuple(float(part) for part in stretch)
    loads = [CellLoad(model.w)]
    counts = []
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
    """Stretch the weave in its own cell to the end displacements `d` : (2,) [m]; parameters as of
    `shear`."""
    model = CellModel(mesh, fabric, numerics, sheared=False, failure=failure)
    loads = [CellLoad(model.w), CellLoad(model.w, tuple(map(float, d)))]
    return _followed(model, loads, [rows], "cell biaxial", hooks)


def to_failure(
    mesh: Patch,
    fabric: Fabric,
    ratio: Sequence[float] = (1.0, 1.0),
    *,
    beyond: float = 1.0,
    pressed: float | None = None,
    numerics: Numerics | None = None,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Stretch the weave in its own cell until the mean fibre strain of a family is its failure strain;
    parameters as of `biaxial_and_platens.biaxial`."""
    model = CellModel(mesh, fabric, numerics, sheared=False)
    d, stop = biaxial_and_platens.path_to_failure(fabric, ratio, beyond, pressed)
    loads = [CellLoad(model.w), CellLoad(model.w, (float(d[0]), float(d[1])))]
    return _followed(model, loads, None, "cell to failure", hooks, stop)


def _followed(model, loads, counts, case, hooks, stop=None):
    fabric = model.fabric
    facts = {
        "case": case,
        "crossings": model.crossings,
        "cell_area": fabric.weave.cell_area,
        "shell_thickness": fabric.weave.thickness,
        "width": [2 * section.half_width for section in model.crossover.sections],
        "spacing": [2 * w for w in model.w[::-1]],
    }
    return follow(model, loads, _row(model), rows=counts, stop=stop, facts=facts, hooks=hooks)


def _row(model):
    """The function that records a state of a cell."""
    smeared = model.fabric.weave.cell_area * model.fabric.weave.thickness
    families = np.asarray(model.crossover.families)
    pairs = model.surfaces
    beside = model.beside
    acting = slice(model.crossings, model.crossings + len(beside))
    of = np.array([family for family, _ in beside])

    def row(state, load):
        x = model.positions(state.q, load)
        strains, means = model.fibre_strains(x)
        worst = model.fibres.worst(strains)
        moment = model.moment(state.forces, load)
        T1, T2 = model.tensions(state.forces, load)
        gaps = np.array([side.gaps.min(initial=np.inf) for _, side in beside])
        return {
            "d1": load.d[0],
            "d2": load.d[1],
            "gamma": load.gamma,
            "T1": T1,
            "T2": T2,
            "moment": moment,
            "tau": moment / smeared,
            "F_c": float(np.mean(abs(pairs.forces[: model.crossings]))),
            "F_side": np.array([pairs.forces[acting][of == family].sum() for family in (0, 1)])
            / model.crossings,
            "side_gap": np.array([gaps[of == family].min() for family in (0, 1)]),
            "thickness": model.thickness(x),
            "d_c": model.compression(x),
            "deepest": pairs.deepest,
            "fibre_strain_mean": np.array([means[families == family].mean() for family in (0, 1)]),
            "fibre_strain_max": np.array([worst[families == family].max() for family in (0, 1)]),
            "broken": float(np.mean(model.fibres.damage > 0)),
        }

    return row
