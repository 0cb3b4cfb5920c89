"""V50 of a pack from the residual velocities of a few shots about its limit.

A change of 1e-6 grows by e in a microsecond once plies are torn, so that shots of one pack scatter
like tests: each has a limit T of its own, normal about V50. A stop at V says T > V; a perforation
tells T by its residual velocity, by the curve of Lambert and Jonas,

    T = (V^p - (V_r / a)^p)^(1/p),   T ~ N(V50, s)

Priors are flat in V50, log s, log p and a (Gelman et al., Bayesian Data Analysis, 3.2: without stops,
p and a known it is Student's t); V50 is the posterior's median, the interval between its quantiles.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import log_ndtr

if TYPE_CHECKING:
    from weavecell.studies.ballistic_limit import Shot

# strike velocities of the shots that tell V50, over the upper end of the bracket, and their number
ABOVE = 1.03, 1.15
SHOTS = 8
# width of the bracket of a pack, as a share of the first guess
BRACKET = 0.05
# by which single shots of a pack scatter, as a share of the limit (docs/reports/packs.md)
SCATTER = 0.02
# shots faster than this share of the slowest perforation tell the shape of the curve, not V50
NEAR = 1.25
# perforations without which there is no estimate
LEAST = 4
CONFIDENCE = 0.95
# ends of p, of a, and of s over the mean of the velocities
_SHAPES = 1.5, 8.0
_SHARES = 0.5, 1.0
_SPREADS = 2e-3, 0.2
# numbers of V50, s, p and a at which the posterior is computed, so many times, each where it has not
# been negligible before
_GRID = 45, 15, 17, 11
_PASSES = 3
_NEGLIGIBLE = 1e-5
# share of V^p that a residual velocity takes, at most
_MOST = 1 - 1e-9


@dataclass(frozen=True)
class PackV50:
    """V50 of a pack.

    Parameters
    ----------
    velocity, low, high : [m/s] median, and ends of the interval
    spread : [m/s] median of s, the standard deviation of the limits of single shots
    shots, perforations : [-] numbers that it rests on
    confidence : [-] of the interval
    """

    velocity: float
    low: float
    high: float
    spread: float
    shots: int
    perforations: int
    confidence: float = CONFIDENCE

    def words(self) -> str:
        """Write V50 with its interval."""
        return (
            f"V50 {self.velocity:.1f} m/s, {self.low:.1f} to {self.high:.1f} m/s with "
            f"{100 * self.confidence:g} % confidence; single shots scatter by {self.spread:.1f} m/s"
        )


def of_shots(shots: Iterable[Shot]) -> PackV50 | None:
    """Estimate V50 from the shots of a search; None of too few perforations."""
    fired = list(shots)
    residuals = [shot.residual_velocity if shot.perforated else 0.0 for shot in fired]
    return estimate([shot.strike_velocity for shot in fired], residuals)


def estimate(strike_velocity: ArrayLike, residual_velocity: ArrayLike) -> PackV50 | None:
    """Estimate V50.

    Parameters
    ----------
    strike_velocity, residual_velocity : (n,) [m/s]; 0 where the projectile was stopped

    Returns
    -------
    PackV50, or None if fewer than `LEAST` shots perforated within `NEAR` of the slowest perforation
    """
    V = np.asarray(strike_velocity, float)
    left = np.asarray(residual_velocity, float)
    if not (left > 0).any():
        return None
    near = V <= NEAR * V[left > 0].min()
    V = V[near]
    left = left[near]
    through = left > 0
    if through.sum() < LEAST:
        return None
    # V50, the logarithms of s and p, and a
    ends = [
        (0.6 * V.min(), 1.1 * V.max()),
        np.log(V.mean() * np.array(_SPREADS)),
        np.log(_SHAPES),
        _SHARES,
    ]
    for _ in range(_PASSES):
        # each pass looks closer at what the one before left
        axes = [np.linspace(low, high, count) for (low, high), count in zip(ends, _GRID)]
        found = _log_posterior(V[through], left[through], V[~through], *np.ix_(*axes))
        weight = np.exp(found - found.max())
        alone = [
            weight.sum(axis=tuple(set(range(weight.ndim)) - {own})) for own in range(weight.ndim)
        ]
        ends = [_support(places, of_one) for places, of_one in zip(axes, alone)]
    low, value, high = _quantiles(axes[0], alone[0])
    spread = float(np.exp(_quantiles(axes[1], alone[1])[1]))
    return PackV50(value, low, high, spread, V.size, int(through.sum()))


def _log_posterior(V, residual, stopped, V50, log_s, log_p, a):
    """Logarithm of the posterior of V50, log s, log p and a, by perforations at V and stops."""
    s = np.exp(log_s)
    p = np.exp(log_p)
    found = np.zeros(np.broadcast_shapes(V50.shape, s.shape, p.shape, a.shape))
    for velocity, left in zip(V, residual):
        # no limit is below 0: such an a is impossible
        share = np.minimum((left / (a * velocity)) ** p, _MOST)
        limit = velocity * (1 - share) ** (1 / p)
        # a density of V_r: dT / dV_r = (V_r / (a T))^(p - 1) / a
        slope = (p - 1) * np.log(left / (a * limit)) - np.log(a)
        found += -0.5 * ((limit - V50) / s) ** 2 - log_s + slope
        found = np.where(share < _MOST, found, -np.inf)
    for velocity in stopped:
        found += log_ndtr((V50 - velocity) / s)
    return found


def _support(places, weights):
    """Places between which the weights are not negligible, and one step more."""
    inside = np.flatnonzero(weights > _NEGLIGIBLE * weights.max())
    return places[max(inside[0] - 1, 0)], places[min(inside[-1] + 1, places.size - 1)]


def _quantiles(places, weights):
    """Lower end of the interval, median and upper end of weights at places."""
    # the share below a place has half of its own weight
    share = (np.cumsum(weights) - 0.5 * weights) / weights.sum()
    tail = 0.5 * (1 - CONFIDENCE)
    return tuple(float(np.interp(q, share, places)) for q in (tail, 0.5, 1 - tail))
