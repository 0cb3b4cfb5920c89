"""A crossover along any path in (d1, d2): unloading, slack yarns, and failing fibres included.

A path is a list of corners (d1, d2) joined by straight lines, from rest on. Negative displacements leave yarns slack.
From a CSV file: a heading "d1 [um], d2 [um]", in either order and any unit of length, then one corner a line.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from fabrics.checks import FilePath, FloatArray
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.files import read_columns
from fabrics.record import Record, columns
from meshing.crossover import Crossover
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver import path_following
from unitcell3d.solver.load_stepping import Hook

MEANINGS = {
    "path": "[-] share of the path",
    "d1": "[m] end displacement of the warp, per end",
    "d2": "[m] the same of the weft",
    "T1": "[N] tension of the warp",
    "T2": "[N] tension of the weft",
    "F_c": "[N] contact force",
    "h1": "[m] height of the warp's centreline",
    "h2": "[m] the same of the weft",
    "d_c": "[m] compression of one yarn, half of the loss of h1 + h2",
    "fibre_strain_mean": "(n, 2) [-] of the fibres of warp and weft",
    "fibre_strain_max": "(n, 2) [-] of the worst whole fibre of warp and weft, -1 where none is left",
    "broken": "(n, 2) [-] share of the fibre bars of warp and weft that has failed",
    "iterations": "[-] tangents factorised",
    "seconds": "[s] wall time",
}
LONGEST_STEP = 1.5e-6  # m between two rows
MOST_ROWS = 2000


def along(
    crossover: Crossover,
    fabric: Fabric,
    corners: ArrayLike,
    *,
    failure: bool = False,
    numerics: Numerics | None = None,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Take a crossover along the corners (k, 2) [m] of a path in (d1, d2), from rest.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric : Fabric
    corners : (k, 2) [m]; a first one at rest may be left out
    failure : fibres fail at their failure strain (`unitcell3d.material.fibres`)
    numerics, hooks : see `path_following.follow`

    Returns
    -------
    Record, with the meanings `MEANINGS`

    Raises
    ------
    InputError : no corner, or one that is not two finite lengths
    """
    places = np.atleast_2d(np.asarray(corners, float))
    if (
        places.ndim != 2
        or places.shape[1:] != (2,)
        or not places.size
        or not np.all(np.isfinite(places))
    ):
        raise InputError("a path needs at least one corner of two finite displacements")
    if np.any(places[0]):
        places = np.concatenate([np.zeros((1, 2)), places])
    counts = [
        max(1, int(np.ceil(np.abs(leg).max() / LONGEST_STEP))) for leg in np.diff(places, axis=0)
    ]
    if not counts or sum(counts) > MOST_ROWS:
        raise InputError(
            key="path",
            value=f"{sum(counts)} steps of {LONGEST_STEP * 1e6:g} um",
            allowed=f"1 to {MOST_ROWS} steps",
        )
    model = CrossoverModel(crossover, fabric, numerics, failure=failure)
    rest = model.heights(model.points)

    def row(state, load):
        x = model.positions(state.q, load)
        strains, means = model.fibre_strains(x)
        heights, (T1, T2) = model.heights(x), model.tensions(state.forces)
        broken = model.fibres.damage > 0
        return {
            "d1": load.d[0],
            "d2": load.d[1],
            "T1": T1,
            "T2": T2,
            "F_c": model.copies[1] * state.contact,
            "h1": heights[0],
            "h2": heights[1],
            "d_c": 0.5 * (rest.sum() - heights.sum()),
            "fibre_strain_mean": means,
            "fibre_strain_max": model.fibres.worst(strains),
            "broken": np.array([broken[model.bar_yarn == yarn].mean() for yarn in (0, 1)]),
        }

    loads = [Load(tuple(map(float, corner))) for corner in places]
    found = path_following.follow(model, loads, row, rows=counts, hooks=hooks)
    return Record(
        columns(found.rows),
        MEANINGS,
        {"fabric": fabric.name, "case": "path", "corners": places, "failure": failure},
        {"u": found.x - model.points},
        found.failed,
    )


def read(path: FilePath) -> FloatArray:
    """(k, 2) [m] corners from a CSV file.

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    heading = '"d1 [um], d2 [um]" or another length'
    corners = read_columns(
        path,
        {"d1": "m", "d2": "m"},
        what="a CSV file of corners d1, d2",
        content=f"headed {heading}",
        heading=heading,
        accepts=lambda names: sorted(names) == ["d1", "d2"],
        columns="d1 and d2",
    )
    found = np.column_stack([corners["d1"], corners["d2"]])
    if not len(found):
        raise InputError(file=path, key="corners", value=0, allowed="at least one")
    return found
