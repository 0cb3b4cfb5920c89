"""Numbers and rows of tables on pages, filled from the data of studies and from the code; `pages.py` writes them.

A mark is a comment, since a forge shows directives and roles as text: a number (`value`), or rows of a
table (`rows`), under a heading that stays as it is written.

    <!-- = panel-plies[panel=203 mm; plies=2] V50 [m/s] : .0f -->206<!-- / -->

    <!-- rows panel-plies[shots=10] | {panel}, {plies} | {V50 [m/s]:.0f} -->
    | panel, plies | V50 [m/s] |
    | --- | ---: |
    | 203 mm, 2 | 206 |
    <!-- / -->
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Callable
from dataclasses import fields
from functools import cache
from math import sqrt
from pathlib import Path
from statistics import fmean, stdev

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

from shellfabric.guards import ENERGY_ERROR_LIMIT  # noqa: E402
from shellfabric.membrane.numerics import Numerics  # noqa: E402
from shellfabric.membrane.quality import CHECKS  # noqa: E402
from shellfabric.plies.numerics import PlyContact  # noqa: E402
from validation.csv_file import DATA, read  # noqa: E402

ASSUMED = {
    place: tomllib.loads((ROOT / place).read_text("utf-8"))
    for place in ("fabrics/data_sheet.toml", "shellfabric/yarns/assumed.toml")
}
# numbers by module and name, {key: number}
CODE = {
    "shellfabric.membrane.quality CHECKS": {name: check.limit for name, check in CHECKS.items()},
    "shellfabric.guards": {"ENERGY_ERROR_LIMIT": ENERGY_ERROR_LIMIT},
    "shellfabric.membrane.numerics Numerics": {
        field.name: field.default for field in fields(Numerics)
    },
    "shellfabric.plies.numerics PlyContact": {"closing_courant": PlyContact().closing_courant},
}
for place, table_of_numbers in ASSUMED.items():
    CODE[place], CODE[f"{place} over the value"] = {}, {}
    for name, numbers in table_of_numbers.items():
        CODE[place] |= {f"{name}, {key}": number for key, number in numbers.items()}
        if isinstance(numbers.get("low"), float):
            CODE[f"{place} over the value"] |= {
                f"{name}, {end}": numbers[end] / numbers["value"] for end in ("low", "high")
            }
VALUE = re.compile(r"(<!-- = (.*?) -->)(.*?)(<!-- / -->)")
ROWS = re.compile(
    r"(<!-- rows (?P<file>[\w/-]+)(?:\[(?P<where>.*?)\])?(?: by (?P<by>[^|\n]+?))?(?P<template> \|[^\n]*) -->\n"
    r"\|[^\n]*\n\|[^\n]*\n)(.*?)(?P<end><!-- / -->)",
    re.DOTALL,
)
OVER_ROWS: dict[str, Callable[[list[float]], float]] = {
    "least": min,
    "most": max,
    "mean": fmean,
    "error": lambda values: stdev(values) / sqrt(len(values)),
    "count": len,
}
CELL = re.compile(
    rf"(?:(?P<over>{'|'.join(OVER_ROWS)}) )?(?P<file>[\w/-]+)(?:\[(?P<where>.*?)\])?(?: (?P<asked>.+?))?"
    r" : (?P<format>\S+)"
)
TERM = re.compile(r"(?:\[(?P<where>.*?)\] )?(?P<column>.+)")
OF_ROW = re.compile(r"\{((?:\[[^{}]*?\] )?[^{}:]+):?([^{}]*)\}")
OF_CODE = re.compile(r"code (?P<name>[^,]+), (?P<key>.+?) : (?P<format>\S+)")


def filled(text: str) -> str:
    """Fill all marks of a page."""
    text = VALUE.sub(lambda mark: mark[1] + value(mark[2]) + mark[4], text)
    return ROWS.sub(lambda mark: mark[1] + rows(mark) + mark["end"], text)


def value(asked: str) -> str:
    """Return the text that a mark asks for.

    What stands in place of a column, in the row in which other columns have the values in brackets:

        first column over second column             the ratio of two
        first column over [plies=8] second column   the second in another row
        range [m/s]#2                               the second part of 107.7 / 167.6

    In brackets one with a * begins and ends as is given about it, 240..248 are the numbers between
    two. `least`, `most`, `mean` or `error` (of the mean) before the file are over several rows,
    `count` is their number. A format that ends with % shows how far a ratio is above 1, in per
    cent; `s` takes a text. `code PLACE, KEY : FORMAT` is a number of the code, one of `CODE`.

    Raises
    ------
    ValueError : no file, column or row of this name, or several rows where one is meant
    """
    found = OF_CODE.fullmatch(asked)
    if found:
        return shown(float(CODE[found["name"]][found["key"]]), found["format"])
    found = CELL.fullmatch(asked)
    if found is None:
        raise ValueError(f"no mark is written like this: {asked}")
    chosen = chosen_rows(found["file"], found["where"] or "")
    if found["over"] == "count":
        return shown(len(chosen), found["format"])
    everything = chosen_rows(found["file"], "")
    texts = [quantity(found["asked"], [row], everything) for row in chosen]
    if not found["over"]:
        if len(texts) != 1 or texts[0] == "":
            raise ValueError(f"{len(texts)} values in {asked!r}")
        return shown(texts[0], found["format"])
    numbers = [float(text) for text in texts if text != ""]
    if not numbers:
        raise ValueError(f"no values in {asked!r}")
    return shown(OVER_ROWS[found["over"]](numbers), found["format"])


def quantity(asked: str, own: list[dict[str, str]], others: list[dict[str, str]]) -> str | float:
    """Return a value, or the ratio of two, empty where one is.

    own : rows that its columns are looked up in
    others : those of a column behind `over` that says its row
    """
    first, over, second = asked.partition(" over ")
    if not over or asked in own[0]:
        return entry(asked, own)
    rows_of_second = own
    if second.startswith("["):
        rows_of_second = others
    parts = entry(first, own), entry(second, rows_of_second)
    if "" in parts:
        return ""
    return float(parts[0]) / float(parts[1])


def entry(term: str, among: list[dict[str, str]]) -> str:
    """Return the value of a column in the one row that is meant.

    Raises
    ------
    ValueError : no column of this name, no row or several
    """
    found = TERM.fullmatch(term)
    meant = [row for row in among if fits(row, found["where"] or "")]
    if len(meant) != 1:
        raise ValueError(f"{len(meant)} rows with {term!r}")
    column, _, part = found["column"].partition("#")
    if column not in meant[0]:
        raise ValueError(f"no column {column!r}, but {', '.join(meant[0])}")
    if not part:
        return meant[0][column]
    return meant[0][column].split(" / ")[int(part) - 1]


def shown(value: str | float, way: str) -> str:
    """Write a value in a format; with % at its end a ratio by how far it is above 1."""
    if way in ("", "s") or value == "":
        return str(value)
    if way.endswith("%"):
        return f"{100 * (float(value) - 1):{way[:-1]}} %"
    if way == "d":
        return f"{int(value):d}"
    return f"{float(value):{way}}"


def rows(mark: re.Match[str]) -> str:
    """Write the rows of a table.

    With `by COLUMN; COLUMN` behind the file one row of the table is made of all rows that are alike
    in these columns; a cell says which of them it means: `{[plies=2] V50 [m/s]:.0f}`.
    """
    groups: dict[object, list[dict[str, str]]] = {}
    columns = [name.strip() for name in (mark["by"] or "").split(";") if name.strip()]
    for number, row in enumerate(chosen_rows(mark["file"], mark["where"] or "")):
        alike: object = number
        if columns:
            alike = tuple(row[name] for name in columns)
        groups.setdefault(alike, []).append(row)
    return "".join(row_of_table(mark["template"], group, columns) for group in groups.values())


def row_of_table(template: str, group: list[dict[str, str]], columns: list[str]) -> str:
    """Write a row of a table from the rows of a file that are alike in some columns."""

    def cell(mark):
        own = group
        if mark[1] in columns:
            own = group[:1]
        return shown(quantity(mark[1], own, group), mark[2])

    return f"{OF_ROW.sub(cell, template).strip()} |\n"


def fits(row: dict[str, str], where: str) -> bool:
    """Say whether columns of a row have given values: "a=1; b=begins with this*".

    Raises
    ------
    ValueError : no column of this name
    """
    for condition in filter(str.strip, where.split(";")):
        column, _, wanted = (part.strip() for part in condition.partition("="))
        if column not in row:
            raise ValueError(f"no column {column!r}, but {', '.join(row)}")
        if not is_meant(row[column], wanted):
            return False
    return True


def is_meant(value: str, wanted: str) -> bool:
    """Say whether a value is the one wanted, begins and ends as it does about a *, or lies between
    two numbers."""
    begin, star, end = wanted.partition("*")
    if star:
        return value.startswith(begin) and value.endswith(end)
    low, dots, high = wanted.partition("..")
    if dots:
        return float(low) <= float(value or "nan") <= float(high)
    return value == wanted


@cache
def table(path: Path) -> list[dict[str, str]]:
    """Read the rows of a file once."""
    return read(path)[1]


def chosen_rows(file: str, where: str) -> list[dict[str, str]]:
    """Read the rows of a file in which columns have given values."""
    path = DATA / f"{file}.csv"
    if not path.is_file():
        raise ValueError(f"no file {file}.csv")
    found = [row for row in table(path) if fits(row, where)]
    if not found:
        raise ValueError(f"no row of {file}.csv with {where}")
    return found


def written() -> list[Path]:
    """List the pages that are written by hand."""
    places = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    places += sorted((ROOT / "validation" / "reports").glob("*.md"))
    return [path for path in places if "generated" not in path.parts]


def pages() -> list[str]:
    """List the pages with marks."""
    mark = re.compile(r"<!-- (= |rows )")
    return [
        str(path.relative_to(ROOT)) for path in written() if mark.search(path.read_text("utf-8"))
    ]
