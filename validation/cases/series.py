"""How often the interval of a V50, or of a curve of residual velocities, holds the true one: series of shots drawn at
panels whose V50 and curve are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.base.checks import FloatArray
from validation.values import Values
from weavecell.runs import go_no_go, v50
from weavecell.runs import plies as analysis
from weavecell.runs.go_no_go import Outcomes
from weavecell.studies import lambert_jonas
from weavecell.studies.bracket import Bracket
from weavecell.studies.limit import RESIDUAL_SHOTS

V50 = 500.0  # [m/s]
TOLERANCE = 1.0  # [m/s] of the brackets of `curve_coverage`
SEED = 11
NAMES = "friction between yarns", "friction on the nose"
# evenly spread, as the panels of a study are
_MIDDLES = (np.arange(12) + 0.5) / 12 - 0.5
POPULATION = np.stack(np.meshgrid(_MIDDLES, _MIDDLES), axis=-1).reshape(-1, 2)


def coverage(
    *, protocol: str, scatter: float, slopes: float, shots: Sequence[int], series: int
) -> Values:
    """Count the series whose 90 % intervals hold V10, V50 and V90.

    Parameters
    ----------
    protocol : a name of PROTOCOLS
    scatter : [-] of limits of panels of which the same is known, normal, over V50
    slopes : [-] by which each of two knowns moves the limit over its whole range, over V50
    shots : numbers of shots of a series
    series : of each number

    Returns
    -------
    dict with held, [%] of the three, least first; and off, rms error of V50, and half, median half width of
    its interval, [%] of V50; by number of shots
    """
    known, rest = _draw(np.random.default_rng(SEED), 100_000)
    limits = _limits(known, rest, scatter, slopes)
    true = np.quantile(limits, go_no_go.LEVELS)
    held, off, half = [], [], []
    for count in shots:
        random = np.random.default_rng([SEED, count])
        found = []
        for _ in range(series):
            known, rest = _draw(random, count)
            fired = PROTOCOLS[protocol](known, _limits(known, rest, scatter, slopes), random)
            guess = float(np.median(fired.velocity))
            asked = POPULATION if fired.names else None
            found.append([*go_no_go.fit(fired, guess, asked).velocities.values()])
        low, high = (np.array([[span[end] for span in row] for row in found]) for end in (1, 2))
        held.append(100 * float(np.mean((low <= true) & (true <= high), axis=0).min()))
        middle = np.array([row[1].value for row in found])
        off.append(100 * float(np.sqrt(np.mean((middle / true[1] - 1) ** 2))))
        half.append(100 * float(np.median([row[1].half for row in found])) / true[1])
    return {"held": held, "off": off, "half": half}


def _draw(random, count):
    """Return (what is known of panels (count, 2), about 0; their rest (count,), normal)."""
    return random.uniform(-0.5, 0.5, (count, 2)), random.standard_normal(count)


def _limits(known, rest, scatter, slopes):
    """Return the limits [m/s] of panels."""
    return V50 * (1 + slopes * known.sum(axis=1) + scatter * rest)


def rounds(known: FloatArray, limits: FloatArray, random: np.random.Generator) -> Outcomes:
    """Place shots as `v50` does, from a guess 30 % low to 50 % high."""
    guess = V50 * float(np.exp(random.uniform(np.log(0.7), np.log(1.5))))
    fired = Outcomes(NAMES, known[:0], np.zeros(0), np.zeros(0, bool))
    for begun in range(0, limits.size, v50.BATCH):
        coarse = go_no_go.fit(fired, guess, draws=go_no_go.COARSE)
        placed = go_no_go.place(coarse, known[begun : begun + v50.BATCH])
        velocity = np.append(fired.velocity, placed)
        until = slice(0, velocity.size)
        fired = Outcomes(NAMES, known[until], velocity, velocity > limits[until])
    return fired


def plies_coverage(
    *, plies: int, sure: float, scatter: float, growth: float, shots: Sequence[int], series: int
) -> Values:
    """Count the studies of plies that find the least count that stops a threat with a probability `sure`.

    Parameters
    ----------
    plies : the least count
    scatter : [-] as of `coverage`; each of two knowns moves limits by .1 over its range
    growth : [-] exponent of plies of the limits
    shots : numbers of shots of a study, in rounds of `v50.BATCH` as `plies` places them
    series : studies of each number, with guesses of the count half to twice as high

    Returns
    -------
    dict with near, [%] of studies within one ply, or 10 % of it; held, [%] whose range holds it; few, [%] that find
    too few; by number of shots
    """
    known, rest = _draw(np.random.default_rng(SEED), 20_000)
    # of packs whose middle is 1: the velocity at which the share that is asked for stops
    stops = float(np.quantile(1 + 0.1 * known.sum(axis=1) + scatter * rest, 1 - sure))
    # between two counts, so that neither is just enough
    middle = V50 / stops / (plies - 0.5) ** growth
    table: dict[str, list] = {"near": [], "held": [], "few": []}
    for count in shots:
        random = np.random.default_rng([SEED, count, plies])
        found = []
        for seed in range(series):
            reference = max(1, round(plies * np.exp(random.uniform(np.log(0.5), np.log(2)))))
            known, rest = _draw(random, count)
            part = 1 + 0.1 * known.sum(axis=1) + scatter * rest
            counts: list[int] = []
            fired = Outcomes(NAMES, known[:0], np.zeros(0), np.zeros(0, bool), np.zeros(0))
            for begun in range(0, count, v50.BATCH):
                coarse = go_no_go.fit(fired, V50, draws=go_no_go.COARSE)
                chosen = analysis.choose_count(
                    coarse,
                    reference,
                    counts,
                    velocity=V50,
                    sure=sure,
                    mixed=fired.mixed,
                    seed=seed,
                )
                counts += v50.BATCH * [chosen]
                times = np.array(counts) / reference
                own = known[begun : begun + v50.BATCH]
                velocity = np.append(fired.velocity, go_no_go.place(coarse, own, times[-1]))
                limits = middle * np.array(counts) ** growth * part[: len(counts)]
                hit = velocity > limits
                fired = Outcomes(NAMES, known[: len(counts)], velocity, hit, times)
            posterior = go_no_go.fit(fired, V50, POPULATION)
            found.append(analysis.count_plies(posterior, reference, V50, sure))
        off = np.array([one.plies - plies for one in found])
        table["near"].append(100 * float(np.mean(np.abs(off) <= max(1, 0.1 * plies))))
        table["held"].append(100 * float(np.mean([one.low <= plies <= one.high for one in found])))
        table["few"].append(100 * float(np.mean(off < 0)))
    return table


def up_and_down(known: FloatArray, limits: FloatArray, random: np.random.Generator) -> Outcomes:
    """Place each test 30 m/s below a perforation and above a stop, 15 m/s once there were both; nothing is
    known of the panels."""
    velocity = V50 + random.uniform(-30, 30)
    velocities: list[float] = []
    hit: list[bool] = []
    for limit in limits:
        velocities.append(velocity + random.normal(0, 2.5))  # no gun meets its velocity
        hit.append(bool(velocities[-1] > limit))
        step = 15 if len(set(hit)) == 2 else 30
        velocity = velocities[-1] + (-step if hit[-1] else step)
    return Outcomes.of_tests(velocities, hit)


def langlie(known: FloatArray, limits: FloatArray, random: np.random.Generator) -> Outcomes:
    """Place tests by Langlie (1962): half way to the last shot since which both outcomes came equally often, or
    to the end of the range; nothing is known of the panels."""
    low, high = V50 * random.uniform((0.75, 1.1), (0.9, 1.25))
    velocities: list[float] = []
    hit: list[bool] = []
    for limit in limits:
        at = 0.5 * (low + high)
        if hit:
            signs = np.cumsum([1 if one else -1 for one in reversed(hit)])
            balanced = np.flatnonzero(signs == 0)
            end = low if hit[-1] else high
            other = velocities[-1 - balanced[0]] if balanced.size else end
            at = 0.5 * (velocities[-1] + other)
        velocities.append(float(at))
        hit.append(bool(at > limit))
    return Outcomes.of_tests(velocities, hit)


PROTOCOLS = {"rounds, as v50": rounds, "up and down": up_and_down, "Langlie": langlie}


def curve_coverage(*, share: float, a: float, p: float, shots: int, series: int) -> Values:
    """Count the searches whose 95 % intervals hold a and p of the curve of Lambert and Jonas.

    Each shot has a limit of its own, normal about V50, and leaves with the residual velocity of the
    curve from there. A search bisects, and fires shots up to twice the limit, as
    `critical-velocity` does.

    Parameters
    ----------
    share : [-] standard deviation of the limits over V50
    a, p : [-] of the curve
    shots : residual shots of a search
    series : searches

    Returns
    -------
    dict with a, p: [%] of the searches whose interval holds it, of those that have one; none: [%]
    that have none for one of them
    """
    random = np.random.default_rng([SEED, shots, round(1e4 * share)])
    held: dict[str, list] = {"a": [], "p": []}
    for _ in range(series):
        found = _search(random, share, a, p, shots)
        for name, true in (("a", a), ("p", p)):
            interval = found.intervals[name]
            if interval is not None:
                held[name].append(interval[0] <= true <= interval[1])
    least = min(map(len, held.values()))
    shares = {name: 100 * float(np.mean(inside)) for name, inside in held.items()}
    return shares | {"none": 100 * (1 - least / series)}


def _search(random, share, a, p, shots):
    """The curve that is fitted to the shots of one search."""
    strikes: list[float] = []
    residuals: list[float] = []

    def fire(velocity):
        own = V50 * (1 + share * random.standard_normal())
        strikes.append(velocity)
        residuals.append(float(lambert_jonas.curve(np.array(velocity), a, p, own)))

    known = Bracket(V50 * random.uniform(0.8, 1.2), 1.0, 2000.0)
    while not known.width <= TOLERANCE:
        fire(known.next())
        known = known.update(residuals[-1] > 0)
    for factor in np.geomspace(*RESIDUAL_SHOTS, shots):
        fire(float(factor * known.high))
    struck, left = np.array(strikes), np.array(residuals)
    single = struck[left == 0].max() < struck[left > 0].min()
    middle = 0.5 * (known.low + known.high)
    return lambert_jonas.fit(struck, left, limit=middle if single else None)
