"""Holds what was found against the conditions of a claim, and says by how much it misses."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from validation.claims.claims import UNITS, Claim, Condition

Found: TypeAlias = dict[str, Any]  # {name: number in SI, text, list or bool}
REPRODUCED, MISSED, WRONG = "reproduced", "missed", "source is wrong"
DATA, NOT_COMPARABLE = "data", "not comparable"
NOT_TESTABLE, NOT_BUILT, LEFT_OUT, BROKEN = "not testable", "not built", "left out", "broken"
VERDICTS = {
    REPRODUCED: "within the tolerance",
    MISSED: "outside the tolerance",
    WRONG: "the computed value shows an error of the thesis",
    DATA: "compares input data or a closed form with itself: in no percentage",
    NOT_COMPARABLE: "statement and computed value are listed side by side",
    NOT_BUILT: "what it needs is not built yet",
    NOT_TESTABLE: "no number to compare with, or one that no model here gives",
    LEFT_OUT: "a slow one that was not selected",
    BROKEN: "its expressions or its function did not come to an end",
}


@dataclass(frozen=True)
class Record:
    """What became of one claim.

    Parameters
    ----------
    id : of the claim
    verdict : of VERDICTS
    found : by the names of the conditions
    miss : by how much, "" where nothing was missed
    note : what went wrong, or why nothing was computed
    variants : {name: verdict} of `runner.VARIANTS` in which the claim was judged too
    """

    id: str
    verdict: str
    found: Found = field(default_factory=dict)
    miss: str = ""
    note: str = ""
    variants: dict[str, str] = field(default_factory=dict)


def judge(claim: Claim, found: Found) -> Record:
    """Record of a claim of which {name: value} were found; numbers are in SI."""
    found = {name: plain(value) for name, value in found.items()}
    miss = "; ".join(filter(None, (_miss(condition, found.get(condition.name)) for condition in claim.conditions)))
    met = WRONG if claim.against else DATA if claim.data else REPRODUCED
    return Record(claim.id, NOT_COMPARABLE if claim.incomparable else MISSED if miss else met, found, miss)


def unchecked(claim: Claim) -> Record:
    """Record of a claim that has no conditions."""
    return Record(claim.id, NOT_BUILT if claim.unbuilt else NOT_TESTABLE, note=claim.unbuilt or claim.untestable)


def changed(claim: Claim, verdict: str) -> bool:
    """Whether a claim has ended with another verdict than it has to; one left out, or that lacks a package, has not."""
    if not claim.conditions or verdict in (LEFT_OUT, NOT_TESTABLE):
        return False
    return verdict == BROKEN or verdict != (claim.due or verdict)


def plain(value: Any) -> Any:
    """A value as JSON can hold it."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(part) for part in value]
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def expected(condition: Condition) -> str:
    """A condition in words: "0.12 ± 0.005 mm"."""
    unit = f" {condition.unit}" if condition.unit else ""
    if condition.test == "is":
        return _words(condition.target)
    if condition.test != "=":
        return f"{condition.test} {condition.target:g}{unit}"
    if condition.relative is not None:
        return f"{condition.target:g}{unit} ± {100 * condition.relative:g} %"
    return f"{condition.target:g} ± {condition.within:g}{unit}"


def computed(condition: Condition, value: Any) -> str:
    """What was found for a condition, in words: "h01 0.1203 mm"."""
    if isinstance(value, float):
        value = f"{value / UNITS[condition.unit]:.4g}{' ' + condition.unit if condition.unit else ''}"
    return f"{condition.name} {_words(value)}"


def _words(value):
    if isinstance(value, list):
        return ", ".join(map(_words, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else str(value)


def _miss(condition, value):
    """By how much a condition is missed, in words; "" if it holds."""
    name, target = condition.name, condition.target
    if condition.test == "is":
        return "" if value == target else f"{name} {_words(value)} instead of {_words(target)}"
    if not isinstance(value, float) or not np.isfinite(value):
        return f"{name} has no value"
    off = value / UNITS[condition.unit] - target
    if condition.test == "=":
        allowed = condition.within if condition.within is not None else condition.relative * abs(target)
        share = f" ({100 * off / target:+.3g} %)" if target else ""
        kept = abs(off) <= allowed * (1 + 1e-12)
        return "" if kept else f"{name} off by {off:+.3g} {condition.unit}{share}, {allowed:.3g} allowed"
    return (
        ""
        if (off > 0 if condition.test == ">" else off < 0)
        else f"{computed(condition, value)}, target {expected(condition)}"
    )
