"""A quality check with its limit and what to do beyond it, an indicator, which is a check with a
number, and the status of several. Checks of runs are in `membrane.quality`, those of studies beside
what they judge. Nothing else is imported: every result of the application has indicators."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from math import isfinite
from typing import Any

OK = "ok"
NOTED = "noted"
DOUBTFUL = "doubtful"


@dataclass(frozen=True)
class Check:
    """A quality check, before there is a number.

    Parameters
    ----------
    name, limit, meaning, note, unit : as of its Indicator
    advice : what to do beyond the limit; in braces what a set-up has to take first
        (`impact.proposals`)
    """

    name: str
    limit: float
    meaning: str
    advice: str
    note: float | None = None
    unit: str = ""

    def judge(self, value: float, meaning: str | None = None) -> Indicator:
        """Return the Indicator of a value.

        Parameters
        ----------
        meaning : what this value is, in place of the check's own words
        """
        if meaning is None:
            meaning = self.meaning
        found = Indicator(self.name, float(value), self.limit, self.unit, meaning, self.note)
        if found.doubtful and "{" not in self.advice:
            found = replace(found, remedy=self.advice)
        return found


@dataclass(frozen=True)
class Indicator:
    """A quality indicator: one number with its limit.

    Parameters
    ----------
    name : for the reader and as the key in summary.json
    value, limit : value <= limit where all is well; a value that is not finite is not well
    unit : of both; "" where it is a ratio
    meaning : what the value is, in one sentence
    note : value above which the indicator is noted though it is within its limit, or None
    remedy : what to do beyond the limit; of a shot only what its set-up takes (`impact.proposals`)
    """

    name: str
    value: float
    limit: float
    unit: str = ""
    meaning: str = ""
    note: float | None = None
    remedy: str = ""

    @property
    def ok(self) -> bool:
        """Whether the value is within the limit."""
        return isfinite(self.value) and self.value <= self.limit

    @property
    def doubtful(self) -> bool:
        """Whether the value is beyond the limit."""
        return not self.ok

    @property
    def status(self) -> str:
        """ "ok", "noted" or "doubtful"."""
        if self.doubtful:
            return DOUBTFUL
        if self.note is not None and self.value > self.note:
            return NOTED
        return OK

    @property
    def text(self) -> str:
        """Value, limit and what the value is."""
        return f"{self}: {self.meaning}"

    @property
    def excess(self) -> float:
        """[-] value over limit."""
        if not isfinite(self.value):
            return float("inf")
        if self.limit > 0:
            return self.value / self.limit
        if self.value > self.limit:
            return float("inf")
        return 0.0

    @property
    def number(self) -> str:
        """The value with two decimals or three digits; with more where it passes the limit by
        less."""
        for decimals in range(2, 9):
            if self.value >= 1:
                text = f"{self.value:.{decimals}f}"
            else:
                text = f"{self.value:#.{decimals + 1}g}"
            if self.ok or float(text) > self.limit:
                break
        return text

    def __str__(self):
        unit = f" {self.unit}".rstrip()
        bounds = f"limit {self.limit:g}{unit}"
        if self.status == NOTED:
            bounds = f"noted above {self.note:g}{unit}, {bounds}"
        if self.doubtful and self.remedy:
            bounds = f"{bounds}; {self.remedy}"
        return f"{self.name} {self.number}{unit} ({bounds})"

    def entry(self) -> dict[str, Any]:
        """Return it as a dict, for summary.json."""
        return asdict(self) | {"ok": self.ok, "status": self.status}


def status(indicators: Iterable[Indicator]) -> str:
    """Return the worst status of several indicators: "ok", "noted" or "doubtful"; "ok" of none."""
    return max((one.status for one in indicators), key=(OK, NOTED, DOUBTFUL).index, default=OK)
