"""histories.h5: datasets with units, and files of an older format read by the names of today."""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np

from fabrics.files import read_hdf5
from weavecell.scenes import renamed_keys


def put(file, name, values, unit, **packing):
    """Write an array to an open HDF5 file, with its unit."""
    file.create_dataset(name, data=np.asarray(values), **packing).attrs["unit"] = unit


def plain(value):
    """A number of numpy as one of Python."""
    return value.item() if isinstance(value, np.generic) else value


@contextmanager
def opened(path, kind, number):
    """An open file of format "weavecell KIND NUMBER"; one of the number before is read with a warning, renamed.

    Raises
    ------
    InputError : no HDF5 file, or of another format
    """
    present, before = (f"weavecell {kind} {n}" for n in (number, number - 1))
    with read_hdf5(path, present, before) as file:
        if file.attrs["format"] == present:
            yield file
        else:
            renamed_keys.warn_of_format(path, number - 1)
            with _upgraded(file) as renamed:
                yield renamed


def _upgraded(file):
    """A copy in memory with the names of today."""
    import h5py

    copy = h5py.File("upgraded.h5", "w", driver="core", backing_store=False)
    for name, value in file.attrs.items():
        copy.attrs[renamed_keys.SUMMARY_KEYS.get(name, name)] = value

    def add(name, item):
        new = renamed_keys.new_path(name, renamed_keys.HDF5_KEYS)
        made = copy.create_dataset(new, data=item[()]) if isinstance(item, h5py.Dataset) else copy.require_group(new)
        made.attrs.update(item.attrs)

    file.visititems(add)
    return copy
