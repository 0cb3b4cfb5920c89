"""The claims of the thesis as data (entries of a claim: `Claim`): what is claimed, where, the runs it takes, and what
would bear it out. claims.toml has the claims that were listed before anything was computed; additional.toml has those
that were added later, among them earlier, weaker readings of a claim that is now held against what the thesis states.
"""

from __future__ import annotations

import ast
import json
import re
import tomllib
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib import resources
from math import pi
from typing import Any

from fabrics.base.errors import InputError
from validation.filling import filled
from validation.values import Values

FILES = ("claims.toml", "additional.toml")
POWERS = {"mm": -3, "um": -6, "us": -6, "g": -3, "kN": 3, "GPa": 9, "MPa": 6}  # of ten, to SI
UNITS = {unit: float(f"1e{power}") for unit, power in POWERS.items()}
UNITS |= {
    "": 1.0,
    "%": 0.01,
    "mm2": 1e-6,
    "g/m2": 1e-3,
    "mm uN^(1/3)": 1e-5,
    "Pa um3": 1e-18,
    "deg": pi / 180,
}
UNITS |= dict.fromkeys(("N", "m/s", "rad", "kg/m3"), 1.0)
_NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
_UNIT = "|".join(map(re.escape, sorted(UNITS, key=len, reverse=True)))
_CONDITION = re.compile(
    rf"(?P<said>.+) (?:(?P<test>[=<>]) (?P<target>{_NUMBER}) ?(?P<unit>{_UNIT})"
    rf"(?: \+- (?P<tolerance>{_NUMBER}) ?(?P<of>%|(?P=unit)))?|is (?P<equal>.+))"
)
_QUANTITY = re.compile(
    rf"(?<![\w'.])({_NUMBER.removeprefix('[-+]?')}) ?({'|'.join((*POWERS, 'deg', 'm/s', 'N'))})\b"
)


@dataclass(frozen=True)
class Condition:
    """One condition.

    Parameters
    ----------
    name : of the number or text
    expression : that finds it; "" where it has been found
    test : "=", "<", ">" or "is"
    target : number in `unit`, text, list or bool
    unit : of UNITS
    tolerance, relative : of "=", in `unit` or, where relative, as a share
    """

    name: str
    expression: str
    test: str
    target: Any
    unit: str = ""
    tolerance: float = 0.0
    relative: bool = False


@dataclass(frozen=True, order=True)
class Run:
    """A computation: its kind, what it is made of and its keywords as JSON."""

    kind: str
    of: str
    keywords: str = "{}"


@dataclass(frozen=True)
class Claim:
    """One claim: it has conditions; or it is not testable; or what it needs is not built yet.

    `run.NAME` is a run: its kind (a function of `runs`) with what it is made of, and keywords of
    that function, as `run.less = { shot = "S-728", velocity = "100 m/s", change = { modulus = 0.8 }
    }`. With `for`, a list or the name of one, it is a dict of runs, one an entry, which stands for
    "{}" in the values. A text that begins with "=" is an expression.

    `expect` has conditions "NAME: EXPRESSION", or "NAME" of what an earlier one has found, with

        = 0.12 mm +- 0.005 mm, = 255.2 g/m2 +- 3 %   |found - value| <= tolerance, or its share of |value|
        > 4.3 %, < 5 us                              in the unit, a unit of UNITS or none
        is S-720, is ['weft', 'warp'], is True       equal: a text, a list in order, or true

    `reading.NAME` are further conditions, of one reading of a sentence that leaves something open,
    which `undecided` names (a window, a level, a length). All readings are judged. Where they
    differ the claim is open.

    An expression is Python over the names of `readers`, the functions of `checks`, the runs, and
    the values of `let`, which are evaluated first, in their order. A number with a unit ("60 us")
    is one in SI. `each` makes one claim for each entry of its lists of one length: "{fabric}" in
    any text, and for a text that is nothing else the value itself. With `fabric` there is "{tag}"
    for the id: "s720" of "S-720".

    Parameters
    ----------
    id : topic, then name
    kind : "number", "outcome", "ordering", "trend", "shape", "failure-mode" or "future"
    source : section, equation, table or figure of the thesis
    basis : "experiment", "thesis-model" or "analytic": what the claim rests on there
    origin : "source", stated there; "ledger", follows from its formulas and tables
    quantity : what is claimed, in words
    run, let, expect : as above; all conditions have to hold
    reading : {name: conditions} of each reading, on top of `expect`
    undecided : what the text leaves open between the readings
    double : id of the claim that makes the same statement on the same numbers, and is counted
    reason : of the tolerances
    slow : takes minutes: left out but for --slow
    erratum : entry of validation/reports/errata.md that bears on it, or ""
    against : the conditions are evidence that the thesis is wrong; says what is
    data : they repeat input data, or a closed form on which no code of the product depends; says which
    incomparable : the thesis's statement and the computed quantity are not comparable; says why
    untestable, unbuilt : why there are no conditions; or ""
    cause : of a miss, as far as it has been investigated
    because : which of `judge.CAUSES` that is
    verdict : recorded one of `judge.VERDICTS`, with which the claim has to end
    factors : {input: factor} that change it, of `changed_fabrics` and "velocity" of its runs; of no claim as
        it stands (`turns`)
    """

    id: str
    kind: str
    source: str
    basis: str
    origin: str
    quantity: str
    run: Values = field(default_factory=dict)
    let: dict[str, str] = field(default_factory=dict)
    expect: tuple[str, ...] = ()
    reading: dict[str, tuple[str, ...]] = field(default_factory=dict)
    undecided: str = ""
    double: str = ""
    reason: str = ""
    slow: bool = False
    erratum: str = ""
    against: str = ""
    data: str = ""
    incomparable: str = ""
    untestable: str = ""
    unbuilt: str = ""
    cause: str = ""
    because: str = ""
    verdict: str = ""
    factors: Values = field(default_factory=dict)

    @cached_property
    def conditions(self) -> tuple[Condition, ...]:
        """Those of `expect`, then those of all readings."""
        return (*self.common, *(c for of in self.readings.values() for c in of))

    @cached_property
    def common(self) -> tuple[Condition, ...]:
        """Those of `expect`."""
        return tuple(map(condition_of, self.expect))

    @cached_property
    def readings(self) -> dict[str, tuple[Condition, ...]]:
        """{name: conditions} of each reading."""
        return {name: tuple(map(condition_of, of)) for name, of in self.reading.items()}

    @property
    def topic(self) -> str:
        return self.id.split("-")[0]


@cache
def load() -> tuple[Claim, ...]:
    """Read all claims, in the order of the files, the additional ones last."""
    return tuple(Claim(**entry) for name in FILES for entry in entries(name))


def entries(name: str) -> list[Values]:
    """Read the claims of a file of FILES, as dicts; those of a group one by one."""
    return [claim for entry in _content(name)["claim"] for claim in members(entry)]


def topics() -> dict[str, str]:
    """Return the topics {topic: title}."""
    return _content(FILES[0])["topics"]


@cache
def _content(name):
    return tomllib.loads((resources.files("validation.claims") / name).read_text("utf-8"))


def members(entry: Values) -> list[Values]:
    """Return the entries of a group, or the entry itself."""
    if "each" not in entry:
        return [entry]
    rest = {key: value for key, value in entry.items() if key != "each"}
    claims = []
    for values in zip(*entry["each"].values(), strict=True):
        row = dict(zip(entry["each"], values))
        tag = str(row.get("fabric")).replace("S-", "s")
        claims.append(filled(rest, row | {"tag": tag}, shown=str))
    return claims


def condition_of(text: str) -> Condition:
    """Read a condition from its text.

    Raises
    ------
    InputError : it is none of those that stand at the top of this module
    """
    found = _CONDITION.fullmatch(text)
    if found is None or (found["test"] == "=") != (found["of"] is not None):
        raise InputError(
            file="ledger", key="expect", value=text, allowed="such as h: EXPRESSION = 1 mm +- 3 %"
        )
    name, _, expression = found["said"].partition(": ")
    expression = in_si(expression)
    equal = found["equal"]
    if equal:
        if equal.startswith("[") or equal in ("True", "False"):
            equal = ast.literal_eval(equal)
        return Condition(name, expression, "is", equal)
    tolerance = float(found["tolerance"] or 0)
    relative = found["of"] == "%" != found["unit"]
    if relative:
        tolerance *= 0.01
    return Condition(
        name, expression, found["test"], float(found["target"]), found["unit"], tolerance, relative
    )


def in_si(text: str) -> str:
    """Convert the numbers with a unit in an expression to numbers in SI, to the last digit."""
    return _QUANTITY.sub(lambda found: repr(_exact(*found.groups())), text)


def _exact(digits, unit):
    plain = unit in POWERS and "e" not in digits.lower()
    if plain:
        return float(f"{digits}e{POWERS[unit]}")
    return float(digits) * UNITS[unit]


def run_of(spec: Values, names: Values) -> Run:
    """Read a run from its entry in a file, whose first key is its kind; a text of it is in SI if it
    is a number with a unit, and evaluated with these names if it begins with "="."""
    (kind, of), *keywords = _evaluated(spec, names).items()
    return Run(kind, json.dumps(of), json.dumps(dict(keywords), sort_keys=True))


def _evaluated(value, names):
    if isinstance(value, dict):
        return {key: _evaluated(part, names) for key, part in value.items()}
    if isinstance(value, str) and (value.startswith("=") or _QUANTITY.fullmatch(value)):
        return eval(in_si(value.removeprefix("=").strip()), names)
    return value
