"""Threshold of the axial force at which a yarn slips through a crossover, against the contact force
there.

    T_f = c0 + mu_eff F_c

c0 is what resists without contact force (the crimp has to travel along the yarn), mu_eff Coulomb's
coefficient as the crossover has it: the yarns press on each other obliquely too, which the vertical
force F_c does not count. Both are fitted to thresholds of the 3D crossover at several contact
forces (`unitcell3d.cases.pull_out`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base import sums
from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError


@dataclass(frozen=True)
class PullOutLaw:
    """Slip threshold of a crossover.

    Parameters
    ----------
    c0 : [N] threshold without contact force; a fit may put it slightly below 0
    mu_eff : [-] slope, at least 0
    residual_rms : [N] of the fit
    """

    c0: float
    mu_eff: float
    residual_rms: float = 0.0

    def threshold(self, F_c: ArrayLike) -> FloatArray:
        """Compute the threshold [N] at the contact force `F_c` [N]; never negative."""
        return np.maximum(self.c0 + self.mu_eff * np.maximum(np.asarray(F_c, float), 0.0), 0.0)

    @classmethod
    def fit(cls, F_c: ArrayLike, T_f: ArrayLike) -> PullOutLaw:
        """Fit contact forces and thresholds (n,) [N] by least squares.

        Raises
        ------
        InputError : fewer than two different contact forces
        """
        forces = np.asarray(F_c, float)
        thresholds = np.asarray(T_f, float)
        if forces.size < 2 or not np.ptp(forces) > 0:
            allowed = "at least two different contact forces for a fit"
            raise InputError(key="F_c", value=forces.tolist(), allowed=allowed)
        slope, start = sums.fit_line(forces, thresholds)
        residuals = thresholds - start - slope * forces
        rms = np.sqrt(np.mean(residuals**2))
        return cls(float(start), max(float(slope), 0.0), float(rms))
