"""Quality indicators of a run as users meet them: in summary.json, in the report, in one printed
line, as exit code."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from shellfabric.membrane.indicator import DOUBTFUL, NOTED, OK, status
from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from shellfabric.membrane.indicator import Indicator
    from weavecell.studies.ballistic_limit import Limit, Shot

# the printed line names so many indicators
_SHOWN = 3


def summary(indicators: Sequence[Indicator]) -> dict[str, Any]:
    """Return {"checks": {"status", "indicators"}} for summary.json."""
    return {
        "checks": {
            "status": status(indicators),
            "indicators": [indicator.entry() for indicator in indicators],
        }
    }


def line(indicators: Iterable[Indicator], status: str = DOUBTFUL) -> str:
    """Write the worst indicators of a status in a line, each with value and limit; "" if there is
    none."""
    worst = [indicator for indicator in indicators if indicator.status == status]
    worst.sort(key=lambda indicator: indicator.excess, reverse=True)
    text = "; ".join(map(str, worst[:_SHOWN]))
    if len(worst) > _SHOWN:
        text += f"; {len(worst) - _SHOWN} more in the summary"
    return text


def words(indicators: Sequence[Indicator]) -> str:
    """Write "ok", or "doubtful: ..." or "noted: ..." with the worst indicators."""
    worst = status(indicators)
    if worst == OK:
        return worst
    return f"{worst}: {line(indicators, worst)}"


def describe_shot(shot: Shot) -> str:
    """Describe a shot in a few words, for the progress of a search."""
    words = f"{shot.outcome} at {shot.strike_velocity:.1f} m/s"
    if status(shot.checks) == DOUBTFUL:
        words += ", doubtful"
    return words


def judge_bracket(limit: Limit) -> str:
    """Write "ok", or the doubtful shots at the ends of the bracket and of the zone of mixed
    outcomes."""
    doubtful = []
    for shot in limit.ends:
        if status(shot.checks) == DOUBTFUL:
            velocity = f"{shot.strike_velocity:.4g} m/s"
            doubtful.append(f"{shot.outcome} shot at {velocity} ({line(shot.checks)})")
    if not doubtful:
        return OK
    return f"doubtful {' and '.join(doubtful)}"


def report(indicators: Sequence[Indicator]) -> None:
    """Print one line if the run is doubtful, and one if something of it is noted."""
    for level in (NOTED, DOUBTFUL):
        if text := line(indicators, level):
            print(f"checks: {level}: {text}", flush=True)


def section(indicators: Sequence[Indicator]) -> Section:
    """Build the section of a report."""
    sentences = []
    for level in (DOUBTFUL, NOTED):
        if text := line(indicators, level):
            sentences.append(f"{level.capitalize()}: {text}.")
    lead = " ".join(sentences) or "Every indicator is within its limit."
    rows = []
    for indicator in indicators:
        state = indicator.status
        if indicator.note is not None:
            state += f" (noted above {indicator.note:g})"
        rows.append(
            (indicator.name, indicator.number, f"{indicator.limit:g}", state, indicator.meaning)
        )
    columns = ("indicator", "value", "limit", "status", "value is")
    table = Table(columns, tuple(rows), numeric=columns[1:3])
    return Section("checks", "Quality checks", lead, tables=(table,), folded=True)
