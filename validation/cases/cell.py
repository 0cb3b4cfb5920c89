"""The crossover's cell and its yarn: where iterations and laws fail, a struck yarn."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.base.errors import UnstableError
from shellfabric.cell import crossover_kernels as kernels
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.membrane import quality
from validation.models import newton as thesis
from validation.models.cable import smith
from validation.models.variants import with_law_form
from validation.values import Values, flags

FABRIC = "S-720"
TABLE = 51  # stretches


def _stretches(fabric, d1, d2):
    w = fabric.weave.w
    return 1 + d1 / w[0], 1 + d2 / w[1]


def newton(*, d1: float, d2: float) -> Values:
    """Repeat the thesis's Newton iteration on two heights (App. B.3) with its printed law at end
    displacements [m].

    Returns
    -------
    dict with F [N]; root [N], the contact force of the monotone equation; steps; and closing, by how much the yarns
    miss closing the cell with F [heights at rest]

    Raises
    ------
    UnstableError : it does not converge, or runs off
    """
    found = thesis.iterate(FABRIC, d1, d2)
    printed = with_law_form(catalogue.load(FABRIC), "printed")
    model = CellModel(printed, cell_formulation="equilibrium")
    if not found.converged:
        many = found.steps >= thesis.MOST
        why = "ran off"
        if many:
            why = f"no convergence in {thesis.MOST} steps"
        raise UnstableError(why)
    root = float(model.solve(*_stretches(catalogue.load(FABRIC), d1, d2))["F"])
    return {
        "F": found.F,
        "root": root,
        "steps": found.steps,
        "closing": _miss(model, found.F, d1, d2),
    }


def _miss(model, F, d1, d2):
    """[heights at rest] by which the yarns miss closing the cell with a force; without one they close nothing."""
    if not F > 0:
        return np.inf
    warp, weft = model.yarns
    w = warp.w + d1, weft.w + d2
    free = kernels.free_height(w[0], warp.S0), kernels.free_height(w[1], weft.S0)
    return abs(kernels.residual(F, w, free, model.crossover)[0]) / sum(model.h0)


def bracket(*, d1: float, d2: float) -> Values:
    """Solve what `shellfabric` solves instead, one monotone equation in a bracket: F [N] and
    closing, as in `newton`."""
    fabric = catalogue.load(FABRIC)
    model = CellModel(fabric)
    F = float(model.solve(*_stretches(fabric, d1, d2))["F"])
    return {"F": F, "closing": _miss(model, F, d1, d2) if F > 0 else 0.0}


@cache
def _printed_table() -> CellTable:
    return CellModel(with_law_form(catalogue.load(FABRIC), "printed")).table(TABLE)


def printed_law(*, d1: float, d2: float) -> Values:
    """Compare the printed law d = a - b / F^(1/3) with the regularised one, d = a - b / (F +
    F0)^(1/3), near F = 0.

    Returns
    -------
    dict with off [-], the largest difference of the tensions over the strength; F, F_printed [N]; flags
    """
    fabric = catalogue.load(FABRIC)
    stretches = _stretches(fabric, d1, d2)
    ours, theirs = (
        CellModel(one).solve(*stretches) for one in (fabric, with_law_form(fabric, "printed"))
    )
    off = max(abs(float(ours[T] - theirs[T])) for T in ("T1", "T2")) / fabric.weave.warp.strength
    checks = quality.of_cell(_printed_table(), [float(theirs[T]) for T in ("T1", "T2")])
    return {
        "off": off,
        "F": float(ours["F"]),
        "F_printed": float(theirs["F"]),
        "flags": flags(checks),
    }


def struck_yarn(
    *,
    fabric: str,
    velocity: float,
    length: float,
    exact: bool = False,
    **numerics: Any,
) -> dict[str, float]:
    """Strike a lone straight warp across at constant velocity by the cable model, or by Smith's
    closed form (`exact`): tension, force [N], kink and front [m/s] speeds; `length` [m] of its
    half, bars and numerics of `smith.strike`."""
    yarn = catalogue.load(fabric).weave.warp
    wave = (
        smith.smith(yarn, velocity)
        if exact
        else smith.strike(yarn, velocity, length=length, **numerics).computed
    )
    return {"tension": wave.tension, "force": wave.force, "kink": wave.U, "front": wave.c}
