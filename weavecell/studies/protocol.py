"""V50 as a laboratory finds it: of six shots, and of short series of shots, up and down, on a curve
that is known.

MIL-STD-662F takes the mean of as many of the fastest stops as of the slowest perforations, here
PAIRS of each, whose velocities lie within a spread that the test states; SPREADS are those of the
standard.

In a series the next shot after a perforation is slower, after a stop faster, by `STEPS[0]` until
the outcome has changed once and by `STEPS[1]` from then on. The series ends as soon as its PAIRS
fastest stops and PAIRS slowest perforations lie within SPAN; V50 is the mean of these 2 PAIRS
velocities. A series that has not ended after MOST shots has no result. The first shot misses V50 by
up to `STEPS[0]`, evenly distributed.

This is the scheme of STANAG 2920 and MIL-STD-662F as it is commonly quoted (three and three within
40 m/s); the texts of the standards were not at hand, and the steps are assumed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.counted import counted
from weavecell.studies.probit import Curve

PAIRS, SPAN, STEPS, MOST = 3, 40.0, (30.0, 15.0), 12  # [-], [m/s], [m/s], [-]
SERIES = 2000
# [ft/s]
SPREADS = 60, 90, 100, 125
# [m]
FOOT = 0.3048


@dataclass(frozen=True)
class SixShots:
    """V50 of the PAIRS fastest stops and the PAIRS slowest perforations.

    Parameters
    ----------
    velocity, spread : [m/s] mean of the six, and the highest less the lowest; NaN without them
    met : [ft/s] the narrowest of SPREADS that the six are within, None of a wider spread
    reason : why there is no such V50, or ""
    doubt : what the outcomes of all shots say against it, or ""
    """

    velocity: float = nan
    spread: float = nan
    met: int | None = None
    reason: str = ""
    doubt: str = ""

    def words(self) -> str:
        """Write V50 with its spread, or why there is none."""
        name = (
            f"V50 of six shots (MIL-STD-662F: {PAIRS} fastest stops, {PAIRS} slowest perforations)"
        )
        if self.reason:
            return f"{name} not determined, because {self.reason}"
        if self.doubt:
            return f"{name} {self.velocity:.1f} m/s is no result: {self.doubt}"
        spread = f"{self.spread:.1f} m/s ({self.spread / FOOT:.0f} ft/s)"
        if self.met:
            met = f"meets {self.met} ft/s"
        else:
            met = f"exceeds {SPREADS[-1]} ft/s, the widest"
        return f"{name} {self.velocity:.1f} m/s; their spread of {spread} {met} of the standard"

    def summary(self) -> dict[str, Any]:
        """Return {name with unit: value}."""
        return {
            "six_shot_v50_m_s": self.velocity,
            "six_shot_spread_m_s": self.spread,
            "six_shot_spread_met_ft_s": self.met,
        }


def six_shots(velocity: ArrayLike, perforated: ArrayLike) -> SixShots:
    """Compute the V50 of six of some shots.

    Parameters
    ----------
    velocity : (n,) [m/s]
    perforated : (n,) bool
    """
    V = np.asarray(velocity, float)
    hit = np.asarray(perforated, bool)
    chosen = _choose_pairs(V[~hit].tolist(), V[hit].tolist())
    if len(chosen) < 2 * PAIRS:
        reason = f"{counted(int(np.sum(~hit)), 'shot')} stopped and {np.sum(hit)} perforated"
        return SixShots(reason=reason, doubt=doubt_outcomes(V, hit))
    spread = max(chosen) - min(chosen)
    met = next((width for width in SPREADS if round(spread / FOOT, 3) <= width), None)
    doubt = doubt_outcomes(V, hit)
    if doubt:
        met = None
    return SixShots(float(np.mean(chosen)), spread, met, doubt=doubt)


def doubt_outcomes(velocity: ArrayLike, perforated: ArrayLike) -> str:
    """Say that outcomes seem exchanged, where shots that perforate are the slower ones; else ""."""
    V = np.asarray(velocity, float)
    hit = np.asarray(perforated, bool)
    if hit.all() or not hit.any():
        return ""
    through, stopped = V[hit].mean(), V[~hit].mean()
    if through > stopped:
        return ""
    slower = f"perforations ({through:.1f} m/s on average) are no faster than stops ({stopped:.1f})"
    return f"{slower}: are the outcomes exchanged?"


def _choose_pairs(stops: Sequence[float], perforations: Sequence[float]) -> list[float]:
    """Velocities of the fastest stops and the slowest perforations, PAIRS of each where there are
    so many."""
    return [*sorted(stops)[-PAIRS:], *sorted(perforations)[:PAIRS]]


@dataclass(frozen=True)
class Series:
    """What many series come to.

    Parameters
    ----------
    mean, deviation : [m/s] of their V50; the deviation is what one laboratory differs from the next
        by
    low, high : [m/s] between which 95 % of them lie
    shots : [-] mean number of shots
    share : [-] of the series that have a result
    """

    mean: float
    deviation: float
    low: float
    high: float
    shots: float
    share: float

    def words(self) -> str:
        """Write what they come to in a sentence."""
        if not self.share:
            return "No short series of tests has a result: the zone of mixed outcomes is too wide."
        return (
            f"An up-and-down series of at most {MOST} shots takes the mean of the {PAIRS} fastest stops and {PAIRS} "
            f"slowest perforations within {SPAN:g} m/s. Many such series find {self.mean:.1f} m/s with a standard "
            f"deviation of {self.deviation:.1f} m/s; 95 % of them are between {self.low:.1f} and {self.high:.1f} m/s. "
            f"{100 * self.share:.0f} % have a result, after {self.shots:.1f} shots on average."
        )


def series(curve: Curve, seed: int = 1, count: int = SERIES) -> Series:
    """Fire `count` series on a fitted curve; the same seed gives the same."""
    if curve.reason:
        return Series(*(nan,) * 4, shots=nan, share=0.0)
    random = np.random.default_rng(seed)
    v50, shots = np.array([one_series(curve, random) for _ in range(count)], float).T
    results = v50[np.isfinite(v50)]
    if results.size == 0:
        return Series(*(nan,) * 4, shots=float(MOST), share=0.0)
    low, high = np.quantile(results, (0.025, 0.975)).tolist()
    return Series(
        float(results.mean()),
        float(results.std(ddof=1)),
        low,
        high,
        float(shots.mean()),
        results.size / count,
    )


def one_series(curve: Curve, random: np.random.Generator) -> tuple[float, int]:
    """Simulate one series: (its V50 [m/s], NaN without a result, its number of shots)."""
    velocity = curve.V50 + random.uniform(-STEPS[0], STEPS[0])
    step = STEPS[0]
    stops: list[float] = []
    perforations: list[float] = []
    for shot in range(1, MOST + 1):
        hit = bool(random.random() < curve.probability(velocity))
        (perforations if hit else stops).append(velocity)
        if stops and perforations:
            step = STEPS[1]
        chosen = _choose_pairs(stops, perforations)
        if len(chosen) == 2 * PAIRS and max(chosen) - min(chosen) <= SPAN:
            return float(np.mean(chosen)), shot
        velocity += -step if hit else step
    return nan, MOST
