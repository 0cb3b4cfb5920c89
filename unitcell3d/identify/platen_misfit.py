"""How far a computed compression between platens is from a measured one, in closure and in
pressure.

The first part of the tests is cut off in the thesis (chapter 7), and no test gives the thickness at
rest or the first touch well: both curves may be moved along the closure as a whole. Their shape is
compared.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import minimize_scalar

from fabrics.base.checks import FloatArray
from fabrics.base.errors import UnstableError
from fabrics.base.record import Record
from fabrics.plate_curve import PlateCurve

POINTS = 16  # of the curve, at equal ratios of pressure
# tried over the closure of the curve, before the best of them is refined
OFFSETS = 81


class PlatenMisfit(NamedTuple):
    """closure : [m] rms at equal pressures; pressure : [-] rms of P / P_measured - 1 at equal
    closures; own offsets."""

    closure: float
    pressure: float


def platen_misfit(
    history: Record, cell_area: float, curve: PlateCurve, pressure: FloatArray | None = None
) -> PlatenMisfit:
    """Compute the misfit of a computed compression between platens; the offset of the closure is
    free in both measures.

    The closure's offset takes the mean of the misfit out; the offset of the pressure's measure is
    the one that makes that measure least. A history that ends early goes on straight in ln P, as in
    `closures`.

    Parameters
    ----------
    history : Record between platens (`cases.biaxial_and_platens.plate_compression`)
    cell_area : [m2] of one crossover
    curve : measured
    pressure : (n,) [Pa] rising, where the curve is read; by default `POINTS` at equal ratios over
        all of it

    Raises
    ------
    UnstableError : no platen was ever pressed
    """
    if pressure is None:
        pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], POINTS)
    measured = curve.at(pressure)
    computed = closures(history, cell_area, pressure, measured)
    pressed, closed = rising(history, cell_area)
    known = np.log(pressed)
    ratio = _pressure_ratios(known, closed, np.log(pressure), measured)
    return PlatenMisfit(_rms(computed - measured), ratio)


def misfit_of_points(
    pressure: FloatArray, closure: FloatArray, measured: FloatArray
) -> PlatenMisfit:
    """Compute the misfit of closures (n,) [m] computed at the pressures (n,) [Pa] of the `measured`
    ones, as `platen_misfit` does."""
    P = np.log(pressure)
    offset = np.mean(closure - measured)
    return PlatenMisfit(
        _rms(closure - offset - measured), _pressure_ratios(P, closure, P, measured)
    )


def closures(
    history: Record, cell_area: float, pressure: FloatArray, measured: FloatArray
) -> FloatArray:
    """Compute what the plates of a history close up to each pressure [Pa], (n,) [m], moved to the
    mean of the `measured` ones.

    Beyond the last pressure that the history reached, the closure goes on as it ended, straight in
    ln P, so that a misfit does not jump where a compression ends early.

    Raises
    ------
    UnstableError : no platen was ever pressed
    """
    pressed, closed = rising(history, cell_area)
    known = np.log(pressed)
    curve = PchipInterpolator(known, closed)
    wanted = np.log(pressure)
    at = curve(np.clip(wanted, known[0], known[-1])) + curve(known[-1], 1) * np.maximum(
        wanted - known[-1], 0
    )
    return at - np.mean(at - measured)


def rising(history: Record, cell_area: float) -> tuple[FloatArray, FloatArray]:
    """Select pressure [Pa] and closure [m] of the steps that press harder than any before: a tip
    that snaps lets the force fall.

    Raises
    ------
    UnstableError : no platen was ever pressed
    """
    pressed = history["F_plate"].mean(axis=1) / cell_area
    steps = np.flatnonzero(pressed > np.concatenate([[0.0], np.maximum.accumulate(pressed)[:-1]]))
    plates = history["plates"]
    if len(steps) < 2:
        raise UnstableError(
            f"the platens were not pressed: {history.failed or 'they never met the yarns'}"
        )
    return pressed[steps], 2 * (plates[0] - plates[steps])


def _pressure_ratios(known, closed, wanted, measured):
    """Least rms of P / P_measured - 1 over the offset between the closures."""
    inverse = PchipInterpolator(closed, known)  # ln P over closure
    ends = closed[0], closed[-1]
    slopes = [max(float(inverse(end, 1)), 0.0) for end in ends]

    def misfit(offset):
        at = measured + offset
        P = inverse(np.clip(at, *ends)) + slopes[0] * np.minimum(at - ends[0], 0)
        return _rms(
            np.expm1(np.minimum(P + slopes[1] * np.maximum(at - ends[1], 0) - wanted, 50.0))
        )

    span = max(ends[1] - ends[0], measured[-1] - measured[0])
    offsets = ends[0] - measured[0] + np.linspace(-span, span, OFFSETS)
    best = offsets[int(np.argmin([misfit(offset) for offset in offsets]))]
    near = 2 * span / (OFFSETS - 1)
    found = minimize_scalar(
        misfit, bounds=(best - near, best + near), method="bounded", options={"xatol": 1e-10}
    )
    return float(min(found.fun, misfit(best)))


def _rms(values):
    return float(np.sqrt(np.mean(np.square(values))))
