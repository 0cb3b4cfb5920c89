"""Tables as Apache Parquet; unit and meaning of a column are metadata of its field in the schema. Needs pyarrow."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fnmatch import fnmatch
from typing import Any, NamedTuple

from fabrics.checks import FilePath
from fabrics.files import read_hdf5, replace_whole
from weavecell.results import coupon, impact, keys, pull_out
from weavecell.results.hdf5_file import plain

# format of a histories.h5: what its datasets mean
MEANINGS = {
    impact.FORMAT: keys.DATASETS, coupon.FORMAT: keys.COUPON_DATASETS, pull_out.FORMAT: keys.COUPON_DATASETS,
}  # fmt: skip
_GROUPS = {"histories": "", "energies": "energy ", "plies/histories": "ply {} "}  # and the names of their columns


class Column(NamedTuple):
    """Values of a column (n,), with unit ("1": a number without) and meaning; "" where there is none."""

    values: Any
    unit: str = ""
    meaning: str = ""


def write(path: FilePath, columns: Mapping[str, Column], about: Mapping[str, Any] | None = None) -> None:
    """Write a table, whole or not at all.

    Parameters
    ----------
    columns : {name: Column}
    about : {name: value} further metadata of the schema, as texts

    Raises
    ------
    ImportError : pyarrow is not installed, or does not fit numpy
    """
    import pyarrow
    from pyarrow import parquet

    arrays = [pyarrow.array(column.values) for column in columns.values()]
    fields = [
        pyarrow.field(name, array.type, metadata={"unit": column.unit, "meaning": column.meaning})
        for (name, column), array in zip(columns.items(), arrays)
    ]
    schema = pyarrow.schema(fields, metadata={key: str(value) for key, value in (about or {}).items()})
    with replace_whole(path) as beside:
        parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=schema), beside)


def write_histories(path: FilePath, source: FilePath) -> None:
    """Write the histories of a histories.h5: a row a sample, or a load step of a coupon.

    Columns have the name of the dataset and the unit, such as `velocity_m_s`, `energy_shear_J` and, of the first ply,
    `ply_1_push_N`. Left out is what has times of its own: yarns and edges of [history], an elastic projectile.

    Raises
    ------
    InputError : `source` is not a histories.h5 of an impact or a coupon
    ImportError : as `write`
    """
    columns = {}
    with read_hdf5(source, *MEANINGS) as file:
        known = MEANINGS[file.attrs["format"]]
        for group, prefix in _GROUPS.items():
            for name, data in file.get(group, {}).items():
                unit = data.attrs["unit"]
                meaning = next(key.meaning for key in known if fnmatch(f"{group}/{name}", key.name))
                whole = data[()]
                for number, values in enumerate(whole.T if whole.ndim > 1 else [whole], 1):
                    words = f"{prefix.format(number)}{name}{'' if unit == '1' else f' {unit}'}"
                    columns[re.sub(r"\W+", "_", words)] = Column(values, unit, meaning)
        about = {name: plain(value) for name, value in file.attrs.items()}
    columns = {name: columns[name] for name in sorted(columns, key=lambda name: name != "time_s")}
    write(path, columns, about)
