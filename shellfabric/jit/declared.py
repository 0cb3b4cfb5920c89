"""Rows of numbers that a dataclass declares: kernels read them by the names that they have there."""

from __future__ import annotations

from math import nan
from typing import Any, get_type_hints

from fabrics.base import schema
from shellfabric.jit.table import Row, flag, integer, number

LINES = {bool: lambda unit, meaning: flag(meaning), int: integer}


class DeclaredRow(Row):
    """A row of numbers that a dataclass declares (`row_of`)."""

    @classmethod
    def of(cls, values: Any) -> Any:
        """Make the row of an object that has these numbers; None becomes NaN."""
        found = {name: getattr(values, name) for name in cls._fields}
        return cls(**{name: nan if value is None else value for name, value in found.items()})


def row_of(kind: type) -> type[DeclaredRow]:
    """Make the table of the numbers that a dataclass declares (`fabrics.base.schema.key`), a line for
    each; of one that may be None it is a floating-point number."""
    types = get_type_hints(kind)
    lines = {}
    for name, field in schema.declared(kind).items():
        line = LINES.get(types[name], number)
        lines[name] = line(schema.unit_of(field) or "-", field.title or "")
    return type(f"{kind.__name__}Row", (DeclaredRow,), {"__doc__": kind.__doc__, **lines})
