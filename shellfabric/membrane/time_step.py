"""How much of the bound on the time step is taken: what form, crimp and viscosity leave of it
(`membrane.model.Panel`).

The bound, (2 / w) (sqrt(1 + xi^2) - xi), is that of a cell that is as stiff as it ever gets, in
every element. What it is worth depends on the cell, and was found by running it
(docs/reports/numerics.md):

    form      In the variational form half of a cell's force follows from the mean stretch of two neighbours, which is
              none where they stretch against each other: the highest mode has half the stiffness,
              and the bound leaves a factor of sqrt 2 in hand. The equilibrium form has all of it,
              and its bound is exact.
    tautness  Crimped fabric is as stiff as the bound takes it to be only where its yarns have been pulled straight.
              Fabric that is so at rest, without crimp or compression to take up, comes to within
              0.965 of the form's bound: sheared elements, whose yarns are no longer square, are a
              little stiffer still.
    ring      A crimped yarn that snaps taut rings at the highest frequencies. The least viscosity takes that away
              (from 0.0025 on peaks are the same at any stable step). Without any, the ring has to
              be followed in time.
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

    Usual is crimped fabric in the variational form with viscosity.
    """
    if table.model.cell_formulation == "variational":
        form = 1.0
    else:
        form = sqrt(0.5)
    if table.tautness() > _TAUT:
        return form * _SHEARED
    return form * (_RING + (1 - _RING) * min(1.0, viscosity / _DAMPED))
