"""Which of two panels has the higher V50, by the difference of the two and its interval, whose half width falls as
1 / sqrt(shots)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, hypot, inf, sqrt

import numpy as np

BETTER, WORSE, UNDECIDED = "better", "worse", "not decided"
# beyond so many shots of each the two are alike for all that is of use
MOST_SHOTS = 10_000
# numbers of shots for which a width is forecast
COUNTS = (10, 20, 40, 80, 160, 320)


@dataclass(frozen=True)
class Difference:
    """Difference of V50 of A and B.

    Parameters
    ----------
    value, low, high : [m/s] A less B, and its interval; infinite where there is none
    shots : [-] of each, those of the fewer
    confidence : [-] of the interval
    reason : why there is no difference; "" if there is one
    """

    value: float
    low: float
    high: float
    shots: int
    confidence: float
    reason: str = ""

    @property
    def verdict(self) -> str:
        """BETTER if A is better with this confidence, WORSE, or UNDECIDED."""
        return judge(self.low, self.high)

    def shots_to_decide(self) -> int | None:
        """Return the number of shots of each after which this difference would be decided; None if
        more than MOST_SHOTS, or if nothing is known of the width."""
        half = half_width_to_zero(self.value, self.low, self.high)
        if not 0 < half < inf or self.value == 0:
            return None
        needed = self.shots * (half / abs(self.value)) ** 2
        if needed > MOST_SHOTS:
            return None
        return max(ceil(needed), self.shots)

    def width_after(self, shots: int) -> float:
        """Forecast the half width [m/s] of the interval after a number of shots of each."""
        return 0.5 * (self.high - self.low) * sqrt(self.shots / shots)


def subtract(
    a: tuple[float, float, float], b: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Compute A less B of two independent (value, low, high), with the interval of the difference
    whose sides are those of the two squared, added and rooted (Newcombe 1998, Statistics in Medicine
    17, 873, method 10)."""
    value = a[0] - b[0]
    low = value - hypot(a[0] - a[1], b[2] - b[0])
    high = value + hypot(a[2] - a[0], b[0] - b[1])
    return value, low, high


def judge(low: float, high: float) -> str:
    """Return BETTER if an interval of a difference is above 0, WORSE below it, else UNDECIDED."""
    if low > 0:
        return BETTER
    if high < 0:
        return WORSE
    return UNDECIDED


def half_width_to_zero(value: float, low: float, high: float) -> float:
    """Return the width of the side of an interval that reaches towards 0; NaN without a value."""
    return value - low if value > 0 else high - value


def forecast_widths(
    difference: Difference, counts: Sequence[int] = COUNTS
) -> list[tuple[int, float, str]]:
    """Forecast (shots of each, half width [m/s] of the interval, verdict if the difference stays)
    for numbers of shots; nothing where the shots set no width."""
    if not np.isfinite([difference.low, difference.high]).all():
        return []
    rows = []
    for count in counts:
        shrink = sqrt(difference.shots / count)
        ends = [
            difference.value + shrink * (end - difference.value)
            for end in (difference.low, difference.high)
        ]
        rows.append((count, difference.width_after(count), judge(*ends)))
    return rows
