"""What a shot of one velocity comes to over all that nobody gave: drawn shots, as `v50` draws them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import betaincinv

from fabrics.base.counted import counted
from shellfabric.impact.setup import ImpactSetup
from weavecell.runs import table
from weavecell.runs.go_no_go import LEVELS
from weavecell.runs.outcomes import DEPENDS
from weavecell.runs.span import CONFIDENCE, Span
from weavecell.runs.table import Shot
from weavecell.studies.inputs import Scatter
from weavecell.studies.unknown import find_unknown


@dataclass(frozen=True)
class Passing:
    """Drawn shots of one velocity.

    Parameters
    ----------
    velocity : [m/s]
    shots : tuple of Shot that have an outcome
    unknown : {what is assumed: (low, high)} of the frictions that were drawn
    failures : why others have none
    """

    velocity: float
    shots: tuple[Shot, ...]
    unknown: dict[str, tuple[float, float]]
    failures: tuple[str, ...] = ()

    @cached_property
    def share(self) -> Span:
        """[-] of shots that perforate, with its interval by Jeffreys' prior."""
        hits, count = sum(shot.perforated for shot in self.shots), len(self.shots)
        part = 0.5 * (1 - CONFIDENCE)
        ends = betaincinv(hits + 0.5, count - hits + 0.5, (part, 1 - part))
        return Span(hits / count, *map(float, ends))

    def quantiles(self, name: str) -> tuple[float, ...]:
        """Return LEVELS of a field of the shots, "residual" [m/s] or "deflection" [m]."""
        return tuple(map(float, np.quantile([getattr(shot, name) for shot in self.shots], LEVELS)))

    @property
    def outcome(self) -> str:
        """Of all shots, or that they differ."""
        outcomes = {shot.outcome for shot in self.shots}
        return outcomes.pop() if len(outcomes) == 1 else DEPENDS

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many shots have which checks beyond their limits, or no outcome."""
        return count_doubts(self.shots, self.failures)

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
    rows = table.draw(setup, draws, seed=seed, scatter=scatter)
    fired = table.run(rows, **runs)
    shots = tuple(shot for shot in fired if not shot.failure)
    failures = tuple(shot.failure for shot in fired if shot.failure)
    return Passing(setup.strike_velocity, shots, find_unknown(setup), failures)


def count_doubts(shots: Sequence[Shot], failures: Sequence[str] = ()) -> tuple[str, ...]:
    """Say of how many shots which checks are beyond their limits, and how many have no outcome."""
    found = Counter(name for shot in shots for name in shot.doubtful)
    count = counted(len(shots), "drawn shot")
    parts = [f"{name} in {times} of {count}" for name, times in found.most_common()]
    lost = len(failures) + sum(bool(shot.failure) for shot in shots)
    if lost:
        parts.append(f"{counted(lost, 'drawn shot')} without an outcome")
    return tuple(parts)


def _say_span(values):
    """Return the lowest and the highest of numbers."""
    listed = [*values]
    return " to ".join(dict.fromkeys(f"{end:.3g}" for end in (min(listed), max(listed))))
