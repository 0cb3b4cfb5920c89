"""Cards of input files: fields in fixed columns, below a comment line with their names as the
manuals have them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import IntArray


def heading(mark: str, names: Iterable[str], widths: Iterable[int]) -> str:
    """Write the comment line: each name at the right end of its field.

    Parameters
    ----------
    mark : with which comments begin
    names : of the fields; those that begin with _ have none
    """
    line = ""
    for name, width in zip(names, widths):
        if name.startswith("_"):
            name = ""
        line += f"{name:>{width}}"
    return f"{mark}{line[len(mark) :].rstrip()}\n"


def card(mark: str, texts: Mapping[str, str]) -> str:
    """Write one card: {name: text as wide as the field}."""
    return heading(mark, texts, map(len, texts.values())) + "".join(texts.values()) + "\n"


def table(mark: str, template: str, names: str, *columns: ArrayLike) -> str:
    """Write a card a row of the columns side by side, in a %-template; one comment line above
    all."""
    return heading(mark, names.split(), map(int, re.findall(r"%(\d+)", template))) + lines(
        template, *columns
    )


def numbers(mark: str, name: str, values: Sequence[int] | IntArray, per_line: int) -> str:
    """Write whole numbers in fields of 10 columns; their name is followed by the number of the
    field."""
    names = (f"{name}{n}" for n in range(1, 1 + min(per_line, len(values))))
    return heading(mark, names, [10] * per_line) + wrap(values, per_line)


def lines(template: str, *columns: ArrayLike) -> str:
    """Write one line of the %-template for each row of the columns side by side."""
    arrays = [np.asarray(column) for column in columns]
    flat = [c.reshape(len(c), -1) for c in arrays]
    rows = zip(*(part for c in flat for part in c.T.tolist()))
    return "".join(template % row + "\n" for row in rows)


def wrap(numbers: Iterable, per_line: int, template: str = "%10d", between: str = "") -> str:
    """Write numbers in lines of at most `per_line`."""
    texts = [template % n for n in numbers]
    return "".join(
        between.join(texts[i : i + per_line]) + "\n" for i in range(0, len(texts), per_line)
    )


def fields(template: str, *values: float | str) -> str:
    """Write one line of values, each in the format `template`, such as "{:10d}"."""
    return "".join(map(template.format, values)) + "\n"
