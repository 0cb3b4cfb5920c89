"""The record of a run: named columns with their meanings, facts and arrays of the last state, in a
file too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError
from fabrics.base.extras import explain_missing
from fabrics.base.files import write_hdf5
from fabrics.base.read_formats import read_hdf5

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

FORMAT = "weavecell record 1"


@dataclass(frozen=True)
class Record:
    """n rows, such as the converged states of a path, the first of them at rest.

    Parameters
    ----------
    columns : {name: (n, ...) SI values}
    meanings : {name: "[unit] what it is"}
    facts : {name: number or text} of the run, such as its fabric and its case
    last : {name: array} of the last state, such as u, (points, 3) [m], the displacement of a mesh's
        nodes
    failed : reason why the run ended before its end, "" if it did not
    """

    columns: dict[str, FloatArray]
    meanings: dict[str, str]
    facts: dict[str, Any] = field(default_factory=dict)
    last: dict[str, np.ndarray] = field(default_factory=dict, repr=False)
    failed: str = ""

    def __getitem__(self, name: str) -> FloatArray:
        return self.columns[name]

    def unit(self, name: str) -> str:
        """Return the SI unit of a column, "-" of a number without one."""
        return self.meanings[name].partition("[")[2].partition("]")[0]

    def to_dataframe(self) -> DataFrame:
        """Return a table with one row per state; a column of several numbers per state gives one
        for each, name_0, name_1, ..."""
        from pandas import DataFrame

        flat = {}
        for name, values in self.columns.items():
            if np.ndim(values) == 1:
                flat[name] = values
                continue
            for number, part in enumerate(np.reshape(values, (len(values), -1)).T):
                flat[f"{name}_{number}"] = part
        return DataFrame(flat)

    @explain_missing()
    def to_xarray(self, *dimensions: str) -> Dataset:
        """Return the columns as variables over `dimensions` ("row" without), with units; further
        axes are name_1, ..."""
        from xarray import Dataset

        shared = dimensions or ("row",)
        variables = {}
        for name, values in self.columns.items():
            count = np.ndim(values)
            axes = [*shared[:count]]
            axes += [f"{name}_{axis}" for axis in range(len(shared), count)]
            meaning = self.meanings[name].partition("] ")[2]
            variables[name] = (axes, values, {"units": self.unit(name), "long_name": meaning})
        return Dataset(variables, attrs=self.facts)

    def write(self, path: FilePath, **notes: Any) -> None:
        """Write as HDF5 (.h5), with notes (numbers and texts) that `notes` gives back."""
        # a path that ended early is a result too, and says so in the file
        with write_hdf5(path, FORMAT, failed=self.failed) as file:
            for group, values in (("facts", self.facts), ("notes", notes)):
                file.create_group(group).attrs.update(values)
            for name, column in self.columns.items():
                file[f"columns/{name}"] = column
                file[f"columns/{name}"].attrs["meaning"] = self.meanings.get(name, "")
            for name, array in self.last.items():
                file[f"last/{name}"] = array

    @staticmethod
    def notes(path: FilePath) -> dict[str, Any]:
        """Read the notes of a file; {} if it has another format."""
        try:
            with read_hdf5(path, FORMAT) as file:
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
        with read_hdf5(path, FORMAT, what="record") as file:
            columns = {}
            meanings = {}
            for name, values in file["columns"].items():
                columns[name] = values[:]
                meanings[name] = str(values.attrs["meaning"])
            return cls(
                columns,
                meanings,
                facts=dict(file["facts"].attrs),
                last={name: values[:] for name, values in file.get("last", {}).items()},
                failed=str(file.attrs["failed"]),
            )


def columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, FloatArray]:
    """Turn rows, dicts with the same keys, into columns: {name: (n, ...)}."""
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}
