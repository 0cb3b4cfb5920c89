"""Arguments of the Python interface: numbers in SI units, or texts with a unit."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Mapping
from math import isfinite
from numbers import Integral
from typing import Any

from fabrics import plausible
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.units import si
from fabrics.base.values import plain


def number(value: Any, unit: str, key: str) -> float:
    """Convert a number to SI units: as it is, or from a text with a unit.

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
    value = plain(value)
    if isinstance(value, str):
        return si(value, unit, key=key)
    try:
        converted = float(value)
    except (OverflowError, TypeError, ValueError):
        converted = float("nan")
    if isinstance(value, bool) or not isfinite(converted):
        raise InputError(
            key=key, value=value, allowed=f'a number [{unit}], or a text such as "1 {unit}"'
        )
    return converted


def note(numbers: Iterable[plausible.Number], file: FilePath | None = None) -> None:
    """Log a line about each number that is not plausible.

    Parameters
    ----------
    file : that they are read from, named in errors

    Raises
    ------
    InputError : a number far outside of its range
    """
    for line in plausible.judge(numbers, file=file):
        logging.getLogger("weavecell").info(f"note: {line}")


def read_whole(value: Any, key: str, least: int) -> int:
    """Return a whole number of at least `least`.

    Raises
    ------
    InputError : anything else
    """
    number = value
    if isinstance(value, float) and value.is_integer():
        number = int(value)
    if not isinstance(number, Integral) or isinstance(value, bool) or number < least:
        raise InputError(key=key, value=value, allowed=f"a whole number of at least {least}")
    return int(number)


def read_positive(value: float | str, unit: str, key: str) -> float:
    """Convert a `number`, which must be above 0."""
    result = number(value, unit, key)
    if not result > 0:
        raise InputError(key=key, value=value, allowed="above 0")
    return result


def read_search(
    tolerance: float | str | None,
    shots: int | None,
    seed: int | None,
    *,
    usual: tuple[float | None, int],
) -> tuple[Any, int, int]:
    """Read how limits are searched and V50 fired: (tolerance [m/s], shots, seed), with what is usual of
    the first two, and the seed 1, where they are not given.

    Raises
    ------
    InputError : a tolerance that is not positive, too few shots, or no seed
    """
    from weavecell.runs import v50

    width, count = usual
    if tolerance is not None:
        width = read_positive(tolerance, "m/s", "tolerance")
    if shots is not None:
        count = read_whole(shots, "shots", v50.LEAST)
    first = 1
    if seed is not None:
        first = read_whole(seed, "seed", 0)
    return width, count, first


def numbers(value: Any, unit: str, key: str) -> list[float]:
    """Convert numbers to SI units: from a text such as "5 um, 9 um", from one number, or from
    several numbers or texts."""
    parts: Iterable[Any] = (value,)
    if isinstance(value, str):
        parts = map(str.strip, value.split(","))
    elif isinstance(value, (tuple, list)):
        parts = value
    found = [number(part, unit, key) for part in parts]
    if not found:
        raise InputError(key=key, value=value, allowed="one value or more")
    return found


def pair(value: Any, unit: str, key: str, what: str = "of warp and weft") -> tuple[float, float]:
    """Convert `numbers`, of which there may be one, for both, or two: (first, second).

    Raises
    ------
    InputError : as `number`, or more than two
    """
    values = numbers(value, unit, key)
    if len(values) > 2:
        raise InputError(
            key=key, value=value, allowed=f"one value, or two separated by a comma, {what}"
        )
    return values[0], values[-1]


def refuse_unused(options: Mapping[str, Any], where: str) -> None:
    """Refuse options that are given and would change nothing.

    Parameters
    ----------
    options : {name: value}, None of what is not given
    where : where they have no effect, in words

    Raises
    ------
    InputError
    """
    for key, value in options.items():
        if value is not None:
            allowed = f"left out {where}: it changes nothing there"
            raise InputError(key=key, value=value, allowed=allowed)


def numbered_file(key: str, text: str, counts: str, least: int) -> tuple[int, str]:
    """Return (number, file) of a text NUMBER=FILE.

    Parameters
    ----------
    key : name of the argument, for the message
    counts : what the number is of, in the plural
    least : number that is allowed

    Raises
    ------
    InputError : another form, or a smaller number

    Examples
    --------
    >>> numbered_file("pack", "4=four.csv", "plies", least=2)
    (4, 'four.csv')
    """
    found = re.fullmatch(r"\s*(\d+)\s*=\s*(.+)", str(text))
    if found is None or int(found[1]) < least:
        allowed = f"the number of {counts}, from {least}, and a file, such as 4=four.csv"
        raise InputError(key=key, value=text, allowed=allowed)
    return int(found[1]), found[2].strip()
