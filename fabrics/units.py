"""Units given as text ("92.5 m/s", "1420 denier", "20 / inch"), converted to SI here and nowhere else."""

from __future__ import annotations

from functools import cache
from math import isfinite
from typing import Any

from fabrics.checks import FilePath
from fabrics.errors import InputError


@cache
def _registry():
    import pint

    registry = pint.UnitRegistry(cache_folder=None)
    registry.define("tpi = 1 / inch")
    return registry


def si(value: Any, unit: str, *, file: FilePath | None = None, key: str | None = None) -> float:
    """Return `value` as a float in the SI unit `unit`.

    Parameters
    ----------
    value : a text with a unit ("92.5 m/s"), or a number where `unit` is "" (dimensionless; "2.18 %" is also understood)
    unit : the SI unit of the result, as text; "" for a dimensionless quantity
    file, key : named in the error

    Raises
    ------
    InputError : not a quantity, not finite, or of another dimension
    """
    allowed = f'a text with a unit that converts to {unit}, such as "1 {unit}"' if unit else "a number"
    bad = InputError(file=file, key=key, value=value, allowed=allowed)
    if isinstance(value, bool):
        raise bad
    if isinstance(value, (int, float)):
        if unit:
            raise bad
        number = float(value)
    else:
        number = _convert(value, unit, bad)
    if not isfinite(number):
        raise bad
    return number


@cache
def _convert_text(text, unit):
    registry = _registry()
    return float(registry.Quantity(text.replace("%", " percent")).to(unit or "dimensionless").magnitude)


def _convert(value, unit, bad):
    if not isinstance(value, str):
        raise bad
    try:
        return _convert_text(value, unit)
    except Exception as problem:  # pint raises many types: parse, undefined unit, dimension
        raise bad from problem
