"""Types and ranges of the fields of a frozen dataclass, as its annotations and its keys say them.

`dataclasses.replace` makes an object without any door of the interface: the object checks itself then
(`check_fields`). A field that is a key of an input file too names what is declared of that key,
`end_time: Annotated[float, limits(END_TIME)]`, or is declared by `fabrics.base.schema.key`.
"""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Sequence
from functools import cache
from math import isnan
from numbers import Integral, Real
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from fabrics.base.errors import InputError
from fabrics.base.schema import PYTHON, number

_WORDS = {
    float: "a number [SI]",
    int: "a whole number",
    str: "a text",
    bool: "True or False",
    type(None): "None",
}


def limits(kind: Any) -> FieldInfo:
    """Return what is declared of a number, for a field that has its limits.

    Parameters
    ----------
    kind : what the field of a Table is annotated with, such as `quantity(...)`; of one number. A field
        that may hold a pair of them is checked one by one
    """
    return FieldInfo.from_annotation(kind)


def finite(**range_of: Any) -> FieldInfo:
    """Return the limits gt, ge, lt, le of a finite number that is no key."""
    return limits(number("", 1.0, **range_of))


def check_fields(owner: Any) -> None:
    """Refuse a field of another type than its annotation says, or outside of the limits of its key.

    Raises
    ------
    InputError : names the field and the value that it has
    """
    kind: Any = type(owner)
    for name, hint, reader, allowed in _fields(kind):
        value = getattr(owner, name)
        if not _fits(value, hint):
            raise InputError(key=name, value=value, allowed=_in_words(hint))
        if reader is None or value is None:
            continue
        if not (_reads(reader, value) or _each_reads(reader, value)):
            raise InputError(key=name, value=value, allowed=allowed)


def _reads(reader, value):
    """Tell whether the reader of a key takes a value as Python gives it."""
    try:
        reader.validate_python(value, context=PYTHON)
    except ValidationError:
        return False
    return True


def _each_reads(reader, values):
    """Tell whether it takes each of several, of a field that may hold a pair of what its key is one
    of."""
    return isinstance(values, (tuple, list)) and all(_reads(reader, each) for each in values)


@cache
def _fields(kind):
    """Return (name, annotation, reader of the key or None, what is allowed) of each field."""
    hints = get_type_hints(kind, include_extras=True)
    found = []
    for entry in dataclasses.fields(kind):
        hint = hints[entry.name]
        infos = [part for part in getattr(hint, "__metadata__", ()) if isinstance(part, FieldInfo)]
        reader = None
        allowed = ""
        for info in infos:
            reader = TypeAdapter(Annotated[info.annotation, info, *info.metadata])
            allowed = info.description or ""
        found.append((entry.name, _plain(hint), reader, allowed))
    return found


def _plain(hint):
    while get_origin(hint) is Annotated:
        hint = hint.__origin__
    return hint


def _fits(value, hint):
    """Tell whether a value is of the type that an annotation says; nan is no number."""
    hint = _plain(hint)
    parts = get_args(hint)
    origin = get_origin(hint)
    if origin in (Union, types.UnionType):
        return any(_fits(value, part) for part in parts)
    if origin is Literal:
        return value in parts
    if origin is tuple or hint is tuple:
        return isinstance(value, tuple) and _parts_fit(value, parts)
    if hint is Any:
        return True
    if hint in (float, int):
        of = Real if hint is float else Integral
        return isinstance(value, of) and not isinstance(value, bool) and not isnan(value)
    if not isinstance(origin or hint, type):
        return True
    if not isinstance(value, origin or hint):
        return False
    # nobody means a text by a sequence of numbers
    texts = isinstance(value, (str, bytes)) and hint is not str
    return not texts and (origin is not Sequence or all(_fits(each, parts[0]) for each in value))


def _parts_fit(values, parts):
    if not parts:
        return True
    if parts[-1] is Ellipsis:
        return all(_fits(each, parts[0]) for each in values)
    return len(values) == len(parts) and all(map(_fits, values, parts))


def _in_words(hint):
    """Say what an annotation allows."""
    hint = _plain(hint)
    parts = get_args(hint)
    origin = get_origin(hint)
    if origin in (Union, types.UnionType):
        return " or ".join(_in_words(part) for part in parts)
    if origin is tuple:
        inner = ", ".join(_in_words(part) for part in parts if part is not Ellipsis)
        return f"a tuple of {inner}"
    if origin is Literal:
        return " or ".join(map(repr, parts))
    return _WORDS.get(hint, f"a {getattr(hint, '__name__', hint)}")
