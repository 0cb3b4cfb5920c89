"""Set-ups by name (`presets.toml`): keys that `preset` of [panel] puts in place of those not given."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import unknown_name
from fabrics.base.files import read_data


@cache
def _data():
    return read_data(Path(__file__).with_suffix(".toml"))


def list_names() -> tuple[str, ...]:
    """Return the names of the presets, in the order of the file."""
    return tuple(_data())


def fill(table: dict[str, Any], file: FilePath | None = None) -> dict[str, Any]:
    """Return the table of a scene with the keys of the preset that its [panel] names, where it does
    not give them itself; the same table if it names none.

    Parameters
    ----------
    table : as it is written
    file : named in errors

    Raises
    ------
    InputError : an unknown name
    """
    panel = table.get("panel")
    if not isinstance(panel, dict) or not isinstance(panel.get("preset"), str):
        return table
    name = panel["preset"]
    if name not in list_names():
        raise unknown_name("preset", name, list_names(), file=file, key="panel.preset")
    filled = dict(table)
    for part, keys in _data()[name].items():
        given = table.get(part, {})
        if isinstance(given, dict):
            filled[part] = keys | given
    return filled
