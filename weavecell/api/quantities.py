"""Arguments of the Python interface: numbers in SI units, or texts with a unit."""

from __future__ import annotations

from math import isfinite
from typing import Any

from fabrics.errors import InputError
from fabrics.units import si


def number(value: Any, unit: str, key: str) -> float:
    """A number in SI units: as it is, or of a text with a unit.

    Parameters
    ----------
    value : float [unit], or a text such as "92.5 m/s"
    unit : SI unit of the result
    key : name of the argument, for the message

    Raises
    ------
    InputError : another type, not finite, or a text with a unit of another dimension

    Examples
    --------
    >>> number("203 mm", "m", "opening"), number(0.203, "m", "opening")
    (0.203, 0.203)
    """
    if isinstance(value, str):
        return si(value, unit, key=key)
    try:
        found = float(value)
    except (TypeError, ValueError):
        found = float("nan")
    if isinstance(value, bool) or not isfinite(found):
        raise InputError(key=key, value=value, allowed=f'a number [{unit}], or a text such as "1 {unit}"')
    return found


def above_zero(value: float | str, unit: str, key: str) -> float:
    """`number`, which must be above 0."""
    result = number(value, unit, key)
    if not result > 0:
        raise InputError(key=key, value=value, allowed="above 0")
    return result
