"""Finished lines of a response surface, kept in one HDF5 file that is written whole after each of
them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.files import read_hdf5, write_hdf5

_FORMAT = "weavecell partial surface 4"


@dataclass(frozen=True)
class Line:
    """A line of the grid, along `axis` (0: d1, 1: d2) at `fixed` of the other [m].

    Parameters
    ----------
    along : (n,) [m] places
    values : (n, 5) T1, T2, F_c [N], h1, h2 [m]
    states : (n, size) unknowns [m], or (0, 0) where no other line starts from this one
    stick_state : (n, s) where the points of contact stick with friction, or (0, 0) like the states
    seconds : [s] wall time
    iterations : tangents factorised
    """

    axis: int
    fixed: float
    along: np.ndarray
    values: np.ndarray
    states: np.ndarray
    stick_state: np.ndarray
    seconds: float
    iterations: int


class Partial:
    """Lines by name.

    Parameters
    ----------
    path : file, or None to keep them in memory alone
    stamp : of what is sampled and the code (`fabrics.base.run_cache.stamp`)
    resume : begin with the lines of the file, if it is there

    Raises
    ------
    InputError : the file to go on from is not one of these, or is of another surface or of other
        code
    """

    def __init__(self, path: FilePath | None, stamp: Mapping[str, str], resume: bool) -> None:
        self._path = Path(path) if path is not None else None
        self._stamp = stamp
        self.lines = (
            self._read() if resume and self._path is not None and self._path.exists() else {}
        )

    def add(self, name: str, line: Line) -> None:
        """Keep a line."""
        self.lines[name] = line
        if self._path is None:
            return
        with write_hdf5(self._path, _FORMAT, **self._stamp) as file:
            for key, kept in self.lines.items():
                group = file.create_group(key)
                for item in fields(Line):
                    group[item.name] = getattr(kept, item.name)

    def _read(self):
        with read_hdf5(self._path, _FORMAT, what="file of the lines of a surface") as file:
            run_cache.check_stamp(file.attrs, self._stamp, self._path, of="surface")
            return {
                key: Line(**{item.name: group[item.name][()] for item in fields(Line)})
                for key, group in file.items()
            }
