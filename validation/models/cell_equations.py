"""The thesis's cell written out with no code of the product, to hold a solved cell against (section 4.3.1).

A claim on the cell is mostly an order or a sign, which a cell with a wrong law or a wrong equilibrium keeps as well. So
its check also asks how far the solved states are from the equations themselves: the arc length by quadrature (eq. 4-3),
T = EA (S - S0) / S0 (eq. 4-7), F = 2 T sin(alpha) of both yarns (eqs. 4-8, 4-10), and heights and compressions that
add up to the heights at rest (eqs. 4-12, 4-13), with d = a - b (F + F0)^(-1/3) (erratum E-05).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial.legendre import leggauss

from validation.values import largest

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fabrics.base.checks import FloatArray
    from shellfabric.cell.model import CellModel

_X, _WEIGHTS = leggauss(40)
# the points of the quadrature from 0 to pi / 2
_U = 0.25 * np.pi * (_X + 1)
_WEIGHTS = 0.25 * np.pi * _WEIGHTS


def arc(w: FloatArray, h: FloatArray) -> FloatArray:
    """Integrate the length [m] of a cosine of height h over the half length w."""
    slope = 0.5 * np.pi * h / w
    return 4 * w / np.pi * (np.sqrt(1 + (slope[..., None] * np.sin(_U)) ** 2) @ _WEIGHTS)


def departure(model: CellModel, stretch1: ArrayLike, stretch2: ArrayLike) -> float:
    """Compute the largest departure of the solved states of a cell in the equilibrium form from the
    equations.

    Of tensions over the strength, of contact forces over the largest, of the sum of the heights over that at rest, and
    of stored energies over the largest.
    """
    stretches = [
        np.array(one) for one in np.broadcast_arrays(np.asarray(stretch1, float), stretch2)
    ]
    weave = model.fabric.weave
    found = model.solve(*stretches)
    F = found["F"]
    touching = found["F"] > 0
    scale = max(float(F.max()), 1e-12)
    worst = 0.0
    W = np.zeros_like(F)
    heights = np.zeros_like(F)
    # laws given to the cell, or the fabric's; bounds have none
    laws: Any = (None, None)
    if model.cell_model == "compressible":
        laws = model.laws or model.fabric.laws
    if model.cell_model == "decoupled" and touching.any():
        return float("inf")
    for k, (yarn, law) in enumerate(zip(weave.yarns, laws)):
        w = weave.w[k] * stretches[k]
        S0 = weave.S0[k]
        T = found[f"T{k + 1}"]
        h = found[f"h{k + 1}"]
        S = arc(w, h)
        tension = yarn.EA * np.maximum(S - S0, 0) / S0
        slope = 0.5 * np.pi * h / w
        force = 2 * tension * slope / np.sqrt(1 + slope**2)
        free = (
            np.abs(S - np.maximum(S0, 2 * w)) / S0
        )  # a yarn that touches nothing keeps its length, or is straight
        worst = max(
            worst,
            largest(tension - T) / yarn.strength,
            float(np.abs(force - F)[touching].max(initial=0.0)) / scale,
            float(free[~touching].max(initial=0.0)),
        )
        W = W + 0.5 * yarn.EA * np.maximum(S - S0, 0) ** 2 / S0
        heights = heights + h
        if law is not None and law.a > 0:
            start = 0.0
            if law.form == "regularised":
                start = (law.b / law.a) ** 3
            d = law.a - law.b * np.where(touching, F + start, 1.0) ** (-1 / 3)
            heights = heights + np.where(touching, d, 0.0)
            if start:
                work = 0.5 * law.b**3 * ((law.a - d) ** -2 - law.a**-2) - start * d
                W = W + np.where(touching, work, 0.0)
    closed = heights / sum(weave.h0) - 1
    worst = max(worst, float(np.abs(closed[touching]).max(initial=0.0)))
    if model.cell_model != "decoupled":
        worst = max(
            worst, float(-closed[~touching].min(initial=0.0))
        )  # contact is lost only where there is room
    return max(worst, largest(W - found["W"]) / max(float(W.max()), 1e-30))
