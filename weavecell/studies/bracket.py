"""Bisection for a limit: what is known of it, and which velocities are to be tried next."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from math import inf

# first factor from the guess towards the other outcome; it is squared with every step
STEP = 1.2


@dataclass(frozen=True)
class Bracket:
    """What is known of the limit, and hence which velocity is to be tried next.

    Parameters
    ----------
    guess : [m/s] where to begin
    lowest, highest : [m/s] between which to look
    low, high : [m/s] stops, perforates; 0 and infinity where unknown
    factor : of the next step while one end is unknown
    """

    guess: float
    lowest: float
    highest: float
    low: float = 0.0
    high: float = inf
    factor: float = STEP

    @property
    def width(self) -> float:
        """[m/s]; infinite while one end is unknown."""
        if self.closed:
            return self.high - self.low
        return inf

    @property
    def closed(self) -> bool:
        """Whether both ends are known."""
        return self.low > 0 and self.high < inf

    @property
    def exhausted(self) -> bool:
        """Whether one end is unknown and there is no more room to look for it."""
        return not self.closed and (self.low >= self.highest or self.high <= self.lowest)

    def next(self) -> float:
        """Return the velocity [m/s] to try."""
        if self.closed:
            return 0.5 * (self.low + self.high)
        if self.low > 0:
            return min(self.low * self.factor, self.highest)
        if self.high < inf:
            return max(self.high / self.factor, self.lowest)
        return self.guess

    def update(self, perforated: bool) -> Bracket:
        """Return the bracket once the outcome of the next velocity is known."""
        end = {"high" if perforated else "low": self.next()}
        stepping = not self.closed and (self.low > 0 or self.high < inf)
        return replace(self, **end, factor=self.factor**2 if stepping else self.factor)

    def predict(self, count: int, tolerance: float) -> list[float]:
        """List the next velocity and those that may follow it, the most likely first; at most
        `count`."""
        wanted: list[float] = []
        open_ends = deque([self])
        while open_ends and len(wanted) < count:
            bracket = open_ends.popleft()
            if bracket.width > tolerance and not bracket.exhausted:
                wanted.append(bracket.next())
                open_ends.extend((bracket.update(False), bracket.update(True)))
        return wanted
