"""Holds what was found against the conditions of a claim, and says by how much it misses."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from validation.claims.claims import UNITS, Claim, Condition
from validation.values import Values

REPRODUCED = "reproduced"
MISSED = "missed"
OPEN = "open"
DOUBLE = "double"
WRONG = "source is wrong"
DATA = "data"
NOT_COMPARABLE = "not comparable"
NOT_TESTABLE = "not testable"
NOT_BUILT = "not built"
LEFT_OUT = "left out"
BROKEN = "broken"
VERDICTS = {
    REPRODUCED: "within the tolerance",
    MISSED: "outside the tolerance",
    OPEN: "the text does not say which of several readings, and they differ: in no percentage",
    WRONG: "the computed value shows an error of the thesis",
    DATA: "compares input data or a closed form with itself, or says that a run ends: in no percentage",
    DOUBLE: "the same statement on the same numbers as another claim, which is counted",
    NOT_COMPARABLE: "statement and computed value are listed side by side",
    NOT_BUILT: "what it needs is not built yet",
    NOT_TESTABLE: "no number to compare with, or one that no model here gives",
    LEFT_OUT: "a slow one that was not selected",
    BROKEN: "its expressions or its function did not come to an end",
}
CAUSES = {
    "physics": "the model behaves otherwise, with the inputs and the words of the thesis",
    "reading": "how much the words of the thesis mean is a bound of the ledger",
    "set-up": "an input that the thesis does not print, or a choice of its run or of ours",
    "fault": "an error of the code that is known and stands",
}


@dataclass(frozen=True)
class Record:
    """What became of one claim.

    Parameters
    ----------
    id : of the claim
    verdict : of VERDICTS
    found : {name of a condition: number in SI, text, list or bool}
    miss : the conditions that do not hold, in words
    note : what went wrong, or why nothing was computed
    variants : {name: verdict} of `runner.VARIANTS` in which the claim was judged too
    """

    id: str
    verdict: str
    found: Values = field(default_factory=dict)
    miss: str = ""
    note: str = ""
    variants: dict[str, str] = field(default_factory=dict)


def judge(claim: Claim, found: Values) -> Record:
    """Judge a claim of which {name: value} were found, and return its record; numbers are in SI."""
    found = {name: plain(value) for name, value in found.items()}
    missed = _missed(claim.common, found)
    readings = {name: _missed(conditions, found) for name, conditions in claim.readings.items()}
    turned = [name for name, of in readings.items() if of]
    verdict = REPRODUCED
    if claim.incomparable:
        verdict = NOT_COMPARABLE
    elif claim.double:
        verdict = DOUBLE
    elif not missed and 0 < len(turned) < len(readings):
        verdict = OPEN
        missed = [f"{name}: {line}" for name in turned for line in readings[name]]
    elif missed or turned:
        missed += [line for name in turned for line in readings[name]]
        verdict = MISSED
    elif claim.against:
        verdict = WRONG
    elif claim.data:
        verdict = DATA
    return Record(claim.id, verdict, found, "; ".join(missed))


def _missed(conditions, found):
    """The conditions that do not hold, in words."""
    missed = []
    for condition in conditions:
        value = found.get(condition.name)
        if not holds(condition, value):
            missed.append(f"{computed(condition, value)}, expected {expected(condition)}")
    return missed


def changed(claim: Claim, verdict: str) -> bool:
    """Tell whether a claim has ended with another verdict than it has to; one left out, or that
    lacks a package, has not."""
    if not claim.conditions or verdict in (LEFT_OUT, NOT_TESTABLE):
        return False
    return verdict != claim.verdict


def plain(value: Any) -> Any:
    """Convert a value to what JSON can hold."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(part) for part in value]
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    return value


def expected(condition: Condition) -> str:
    """Write a condition in words: "0.12 ± 0.005 mm"."""
    if condition.test == "is":
        return _words(condition.target)
    target = f"{condition.target:g}"
    if condition.test != "=":
        return f"{condition.test} {target}{_suffix(condition)}"
    if condition.relative:
        return f"{target}{_suffix(condition)} ± {100 * condition.tolerance:g} %"
    return f"{target} ± {condition.tolerance:g}{_suffix(condition)}"


def computed(condition: Condition, value: Any) -> str:
    """Write what was found for a condition, in words: "h01 0.1203 mm"."""
    if isinstance(value, float):
        value = f"{value / UNITS[condition.unit]:.4g}{_suffix(condition)}"
    return f"{condition.name} {_words(value)}"


def _suffix(condition):
    return f" {condition.unit}".rstrip()


def _words(value):
    if isinstance(value, list):
        return ", ".join(map(_words, value))
    if value is True:
        return "yes"
    if value is False:
        return "no"
    if value is None:
        return "none"
    return str(value)


def holds(condition: Condition, value: Any) -> bool:
    """Tell whether a condition holds of what was found for it."""
    if condition.test == "is":
        return value == condition.target
    if not isinstance(value, float) or not np.isfinite(value):
        return False
    off = value / UNITS[condition.unit] - condition.target
    if condition.test == "<":
        return off < 0
    if condition.test == ">":
        return off > 0
    allowed = condition.tolerance
    if condition.relative:
        allowed *= abs(condition.target)
    return abs(off) <= allowed * (1 + 1e-12)
