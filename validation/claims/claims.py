"""The claims of the thesis as data: what is claimed, where, and what our number has to be to bear it out.

claims.toml has the claims that were listed before anything was computed; additional.toml has those that were added
later, among them earlier, weaker readings of a claim that is now held against what the thesis states.

A claim is in one of three states. It names a `check`; or it is not testable, with the reason; or what it needs is not
built yet, with where that is planned. A check may be marked in one of three ways, each with its reason: its conditions
are evidence that the thesis is wrong (`against`); they repeat input data or evaluate a closed form on which no code of
the product depends, so that nothing is reproduced (`data`); or what the thesis states is not comparable with what the
check computes (`incomparable`).

A condition holds one number, text or list that the check finds against a target, in the unit it is given in:

    value with within (absolute) or relative   |found - value| <= within, or <= relative |value|
    above, below                               found > above, found < below
    is                                         found == is: a text, a list in order, or true
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from math import isfinite
from typing import Any

from fabrics.errors import InputError
from fabrics.units import si

FILES = ("claims.toml", "additional.toml")
KINDS = ("number", "outcome", "ordering", "trend", "shape", "failure-mode", "future")
TESTS = ("value", "above", "below", "is")
TOPICS = {
    "geom": "Weave geometry",
    "compr": "Transverse compression",
    "yarn": "Single yarns",
    "cell": "The unit cell",
    "shear": "Shear",
    "wave": "Waves",
    "impact1": "Impact on one ply",
    "impactN": "Impact on packs",
    "gap": "Gaps between plies",
    "biaxial": "Biaxial tests on glass",
    "bias": "Bias extension",
    "sens": "Sensitivities",
    "slip": "Slip at the boundary",
    "pencil": "Pencilling",
    "cost": "Cost",
    "failmode": "Ways to fail",
    "future": "Recommendations",
}
# what a unit is converted to; a found number is held against the target in SI and given in the unit
SI = {
    "mm": "m", "um": "m", "mm2": "m^2", "us": "s", "g": "kg", "g/m2": "kg/m^2", "kg/m3": "kg/m^3", "GPa": "Pa",
    "MPa": "Pa", "kPa": "Pa", "deg": "rad", "mm uN^(1/3)": "m * N^(1/3)", "Pa um3": "Pa * m^3", "N": "N", "m/s": "m/s",
    "rad": "rad", "Pa": "Pa", "s": "s", "J": "J", "kN": "N", "J/m2": "J/m^2",
}  # fmt: skip
_SPELLED = {
    "g/m2": "g/m^2", "kg/m3": "kg/m^3", "mm2": "mm^2", "Pa um3": "Pa um^3", "mm uN^(1/3)": "mm * uN**(1/3)",
    "J/m2": "J/m^2",
}  # fmt: skip


@dataclass(frozen=True)
class Condition:
    """One condition on what a check finds.

    Parameters
    ----------
    name : of the number or text among those that the check finds
    test : of TESTS
    target : number in `unit`, text, list or bool
    within, relative : the tolerance of a "value"
    unit : of SI, "%" or "" for none
    """

    name: str
    test: str
    target: object
    within: float | None = None
    relative: float | None = None
    unit: str = ""

    @property
    def factor(self) -> float:
        """SI value of the unit."""
        if self.unit in ("", "%"):
            return 0.01 if self.unit else 1.0
        return si(f"1 {_SPELLED.get(self.unit, self.unit)}", SI[self.unit].replace("^", "**"), key=self.name)


@dataclass(frozen=True)
class Claim:
    """One claim.

    Parameters
    ----------
    id : topic, then name
    kind : of KINDS
    source : section, equation, table or figure of the thesis
    basis : "experiment", "thesis-model" or "analytic": what the claim rests on there
    origin : "source", stated there; "ledger", follows from its formulas and tables
    quantity : what is claimed, in words
    conditions : all of which have to hold
    reason : of the tolerances
    check, arguments : name of the check, and what it is called with
    slow : left out but for --slow
    erratum : entry of docs/reports/errata.md that bears on it, or ""
    against : the conditions are evidence that the thesis is wrong; says what is
    data : the conditions compare input data, or a closed form, with themselves; says which
    incomparable : the thesis's statement and the computed quantity are not comparable; says why
    untestable, unbuilt : why there is no check; or ""
    cause : of a miss, as far as it has been investigated
    verdict : recorded one of `judge.VERDICTS`, with which the check has to end; "" of slow checks not run since
    turned : "verdict: why" where the check ends with another one now, until the page of claims is computed again
    """

    id: str
    kind: str
    source: str
    basis: str
    origin: str
    quantity: str
    conditions: tuple[Condition, ...] = ()
    reason: str = ""
    check: str = ""
    arguments: dict | None = None
    slow: bool = False
    erratum: str = ""
    against: str = ""
    data: str = ""
    incomparable: str = ""
    untestable: str = ""
    unbuilt: str = ""
    cause: str = ""
    verdict: str = ""
    turned: str = ""

    @property
    def topic(self) -> str:
        return self.id.split("-")[0]


@cache
def load() -> tuple[Claim, ...]:
    """All claims, in the order of the files, the additional ones last.

    Raises
    ------
    InputError : a file does not keep to the rules above
    """
    claims = tuple(_claim(entry) for name in FILES for entry in entries(name))
    if len({claim.id for claim in claims}) < len(claims):
        raise InputError("the ledger has two claims of one name", file=" and ".join(FILES))
    return claims


def entries(name: str) -> list[dict[str, Any]]:
    """The claims of a file of FILES, as dicts."""
    return tomllib.loads((resources.files("validation.claims") / name).read_text("utf-8"))["claim"]


def select(claims: Sequence[Claim], topics: Sequence[str] = (), slow: bool = False) -> tuple[list[Claim], list[Claim]]:
    """(claims to run, claims that are left out for being slow) of the topics; all topics where none is given.

    Raises
    ------
    InputError : an unknown topic
    """
    for topic in topics:
        if topic not in TOPICS:
            raise InputError(key="--topic", value=topic, allowed=", ".join(TOPICS))
    chosen = [claim for claim in claims if not topics or claim.topic in topics]
    return [c for c in chosen if slow or not c.slow], [c for c in chosen if c.slow and not slow]


def _claim(entry):
    entry = dict(entry)
    conditions = tuple(_condition(entry["id"], part) for part in entry.pop("expect", ()))
    claim = Claim(conditions=conditions, **entry)
    bad = None
    if claim.kind not in KINDS:
        bad = "kind", claim.kind, ", ".join(KINDS)
    elif claim.topic not in TOPICS:
        bad = "id", claim.id, f"one that begins with a topic: {', '.join(TOPICS)}"
    elif [bool(claim.check), bool(claim.untestable), bool(claim.unbuilt)].count(True) != 1:
        bad = "check", claim.check, "given, or else the reason why there is none"
    elif bool(claim.check) != bool(claim.conditions) or (claim.check and not claim.reason):
        bad = "expect", None, "given with every check, and with the reason of its tolerance"
    elif len([mark for mark in (claim.against, claim.data, claim.incomparable) if mark]) > (1 if claim.check else 0):
        bad = "against, data, incomparable", claim.id, "at most one of them, and only with a check"
    if bad:
        raise InputError(file=f"ledger, {claim.id}", key=bad[0], value=bad[1], allowed=bad[2])
    return claim


def _condition(owner, part):
    part = dict(part)
    tests = [test for test in TESTS if test in part]
    unit = part.get("unit", "")
    if len(tests) != 1 or "name" not in part or unit not in ("", "%", *SI):
        raise InputError(file=f"ledger, {owner}", key="expect", value=part, allowed="a name, one test and a known unit")
    target = part.pop(tests[0])
    if tests[0] == "value" and (("within" in part) == ("relative" in part) or not isfinite(target)):
        raise InputError(file=f"ledger, {owner}", key="value", value=target, allowed="a number, within or relative")
    return Condition(part.pop("name"), tests[0], target, **part)
