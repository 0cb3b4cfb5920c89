"""Bicubic interpolation of a response surface, twice continuously differentiable, with an estimate
of its error.

The estimate leaves out one grid line after another and compares the spline through the rest with
what the crossover gave on that line. It is the error of the spacing twice as wide: for a smooth
surface sixteen times that of the grid itself, at a kink about twice.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import RectBivariateSpline

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.surface import ResponseSurface

QUANTITIES = ("T1", "T2", "F_c", "h1", "h2")
FEWEST = 5  # lines of a grid, of which one can be left out of a cubic spline


class Interpolant:
    """Splines through the samples of a ResponseSurface.

    Raises
    ------
    InputError : fewer than `FEWEST` lines in a direction
    """

    def __init__(self, surface: ResponseSurface) -> None:
        for name in ("d1", "d2"):
            if getattr(surface, name).size < FEWEST:
                raise InputError(
                    key=name, value=getattr(surface, name).size, allowed=f"at least {FEWEST} values"
                )
        self.surface = surface
        self._splines = {
            name: RectBivariateSpline(surface.d1, surface.d2, getattr(surface, name))
            for name in QUANTITIES
        }

    def __call__(self, name: str, d1: ArrayLike, d2: ArrayLike) -> FloatArray:
        """A quantity of `QUANTITIES` at (d1, d2) [m], broadcast against each other.

        Raises
        ------
        InputError : a point lies outside the surface
        """
        d1, d2 = np.broadcast_arrays(np.asarray(d1, float), np.asarray(d2, float))
        for axis, d in (("d1", d1), ("d2", d2)):
            low, high = getattr(self.surface, axis)[[0, -1]]
            if d.size and not (low <= d.min() and d.max() <= high):
                raise InputError(
                    key=axis,
                    value=f"{d.min():g} to {d.max():g} m",
                    allowed=f"{low:g} to {high:g} m",
                )
        return self._splines[name](d1, d2, grid=False)


@dataclass(frozen=True)
class Error:
    """Estimate for one quantity: of each grid line (NaN at the edges) the largest, and over all
    lines rms and largest.

    Parameters
    ----------
    lines : (n1,) and (n2,) [N or m] of the lines d1 = const and d2 = const
    rms, largest : [N or m]
    """

    lines: tuple
    rms: float
    largest: float


def errors(surface: ResponseSurface) -> dict[str, Error]:
    """Compute the errors of the interpolant of a surface: {quantity: Error}.

    Raises
    ------
    InputError : fewer than `FEWEST` lines in a direction
    """
    Interpolant(surface)
    return {name: _left_out(surface.d1, surface.d2, getattr(surface, name)) for name in QUANTITIES}


def _left_out(d1, d2, values):
    lines = []
    misses = []
    for axis, other, transposed in ((d1, d2, values), (d2, d1, values.T)):
        worst = np.full(axis.size, np.nan)
        for i in range(1, axis.size - 1):
            rest = np.delete(np.arange(axis.size), i)
            spline = RectBivariateSpline(axis[rest], other, transposed[rest])
            miss = spline(axis[i], other)[0] - transposed[i]
            worst[i] = abs(miss).max()
            misses.append(miss)
        lines.append(worst)
    misses = np.concatenate(misses)
    return Error(tuple(lines), float(np.sqrt(np.mean(misses**2))), float(abs(misses).max()))
