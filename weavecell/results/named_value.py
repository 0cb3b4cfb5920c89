"""A value with its name, unit and uncertainty, as it is written in a text, in a cell of a table and
in a summary.

A result lists its values once, as `NamedValue`; what it prints, its pages and its tables are made
from that list.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isnan
from typing import TYPE_CHECKING

from weavecell.results import display

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True)
class NamedValue:
    """A value, its interval, or both.

    Parameters
    ----------
    name : as a text and a heading have it
    value : in its unit; None if it is not known, or if only its interval is
    unit : one of `display.SHOWN` or another unit, "1" without
    low, high : ends of its interval, in its unit; None without
    error : what is written behind +-, in its unit; None without
    form : format of the value
    margin : format of the interval and the error; that of the value without
    """

    name: str
    value: float | None
    unit: str
    low: float | None = None
    high: float | None = None
    error: float | None = None
    form: str = ".4g"
    margin: str = ""

    @property
    def heading(self) -> str:
        """Name and unit shown, such as "a [mm]"."""
        return display.heading(self.name, self.unit)

    @property
    def unit_shown(self) -> str:
        """The unit behind the number in a text."""
        return display.choose_unit(self.unit)[0]

    def ends(self) -> tuple[str, str]:
        """Format both ends of the interval in the unit shown and without it."""
        low, high = (
            display.number(end, self.unit, self.margin or self.form)
            for end in (self.low, self.high)
        )
        return low, high

    def interval(self) -> str:
        """Format the interval without its unit, such as "0.0438 .. 0.0457"."""
        return " .. ".join(self.ends())

    def cell(self) -> str:
        """Format the value for a table whose heading has the unit: with its error, "inf" where that
        has no bound; in place of a missing value its interval, else a dash."""
        if self.value is None and self.low is not None:
            return self.interval()
        number = display.number(self.value, self.unit, self.form)
        if self.error is None or self.value is None or isnan(self.value):
            return number
        error = "inf"
        if self.error < inf:
            error = display.number(self.error, self.unit, self.margin or self.form)
        return f"{number} +- {error}"

    def numbers(self) -> tuple[float | None, float | None]:
        """Return value and error in the unit shown, for a table of numbers."""
        factor = display.choose_unit(self.unit)[1]
        value, error = (
            None if given is None else factor * given for given in (self.value, self.error)
        )
        return value, error

    def text(self) -> str:
        """Format the value with its unit, such as "0.0447 mm"."""
        return f"{self.cell()} {self.unit_shown}".rstrip()

    def line(self) -> str:
        """Format the value with its name and unit, such as "a = 0.0447 mm"."""
        return f"{self.name} = {self.text()}"

    def entries(self, part: str = "") -> dict[str, float | None]:
        """Return the entries of a summary, in SI units: {"a_m": value}, with a part "soft"
        {"a_soft_m": value}, of an interval alone {"a_interval_low", "a_interval_high": its ends}."""
        if self.value is None and self.low is not None:
            return {f"{self.name}_interval_low": self.low, f"{self.name}_interval_high": self.high}
        words = [self.name, part, display.si_unit(self.unit).replace(" ", "_")]
        return {"_".join(filter(None, words)): self.value}


def tabulate(label: str, rows: Iterable[tuple[str, Sequence[NamedValue]]]) -> DataFrame:
    """Tabulate rows of (name of the row, its values), cells as texts.

    Parameters
    ----------
    label : heading of the first column, the names of the rows
    rows : at least one; all have the same values in the same order, whose headings the first has

    Returns
    -------
    table : DataFrame, one column a value
    """
    from pandas import DataFrame

    listed = list(rows)
    _, first = listed[0]
    headings = [label, *(value.heading for value in first)]
    cells = [(name, *(value.cell() for value in values)) for name, values in listed]
    return DataFrame(cells, columns=headings)
