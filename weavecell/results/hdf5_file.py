"""histories.h5: datasets with units, and objects as groups by the tables of `results.keys`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weavecell.results.keys import TABLES, Key

# arrays with fewer numbers gain nothing from compression
_PACKED_FROM = 1000


def put(file: Any, name: str, values: ArrayLike, unit: str) -> None:
    """Write an array to an open HDF5 file, with its unit; a large one is compressed."""
    array = np.asarray(values)
    packing = {}
    if array.size >= _PACKED_FROM:
        packing = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    file.create_dataset(name, data=array, **packing).attrs["unit"] = unit


def plain(value: Any) -> Any:
    """Convert a number of numpy to one of Python."""
    if isinstance(value, np.generic):
        return value.item()
    return value


def write_group(group: Any, source: object, table: Iterable[Key]) -> None:
    """Write what a table names of an object: keys with a unit as datasets, the others as
    attributes."""
    for key in table:
        if key.unit:
            put(group, key.name, key.value(source), key.si_unit)
        else:
            group.attrs[key.name] = key.value(source)


def read_group(group: Any, kind: Any, table: str, **more: Any) -> Any:
    """Read the object of a dataclass `kind` that `write_group` wrote by a table; `more` of its
    fields are given."""
    known = {entry.name for entry in fields(kind)}
    for key in TABLES[table]:
        if key.field in known:
            more[key.field] = plain(group[key.name][()] if key.unit else group.attrs[key.name])
    return kind(**more)
