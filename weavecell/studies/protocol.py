"""V50 as a laboratory finds it: of six shots.

MIL-STD-662F takes the mean of as many of the fastest stops as of the slowest perforations, here
PAIRS of each, whose velocities lie within a spread that the test states; SPREADS are those of the
standard.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.counted import counted

PAIRS = 3  # stops, and perforations
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
        name = "V50 of six shots (MIL-STD-662F)"
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
