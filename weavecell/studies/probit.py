"""Probability of perforation against strike velocity, fitted to shots that stopped or perforated.

    P(V) = F((V - V50) / s)   with F of the standard normal (probit) or logistic (logit)
                              distribution

V50 and s have the largest likelihood. Where no shot that stopped was faster than one that
perforated, that is a step, s = 0, with V50 anywhere between them: the middle is given. Where the
fastest stop and the slowest perforation have one velocity, the step is there.

Intervals are those of a posterior with a prior of s (`posterior`), whatever the number of shots.
Since P reaches 0 and 1 nowhere, V0 and V100 are taken where it is `LOW` and `HIGH`.

Whether the shots would bound V50 without that prior, or how many more would, is said beside it. It is
asked of at least `ENOUGH` shots, by the penalised likelihood of Firth (1993, Biometrika 80, 27), whose
logarithm is

    l(V50, s) + 1/2 ln det I,   I = sum_k w_k (1, V_k)^T (1, V_k),   w = f^2 / (F (1 - F))

if its profile over V50 falls by half the quantile of chi^2 (1) either way (Heinze and Schemper 2002,
Statistics in Medicine 21, 2409, who use it where outcomes do not mix). The likelihood alone finds s too
small, the more so as the velocities of later shots follow from it, and its intervals are too narrow
(`python -m validation study v50-coverage`).

statsmodels finds the same curves (a test holds them against each other). It is not used here: where
shots are separated it does not converge, and its intervals are those of a normal distribution, too
narrow for few shots.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass
from math import exp, isnan, log, nan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar
from scipy.special import expit, log_expit, log_ndtr, ndtr
from scipy.stats import chi2, logistic, norm

from fabrics.base.checks import FloatArray
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from weavecell.studies.posterior import Posterior, prior_words

LOW = 0.01
HIGH = 0.99
# shares of perforations of the velocities that a curve gives
NAMED = {"V0": LOW, "V50": 0.5, "V100": HIGH}
LINKS = {"probit": norm, "logit": logistic}
# their distribution functions and the logarithms of these, which the methods of scipy.stats wrap in
# many checks
CDF = {"probit": ndtr, "logit": expit}
LOG_CDF = {"probit": log_ndtr, "logit": log_expit}
# ln w of eta, of the logarithms of F (eta) and F (-eta); of the probit but for a constant
LOG_WEIGHT = {
    "probit": lambda eta, below, above: -np.square(eta) - below - above,
    "logit": lambda eta, below, above: below + above,
}
NOT_RISING = "the share of perforations does not grow with the velocity"
# bounds of beta times the range of the velocities
_FLATTEST, _STEEPEST = 1e-3, 1e5
# step of the logarithm of beta with which a search begins
_COARSE = 0.5
# ranges of the velocities beyond which V50 has no bound
_FAR = 100
# least determinant, whose logarithm is finite
_LEAST = 1e-300
# fewest shots that may bound V50 without a prior: of drawn series of 8 half have no bound
ENOUGH = 12
# more shots than so many times those fired are not forecast
_MOST_TIMES = 20


@dataclass(frozen=True)
class Curve:
    """A fitted curve.

    Parameters
    ----------
    link : a name of LINKS
    V50, s : [m/s]
    deviation : [m/s] standard deviation of the velocity at which a panel fails
    intervals : {"V0", "V50", "V100": (low, high) [m/s], "s": (low, high) [m/s]}; 0 or infinite
        where the shots set no bound, and 0 where it would be below; they hold the value itself
    likelihood : its logarithm
    separated : whether no stop was faster than a perforation: the curve is a step, and s 0
    confidence : [-] of the intervals
    by_prior : whether the intervals rest on the prior, without which the shots do not bound V50
    more_shots : how many more shots, if they fall as these, bound V50 without a prior; 0 if these
        do, None if more than can be forecast
    reason : why the shots determine no curve, all of whose numbers are NaN then; "" of a fitted one
    """

    link: str
    V50: float
    s: float
    deviation: float
    intervals: dict
    likelihood: float
    separated: bool
    confidence: float
    by_prior: bool = False
    more_shots: int | None = 0
    reason: str = ""

    def words(self) -> str:
        """Write V50 with its interval, or why there is none."""
        if self.reason:
            return f"V50 ({self.link}) not determined, because {self.reason}"
        step = ""
        if self.separated:
            step = "; no stop is faster than a perforation, a step, s = 0"
        level = f"with {100 * self.confidence:g} % confidence"
        basis = f"by {prior_words()}; {self._forecast_words()}"
        return f"V50 ({self.link}) {self.V50:.1f} m/s, {self.span()} {level}, {basis}{step}"

    def _forecast_words(self):
        """Write whether the shots bound V50 without the prior, or how many more do."""
        if not self.by_prior:
            return "the shots would bound it without a prior too"
        if self.more_shots is None:
            return "the shots alone set no bounds"
        return f"about {counted(self.more_shots, 'more shot')} would bound it without a prior"

    def span(self) -> str:
        """Write the interval of V50."""
        low, high = self.intervals["V50"]
        return f"{low:.1f} to {high:.1f} m/s"

    def velocity(self, probability: Any) -> Any:
        """Compute the velocity [m/s] at which a share `probability` perforates."""
        return self.V50 + self.s * LINKS[self.link].ppf(probability)

    def probability(self, velocity: ArrayLike) -> np.ndarray:
        """Compute the probability [-] of perforation at strike velocities [m/s] of any shape."""
        # a step: half of the panels perforate at V50 itself
        if self.s == 0:
            return np.heaviside(np.asarray(velocity, float) - self.V50, 0.5)
        return CDF[self.link]((np.asarray(velocity, float) - self.V50) / self.s)

    @property
    def V0(self) -> float:
        # a wide curve would have V0 below 0, which no test can show
        return float(np.maximum(self.velocity(LOW), 0.0))

    @property
    def V100(self) -> float:
        return self.velocity(HIGH)


class _Likelihood:
    """Logarithm of the likelihood of some shots, penalised or not, and its profiles.

    Parameters
    ----------
    times : [-] how often each shot was fired, with its outcome
    """

    def __init__(
        self,
        velocity: np.ndarray,
        perforated: np.ndarray,
        link: str,
        *,
        penalised: bool,
        times: float = 1.0,
    ) -> None:
        self.V = velocity
        self.hit = perforated
        self.law = LINKS[link]
        self.log_cdf = LOG_CDF[link]
        self.log_weight = LOG_WEIGHT[link]
        self.penalised = penalised
        self.times = times
        self.range = float(np.ptp(velocity))
        # the slope is searched by its logarithm: it spans eight powers of ten
        self.betas = log(_FLATTEST / self.range), log(_STEEPEST / self.range)
        # [m/s] least s
        self.least = self.range / _STEEPEST

    def __call__(self, at: float, beta: Any) -> Any:
        """Of P(at) = 1/2 and slope beta, a number or an array of any shape."""
        eta = np.multiply.outer(beta, self.V - at)
        # both distributions are even: sf(x) is cdf(-x)
        below = self.log_cdf(eta)
        above = self.log_cdf(-eta)
        found = self.times * np.where(self.hit, below, above).sum(axis=-1)
        if self.penalised:
            found = found + penalty(self.V, self.log_weight(eta, below, above))
        return found

    def maximise_at(self, at: float) -> tuple[float, float]:
        """(largest likelihood, its beta) with P(at) = 1/2."""
        # the penalised one need not have one top
        tried = np.arange(*self.betas, _COARSE)
        near = tried[np.argmax(self(at, np.exp(tried)))]
        top = minimize_scalar(
            lambda t: -self(at, exp(t)),
            bounds=(near - _COARSE, near + _COARSE),
            method="bounded",
            options={"xatol": 1e-6},
        )
        return -float(top.fun), exp(top.x)

    def maximise_with_slope(self, beta: float) -> tuple[float, float]:
        """(largest likelihood, its V50) with slope beta."""
        # a flat curve may have its V50 far outside the shots
        reach = 10 * self.range + 10 / beta
        bounds = float(self.V.min()) - reach, float(self.V.max()) + reach
        top = minimize_scalar(
            lambda at: -self(at, beta),
            bounds=bounds,
            method="bounded",
            options={"xatol": 1e-9 * self.range},
        )
        return -float(top.fun), top.x


def penalty(velocity: FloatArray, log_weight: FloatArray) -> Any:
    """Compute half the logarithm of the determinant of the information on both constants of a
    curve, but for a constant.

    Parameters
    ----------
    velocity : (n,) [m/s]
    log_weight : (..., n) ln w of each shot
    """
    # in units of the largest weight: others may be less than any number
    largest = log_weight.max(axis=-1)
    w = np.exp(log_weight - largest[..., None])
    total = w.sum(axis=-1)
    off = velocity - (np.sum(w * velocity, axis=-1) / total)[..., None]
    return largest + 0.5 * np.log(np.maximum(total * (w * off**2).sum(axis=-1), _LEAST))


def fit(
    velocity: ArrayLike, perforated: ArrayLike, *, link: str = "probit", confidence: float = 0.95
) -> Curve:
    """Fit a curve to shots.

    Parameters
    ----------
    velocity : (n,) [m/s]
    perforated : (n,) bool
    link : a name of LINKS
    confidence : [-] of the intervals

    Returns
    -------
    Curve, with a `reason` and no numbers where the shots determine none

    Raises
    ------
    InputError : velocities that are not numbers, unknown link, or a confidence that is not a share
    """
    V = np.asarray(velocity, float)
    hit = np.asarray(perforated, bool)
    if link not in LINKS:
        raise InputError(key="link", value=link, allowed=" or ".join(LINKS))
    if V.ndim != 1 or V.shape != hit.shape or not np.isfinite(V).all():
        raise InputError("velocities and outcomes must be two rows of the same length, and finite")
    if not 0 < confidence < 1:
        raise InputError(key="confidence", value=confidence, allowed="above 0 and below 1")
    if reason := _no_curve(V, hit):
        return none(link, confidence, reason)
    V50, s, best = _maximise(V, hit, link)
    if isnan(V50):
        return none(link, confidence, NOT_RISING)
    more = _more_shots(_Likelihood(V, hit, link, penalised=True), V50, confidence)
    posterior = posterior_of(V, hit, V50, link)
    intervals = {
        name: posterior.interval(LINKS[link].ppf(P), confidence) for name, P in NAMED.items()
    }
    intervals["s"] = posterior.interval_of_spread(confidence)
    deviation = s * float(LINKS[link].std())
    curve = Curve(
        link,
        V50,
        s,
        deviation,
        intervals,
        best,
        _is_separated(V, hit),
        confidence,
        by_prior=more != 0,
        more_shots=more,
    )
    # a step has s = 0, which no posterior holds
    for name, (low, high) in intervals.items():
        value = getattr(curve, name)
        intervals[name] = min(low, value), max(high, value)
    return curve


def locate(velocity: FloatArray, perforated: np.ndarray) -> float:
    """Find the V50 [m/s] of `fit`, a probit, without its intervals; NaN where the shots determine
    none."""
    if _no_curve(velocity, perforated):
        return nan
    return _maximise(velocity, perforated, "probit")[0]


def _is_separated(V, hit):
    """Whether no stop was faster than a perforation."""
    return bool(V[hit].min() >= V[~hit].max())


def _maximise(V, hit, link):
    """(V50, s [m/s], likelihood) where it is largest; NaN if perforations do not grow with V."""
    likelihood = _Likelihood(V, hit, link, penalised=False)
    # then the likelihood has no maximum: it grows with the slope for ever
    if _is_separated(V, hit):
        return _step(likelihood)
    V50, s, best = _top(likelihood)
    # the search ended at its flattest slope
    if s > 0.5 * likelihood.range / _FLATTEST or V50 < 0:
        return nan, nan, nan
    return V50, s, best


def _no_curve(V, hit):
    """Why shots determine no curve whatever the link, or ""."""
    if hit.all() or not hit.any():
        return f"all {counted(hit.size, 'shot')} {'perforated' if hit.any() else 'stopped'}"
    if np.ptp(V) > 0:
        return ""
    return f"all shots have one velocity, {V[0]:.4g} m/s"


def none(link: str, confidence: float, reason: str) -> Curve:
    """Return the Curve of shots that determine none, with the reason."""
    intervals = dict.fromkeys(("V0", "V50", "V100", "s"), (nan, nan))
    return Curve(link, nan, nan, nan, intervals, nan, False, confidence, reason=reason)


def posterior_of(
    velocity: FloatArray, perforated: np.ndarray, V50: float, link: str = "probit"
) -> Posterior:
    """Compute the posterior of shots whose likelihood is largest at a V50 [m/s]."""
    return Posterior(velocity, perforated, LOG_CDF[link], float(LINKS[link].std()), V50)


def bounds_V50(
    velocity: ArrayLike, perforated: ArrayLike, near: float, confidence: float = 0.95
) -> bool:
    """Tell whether shots are so many, and fall such that they bound V50, looked for from a near one
    [m/s], without a prior."""
    V = np.asarray(velocity, float)
    likelihood = _Likelihood(V, np.asarray(perforated, bool), "probit", penalised=True)
    return V.size >= ENOUGH and _bounds(likelihood, near, confidence)


def _bounds(likelihood, near, confidence):
    """Whether the profile of V50 has fallen far enough at `_FAR` ranges to either side, or at 0."""
    at, _, top = _top_over_V50(likelihood, near)
    reach = _FAR * likelihood.range
    floor = top - 0.5 * float(chi2.ppf(confidence, 1))
    ends = max(at - reach, 0.0), at + reach
    return all(likelihood.maximise_at(end)[0] < floor for end in ends)


def _more_shots(likelihood, near, confidence):
    """How many more shots bound V50, and make it ENOUGH of them, if each shot were fired again as
    often with its outcome; None if more than `_MOST_TIMES` those fired would be needed."""
    fired = likelihood.V.size

    def bounded(more):
        repeated = copy(likelihood)
        repeated.times = (fired + more) / fired
        return fired + more >= ENOUGH and _bounds(repeated, near, confidence)

    most = _MOST_TIMES * fired
    if bounded(0):
        return 0
    if not bounded(most):
        return None
    return bisect_left(range(most), True, lo=1, key=bounded)


def fallen(
    velocity: ArrayLike, perforated: ArrayLike, V50: float, *, link: str = "probit"
) -> float:
    """Compute by how much the logarithm of the likelihood, without a penalty, has fallen from its top
    at a V50 [m/s]: by itself it would leave those of less than half the quantile of chi^2 (1)."""
    V = np.asarray(velocity, float)
    likelihood = _Likelihood(V, np.asarray(perforated, bool), link, penalised=False)
    return _top_over_V50(likelihood, V50)[2] - likelihood.maximise_at(V50)[0]


def band(
    velocity: ArrayLike, perforated: ArrayLike, curve: Curve, probabilities: Iterable[float]
) -> np.ndarray:
    """Compute intervals (k, 2) [m/s] of the velocities at which the shares `probabilities`
    perforate."""
    V = np.asarray(velocity, float)
    hit = np.asarray(perforated, bool)
    law = LINKS[curve.link]
    posterior = posterior_of(V, hit, curve.V50, curve.link)
    return np.array([posterior.interval(law.ppf(P), curve.confidence) for P in probabilities])


def _top(likelihood):
    """(V50, s, likelihood) where it is largest."""
    top = minimize_scalar(
        lambda t: -likelihood.maximise_with_slope(exp(t))[0],
        bounds=likelihood.betas,
        method="bounded",
        options={"xatol": 1e-9},
    )
    best, V50 = likelihood.maximise_with_slope(exp(top.x))
    return float(V50), exp(-top.x), best


def _top_over_V50(likelihood, near):
    """(V50, beta, likelihood) where it is largest, looked for from a near V50."""
    step = 0.05 * likelihood.range
    bracket = near - step, near + step
    top = minimize_scalar(lambda at: -likelihood.maximise_at(at)[0], bracket, tol=1e-6)
    best, beta = likelihood.maximise_at(float(top.x))
    return float(top.x), beta, best


def _step(likelihood):
    """(V50, s = 0, likelihood) of a step, at which a share of the shots of one velocity may have
    perforated."""
    V = likelihood.V
    hit = likelihood.hit
    low = float(V[~hit].max())
    high = float(V[hit].min())
    if low < high:
        return 0.5 * (low + high), 0.0, 0.0
    share = float(hit[low == V].mean())
    V50 = low - likelihood.least * likelihood.law.ppf(share)
    return V50, 0.0, likelihood(V50, 1 / likelihood.least)
