"""A result as one table: a table of keys.toml says what it has, and its summary, its JSON file, its
table, its CSV file and what is loaded of it are read off that.

A row of keys.toml is a value of the result at `path`. Rows with a dot, "scan.above", say what is in
the value "scan". Those of "rows.", "rows.outcome", are the columns of the result's table: a column
has one name in the DataFrame, in the CSV file and in JSON. The CSV file has all digits, so that a
loaded result has the very table of the live one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, is_dataclass
from fnmatch import fnmatchcase
from functools import cache
from typing import TYPE_CHECKING, Any

from fabrics.base import files
from fabrics.base.checks import FilePath
from weavecell.results import keys
from weavecell.results.keys import Key

if TYPE_CHECKING:
    from pandas import DataFrame

ROWS = "rows."
HDF5_FORMAT = "weavecell table 1"


def facts(result: object, table: str) -> dict[str, Any]:
    """Return {name: value} of a result in the order of the table; rows are left out, and names with
    a *, which the result adds itself."""
    found: dict[str, Any] = {}
    for key in keys.TABLES[table]:
        name = key.name.partition(".")[0]
        if name in found or key.name.startswith(ROWS) or "*" in name:
            continue
        value = key.value(result) if name == key.name else getattr(result, name)
        if is_dataclass(value) and not isinstance(value, type):
            value = asdict(value)
        if value or not key.optional:
            found[name] = value
    return found


def columns(items: Any, table: str) -> dict[str, Any]:
    """Return {column: values} of the items of a result, such as its shots, or of one object that
    has arrays; a pair is a column for each of its parts."""
    found: dict[str, Any] = {}
    for key in _given(table):
        values: Any
        if isinstance(items, Sequence):
            values = [key.value(item) for item in items]
        else:
            values = key.value(items)
        if key.optional and all(value is None for value in values):
            continue
        for column, part in _split(key):
            found[column] = values if part is None else [value[part] for value in values]
    return found


def records(items: Sequence[object], table: str) -> list[dict[str, Any]]:
    """Return {key: value} of each item, for a JSON file."""
    return [{key.name: key.value(item) for key in _given(table)} for item in items]


def frame(found: Mapping[str, Any], table: str) -> DataFrame:
    """Return the DataFrame of some columns; what is missing is "" in a column of texts, else NaN."""
    from pandas import DataFrame

    made = DataFrame(dict(found))
    for name in made:
        values = made[name]
        if is_text(str(name), table):
            made[name] = values.where(values.notna(), "")
        elif values.dtype == object:
            made[name] = values.where(values.notna(), float("nan")).infer_objects()
    return made


def csv(made: DataFrame) -> str:
    """Write a table as CSV, with all digits."""
    return str(made.to_csv(index=False, lineterminator="\n"))


def read_csv(path: FilePath, table: str) -> DataFrame:
    """Read a table of a kind of result from the CSV file that `csv` wrote."""
    from pandas import read_csv

    texts = {}
    numbers = {}
    for name in read_csv(path, nrows=0):
        if is_text(name, table):
            texts[name] = str
        else:
            numbers[name] = [""]
    written = read_csv(
        path, dtype=texts, na_values=numbers, keep_default_na=False, float_precision="round_trip"
    )
    return frame({str(name): written[name] for name in written}, table)


def is_text(column: str, table: str) -> bool:
    """Tell whether a column of a table has texts."""
    key = find_column(column, table)
    return key is not None and key.unit == ""


@cache
def find_column(name: str, table: str) -> Key | None:
    """Find the key of a column of a table by its name; None of one that the table does not name."""
    for key in _of_rows(table):
        if any(fnmatchcase(name, column) for column, _ in _split(key)):
            return key
    return None


def _of_rows(table):
    """The keys of the columns of a table, without "rows."."""
    for key in keys.TABLES.get(table, ()):
        if key.name.startswith(ROWS):
            yield key._replace(name=key.name.removeprefix(ROWS))


def _given(table):
    """The columns whose values stand at a path; others the result makes itself."""
    return [key for key in _of_rows(table) if key.path]


def _split(key: Key) -> Iterator[tuple[str, int | None]]:
    """(column, number of the part) of a key in tables; peak_tension_N is peak_tension_warp_N and
    peak_tension_weft_N."""
    if not key.parts:
        yield key.name, None
    for number, part in enumerate(key.parts):
        words, _, unit = key.name.rpartition("_")
        yield f"{words}_{part}_{unit}", number


def write_hdf5(made: DataFrame, path: FilePath, table: str) -> None:
    """Write a table as HDF5, whole or not at all: a dataset a column, with its unit."""
    with files.write_hdf5(path, HDF5_FORMAT) as file:
        for name in map(str, made):
            values = made[name].to_numpy()
            if values.dtype == object:
                file.create_dataset(name, data=[str(value) for value in values])
                continue
            key = find_column(name, table)
            file.create_dataset(name, data=values).attrs["unit"] = key.si_unit if key else "1"
