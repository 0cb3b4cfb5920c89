"""Units given as text ("92.5 m/s", "1420 denier", "20 / inch"), converted to SI here and nowhere else."""

from __future__ import annotations

import re
from functools import cache
from math import isfinite
from typing import Any

from fabrics.checks import FilePath
from fabrics.errors import InputError

# SI unit: {unit: factor to it, as pint has it to the last digit}; these are converted without importing pint
FACTORS = {
    "m": {"m": 1.0, "cm": 0.01, "mm": 1e-3, "um": 1e-6},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "kg": {"kg": 1.0, "g": 1e-3},
    "m/s": {"m/s": 1.0},
    "N": {"N": 1.0, "kN": 1e3},
    "J": {"J": 1.0},
    "Pa": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9},
    "kg/m": {"denier": 1.111111111111111e-07, "dtex": 1e-7, "tex": 1e-6},
    "1/m": {"/ mm": 1e3, "/ cm": 100.0, "/ inch": 39.37007874015748},
    "kg/m^2": {"g/m^2": 1e-3},
    "kg/m^3": {"kg/m^3": 1.0, "g/cm^3": 999.9999999999999},
    "m N^(1/3)": {"m N^(1/3)": 1.0, "mm N^(1/3)": 1e-3},
    "m * N**(1/3)": {"m * N^(1/3)": 1.0, "mm * N^(1/3)": 1e-3},
    "N/(kg/m)": {"mN/tex": 1e3, "cN/dtex": 1e5, "cN/tex": 1e4, "N/tex": 1e6},
    "1/s": {"/ s": 1.0},
    "rad": {"deg": 0.017453292519943295},
    "": {"": 1.0, "%": 0.01},
}
# SI unit: an example for messages; of others "1" of the unit itself
EXAMPLES = {
    "m": "0.3 mm", "kg/m": "1100 dtex", "kg/m^3": "1.44 g/cm^3", "kg/m^2": "200 g/m^2", "1/m": "8.5 / cm",
    "Pa": "90 GPa", "N": "220 N", "N/(kg/m)": "2350 mN/tex", "kg": "1.1 g", "m/s": "100 m/s", "s": "100 us",
}  # fmt: skip
_NAMES = {"N/(kg/m)": "N/tex"}
_PER_DENIER = ("g/den", "g/denier", "gf/den", "gpd")  # of a data sheet: grams as a force
_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:\d{1,15}(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)\s*(|[a-zA-Z%/].*?)\s*")


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
    allowed = (
        f'a text with a unit that converts to {_NAMES.get(unit, unit)}, such as "{example(unit)}"'
        if unit
        else "a number"
    )
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


def in_one_of(
    value: Any, units: tuple[str, ...], *, file: FilePath | None = None, key: str | None = None
) -> tuple[float, str]:
    """(number, unit) of the first of the SI `units` that the value converts to.

    Raises
    ------
    InputError : it converts to none of them
    """
    for unit in units:
        try:
            return si(value, unit, file=file, key=key), unit
        except InputError:
            if len(units) == 1:
                raise
    names = " or ".join(_NAMES.get(unit, unit) for unit in units)
    allowed = f'a text with a unit that converts to {names}, such as "{example(units[0])}"'
    raise InputError(file=file, key=key, value=value, allowed=allowed)


def example(unit: str) -> str:
    """A quantity of this SI unit, as a user would write it."""
    return EXAMPLES.get(unit, f"1 {unit}")


@cache
def _convert_text(text, unit):
    found = _NUMBER_AND_UNIT.fullmatch(text)
    if unit == "N/(kg/m)" and found and found[2] in _PER_DENIER:
        text, found = f"{found[1]} gf/denier", None
    factor = FACTORS.get(unit, {}).get(found[2]) if found else None
    return _convert_by_pint(text, unit) if factor is None else float(found[1]) * factor


def _convert_by_pint(text, unit):
    registry = _registry()
    return float(registry.Quantity(text.replace("%", " percent")).to(unit or "dimensionless").magnitude)


def _convert(value, unit, bad):
    if not isinstance(value, str):
        raise bad
    try:
        return _convert_text(value, unit)
    except Exception as problem:  # pint raises many types: parse, undefined unit, dimension
        raise bad from problem
