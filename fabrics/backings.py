"""Backings by name: modelling clay and ballistic gelatine (`backings.toml`).

An entry holds keys of the table [backing] of an input file as they would be written there ("0.1
MPa"; a number where there is no unit), each with its source and status.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import unknown_name
from fabrics.base.files import read_data
from fabrics.materials import Isotropic, of_table, plain, read_table

_FILE = Path(__file__).with_name("backings.toml")


@cache
def _data():
    return read_data(_FILE)["backing"]


def list_names() -> tuple[str, ...]:
    """Return the names of the backings, in the order of the file."""
    return tuple(_data())


def entry(
    name: str, *, file: FilePath | None = None, key: str = "material"
) -> Mapping[str, Mapping[str, str]]:
    """Look up a backing: {key: value, source and status}.

    Raises
    ------
    InputError : an unknown name; one line with the `file` and `key` that it is read from, and the
        names there are
    """
    if name not in list_names():
        raise unknown_name("backing", name, list_names(), file=file, key=key)
    return _data()[name]


def table(
    name: str,
    given: Mapping[str, Any] | None = None,
    *,
    file: FilePath | None = None,
    key: str = "material",
) -> dict[str, Any]:
    """Return the table [backing] of a backing: its name and data, with the keys in `given` in their
    place.

    Raises
    ------
    InputError : as `entry`
    """
    data: dict[str, Any] = {"material": name}
    for constant, row in entry(name, file=file, key=key).items():
        data[constant] = plain(row["value"])
    return data | dict(given or {})


def load(name: str) -> Isotropic:
    """Return the material of a backing.

    Raises
    ------
    InputError : an unknown name
    """
    return of_table(entry(name), _FILE)


def assumed_line(name: str, block: Isotropic) -> str:
    """Write the line that names the assumed constants of a block, of a backing or of "" (the
    thesis)."""
    if name:
        data = entry(name)
    else:
        data = read_table("backing")
    own = of_table(data, _FILE)
    kept = []
    for key, row in data.items():
        if row["status"] == "assumed" and getattr(block, key) == getattr(own, key):
            kept.append(key)
    constants = ", ".join(f"{key} {data[key]['value']}" for key in kept)
    return f"assumed: {constants or 'nothing'}, of the block of {name or 'the thesis'}"
