"""The ballistic limit over all that is drawn: place, roll, frictions that nobody gave, yarns and panels.

Each shot is fired at a panel of its own (`strengths.draw_panel`). The limit of a panel is a plane in what
is known of it, the place and the drawn frictions, with a normal rest, which is the strength of its yarns. A stop
says that the limit lies above the strike velocity, a perforation that it lies below: a probit. All
unknowns have weak priors, so that a few shots are enough. As soon as outcomes differ each shot is placed
beside the limit that is expected of its own panel, where its outcome tells most. Residual velocities are
not used: by Lambert's and Jonas' law without a factor they put limits of S-728 7 % too high.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.special import log_ndtr, ndtr, ndtri

from fabrics.base.checks import FloatArray

CONFIDENCE = 0.9
SCATTER = 0.07  # [-] of the guess: standard deviation of the rest, as it is guessed; a factor e^0.5 either way
REACH = 0.2  # [-] of the guess: standard deviation of what the whole range of a known one moves
FIRST = 0.5  # [-] of the guess: standard deviation of the limit itself
BESIDE = 1.0  # [standard deviations] of a shot from the limit of its panel, below and above in turn
WALK = 1.3  # factor to the next shot as long as outcomes are alike
OPENING = (
    0.6,
    0.9,
)  # [-] of the guess: the first round; it is high of narrow noses, which push yarns aside
LEVELS = 0.1, 0.5, 0.9
STRENGTH = "strength of yarns"  # what is not known of a panel


class Span(NamedTuple):
    """A number with its interval of CONFIDENCE."""

    value: float
    low: float
    high: float

    def words(self, unit: str = "m/s") -> str:
        """Write it with its interval."""
        middle = f"{self.value:.3g} {unit}".rstrip()
        return f"{middle} ({self.low:.3g} to {self.high:.3g})"


@dataclass(frozen=True)
class Outcomes:
    """What shots tell.

    Parameters
    ----------
    names : of what is known of each panel
    known : (n, names) [-] about 0
    velocity : (n,) [m/s]
    perforated : (n,)
    """

    names: tuple[str, ...]
    known: FloatArray
    velocity: FloatArray
    perforated: FloatArray

    @property
    def mixed(self) -> bool:
        """Whether some stop and some perforate."""
        return 0 < self.perforated.sum() < self.perforated.size


@dataclass(frozen=True)
class Limits:
    """Limits of panels as far as shots tell them: a normal approximation of the posterior.

    Parameters
    ----------
    shots : Outcomes
    guess : [m/s] of which the priors are shares
    """

    shots: Outcomes
    guess: float

    @cached_property
    def scale(self) -> FloatArray:
        """[m/s] of one deviation of the prior of each constant of the plane."""
        return self.guess * np.array([FIRST, *[REACH] * len(self.shots.names)])

    @cached_property
    def _fit(self):
        """(mode, covariance) in deviations of the prior."""
        X, V = _columns(self.shots.known), self.shots.velocity
        sign = np.where(self.shots.perforated, 1.0, -1.0)
        d = X.shape[1]

        def cost(p):
            s = self.scatter(p)
            lost = 0.5 * (p[:d] ** 2).sum() + 0.5 * (p[d] / 0.5) ** 2
            return lost - log_ndtr(sign * (V - self.of(self.shots.known, p)) / s).sum()

        mode = minimize(cost, np.zeros(d + 1), method="BFGS", options={"maxiter": 100}).x
        values, vectors = np.linalg.eigh(_curvature(cost, mode))
        # the prior alone curves by 1 in each direction of the plane
        return mode, (vectors / np.maximum(values, 0.3)) @ vectors.T

    def of(self, known: FloatArray, p: FloatArray | None = None) -> FloatArray:
        """Return mean limits [m/s] of panels."""
        p = self._fit[0] if p is None else p
        return _columns(known) @ (p[:-1] * self.scale) + self.guess

    def scatter(self, p: FloatArray | None = None) -> float:
        """[m/s] of limits of panels of which the same is known."""
        p = self._fit[0] if p is None else p
        return float(self.guess * SCATTER * np.exp(p[-1]))

    @cached_property
    def drawn(self) -> FloatArray:
        """(1 + 200, constants) the mode, and draws of the posterior."""
        mode, covariance = self._fit
        rng = np.random.default_rng(0)
        return np.vstack([mode, rng.multivariate_normal(mode, covariance, 200)])

    def levels(self, population: FloatArray) -> FloatArray:
        """(201, LEVELS) [m/s] that these shares of a population of panels stop, of `drawn`."""
        z = ndtri((np.arange(32) + 0.5) / 32)
        found = []
        for p in self.drawn:
            limits = self.of(population, p)[:, None] + self.scatter(p) * z
            found.append(np.quantile(limits, LEVELS))
        return np.array(found)

    def passing(self, velocities: FloatArray, population: FloatArray) -> FloatArray:
        """(201, n) [-] probabilities of perforation at velocities [m/s], of `drawn`."""
        found = []
        for p in self.drawn:
            apart = (np.asarray(velocities)[:, None] - self.of(population, p)) / self.scatter(p)
            found.append(ndtr(apart).mean(axis=1))
        return np.array(found)

    def widths(self, population: FloatArray) -> dict[str, float]:
        """[m/s] between the limits that 5 and 95 % have below them, of what is known and of the rest
        alone: medians of the posterior."""
        part = 0.5 * (1 - CONFIDENCE)
        low, high = np.quantile(population, (part, 1 - part), axis=0)
        plane = np.abs(self.drawn[1:, 1:-1] * self.scale[1:]) * (high - low)
        rest = -2 * ndtri(part) * np.array([self.scatter(p) for p in self.drawn[1:]])
        found = np.median(np.column_stack([plane, rest]), axis=0)
        return dict(zip((*self.shots.names, STRENGTH), map(float, found)))

    def shares(self, population: FloatArray) -> dict[str, Span]:
        """Shares [-] of the variance of limits, by what is known and the rest: medians, since the mode may
        have no share of one at all."""
        found = []
        for p in self.drawn:
            parts = np.append(
                (p[1:-1] * self.scale[1:] * population.std(axis=0)) ** 2, self.scatter(p) ** 2
            )
            found.append(parts / parts.sum())
        spans = _spans(np.array(found), median=True)
        return dict(zip((*self.shots.names, STRENGTH), spans))


@dataclass(frozen=True)
class LimitPosterior:
    """What shots tell of the limit of all that is drawn: velocities at which shares of it pass.

    Parameters
    ----------
    limits : Limits
    population : (m, names) what is known of panels, as it is drawn
    """

    limits: Limits
    population: FloatArray

    @cached_property
    def velocities(self) -> dict[str, Span]:
        """{"V10": Span [m/s]} of LEVELS."""
        spans = _spans(self.limits.levels(self.population))
        return {f"V{100 * level:.0f}": span for level, span in zip(LEVELS, spans)}

    def passing(self, velocities: FloatArray) -> list[Span]:
        """Probability of perforation at velocities [m/s]."""
        return _spans(self.limits.passing(velocities, self.population))

    @cached_property
    def shares(self) -> dict[str, Span]:
        """{what is drawn: share of the variance}, the largest first."""
        found = self.limits.shares(self.population)
        return dict(sorted(found.items(), key=lambda item: -item[1].value))

    @cached_property
    def widths(self) -> dict[str, float]:
        """{what is drawn: [m/s] by which the middle 90 % of it alone moves the limit}, two digits."""
        found = self.limits.widths(self.population)
        return {name: float(f"{width:.2g}") for name, width in found.items()}

    def words(self) -> str:
        """Write the velocities in one line, V50 first."""
        named = {name: f"{name} {span.words('')}" for name, span in self.velocities.items()}
        middle = self.velocities["V50"].words()
        others = f"{named['V10']}, {named['V90']}"
        return f"V50 {middle}; {others}; {100 * CONFIDENCE:g} % intervals"


def subtract(a: LimitPosterior, b: LimitPosterior) -> Span:
    """Return V50 of one less that of another."""
    half = LEVELS.index(0.5)
    of_a, of_b = (one.limits.levels(one.population)[:, half] for one in (a, b))
    # the draws of the two posteriors begin with the same random numbers
    other = np.random.default_rng(1).permutation(of_b[1:])
    return _spans(np.append(of_a[0] - of_b[0], of_a[1:] - other)[:, None])[0]


def fit(shots: Outcomes, guess: float) -> Limits:
    """Fit twice: the priors are shares of the limit, so the second fit takes that of the first as guess."""
    middle = np.median(Limits(shots, guess).of(shots.known))
    return Limits(shots, float(np.clip(middle, 0.3 * guess, 3 * guess)))


def place(shots: Outcomes | None, known: FloatArray, guess: float) -> FloatArray:
    """Choose the velocities [m/s] of the next round.

    Parameters
    ----------
    shots : Outcomes so far; None before the first round
    known : (n, names) of the panels of the round
    guess : [m/s] of the limit
    """
    count = len(known)
    if shots is None:
        return guess * np.resize(OPENING, count)
    if not shots.mixed:
        steps = WALK ** (1.0 + np.arange(count))
        if shots.perforated.all():
            return shots.velocity.min() / steps
        return shots.velocity.max() * steps
    limits = fit(shots, guess)
    numbers = shots.velocity.size + np.arange(count)
    side = np.where(numbers % 2, BESIDE, -BESIDE)
    return limits.of(known) + side * limits.scatter()


def _columns(known):
    return np.column_stack([np.ones(len(known)), known])


def _spans(values: FloatArray, median: bool = False) -> list[Span]:
    """Span of each column of (1 + draws, n), whose first row is the mode."""
    part = 0.5 * (1 - CONFIDENCE)
    low, middle, high = np.quantile(values[1:], (part, 0.5, 1 - part), axis=0)
    if not median:
        middle = values[0]
    return [Span(*map(float, one)) for one in zip(middle, low, high)]


def _curvature(cost, p, step=1e-3):
    """Second derivatives of a cost by differences."""
    d = len(p)
    found = np.zeros((d, d))
    moves = step * np.eye(d)
    for i in range(d):
        for j in range(i, d):
            a, b = moves[i], moves[j]
            sums = cost(p + a + b) - cost(p + a - b) - cost(p - a + b) + cost(p - a - b)
            found[i, j] = found[j, i] = sums / (4 * step**2)
    return found
