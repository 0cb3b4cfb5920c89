"""What every result of the Python interface offers, and how it shows in a notebook."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

from fabrics.errors import DoubtfulResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.panel.quality import Indicator

__all__ = ["Result"]


class Result:
    """What every result offers; a derived class gives `summary`, `_columns` and, where it has them, the others.

    Examples
    --------
    >>> shot = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> isinstance(shot, wc.Result), shot.doubtful, shot.checks_text
    (True, False, 'ok')
    """

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks (docs/reports/numerics.md), each with name, value, limit, unit, note, status ("ok", "noted" or
        "doubtful"), doubtful (bool) and text; empty where none is defined."""
        return ()

    @property
    def doubtful(self) -> bool:
        """Whether a quality check is beyond its limit."""
        return any(one.doubtful for one in self.checks)

    @property
    def checks_text(self) -> str:
        """ "ok", or "doubtful: ..." or "noted: ..." with the worst checks, their values and limits."""
        from weavecell.report import checks

        return checks.words(self.checks)

    def warn(self) -> None:
        """Warn with the category `DoubtfulResult` if the result is doubtful."""
        if self.doubtful:
            warnings.warn(f"{self._what()}: {self.checks_text}", DoubtfulResult, stacklevel=3)

    def _what_is_assumed(self) -> dict[str, Any]:
        """Entries of a summary: what is assumed, and the range over it."""
        assumed, around = getattr(self, "assumed", ()), getattr(self, "range", None)
        entries = {"assumed": "; ".join(assumed)} if assumed else {}
        return entries if around is None else entries | {"assumed_range": around.words()}

    def _what(self) -> str:
        """The result in a few words, for the warning."""
        return type(self).__name__

    def summary(self) -> dict[str, Any]:
        """{name with unit: value} of the result; the checks in words."""
        raise NotImplementedError

    def _columns(self) -> Mapping[str, Any]:
        """{name with unit: (n,)} of the table."""
        raise NotImplementedError

    def to_dataframe(self) -> DataFrame:
        """The result as a pandas.DataFrame; names of the columns end in their SI unit."""
        from pandas import DataFrame

        return DataFrame(dict(self._columns()))

    def __repr__(self) -> str:
        shown = ", ".join(f"{key}={_text(value)}" for key, value in self.summary().items() if plain(value))
        return f"{type(self).__name__}({shown})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(key)}</th><td>{escape(_text(value))}</td></tr>"
            for key, value in self.summary().items()
            if plain(value)
        )
        return f"<table><caption>{escape(type(self).__name__)}</caption>{rows}</table>"


def plain(value: object) -> bool:
    """Whether a value is shown: a text, a number or None."""
    return isinstance(value, (str, int, float)) or value is None


def _text(value):
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def figure(draw: Callable, *arguments: Any) -> Figure:
    """What draw(pyplot, *arguments) returns, in the style of the reports."""
    from meshing.pictures_style import plots

    with plots() as pyplot:
        return draw(pyplot, *arguments)
