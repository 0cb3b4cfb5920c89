"""Numbers and rows of tables on pages, filled from the data of studies and from the code; `pages.py` writes them.

A mark is a comment, since a forge shows directives and roles as text. A number:

    <!-- = panel-plies[panel=203 mm; plies=2] V50 [m/s] : .0f -->206<!-- / -->

is the value of a column in the row of a file of docs/reports/data in which other columns have these values. `a over b`
in place of a column is the ratio of two, `least` or `most` before the file is taken over several rows, and a format
that ends with % shows how far a ratio is above 1, in per cent. `code MODULE NAME KEY : FORMAT` is a number of the
code, one of `CODE`. Rows of a table, under a heading that stays as it is written:

    <!-- rows panel-plies[shots=10] | {panel}, {plies} | {V50 [m/s]:.0f} -->
    | panel, plies | V50 [m/s] |
    | --- | ---: |
    | 203 mm, 2 | 206 |
    <!-- / -->
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

from shellfabric.membrane.quality import CHECKS  # noqa: E402
from validation.study import DATA, read  # noqa: E402

CODE = {
    "shellfabric.membrane.quality CHECKS": {name: check.limit for name, check in CHECKS.items()}
}
VALUE = re.compile(r"(<!-- = (.*?) -->)(.*?)(<!-- / -->)")
ROWS = re.compile(
    r"(<!-- rows ([\w/-]+)(?:\[(.*?)\])?((?: \|[^\n]*)) -->\n\|[^\n]*\n\|[^\n]*\n)(.*?)(<!-- / -->)",
    re.DOTALL,
)
CELL = re.compile(
    r"(?:(?P<end>least|most) )?(?P<file>[\w/-]+)(?:\[(?P<where>.*?)\])? (?P<column>.+?)(?: over (?P<other>.+?))?"
    r" : (?P<format>\S+)"
)
OF_CODE = re.compile(r"code (?P<name>\S+ \S+) (?P<key>.+?) : (?P<format>\S+)")


def filled(text: str) -> str:
    """Fill all marks of a page."""
    text = VALUE.sub(lambda mark: mark[1] + value(mark[2]) + mark[4], text)
    return ROWS.sub(lambda mark: mark[1] + rows(mark[2], mark[3] or "", mark[4]) + mark[6], text)


def value(asked: str) -> str:
    """Return the text that a mark asks for.

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
    numbers = []
    for row in chosen:
        try:
            number = float(row[found["column"]])
            if found["other"]:
                number /= float(row[found["other"]])
        except KeyError as name:
            raise ValueError(
                f"{found['file']}.csv has no column {name}, but {', '.join(row)}"
            ) from None
        except ValueError:
            continue
        numbers.append(number)
    if not numbers or (len(numbers) > 1 and not found["end"]):
        raise ValueError(f"{len(numbers)} values in {asked!r}")
    number = min(numbers)
    if found["end"] == "most":
        number = max(numbers)
    return shown(number, found["format"])


def shown(number: float, way: str) -> str:
    """Write a number in a format; with % at its end that of a ratio above 1."""
    if way.endswith("%"):
        return f"{100 * (number - 1):{way[:-1]}} %"
    return f"{number:{way}}"


def rows(file: str, where: str, template: str) -> str:
    """Write the rows of a table."""
    lines = []
    for row in chosen_rows(file, where):

        def cell(mark, row=row):
            text = row[mark[1]]
            if mark[2] and text:
                return f"{float(text):{mark[2]}}"
            return text

        lines.append(f"{re.sub(r'{([^{}:]+):?([^{}]*)}', cell, template).strip()} |\n")
    return "".join(lines)


def chosen_rows(file: str, where: str) -> list[dict[str, str]]:
    """Read the rows of a file in which columns have given values."""
    path = DATA / f"{file}.csv"
    if not path.is_file():
        raise ValueError(f"no file {file}.csv")
    wanted = dict(
        (part.strip() for part in one.split("=", 1)) for one in where.split(";") if one.strip()
    )
    found = [row for row in read(path)[1] if wanted.items() <= row.items()]
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
