"""What a shot of one velocity comes to over all that nobody gave: drawn shots, as `v50` draws them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import betaincinv

from fabrics.base import run_cache
from fabrics.base.counted import counted
from shellfabric.impact.setup import ImpactSetup
from weavecell.studies import drawn, strengths, v50
from weavecell.studies.drawn import Span
from weavecell.studies.inputs import Scatter
from weavecell.studies.mover import DEPENDS
from weavecell.studies.unknown import find_unknown


@dataclass(frozen=True)
class Passing:
    """Drawn shots of one velocity.

    Parameters
    ----------
    velocity : [m/s]
    shots : tuple of `v50.Shot` that have an outcome
    unknown : {what is assumed: (low, high)} of the frictions that were drawn
    failures : why others have none
    """

    velocity: float
    shots: tuple[v50.Shot, ...]
    unknown: dict[str, tuple[float, float]]
    failures: tuple[str, ...] = ()

    @cached_property
    def share(self) -> Span:
        """[-] of shots that perforate, with its interval by Jeffreys' prior."""
        hits, count = sum(shot.perforated for shot in self.shots), len(self.shots)
        part = 0.5 * (1 - drawn.CONFIDENCE)
        ends = betaincinv(hits + 0.5, count - hits + 0.5, (part, 1 - part))
        return Span(hits / count, *map(float, ends))

    def quantiles(self, name: str) -> tuple[float, ...]:
        """Return `drawn.LEVELS` of a field of the shots, "residual" [m/s] or "deflection" [m]."""
        return tuple(
            map(float, np.quantile([getattr(shot, name) for shot in self.shots], drawn.LEVELS))
        )

    @property
    def outcome(self) -> str:
        """Of all shots, or that they differ."""
        outcomes = {shot.outcome for shot in self.shots}
        return outcomes.pop() if len(outcomes) == 1 else DEPENDS

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many shots have which checks beyond their limits, or no outcome."""
        found = Counter(name for shot in self.shots for name in shot.doubtful)
        count = counted(len(self.shots), "drawn shot")
        parts = [f"{name} in {times} of {count}" for name, times in found.most_common()]
        if self.failures:
            parts.append(f"{counted(len(self.failures), 'drawn shot')} without an outcome")
        return tuple(parts)

    def words(self) -> str:
        """Write share, residual velocities and deflections in one line."""
        if not self.shots:
            return f"not determined: {self.failures[0]}"
        hits, count = sum(shot.perforated for shot in self.shots), len(self.shots)
        low, high = (f"{100 * end:.0f}" for end in self.share[1:])
        parts = [
            f"{hits} of {counted(count, 'drawn shot')} pass ({low} to {high} %, 90 % interval)"
        ]
        if hits:
            left = (shot.residual for shot in self.shots if shot.perforated)
            parts[0] += f", {_say_span(left)} m/s left"
        if hits < count:
            moved = (1e3 * shot.deflection for shot in self.shots if not shot.perforated)
            stopping = "of the others " if hits else ""
            parts.append(f"the back face {stopping}moves {_say_span(moved)} mm")
        return "; ".join(parts)

    def summary(self) -> dict[str, Any]:
        """Return it as plain types."""
        if not self.shots:
            return {"shots": 0, "failures": self.failures}
        return {
            "shots": len(self.shots),
            "share": list(self.share),
            "residual_velocity_m_s": self.quantiles("residual"),
            "deflection_m": self.quantiles("deflection"),
            "failures": self.failures,
        }


def fire_draws(
    setup: ImpactSetup, scatter: Scatter, *, draws: int, seed: int, **runs: Any
) -> Passing:
    """Fire drawn shots at the strike velocity of a set-up.

    Parameters
    ----------
    setup : ImpactSetup of resolved yarns
    runs : as of `run_cache.results`
    """
    strengths.check(setup, scatter)
    fired_at = v50.as_fired(setup)
    arguments = [
        (fired_at, scatter, seed, number, setup.strike_velocity) for number in range(draws)
    ]
    fired = run_cache.results(v50.fire, arguments, **runs)
    counted_shots = tuple(shot for shot in fired if not shot.failure)
    failures = tuple(shot.failure for shot in fired if shot.failure)
    return Passing(setup.strike_velocity, counted_shots, find_unknown(setup), failures)


def _say_span(values):
    """The lowest and the highest of numbers."""
    listed = [*values]
    return " to ".join(dict.fromkeys(f"{end:.3g}" for end in (min(listed), max(listed))))
