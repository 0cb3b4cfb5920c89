"""Tables as a terminal and a notebook show them."""

from __future__ import annotations

import sys
from html import escape
from math import isnan
from typing import TYPE_CHECKING

from fabrics.base.extras import explain_missing

if TYPE_CHECKING:
    from pandas import DataFrame


class Tables(dict[str, "DataFrame"]):
    """{title: DataFrame}, one below the other in a terminal and in a notebook.

    Examples
    --------
    >>> print(wc.show("gelatine 10 %"))  # doctest: +ELLIPSIS
    gelatine 10 %...
    """

    def __str__(self) -> str:
        return "\n\n".join(format_for_terminal(table, title) for title, table in self.items())

    __repr__ = __str__

    def _repr_html_(self) -> str:
        parts = []
        for title, table in self.items():
            parts.append(f"<b>{escape(title)}</b>{table.to_html(border=0)}")
        return "".join(parts)


@explain_missing()
def format_for_terminal(table: DataFrame, title: str = "") -> str:
    """Format a table as text: units below the names of columns, numbers with four digits, long
    texts in several lines."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text as AsItIs

    # texts of users may have square brackets, in which rich looks for marks
    shown = Table(title=AsItIs(title) if title else None, title_justify="left", title_style="bold")
    shown.box = box.SIMPLE_HEAD
    shown.pad_edge = shown.show_edge = False
    rows = table.reset_index()
    numbers = set(rows.select_dtypes("number"))
    if numbers:
        shown.padding = 0
    for name in rows:
        if name in numbers:
            # a word a line keeps nine numbers and a name within the 80 columns of a terminal
            heading = AsItIs("\n".join(word.strip("[]") for word in name.split()))
            shown.add_column(heading, justify="right")
        else:
            is_name = bool(numbers) and name == table.index.name
            shown.add_column(AsItIs(str(name)), overflow="fold", no_wrap=is_name)
    for row in rows.itertuples(index=False):
        shown.add_row(*(AsItIs(_cell(value)) for value in row))
    # a notebook keeps text and asks for colours: marks of bold would be kept with it
    console = Console(force_jupyter=False, force_terminal=sys.stdout.isatty())
    with console.capture() as printed:
        console.print(shown)
    return "\n".join(line.rstrip() for line in printed.get().rstrip("\n").split("\n"))


def _cell(value):
    if not isinstance(value, float):
        return str(value)
    # a sphere has no length
    if isnan(value):
        return "–"
    return f"{value:.4g}"
