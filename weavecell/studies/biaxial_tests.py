"""Measured biaxial tests of a fabric: load of a yarn of warp and weft against the fabric's strains.

A CSV file has a heading and a row for each measured state,

    test, warp strain [%], weft strain [%], warp load [N], weft load [N]

in any order and unit. Rows of one name are one test, in the order of the file. An empty strain is
that of a direction which is free: it carries no load. An empty load was not measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError
from fabrics.base.files import read_csv, read_number
from fabrics.base.units import si

DIRECTIONS = ("warp", "weft")
TEST = "test"
STRAINS = ("warp strain", "weft strain")
LOADS = ("warp load", "weft load")
UNITS = dict.fromkeys(STRAINS, "") | dict.fromkeys(LOADS, "N")
WHAT = "biaxial tests: test, warp strain [%], weft strain [%], warp load [N], weft load [N]"
# how a number without a unit is headed
PLAIN = ("-", "1")
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


def read(path: FilePath) -> list[BiaxialTest]:
    """Read the tests of a CSV file, in the order of their first rows.

    Raises
    ------
    InputError : one line naming the file, the line, the value and what is allowed
    """
    lines = read_csv(path, WHAT, words=(TEST,))
    if not lines:
        raise InputError("is empty", file=path, allowed=WHAT)
    columns = [_column(cell, path) for cell in lines[0][1]]
    names = [name for name, _ in columns]
    if sorted(names) != sorted((TEST, *UNITS)):
        raise InputError(file=path, key="columns", value=", ".join(names), allowed=WHAT)
    rows: dict[str, list[list[float]]] = {}
    for number, cells in lines[1:]:
        name, values = _row(number, cells, columns, path)
        rows.setdefault(name, []).append(values)
    return [_test(name, np.array(values), path) for name, values in rows.items()]


def _column(cell, path):
    """(name, SI value of its unit) of a heading."""
    name, _, unit = cell.partition("[")
    name = " ".join(name.lower().split())
    if name == TEST:
        return name, 1.0
    if name not in UNITS or not unit.endswith("]"):
        raise InputError(file=path, key="heading", value=cell, allowed=WHAT)
    unit = unit[:-1].strip()
    if name in STRAINS and unit in PLAIN:
        return name, 1.0
    return name, si(f"1 {unit}", UNITS[name], file=path, key=name)


def _row(number, cells, columns, path):
    """(name of the test, [strains of warp and weft, loads of warp and weft]) of a line, in SI."""
    line = f"line {number}"
    # empty cells at the end of a line are left out
    cells = [*cells, *[""] * (len(columns) - len(cells))]
    if len(cells) != len(columns):
        allowed = f"{len(columns)} cells"
        raise InputError(file=path, key=line, value=", ".join(cells), allowed=allowed)
    found = {}
    for (name, scale), cell in zip(columns, cells):
        if name == TEST:
            if not cell:
                raise InputError(file=path, key=f"{line}, test", value=cell, allowed="a name")
            found[name] = cell
        elif not cell:
            found[name] = nan
        else:
            allowed = "a finite number, or empty of a free direction or a load not measured"
            found[name] = scale * read_number(cell, allowed, file=path, key=f"{line}, {name}")
            if name in STRAINS and abs(found[name]) > LARGEST:
                allowed = f"at most {100 * LARGEST:g} %"
                raise InputError(file=path, key=f"{line}, {name}", value=cell, allowed=allowed)
    return found[TEST], [found[name] for name in UNITS]


def _test(name, values, path):
    """The test of its rows, which are checked together."""
    key = f"test {name}"
    if len(values) < FEWEST:
        allowed = f"at least {FEWEST} rows"
        raise InputError(file=path, key=key, value=f"{len(values)} rows", allowed=allowed)
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
