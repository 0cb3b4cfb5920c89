"""What a shot of one velocity comes to over all that nobody gave: drawn shots, as `v50` draws them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import betaincinv

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from shellfabric.impact.setup import ImpactSetup
from weavecell.runs import go_no_go, table, v50
from weavecell.runs.go_no_go import LEVELS, LimitPosterior, Outcomes
from weavecell.runs.measurement import Measurement, measure_known, rank
from weavecell.runs.outcomes import DEPENDS
from weavecell.runs.span import CONFIDENCE, Span
from weavecell.runs.table import Shot
from weavecell.studies import strengths
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
    posterior : of limits; None where outcomes are all alike
    """

    velocity: float
    shots: tuple[Shot, ...]
    unknown: dict[str, tuple[float, float]]
    failures: tuple[str, ...] = ()
    posterior: LimitPosterior | None = None

    @cached_property
    def share(self) -> Span:
        """[-] of shots that perforate, with its interval by Jeffreys' prior."""
        hits, count = sum(shot.perforated for shot in self.shots), len(self.shots)
        part = 0.5 * (1 - CONFIDENCE)
        ends = betaincinv(hits + 0.5, count - hits + 0.5, (part, 1 - part))
        return Span(hits / count, *map(float, ends))

    @cached_property
    def measurements(self) -> tuple[Measurement, ...]:
        """What measurements leave of the share of shots at a cloth that passes, what narrows it most first."""

        def find(posterior):
            return posterior.cloths_passed(self.velocity)

        answer = "share of shots at a cloth that passes"
        return rank(measure_known(self.posterior, self.unknown, find, answer, ""))

    def quantiles(self, name: str) -> tuple[float, ...]:
        """Return LEVELS of a field of the shots that have it, "residual" [m/s] or "deflection" [m]; NaN
        if none has."""
        known = [getattr(shot, name) for shot in self.shots]
        known = [value for value in known if np.isfinite(value)] or [np.nan]
        return tuple(map(float, np.quantile(known, LEVELS)))

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
    setup: ImpactSetup, scatter: Scatter, *, draws: int, seed: int, folder: FilePath, **runs: Any
) -> Passing:
    """Fire drawn shots at the strike velocity of a set-up.

    Parameters
    ----------
    setup : ImpactSetup of resolved yarns
    folder, runs : as of `run_cache.results`
    """
    rows = table.draw(setup, draws, seed=seed, scatter=scatter)
    fired = table.run(rows, folder=folder, **runs)
    shots = tuple(shot for shot in fired if not shot.failure)
    failures = tuple(shot.failure for shot in fired if shot.failure)
    posterior = _fit(rows[0].setup, shots, setup.strike_velocity, seed)
    return Passing(setup.strike_velocity, shots, find_unknown(setup), failures, posterior)


def _fit(setup, shots, velocity, seed):
    """Return the posterior of limits of shots at one velocity, which the first guess is; None where outcomes are
    all alike."""
    known = [strengths.draw_known(setup, seed, shot.number) for shot in shots]
    perforated = [shot.perforated for shot in shots]
    if len(set(perforated)) < 2:
        return None
    rows = np.array([[*one.values()] for one in known]).reshape(len(known), len(known[0]))
    outcomes = Outcomes(tuple(known[0]), rows, np.full(len(rows), velocity), np.array(perforated))
    return go_no_go.fit(outcomes, velocity, v50.draw_population(setup, seed))


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
