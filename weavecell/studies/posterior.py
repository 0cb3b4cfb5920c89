"""What few shots tell of V50 when they alone set no bounds: a posterior, whose prior is said.

    p(V50, s | shots) ~ L(V50, s) p(s),    0 < V50,
    ln (s_T / (m V)) normal with mean 0 and standard deviation ln f

L is the likelihood of `probit`, s_T the standard deviation of the velocity at which panels fail and V
the V50 of the largest likelihood; the median m and the factor f of the prior are those of
inputs.toml. V50 has no prior but that it is above 0. Intervals have equal tails.

The integral over s is a sum over `_SPREADS` values of ln s, that over V50 one over `_PLACES` values
from 8 s below the slowest to 8 s above the fastest shot, beyond which L is nothing. The prior of s
makes it finite: without one, few shots leave any V50 to a curve that is flat enough.
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp, log

import numpy as np

from fabrics.base.checks import FloatArray
from weavecell.studies import inputs

# sums of twice as many change no end of an interval by a hundredth of s (a test)
_SPREADS = 41
_PLACES = 241
# deviations of ln s, and of V, that are summed over
_REACH_OF_SPREAD = 4.0
_REACH = 8.0


def prior() -> tuple[float, float]:
    """Read the prior of s: its median over V50, and the factor of one deviation."""
    entries = inputs.table("prior")
    return entries["spread_over_v50"].value, entries["factor"].value


def prior_words() -> str:
    """Write the prior."""
    median, factor = prior()
    return (
        f"a prior: panels fail within {100 * median:g} % of V50 (standard deviation), log-normal, "
        f"factor {factor:g}"
    )


class Posterior:
    """The posterior of the curve of some shots.

    Parameters
    ----------
    velocity, perforated : (n,) [m/s], bool
    log_cdf : logarithm of the distribution function of the curve, of an array
    deviation : [-] standard deviation of that distribution, s_T / s
    V50 : [m/s] of the largest likelihood
    """

    def __init__(
        self,
        velocity: FloatArray,
        perforated: np.ndarray,
        log_cdf: Callable[[FloatArray], FloatArray],
        deviation: float,
        V50: float,
    ) -> None:
        median, factor = prior()
        of_prior = np.linspace(-_REACH_OF_SPREAD, _REACH_OF_SPREAD, _SPREADS)
        self.s = median * V50 / deviation * np.exp(log(factor) * of_prior)
        low = np.maximum(velocity.min() - _REACH * self.s * deviation, 0.0)
        high = velocity.max() + _REACH * self.s * deviation
        share = (np.arange(_PLACES) + 0.5) / _PLACES
        step = (high - low) / _PLACES
        # (spreads, places)
        self.V50 = low[:, None] + np.outer(high - low, share)
        sign = np.where(perforated, 1.0, -1.0)
        eta = (velocity - self.V50[..., None]) / self.s[:, None, None]
        log_likelihood = log_cdf(sign * eta).sum(axis=-1)
        density = np.exp(log_likelihood - log_likelihood.max())
        self.weight = density * (step * np.exp(-0.5 * of_prior**2))[:, None]
        self.weight /= self.weight.sum()

    def interval(self, z: float, confidence: float) -> tuple[float, float]:
        """Compute the interval [m/s], at least 0, of V_P = V50 + z s."""
        low, high = _interval(self.V50 + z * self.s[:, None], self.weight, confidence)
        return max(low, 0.0), max(high, 0.0)

    def interval_of_spread(self, confidence: float) -> tuple[float, float]:
        """Compute the interval [m/s] of s."""
        # by its logarithm, in which the values are evenly spaced
        low, high = _interval(np.log(self.s), self.weight.sum(axis=1), confidence)
        return exp(low), exp(high)

    def share_below(self, V50: float) -> float:
        """Compute the probability [-] that V50 is below a velocity [m/s]."""
        return float(self.weight[self.V50 < V50].sum())


def _interval(values: FloatArray, weight: FloatArray, confidence: float) -> tuple[float, float]:
    """Interval with equal tails of values of some weights, of any shape."""
    order = np.argsort(values, axis=None, kind="stable")
    ordered = values.ravel()[order]
    mass = weight.ravel()[order]
    middle = np.cumsum(mass) - 0.5 * mass
    tail = 0.5 * (1 - confidence)
    low, high = np.interp((tail, 1 - tail), middle, ordered)
    return float(low), float(high)
