"""Contact law of two neighbouring plies: pressure against closure, per area, the same on every mesh.

Closure is the thickness that two half plies lose under a pressure from outside, from their thickness at rest on; of two
plies of one fabric it is what one ply loses between platens. The weave gives way first (44 to 50 um for Kevlar 129 up
to 19 MPa, thesis section 2.2.1), then fibre is pressed on fibre:

    p(d)  from samples, linear between them,        dp/dd = E_c rho_f / A_d  beyond the last one

with E_c the transverse modulus of packed yarn, rho_f the density of the fibre and A_d the areal density of a ply, so
that A_d / rho_f is the thickness of a solid sheet of its fibre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fabrics.checks import FloatArray, positive
from fabrics.errors import InputError


@dataclass(frozen=True, eq=False)
class PlyLaw:
    """Pressure against closure of two neighbouring plies.

    Parameters
    ----------
    closure : (n,) [m] rising from 0, n at least 2
    pressure : (n,) [Pa] rising from 0
    stiffness : [Pa/m] beyond the last sample
    source : where it comes from
    status : "measured", "computed", "fitted" or "assumed"

    Raises
    ------
    InputError : samples that do not begin at 0 or do not rise, or a stiffness that is not positive
    """

    closure: np.ndarray
    pressure: np.ndarray
    stiffness: float
    source: str = ""
    status: str = "assumed"

    def __post_init__(self):
        positive(self, "stiffness")
        for key in ("closure", "pressure"):
            column = np.asarray(getattr(self, key), float)
            object.__setattr__(self, key, column)
            if column.ndim != 1 or column.size < 2 or column.size != len(self.closure):
                raise InputError(key=key, value=f"{column.size} values", allowed="at least 2, as many of both")
            if not np.all(np.isfinite(column)) or column[0] != 0 or not np.all(np.diff(column) > 0):
                row = int(np.argmin(np.diff(column) > 0)) + 2
                raise InputError(
                    key=key, value=f"row {row}", allowed="finite, 0 in the first row and rising from row to row"
                )

    @property
    def travel(self) -> float:
        """[m] closure at the last sample, from which on the law is that of solid fibre."""
        return float(self.closure[-1])

    def pressure_at(self, closure: ArrayLike) -> FloatArray:
        """Pressure [Pa] at a closure [m]; zero where plies are apart."""
        d = np.asarray(closure, float)
        beyond = np.maximum(d - self.travel, 0.0)
        return np.interp(d, self.closure, self.pressure) + self.stiffness * beyond

    def energy_at(self, closure: ArrayLike) -> FloatArray:
        """Energy per area [J/m2] stored at a closure [m]: the integral of the pressure."""
        d = np.maximum(np.asarray(closure, float), 0.0)
        steps = 0.5 * np.diff(self.closure) * (self.pressure[1:] + self.pressure[:-1])
        stored = np.concatenate([[0.0], np.cumsum(steps)])
        k = np.clip(np.searchsorted(self.closure, d, side="right") - 1, 0, len(self.closure) - 1)
        rest, start = d - self.closure[k], self.pressure[k]
        slope = np.append(np.diff(self.pressure) / np.diff(self.closure), self.stiffness)[k]
        return stored[k] + start * rest + 0.5 * slope * rest * rest
