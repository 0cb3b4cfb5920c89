"""Frozen dataclasses that say what to do where a user sets one of their attributes."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields
from typing import Any, TypeVar

from fabrics.base.errors import nearest

Frozen = TypeVar("Frozen", bound=type)


def explain_frozen(kind: Frozen) -> Frozen:
    """Decorate a frozen dataclass: where an attribute is set or deleted, the error names it, those
    that there are, and the way to another object."""

    def refuse(owner: Any, name: str, *_: Any) -> None:
        raise FrozenInstanceError(_explain(owner, name))

    kind.__setattr__ = refuse  # type: ignore[assignment, method-assign]
    kind.__delattr__ = refuse  # type: ignore[assignment, method-assign]
    return kind


def _explain(owner, name):
    kind = type(owner).__name__
    known = [one.name for one in fields(owner) if one.init]
    if name in known:
        return (
            f"{kind}.{name} cannot be set: dataclasses.replace(..., {name}=...) returns another "
            f"{kind} with it"
        )
    if hasattr(owner, name):
        return f"{kind}.{name} cannot be set: it follows from {', '.join(known)}"
    near = nearest(name, known)
    hint = ""
    if near:
        hint = f", did you mean {near}?"
    return f"{kind} has no {name}{hint}; it has {', '.join(known)}"
