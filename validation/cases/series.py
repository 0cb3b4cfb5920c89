"""How often the interval of V50 that `reduce tests` gives, or of a curve of residual velocities, holds the true one:
series of shots drawn at panels whose V50 and curve are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from fabrics.base.checks import FloatArray
from validation.values import Values
from weavecell.studies import lambert_jonas, probit
from weavecell.studies.bracket import Bracket
from weavecell.studies.limit import RESIDUAL_SHOTS

V50 = 500.0  # [m/s]
TOLERANCE = 1.0  # [m/s] of the brackets of `curve_coverage`
CONFIDENCE = 0.95
SEED = 11


def coverage(*, protocol: str, share: float, shots: Sequence[int], series: int) -> Values:
    """Count the series whose 95 % interval holds V50.

    Parameters
    ----------
    protocol : a name of PROTOCOLS
    share : [-] s over V50; panels fail at normal velocities
    shots : numbers of shots of a series
    series : of each number

    Returns
    -------
    dict with held, and without, by the likelihood alone, both [%]; and half, the median half width of
    the interval over s; by number of shots
    """
    held = []
    without = []
    half = []
    for count in shots:
        random = np.random.default_rng([SEED, count])
        found = []
        for _ in range(series):
            failing = V50 * (1 + share * random.standard_normal(count))
            found.append(_inside(*PROTOCOLS[protocol](failing, random)))
        inside, plain, widths = np.array(found).T
        held.append(100 * inside.mean())
        without.append(100 * plain.mean())
        half.append(0.5 * float(np.nanmedian(widths)) / (share * V50))
    return {"held": held, "without": without, "half": half}


def _inside(velocity, perforated):
    """(whether V50 is in the interval of `probit.fit`, whether in that of the likelihood alone, width [m/s] of the
    first); shots that determine no curve exclude nothing, and have no width."""
    V = np.array(velocity)
    hit = np.array(perforated)
    near = probit.locate(V, hit)
    if np.isnan(near):
        return True, True, np.nan
    fall = 0.5 * chi2.ppf(CONFIDENCE, 1)
    without = probit.fallen(V, hit, V50) <= fall
    low, high = probit.posterior_of(V, hit, near).interval(0.0, CONFIDENCE)
    return low <= V50 <= high, without, high - low


def up_and_down(failing: FloatArray, random: np.random.Generator) -> tuple[list, list]:
    """Place each shot 30 m/s below a perforation and above a stop, 15 m/s once there were both."""
    velocity = V50 + random.uniform(-30, 30)
    velocities: list[float] = []
    hit: list[bool] = []
    for limit in failing:
        velocities.append(velocity + random.normal(0, 2.5))  # no gun meets its velocity
        hit.append(bool(velocities[-1] > limit))
        step = 15 if len(set(hit)) == 2 else 30
        velocity = velocities[-1] + (-step if hit[-1] else step)
    return velocities, hit


def langlie(failing: FloatArray, random: np.random.Generator) -> tuple[list, list]:
    """Place shots by Langlie (1962): half way to the last shot since which both outcomes came equally often, or to
    the end of the range."""
    low, high = V50 * random.uniform((0.75, 1.1), (0.9, 1.25))
    velocities: list[float] = []
    hit: list[bool] = []
    for limit in failing:
        at = 0.5 * (low + high)
        if hit:
            signs = np.cumsum([1 if one else -1 for one in reversed(hit)])
            balanced = np.flatnonzero(signs == 0)
            end = low if hit[-1] else high
            other = velocities[-1 - balanced[0]] if balanced.size else end
            at = 0.5 * (velocities[-1] + other)
        velocities.append(float(at))
        hit.append(bool(at > limit))
    return velocities, hit


PROTOCOLS = {"up and down": up_and_down, "Langlie": langlie}


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
