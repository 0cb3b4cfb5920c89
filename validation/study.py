"""Studies as data: a file of validation/studies says what is varied and what is read off, `validation.runner` runs it
(entries of a file: `Study`). A case that ends with an error has it in the column "problem".
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import product
from operator import or_
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from fabrics.base.errors import InputError
from validation import cases
from validation.csv_file import Record
from validation.filling import filled, merged

FOLDER = Path(__file__).parent / "studies"
_NUMPY = (
    "abs all any arange array corrcoef degrees diff exp interp isnan log max mean median min nan "
    "polyfit sqrt std sum"
)
NAMES: Record = {name: getattr(np, name) for name in _NUMPY.split()} | {
    "__builtins__": {
        "__import__": __import__
    },  # numpy imports parts of itself when they are first used
    "float": float,
    "len": len,
    "round": round,
    "set": set,
    "str": str,
    "sorted": sorted,
    "zip": zip,
    "rises": lambda values: bool(np.all(np.diff(values) > 0)),
    "falls": lambda values: bool(np.all(np.diff(values) < 0)),
}


@dataclass(frozen=True)
class Row:
    """One case: what stands in the table, the keywords of its run and of its reference, and its quantities."""

    labels: Record
    keywords: Record
    reference: Record | None
    quantities: dict[str, str]


@dataclass(frozen=True)
class Study:
    """A study by its name and the content of its file.

    question    what the study answers
    run         function of validation/cases that computes a case, as "module.function"
    like        another study, whose entries are those that this file does not have
    [base]      keywords of the function; those of a shot are the keys of the input file (`weavecell.setup`). A nose
                to which they give no friction has none, but for `nose_friction = "assumed"` (`validation.cases.noses`)
    [each]      what is varied, in all combinations: lists of values, tables {label: changes of the keywords}, or
                lists of lists under a heading of several keys, "fabric, plies, velocity"
    [[case]]    groups of cases with a `name`, changes `set`, `each` and `quantities` of their own. {key} in a text
                stands for a value of `each`, which is then no keyword itself
    labels      keys of `each` that are no keywords
    [columns]   headings of keys of `each`
    [quantities]  columns: expressions of what the function returns, of `ref` (the same of the reference), of `row`
                (the values of `each`) and of NAMES
    [reference] values of `each`, or changes in their place, of the run that a case is compared with
    [fits]      further rows: {column: expression} of `of(column, {key: value})`, the values of a column
    [cost], [map]   how the cases are judged (`validation.judges`)
    expect      expressions of `of` that must hold
    [golden]    cheap rows by which `validation.stale` sees whether the CSV is still true (`validation.golden`)
    [picture]   columns of the figure in the documentation: x, y, by; and whether they are logarithmic: log = "xy"
    [quick]     keywords changed for a short look, and `most`, the number of cases
    """

    name: str
    content: Record

    def rows(self, quick: bool = False) -> list[Row]:
        """Return all cases, or those of a short look."""
        content = self.content
        base = content.get("base", {})
        most = None
        if quick:
            short = {"most": 2} | content.get("quick", {})
            most = short.pop("most")
            base = merged(base, short)
        rows: list[Row] = []
        for case in content.get("case", [{}]):
            rows += self._rows_of(case, base)
        if most is None:
            return rows
        # errors are those against the exact case, whatever is left out
        exact = content.get("cost", {}).get("exact")
        return rows[:most] + [row for row in rows[most:] if exact in row.labels.values()]

    def row_at(self, chosen: Record) -> Row:
        """Return the case at other values {key of `each`: value}, of a study without [[case]]."""
        return self._row({}, self.content.get("base", {}), self.content["each"], dict(chosen))

    def row_of(self, changes: Record) -> Row:
        """Return the case of [base] with changes."""
        return Row({}, merged(self.content["base"], changes), None, self.content["quantities"])

    def _rows_of(self, case, base):
        varied = self.content.get("each", {}) | case.get("each", {})
        choices = []
        for heading, entries in varied.items():
            names = keys(heading)
            choices.append([dict(zip(names, values(heading, entry))) for entry in entries])
        for places in product(*choices):
            yield self._row(case, base, varied, reduce(or_, places, {}))

    def _row(self, case, base, varied, chosen):
        other = None
        if "reference" in self.content:
            other = self._keywords(case, base, varied, chosen | self.content["reference"])
        shown = {}
        if "name" in case:
            shown["name"] = filled(case["name"], chosen)
        quantities = self.content.get("quantities", {}) | case.get("quantities", {})
        return Row(shown | chosen, self._keywords(case, base, varied, chosen), other, quantities)

    def _keywords(self, case, base, varied, chosen):
        used = set(self.content.get("labels", ()))
        found = filled(merged(base, case.get("set", {})), chosen, used)
        for key, value in chosen.items():
            labelled = varied.get(key)
            if isinstance(value, Mapping):
                found = merged(found, value)
            elif isinstance(labelled, Mapping):
                found = merged(found, filled(labelled[value], chosen))
            elif key not in used:
                for table in reversed(key.split(".")):
                    value = {table: value}
                found = merged(found, value)
        return found


def keys(heading: str) -> list[str]:
    """Return the keys of a heading of `each`."""
    return [key.strip() for key in heading.split(",")]


def values(heading: str, entry: Any) -> Sequence[Any]:
    """Return the values of an entry under a heading."""
    if "," in heading:
        return entry
    return [entry]


def all_names() -> list[str]:
    """List all studies."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load(name: str) -> Study:
    """Load a study by its name.

    Raises
    ------
    InputError : there is none of this name, or a study without a function of validation/cases
    """
    if name not in all_names():
        raise InputError(key="names", value=name, allowed=f"all, or of {', '.join(all_names())}")
    content = tomllib.loads((FOLDER / f"{name}.toml").read_text("utf-8"))
    if "like" in content:
        content = load(content["like"]).content | content
    cases.function(content["run"])
    return Study(name, content)


def evaluated(expression: str, result: Record, reference: Record | None = None) -> Any:
    """Evaluate a quantity of a result."""
    known = NAMES | result
    if reference is not None:
        known["ref"] = SimpleNamespace(**reference)
    # the expressions are those of our own files
    return eval(expression, known)


def record(row: Row, result: Record, reference: Record) -> Record:
    """Make the row of the CSV of a case."""
    problem = result.get("problem") or reference.get("problem")
    if problem:
        return row.labels | dict.fromkeys(row.quantities) | {"problem": problem}
    found = dict(row.labels)
    for name, expression in row.quantities.items():
        found[name] = evaluated(expression, result | {"row": row.labels}, reference)
    return found


def of(records: Sequence[Record]) -> Callable[..., Any]:
    """Return the function of(column, where={}): the values of a column in the rows where others
    have these values; numbers as an array."""

    def values_of(column: str, where: Record | None = None) -> Any:
        found = []
        for one in records:
            if (where or {}).items() <= one.items() and one.get(column) not in (None, ""):
                found.append(one[column])
        if all(isinstance(value, (int, float)) for value in found):
            return np.array(found)
        return found

    return values_of


def unmet(study: Study, records: Sequence[Record]) -> list[str]:
    """List the expectations of a study that its records do not meet."""
    known = NAMES | {"of": of(records)}
    return [
        expression for expression in study.content.get("expect", []) if not eval(expression, known)
    ]
