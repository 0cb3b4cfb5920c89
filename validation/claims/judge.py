"""Holds what a check has found against the conditions of its claim, and says by how much it misses."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from validation.claims.claims import Claim, Condition
    from validation.claims.registry import Found

REPRODUCED, MISSED, WRONG = "reproduced", "missed", "source is wrong"
DATA, NOT_COMPARABLE = "data", "not comparable"
NOT_TESTABLE, NOT_BUILT, LEFT_OUT, BROKEN = "not testable", "not built", "left out", "broken"
VERDICTS = {
    REPRODUCED: "the computed value is within the tolerance",
    MISSED: "the computed value is outside the tolerance",
    WRONG: "the computed value shows an error of the thesis",
    DATA: "input data or a closed form compared with itself: nothing is reproduced, and it is in no percentage",
    NOT_COMPARABLE: "the statement and the computed value are not comparable: both are listed",
    NOT_BUILT: "what the check would need is not built yet",
    NOT_TESTABLE: "no number to compare with, or a number that no model here gives",
    LEFT_OUT: "a slow check that was not selected",
    BROKEN: "the check itself did not come to an end",
}


@dataclass(frozen=True)
class Record:
    """What became of one claim.

    Parameters
    ----------
    id : of the claim
    verdict : of VERDICTS
    found : {name: number in SI, text or list} that the check found
    text : one line: what was found against what was expected
    miss : by how much, "" where nothing was missed
    note : remark of the check
    seconds : of the check, without the runs it shares
    setting : projectile body, cell formulation, denier and mesh of its shots, in words; "" if it rests on none
    variants : {name: verdict} of `variants.VARIANTS` in which the claim was checked too
    """

    id: str
    verdict: str
    found: dict = field(default_factory=dict)
    text: str = ""
    miss: str = ""
    note: str = ""
    seconds: float = 0.0
    setting: str = ""
    variants: dict = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


def judge(claim: Claim, found: Found, note: str = "", seconds: float = 0.0) -> Record:
    """Record of a claim whose check has found {name: value}; numbers are in SI."""
    found = {name: plain(value) for name, value in found.items()}
    misses = [text for text in (_miss(condition, found) for condition in claim.conditions) if text]
    verdict = NOT_COMPARABLE if claim.incomparable else MISSED if misses else _unmissed(claim)
    text = "; ".join(_as_text(condition, found) for condition in claim.conditions)
    return Record(claim.id, verdict, found, text, "; ".join(misses), note, seconds)


def _unmissed(claim):
    """Verdict of a claim whose conditions all hold."""
    return WRONG if claim.against else DATA if claim.data else REPRODUCED


def unchecked(claim: Claim) -> Record:
    """Record of a claim that has no check."""
    if claim.unbuilt:
        return Record(claim.id, NOT_BUILT, note=claim.unbuilt)
    return Record(claim.id, NOT_TESTABLE, note=claim.untestable)


def plain(value: Any) -> Any:
    """A value as JSON can hold it."""
    if isinstance(value, dict):
        return {name: plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(part) for part in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, float, np.number)):
        return float(value)
    return value


def expected(condition: Condition) -> str:
    """A condition in words: "0.12 ± 0.005 mm"."""
    unit = f" {condition.unit}" if condition.unit else ""
    if condition.test == "is":
        return _words(condition.target)
    if condition.test != "value":
        return f"{'>' if condition.test == 'above' else '<'} {condition.target:g}{unit}"
    if condition.relative is not None:
        return f"{condition.target:g}{unit} ± {100 * condition.relative:g} %"
    return f"{condition.target:g} ± {condition.within:g}{unit}"


def computed(condition: Condition, found: Found) -> str:
    """What a check found for a condition, in words: "h01 0.1203 mm"."""
    return f"{condition.name} {_shown(condition, found.get(condition.name))}"


def _as_text(condition, found):
    return f"{computed(condition, found)} ({expected(condition)})"


def _shown(condition, value):
    if not isinstance(value, float):
        return _words(value)
    return f"{value / condition.factor:.4g}{' ' + condition.unit if condition.unit else ''}"


def _words(value):
    if isinstance(value, (list, tuple)):
        return ", ".join(map(_words, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else str(value)


def _miss(condition, found):
    """By how much a condition is missed, in words; "" if it holds."""
    value, name, unit = found.get(condition.name), condition.name, condition.unit
    if condition.test == "is":
        return "" if value == condition.target else f"{name} {_words(value)} instead of {_words(condition.target)}"
    if not isinstance(value, float) or not np.isfinite(value):
        return f"{name} has no value"
    value /= condition.factor
    off = value - condition.target
    unit = f" {unit}" if unit else ""
    if condition.test == "value":
        allowed = condition.within if condition.within is not None else condition.relative * abs(condition.target)
        if abs(off) <= allowed * (1 + 1e-12):
            return ""
        share = f" ({100 * off / condition.target:+.3g} %)" if condition.target else ""
        return f"{name} off by {off:+.3g}{unit}{share}, {allowed:.3g} allowed"
    if (off > 0) == (condition.test == "above") and off != 0:
        return ""
    return f"{name} {value:.4g}{unit}, target {expected(condition)}"
