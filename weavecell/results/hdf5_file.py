"""histories.h5: datasets with units."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def put(file: Any, name: str, values: ArrayLike, unit: str, **packing: Any) -> None:
    """Write an array to an open HDF5 file, with its unit."""
    file.create_dataset(name, data=np.asarray(values), **packing).attrs["unit"] = unit


def plain(value: Any) -> Any:
    """A number of numpy as one of Python."""
    return value.item() if isinstance(value, np.generic) else value
