"""A user's biaxial test, and its file.

The file is CSV, one test at one ratio of strains. Lines that begin with # are comments. The first other line names the
columns with their units, in any order; the tensions are per yarn, and one of them may be missing:

    warp strain [%], weft strain [%], warp tension [N], weft tension [N]

At least eight rows.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fabrics.errors import InputError
from fabrics.units import si

FEWEST = 8
COLUMNS = ("warp strain", "weft strain", "warp tension", "weft tension")


@dataclass(frozen=True, eq=False)
class Test:
    """A test.

    Parameters
    ----------
    strain : (n, 2) [-] of the cloth along warp and weft
    tension : (n, 2) [N] per yarn; nan in a column that was not measured
    source : where it comes from

    Raises
    ------
    InputError : too few rows, a strain or tension that is not finite, or no tension at all
    """

    __test__ = False  # not one of pytest's

    strain: np.ndarray
    tension: np.ndarray
    source: str = ""

    def __post_init__(self):
        measured = ~np.all(np.isnan(self.tension), axis=0)
        if len(self.strain) < FEWEST:
            raise InputError(key="rows", value=len(self.strain), allowed=f"at least {FEWEST}", file=self.source or None)
        if not np.all(np.isfinite(self.strain)) or not np.all(np.isfinite(self.tension[:, measured])):
            raise InputError(key="rows", allowed="finite numbers", file=self.source or None)
        if not measured.any():
            raise InputError(key="columns", allowed="one with a tension at least", file=self.source or None)

    @property
    def ratio(self):
        """[-] warp over weft strain, of the whole test."""
        return float(np.sum(self.strain[:, 0] * self.strain[:, 1]) / np.sum(self.strain[:, 1] ** 2))

    @classmethod
    def read(cls, path) -> Test:
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
            raise InputError("cannot be read", file=path, allowed=f"a biaxial test ({why})") from problem
        numbered = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
        if not numbered:
            raise InputError("is empty", file=path, allowed="strains and tensions")
        names, scales = zip(*(_heading(cell, path) for cell in next(csv.reader([numbered[0][1]]))))
        if len(set(names)) < len(names) or not set(COLUMNS[:2]) <= set(names):
            raise InputError(file=path, key="columns", value=", ".join(names), allowed="both strains, and tensions")
        rows = [_row(n, line, len(names), path) for n, line in numbered[1:]]
        table = dict(zip(names, (np.array(rows).reshape(-1, len(names)) * scales).T))
        missing = np.full(len(rows), np.nan)
        strain, tension = (
            np.stack([table.get(name, missing) for name in part], 1) for part in (COLUMNS[:2], COLUMNS[2:])
        )
        return cls(strain, tension, str(path))


def _heading(cell, path):
    """(name, SI value of its unit) of a heading such as "warp strain [%]"."""
    found = re.fullmatch(r"\s*(.+?)\s*\[([^\]]+)\]\s*", cell)
    if found is None or found[1] not in COLUMNS:
        raise InputError(
            file=path, key="heading", value=cell.strip(), allowed=f"{', '.join(COLUMNS)}, each with [unit]"
        )
    unit = "" if found[1].endswith("strain") else "N"
    return found[1], si(f"1 {found[2]}", unit, file=path, key=found[1])


def _row(number, line, count, path):
    try:
        values = [float(cell) for cell in next(csv.reader([line]))]
    except ValueError:
        values = []
    if len(values) != count:
        raise InputError(file=path, key=f"line {number}", value=line.strip(), allowed=f"{count} numbers")
    return values
