"""A set-up with other values of keys of the input file: `sweep` of a set-up made in Python.

Keys reach the solver under their names: as fields of `ImpactSetup`, or of the object that it has for
a table, such as `projectile.mass`. A value is read by the declaration of its key, as in a file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Union, get_args, get_origin, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError

from fabrics.base.errors import InputError
from fabrics.base.schema import PYTHON, entries
from weavecell.scenes.impact import Scene

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup


def vary_setup(setup: ImpactSetup, changes: Mapping[str, Any]) -> ImpactSetup:
    """Return a set-up with the values of some keys of the input file in place of its own.

    Parameters
    ----------
    changes : {dotted key: value as in a file, or a number in SI units}

    Raises
    ------
    InputError : no such key, a wrong value, or a key that no number of a set-up follows from alone,
        such as the material of the projectile
    """
    for key, written in changes.items():
        path = _find_field(setup, key, written)
        setup = _replaced(setup, path, _read(key, written), key, written)
    return setup


def read_key(setup: ImpactSetup, key: str) -> Any:
    """Return what a set-up has for a key that `vary_setup` changes."""
    value: Any = setup
    for name in _find_field(setup, key, None):
        value = getattr(value, name)
    return value


def _find_field(setup, key, written):
    """The names of the attributes that lead to what a key sets."""
    *tables, name = key.split(".")
    if name in _names(setup):
        return [name]
    owner = getattr(setup, tables[-1], None) if tables else None
    if owner is not None and name in _names(owner):
        return [tables[-1], name]
    allowed = (
        "left out of a sweep over a set-up, whose numbers do not follow from it alone: "
        "give an input file, or a list of set-ups"
    )
    raise InputError(key=key, value=written, allowed=allowed)


def _names(owner):
    if not is_dataclass(owner):
        return []
    return [one.name for one in fields(owner) if one.init]


def _read(key, written):
    """The value of a key in SI units.

    Raises
    ------
    InputError : no key of the input file, or a wrong value
    """
    field = entries(Scene)[key]
    declared: Any = Annotated[(field.annotation, *field.metadata)]
    try:
        return TypeAdapter(declared, config=ConfigDict(strict=True)).validate_python(
            written, context=PYTHON
        )
    except ValidationError:
        raise InputError(key=key, value=written, allowed=field.description) from None


def _replaced(owner, path, value, key, written):
    """The object with a value in place of that at the end of a path."""
    name, *rest = path
    if rest:
        inner = _replaced(getattr(owner, name), rest, value, key, written)
        return replace(owner, **{name: inner})
    if not _fits(value, get_type_hints(type(owner))[name]):
        allowed = (
            "left out of a sweep over a set-up, which has an object there: "
            "give an input file, or a list of set-ups"
        )
        raise InputError(key=key, value=written, allowed=allowed)
    return replace(owner, **{name: value})


def _fits(value, hint):
    """Whether a number, text or tuple is what an attribute holds."""
    kinds = [hint]
    if get_origin(hint) in (Union, UnionType):
        kinds = list(get_args(hint))
    allowed = tuple(get_origin(kind) or kind for kind in kinds)
    return isinstance(value, allowed) or (isinstance(value, int) and float in allowed)
