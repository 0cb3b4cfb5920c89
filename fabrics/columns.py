"""Columns of measured numbers from a user's CSV file, in SI units.

Lines that begin with # are comments. The first other line names the columns, each with its unit, such as

    time [us], displacement [mm]
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from fabrics.checks import FilePath, FloatArray
from fabrics.errors import InputError
from fabrics.units import si


def read(
    path: FilePath,
    units: Mapping[str, str],
    *,
    what: str,
    content: str,
    heading: str,
    accepts: Callable[[Sequence[str]], bool],
    columns: str,
) -> dict[str, FloatArray]:
    """The columns of a file: {name: (n,) [SI]}.

    Parameters
    ----------
    units : {name: SI unit} of the columns that there may be
    what, content, heading, columns : what is reported as allowed where the file cannot be read, is empty, has a heading
        that is not one of `units`, or names that `accepts` (names) turns down

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as problem:
        why = getattr(problem, "strerror", None) or "not text"
        raise InputError("cannot be read", file=path, allowed=f"{what} ({why})") from problem
    numbered = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not numbered:
        raise InputError("is empty", file=path, allowed=content)
    names, scales = zip(*(_heading(cell, units, heading, path) for cell in next(csv.reader([numbered[0][1]]))))
    if not accepts(names):
        raise InputError(file=path, key="columns", value=", ".join(names), allowed=columns)
    rows = [_row(n, line, len(names), path) for n, line in numbered[1:]]
    return dict(zip(names, (np.array(rows).reshape(-1, len(names)) * scales).T))


def _heading(cell, units, allowed, path):
    """(name, SI value of its unit) of a heading such as "pressure [MPa]"."""
    found = re.fullmatch(r"\s*(.+?)\s*\[([^\]]+)\]\s*", cell)
    if found is None or found[1] not in units:
        raise InputError(file=path, key="heading", value=cell.strip(), allowed=allowed)
    return found[1], si(f"1 {found[2]}", units[found[1]], file=path, key=found[1])


def _row(number, line, count, path):
    try:
        values = [float(cell) for cell in next(csv.reader([line]))]
    except ValueError:
        values = []
    if len(values) != count:
        allowed_text = "two numbers" if count == 2 else f"{count} numbers"
        raise InputError(file=path, key=f"line {number}", value=line.strip(), allowed=allowed_text)
    return values
