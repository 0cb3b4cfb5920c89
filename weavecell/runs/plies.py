"""How many plies of a fabric stop a threat with a given probability: drawn shots at packs of several counts.

Shots lie where the answer is: each round at the count that one draw of the posterior asks for, so that counts
spread as far as the answer does and close in with it. The posterior is that of `go_no_go` with a power of the
plies, from which the count follows without a search: a share of shots stops at the velocity

    V_share(n) = V_share(n_0) (n / n_0)^growth,

so that n = n_0 (V / V_share(n_0))^(1 / growth) plies are just enough. The answer is the least whole count
whose probability of a stop, averaged over all that is not known, reaches what is asked; its range is that of
the least counts of the draws. The most likely count would be too small in 16 to 50 of 100 studies.

Tests say how far the model is off: ln(computed / measured V50) of the rows that were scored
(`weavecell/report/against_tests.csv`), as Student's t of their number. That outweighs all that is drawn. A test of
this very fabric takes its place; the error of the growth, from rows of that, then widens it away from its count.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import ceil, log, sqrt
from typing import Any, NamedTuple

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.counted import counted
from shellfabric.impact.setup import ImpactSetup
from shellfabric.plies.pack_keys import MOST_PLIES
from weavecell.runs import go_no_go
from weavecell.runs.difference import subtract
from weavecell.runs.go_no_go import LimitPosterior
from weavecell.runs.measurement import Count, Measurement, measure_known, rank
from weavecell.runs.span import CONFIDENCE, Span, find_spans
from weavecell.runs.table import Draw, Shot
from weavecell.runs.v50 import Series, draw_population
from weavecell.studies import ballistic_limit, strengths
from weavecell.studies.inputs import Scatter
from weavecell.studies.unknown import find_unknown

STEP = 2.0  # of the count from one round to the next, at most
MOST_DRAWN = 40  # plies of a picture
LEAST_GROWTH = 0.1  # [-] that is left of the growth where tests say that it is too large
V50_ROWS = "V50 of one ply", "V50 of packs"
GROWTH_ROW = re.compile(r"growth of V50 from (\d+) to (\d+) plies.*")


class Rows(NamedTuple):
    """Values of several scored rows: mean, standard deviation, and how many they are."""

    mean: float
    deviation: float
    size: int

    def draw(self, random: np.random.Generator, size: int) -> FloatArray:
        """Draw the value of a row that is not among them, Student's t."""
        spread = self.deviation * sqrt(1 + 1 / self.size)
        return self.mean + spread * random.standard_t(self.size - 1, size)


@dataclass(frozen=True)
class ModelError:
    """What scored rows say of computed V50.

    Parameters
    ----------
    factor : Rows of ln(computed / measured) of V50, and of V50 of a pack over that of a thinner one
    growth : Rows of the exponent of plies, computed less measured
    of_test : [-] standard uncertainty of a measured V50 of a pack
    """

    factor: Rows
    growth: Rows
    of_test: float


class V50Test(NamedTuple):
    """A V50 of the fabric that was tested: plies, velocity [m/s]."""

    plies: int
    velocity: float


def find_error(scored: Iterable[Mapping[str, str]]) -> ModelError:
    """Find how far computed V50 are off from rows that were scored, {column: text}."""
    rows = {row["quantity"]: row for row in scored}
    growths = {name: found for name in rows if (found := GROWTH_ROW.fullmatch(name))}
    factors = [_read_logarithms(rows[name]) for name in (*V50_ROWS, *growths) if name in rows]
    powers = [
        _read_logarithms(rows[name], log(int(found[2]) / int(found[1])))
        for name, found in growths.items()
    ]
    return ModelError(_pool(factors), _pool(powers), float(rows[V50_ROWS[1]]["sigma_test"]))


def _read_logarithms(row, scale=1.0):
    """Return Rows of ln(bias) over `scale` of a quantity."""
    scatter = sum(float(row[name] or 0) ** 2 for name in ("sigma_model", "sigma_test"))
    return Rows(log(float(row["bias"])) / scale, sqrt(scatter) / scale, int(row["n"]))


def _pool(parts):
    """Return Rows of several quantities as one: scatter within them and between their means."""
    size = sum(one.size for one in parts)
    mean = sum(one.size * one.mean for one in parts) / size
    squares = sum(
        (one.size - 1) * one.deviation**2 + one.size * (one.mean - mean) ** 2 for one in parts
    )
    return Rows(mean, sqrt(squares / (size - 1)), size)


def as_tests_say(
    posterior: LimitPosterior,
    reference: int,
    error: ModelError,
    tests: Sequence[V50Test] = (),
    seed: int = 1,
) -> LimitPosterior:
    """Return the posterior of true limits: that of computed ones, less the error of the model.

    Parameters
    ----------
    posterior : of packs, whose middle is that of `reference` plies
    tests : of this fabric; a tested V50 is that of the cloth that is asked about
    """
    random = np.random.default_rng(seed)
    size = posterior.middle.size
    middle = posterior.middle * np.exp(-error.factor.draw(random, size))
    if not tests:
        return replace(posterior, middle=middle)
    assert posterior.growth is not None
    growth = np.maximum(posterior.growth - error.growth.draw(random, size), LEAST_GROWTH)
    # the factor is that at the count of the first test, from which the growth goes on
    away = np.log(reference / tests[0].plies)
    middle = middle * np.exp((growth - posterior.growth) * away)
    moved = replace(posterior, middle=middle, growth=growth)
    cost = np.zeros(size)
    for test in tests:
        found = moved.of(test.plies / reference).middles
        cost += 0.5 * (np.log(found / test.velocity) / error.of_test) ** 2
    weight = np.exp(cost.min() - cost)
    taken = np.searchsorted(np.cumsum(weight) / weight.sum(), (np.arange(size) + 0.5) / size)
    return moved.take(taken.clip(0, size - 1))


def real_counts(
    posterior: LimitPosterior, reference: int, velocity: float, sure: float
) -> FloatArray:
    """Compute the plies (d,), not whole, of which a share `sure` of shots stops at `velocity` [m/s]."""
    assert posterior.growth is not None
    stopped = np.maximum(posterior.levels([1 - sure])[:, 0], 1e-6 * velocity)
    with np.errstate(over="ignore"):
        return np.asarray(reference * (velocity / stopped) ** (1 / posterior.growth))


def count_plies(posterior: LimitPosterior, reference: int, velocity: float, sure: float) -> Count:
    """Find the least count whose averaged probability of a stop is at least `sure`, and the range of the least
    counts of the draws; one more than the most plies where none is."""
    part = 0.5 * (1 - CONFIDENCE)
    real = real_counts(posterior, reference, velocity, sure)
    ends = np.quantile(real, (part, 1 - part), method="nearest")

    def stops(count: int) -> float:
        return 1 - float(posterior.of(count / reference).passed([velocity]).mean())

    least = 1 + bisect_left(range(1, MOST_PLIES + 1), sure, key=stops)
    low, high = (min(ceil(end - 1e-9), MOST_PLIES + 1) for end in ends)
    # a count that is sure on average may lie beyond the draws
    return Count(least, min(low, least), max(high, least))


@dataclass(frozen=True)
class PliesOfFabric:
    """Shots at packs of one fabric, and what they tell of the plies that stop a threat.

    Parameters
    ----------
    shots : tuple of Shot that have an outcome
    counts : plies of each
    posterior : of limits at `reference` plies; None where outcomes are all alike
    velocity : [m/s] that is to be stopped
    sure : probability of a stop that is asked for
    reference : plies
    scatter : Scatter
    error : ModelError
    tests : of this fabric
    failures : why other shots have no outcome
    unknown : {what is assumed: (low, high)} of the frictions that were drawn
    """

    shots: tuple[Shot, ...]
    counts: tuple[int, ...]
    posterior: LimitPosterior | None
    velocity: float
    sure: float
    reference: int
    scatter: Scatter
    error: ModelError
    tests: tuple[V50Test, ...] = ()
    failures: tuple[str, ...] = ()
    unknown: dict[str, tuple[float, float]] = field(default_factory=dict)

    @cached_property
    def tested(self) -> LimitPosterior:
        """The posterior of true limits."""
        assert self.posterior is not None
        return as_tests_say(self.posterior, self.reference, self.error, self.tests)

    @cached_property
    def by_model(self) -> Count:
        """Plies if the model were right."""
        assert self.posterior is not None
        return self._count(self.posterior)

    @cached_property
    def by_tests(self) -> Count:
        """Plies with what tests say of the model."""
        return self._count(self.tested)

    def _count(self, posterior):
        return count_plies(posterior, self.reference, self.velocity, self.sure)

    def v50(self, plies: int, tested: bool = True) -> Span:
        """Compute V50 [m/s] of packs of so many plies, as tests say or by the model."""
        posterior = self.tested if tested else self.posterior
        assert posterior is not None
        return find_spans(posterior.of(plies / self.reference).middles[:, None])[0]

    def shares(self) -> dict[str, Any]:
        """Compute the shares that stop, over the plies about the answer: {column: (n,)}, with what tests say of the
        model and by the model alone, each with its interval."""
        assert self.posterior is not None
        most = max(self.by_model.high, min(self.by_tests.high, 3 * self.by_tests.plies), 4)
        plies = np.arange(1, min(most, MOST_DRAWN) + 2)
        found = {"plies": plies}
        part = 0.5 * (1 - CONFIDENCE)
        for name, posterior in (("tested", self.tested), ("model", self.posterior)):
            packs = [posterior.of(n / self.reference) for n in plies]
            stops = 1 - np.hstack([pack.passed([self.velocity]) for pack in packs])
            low, high = np.quantile(stops, (part, 1 - part), axis=0)
            found |= {name: stops.mean(axis=0), f"{name}_low": low, f"{name}_high": high}
        return found

    @property
    def moved(self) -> dict[str, float]:
        """{what moves the limit: [m/s] by its middle 90 %}: the error of the model first, then what is drawn."""
        assert self.posterior is not None
        at = self.by_tests.plies / self.reference
        ends = find_spans(self.tested.of(at).middles[:, None])[0]
        return {"error of the model": ends.high - ends.low, **self.posterior.of(at).widths}

    def measure(self, fabric: str) -> tuple[Measurement, ...]:
        """Return what measurements leave of the plies of a fabric of that name, what narrows them most first: a
        V50 of as many plies as the answer has, and each thing drawn that is common to a cloth."""
        if self.posterior is None:
            return ()
        plies = min(self.by_tests.plies, MOST_PLIES)
        test = V50Test(plies, self.v50(plies).value)
        again = as_tests_say(self.posterior, self.reference, self.error, (test, *self.tests))
        answer, unit = f"plies of {fabric}", "plies"
        of_pack = counted(plies, "ply")
        shot = Measurement(
            answer,
            Span(*self.by_tests),
            Span(*self._count(again)),
            unit,
            f"V50 of {of_pack}",
            self.error.of_test * test.velocity,
            "m/s",
            "shots about V50",
            f"plies --test '{fabric}, {of_pack}: V50'",
        )

        def count(posterior):
            return Span(*self._count(posterior))

        return rank([shot, *measure_known(self.tested, self.unknown, count, answer, unit)])


def study(
    setup_of: Callable[[int], ImpactSetup],
    scatter: Scatter,
    error: ModelError,
    *,
    velocity: float,
    sure: float,
    shots: int,
    batch: int,
    seed: int = 1,
    tests: Sequence[V50Test] = (),
    report: Callable[[int, int], object] = lambda done, total: None,
    **runs: Any,
) -> PliesOfFabric:
    """Fire shots at packs of one fabric, in rounds of `batch`.

    Parameters
    ----------
    setup_of : set-up as it is fired at, of a count of plies
    velocity, sure : [m/s] that is to be stopped, and with which probability
    report, runs : as in `run_cache.results`, with the folder of the shots
    """
    reference = guess_count(setup_of, velocity)
    asked = setup_of(max(reference, 2))
    strengths.check(asked, scatter)
    names = tuple(strengths.draw_known(asked, seed, 0))
    series = Series(names, velocity, shots, batch, varied=True)

    def choose(coarse: LimitPosterior) -> tuple[ImpactSetup, float]:
        counts = [round(times * reference) for times, *_ in series.fired]
        mixed = series.list_outcomes().mixed
        count = choose_count(
            coarse, reference, counts, velocity=velocity, sure=sure, mixed=mixed, seed=seed
        )
        return setup_of(count), count / reference

    # packs of other counts are other packs: no two shots share the strengths of their yarns
    draw = partial(Draw, scatter, seed, stride=MOST_PLIES)
    *_, outcomes = series.fire(choose, draw, report, **runs)
    posterior = None
    if outcomes.mixed:
        posterior = go_no_go.fit(outcomes, velocity, draw_population(asked, seed))
    fired, failures = series.sort()
    counts = [round(times * reference) for times, _, shot in series.fired if not shot.failure]
    return PliesOfFabric(
        fired,
        tuple(counts),
        posterior,
        velocity,
        sure,
        reference,
        scatter,
        error,
        tuple(tests),
        failures,
        find_unknown(asked),
    )


def choose_count(
    coarse: LimitPosterior,
    reference: int,
    counts: Sequence[int],
    *,
    velocity: float,
    sure: float,
    mixed: bool,
    seed: int,
) -> int:
    """Choose the plies of the next round: that one draw of the posterior asks for, or while all outcomes are
    alike its median, at most STEP times the most that were fired at, or the fewest over STEP.

    Parameters
    ----------
    counts : plies of the shots so far
    mixed : whether some stop and some perforate
    """
    if not counts:
        return reference
    real = real_counts(coarse, reference, velocity, sure)
    wanted = np.random.default_rng([seed, len(counts)]).choice(real) if mixed else np.median(real)
    wanted = np.clip(wanted, min(counts) / STEP, STEP * max(counts))
    return int(np.clip(ceil(wanted - 1e-9), 1, MOST_PLIES))


def guess_count(setup_of: Callable[[int], ImpactSetup], velocity: float) -> int:
    """Guess the plies whose limit is `velocity` [m/s]: from a pack of two, by the growth of the priors."""
    two = setup_of(2)
    guess = ballistic_limit.first_guess(two.target(two.table(kept=True)))
    return int(np.clip(round(2 * (velocity / guess) ** (1 / go_no_go.GROWTH)), 1, MOST_PLIES))


def group(masses: Mapping[str, FloatArray]) -> list[list[str]]:
    """Group names by equally likely masses (d,), the lightest first: within a group none is decided to be
    heavier than its first, over the whole interval of their difference."""
    order = sorted(masses, key=lambda name: float(np.median(masses[name])))
    groups: list[list[str]] = []
    for name in order:
        if groups and subtract(masses[name], masses[groups[-1][0]]).low <= 0:
            groups[-1].append(name)
        else:
            groups.append([name])
    return groups
