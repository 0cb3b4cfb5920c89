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

# the printed line names so many indicators
_SHOWN = 3


def summary(indicators: Sequence[Indicator]) -> dict[str, Any]:
    """{"checks": {"status", "indicators"}} for summary.json."""
    return {
        "checks": {"status": status(indicators), "indicators": [one.entry() for one in indicators]}
    }


def line(indicators: Iterable[Indicator], status: str = DOUBTFUL) -> str:
    """The worst indicators of a status, each with value and limit; "" if there is none."""
    found = [one for one in indicators if one.status == status]
    found.sort(key=lambda one: one.excess, reverse=True)
    text = "; ".join(map(str, found[:_SHOWN]))
    if len(found) > _SHOWN:
        text += f"; {len(found) - _SHOWN} more in the summary"
    return text


def words(indicators: Sequence[Indicator]) -> str:
    """ "ok", or "doubtful: ..." or "noted: ..." with the worst indicators."""
    found = status(indicators)
    if found == OK:
        return found
    return f"{found}: {line(indicators, found)}"


def of_shot(shot: Shot) -> str:
    """A shot in a few words, for the progress of a search."""
    words = f"{shot.outcome} at {shot.strike_velocity:.1f} m/s"
    if status(shot.checks) == DOUBTFUL:
        words += ", doubtful"
    return words


def of_bracket(limit: Limit) -> str:
    """ "ok", or the doubtful shots at the ends of the bracket and of the zone of mixed outcomes."""
    found = []
    for shot in limit.ends:
        if status(shot.checks) == DOUBTFUL:
            velocity = f"{shot.strike_velocity:.4g} m/s"
            found.append(f"{shot.outcome} shot at {velocity} ({line(shot.checks)})")
    if not found:
        return OK
    return f"doubtful {' and '.join(found)}"


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
    sentences = []
    for found in (DOUBTFUL, NOTED):
        if text := line(indicators, found):
            sentences.append(f"{found.capitalize()}: {text}.")
    lead = " ".join(sentences) or "Every indicator is within its limit."
    rows = []
    for one in indicators:
        state = one.status
        if one.note is not None:
            state += f" (noted above {one.note:g})"
        rows.append((one.name, one.number, f"{one.limit:g}", state, one.meaning))
    columns = ("indicator", "value", "limit", "status", "value is")
    table = Table(columns, tuple(rows), numeric=columns[1:3])
    return Section("checks", "Quality checks", lead, tables=(table,))
