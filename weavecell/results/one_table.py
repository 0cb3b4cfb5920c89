"""A result as one table: a table of keys.toml says what it has, and its summary, its JSON file, its
tables and its CSV file are read off it.

A row of keys.toml is a value of the result at `path`. Rows with a dot, "shots.outcome", say what is
in the value "shots"; where they have a path, the value is a list, and they are columns of a table
with a row for each of its items.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, is_dataclass
from typing import Any

from weavecell.results import display, keys
from weavecell.results.keys import Key


def facts(result: object, table: str) -> dict[str, Any]:
    """Return {name: value} of a result in the order of the table; of a list the number of its
    items."""
    rows = keys.TABLES[table]
    lists = {key.name.partition(".")[0] for key in rows if "." in key.name and key.path}
    found: dict[str, Any] = {}
    for key in rows:
        name = key.name.partition(".")[0]
        if name in found:
            continue
        value = key.value(result) if name == key.name else getattr(result, name)
        if name in lists:
            value = len(value)
        if is_dataclass(value) and not isinstance(value, type):
            value = asdict(value)
        if value or not key.optional:
            found[name] = value
    return found


def columns(items: Sequence[object], table: str, name: str) -> dict[str, list[Any]]:
    """Return {column: values} of a list, such as shots; a pair is a column for each of its parts."""
    found: dict[str, list[Any]] = {}
    for key in _keys_of_list(table, name):
        for column, part in _split(key):
            values = [key.value(item) for item in items]
            found[column] = values if part is None else [value[part] for value in values]
    return found


def records(items: Sequence[object], table: str, name: str) -> list[dict[str, Any]]:
    """Return {key: value} of each item, for a JSON file."""
    listed = _keys_of_list(table, name)
    return [{key.name: key.value(item) for key in listed} for item in items]


def columns_of_records(
    written: Sequence[Mapping[str, Any]], table: str, name: str
) -> dict[str, list[Any]]:
    """Return the `columns` of a list that a JSON file has as `records`."""
    found: dict[str, list[Any]] = {}
    for key in _keys_of_list(table, name):
        for column, part in _split(key):
            values: list[Any] = [record.get(key.name) for record in written]
            found[column] = values if part is None else [value[part] for value in values]
    return found


def find_list(table: str) -> str | None:
    """Find the list of a table whose items are the rows of the result's table; None without one."""
    rows = keys.TABLES.get(table, ())
    return next((key.name.partition(".")[0] for key in rows if "." in key.name and key.path), None)


def csv(found: Mapping[str, Sequence[Any]], table: str, name: str, wanted: Sequence[str]) -> str:
    """Write the `wanted` of some `columns` as CSV, headings with their SI units."""
    from pandas import DataFrame

    written = {}
    named = {
        column: (key, part) for key in _keys_of_list(table, name) for column, part in _split(key)
    }
    for column in wanted:
        key, part = named[column]
        words = key.csv or keys.infer_key(column).meaning
        if part is not None:
            words = words.format(key.parts[part])
        unit = display.si_unit(key.unit)
        heading = words if unit in ("", "1") else f"{words} [{unit}]"
        written[heading] = [f"{value:{key.form}}" for value in found[column]]
    return DataFrame(written).to_csv(index=False)


def _keys_of_list(table: str, name: str) -> list[Key]:
    """The keys of the items of a list, without its name."""
    of_list = [key for key in keys.TABLES[table] if key.name.startswith(f"{name}.") and key.path]
    return [key._replace(name=key.name.removeprefix(f"{name}.")) for key in of_list]


def _split(key: Key) -> Iterator[tuple[str, int | None]]:
    """(column, number of the part) of a key in tables; peak_tension_N is peak_tension_warp_N and
    peak_tension_weft_N."""
    if not key.parts:
        yield key.name, None
    for number, part in enumerate(key.parts):
        words, _, unit = key.name.rpartition("_")
        yield f"{words}_{part}_{unit}", number
