"""Amounts in the sentences of messages: the same in the unit that a user writes.

Messages are below the units, which refuse in words themselves: `fabrics.base.units` gives its table and its
reader here when it is loaded (`use_units`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from fabrics.base.values import is_same

_NUMBER = r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
# what a message quotes or explains in brackets stays as it is
_ASIDE = re.compile(r"(\"[^\"]*\"|'[^']*'|\([^)]*\))")


@dataclass
class Units:
    """What is known of units.

    Parameters
    ----------
    factors : {SI unit: {unit: its factor}}
    read : (text, SI unit) to the number in that unit
    """

    factors: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    read: Callable[[Any, str], float] | None = None


_UNITS = Units()


def use_units(
    factors: Mapping[str, Mapping[str, float]], read: Callable[[Any, str], float]
) -> None:
    """Take the units that messages may speak of."""
    _UNITS.factors = factors
    _UNITS.read = read
    _amounts.cache_clear()


def in_unit_of(value: Any, text: str) -> str:
    """Return a sentence in which each amount of the dimension of `value` stands in the unit of `value` too.

    Parameters
    ----------
    value : as a user has written it, such as "20 ft"; of all else the sentence stays as it is

    Examples
    --------
    >>> in_unit_of("20 ft", 'a length of at most 5 m, such as "203 mm"')
    'a length of at most 5 m (16.4 ft), such as "203 mm"'
    """
    if not isinstance(value, str):
        return text
    own = re.fullmatch(rf"\s*{_NUMBER}\s*(\S.*)", value)
    if own is None:
        return text
    unit = own[1].strip()
    parts = _ASIDE.split(text)
    for place in range(0, len(parts), 2):
        parts[place] = _amounts().sub(lambda found: _with_unit(found, unit), parts[place])
    return "".join(parts)


def is_alike(written: Any, value: Any) -> bool:
    """Tell whether what is written may be the value, a number in SI units or the same text."""
    if is_same(written, value):
        return True
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return False
    return any(math.isclose(number, value, rel_tol=1e-9) for number in _readings(written))


def _readings(written):
    """The numbers in SI units that a text may stand for."""
    if _UNITS.read is None:
        return
    for unit in _UNITS.factors:
        with suppress(Exception):
            yield _UNITS.read(written, unit)


@cache
def _amounts():
    """A number, or two with "to" between them, and one of our units."""
    listed = {name for of in _UNITS.factors.values() for name in of if name}
    names = sorted(listed, key=len, reverse=True)
    words = "|".join(map(re.escape, names))
    return re.compile(
        rf"({_NUMBER})(?:( to | and | and at most )({_NUMBER}))? ({words})(?![\w/^*])"
    )


def _with_unit(found, unit):
    """An amount with the same in a unit behind it, if it has one of its dimension."""
    low, between, high, own = found.groups()
    if own == unit or _UNITS.read is None:
        return found[0]
    for si_unit, factors in _UNITS.factors.items():
        if own not in factors:
            continue
        # "above 0 and at most" has one end
        if between != " to " and high and float(low) == 0:
            low = ""
        # of another dimension, or no unit: pint raises many types
        with suppress(Exception):
            ratio = factors[own] / _UNITS.read(f"1 {unit}", si_unit)
            numbers = [_format(float(number) * ratio) for number in (low, high) if number]
            return f"{found[0]} ({(between or '').join(numbers)} {unit})"
    return found[0]


def _format(number):
    """Four digits, without an exponent where there are no more than eight."""
    rounded = float(f"{number:.4g}")
    return f"{rounded:.8g}"
