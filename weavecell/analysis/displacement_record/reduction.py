"""Velocity, deceleration, energy and force from a displacement record, each with its error.

A polynomial is fitted by least squares to the samples within a window about each instant (Savitzky and Golay,
Analytical Chemistry 36 (1964) 1627), a cubic for the velocity v and a quartic for the acceleration a. Two errors
remain.

Noise. White noise of the standard deviation s in x gives s |c| in a derivative whose weights are c. s is found from
the third differences of the record, of which white noise leaves sqrt(20) s and a smooth history next to nothing.

Smoothing. What the window rounds off is estimated by a fit of two orders more in the same window, which rounds off
less: the difference of the two beyond what noise makes of it, and its largest within half a window, since the estimate
passes through zero where it changes its sign. At a jump of velocity, which neither follows, it is a quarter of the
error, and within half a window of the ends of a record it is low too.

The windows of v and a are those with the least sum of both errors, squared, over the record: wide where noise rules,
narrow where the history turns.

    absorbed energy  E_a = m (V_s^2 - v^2) / 2,  its error  m |v| dv (+) m V_s dV_s;   force  F = -m a
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from fabrics.errors import InputError
from weavecell.analysis.displacement_record.record import Record

ORDERS = {1: 3, 2: 4}  # of the polynomial for each derivative
CONFIDENT = 1.96  # standard deviations, for 95 %
_LEAST = 11  # samples of a window
_TAIL = 0.05  # of the record, at whose end the residual velocity is read


@dataclass(frozen=True, eq=False)
class Reduction:
    """What a record tells. Errors are half widths at 95 %, smoothing included.

    Parameters
    ----------
    record : Record
    mass : [kg]
    windows : (of v, of a) [s] over which polynomials are fitted
    noise : [m] standard deviation of the displacement
    x, v, a : (n,) [m, m/s, m/s2] displacement, velocity, acceleration
    v_noise, v_smoothing, a_noise, a_smoothing : (n,) their errors
    strike, residual : (value, error) [m/s]; a projectile that is slower than the error at the end has stopped
    """

    record: Record
    mass: float
    windows: tuple[float, float]
    noise: float
    x: np.ndarray
    v: np.ndarray
    a: np.ndarray
    v_noise: np.ndarray
    v_smoothing: np.ndarray
    a_noise: np.ndarray
    a_smoothing: np.ndarray
    strike: tuple[float, float]
    residual: tuple[float, float]

    @property
    def v_error(self) -> np.ndarray:
        return np.hypot(self.v_noise, self.v_smoothing)

    @property
    def a_error(self) -> np.ndarray:
        return np.hypot(self.a_noise, self.a_smoothing)

    @property
    def absorbed(self) -> np.ndarray:
        """(n,) [J] energy that the target has taken."""
        return 0.5 * self.mass * (self.strike[0] ** 2 - self.v**2)

    @property
    def absorbed_error(self) -> np.ndarray:
        """(n,) [J]"""
        return self.mass * np.hypot(self.v * self.v_error, self.strike[0] * self.strike[1])

    @property
    def stopped(self) -> bool:
        return abs(self.residual[0]) <= self.residual[1]


def reduce(record: Record, mass: float, *, window: float | None = None) -> Reduction:
    """Reduce a record.

    Parameters
    ----------
    record : Record
    mass : [kg] of the projectile
    window : [s] for all fits; the best ones if None

    Raises
    ------
    InputError : a mass that is not positive; a window of fewer than 11 samples or longer than half the record
    """
    if not 0 < mass < np.inf:
        raise InputError(key="mass", value=mass, allowed="above 0")
    n, dt = record.t.size, record.dt
    noise = float(np.std(np.diff(record.x, 3)) / np.sqrt(20))
    if window is None:
        widths = tuple(_best_window(record, derivative, noise) for derivative in ORDERS)
    else:
        width = 2 * (round(window / dt) // 2) + 1
        if not _LEAST <= width <= n // 2:
            allowed = f"from {_LEAST * dt:.3g} to {n // 2 * dt:.3g} s"
            raise InputError(key="window", value=window, allowed=allowed)
        widths = (width, width)
    v, a = (_derivative(record, width, derivative, noise) for width, derivative in zip(widths, ORDERS))
    x = _apply(_weights(widths[0], ORDERS[1], 0, dt), record.x)
    strike = _strike(record, v[0], np.hypot(*v[1:]), noise)
    last = slice(-max(3, int(_TAIL * n)), None)
    residual = float(v[0][last].mean()), float(np.hypot(*v[1:])[last].max())
    return Reduction(
        record, mass, (widths[0] * dt, widths[1] * dt), noise, x, v[0], a[0], v[1], v[2], a[1], a[2], strike, residual
    )


def _best_window(record, derivative, noise):
    """Samples of the window with the least error of a derivative over the record; windows grow by a quarter."""
    widths, width = [_LEAST], 1.25 * _LEAST
    while width <= record.t.size // 2:
        widths.append(2 * (int(width) // 2) + 1)
        width *= 1.25
    errors = [np.mean(np.square(_derivative(record, w, derivative, noise)[1:])) for w in widths]
    return widths[int(np.argmin(errors))]


def _derivative(record, width, derivative, noise):
    """A derivative, its error by noise (95 %), and by smoothing."""
    order = ORDERS[derivative]
    own, finer = (_weights(width, n, derivative, record.dt) for n in (order, order + 2))
    fit, difference = _apply(own, record.x), np.abs(_apply(own - finer, record.x))
    spread, apart = (noise * _along(np.linalg.norm(part, axis=1), record.t.size) for part in (own, own - finer))
    smoothing = maximum_filter1d(np.maximum(difference - apart, 0.0), width)
    return fit, CONFIDENT * spread, smoothing


def _weights(width, order, derivative, dt):
    """(width, width) row k: weights of the samples of a window in the derivative at its k-th sample."""
    half = width // 2
    z = np.arange(-half, half + 1) / half
    powers = np.arange(order + 1)
    slopes = np.zeros((width, order + 1))
    for n in powers[derivative:]:
        slopes[:, n] = np.prod(np.arange(n - derivative + 1, n + 1)) * z ** (n - derivative)
    return slopes @ np.linalg.pinv(np.vander(z, order + 1, increasing=True)) / (half * dt) ** derivative


def _apply(weights, x):
    """The weighted sums along a record; at its ends the window stays within it."""
    width, half = len(weights), len(weights) // 2
    middle = np.convolve(x, weights[half][::-1], "valid")
    return np.concatenate([weights[:half] @ x[:width], middle, weights[half + 1 :] @ x[-width:]])


def _along(values, n):
    """(n,) a value for each place in the window, laid along a record of n samples."""
    half = len(values) // 2
    return np.concatenate([values[:half], np.full(n - 2 * half, values[half]), values[half + 1 :]])


def _strike(record, v, error, noise):
    """(velocity, error) [m/s] before the strike: a straight line through the samples there, or the first velocity."""
    before = record.t < 0
    if before.sum() < 10:
        return float(v[0]), float(error[0])
    t = record.t[before]
    slope = np.polyfit(t, record.x[before], 1)[0]
    return float(slope), float(CONFIDENT * noise / np.sqrt(np.sum((t - t.mean()) ** 2)))
