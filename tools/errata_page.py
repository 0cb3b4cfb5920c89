"""The whole table of errata for the site, from docs/reports/data/errata.csv."""

from __future__ import annotations

from itertools import groupby
from operator import itemgetter
from pathlib import Path

from validation.csv_file import read

DATA = Path(__file__).parents[1] / "docs" / "reports" / "data" / "errata.csv"
HEAD = """# Errata of the thesis, in full

[Errata](thesis/errata.md) has the short list and the meaning of the grades. "Inferred" means that a correction
reproduces other printed numbers, but the thesis does not say it."""


def page() -> str:
    """Write the text of the page: a section for each part of the thesis, a paragraph for each
    erratum."""
    made, rows = read(DATA)
    parts = [HEAD, f"Table: {made}."]
    for section, entries in groupby(rows, key=itemgetter("section")):
        parts.append(f"## {section}")
        parts += map(entry, entries)
    return "\n\n".join(parts) + "\n"


def entry(row: dict[str, str]) -> str:
    """Write the text of a row under its number, grade and title."""
    if not row["no"]:
        title = f"### {row['what']}\n\n" if row["what"] else ""
        return title + row["text"]
    used = f" *Used here: {row['used here']}.*" if row["used here"] else ""
    return f"**{row['no']} [{row['grade']}] {row['what']}.** {row['text']}{used}"
