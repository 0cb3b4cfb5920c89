"""Response of a crossover over a rectangle of end displacements: tensions, contact force and
heights, with its file.

The file is HDF5: one dataset an array, SI units in the attribute "unit", provenance in the
attributes of the root.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import write_hdf5
from fabrics.base.read_formats import read_hdf5

_UNITS = {"d1": "m", "d2": "m", "T1": "N", "T2": "N", "F_c": "N", "h1": "m", "h2": "m"}
_FORMAT = "weavecell response surface 1"


@dataclass(frozen=True)
class ResponseSurface:
    """Sampled response of one crossover (thesis Figure 3-11).

    Parameters
    ----------
    d1 : (n1,) [m] rising end displacements of the warp, per end
    d2 : (n2,) [m] of the weft
    T1, T2 : (n1, n2) [N] yarn tensions
    F_c : (n1, n2) [N] contact force
    h1, h2 : (n1, n2) [m] heights of the centrelines
    fabric : name
    provenance : how it was made

    Raises
    ------
    InputError : an axis does not rise, or a shape or value does not fit
    """

    d1: np.ndarray
    d2: np.ndarray
    T1: np.ndarray
    T2: np.ndarray
    F_c: np.ndarray
    h1: np.ndarray
    h2: np.ndarray
    fabric: str = ""
    provenance: str = ""

    def __post_init__(self):
        for name in ("d1", "d2"):
            axis = getattr(self, name)
            if axis.ndim != 1 or axis.size < 2 or not np.all(np.diff(axis) > 0):
                raise InputError(key=name, allowed="a rising axis of at least two points")
        shape = self.d1.size, self.d2.size
        for name in list(_UNITS)[2:]:
            values = getattr(self, name)
            if values.shape != shape or not np.all(np.isfinite(values)):
                raise InputError(key=name, allowed=f"finite, of shape {shape}")

    def write(self, path: FilePath) -> None:
        """Write the surface as HDF5, whole or not at all."""
        with write_hdf5(path, _FORMAT, fabric=self.fabric, provenance=self.provenance) as file:
            for name, unit in _UNITS.items():
                file.create_dataset(name, data=getattr(self, name)).attrs["unit"] = unit

    @classmethod
    def read(cls, path: FilePath) -> ResponseSurface:
        """Read what `write` wrote.

        Raises
        ------
        InputError : no such file, not HDF5, another format, or a dataset is missing or bad
        """
        with read_hdf5(path, _FORMAT) as file:
            missing = [name for name in _UNITS if name not in file]
            if missing:
                raise InputError(f"has no dataset {missing[0]}", file=path)
            values = {name: file[name][()] for name in _UNITS}
            values |= {name: str(file.attrs.get(name, "")) for name in ("fabric", "provenance")}
        assert set(values) == {entry.name for entry in fields(cls)}
        return cls(**values)
