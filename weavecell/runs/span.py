"""A number with its interval."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fabrics.base.checks import FloatArray

CONFIDENCE = 0.9


class Span(NamedTuple):
    """A median with its interval of CONFIDENCE."""

    value: float
    low: float
    high: float

    @property
    def half(self) -> float:
        """Half of the width of the interval."""
        return 0.5 * (self.high - self.low)

    def words(self, unit: str = "m/s") -> str:
        """Write it with its interval."""
        middle = f"{self.value:.3g} {unit}".rstrip()
        return f"{middle} ({self.low:.3g} to {self.high:.3g})"


def find_spans(values: FloatArray) -> list[Span]:
    """Find the Span of each column of equally likely values (d, n)."""
    part = 0.5 * (1 - CONFIDENCE)
    low, value, high = np.quantile(values, (part, 0.5, 1 - part), axis=0)
    return [Span(*map(float, one)) for one in zip(value, low, high)]
