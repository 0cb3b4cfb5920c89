"""A crossover along any path in (d1, d2): unloading, slack yarns, and failing fibres included.

A path is a list of corners (d1, d2) joined by straight lines, from rest on. Negative displacements
leave yarns slack. From a CSV file: a heading "d1 [um], d2 [um]", in either order and any unit of
length, then one corner a line.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError
from fabrics.base.record import Record
from fabrics.base.tables import read_columns
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.path_following import Hook, follow

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
    Record, with the columns of `biaxial_and_platens.row`

    Raises
    ------
    InputError : no corner, or one that is not two finite lengths
    """
    places = _corners(corners)
    lengths = abs(np.diff(places, axis=0)).max(axis=1)
    counts = [max(1, int(np.ceil(length / LONGEST_STEP))) for length in lengths]
    if not counts or sum(counts) > MOST_ROWS:
        raise InputError(
            key="path",
            value=f"{sum(counts)} steps of {LONGEST_STEP * 1e6:g} um",
            allowed=f"1 to {MOST_ROWS} steps",
        )
    model = CrossoverModel(crossover, fabric, numerics, failure=failure)
    loads = [Load(tuple(map(float, corner))) for corner in places]
    row = biaxial_and_platens.row(model)
    facts = {"case": "path", "corners": places, "failure": failure}
    return follow(model, loads, row, rows=counts, facts=facts, hooks=hooks)


def _corners(corners):
    """(k, 2) [m] the corners of a path, the first at rest."""
    places = np.atleast_2d(np.asarray(corners, float))
    pairs = places.ndim == 2 and places.shape[1:] == (2,) and places.size > 0
    if not pairs or not np.all(np.isfinite(places)):
        raise InputError("a path needs at least one corner of two finite displacements")
    if np.any(places[0]):
        places = np.concatenate([np.zeros((1, 2)), places])
    return places


def read(path: FilePath) -> FloatArray:
    """Read corners (k, 2) [m] from a CSV file.

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    units = {"d1": "m", "d2": "m"}
    columns = read_columns(path, units, what="a CSV file of corners", example="d1 [um]")
    corners = np.column_stack([columns["d1"], columns["d2"]])
    if not len(corners):
        raise InputError(file=path, key="corners", value=0, allowed="at least one")
    return corners
