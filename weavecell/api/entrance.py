"""The entrance of every public function: what users give becomes what the code knows, once and here.

Numbers of any library become int or float (`fabrics.base.values`). What is none of the types that the
signature names is refused: `resume="no"` would be true, `shots=True` one shot, and `out=3` a file of
the process. A quantity, `float | str`, is refused by the function, which knows its unit. A test
walks all public functions with values of all kinds.
"""

from __future__ import annotations

import functools
import inspect
import os
import re
from collections.abc import Callable, Mapping, Sequence
from math import isnan
from typing import Any, ParamSpec, TypeVar, cast

from fabrics.base import written
from fabrics.base.errors import InputError
from fabrics.base.values import plain
from weavecell.answers.result import Result

Parameters = ParamSpec("Parameters")
Returned = TypeVar("Returned")
QUANTITY = {"float", "str"}
# what refuses a result itself, with what to do instead
_COMPUTED = "Fabric"


def public(function: Callable[Parameters, Returned]) -> Callable[Parameters, Returned]:
    """Decorate a function of the Python interface: its arguments are taken by `take`."""
    signature = inspect.signature(function)

    @functools.wraps(function)
    def called(*arguments: Any, **options: Any) -> Any:
        taken, named = take(signature, arguments, options)
        return cast(Any, function)(*taken, **named)

    called.takes = take  # type: ignore[attr-defined]
    return cast(Any, called)


def take(
    signature: inspect.Signature, arguments: Sequence[Any], options: Mapping[str, Any]
) -> tuple[list[Any], dict[str, Any]]:
    """Take the arguments and options of a user: (arguments, options) made plain.

    Raises
    ------
    InputError : one of another type than the signature says
    """
    written.forget_keywords()
    declared = {name: str(one.annotation) for name, one in signature.parameters.items()}
    taken = [plain(value) for value in arguments]
    named = {key: plain(value) for key, value in options.items()}
    refuse_others(declared, {**dict(zip(declared, taken)), **named})
    return taken, named


def refuse_others(declared: Mapping[str, str], given: Mapping[str, object]) -> None:
    """Refuse values of another type than is declared.

    Parameters
    ----------
    declared : {name: annotation}
    given : {name: value}

    Raises
    ------
    InputError
    """
    for name, value in given.items():
        kinds = _split(declared.get(name, "Any"))
        others = [kind for kind in kinds if kind != "None"]
        if value is None and "None" in kinds:
            continue
        if "Any" in kinds or set(others) == QUANTITY:
            continue
        if isinstance(value, Result) and _COMPUTED in kinds:
            continue
        if not any(_is_a(value, kind) for kind in others):
            words = " or ".join(dict.fromkeys(map(_say, others)))
            raise InputError(key=name, value=value, allowed=words)


def _split(annotation):
    """The parts of a union, which may have brackets."""
    return re.split(r" \| (?![^\[]*\])", annotation)


def _is_a(value, kind):
    """Whether a value is of a kind of a signature."""
    name, _, inside = kind.rstrip("]").partition("[")
    match name:
        case "bool":
            return isinstance(value, bool)
        case "int":
            return _is_number(value) and value % 1 == 0
        case "float":
            return _is_number(value)
        case "str":
            return isinstance(value, str)
        case "Literal":
            return isinstance(value, str) and bool(value)
        case "FilePath":
            return isinstance(value, (str, os.PathLike)) and bool(os.fspath(value))
        case "list" | "tuple" | "Sequence":
            listed = isinstance(value, (list, tuple))
            return listed and (inside != "str" or all(isinstance(one, str) for one in value))
        case "Mapping" | "Iterable":
            return hasattr(value, "__iter__") and not isinstance(value, (str, bytes))
    # an object, by its class, which need not be loaded
    return name in {one.__name__ for one in type(value).__mro__}


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and not isnan(value)


def _say(kind):
    """A kind of a signature in words."""
    name, _, inside = kind.rstrip("]").partition("[")
    words = {
        "bool": "True or False",
        "int": "a whole number",
        "float": "a number",
        "str": "a text",
        "FilePath": "a path",
        "Literal": f"one of {inside}".replace('"', ""),
        "list": "a list",
        "tuple": "a list",
        "Sequence": "a list",
        "Mapping": "a dict",
        "Iterable": "a list of set-ups",
        "ImpactSetup": "a set-up",
        "Result": "a result",
    }
    if name == "list" and inside == "str":
        return "a list of texts"
    return words.get(name, f"a {name}")
