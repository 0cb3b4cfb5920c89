"""Which of two panels has the higher V50, from paired shots.

Shot k at panel A and shot k at panel B are at panels drawn with the same random numbers, each at a
velocity of its own. The velocities at which the two fail are taken as normal,

    (T_A, T_B) ~ N((V50_B + D, V50_B), (s_A, s_B), r),  0 <= r <= `MOST_ALIKE`,

and a shot perforates if it is faster than its T. What is made largest is the logarithm of the
likelihood, penalised for each panel by half the logarithm of the determinant of the information on
its two constants (Firth 1993, Biometrika 80, 27; for outcomes that do not mix Heinze and Schemper
2002, Statistics in Medicine 21, 2409). Without the penalty s is found too small, the more so as the
velocities of later shots follow from it, and too small without bound where no stop is faster than a
perforation: then the penalty alone keeps the interval open. The interval of D ends where the largest
over V50_B, s_A, s_B and r has fallen by half the quantile of chi^2 (1). What draws have in common
narrows it by r alone: with r = 0 it is that of two studies that have nothing in common. A shot
without a partner counts alone.

The half width of an interval falls as 1 / sqrt(shots), which `shots_to_decide` uses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, copysign, exp, hypot, inf, log, nan, sqrt
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.special import log_ndtr, ndtr, owens_t
from scipy.stats import chi2

from weavecell.studies import probit

CONFIDENCE = 0.95
# highest correlation that is tried: at 1 the likelihood has no derivative
MOST_ALIKE = 0.98
BETTER, WORSE, UNDECIDED = "better", "worse", "not decided"
# beyond so many shots of each the two are alike for all that is of use
MOST_SHOTS = 10_000
# numbers of shots for which a width is forecast
COUNTS = (10, 20, 40, 80, 160, 320)
# least probability of an outcome, whose logarithm is finite
_LEAST = 1e-300
# steps, each 1.5 times the one before, towards the end of an interval
MOST_STEPS = 16
# share of the range of the velocities, with which a search for s begins
FIRST_SPREAD = 0.03


@dataclass(frozen=True)
class Difference:
    """Difference of V50 of A and B.

    Parameters
    ----------
    value, low, high : [m/s] A less B, and its interval; infinite where there is none
    correlation : [-] r of the largest likelihood
    shots : [-] of each, those of the fewer
    confidence : [-] of the interval
    reason : why there is no difference; "" if there is one
    """

    value: float
    low: float
    high: float
    correlation: float
    shots: int
    confidence: float = CONFIDENCE
    reason: str = ""

    @property
    def verdict(self) -> str:
        """BETTER if A is better with this confidence, WORSE, or UNDECIDED."""
        return judge(self.low, self.high)

    def shots_to_decide(self) -> int | None:
        """Return the number of shots of each after which this difference would be decided; None if
        more than MOST_SHOTS, or if nothing is known of the width."""
        half = half_width_to_zero(self.value, self.low, self.high)
        if not 0 < half < inf or self.value == 0:
            return None
        needed = self.shots * (half / abs(self.value)) ** 2
        if needed > MOST_SHOTS:
            return None
        return max(ceil(needed), self.shots)

    def width_after(self, shots: int) -> float:
        """Forecast the half width [m/s] of the interval after a number of shots of each."""
        return 0.5 * (self.high - self.low) * sqrt(self.shots / shots)


def subtract(
    a: tuple[float, float, float], b: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Compute A less B of two independent (value, low, high), with the interval of the difference
    whose sides are those of the two squared, added and rooted (Newcombe 1998, Statistics in Medicine
    17, 873, method 10)."""
    value = a[0] - b[0]
    low = value - hypot(a[0] - a[1], b[2] - b[0])
    high = value + hypot(a[2] - a[0], b[0] - b[1])
    return value, low, high


def judge(low: float, high: float) -> str:
    """Return BETTER if an interval of a difference is above 0, WORSE below it, else UNDECIDED."""
    if low > 0:
        return BETTER
    if high < 0:
        return WORSE
    return UNDECIDED


def half_width_to_zero(value: float, low: float, high: float) -> float:
    """Return the width of the side of an interval that reaches towards 0; NaN without a value."""
    return value - low if value > 0 else high - value


def compare_shots(
    a: Mapping[int, tuple[float, bool]],
    b: Mapping[int, tuple[float, bool]],
    confidence: float = CONFIDENCE,
) -> Difference:
    """Estimate the difference of V50 of A and B with its interval.

    Parameters
    ----------
    a, b : {number of the drawn panel: (strike velocity [m/s], whether it perforated)}
    confidence : [-] of the interval
    """
    curves = [_fit(shots) for shots in (a, b)]
    fewest = min(len(a), len(b))
    for name, curve in zip("AB", curves):
        if curve.reason:
            reason = f"V50 of {name} is not determined: {curve.reason}"
            return Difference(nan, -inf, inf, nan, fewest, confidence, reason)
    value = curves[0].V50 - curves[1].V50
    found = _Profile(PairedLikelihood(a, b), value, *map(_first_guess, (a, b), curves))
    value, low, high, r = found.interval(0.5 * chi2.ppf(confidence, 1))
    return Difference(value, low, high, r, fewest, confidence)


def _fit(shots):
    velocity, perforated = zip(*shots.values())
    return probit.fit(velocity, perforated)


def _first_guess(shots, curve):
    """(V50, s) [m/s] to begin with; the shots of a step have no s."""
    velocity = [velocity for velocity, _ in shots.values()]
    return curve.V50, max(curve.s, FIRST_SPREAD * float(np.ptp(velocity)))


class _Profile:
    """The likelihood of some shots, largest over all but the difference, which is measured in
    widths, so that the steps of derivatives suit all unknowns."""

    def __init__(self, likelihood, difference, a, b):
        self.likelihood = likelihood
        self.unit = 0.5 * (a[1] + b[1])
        self.V50 = b[0]
        self.start = [difference / self.unit, 0.0, log(a[1]), log(b[1])]

    def _minus(self, difference, V50, log_s_a, log_s_b, r):
        unit = self.unit
        return -self.likelihood(difference * unit, self.V50 + V50 * unit, log_s_a, log_s_b, r)

    def top(self):
        """(largest logarithm of the likelihood, its unknowns)."""
        return self._best(lambda x: self._minus(*x), [[*self.start, r] for r in (0.2, 0.8)], 2)

    def at(self, difference, start):
        """The same at one difference [widths], from the unknowns of a near one."""
        return self._best(lambda x: self._minus(difference, *x), [start], 1)

    def _best(self, function, starts, places):
        bounds = [(None, None)] * places + [(-5, 8), (-5, 8), (0, MOST_ALIKE)]
        settings = {"method": "L-BFGS-B", "bounds": bounds, "options": {"eps": 1e-6}}
        tried = [minimize(function, start, **settings) for start in starts]
        best = min(tried, key=lambda one: one.fun)
        return -best.fun, best.x

    def interval(self, fall):
        """(difference, low, high [m/s], r), the ends where the likelihood has fallen so far."""
        height, (best, *others) = self.top()
        ends = [self._end(best, others, height - fall, step) for step in (-0.5, 0.5)]
        low, high = (end * self.unit for end in ends)
        return float(best) * self.unit, low, high, float(others[-1])

    def _end(self, best, others, floor, step):
        near, start = best, others
        for _ in range(MOST_STEPS):
            far = near + step
            height, found = self.at(far, start)
            if height < floor:
                above = lambda d: self.at(d, start)[0] - floor  # noqa: B023, E731
                return brentq(above, near, far, xtol=1e-3)
            near, start, step = far, found, 1.5 * step
        return copysign(inf, step)


class PairedLikelihood:
    """Logarithm of the likelihood of paired shots; see the module.

    Parameters
    ----------
    a, b : as in `compare_shots`
    """

    def __init__(
        self,
        a: Mapping[int, tuple[float, bool]],
        b: Mapping[int, tuple[float, bool]],
    ) -> None:
        both = sorted(a.keys() & b.keys())
        self.pairs = (*_arrays(a, both), *_arrays(b, both))
        self.alone_a = _arrays(a, sorted(a.keys() - b.keys()))
        self.alone_b = _arrays(b, sorted(b.keys() - a.keys()))
        self.velocities = [np.array([velocity for velocity, _ in of.values()]) for of in (a, b)]

    def penalise(self, panel: int, V50: float, s: float) -> float:
        """Compute half the logarithm of the determinant of the information on b0 and b1 of a panel,
        P = Phi(b0 + b1 V)."""
        V = self.velocities[panel]
        z = (V - V50) / s
        return float(probit.penalty(V, probit.LOG_WEIGHT["probit"](z, log_ndtr(z), log_ndtr(-z))))

    def __call__(
        self, difference: float, V50_b: float, log_s_a: float, log_s_b: float, r: float
    ) -> float:
        s_a, s_b = exp(log_s_a), exp(log_s_b)
        V_a, sign_a, V_b, sign_b = self.pairs
        x = sign_a * (V_a - V50_b - difference) / s_a
        y = sign_b * (V_b - V50_b) / s_b
        found = np.log(np.maximum(bivariate_cdf(x, y, sign_a * sign_b * r), _LEAST)).sum()
        found += self.penalise(0, V50_b + difference, s_a) + self.penalise(1, V50_b, s_b)
        V, sign = self.alone_a
        found += np.log(np.maximum(ndtr(sign * (V - V50_b - difference) / s_a), _LEAST)).sum()
        V, sign = self.alone_b
        found += np.log(np.maximum(ndtr(sign * (V - V50_b) / s_b), _LEAST)).sum()
        return float(found)


def _arrays(shots, numbers):
    """(velocities (n,) [m/s], 1 for each perforation and -1 for each stop) of some numbers."""
    velocity = np.array([shots[number][0] for number in numbers], float)
    perforated = np.array([shots[number][1] for number in numbers], bool)
    return velocity, np.where(perforated, 1.0, -1.0)


def bivariate_cdf(x: Any, y: Any, r: Any) -> np.ndarray:
    """Compute P(X < x, Y < y) of two standard normal variables with correlation r, by Owen's T
    (Owen 1956, Annals of Mathematical Statistics 27, eq. 2.1).

    Parameters
    ----------
    x, y, r : (n,), |r| < 1
    """
    # the formula is for arguments other than 0
    x = np.where(np.abs(x) < 1e-12, 1e-12, x)
    y = np.where(np.abs(y) < 1e-12, 1e-12, y)
    root = np.sqrt(1 - np.square(r))
    of_x = owens_t(x, (y / x - r) / root)
    of_y = owens_t(y, (x / y - r) / root)
    return 0.5 * (ndtr(x) + ndtr(y)) - of_x - of_y - 0.5 * (x * y < 0)


def forecast_widths(
    difference: Difference, counts: Sequence[int] = COUNTS
) -> list[tuple[int, float, str]]:
    """Forecast (shots of each, half width [m/s] of the interval, verdict if the difference stays)
    for numbers of shots; nothing where the shots set no width."""
    if not np.isfinite([difference.low, difference.high]).all():
        return []
    rows = []
    for count in counts:
        shrink = sqrt(difference.shots / count)
        ends = [
            difference.value + shrink * (end - difference.value)
            for end in (difference.low, difference.high)
        ]
        rows.append((count, difference.width_after(count), judge(*ends)))
    return rows
