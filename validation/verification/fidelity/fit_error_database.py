"""What a survey teaches: errors.json from its rows.

An error is taken as a factor times how hard the scene is (`quantities.scale`, from two scouts). A factor that is kept
is one that 97 scenes of a hundred stay below. Peak tensions are mixed with those of the partner, in the
proportion for which that factor is least.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from typing import Any

import numpy as np

from weavecell.analysis.fidelity import quantities
from weavecell.analysis.fidelity.ladder import BY_NAME, LADDER, Model, partner, scouts

SURE, OFTEN = 0.97, 0.8  # SURE: leaving out one scene at a time, 180 of 186 targets are met
WEIGHTS = tuple(0.05 * n for n in range(9))  # of the partner's peak tensions, that are tried
LEAST = 1e-4  # [-] of any error or scale: less says nothing
OTHER = 1.0  # error of a model that does not agree on the outcome


def of(rows: Sequence[dict[str, Any]], models: Sequence[Model] = LADDER) -> dict[str, Any]:
    """{"models", "regimes", "finest"} for `error_database.Book` from the rows of all scenes.

    Parameters
    ----------
    rows : [{model: {"values", "seconds"}}]
    models : the ladder, the full model last
    """
    full = models[-1].name
    found = {"models": {model.name: {"cost": _cost(model, full, rows)} for model in models}, "regimes": {}}
    found["finest"] = {}
    for regime in (quantities.HELD, quantities.THROUGH):
        alike = [row for row in rows if quantities.regime(_seen(row)[0]) == regime]
        names = [name for name in quantities.NAMES if quantities.is_defined(name, regime)]
        found["regimes"][regime] = {name: _quantity(name, alike, models) for name in names}
        found["finest"][regime] = {name: _finest(name, full, alike) for name in names}
    return found


def _seen(row):
    """What the two scouts of a row found, the finer first."""
    return tuple(row[model.name]["values"] for model in reversed(scouts(row)))


def _cost(model, full, rows):
    shares = [row[model.name]["seconds"] / row[full]["seconds"] for row in rows if model.name in row]
    return float(np.median(shares)) if shares else inf


def _quantity(name, rows, models):
    """{"scenes", "usual", "models": {model: {"factor", "apart", "expected", "weight"}}}."""
    apart = [quantities.differences(*_seen(row))[name] for row in rows]
    usual = max(LEAST, float(np.nanmedian(apart)) if np.any(np.isfinite(apart)) else LEAST)
    scales = [quantities.scale(name, *_seen(row), usual) for row in rows]
    known = [(row, scale) for row, scale in zip(rows, scales) if isfinite(scale)]
    fitted = {model.name: _model(model, name, models[-1].name, known) for model in models}
    return {"scenes": len(known), "usual": usual, "models": {key: found for key, found in fitted.items() if found}}


def _model(model, name, full, known):
    known = [(row, scale) for row, scale in known if model.name in row]
    weights = WEIGHTS if name == "peak_tension" and model.name != full else (0.0,)
    tried = [(_errors(model, name, full, known, weight), weight) for weight in weights]
    if not tried[0][0]:
        return None
    errors, weight = min(tried, key=lambda one: np.quantile([off / scale for off, scale in one[0]], SURE))
    moved = [(error(row[model.name]["values"], _partner(model, row), name), scale) for row, scale in known]
    return {
        "factor": float(np.quantile([off / scale for off, scale in errors], SURE)),
        "apart": max(off / scale for off, scale in moved if isfinite(off)),
        "expected": float(np.quantile([off for off, _ in errors], OFTEN)),
        "weight": weight,
    }


def _errors(model, name, full, known, weight):
    """[(error, scale)] of the rows that have it."""
    found = [
        (error(quantities.mixed(row[model.name]["values"], _partner(model, row), weight), row[full]["values"], name), s)
        for row, s in known
    ]
    return [(off, scale) for off, scale in found if isfinite(off)]


def _partner(model, row):
    return row[partner(model, scouts(row)).name]["values"]


def error(values: dict[str, Any], others: dict[str, Any], name: str) -> float:
    """[-] of a quantity; OTHER where the outcome is another; nan where there is none."""
    if quantities.regime(values) != quantities.regime(others):
        return OTHER
    return quantities.differences(values, others)[name]


def _finest(name, full, rows):
    """[-] what the full model is off by: what its difference from the mesh of 2 elements a crossover leaves where
    errors fall with the side."""
    off = [error(row["2 elements"]["values"], row[full]["values"], name) for row in rows if "2 elements" in row]
    off = [one for one in off if isfinite(one)]
    fine, coarse = (1 / dict(BY_NAME[model].changes)["elements_per_crossover"] for model in (full, "2 elements"))
    return fine / (coarse - fine) * float(np.quantile(off, OFTEN)) if off else 0.0
