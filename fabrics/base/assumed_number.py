"""A number that stands in for one that the user has not given.

Runs cover the range of what is assumed, and leave a measured number as it is. Whether a number is
assumed cannot be told by its value, since a measured one may be the same. The number says it
itself: it goes wherever a float goes, and any other number in its place, or any number that is
computed from it, is a plain float.
"""

from __future__ import annotations


class Assumed(float):
    """A float that is assumed, with the range in which it is taken to lie.

    Parameters
    ----------
    value : in any unit
    low, high : of the range; the value itself if none is known where it is assumed
    """

    low: float
    high: float

    def __new__(cls, value: float, low: float | None = None, high: float | None = None) -> Assumed:
        number = super().__new__(cls, value)
        number.low = float(value) if low is None else float(low)
        number.high = float(value) if high is None else float(high)
        return number

    def __getnewargs__(self):
        # a copy in another process is assumed too
        return float(self), self.low, self.high

    @property
    def span(self) -> tuple[float, float]:
        """(low, high)"""
        return self.low, self.high


def is_assumed(number: float | None) -> bool:
    """Return whether a number is assumed, and not one of the user's own."""
    return isinstance(number, Assumed)


def least(number: float) -> float:
    """Return the low end of the range of a number that is assumed; any other number itself."""
    if isinstance(number, Assumed):
        return number.low
    return float(number)
