"""Probability of perforation against strike velocity, fitted to shots that stopped or perforated.

    P(V) = F((V - V50) / s)   with F of the standard normal (probit) or logistic (logit)
                              distribution

V50 and s have the largest likelihood, intervals those values at which the profile likelihood has
fallen by half the quantile of chi^2 (1): they hold for few shots too, unsymmetric. With beta = 1 /
s, and any V_P = V50 + z_P s in the place of V50, the logarithm of the likelihood is concave in
beta, so that every profile has one top. Since P reaches 0 and 1 nowhere, V0 and V100 are taken
where it is `LOW` and `HIGH`.

Where no shot that stopped was faster than one that perforated, the likelihood is largest for s = 0,
a step, with V50 anywhere between them: the middle is given, and the profile as ever (`intervals`).
That is no interval of confidence: of 70 drawn series of twelve shots with s = 5 m/s, 41 were
separated, and 95 % intervals by the profile held V50 in 56 % of these, against 97 % of the others.
`interval_of` says that such shots set no bounds. Where the fastest stop and the slowest perforation
have one velocity, the step is there.

statsmodels finds the same curves (a test holds them against each other). It is not used here: where
shots are separated it does not converge, and its intervals are those of a normal distribution, too
narrow for few shots.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import exp, inf, log, nan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, minimize_scalar
from scipy.special import expit, log_expit, log_ndtr, ndtr
from scipy.stats import chi2, logistic, norm

from fabrics.base.errors import InputError

LOW = 0.01
HIGH = 0.99
LINKS = {"probit": norm, "logit": logistic}
# their distribution functions and the logarithms of these, which the methods of scipy.stats wrap in
# many checks
CDF = {"probit": ndtr, "logit": expit}
LOG_CDF = {"probit": log_ndtr, "logit": log_expit}
NOT_RISING = "the share of perforations does not grow with the velocity"
# bounds of beta times the range of the velocities
_FLATTEST, _STEEPEST = 1e-3, 1e5


@dataclass(frozen=True)
class Curve:
    """A fitted curve.

    Parameters
    ----------
    link : a name of LINKS
    V50, s : [m/s]
    deviation : [m/s] standard deviation of the velocity at which a panel fails
    intervals : {"V0", "V50", "V100": (low, high) [m/s], "s": (low, high) [m/s]} of the profile
        likelihood; 0 or infinite where the shots set no bound, and 0 where it would be below. What
        is told of a curve is `interval_of`
    likelihood : its logarithm
    separated : whether no stop was faster than a perforation: the curve is a step, and s 0
    confidence : [-] of the intervals
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
    reason: str = ""

    def words(self) -> str:
        """Write V50 with its interval, or why there is none."""
        if self.reason:
            return f"V50 ({self.link}) not determined, because {self.reason}"
        words = f"V50 ({self.link}) {self.V50:.1f} m/s"
        if self.separated:
            most = self.intervals["s"][1]
            return (
                f"{words} without an interval: no stop is faster than a perforation, a step, s = 0 "
                f"(by the likelihood up to {most:.1f} m/s)"
            )
        low, high = self.intervals["V50"]
        return f"{words}, {low:.1f} to {high:.1f} m/s with {100 * self.confidence:g} % confidence"

    def interval_of(self, name: str) -> tuple[float, float]:
        """Return the (low, high) [m/s] of V0, V50, V100 or s at the level of `confidence`; 0 and
        infinity where the outcomes do not mix, which sets no bounds."""
        if self.separated:
            return 0.0, inf
        low, high = self.intervals[name]
        return low, high

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
    """Logarithm of the likelihood of some shots, and its profiles."""

    def __init__(self, velocity: np.ndarray, perforated: np.ndarray, link: str) -> None:
        self.V = velocity
        self.hit = perforated
        self.law = LINKS[link]
        self.log_cdf = LOG_CDF[link]
        self.range = float(np.ptp(velocity))
        # the slope is searched by its logarithm: it spans eight powers of ten
        self.betas = log(_FLATTEST / self.range), log(_STEEPEST / self.range)
        # [m/s] least s
        self.least = self.range / _STEEPEST

    def __call__(self, at: float, beta: float, z: float = 0.0) -> float:
        """Of P(at) = F(z) and slope beta."""
        eta = z + beta * (self.V - at)
        # both distributions are even: sf(x) is cdf(-x)
        return float(self.log_cdf(eta[self.hit]).sum() + self.log_cdf(-eta[~self.hit]).sum())

    def maximise_at(self, at: float, z: float = 0.0) -> tuple[float, float]:
        """(largest likelihood, its beta) with P(at) = F(z)."""
        top = minimize_scalar(
            lambda t: -self(at, exp(t), z),
            bounds=self.betas,
            method="bounded",
            options={"xatol": 1e-9},
        )
        return -top.fun, exp(top.x)

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
        return -top.fun, top.x


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
        return _none(link, confidence, reason)
    likelihood = _Likelihood(V, hit, link)
    # then the likelihood has no maximum: it grows with the slope for ever
    separated = bool(V[hit].min() >= V[~hit].max())
    if separated:
        V50, s, best = _step(likelihood)
    else:
        V50, s, best = _top(likelihood)
        # the search ended at its flattest slope
        if s > 0.5 * likelihood.range / _FLATTEST or V50 < 0:
            return _none(link, confidence, NOT_RISING)
    # profile likelihood: with few shots it is far from a parabola, and so are the intervals
    floor = best - 0.5 * chi2.ppf(confidence, 1)
    intervals = {
        name: interval(likelihood, P, V50 + max(s, likelihood.least) * LINKS[link].ppf(P), floor)
        for name, P in (("V0", LOW), ("V50", 0.5), ("V100", HIGH))
    }
    intervals["s"] = _spread(likelihood, s, floor)
    deviation = s * float(LINKS[link].std())
    return Curve(link, V50, s, deviation, intervals, best, separated, confidence)


def _no_curve(V, hit):
    """Why shots determine no curve whatever the link, or ""."""
    if hit.all() or not hit.any():
        return f"all {hit.size} shots {'perforated' if hit.any() else 'stopped'}"
    if np.ptp(V) > 0:
        return ""
    return f"all shots have one velocity, {V[0]:.4g} m/s"


def _none(link, confidence, reason):
    """The Curve of shots that determine none."""
    intervals = dict.fromkeys(("V0", "V50", "V100", "s"), (nan, nan))
    return Curve(link, nan, nan, nan, intervals, nan, False, confidence, reason)


def band(
    velocity: ArrayLike, perforated: ArrayLike, curve: Curve, probabilities: Iterable[float]
) -> np.ndarray:
    """Compute intervals (k, 2) [m/s] of the velocities at which the shares `probabilities`
    perforate."""
    likelihood = _Likelihood(np.asarray(velocity, float), np.asarray(perforated, bool), curve.link)
    floor = curve.likelihood - 0.5 * chi2.ppf(curve.confidence, 1)
    s = max(curve.s, likelihood.least)
    places = [(P, curve.V50 + s * LINKS[curve.link].ppf(P)) for P in probabilities]
    return np.array([interval(likelihood, P, at, floor) for P, at in places])


def interval(likelihood: _Likelihood, P: float, at: float, floor: float) -> tuple[float, float]:
    """Find the interval (low, high) [m/s], at least 0, between which the profile likelihood of V_P,
    largest at `at`, is above a floor."""
    z = likelihood.law.ppf(P)
    below = lambda V: likelihood.maximise_at(V, z)[0] - floor  # noqa: E731
    return max(_edge(below, at, -likelihood.range), 0.0), _edge(below, at, likelihood.range)


def _edge(above, inside, step):
    """Where a function that is above 0 at `inside` and has one top crosses 0; infinite if it does
    nowhere near."""
    near = inside
    far = inside + 0.05 * step
    while above(far) > 0:
        near = far
        # doubled: an open interval is found in a few steps
        far = inside + 2 * (far - inside)
        if abs(far - inside) > 100 * abs(step):
            if step > 0:
                return inf
            return -inf
    return brentq(above, near, far, xtol=1e-6 * abs(step))


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


def _spread(likelihood, s, floor):
    """(low, high) [m/s] of s, from the profile likelihood of its logarithm; 0 and infinity if there
    is no bound."""
    above = lambda t: likelihood.maximise_with_slope(exp(t))[0] - floor  # noqa: E731
    flattest, steepest = likelihood.betas
    middle = steepest
    if s != 0:
        middle = -log(s)
    high = inf
    if above(flattest) < 0:
        high = exp(-brentq(above, flattest, middle))
    low = 0.0
    if s > 0 and above(steepest) < 0:
        low = exp(-brentq(above, middle, steepest))
    return low, high
