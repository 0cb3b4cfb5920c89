"""A displacement record, and its file.

The file is CSV. Lines that begin with # are comments. The first other line names the two columns with their units:

    time [us], displacement [mm]

Times rise evenly; displacement grows along the flight. Samples before the strike, at times below zero, tell the strike
velocity. At least 50 rows.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fabrics.errors import InputError
from fabrics.units import si

FEWEST = 50
UNEVEN = 1e-3  # of the spacing: what rounding in a file may do to it
_UNITS = {"time": "s", "displacement": "m"}


@dataclass(frozen=True, eq=False)
class Record:
    """A record.

    Parameters
    ----------
    t : (n,) [s] evenly spaced; the strike is at 0
    x : (n,) [m] displacement of the projectile
    source : where it comes from

    Raises
    ------
    InputError : too few samples, one that is not finite, or times that are not even
    """

    t: np.ndarray
    x: np.ndarray
    source: str = ""

    def __post_init__(self):
        if self.t.shape != self.x.shape or self.t.size < FEWEST:
            raise InputError(key="rows", value=int(self.t.size), allowed=f"at least {FEWEST}", file=self.source or None)
        if not (np.all(np.isfinite(self.t)) and np.all(np.isfinite(self.x))):
            raise InputError(key="displacement", allowed="finite in every row", file=self.source or None)
        steps = np.diff(self.t)
        if not np.all(steps > 0) or np.abs(steps - self.dt).max() > UNEVEN * self.dt + 1e-9 * abs(self.t).max():
            row = int(np.argmax(np.abs(steps - self.dt))) + 2
            raise InputError(key="time", value=f"row {row}", allowed="rising in even steps", file=self.source or None)

    @property
    def dt(self):
        """[s] between samples."""
        return float((self.t[-1] - self.t[0]) / (self.t.size - 1))

    @classmethod
    def read(cls, path) -> Record:
        """Read a file.

        Raises
        ------
        InputError : one line naming the file, the row, the value and what is allowed
        """
        path = Path(path)
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except (OSError, UnicodeDecodeError) as problem:
            why = getattr(problem, "strerror", None) or "not text"
            raise InputError("cannot be read", file=path, allowed=f"a displacement record ({why})") from problem
        numbered = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
        if not numbered:
            raise InputError("is empty", file=path, allowed="time [us], displacement [mm]")
        names, scales = zip(*(_heading(cell, path) for cell in next(csv.reader([numbered[0][1]]))))
        if sorted(names) != sorted(_UNITS):
            raise InputError(file=path, key="columns", value=", ".join(names), allowed="time and displacement")
        rows = np.array([_row(n, line, path) for n, line in numbered[1:]]).reshape(-1, 2) * scales
        columns = dict(zip(names, rows.T))
        return cls(columns["time"], columns["displacement"], str(path))


def _heading(cell, path):
    """(name, SI value of its unit) of a heading such as "time [us]"."""
    found = re.fullmatch(r"\s*(\w+)\s*\[([^\]]+)\]\s*", cell)
    if found is None or found[1] not in _UNITS:
        raise InputError(file=path, key="heading", value=cell.strip(), allowed="time [unit] or displacement [unit]")
    return found[1], si(f"1 {found[2]}", _UNITS[found[1]], file=path, key=found[1])


def _row(number, line, path):
    try:
        first, second = next(csv.reader([line]))
        return float(first), float(second)
    except ValueError:
        raise InputError(file=path, key=f"line {number}", value=line.strip(), allowed="two numbers") from None
