"""CSV files of studies: records are written as texts, and read again."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from functools import reduce
from math import isnan
from operator import or_
from pathlib import Path
from typing import Any

import numpy as np

from fabrics.base.files import write_whole

DATA = Path(__file__).parents[1] / "docs" / "reports" / "data"
Record = dict[str, Any]  # {column: value} of a row of the CSV


def text(value: Any) -> str:
    """Write a value as it stands in the CSV: numbers with five digits, sequences with strokes
    between."""
    if value is None or (isinstance(value, float) and isnan(value)):
        return ""
    if isinstance(value, (bool, np.bool_)):
        if value:
            return "yes"
        return "no"
    if isinstance(value, (float, np.floating)):
        return f"{value:.5g}"
    if isinstance(value, (list, tuple, np.ndarray)):
        return " / ".join(map(text, value))
    return str(value)


def texts(
    records: Sequence[Record], headings: Mapping[str, str] | None = None
) -> list[dict[str, str]]:
    """Return records as the rows {heading: text} of their CSV, each with all columns."""
    columns: Record = reduce(or_, records, {})
    shown = dict(zip(columns, columns)) | dict(headings or {})
    return [{shown[key]: text(one.get(key)) for key in columns} for one in records]


def write(
    path: Path, records: Sequence[Record], made: str = "", headings: Mapping[str, str] | None = None
) -> None:
    """Write records as CSV; `made`, if given, says how in a first line, and `headings` are those of columns."""
    rows = texts(records, headings)
    with write_whole(path) as file:
        if made:
            file.write(f"# {made}\n")
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read(path: Path) -> tuple[str, list[dict[str, str]]]:
    """Read a CSV of `write`: (how it was made, rows)."""
    with open(path, encoding="utf-8", newline="") as file:
        made = file.readline().removeprefix("#").strip()
        return made, list(csv.DictReader(file))
