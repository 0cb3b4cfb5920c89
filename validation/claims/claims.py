"""The claims of the thesis as data: what is claimed, where, the runs it takes, and what would bear it out.

claims.toml has the claims that were listed before anything was computed; additional.toml has those that were added
later, among them earlier, weaker readings of a claim that is now held against what the thesis states. Their keys are
the fields of `Claim`.

`run.NAME` is a run: its kind (a function of `runs`) with what it is made of, and keywords of that function, as
`run.less = { shot = "S-728", velocity = "100 m/s", change = { modulus = 0.8 } }`. With `for`, a list or the name of
one, it is a dict of runs, one an entry, which stands for "{}" in the values. A text that begins with "=" is an
expression.

`expect` has conditions "NAME: EXPRESSION", or "NAME" of what an earlier condition or the function `check` finds, with

    = 0.12 mm +- 0.005 mm, = 255.2 g/m2 +- 3 %   |found - value| <= tolerance, or <= the share of |value|
    > 4.3 %, < 5 us                              in the unit, a unit of UNITS or none
    is S-720, is ['weft', 'warp'], is True       equal: a text, a list in order, or true

An expression is Python over the names of `readers`, the functions of `checks`, the runs, and the values of `let`,
which are evaluated first, in their order. A number with a unit ("60 us") is one in SI.

`each` makes one claim for each entry of its lists of one length: "{fabric}" in any text, and for a text that is nothing
else the value itself. With `fabric` there is "{tag}" for the id: "s720" of "S-720".
"""

from __future__ import annotations

import ast
import json
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from math import isfinite, pi
from typing import Any

from fabrics.errors import InputError

FILES = ("claims.toml", "additional.toml")
KINDS = ("number", "outcome", "ordering", "trend", "shape", "failure-mode", "future")
POWERS = {"mm": -3, "um": -6, "us": -6, "g": -3, "kN": 3, "GPa": 9, "MPa": 6}  # of ten, to SI
UNITS = {unit: float(f"1e{power}") for unit, power in POWERS.items()}
UNITS |= {"": 1.0, "%": 0.01, "mm2": 1e-6, "g/m2": 1e-3, "mm uN^(1/3)": 1e-5, "Pa um3": 1e-18, "deg": pi / 180}
UNITS |= dict.fromkeys(("N", "m/s", "rad", "kg/m3"), 1.0)
_NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
_UNIT = "|".join(map(re.escape, sorted(UNITS, key=len, reverse=True)))
_CONDITION = re.compile(rf"(.+?) ([=<>]) ({_NUMBER}) ?({_UNIT})(?: \+- ({_NUMBER}) ?({_UNIT}))?")
_EQUAL = re.compile(r"(.+) is (.+)")
_QUANTITY = re.compile(rf"(?<![\w'.])({_NUMBER.removeprefix('[-+]?')}) ?({'|'.join((*POWERS, 'deg', 'm/s', 'N'))})\b")


@dataclass(frozen=True)
class Condition:
    """One condition.

    Parameters
    ----------
    name : of the number or text
    expression : that finds it; "" where it has been found
    test : "=", "<", ">" or "is"
    target : number in `unit`, text, list or bool
    within, relative : the tolerance of "=", in `unit` or as a share
    unit : of UNITS
    """

    name: str
    expression: str
    test: str
    target: Any
    within: float | None = None
    relative: float | None = None
    unit: str = ""


@dataclass(frozen=True, order=True)
class Run:
    """A computation: its kind, what it is made of and its keywords as JSON."""

    kind: str
    of: str
    keywords: str = "{}"


@dataclass(frozen=True)
class Claim:
    """One claim: it has conditions; or it is not testable; or what it needs is not built yet.

    Parameters
    ----------
    id : topic, then name
    kind : of KINDS
    source : section, equation, table or figure of the thesis
    basis : "experiment", "thesis-model" or "analytic": what the claim rests on there
    origin : "source", stated there; "ledger", follows from its formulas and tables
    quantity : what is claimed, in words
    run, let : as above
    check, arguments : name of the function that finds numbers, and what it is called with beside the runs
    conditions : all of which have to hold
    reason : of the tolerances
    slow : takes minutes: left out but for --slow
    erratum : entry of docs/reports/errata.md that bears on it, or ""
    against : the conditions are evidence that the thesis is wrong; says what is
    data : they repeat input data, or a closed form on which no code of the product depends; says which
    incomparable : the thesis's statement and the computed quantity are not comparable; says why
    untestable, unbuilt : why there are no conditions; or ""
    cause : of a miss, as far as it has been investigated
    verdict : recorded one of `judge.VERDICTS`, with which the claim has to end; "" of slow ones not run since
    turned : "verdict: why" where it ends with another one now, until the page of claims is computed again
    """

    id: str
    kind: str
    source: str
    basis: str
    origin: str
    quantity: str
    run: dict[str, Any] = field(default_factory=dict)
    let: dict[str, str] = field(default_factory=dict)
    check: str = ""
    arguments: dict[str, Any] = field(default_factory=dict)
    conditions: tuple[Condition, ...] = ()
    reason: str = ""
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

    @property
    def due(self) -> str:
        """The verdict with which it has to end now."""
        return self.turned.partition(":")[0] or self.verdict


@cache
def load() -> tuple[Claim, ...]:
    """All claims, in the order of the files, the additional ones last.

    Raises
    ------
    InputError : a file does not keep to the rules above
    """
    claims = tuple(map(claim_of, (entry for name in FILES for entry in entries(name))))
    if len({claim.id for claim in claims}) < len(claims):
        raise InputError("the ledger has two claims of one name", file=" and ".join(FILES))
    return claims


def entries(name: str) -> list[dict[str, Any]]:
    """The claims of a file of FILES, as dicts; those of a group one by one."""
    return [claim for entry in _content(name)["claim"] for claim in members(entry)]


def topics() -> dict[str, str]:
    """{topic: title}"""
    return _content(FILES[0])["topics"]


@cache
def _content(name):
    return tomllib.loads((resources.files("validation.claims") / name).read_text("utf-8"))


def members(entry: dict[str, Any]) -> list[dict[str, Any]]:
    """The entries of a group, or the entry itself."""
    entry = dict(entry)
    lists = entry.pop("each", None)
    if lists is None:
        return [entry]
    rows = [dict(zip(lists, values)) for values in zip(*lists.values(), strict=True)]
    tags = [{"tag": row["fabric"].replace("S-", "s")} if "fabric" in row else {} for row in rows]
    return [filled(entry, row | tag) for row, tag in zip(rows, tags)]


def filled(value: Any, names: dict[str, Any]) -> Any:
    """A value of a file with "{NAME}" replaced, in all texts of it; a text that is nothing else becomes the value."""
    if isinstance(value, dict):
        return {filled(key, names): filled(part, names) for key, part in value.items()}
    if isinstance(value, list):
        return [filled(part, names) for part in value]
    for name, content in names.items() if isinstance(value, str) else ():
        if value == f"{{{name}}}":
            return content
        value = value.replace(f"{{{name}}}", str(content))
    return value


def select(claims: Sequence[Claim], of: Sequence[str] = (), slow: bool = False) -> tuple[list[Claim], list[Claim]]:
    """(claims to run, claims that are left out for being slow) of the topics; all topics where none is given.

    Raises
    ------
    InputError : an unknown topic
    """
    for topic in set(of) - set(topics()):
        raise InputError(key="--topics", value=topic, allowed=", ".join(topics()))
    chosen = [claim for claim in claims if not of or claim.topic in of]
    return [c for c in chosen if slow or not c.slow], [c for c in chosen if c.slow and not slow]


def claim_of(entry: dict[str, Any]) -> Claim:
    """A claim from its entry in a file, which is no group.

    Raises
    ------
    InputError : it does not keep to the rules above
    """
    entry = dict(entry)
    conditions = tuple(condition_of(entry["id"], text) for text in entry.pop("expect", ()))
    claim = Claim(conditions=conditions, **entry)
    states = [bool(conditions), bool(claim.untestable), bool(claim.unbuilt)]
    marks = [bool(mark) for mark in (claim.against, claim.data, claim.incomparable)]
    rules = {
        f"kind: one of {', '.join(KINDS)}": claim.kind in KINDS,
        f"id: one that begins with a topic: {', '.join(topics())}": claim.topic in topics(),
        "expect: given, or else the reason why it is not": states.count(True) == 1,
        "check: with conditions alone": bool(conditions) or not claim.check,
        "reason: given with conditions: that of their tolerances": bool(claim.reason) or not conditions,
        "against, data, incomparable: at most one, with conditions alone": marks.count(True) <= bool(conditions),
    }
    for rule, kept in rules.items():
        if not kept:
            raise InputError(file=f"ledger, {claim.id}", key=rule.split(": ")[0], allowed=rule.partition(": ")[2])
    return claim


def condition_of(owner: str, text: str) -> Condition:
    """A condition from its text.

    Raises
    ------
    InputError : it is none of those that stand at the top of this module
    """
    number, equal = _CONDITION.fullmatch(text), _EQUAL.fullmatch(text)
    name, _, expression = (number or equal or [text, text])[1].partition(": ")
    expression = in_si(expression)
    if number and (number[2] == "=") == (number[5] is not None) and isfinite(float(number[3])):
        test, value, unit, tolerance, its_unit = number.groups()[1:]
        if tolerance is None:
            return Condition(name, expression, test, float(value), unit=unit)
        if its_unit == unit:
            return Condition(name, expression, test, float(value), float(tolerance), unit=unit)
        if its_unit == "%":
            return Condition(name, expression, test, float(value), relative=0.01 * float(tolerance), unit=unit)
    elif equal:
        try:
            return Condition(name, expression, "is", ast.literal_eval(equal[2]))
        except (SyntaxError, ValueError):
            return Condition(name, expression, "is", equal[2])
    raise InputError(file=f"ledger, {owner}", key="expect", value=text, allowed="such as h: EXPRESSION = 1 mm +- 3 %")


def in_si(text: str) -> str:
    """An expression whose numbers with a unit are numbers in SI, to the last digit."""
    return _QUANTITY.sub(lambda found: repr(_exact(*found.groups())), text)


def _exact(digits, unit):
    plain = unit in POWERS and "e" not in digits.lower()
    return float(f"{digits}e{POWERS[unit]}") if plain else float(digits) * UNITS[unit]


def run_of(spec: dict[str, Any]) -> Run:
    """A run from its entry in a file, whose first key is its kind; texts that are a number with a unit are in SI."""
    (kind, of), *keywords = _plain(spec).items()
    return Run(kind, json.dumps(of), json.dumps(dict(keywords), sort_keys=True))


def _plain(value):
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    quantity = isinstance(value, str) and re.fullmatch(rf"({_NUMBER}) ?({_UNIT})", value)
    return _exact(*quantity.groups()) if quantity else value
