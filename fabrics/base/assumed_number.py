"""A number that is not known exactly: it stands in for one that nobody has given, or was given with a
range.

Drawn shots cover the range, and leave a number that was given without one as it is. Whether a number
is assumed cannot be told by its value, since a measured one may be the same. The number says it
itself: it goes wherever a float goes, and any other number in its place, or any number that is
computed from it, is a plain float.
"""

from __future__ import annotations


class Assumed(float):
    """A float with the range in which it is taken to lie.

    Parameters
    ----------
    value : in any unit
    low, high : of the range; the value itself if none is known where it is assumed
    deviation : one standard deviation, of a normal distribution between these ends; 0 of one that
        is even on either side of the value
    given : whether the user gave value and range, so that they are no assumption
    """

    low: float
    high: float
    deviation: float
    given: bool

    def __new__(
        cls,
        value: float,
        low: float | None = None,
        high: float | None = None,
        deviation: float = 0.0,
        given: bool = False,
    ) -> Assumed:
        number = super().__new__(cls, value)
        number.low = float(value) if low is None else float(low)
        number.high = float(value) if high is None else float(high)
        number.deviation = float(deviation)
        number.given = bool(given)
        return number

    @property
    def parts(self) -> tuple[float, float, float, float, bool]:
        """Its value and all that is said of it, as `Assumed` takes them."""
        return float(self), self.low, self.high, self.deviation, self.given

    def __getnewargs__(self):
        # a copy in another process is assumed too
        return self.parts

    @property
    def span(self) -> tuple[float, float]:
        """(low, high)"""
        return self.low, self.high

    @property
    def words(self) -> str:
        """The range, and whether it is assumed, in words: "assumed 0.1 to 0.3"."""
        said = "given as" if self.given else "assumed"
        if self.deviation:
            return f"{said} {float(self):g} ± {self.deviation:g}"
        return f"{said} {self.low:g} to {self.high:g}"


def is_assumed(number: float | None) -> bool:
    """Return whether a number has a range, and is not one of the user's own without."""
    return isinstance(number, Assumed)
