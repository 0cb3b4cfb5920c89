"""A user's biaxial test, and its file.

The file is CSV, one test at one ratio of strains. Lines that begin with # are comments. The first other line names the
columns with their units, in any order; the tensions are per yarn, and one of them may be missing:

    warp strain [%], weft strain [%], warp tension [N], weft tension [N]

At least eight rows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.files import read_columns

FEWEST = 8
COLUMNS = ("warp strain", "weft strain", "warp tension", "weft tension")


@dataclass(frozen=True, eq=False)
class Test:
    """A test.

    Parameters
    ----------
    strain : (n, 2) [-] of the fabric along warp and weft
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
    def ratio(self) -> float:
        """[-] warp over weft strain, of the whole test."""
        return float(np.sum(self.strain[:, 0] * self.strain[:, 1]) / np.sum(self.strain[:, 1] ** 2))

    @classmethod
    def read(cls, path: FilePath) -> Test:
        """Read a file.

        Raises
        ------
        InputError : one line naming the file, the row, the value and what is allowed
        """
        table = read_columns(
            path, {name: "" if name.endswith("strain") else "N" for name in COLUMNS}, what="a biaxial test",
            content="strains and tensions", heading=f"{', '.join(COLUMNS)}, each with [unit]",
            accepts=lambda names: len(set(names)) == len(names) and set(COLUMNS[:2]) <= set(names),
            columns="both strains, and tensions",
        )  # fmt: skip
        missing = np.full(table[COLUMNS[0]].size, np.nan)
        strain, tension = (
            np.stack([table.get(name, missing) for name in part], 1) for part in (COLUMNS[:2], COLUMNS[2:])
        )
        return cls(strain, tension, str(path))
