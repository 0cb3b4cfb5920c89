"""Compression of one ply between flat platens: pressure against what the platens have closed since a
first pressure.

Built in, the law of the thesis (eqs. 2-5, 2-6; errata E-02 .. E-04), thickness t for volume:

    P = K'' / (t - t_min)^3,   K'' = c1 A_d^3 + c2   ->   closure = K''^(1/3) (P_start^(-1/3) - P^(-1/3))

t_min is in a lost figure; a closure does not need it. c2 < 0: K'' changes sign at 148.3 g/m2.

A user's curve is a CSV file of loading alone, five rows or more: "pressure [MPa], thickness [mm]",
falling, or "pressure [kPa], closure [um]", rising, in either order. Lines with # are comments.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, placed
from fabrics.base.files import read_data
from fabrics.base.sourced import in_si
from fabrics.base.tables import read_columns

_LAW = Path(__file__).parent / "pressure_law.toml"
_UNITS = {"c1": "Pa * m^3 / (kg/m^2)^3", "c2": "Pa * m^3", "start": "N", "peak": "N", "platen": "m"}
FEWEST = 5
# [Pa] the highest in the tests of plies and packs: 7 kN on 19 mm x 19 mm
PLATEN_PRESSURE = 7000 / 0.019**2
SAMPLES = 24


@dataclass(frozen=True, eq=False)
class PlateCurve:
    """A measured curve.

    Parameters
    ----------
    pressure : (n,) [Pa] rising, positive
    closure : (n,) [m] rising, what the platens have closed since pressure[0]
    source : where it comes from

    Raises
    ------
    InputError : too few points, a value that is not finite, or a curve that does not rise
    """

    pressure: np.ndarray
    closure: np.ndarray
    source: str = ""

    def __post_init__(self):
        if len(self.pressure) < FEWEST or len(self.pressure) != len(self.closure):
            raise InputError(key="rows", value=len(self.pressure), allowed=f"at least {FEWEST}")
        for key in ("pressure", "closure"):
            steps = np.diff(getattr(self, key))
            rising = np.isfinite(steps) & (steps > 0)
            if not rising.all():
                row = int(np.argmin(rising)) + 2
                raise InputError(key=key, value=f"row {row}", allowed="finite and rising")
        if not self.pressure[0] > 0:
            raise InputError(key="pressure", value=float(self.pressure[0]), allowed="positive")

    def at(self, pressure: ArrayLike) -> FloatArray:
        """Interpolate the closure [m] at pressures [Pa] inside the curve."""
        return np.interp(np.log(pressure), np.log(self.pressure), self.closure)

    @classmethod
    def pressure_law(cls, areal_density: float, plies: int = 1) -> PlateCurve:
        """Compute the law of the thesis for a Kevlar 129 plain weave: a ply, or a pack of 4, 8 or
        16 (Table 2-2, erratum E-02).

        Parameters
        ----------
        areal_density : [kg/m2] of one ply, measured
        plies : number; the closure is that of the whole pack

        Raises
        ------
        InputError : the areal density is below that where K'' vanishes, or a pack that was not
            tested
        """
        content = read_data(_LAW)
        packs = content.pop("plies")
        if plies != 1:
            if str(plies) not in packs:
                raise InputError(
                    key="plies", value=plies, allowed="1, 4, 8 or 16, of which packs were tested"
                )
            content |= packs[str(plies)]
        law = in_si(content, _UNITS, _LAW)
        K = law["c1"] * areal_density**3 + law["c2"]
        if not K > 0:
            allowed = f"above {(-law['c2'] / law['c1']) ** (1 / 3):.4f} kg/m2, where K'' vanishes"
            raise InputError(key="areal_density_measured", value=areal_density, allowed=allowed)
        pressure = np.geomspace(law["start"], law["peak"], SAMPLES) / law["platen"] ** 2
        closure = np.cbrt(K) * (pressure[0] ** (-1 / 3) - pressure ** (-1 / 3))
        pack = ""
        if plies != 1:
            pack = f", {plies} plies (Table 2-2)"
        return cls(
            pressure,
            closure,
            f"pressure law of thesis eq. 2-6 at {1e3 * areal_density:.1f} g/m2{pack}",
        )

    @classmethod
    def read(cls, path: FilePath) -> PlateCurve:
        """Read a user's CSV file.

        Raises
        ------
        InputError : one line naming the file, the row, the value and what is allowed
        """
        path = Path(path)
        column = read_columns(
            path,
            {"pressure": "Pa", "thickness": "m", "closure": "m"},
            what="a plate curve",
            example="pressure [MPa]",
            either=("thickness", "closure"),
        )
        if "closure" in column:
            closure = column["closure"]
        else:
            closure = -column["thickness"]
        with placed(path):
            return cls(column["pressure"], closure - closure[:1].sum(), path.name)
