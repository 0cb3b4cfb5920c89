"""Wave fronts along a yarn, read off its recorded history, with the speeds fitted to them.

Longitudinal: in each element, the instant at which the tension passes a threshold, interpolated
between records. In a woven yarn of no crimp it runs at c / sqrt(1 + mass of the crossing yarn over
its own), c / sqrt 2 in a balanced weave (thesis eq. 5-6, erratum E-38). The speed in the fabric at
rest, X / t, is less than that along the yarn by the crimp, and a crimped yarn's front is a shock:
with the tension T behind it and the stretch eps of the fabric there, it runs at sqrt(T / (m eps)),
m being the mass of the fabric per length and yarn (momentum and mass across the jump).

Transverse: at each instant, the foot of the cone about the nose (`shellfabric.loop.cone`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import linregress
from scipy.stats import t as student

from fabrics.base.checks import FloatArray
from shellfabric.loop.histories import FAMILIES, Histories, YarnHistory

# share of the yarn's strength: the tension that counts as the arrival of the longitudinal front
TOE = 0.01
WINDOW = (
    0.15,
    0.85,
)  # part of the yarn, from the impact point to its end, within which speeds are fitted


@dataclass(frozen=True)
class Front:
    """A front, and the straight line through it.

    Parameters
    ----------
    kind : "longitudinal" or "transverse"
    family : "warp" or "weft"
    time, place : (m,) [s, m] of the front; place counts from the impact point
    speed : [m/s] of the line through those within the window; nan if there are fewer than four
    interval : (low, high) [m/s] of the speed, at 95 %
    start : [s] at which the line leaves the impact point
    r2 : coefficient of determination of the line
    """

    kind: str
    family: str
    time: np.ndarray
    place: np.ndarray
    speed: float
    interval: tuple[float, float]
    start: float
    r2: float


def fronts(histories: Histories) -> tuple[Front, ...]:
    """Find the fronts along the warp and the weft yarn nearest the impact point, if such were
    recorded."""
    yarns = [yarn for yarn in map(histories.through, FAMILIES) if yarn is not None]
    return tuple(front(yarn, histories.t) for yarn in yarns for front in (longitudinal, transverse))


def longitudinal(
    yarn: YarnHistory,
    t: FloatArray,
    *,
    threshold: float | None = None,
    window: tuple[float, float] = WINDOW,
) -> Front:
    """Find the arrivals of the longitudinal front.

    Parameters
    ----------
    yarn, t : of Histories
    threshold : [N] of the tension; TOE of the yarn's strength if None
    window : shares of the yarn's length within which the speed is fitted
    """
    if threshold is None:
        threshold = TOE * yarn.strength
    side = yarn.X > 0
    tension = np.vstack(
        [np.zeros(side.sum()), yarn.tension[:, side]]
    )  # at the strike there is none yet
    clock = np.concatenate([[0.0], t])
    reached = (tension >= threshold).any(axis=0)
    k = np.argmax(tension >= threshold, axis=0)[reached]
    column = np.flatnonzero(reached)
    before = tension[k - 1, column]
    after = tension[k, column]
    time = clock[k - 1] + (clock[k] - clock[k - 1]) * (threshold - before) / (after - before)
    return _fit_front("longitudinal", yarn, time, yarn.X[side][reached], window)


def transverse(yarn: YarnHistory, t: FloatArray, *, window: tuple[float, float] = WINDOW) -> Front:
    """Find the feet of the deflected part (`shellfabric.loop.cone`), at the instants that have
    one."""
    radius = yarn.cone_radius
    found = np.isfinite(radius)
    return _fit_front("transverse", yarn, np.asarray(t)[found], radius[found], window)


def _fit_front(kind, yarn, time, place, window):
    end = float(np.abs(yarn.X).max())
    inside = (place >= window[0] * end) & (place <= window[1] * end)
    if np.count_nonzero(inside) < 4 or np.ptp(time[inside]) == 0.0:
        return Front(kind, yarn.family, time, place, np.nan, (np.nan, np.nan), np.nan, np.nan)
    line = linregress(time[inside], place[inside])
    reach = student.ppf(0.975, np.count_nonzero(inside) - 2) * line.stderr
    interval = float(line.slope - reach), float(line.slope + reach)
    start = float(-line.intercept / line.slope)
    r2 = float(line.rvalue**2)
    return Front(kind, yarn.family, time, place, float(line.slope), interval, start, r2)
