"""What shots tell of V50: a posterior, whose prior is said.

    p(V50, s | shots) ~ L(V50, s) p(s),    0 < V50,
    ln (s_T / (m V)) normal with mean 0 and standard deviation ln f

L is the likelihood of `probit`, s_T the standard deviation of the velocity at which panels fail and V
the V50 of the largest likelihood; the median m and the factor f of the prior are those of
inputs.toml. V50 has no prior but that it is above 0. Intervals have equal tails.

The integral over s is a sum over `_SPREADS` values of ln s, that over V50 one over `_PLACES` values
from 8 s below the slowest to 8 s above the fastest shot, beyond which L is nothing; and once more
over that part of both which holds all but a trace. The prior of s makes it finite: without one, few
shots leave any V50 to a curve that is flat enough.

All numbers of shots have this interval. One that is chosen by the outcomes holds too few: of up and
down series of 12 and 20 shots with s of 8 % those whose likelihood alone bounds V50 are those that
found s too small, and its interval, Firth's, held V50 in 79 and 83 % of them. The prior is wider
than what panels show, 1 to 8 %, since few shots that found s too small cannot tell: with a median
of 3 % intervals held V50 in 86 to 94 % of series with 8 % (`python -m validation study
v50-coverage`).
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp, inf, log

import numpy as np

from fabrics.base.checks import FloatArray
from weavecell.studies import inputs

# sums of twice as many change no end of an interval by a hundredth of s (a test)
_SPREADS = 41
_PLACES = 241
# deviations of ln s, and of V, that are summed over
_REACH_OF_SPREAD = 4.0
_REACH = 8.0
# share of the largest weight, below which a sum leaves out
_TRACE = 1e-8


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
        self._velocity = velocity
        self._sign = np.where(perforated, 1.0, -1.0)
        self._log_cdf = log_cdf
        self._deviation = deviation
        self._V50 = V50
        of_prior = np.linspace(-_REACH_OF_SPREAD, _REACH_OF_SPREAD, _SPREADS)
        self._add_up(of_prior, 0.0, inf)
        self._add_up(*self._find_support(of_prior))

    def _add_up(self, of_prior, lowest, highest):
        """Set s, V50 and weight: sums over deviations of ln s (spreads,), and over V50 [m/s] from a
        lowest to a highest."""
        median, factor = prior()
        self.s = median * self._V50 / self._deviation * np.exp(log(factor) * of_prior)
        beyond = _REACH * self.s * self._deviation
        low = np.maximum(self._velocity.min() - beyond, lowest)
        high = np.maximum(np.minimum(self._velocity.max() + beyond, highest), low)
        share = (np.arange(_PLACES) + 0.5) / _PLACES
        self._step = (high - low) / _PLACES
        # (spreads, places)
        self.V50 = low[:, None] + np.outer(high - low, share)
        eta = (self._velocity - self.V50[..., None]) / self.s[:, None, None]
        log_likelihood = self._log_cdf(self._sign * eta).sum(axis=-1)
        density = np.exp(log_likelihood - log_likelihood.max())
        self.weight = density * (self._step * np.exp(-0.5 * of_prior**2))[:, None]
        self.weight /= self.weight.sum()

    def _find_support(self, of_prior):
        """The arguments of `_add_up` for what holds all but a trace, a step wider on each side."""
        spreads = self.weight.sum(axis=1)
        held = np.flatnonzero(spreads > _TRACE * spreads.max())
        step = of_prior[1] - of_prior[0]
        finer = np.linspace(of_prior[held[0]] - step, of_prior[held[-1]] + step, _SPREADS)
        places = self.V50[self.weight > _TRACE * self.weight.max()]
        wider = float(self._step[held].max())
        return finer, max(float(places.min()) - wider, 0.0), float(places.max()) + wider

    def interval(self, z: float, confidence: float) -> tuple[float, float]:
        """Compute the interval [m/s], at least 0, of V_P = V50 + z s."""
        low, high = _interval(self.V50 + z * self.s[:, None], self.weight, confidence)
        return max(low, 0.0), max(high, 0.0)

    def interval_of_spread(self, confidence: float) -> tuple[float, float]:
        """Compute the interval [m/s] of s."""
        # by its logarithm, in which the values are evenly spaced
        low, high = _interval(np.log(self.s), self.weight.sum(axis=1), confidence)
        return exp(low), exp(high)


def _interval(values: FloatArray, weight: FloatArray, confidence: float) -> tuple[float, float]:
    """Interval with equal tails of values of some weights, of any shape."""
    order = np.argsort(values, axis=None, kind="stable")
    ordered = values.ravel()[order]
    mass = weight.ravel()[order]
    middle = np.cumsum(mass) - 0.5 * mass
    tail = 0.5 * (1 - confidence)
    low, high = np.interp((tail, 1 - tail), middle, ordered)
    return float(low), float(high)
