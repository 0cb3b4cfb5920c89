"""Golden rows, computed again and compared with the CSV.

The CSV has five digits. A number agrees if it differs from the kept one by no more than these leave open, and the
tolerance of the study. Words have to be the same, and so have numbers in a sentence.
"""

from __future__ import annotations

import re
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import floor, isnan, log10
from typing import Any

import numpy as np

from fabrics.base.errors import InputError, WeavecellError
from validation import csv_file, golden, judges, runner, study
from validation.cases import impact
from validation.golden import Golden
from validation.study import NAMES, Row, Study
from validation.values import Values

DIGITS = 5  # of a number in a CSV, of `csv_file.text`
BEYOND = 0.1  # of the width of a bracket, by which the two shots lie outside of it
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?")


@dataclass(frozen=True)
class Cell:
    """A value of a golden row: the row and the column, the text in the CSV, and what it is today."""

    row: str
    column: str
    kept: str
    now: Any


@dataclass(frozen=True)
class Outcome:
    """What the golden rows of a study come to: all that were compared, those that have moved, CPU time [s]."""

    cells: list[Cell]
    moves: list[Cell]
    seconds: float


def compare(chosen: Study, records: Sequence[dict[str, str]]) -> Outcome:
    """Compute the golden rows of a study, and compare them with the rows (texts by heading) of its CSV.

    Raises
    ------
    InputError : of `golden.rows` and `golden.kept_row`
    """
    began = time.process_time()
    cells = []
    for row in golden.rows(chosen):
        cells += computed(chosen, row, golden.kept_row(chosen, row, records))
    rules = golden.table(chosen)
    moves = [cell for cell in cells if not agrees(cell.kept, cell, rules)]
    return Outcome(cells, moves, time.process_time() - began)


def computed(chosen: Study, row: Row, kept: dict[str, str]) -> list[Cell]:
    """Compute a golden row: the values that are compared."""
    rules = golden.table(chosen)
    name = golden.name(row)
    keywords = {key: value for key, value in row.keywords.items() if key not in rules.without}
    if rules.bracket:
        low, high = eval(rules.bracket, NAMES | {"kept": numbers(kept)})
        return [beside(chosen.content["run"], name, keywords, low, high)]
    asked = set(rules.columns or row.quantities) - set(rules.clock)
    quantities = {key: row.quantities[key] for key in row.quantities if key in asked}
    row = replace(row, keywords=keywords, quantities=quantities)
    result = runner.solve(chosen.content["run"], row.keywords)
    reference: Values = {}
    if row.reference is not None and any("ref." in text for text in quantities.values()):
        reference = runner.solve(chosen.content["run"], row.reference)
    found = study.record(row, result, reference)
    if "map" in chosen.content:
        found["outcome"] = judges.outcome_of_point(chosen, found, result, reference)
    cells = []
    for key in found.keys() - row.labels.keys():
        heading = golden.heading(chosen, key)
        cells.append(Cell(name, heading, kept.get(heading) or "", found[key]))
    return sorted(cells, key=lambda cell: cell.column)


def numbers(kept: dict[str, str]) -> dict[str, Any]:
    """Read the texts of a kept row: a number, a list of numbers, or the text."""
    found: dict[str, Any] = {}
    for key, text in kept.items():
        found[key] = text
        with suppress(ValueError, AttributeError):
            values = [float(part) for part in text.split(" / ")]
            found[key] = values
            if len(values) == 1:
                found[key] = values[0]
    return found


def beside(run: str, row: str, keywords: Values, low: float, high: float) -> Cell:
    """Fire two shots just outside of a kept bracket [m/s], of which one has to stop or to leave all yarns whole.

    Raises
    ------
    InputError : a function of validation/cases that has no bracket
    """
    if run not in ("impact.limit", "impact.first_failure"):
        raise InputError(key="golden.bracket", value=run, allowed="of a search for a limit")
    spare = BEYOND * (high - low)
    ends = (low - spare, high + spare)
    column = f"at {ends[0]:.5g}, {ends[1]:.5g} m/s"
    found: list[bool] | str = [False, True]
    try:
        if run == "impact.limit":
            found = impact.perforated(ends, **keywords)
        else:
            # a share above that of the ends asks for no bisection
            keywords = keywords | {"low": ends[0], "high": ends[1], "share": ends[1] / ends[0]}
            impact.first_failure(**keywords)
    except WeavecellError as problem:
        found = str(problem)
    return Cell(row, column, csv_file.text([False, True]), found)


def agrees(kept: str, cell: Cell, rules: Golden) -> bool:
    """Say whether a value of today is a kept text, whose numbers have five digits, within the tolerance of a study."""
    now = exact(cell.now)
    before = NUMBER.findall(kept)
    after = NUMBER.findall(now)
    if NUMBER.split(kept) != NUMBER.split(now) or len(before) != len(after):
        return False
    absolute = rules.absolute.get(cell.column, 0.0)
    for old, new in zip(map(float, before), map(float, after)):
        rounding = 0.0
        if old:
            rounding = 0.5 * 10.0 ** (floor(log10(abs(old))) + 1 - DIGITS)
        # a number that lies between two texts may fall to either side
        if abs(new - old) > (1 + 1e-6) * rounding + rules.tolerance * abs(old) + absolute:
            return False
    return True


def exact(value: Any) -> str:
    """Write a value as `csv_file.text` does, with all its digits."""
    if isinstance(value, (float, np.floating)) and not isnan(value):
        return repr(float(value))
    if isinstance(value, (list, tuple, np.ndarray)):
        return " / ".join(map(exact, value))
    return csv_file.text(value)
