"""A set-up of an impact that prints in a few lines."""

from __future__ import annotations

from dataclasses import MISSING, fields, is_dataclass

from fabrics.fabric import Fabric
from shellfabric.impact.setup import ImpactSetup


class ShortSetup(ImpactSetup):
    """An `ImpactSetup` of which what differs from the defaults is printed."""

    def __repr__(self) -> str:
        lines = ",\n    ".join(_list_changes(self))
        return f"ImpactSetup(\n    {lines})"


def _list_changes(value):
    """NAME=VALUE of each field of a dataclass that has not its default."""
    shown = [(entry, getattr(value, entry.name)) for entry in fields(value) if entry.repr]
    return [
        f"{entry.name}={_text(own)}" for entry, own in shown if repr(own) != repr(_default(entry))
    ]


def _text(value):
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))})"
    if isinstance(value, float):
        return f"{value:.6g}"
    if is_dataclass(value) and not isinstance(value, Fabric):
        return f"{type(value).__name__}({', '.join(_list_changes(value))})"
    return repr(value)


def _default(entry):
    if entry.default_factory is MISSING:
        return entry.default
    return entry.default_factory()
