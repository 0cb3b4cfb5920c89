"""Threshold of the axial force at which a yarn slips through a crossover, against the contact force there.

    T_f = c0 + mu_eff F_c

c0 is what resists without contact force (the crimp has to travel along the yarn), mu_eff Coulomb's coefficient as the
crossover has it: the yarns press on each other obliquely too, which the vertical force F_c does not count. Both are
fitted to thresholds of the 3D crossover at several contact forces (`unitcell3d.cases.pull_out`).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, not_negative
from fabrics.base.errors import InputError

# of aramid yarns on each other: a range quoted in the literature, no single measurement
FRICTION = 0.2
FRICTION_RANGE = (0.15, 0.25)
FRICTION_STATUS = "literature"


@dataclass(frozen=True)
class PullOutLaw:
    """Slip threshold of a crossover.

    Parameters
    ----------
    c0 : [N] threshold without contact force; a fit may put it slightly below 0
    mu_eff : [-] slope
    F_c, T_f : (n,) [N] contact forces and thresholds that were fitted
    friction : [-] Coulomb's coefficient of the 3D contact
    friction_range : (lowest, highest) [-] of the coefficient in the literature
    status : of the coefficient and its range
    residual_rms : [N] of the fit
    provenance : how the thresholds were computed

    Raises
    ------
    InputError : a number that is not finite, a negative slope, coefficient or contact force, a range that does not
        rise, or samples of unequal number
    """

    c0: float
    mu_eff: float
    F_c: tuple[float, ...] = ()
    T_f: tuple[float, ...] = ()
    friction: float = FRICTION
    friction_range: tuple[float, float] = FRICTION_RANGE
    status: str = FRICTION_STATUS
    residual_rms: float | None = None
    provenance: str = ""

    def __post_init__(self):
        not_negative(self, "mu_eff", "friction")
        if not (isinstance(self.c0, (int, float)) and isfinite(self.c0)):
            raise InputError(key="c0", value=self.c0, allowed="a finite force")
        if len(self.F_c) != len(self.T_f):
            raise InputError(
                key="T_f",
                value=len(self.T_f),
                allowed=f"as many as contact forces, {len(self.F_c)}",
            )
        if not all(isfinite(value) and value >= 0 for value in self.F_c):
            raise InputError(key="F_c", value=self.F_c, allowed="zero or positive forces")
        low, high = self.friction_range
        if not 0 <= low < high:
            raise InputError(
                key="friction_range",
                value=self.friction_range,
                allowed="two rising numbers from 0 on",
            )

    def threshold(self, F_c: ArrayLike) -> FloatArray:
        """Threshold [N] at the contact force `F_c` [N]; never negative."""
        return np.maximum(self.c0 + self.mu_eff * np.maximum(np.asarray(F_c, float), 0.0), 0.0)

    @classmethod
    def fit(cls, F_c: ArrayLike, T_f: ArrayLike, **others: Any) -> PullOutLaw:
        """Least squares over samples (n,) [N] of contact forces and thresholds.

        others : further fields

        Raises
        ------
        InputError : fewer than two different contact forces
        """
        forces, thresholds = np.asarray(F_c, float), np.asarray(T_f, float)
        if forces.size < 2 or not np.ptp(forces) > 0:
            raise InputError(
                key="F_c",
                value=forces.tolist(),
                allowed="at least two different contact forces for a fit",
            )
        slope, start = (float(part) for part in np.polyfit(forces, thresholds, 1))
        off = thresholds - start - slope * forces
        return cls(
            start,
            max(slope, 0.0),
            tuple(forces.tolist()),
            tuple(thresholds.tolist()),
            residual_rms=float(np.sqrt(np.mean(off**2))),
            **others,
        )
