"""Quality indicators of a run as users meet them: in summary.json, in the report, in one printed line, as exit code."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from fabrics.base.errors import DoubtfulError
from shellfabric.panel.quality import DOUBTFUL, NOTED, OK, status
from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from shellfabric.panel.quality import Indicator
    from weavecell.studies.ballistic_limit import Limit, Shot

_SHOWN = 3  # indicators of the printed line


def summary(indicators: Sequence[Indicator]) -> dict[str, Any]:
    """{"checks": {"status", "indicators"}} for summary.json."""
    return {
        "checks": {"status": status(indicators), "indicators": [one.entry() for one in indicators]}
    }


def line(indicators: Iterable[Indicator], status: str = DOUBTFUL) -> str:
    """The worst indicators of a status, each with value and limit; "" if there is none."""
    found = sorted(
        (one for one in indicators if one.status == status),
        key=lambda one: one.excess,
        reverse=True,
    )
    more = f"; {len(found) - _SHOWN} more in the summary" if len(found) > _SHOWN else ""
    return "; ".join(map(str, found[:_SHOWN])) + more if found else ""


def words(indicators: Sequence[Indicator]) -> str:
    """ "ok", or "doubtful: ..." or "noted: ..." with the worst indicators."""
    found = status(indicators)
    return found if found == OK else f"{found}: {line(indicators, found)}"


def of_shot(shot: Shot) -> str:
    """A shot in a few words, for the progress of a search."""
    doubt = ", doubtful" if status(shot.checks) == DOUBTFUL else ""
    return f"{shot.outcome} at {shot.strike_velocity:.1f} m/s{doubt}"


def of_bracket(limit: Limit) -> str:
    """ "ok", or the doubtful shots at the ends of the bracket and of the zone of mixed outcomes."""
    found = [
        f"{shot.outcome} shot at {shot.strike_velocity:.4g} m/s ({line(shot.checks)})"
        for shot in limit.ends
        if status(shot.checks) == DOUBTFUL
    ]
    return f"doubtful {' and '.join(found)}" if found else OK


def report(indicators: Sequence[Indicator], strict: bool = False) -> None:
    """Print one line if the run is doubtful, and one if something of it is noted.

    Raises
    ------
    DoubtfulError : it is doubtful, and `strict`; to be called when all results have been written
    """
    for found in (NOTED, DOUBTFUL):
        if text := line(indicators, found):
            print(f"checks: {found}: {text}", flush=True)
    if strict and text:
        raise DoubtfulError(f"the result is doubtful: {text}")


def section(indicators: Sequence[Indicator]) -> Section:
    """The section of a report."""
    texts = {found: line(indicators, found) for found in (DOUBTFUL, NOTED)}
    sentences = [f"{found.capitalize()}: {text}." for found, text in texts.items() if text]
    lead = " ".join(sentences) if sentences else "Every indicator is within its limit."
    notes = ["" if one.note is None else f" (noted above {one.note:g})" for one in indicators]
    rows = tuple(
        (one.name, one.number, f"{one.limit:g}", one.status + note, one.meaning)
        for one, note in zip(indicators, notes)
    )
    columns = ("indicator", "value", "limit", "status", "value is")
    return Section(
        "checks", "Quality checks", lead, tables=(Table(columns, rows, numeric=columns[1:3]),)
    )
