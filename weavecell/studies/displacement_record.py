"""The record of a projectile's displacement, smoothed: velocity, energy, force, each with its error.

Differences of a record amplify its noise. A smoothing spline (scipy, `make_smoothing_spline`) is
linear in the record: velocity f', acceleration f''. The error of each quantity has two parts:

    random   its standard deviation by noise of the residual's size, over repeated draws;
    smooth   what the spline takes off: the quantity of the smoothed curve less that of the curve
             smoothed once more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from scipy.interpolate import BSpline, make_smoothing_spline

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError
from fabrics.base.tables import read_columns

FEWEST = 20
# of the polynomial whose rest is smoothed
DEGREE = 4
DRAWS = 100
SEED = 1
# of a standard deviation: an interval of 95 %
WIDTH = 1.96


@dataclass(frozen=True, eq=False)
class Motion:
    """A projectile's motion from its record.

    Parameters
    ----------
    time : (n,) [s]
    measured : (n,) [m] displacement as recorded, along the flight
    displacement, velocity, force : (n,) [m], [m/s], [N], smoothed; the force slows down
    velocity_error, force_error : (n,) [m/s], [N] half widths of 95 %, random and smoothing together
    mass : [kg]
    noise : [m] standard deviation of the record about the curve
    bandwidth : [Hz] at which half of an oscillation passes
    chosen : "cross-validation" or "given"
    """

    time: FloatArray
    measured: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    force: FloatArray
    velocity_error: FloatArray
    force_error: FloatArray
    mass: float
    noise: float
    bandwidth: float
    chosen: str

    @property
    def energy(self) -> FloatArray:
        """(n,) [J] kinetic."""
        return 0.5 * self.mass * self.velocity**2

    @property
    def energy_error(self) -> FloatArray:
        """(n,) [J] half width of 95 %."""
        return self.mass * abs(self.velocity) * self.velocity_error

    @property
    def absorbed_energy(self) -> float:
        """[J] lost from the first to the last instant."""
        return float(self.energy[0] - self.energy[-1])

    @property
    def absorbed_energy_error(self) -> float:
        """[J] half width of 95 %, of both ends together."""
        return float(np.hypot(*self.energy_error[[0, -1]]))

    @property
    def greatest_force_error(self) -> float:
        """[N] half width of 95 % where the force is greatest."""
        return float(self.force_error[int(self.force.argmax())])


def read(path: FilePath) -> tuple[FloatArray, FloatArray]:
    """Read a CSV with the columns time and displacement: (n,) [s], (n,) [m].

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    column = read_columns(
        path, {"time": "s", "displacement": "m"}, what="a record of a shot", example="time [us]"
    )
    time = column["time"]
    if len(time) < FEWEST:
        raise InputError(file=path, key="rows", value=len(time), allowed=f"at least {FEWEST}")
    steps = np.diff(time)
    if not steps.min() > 0:
        line = column.table.place(int(np.argmin(steps)) + 1)
        raise InputError(file=path, key="time", value=line, allowed="rising")
    return time, column["displacement"]


def reduce(
    time: FloatArray, displacement: FloatArray, mass: float, bandwidth: float | None = None
) -> Motion:
    """Smooth a record.

    The spline minimises

        sum_i (z_i - f(t_i))^2 + lambda int f''(t)^2 dt

    over what a polynomial of degree 4 leaves of the record, since a spline alone is straight at
    both ends. At an even spacing dt it passes 1 / (1 + lambda dt omega^4) of a frequency, a half at
    the

        bandwidth = (lambda dt)^(-1/4) / (2 pi).

    Parameters
    ----------
    time, displacement : (n,) [s], rising; (n,) [m] along the flight
    mass : [kg] of the projectile
    bandwidth : [Hz]; by generalised cross-validation if it is None

    Raises
    ------
    InputError : a bandwidth that the spacing of the record does not resolve
    """
    # in units of the spacing and of what the projectile moves, so that no number is tiny
    dt = float(np.mean(np.diff(time)))
    span = float(np.ptp(displacement))
    x = (time - time[0]) / dt
    y = displacement / span
    weight = None
    chosen = "cross-validation"
    if bandwidth is not None:
        highest = 0.5 / dt
        lowest = 1 / (time[-1] - time[0])
        if not lowest < bandwidth < highest:
            allowed = (
                f"between {lowest:.3g} and {highest:.3g} Hz, one over the record and half the rate"
            )
            raise InputError(key="bandwidth", value=f"{bandwidth:g} Hz", allowed=allowed)
        weight = (2 * np.pi * bandwidth * dt) ** -4.0
        chosen = "given"

    def smooth(values: FloatArray) -> _Curve:
        return _Curve.through(x, values, weight)

    curve = smooth(y)
    if weight is None:
        weight = curve.weight()
    scale = (span, span / dt, -mass * span / dt**2)
    parts = [curve.derivative(order) for order in range(3)]
    freedom = _freedom(smooth, len(x))
    noise = float(np.sqrt(np.sum((y - parts[0]) ** 2) / max(len(x) - freedom, 1.0)))
    again = smooth(parts[0])
    rng = np.random.default_rng(SEED)
    drawn = [smooth(noise * rng.standard_normal(len(x))) for _ in range(DRAWS)]
    errors = []
    for order in (1, 2):
        random = np.std([one.derivative(order) for one in drawn], axis=0)
        smoothing = parts[order] - again.derivative(order)
        errors.append(abs(scale[order]) * np.hypot(WIDTH * random, smoothing))
    return Motion(
        time=time,
        measured=displacement,
        displacement=scale[0] * parts[0],
        velocity=scale[1] * parts[1],
        force=scale[2] * parts[2],
        velocity_error=errors[0],
        force_error=errors[1],
        mass=mass,
        noise=span * noise,
        bandwidth=float(weight**-0.25 / (2 * np.pi * dt)),
        chosen=chosen,
    )


@dataclass(frozen=True, eq=False)
class _Curve:
    """A polynomial and the smoothing spline of what it leaves, at the places x."""

    x: FloatArray
    trend: Polynomial
    left: FloatArray
    spline: BSpline

    @classmethod
    def through(cls, x: FloatArray, values: FloatArray, weight: float | None) -> _Curve:
        """Smooth some values; lambda by cross-validation if it is None."""
        trend = Polynomial.fit(x, values, DEGREE)
        left = values - trend(x)
        return cls(x, trend, left, make_smoothing_spline(x, left, lam=weight))

    def derivative(self, order: int) -> FloatArray:
        """Compute a derivative (n,) at the places; order 0 is the curve itself."""
        if order == 0:
            return self.trend(self.x) + self.spline(self.x)
        return self.trend.deriv(order)(self.x) + self.spline.derivative(order)(self.x)

    def weight(self) -> float:
        """Find the lambda of the spline, which scipy does not return: the spline is stationary, so
        its residual projected on it is lambda times its bending energy."""
        x = self.x
        bent = self.spline.derivative(2)
        # the square of a piecewise linear function between knots is exact by Simpson's rule
        middle = bent(0.5 * (x[1:] + x[:-1])) ** 2
        squares = bent(x) ** 2
        energy = np.sum(np.diff(x) * (squares[1:] + squares[:-1] + 4 * middle) / 6)
        curve = self.spline(x)
        # an oscillation of half the rate passes at the least
        return max(float(np.sum((self.left - curve) * curve) / energy), np.pi**-4.0)


def _freedom(smooth: Callable[[FloatArray], _Curve], n: int) -> float:
    """Estimate the trace of the smoother, its degrees of freedom, by random signs (Hutchinson)."""
    rng = np.random.default_rng(SEED)
    signs = rng.choice([-1.0, 1.0], (20, n))
    return float(np.mean([row @ smooth(row).derivative(0) for row in signs]))
