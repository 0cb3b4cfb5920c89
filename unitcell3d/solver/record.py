"""What a case leaves behind: named columns of one row per converged state, kept also where its path ends early."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from fabrics.checks import FilePath, FloatArray
from fabrics.errors import InputError
from fabrics.files import read_hdf5, write_hdf5

_FORMAT = "weavecell case record 2"
_NAMES = ("fabric", "case", "failed")
Hook: TypeAlias = Callable[[float, dict[str, Any]], object]  # called as hook(share of the path, row)


@dataclass(frozen=True)
class Record:
    """A path of n converged states, the first of them at rest.

    Parameters
    ----------
    columns : {name: (n, ...) SI values}
    meanings : {name: "[unit] what it is"}
    u : (points, 3) [m] displacement of the mesh's nodes in the last state
    fabric, case : names
    failed : reason why the path ended before its end, "" where it did not
    facts : {name: number or text} of the run
    last : {name: array} of other things in the last state
    """

    columns: dict
    meanings: dict
    u: np.ndarray = field(repr=False)
    fabric: str = ""
    case: str = ""
    failed: str = ""
    facts: dict = field(default_factory=dict)
    last: dict = field(default_factory=dict, repr=False)

    def __getitem__(self, name: str) -> FloatArray:
        return self.columns[name]

    def write(self, path: FilePath, **notes: Any) -> None:
        """Write as HDF5 (.h5), with notes (numbers and texts) that `notes` gives back."""
        with write_hdf5(path, _FORMAT, **{name: getattr(self, name) for name in _NAMES}) as file:
            for group, values in (("facts", self.facts), ("notes", notes)):
                file.create_group(group).attrs.update(values)
            for name, values in self.columns.items():
                file[f"columns/{name}"] = values
                file[f"columns/{name}"].attrs["meaning"] = self.meanings.get(name, "")
            for name, values in self.last.items():
                file[f"last/{name}"] = values
            file["u"] = self.u

    @staticmethod
    def notes(path: FilePath) -> dict[str, Any]:
        """The notes of a file; {} where it is none of these."""
        try:
            with read_hdf5(path, _FORMAT) as file:
                return dict(file["notes"].attrs)
        except InputError:
            return {}

    @classmethod
    def read(cls, path: FilePath) -> Record:
        """Read what `write` wrote.

        Raises
        ------
        InputError : no such file, or another format
        """
        with read_hdf5(path, _FORMAT, what="record of a case") as file:
            return cls(
                columns={name: values[:] for name, values in file["columns"].items()},
                meanings={name: str(values.attrs["meaning"]) for name, values in file["columns"].items()},
                u=file["u"][:],
                **{name: str(file.attrs[name]) for name in _NAMES},
                facts=dict(file["facts"].attrs),
                last={name: values[:] for name, values in file.get("last", {}).items()},
            )


def columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, FloatArray]:
    """{name: (n, ...)} of rows, dicts with the same keys."""
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}
