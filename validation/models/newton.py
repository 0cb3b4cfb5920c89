"""The thesis's own iteration for the cell (App. B.3), as it is printed and as corrected, to show what it does.

Two unknown heights; f1 = F_c1 - F_c2 (eq. 4-14), f2 = h1 + h2 + d_c1 + d_c2 - h01 - h02 (eq. 4-15); Newton from the
heights at rest. Nothing of weavecell uses it: `shellfabric.cell.crossover_kernels` solves one equation in a bracket.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics import catalogue
from shellfabric.cell import crossover_kernels
from shellfabric.cell.model import CellModel
from validation.values import largest

TOLERANCE = 1e-3  # K_tol of App. B.3
MOST = 500


@dataclass(frozen=True)
class Iteration:
    """How an iteration ended: force [N], steps made, whether it converged."""

    F: float
    steps: int
    converged: bool


def iterate(
    fabric: str, d1: float, d2: float, *, invert: bool = True, below: float = 0.0
) -> Iteration:
    """Iterate by Newton with the exact Jacobian from the heights at rest; `invert` False multiplies
    by the Jacobian instead.

    `below` : share by which it starts below them, for what rounding can do
    """
    model = CellModel(catalogue.load(fabric), cell_formulation="equilibrium")
    weave = model.fabric.weave
    law = model.used_laws[0]
    w = [w0 + d for w0, d in zip(weave.w, (d1, d2))]
    h = np.array(weave.h0) * (1 - below)
    full = sum(weave.h0)
    with np.errstate(all="ignore"):
        for step in range(1, MOST + 1):
            F, slope = zip(*(_force(*row, model.crossover) for row in zip(w, h, model.yarns)))
            F = np.array(F)  # type: ignore[assignment]
            slope = np.array(slope)  # type: ignore[assignment]
            d = law.a - law.b / np.cbrt(F)
            compliance = law.b / 3 / np.cbrt(F) ** 4
            f = np.array([F[0] - F[1], h.sum() + d.sum() - full])
            if not np.all(np.isfinite(f)):
                return Iteration(float("nan"), step, False)
            if abs(f[0]) <= TOLERANCE * np.abs(F).mean() and abs(f[1]) <= TOLERANCE * abs(h.sum()):
                return Iteration(float(F.mean()), step, True)  # type: ignore[attr-defined]
            J = np.array([[slope[0], -slope[1]], 1 + compliance * slope])
            step_of_heights = J @ f
            if invert:
                step_of_heights = np.linalg.solve(J, f)
            h = h - step_of_heights
            if largest(h) > 1e3 * full:
                return Iteration(float("nan"), step, False)
    return Iteration(float(F.mean()), MOST, False)  # type: ignore[attr-defined]


def _force(w, h, yarn, crossover):
    """F = 2 T sin(alpha) and its slope, with the sign that T has."""
    F, slope, _ = crossover_kernels.contact_force(w, h, yarn, crossover)
    return F, slope


def iterations_at_edge(fabric: str, reach: float) -> float:
    """Count the steps of the iteration where yarns barely touch, of the pairs at which it
    converges, over those inside."""
    d = np.linspace(-reach, reach, 41)
    ends = {(a, b): iterate(fabric, a, b) for a in d for b in d if a > 0 or b > 0}
    inside = np.median(
        [e.steps for (a, b), e in ends.items() if a >= 0.01e-3 and b >= 0.01e-3 and e.converged]
    )
    cell = CellModel(catalogue.load(fabric), cell_formulation="equilibrium")
    force = cell.solve(*(1 + np.array(list(ends)) / cell.fabric.weave.w).T)["F"]
    weak = [e.steps for F, e in zip(force, ends.values()) if 0 < F < 1.0 and e.converged]
    return float(np.mean(weak) / inside)
