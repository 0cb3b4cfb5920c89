"""Contact law of two neighbouring plies: pressure against closure, per area, the same on every mesh
(docs/theory-panel.md, "Packs: contact law of plies"; which one a fabric has: `fabrics.ply_laws`).

Closure is the thickness that two half plies lose under a pressure from outside, from rest on; of two
plies of one fabric, what one ply loses between platens. The weave gives way first (127 to 240 um up
to 19.4 MPa in the 3D crossovers of six Kevlar 129 fabrics), then fibre is pressed on fibre:

    p(d)  from samples, linear between them,        dp/dd = E_c rho_f / A_d  beyond the last one

E_c: transverse modulus of packed yarn; rho_f: density of fibre; A_d: areal density of a ply.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, positive
from fabrics.base.errors import InputError

# [m] a law without travel is a straight line, and one sample at any distance describes it
SOLID_TRAVEL = 1e-6


@dataclass(frozen=True, eq=False)
class PlyLaw:
    """Pressure against closure of two neighbouring plies.

    Parameters
    ----------
    closure : (n,) [m] rising from 0, n at least 2
    pressure : (n,) [Pa] rising from 0
    stiffness : [Pa/m] beyond the last sample
    source : where it comes from
    status : of `STATUSES`

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
                raise InputError(
                    key=key,
                    value=f"{column.size} values",
                    allowed="at least 2, as many pressures as closures",
                )
            if not np.all(np.isfinite(column)) or column[0] != 0 or not np.all(np.diff(column) > 0):
                row = 1
                if column[0] == 0:
                    row = int(np.argmin(np.diff(column) > 0)) + 2
                raise InputError(
                    key=key,
                    value=f"row {row}",
                    allowed="finite, 0 in the first row and rising from row to row",
                )

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, PlyLaw)
            and self.table() == other.table()
            and self.stiffness == other.stiffness
        )

    __hash__ = None  # type: ignore[assignment]

    def words(self) -> str:
        """Describe travel, pressure at its end, and stiffness beyond, for the reader."""
        beyond = f"{self.stiffness:.3g} Pa/m beyond"
        return f"{1e6 * self.travel:.1f} µm up to {1e-6 * self.pressure[-1]:.3g} MPa, {beyond} ({self.status})"

    def table(self) -> dict[str, Any]:
        """Return the law as the table that `from_table` reads."""
        return {
            "closure": [f"{1e6 * value:.6g} um" for value in self.closure],
            "pressure": [f"{1e-6 * value:.6g} MPa" for value in self.pressure],
            "source": self.source,
            "status": self.status,
        }

    def between(self, other: PlyLaw) -> PlyLaw:
        """Compute the law of a ply of this fabric on one of another: half of the closure of each at
        every pressure."""
        if other is self or other == self:
            return self
        pressure = np.union1d(self.pressure, other.pressure)
        closure = 0.5 * (self.closure_at(pressure) + other.closure_at(pressure))
        stiffness = 2 / (1 / self.stiffness + 1 / other.stiffness)
        if self.source == other.source:
            source = self.source
        else:
            source = f"half each: {self.source}; {other.source}"
        if self.status == other.status:
            status = self.status
        else:
            status = f"{self.status}, {other.status}"
        return PlyLaw(closure, pressure, stiffness, source, status)

    def capped(self, share: float) -> PlyLaw:
        """Return the law with its slopes cut to `share` of that of solid fibre; at every closure of
        a sample with the pressure of the cut slopes before it."""
        most = share * self.stiffness
        slopes = np.minimum(np.diff(self.pressure) / np.diff(self.closure), most)
        pressure = np.concatenate([[0.0], np.cumsum(slopes * np.diff(self.closure))])
        return replace(self, pressure=pressure, stiffness=min(most, self.stiffness))

    @property
    def steepest(self) -> float:
        """[Pa/m] highest slope of the law, which bounds the time step of explicit springs."""
        return max(self.stiffness, float(np.max(np.diff(self.pressure) / np.diff(self.closure))))

    @property
    def travel(self) -> float:
        """[m] closure at the last sample, from which on the law is that of solid fibre."""
        return float(self.closure[-1])

    def pressure_at(self, closure: ArrayLike) -> FloatArray:
        """Compute the pressure [Pa] at a closure [m]; zero while plies are apart."""
        d = np.asarray(closure, float)
        beyond = np.maximum(d - self.travel, 0.0)
        return np.interp(d, self.closure, self.pressure) + self.stiffness * beyond

    def closure_at(self, pressure: ArrayLike) -> FloatArray:
        """Compute the closure [m] at a pressure [Pa]; the inverse of `pressure_at`."""
        p = np.asarray(pressure, float)
        beyond = np.maximum(p - self.pressure[-1], 0.0)
        return np.interp(p, self.pressure, self.closure) + beyond / self.stiffness

    def energy_at(self, closure: ArrayLike) -> FloatArray:
        """Compute the energy per area [J/m2] stored at a closure [m]: the integral of the
        pressure."""
        d = np.maximum(np.asarray(closure, float), 0.0)
        steps = 0.5 * np.diff(self.closure) * (self.pressure[1:] + self.pressure[:-1])
        stored = np.concatenate([[0.0], np.cumsum(steps)])
        k = np.clip(np.searchsorted(self.closure, d, side="right") - 1, 0, len(self.closure) - 1)
        rest = d - self.closure[k]
        start = self.pressure[k]
        slope = np.append(np.diff(self.pressure) / np.diff(self.closure), self.stiffness)[k]
        return stored[k] + start * rest + 0.5 * slope * rest * rest
