"""What a case leaves behind: named columns of one row per converged state, kept also where its path ends early."""

from __future__ import annotations

from dataclasses import dataclass, field

import h5py
import numpy as np

from fabrics.errors import InputError
from fabrics.files import replace_whole

_FORMAT = "weavecell case record 1"


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
    """

    columns: dict
    meanings: dict
    u: np.ndarray = field(repr=False)
    fabric: str = ""
    case: str = ""
    failed: str = ""
    facts: dict = field(default_factory=dict)

    def __getitem__(self, name):
        return self.columns[name]

    def write(self, path):
        """Write as HDF5 (.h5)."""
        with replace_whole(path) as beside, h5py.File(beside, "w") as file:
            file.attrs.update({"format": _FORMAT, "fabric": self.fabric, "case": self.case, "failed": self.failed})
            file.create_group("facts").attrs.update(self.facts)
            for name, values in self.columns.items():
                file[f"columns/{name}"] = values
                file[f"columns/{name}"].attrs["meaning"] = self.meanings.get(name, "")
            file["u"] = self.u

    @classmethod
    def read(cls, path) -> Record:
        """Read what `write` wrote.

        Raises
        ------
        InputError : no such file, or another format
        """
        try:
            with h5py.File(path, "r") as file:
                if file.attrs.get("format") != _FORMAT:
                    raise InputError(file=path, key="format", value=file.attrs.get("format"), allowed=repr(_FORMAT))
                columns = {name: values[:] for name, values in file["columns"].items()}
                meanings = {name: str(values.attrs["meaning"]) for name, values in file["columns"].items()}
                texts = {key: str(file.attrs[key]) for key in ("fabric", "case", "failed")}
                return cls(columns, meanings, file["u"][:], facts=dict(file["facts"].attrs), **texts)
        except OSError as problem:
            raise InputError("cannot be read", file=path, allowed=f"a case record ({problem})") from problem
