"""Measured biaxial tests of a fabric: load of a yarn of warp and weft against the fabric's strains.

A table of users (`fabrics.base.tables`) has a row for each measured state,

    test, warp strain [%], weft strain [%], warp load [N], weft load [N]

Laboratories head it otherwise too: "ratio" or "specimen" in place of "test", "tension" or "force" in
place of "load", and loads per width of the fabric, such as "warp tension [kN/m]", which the spacing of
the yarns makes loads of one yarn (`fabrics.base.tables.SYNONYMS`).

Rows of one name are one test, in the order of the file. An empty strain is
that of a direction which is free: it carries no load. An empty load was not measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import nan

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.tables import WORDS, read_table

DIRECTIONS = ("warp", "weft")
TEST = "test"
STRAINS = ("warp strain", "weft strain")
LOADS = ("warp load", "weft load")
UNITS = dict.fromkeys(STRAINS, "") | dict.fromkeys(LOADS, "N")
# a curve of fewer rows says nothing of its scatter
FEWEST = 5
# [-] a larger strain is a slip of the unit: glass breaks at 0.02, aramid at 0.04
LARGEST = 0.5


@dataclass(frozen=True, eq=False)
class BiaxialTest:
    """One test.

    Parameters
    ----------
    name : as in the file
    strain : (n, 2) [-] of the fabric along warp and weft; nan of a free direction
    load : (n, 2) [N] of a yarn of warp and weft; nan where it was not measured
    """

    name: str
    strain: FloatArray
    load: FloatArray

    @property
    def free(self) -> str:
        """ "warp" or "weft", the direction that is free; "" of a test that prescribes both."""
        for name, strains in zip(DIRECTIONS, self.strain.T):
            if np.isnan(strains).all():
                return name
        return ""

    @property
    def direction(self) -> FloatArray:
        """(2,) [-] along which the strains grow, the larger part 1; 0 of a free direction."""
        strain = np.nan_to_num(self.strain)
        furthest = strain[np.abs(strain).max(axis=1).argmax()]
        return furthest / np.abs(furthest).max()

    @property
    def ratio(self) -> str:
        """Warp to weft strain, in words."""
        if self.free:
            return f"{self.free} free"
        warp, weft = self.direction
        return f"{warp:.3g} : {weft:.3g}"

    @property
    def greatest(self) -> FloatArray:
        """(2,) [N] greatest load of warp and weft; nan where none was measured."""
        found = [nan, nan]
        for m, loads in enumerate(self.load.T):
            if np.isfinite(loads).any():
                found[m] = float(np.nanmax(loads))
        return np.array(found)


def read(path: FilePath, spacing: Sequence[float]) -> list[BiaxialTest]:
    """Read the tests of a CSV file, in the order of their first rows.

    Parameters
    ----------
    spacing : (warp, weft) [m] of the yarns, by which loads per width are those of one yarn

    Raises
    ------
    InputError : one line naming the file, the line, the value and what is allowed
    """
    table, widths = _read_rows(path, spacing)
    if not any(name in table.cells for name in LOADS):
        allowed = f"with {' or '.join(LOADS)} [N]"
        raise InputError(file=path, key="columns", value=", ".join(table.cells), allowed=allowed)
    rows: dict[str, list[list[float]]] = {}
    for line, cells in table.rows():
        if not cells[TEST]:
            raise InputError(file=path, key=f"{line}, {TEST}", value="", allowed="a name")
        values = [
            widths.get(name, 1.0) * _value(table, line, name, cells.get(name, "")) for name in UNITS
        ]
        rows.setdefault(cells[TEST], []).append(values)
    if not rows:
        raise InputError("has no row", file=path, allowed="a heading and a row for each state")
    return [_test(name, np.array(values), path) for name, values in rows.items()]


def _read_rows(path, spacing):
    """Return (Table, {load that is per width: [m] of a yarn})."""

    def read_with(unit):
        return read_table(
            path,
            {TEST: WORDS} | UNITS | dict.fromkeys(LOADS, unit),
            what="biaxial tests",
            example="warp strain [%]",
            optional=LOADS,
        )

    try:
        return read_with("N"), {}
    except InputError:
        # of both families, or the first words stand
        with suppress(InputError):
            return read_with("N/m"), dict(zip(LOADS, spacing))
        raise


def _value(table, line, name, cell):
    """The number of a cell in SI; nan of an empty one."""
    if not cell:
        return nan
    value = table.number(line, name, cell)
    if name in STRAINS and abs(value) > LARGEST:
        allowed = f"at most {100 * LARGEST:g} %"
        raise InputError(file=table.path, key=f"{line}, {name}", value=cell, allowed=allowed)
    return value


def _test(name, values, path):
    """The test of its rows, which are checked together."""
    key = f"test {name}"
    if len(values) < FEWEST:
        allowed = f"at least {FEWEST} rows"
        raise InputError(file=path, key=key, value=counted(len(values), "row"), allowed=allowed)
    strain = values[:, :2]
    load = values[:, 2:]
    empty = np.isnan(strain)
    for m, column in enumerate(STRAINS):
        if empty[:, m].any() and not empty[:, m].all():
            allowed = "given in all rows of the test, or in none"
            raise InputError(file=path, key=f"{key}, {column}", value="empty", allowed=allowed)
    if empty.all():
        raise InputError("has no strain", file=path, key=key)
    if not np.isfinite(load[~empty]).any():
        allowed = "given of a direction that is stretched"
        raise InputError(file=path, key=f"{key}, load", value="empty", allowed=allowed)
    if not np.nanmax(np.abs(strain)) > 0:
        raise InputError(file=path, key=f"{key}, strain", value=0, allowed="one that stretches")
    return BiaxialTest(name, strain, np.where(empty, nan, load))
