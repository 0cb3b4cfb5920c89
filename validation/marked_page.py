"""A page of the documentation whose tables a command makes: what is between two marks is replaced, the rest kept."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fabrics.errors import InputError
from fabrics.files import write


def markdown(rows: Sequence[Sequence[object]], *, numbers: bool = False) -> str:
    """Rows, the first of which is the head, as a table in Markdown; with `numbers` all columns but the first are flush
    right."""
    rule = ["---", *(["---:" if numbers else "---"] * (len(rows[0]) - 1))]
    return "".join("| " + " | ".join(map(str, row)) + " |\n" for row in [rows[0], rule, *rows[1:]])


def split(page: Path, begin: str, end: str) -> tuple[str, str]:
    """What stands before the mark `begin` of a page, and after the first mark `end` behind it.

    Raises
    ------
    InputError : the page has no such marks
    """
    before, begins, rest = page.read_text("utf-8").partition(begin)
    _, ends, after = rest.partition(end)
    if not (begins and ends):
        raise InputError(f"has no marks {begin} ... {end}", file=page)
    return before, after


def put(page: Path, begin: str, end: str, content: str) -> None:
    """Put a text between two marks of a page; InputError as `split`."""
    before, after = split(page, begin, end)
    write(page, f"{before}{begin}{content}{end}{after}")
