"""Which of two panels stops more: the difference of two answers, whose interval narrows as 1 / sqrt(shots)."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, inf, nan

import numpy as np

from fabrics.base.checks import FloatArray
from weavecell.runs.span import CONFIDENCE, Span, find_spans

BETTER, WORSE, UNDECIDED = "better", "worse", "not decided"
# beyond so many shots of each the two are alike for all that is of use
MOST_SHOTS = 10_000


@dataclass(frozen=True)
class Difference:
    """A less B.

    Parameters
    ----------
    span : Span; infinite where there is none
    shots : [-] of each, those of the fewer
    reason : why there is no difference; "" if there is one
    """

    span: Span
    shots: int
    reason: str = ""

    confidence = CONFIDENCE

    @classmethod
    def missing(cls, shots: int, reason: str) -> Difference:
        """Return the difference of answers of which one is missing."""
        return cls(Span(nan, -inf, inf), shots, reason)

    @property
    def value(self) -> float:
        """Its median."""
        return self.span.value

    @property
    def verdict(self) -> str:
        """BETTER if A is better over the whole interval, WORSE, or UNDECIDED."""
        if self.span.low > 0:
            return BETTER
        if self.span.high < 0:
            return WORSE
        return UNDECIDED

    def shots_to_decide(self) -> int | None:
        """Return the number of shots of each after which this difference would be decided; None if it
        is, if more than MOST_SHOTS would be needed, or if nothing is known of the width."""
        value, low, high = self.span
        half = value - low if value > 0 else high - value
        if self.verdict != UNDECIDED or not 0 < half < inf or value == 0:
            return None
        needed = self.shots * (half / abs(value)) ** 2
        if needed > MOST_SHOTS:
            return None
        return max(ceil(needed), self.shots + 1)


def subtract(a: FloatArray, b: FloatArray) -> Span:
    """Return the Span of equally likely values (d,) less as many others, drawn apart from each other."""
    # two posteriors are sampled with the same random numbers; both ways round, so that b less a is the
    # same turned round, and a less a is nothing
    mixed = np.random.default_rng(1).permutation(len(a))
    return find_spans(np.concatenate([a - b[mixed], a[mixed] - b])[:, None])[0]
