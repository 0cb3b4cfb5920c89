"""Values that users give in Python, as the code below knows them: numbers, texts, lists and dicts."""

from __future__ import annotations

import os
from math import nan
from numbers import Real
from pathlib import Path
from typing import Any

# classes of numpy and pandas of what is missing
_MISSING = ("NAType", "NaTType", "MaskedConstant")


def plain(value: Any) -> Any:
    """Convert a value of a user to what the code knows, inside of lists, tuples and dicts too.

    Decimal, Fraction, and scalars of numpy and pandas become int or float, arrays lists, a quantity
    of pint the text that a file has, any path a Path. What stands for a missing value, such as
    pandas.NA, is NaN, which no key takes. Other values stay what they are, as do lists that hold
    themselves.

    Examples
    --------
    >>> from decimal import Decimal
    >>> plain([Decimal("2"), Decimal("0.5")]), plain({"plies": np.int64(3)})
    ([2, 0.5], {'plies': 3})
    """
    if value is None or isinstance(value, (str, bool, Path)):
        return value
    if type(value) in (dict, list, tuple):
        try:
            return _plain_parts(value)
        except RecursionError:
            return str(value)
    if type(value).__name__ in _MISSING and _is_of(value, "numpy", "pandas"):
        return nan
    if _is_of(value, "numpy", "pandas") and hasattr(value, "tolist"):
        listed = value.tolist()
        # a datetime that is none
        return nan if listed is None else listed
    if _is_of(value, "pint") and hasattr(value, "magnitude"):
        return _text_of_pint(value)
    if isinstance(value, os.PathLike):
        return _path(value)
    # a Decimal is no Real of Python
    if isinstance(value, Real) or _is_of(value, "decimal"):
        return _number(value)
    return value


def is_same(one: Any, other: Any) -> bool:
    """Say whether two values are equal; values that cannot be compared, as arrays and tables with
    others, are not."""
    try:
        return bool(one == other)
    except Exception:
        return False


def _plain_parts(value):
    if isinstance(value, dict):
        return {plain(key): plain(part) for key, part in value.items()}
    return type(value)(plain(part) for part in value)


def _is_of(value, *modules):
    """Whether a value's class is of a module, which need not be loaded to know."""
    return type(value).__module__.partition(".")[0].lstrip("_") in modules


def _text_of_pint(value):
    magnitude = plain(value.magnitude)
    if isinstance(magnitude, (int, float)):
        magnitude = repr(magnitude)
    return f"{magnitude} {value.units}".replace("dimensionless", "").rstrip()


def _path(value):
    text = os.fspath(value)
    if isinstance(text, str):
        return Path(text)
    return value


def _number(value):
    """The int or float of a number; one that is neither, such as Decimal("sNaN"), as it is."""
    if type(value) in (int, float):
        return value
    try:
        number = float(value)
    except (OverflowError, ValueError, TypeError):
        return value
    # a float that its user has as a float stays one
    if number.is_integer() and not isinstance(value, float):
        return int(number)
    return number
