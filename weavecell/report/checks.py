"""Quality indicators of a run as users meet them: in summary.json, in the report, in one printed line, as exit code."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from fabrics.errors import DoubtfulError
from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from shellfabric.panel.quality import Indicator

_SHOWN = 3  # indicators of the printed line


def status(indicators: Iterable[Indicator]) -> str:
    """ "ok", or "doubtful" if an indicator is beyond its limit."""
    return "ok" if all(one.ok for one in indicators) else "doubtful"


def summary(indicators: Sequence[Indicator]) -> dict[str, Any]:
    """{"checks": {"status", "indicators"}} for summary.json."""
    return {"checks": {"status": status(indicators), "indicators": [one.entry() for one in indicators]}}


def line(indicators: Iterable[Indicator]) -> str:
    """The worst indicators beyond their limits, each with value and limit; "" if there is none."""
    beyond = sorted((one for one in indicators if not one.ok), key=lambda one: one.excess, reverse=True)
    more = f"; {len(beyond) - _SHOWN} more in the summary" if len(beyond) > _SHOWN else ""
    return "; ".join(map(str, beyond[:_SHOWN])) + more if beyond else ""


def report(indicators: Iterable[Indicator], strict: bool = False) -> None:
    """Print one line if the run is doubtful.

    Raises
    ------
    DoubtfulError : it is, and `strict`; to be called when all results have been written
    """
    text = line(indicators)
    if text:
        print(f"checks: doubtful: {text}", flush=True)
        if strict:
            raise DoubtfulError(f"the result is doubtful: {text}")


def section(indicators: Sequence[Indicator]) -> Section:
    """The section of a report."""
    found = status(indicators)
    lead = "Every indicator is within its limit." if found == "ok" else f"Doubtful: {line(indicators)}."
    rows = tuple(
        (one.name, f"{one.value:.3g}", f"{one.limit:g}", "ok" if one.ok else "beyond", one.meaning)
        for one in indicators
    )
    columns = ("indicator", "value", "limit", "status", "meaning")
    return Section("checks", "Quality checks", lead, tables=(Table(columns, rows, numeric=columns[1:3]),))
