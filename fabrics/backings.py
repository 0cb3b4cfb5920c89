"""Backings by name: modelling clay and ballistic gelatine (`backings.toml`).

`TABLES` has keys of the table [backing] of an input file as they would be written there ("0.1
MPa"; a number where there is no unit), each with its source and status.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.sourced import SourcedTables, assumed_of, plain
from fabrics.materials import UNITS, Isotropic, of_table, read_table

_FILE = Path(__file__).with_name("backings.toml")

TABLES = SourcedTables(_FILE, "backing", UNITS)
list_names = TABLES.list_names
entry = TABLES.entry


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
    InputError : an unknown name
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
    return Isotropic(**TABLES.values(name, key="material"))


def assumed_line(name: str, block: Isotropic) -> str:
    """Write the line that names the assumed constants of a block, of a backing or of "" (the
    thesis)."""
    if name:
        data = entry(name)
    else:
        data = read_table("backing")
    own = of_table(data, _FILE)
    kept = []
    for key in assumed_of(data):
        if getattr(block, key) == getattr(own, key):
            kept.append(key)
    constants = ", ".join(f"{key} {data[key]['value']}" for key in kept)
    return f"assumed: {constants or 'nothing'}, of the block of {name or 'the thesis'}"
