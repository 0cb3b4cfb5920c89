"""Velocities at which shares of shots pass, from few shots that each pass or stop (go/no-go).

The limit of a panel is a plane in what is known of it, with a normal rest, which is its yarns':

    limit = middle (1 + known . slopes + scatter z),    z normal                                  (1)

A stop says that the limit lies above the strike velocity, a perforation below it (probit). Shots at packs
of several counts of plies n have one constant more, as a power of their own line in logarithms:

    middle = middle_0 (n / n_0)^growth                                                             (2)

of which shots at one count are the case n = n_0. All constants
have priors that are shares of the limit, so that it answers from the first shot on. The posterior is
sampled by importance: the 90 % intervals of a normal approximation hold .8 of truths at 32 shots. Each
shot is fired where its outcome tells most of all constants. That walks from a wrong guess too, and
settles beside the limit of the shot's own panel: there are no rules for the opening, the walk or the side.

Residual velocities are not used: by Lambert's and Jonas' law without a factor they put limits of S-728
7 % too high. Tests of a laboratory, of whose panels nothing is known, are the case of no slopes.

Sources: Neyer, Technometrics 36 (1994) 61, and Wu and Tian, J. Stat. Plan. Inference 149 (2014) 1, on
sequential tests of pass or stop; Houlsby et al., arXiv:1112.5745, on the velocity that tells most; Cappé
et al., Stat. Comput. 18 (2008) 447, on adapted importance sampling.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import entr, gammaincinv, log_ndtr, ndtr, ndtri

from fabrics.base.checks import FloatArray
from weavecell.runs.span import CONFIDENCE, Span, find_spans

LEVELS = 0.1, 0.5, 0.9
STRENGTH = "strength of yarns"  # what is not known of a panel
PLACE = "place"  # from the gap between yarns to the middle of a crossover

# priors, of which `python -m validation study go-no-go-coverage` shows what they do
FIRST = 0.7  # [-] deviation of log(middle / guess): guesses twice too high are expected
SCATTER = 0.06  # [-] median of the scatter: four scenes of drawn panels have .052 to .060
SPREAD = 0.9  # [-] deviation of its logarithm: with .7 intervals hold .76 to .87 where the scatter is .03 or .12
# the same of packs of several counts, of which .9 makes one in six counts of 16 shots too many by two plies or more
SPREAD_OF_PLIES = 0.5
REACH = 0.1  # [-] deviation of the slope over the whole range of what is known, before COMMON
REACH_OF_PLACE = 0.04  # [-] of the place
GROWTH = 0.45  # [-] median of the exponent of plies: tests have .25 (aramid, 2 to 8 plies) to .5 (energy as mass)
GROWTH_SPREAD = 0.27  # [-] deviation of its logarithm
COMMON = 0.9  # [-] deviation of the logarithm of what all slopes have in common: flat scenes and steep ones

# of the sampling
TAIL = 6.0  # degrees of freedom of the proposal
STAGES = 3  # of the proposal: the last one is sampled, those before only move it
ENOUGH = (
    100.0  # independent draws that a sample is worth at least; else it is made four times larger
)
MOST = 2**14  # draws
KEPT = 2048  # of the sample, equally likely
COARSE = 256  # draws of a fit that only places the next shots
TRIED = 25  # velocities among which the next one is chosen


@dataclass(frozen=True)
class Outcomes:
    """What shots tell.

    Parameters
    ----------
    names : of what is known of each panel
    known : (n, names) [-] about 0, over whose range a slope counts
    velocity : (n,) [m/s]
    perforated : (n,)
    times : (n,) plies over those that the guess is of; None of packs of one count
    """

    names: tuple[str, ...]
    known: FloatArray
    velocity: FloatArray
    perforated: NDArray[np.bool_]
    times: FloatArray | None = None

    @classmethod
    def of_tests(cls, velocity: ArrayLike, perforated: ArrayLike) -> Outcomes:
        """Return shots of whose panels nothing is known.

        Parameters
        ----------
        velocity, perforated : (n,) [m/s], bool
        """
        V = np.asarray(velocity, float)
        return cls((), np.zeros((V.size, 0)), V, np.asarray(perforated, bool))

    @property
    def mixed(self) -> bool:
        """Whether some stop and some perforate."""
        return 0 < self.perforated.sum() < self.perforated.size


@dataclass(frozen=True)
class LimitPosterior:
    """Equally likely constants of (1), and the population of panels that is asked about.

    Parameters
    ----------
    names : of what is known
    middle : (d,) [m/s]
    slopes : (d, names) [-]
    scatter : (d,) [-]
    population : (m, names) [-] what is known of panels, as they are drawn
    common : (names,) whether it is the same for all shots at one cloth, as frictions are; a place is not
    effective : number of independent draws that these are worth
    growth : (d,) [-] exponent of (2); None of packs of one count
    """

    names: tuple[str, ...]
    middle: FloatArray
    slopes: FloatArray
    scatter: FloatArray
    population: FloatArray
    common: tuple[bool, ...]
    effective: float
    growth: FloatArray | None = None

    def of(self, times: float) -> LimitPosterior:
        """Return the posterior of packs of so many times the plies."""
        if self.growth is None:
            return self
        return replace(self, middle=self.middle * times**self.growth)

    def take(self, numbers: NDArray[np.signedinteger]) -> LimitPosterior:
        """Return the posterior of these of its draws."""
        growth = None if self.growth is None else self.growth[numbers]
        drawn = {name: getattr(self, name)[numbers] for name in ("middle", "slopes", "scatter")}
        return replace(self, **drawn, growth=growth)

    def levels(self, levels: Sequence[float] = LEVELS) -> FloatArray:
        """Compute the velocities (d, levels) [m/s] that these shares of all panels pass."""
        mean = self.slopes @ self.population.T
        s = self.scatter[:, None]
        wanted = np.asarray(levels, float)
        v = mean.mean(axis=1)[:, None] + np.sqrt(mean.var(axis=1)[:, None] + s * s) * ndtri(wanted)
        # Newton, at most one scatter a step
        for _ in range(5):
            apart = (v[:, :, None] - mean[:, None]) / s[:, :, None]
            density = np.exp(-0.5 * apart * apart).mean(axis=2) / np.sqrt(2 * np.pi) / s
            beyond = ndtr(apart).mean(axis=2) - wanted
            v = v - np.clip(beyond / np.maximum(density, 1e-9), -s, s)
        return np.maximum(self.middle[:, None] * (1 + v), 0.0)

    @cached_property
    def velocities(self) -> dict[str, Span]:
        """{"V10": Span [m/s]} of LEVELS, over all shots."""
        names = [f"V{100 * level:.0f}" for level in LEVELS]
        return dict(zip(names, find_spans(self.levels())))

    def passed(self, velocity: ArrayLike) -> FloatArray:
        """Compute the shares (d, v) [-] of shots that pass at velocities (v,) [m/s]."""
        part = np.asarray(velocity, float)[None, :, None] / self.middle[:, None, None] - 1
        mean = (self.slopes @ self.population.T)[:, None]
        return ndtr((part - mean) / self.scatter[:, None, None]).mean(axis=2)

    def passing(self, velocity: ArrayLike) -> list[Span]:
        """Compute the probability [-] that a shot passes at velocities (v,) [m/s]."""
        return find_spans(self.passed(velocity))

    def narrow(self, name: str, share: float) -> LimitPosterior:
        """Return the posterior for panels of which something is known: of its range a share alone is left."""
        number = self.names.index(name)
        middle = self.population[:, number].mean()
        population = self.population.copy()
        population[:, number] = middle + share * (population[:, number] - middle)
        return replace(self, population=population)

    def draw_cloths(self) -> FloatArray:
        """Return V50 [m/s] (d, m) that tests of single cloths would find: what is common to the shots at
        one is drawn once, so that V50 differs from cloth to cloth."""
        return self.middle[:, None] * (1 + self.slopes @ self._cloth.T)

    def cloths(self) -> Span:
        """Compute the V50 [m/s] that a test of one cloth would find."""
        return find_spans(self.draw_cloths().reshape(-1, 1))[0]

    def cloths_passed(self, velocity: float) -> Span:
        """Compute the share [-] that passes at `velocity` [m/s] of shots at one cloth: what is common to them is
        drawn once, what differs from shot to shot is averaged over."""
        own = self.population - self._cloth
        spread = np.sqrt(self.scatter**2 + (self.slopes @ own.T).var(axis=1))
        apart = velocity / self.middle[:, None] - 1 - self.slopes @ self._cloth.T
        return find_spans(ndtr(apart / spread[:, None]).reshape(-1, 1))[0]

    @property
    def _cloth(self):
        """(m, names) what is known of cloths; what differs from shot to shot is in its middle."""
        return np.where(self.common, self.population, self.population.mean(axis=0))

    @cached_property
    def widths(self) -> dict[str, float]:
        """{what is drawn: [m/s] by which the middle 90 % of it alone moves the limit}, the largest first."""
        part = 0.5 * (1 - CONFIDENCE)
        low, high = np.quantile(self.population, (part, 1 - part), axis=0)
        of_known = np.abs(self.slopes) * (high - low)
        of_rest = -2 * ndtri(part) * self.scatter[:, None]
        moved = np.median(self.middle[:, None] * np.hstack([of_known, of_rest]), axis=0)
        found = dict(zip((*self.names, STRENGTH), map(float, moved)))
        return dict(sorted(found.items(), key=lambda item: -item[1]))

    @cached_property
    def shares(self) -> dict[str, Span]:
        """{what is drawn: share [-] of the variance of limits}, the largest first."""
        of_known = (self.slopes * self.population.std(axis=0)) ** 2
        parts = np.column_stack([of_known, self.scatter**2])
        spans = find_spans(parts / parts.sum(axis=1, keepdims=True))
        found = dict(zip((*self.names, STRENGTH), spans))
        return dict(sorted(found.items(), key=lambda item: -item[1].value))

    @cached_property
    def middles(self) -> FloatArray:
        """(d,) [m/s] that half of all shots pass, equally likely."""
        return self.levels([0.5])[:, 0]

    def words(self) -> str:
        """Write the velocities in one line, V50 first, and what a test of one cloth would find."""
        v50, *others = sorted(self.velocities.items(), key=lambda item: item[0] != "V50")
        told = [
            f"V50 {v50[1].words('m/s')}",
            *(f"{name} {span.words('')}" for name, span in others),
        ]
        if any(self.common):
            low, high = self.cloths()[1:]
            told.append(f"one cloth's V50 {low:.3g} to {high:.3g}")
        return ", ".join(told)


@dataclass(frozen=True)
class _Plane:
    """The logarithm of the posterior of (1) in deviations from the priors, of which a row has those of
    the middle, of what slopes have in common, of the scatter, of each slope, and of the growth.

    Parameters
    ----------
    shots : Outcomes
    guess : [m/s] of the middle
    """

    shots: Outcomes
    guess: float

    @cached_property
    def velocity(self):
        """(n,) [-] over the guess."""
        return self.shots.velocity / self.guess

    @cached_property
    def sign(self):
        """(n,) 1 of a perforation, -1 of a stop."""
        return np.where(self.shots.perforated, 1.0, -1.0)

    @cached_property
    def reach(self):
        """(names,) [-] deviations of the slopes."""
        return np.array([REACH_OF_PLACE if name == PLACE else REACH for name in self.shots.names])

    @property
    def spread(self):
        """[-] of the logarithm of the scatter."""
        return SPREAD if self.shots.times is None else SPREAD_OF_PLIES

    @property
    def size(self):
        """Number of constants."""
        return 3 + len(self.shots.names) + (self.shots.times is not None)

    def constants(self, p):
        """Return (middle over the guess, slopes, scatter, growth) of deviations (..., size)."""
        last = 3 + len(self.shots.names)
        slopes = self.reach * np.exp(COMMON * p[..., 1:2]) * p[..., 3:last]
        growth = GROWTH * np.exp(GROWTH_SPREAD * p[..., last:])
        return (
            np.exp(FIRST * p[..., :1]),
            slopes,
            SCATTER * np.exp(self.spread * p[..., 2:3]),
            growth,
        )

    def over_middle(self, p):
        """Return (..., n) velocities over the middle of packs of the plies of each shot."""
        middle, _, _, growth = self.constants(p)
        if self.shots.times is not None:
            middle = middle * self.shots.times**growth
        return self.velocity / middle

    def apart(self, p):
        """Return (..., n) scatters by which each shot lies on the side that its outcome says."""
        _, slopes, scatter, _ = self.constants(p)
        return self.sign * (self.over_middle(p) - 1 - slopes @ self.shots.known.T) / scatter

    def cost(self, p):
        """Return (...) minus the logarithm of the posterior, but for a constant."""
        return 0.5 * (p * p).sum(axis=-1) - log_ndtr(self.apart(p)).sum(axis=-1)

    def score(self, p):
        """Return (step to the mode, information) by Fisher's scoring."""
        _, slopes, scatter, growth = self.constants(p)
        apart, over_middle = self.apart(p), self.over_middle(p)
        own = self.reach * np.exp(COMMON * p[1:2])
        moved = [FIRST * over_middle, COMMON * (self.shots.known @ slopes)]
        moved += [*(self.shots.known * own).T]
        if self.shots.times is not None:
            moved.append(GROWTH_SPREAD * growth * np.log(self.shots.times) * over_middle)
        rows = [-self.sign * one / scatter for one in moved]
        rows.insert(2, -self.spread * apart)
        jacobian = np.array(rows).T
        log_density = -0.5 * apart * apart - 0.5 * np.log(2 * np.pi)
        slope = np.exp(log_density - log_ndtr(apart))
        weight = slope * np.exp(log_density - log_ndtr(-apart))
        information = (jacobian * weight[:, None]).T @ jacobian + np.eye(self.size)
        return np.linalg.solve(information, jacobian.T @ slope - p), information

    def find_mode(self):
        """Return (mode, information there)."""
        p = np.zeros(self.size)
        for _ in range(30):
            move, information = self.score(p)
            move /= max(1.0, np.abs(move).max() / 1.5)
            while self.cost(p + move) > self.cost(p) + 1e-9 and np.abs(move).max() > 1e-3:
                move *= 0.5
            if np.abs(move).max() < 1e-2:
                break
            p = p + move
        return p, information

    def sample(self, draws):
        """Return (deviations (draws, size), weights (draws,)) of the posterior."""
        p, information = self.find_mode()
        spread = _spread_evenly(self.size, draws)
        tail = 0.5 * (TAIL + self.size) * np.log1p((spread * spread).sum(axis=1) / TAIL)
        half = 1.2 * np.linalg.cholesky(np.linalg.inv(information))
        for stage in range(STAGES):
            found = p + spread @ half.T
            log_weight = tail - self.cost(found)
            weight = np.exp(log_weight - log_weight.max())
            if stage == STAGES - 1:
                break
            # the heaviest are cut: a few draws must not shape the next proposal
            weight = np.minimum(weight, np.sort(weight)[-max(8, draws // 32)])
            weight /= weight.sum()
            p = weight @ found
            apart = found - p
            covariance = (weight[:, None] * apart).T @ apart
            half = 1.1 * np.linalg.cholesky(covariance + 0.01 * np.eye(self.size))
        return found, weight / weight.sum()


def fit(
    shots: Outcomes,
    guess: float,
    population: FloatArray | None = None,
    common: Sequence[bool] | None = None,
    draws: int = KEPT,
) -> LimitPosterior:
    """Sample the posterior of limits.

    Parameters
    ----------
    shots : Outcomes, none too
    guess : [m/s] of the limit
    population, common : see LimitPosterior; None asks about panels as those shot at, whose knowns are
        common to a cloth but for the place
    draws : a power of 2
    """
    plane = _Plane(shots, guess)
    found, weight = plane.sample(draws)
    effective = float(1 / (weight @ weight))
    if effective < ENOUGH and KEPT <= draws < MOST:
        return fit(shots, guess, population, common, 4 * draws)
    kept = min(draws, KEPT)
    places = np.searchsorted(np.cumsum(weight), (np.arange(kept) + 0.5) / kept)
    middle, slopes, scatter, growth = plane.constants(found[places.clip(0, draws - 1)])
    if population is None:
        population = shots.known if len(shots.known) else np.zeros((1, len(shots.names)))
    if common is None:
        common = [name != PLACE for name in shots.names]
    return LimitPosterior(
        shots.names,
        guess * middle[:, 0],
        slopes,
        scatter[:, 0],
        population,
        tuple(common),
        effective,
        growth[:, 0] if growth.size else None,
    )


def place(posterior: LimitPosterior, known: FloatArray, times: float = 1.0) -> FloatArray:
    """Choose the velocities [m/s] of the next round: of each shot that whose outcome tells most of the
    constants, beside the outcomes of the shots of the round that are placed.

    Parameters
    ----------
    posterior : LimitPosterior of the shots so far
    known : (n, names) of the panels of the round
    times : plies of the round, as in `Outcomes`
    """
    posterior = posterior.of(times)
    joint = np.full((1, posterior.middle.size), 1 / posterior.middle.size)
    found = []
    for own in known:
        limit = posterior.middle * (1 + posterior.slopes @ own)
        rest = posterior.middle * posterior.scatter
        middle = np.median(limit)
        wide = np.sqrt(limit.var() + np.mean(rest * rest))
        velocity = middle + wide * np.linspace(-2, 2, TRIED)
        velocity = velocity[velocity > 0.05 * middle]
        passes = ndtr((velocity[:, None] - limit) / rest)
        # outcomes of the round so far, with and without a pass of this shot
        both = passes @ joint.T
        uncertain = (entr(both) + entr(joint.sum(axis=1) - both)).sum(axis=1)
        certain = (entr(passes) + entr(1 - passes)).mean(axis=1)
        best = int(np.argmax(uncertain - certain))
        found.append(velocity[best])
        joint = np.concatenate([joint * passes[best], joint * (1 - passes[best])])
    return np.array(found)


@lru_cache
def _spread_evenly(size, draws):
    """Return (draws, size) of a multivariate t of TAIL degrees of freedom."""
    from scipy.stats import qmc

    share = np.clip(qmc.Sobol(size + 1, seed=1).random(draws), 1e-6, 1 - 1e-6)
    squared = 2 * gammaincinv(0.5 * TAIL, share[:, -1:])
    return ndtri(share[:, :-1]) / np.sqrt(squared / TAIL)
