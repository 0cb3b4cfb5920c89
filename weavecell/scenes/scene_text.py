"""Text of an input file, written from the tables of keywords."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from fabrics.base.schema import MayBeObject, mark


def text(table: Mapping[str, Any], fabric: object) -> str:
    """Write the input file of a table of `scene`; "" if it has objects in it, or `fabric` is one,
    which no file can hold.

    Parameters
    ----------
    fabric : its name or the whole path of its file
    """
    import tomlkit

    from weavecell.scenes.impact import Scene

    if not isinstance(fabric, (str, Path)) or _has_object(table):
        return ""
    if str(fabric).endswith(".toml"):
        named = {"file": str(fabric)}
    else:
        named = {"name": str(fabric)}
    rest = {key: value for key, value in table["fabric"].items() if key != "name"}
    content = {}
    for key, value in {**table, "fabric": named | rest}.items():
        if written := _text(value, Scene.model_fields[key]):
            content[key] = written
    return tomlkit.dumps(content)


def _has_object(table):
    """Return whether a table of `scene` has an object, which no file can hold."""
    from weavecell.scenes.impact import Scene

    for name in table:
        for key, field in fields_of(Scene, name).items():
            value = table[name].get(key, "")
            if mark(field, MayBeObject) and not isinstance(value, (str, dict)):
                return True
    return False


@cache
def fields_of(model: Any, name: str) -> dict[str, Any]:
    """Return {key: field} of the table `name` of an input file."""
    return _fields(model.model_fields[name])


def _fields(entry):
    from fabrics.base.schema import tables_in

    fields = {}
    for table in tables_in(entry.annotation):
        fields |= table.model_fields
    return fields


def _text(value, entry):
    """A value of the field `entry` as it stands in a file: a number that is a quantity with the
    unit of its key."""
    from fabrics.base.schema import unit_of

    if isinstance(value, dict):
        fields = _fields(entry)
        # numbers of parts that installed packages add are of no table
        return {key: _text(part, fields.get(key, entry)) for key, part in value.items()}
    if isinstance(value, list):
        return [_text(part, entry) for part in value]
    unit = unit_of(entry)
    if unit is None or isinstance(value, (bool, str)):
        return value
    if unit == "1":
        return repr(value)
    return f"{value!r} {unit}"
