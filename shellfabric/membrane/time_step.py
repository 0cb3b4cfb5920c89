"""How much of the bound on the time step is taken: what form, crimp and viscosity leave of it, found by
running it (docs/reports/numerics.md, docs/theory-panel.md, "Time integration and time step").
"""

from __future__ import annotations

from math import sqrt
from typing import Any

_SHEARED = 0.965  # of the form's bound, what taut fabric was seen to bear
_TAUT = 0.5  # of the largest stiffness of the table, at rest
# share of the step that follows a ring, and the viscosity that leaves none
_RING = 0.63
_DAMPED = 0.0025


def share(table: Any, viscosity: float) -> float:
    """Compute the share [-] of the bound that is taken for 1, for a CellTable and a damping ratio;
    exactly 1 for what is usual.

    form: in the variational form half of a cell's force follows from the mean stretch of two
    neighbours, none where they stretch against each other: the highest mode has half the stiffness,
    a factor of sqrt 2 in hand. The bound of the equilibrium form is exact. tautness: fabric that is
    straight at rest comes to within 0.965 of the form's bound, as sheared elements are a little
    stiffer still. ring: a crimped yarn that snaps taut rings at the highest frequencies, which the
    least viscosity takes away (from 0.0025 on peaks are the same at any stable step); without any
    it has to be followed in time.

    Usual is crimped fabric in the variational form with viscosity.
    """
    if table.model.cell_formulation == "variational":
        form = 1.0
    else:
        form = sqrt(0.5)
    if table.tautness() > _TAUT:
        return form * _SHEARED
    return form * (_RING + (1 - _RING) * min(1.0, viscosity / _DAMPED))
