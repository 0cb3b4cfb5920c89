"""A quality indicator, one number with its limit, and the status of several; which there are is in
`membrane.quality`. Nothing else is imported: every result of the application has indicators."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

OK = "ok"
NOTED = "noted"
DOUBTFUL = "doubtful"


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
