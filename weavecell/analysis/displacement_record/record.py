"""A displacement record, and its file.

The file is CSV. Lines that begin with # are comments. The first other line names the two columns with their units:

    time [us], displacement [mm]

Times rise evenly; displacement grows along the flight. Samples before the strike, at times below zero, tell the strike
velocity. At least 50 rows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.files import read_columns

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
    def dt(self) -> float:
        """[s] between samples."""
        return float((self.t[-1] - self.t[0]) / (self.t.size - 1))

    @classmethod
    def read(cls, path: FilePath) -> Record:
        """Read a file.

        Raises
        ------
        InputError : one line naming the file, the row, the value and what is allowed
        """
        found = read_columns(
            path, _UNITS, what="a displacement record", content="time [us], displacement [mm]",
            heading="time [unit] or displacement [unit]",
            accepts=lambda names: sorted(names) == sorted(_UNITS), columns="time and displacement",
        )  # fmt: skip
        return cls(found["time"], found["displacement"], str(path))
