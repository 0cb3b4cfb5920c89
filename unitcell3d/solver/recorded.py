"""What is recorded of the states of a path: columns with the meanings of meanings.toml, and what every
case of a crossover has."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fabrics.base.record import Record, columns
from unitcell3d.solver.newton import Equilibrium

# {column: "[unit] what it is"}
MEANINGS = tomllib.loads(Path(__file__).with_name("meanings.toml").read_text("utf-8"))


def record(
    rows: Sequence[Mapping[str, Any]],
    facts: Mapping[str, Any],
    last: Mapping[str, Any],
    failed: str,
) -> Record:
    """Return the Record of rows, dicts whose keys are names of `MEANINGS`."""
    found = columns(rows)
    meanings = {name: MEANINGS.get(name, "") for name in found}
    return Record(found, meanings, dict(facts), dict(last), failed)


def crossover_row(model: Any, state: Equilibrium, load: Any) -> dict[str, Any]:
    """Return loads, tensions, contact forces, heights and compression of a crossover.

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
    """Return strains of the fibres of warp and weft of a crossover, and what each yarn is
    compressed by itself."""
    x = model.positions(state.q, load)
    strains, means = model.fibre_strains(x)
    return {
        "d_yarns": model.half_thicknesses(model.points) - model.half_thicknesses(x),
        "fibre_strain_max": model.fibres.worst(strains),
        "fibre_strain_mean": means,
        "broken": model.fibres.broken(),
    }
