"""Residual velocity against strike velocity: the Lambert-Jonas curve, fitted with confidence
intervals.

    V_r = a (V_s^p - V_bl^p)^(1/p)   above the ballistic limit V_bl,   0 below it

J. P. Lambert, G. H. Jonas, Towards Standardization in Terminal Ballistics Testing: Velocity
Representation, BRL Report 1852 (1976). With p = 2 it is a balance of energy and a^2 the share of
the projectile in the mass that flies on; the larger p, the more abruptly V_r rises at the limit. a
is at most 1: no projectile leaves faster than it came. V_bl is at most the velocity of the slowest
perforation, and at least that of the fastest of the stops that are slower than it: a stop has no
residual velocity to fit, but says that the limit is above it.
Computed here as a V_s (1 - (V_bl / V_s)^p)^(1/p).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares
from scipy.stats import t as student

from fabrics.base.checks import FloatArray
from fabrics.base.counted import counted
from fabrics.base.errors import InputError

NAMES = ("a", "p", "limit")
_LOWEST = {"a": 1e-3, "p": 0.5}
_HIGHEST = {"a": 1.0, "p": 50.0}


@dataclass(frozen=True)
class LambertJonas:
    """A fitted curve.

    Parameters
    ----------
    a, p : [-]
    limit : [m/s] V_bl
    intervals : {name: (low, high)} of the parameters that were fitted, at the level of
        `confidence`, from the curve's slopes at the fit; None for one that came to rest on a bound
        of what is sought, infinite where the shots tell nothing of it. They take the errors of all
        residual velocities as alike and the limit as known, and are too narrow in p where shots
        just above the limit scatter with it (docs/pack.md)
    confidence : [-]
    residual_rms : [m/s] of the fit
    points : number of perforations that it was fitted to
    slowest : [m/s] strike velocity of the slowest perforation, the highest limit that there can be
    fastest_stop : [m/s] strike velocity of the fastest stop below it, the lowest limit that there
        can be; 0 without such a stop
    reason : why the shots determine no curve, all of whose numbers are NaN then; "" of a fitted one
    """

    a: float
    p: float
    limit: float
    intervals: dict
    confidence: float
    residual_rms: float
    points: int
    slowest: float
    fastest_stop: float = 0.0
    reason: str = ""

    def residual_velocity(self, strike_velocity: ArrayLike) -> FloatArray:
        """Compute the residual velocity [m/s] of the curve at strike velocities [m/s] of any
        shape."""
        return curve(np.asarray(strike_velocity, float), self.a, self.p, self.limit)

    def sample(self, highest: float) -> tuple[FloatArray, FloatArray]:
        """Sample the curve: (strike velocities from the limit to `highest`, residual velocities),
        (400,) [m/s] each."""
        # the curve rises steeply at the limit
        strike = self.limit + (highest - self.limit) * np.linspace(0, 1, 400) ** 3
        return strike, self.residual_velocity(strike)

    def words(self, between: str = ", ") -> str:
        """Write the fitted parameters, each with its interval; the reason if that does not exclude
        half of the value."""
        if self.reason:
            return f"not determined, because {self.reason}"
        return between.join(map(self._format_parameter, self.intervals))

    def _format_parameter(self, name):
        value = getattr(self, name)
        interval = self.intervals[name]
        if interval is None:
            # the bounds that are answers: others are no more than ends of the search
            highest = {"a": _HIGHEST["a"], "limit": self.slowest}
            if value == highest.get(name):
                return f"{name} = {value:.3g} (its upper bound)"
            if name == "limit" and value == self.fastest_stop:
                return f"limit = {value:.3g} (its lower bound, the fastest stop)"
            return f"{name} not determined (at the bound {value:.3g} of the search)"
        low, high = interval
        sign = "not determined, about"
        if low > 0.5 * value:
            sign = "="
        return f"{name} {sign} {value:.3g} ({low:.3g} to {high:.3g})"


def curve(strike_velocity: FloatArray, a: float, p: float, limit: float) -> FloatArray:
    """Compute the residual velocity [m/s], (n,) or a number."""
    # below the limit the projectile is stopped
    ratio = np.minimum(limit / strike_velocity, 1.0)
    return a * strike_velocity * (-np.expm1(p * np.log(ratio))) ** (1 / p)


def fit(
    strike_velocity: ArrayLike,
    residual_velocity: ArrayLike,
    *,
    limit: float | None = None,
    confidence: float = 0.95,
) -> LambertJonas:
    """Fit the curve to shots by least squares.

    Parameters
    ----------
    strike_velocity, residual_velocity : (n,) [m/s]; 0 where the projectile was stopped
    limit : [m/s] to hold V_bl at, if it is known; fitted if None
    confidence : [-] of the intervals

    Returns
    -------
    LambertJonas, with a `reason` and no numbers where there are no more perforations than
    parameters, or one of them below the limit

    Raises
    ------
    InputError : shots that are not numbers, or a confidence that is not a share
    """
    vs = np.asarray(strike_velocity, float)
    vr = np.asarray(residual_velocity, float)
    free: tuple[str, ...] = NAMES
    if limit is not None:
        free = NAMES[:2]
    _check(vs, vr, confidence)
    through = vs[vr > 0]
    slowest = float(through.min(initial=inf))
    fastest_stop = float(vs[(vr == 0) & (vs < slowest)].max(initial=0.0))
    reason = ""
    # as many points as parameters are met exactly, and say nothing about scatter
    if through.size <= len(free):
        reason = (
            f"{counted(through.size, 'perforation')} do not determine its {len(free)} parameters"
        )
    elif limit is not None and not 0 < limit < slowest:
        reason = f"a shot perforates at {slowest:.4g} m/s, below the limit, {limit:.4g} m/s"
    if reason:
        none = dict.fromkeys(free)
        bounds = slowest, fastest_stop
        return LambertJonas(nan, nan, nan, none, confidence, nan, through.size, *bounds, reason)
    vs = through
    vr = vr[vr > 0]
    low = np.array([*_LOWEST.values(), max(fastest_stop, 0.1 * slowest)][: len(free)])
    high = np.array([*_HIGHEST.values(), slowest][: len(free)])
    scale = np.array([1.0, 1.0, slowest][: len(free)])

    def full(x):
        if limit is not None:
            return (*x, limit)
        return x

    # the sum of squares can have a valley for each sharpness of the rise: begin in several, keep
    # the deepest
    near = max(0.99 * slowest, 0.5 * (fastest_stop + slowest))
    starts = [[0.95, p, near][: len(free)] for p in (1.2, 2.0, 4.0, 10.0)]
    best = min(
        (
            least_squares(
                lambda x: curve(vs, *full(x)) - vr,
                start,
                bounds=(low, high),
                x_scale=scale,
                xtol=1e-15,
                ftol=1e-15,
                gtol=1e-15,
            )
            for start in starts
        ),
        key=lambda solution: solution.cost,
    )
    # the search ends just short of a bound: a value there is the bound
    best.x = np.where(best.x > high - 1e-9 * (high - low), high, best.x)
    best.x = np.where(best.x < low + 1e-9 * (high - low), low, best.x)
    a, p, at = (float(value) for value in full(best.x))
    intervals = _intervals(best, dict(zip(free, zip(low, high))), len(vs), confidence)
    if fastest_stop > 0 and intervals.get("limit") is not None:
        # the shots themselves say more than the slopes of the curve
        least, most = intervals["limit"]
        intervals["limit"] = max(least, fastest_stop), min(most, slowest)
    rms = float(np.sqrt(np.mean(best.fun**2)))
    return LambertJonas(a, p, at, intervals, confidence, rms, len(vs), slowest, fastest_stop)


def _check(vs, vr, confidence):
    if vs.ndim != 1 or vs.shape != vr.shape:
        raise InputError("strike and residual velocities must be two rows of the same length")
    if not (np.isfinite(vs).all() and np.isfinite(vr).all() and (vs > 0).all() and (vr >= 0).all()):
        raise InputError("strike velocities must be above 0 and residual velocities at least 0")
    if not 0 < confidence < 1:
        raise InputError(key="confidence", value=confidence, allowed="above 0 and below 1")


def _intervals(solution, bounds, points, confidence):
    """Linearised intervals; a parameter on its bound has none, and the others are found with it
    held."""
    low, high = np.transpose([*bounds.values()])
    inside = (low < solution.x) & (solution.x < high) & (solution.active_mask == 0)
    inner = list(np.flatnonzero(inside))
    intervals = dict.fromkeys(bounds)
    J = solution.jac[:, inner]
    freedom = points - len(inner)
    if not inner:
        return intervals
    spread = np.full(len(inner), np.inf)
    # two parameters that do the same have no interval of their own
    if np.linalg.matrix_rank(J) == len(inner):
        spread = np.sqrt(np.diag(np.linalg.inv(J.T @ J)) * 2 * solution.cost / freedom)
    half = student.ppf(0.5 * (1 + confidence), freedom) * spread
    for k, name in enumerate(bounds):
        if k in inner:
            middle = float(solution.x[k])
            reach = float(half[inner.index(k)])
            intervals[name] = (middle - reach, middle + reach)
    return intervals
