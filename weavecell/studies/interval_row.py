"""The row that an answer over what nobody knows has in a table of several."""

from __future__ import annotations

from typing import Any

from fabrics.base.counted import counted
from shellfabric.membrane.indicator import OK
from weavecell.studies import interval, sweep
from weavecell.studies.ballistic_limit import count_widened
from weavecell.studies.interval import Interval

ALIKE = "alike wherever it strikes"  # limits


def make_row(found: Interval) -> dict[str, Any]:
    """Return the row of an answer over what nobody knows: outcome, lowest and highest value, and what
    decides."""
    ends = sweep.QUANTITIES[found.quantity].over_unknown.ends
    assert ends is not None
    runs = len(found.runs)
    checks = OK
    if found.doubtful:
        checks = f"doubtful: {found.doubtful} of {counted(runs, 'run')}"
    again = {}
    if widened := count_widened([run.row.get("widened", "") for run in found.runs], "run"):
        again["widened"] = widened
    return {
        "outcome": _outcome_of_interval(found),
        **dict(zip(ends, (found.low, found.high))),
        "decides": ", ".join(found.decides),
        "runs": runs,
        "checks": checks,
        **again,
    }


def _outcome_of_interval(found):
    """Outcome of all shots, or that of limits, which is the same of one ply that has a limit."""
    if found.quantity == interval.SHOT or found.low is None:
        return found.outcome or found.runs[0].outcome
    if found.agrees:
        return ALIKE
    return interval.DEPENDS
