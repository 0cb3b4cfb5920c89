"""Units given as text ("92.5 m/s", "1420 denier", "20 / inch"), converted to SI here and nowhere
else."""

from __future__ import annotations

import re
from functools import cache
from math import isfinite
from pathlib import Path
from typing import Any

from fabrics.base import amounts
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, nearest

# SI unit: {unit: factor to it, as pint has it to the last digit}; these are converted without
# importing pint
FACTORS = {
    "m": {"m": 1.0, "cm": 0.01, "mm": 1e-3, "um": 1e-6},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "kg": {"kg": 1.0, "g": 1e-3},
    "m/s": {"m/s": 1.0, "km/s": 1e3},
    "N": {"N": 1.0, "kN": 1e3},
    "J": {"J": 1.0},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "m^2": {"m^2": 1.0, "mm^2": 1e-6},
    "kg/m": {
        "denier": 1.111111111111111e-07,
        "den": 1.111111111111111e-07,
        "dtex": 1e-7,
        "tex": 1e-6,
    },
    "1/m": {"/ mm": 1e3, "/ cm": 100.0, "/ inch": 39.37007874015748},
    "kg/m^2": {"g/m^2": 1e-3, "g/m2": 1e-3, "gsm": 1e-3},
    "kg/m^3": {
        "kg/m^3": 1.0,
        "kg/m3": 1.0,
        "g/cm^3": 999.9999999999999,
        "g/cm3": 999.9999999999999,
    },
    "m N^(1/3)": {"m N^(1/3)": 1.0, "mm N^(1/3)": 1e-3},
    "m * N**(1/3)": {"m * N^(1/3)": 1.0, "mm * N^(1/3)": 1e-3},
    "N/(kg/m)": {"mN/tex": 1e3, "cN/dtex": 1e5, "cN/tex": 1e4, "N/tex": 1e6},
    "1/s": {"/ s": 1.0},
    "K": {"K": 1.0},
    "J/(kg K)": {"J/(kg K)": 1.0},
    "rad": {"deg": 0.017453292519943295, "rad": 1.0},
    "": {"": 1.0, "%": 0.01},
    # a number alone, which is no share: not even in %
    "1": {"": 1.0},
}
# SI unit: an example for messages; of others "1" of the unit itself
EXAMPLES = {
    "m": "0.3 mm",
    "kg/m": "1100 dtex",
    "kg/m^3": "1.44 g/cm^3",
    "kg/m^2": "200 g/m^2",
    "1/m": "8.5 / cm",
    "Pa": "90 GPa",
    "rad": "45 deg",
    "N": "220 N",
    "N/(kg/m)": "2350 mN/tex",
    "kg": "1.1 g",
    "m/s": "100 m/s",
    "s": "100 us",
    "1/s": "1000 / s",
}
_NAMES = {"N/(kg/m)": "N/tex"}
NUMBER = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
# of a unit: one digit, or a fraction of two; pint takes forever over "kg^99999999"
_EXPONENT = re.compile(
    r"(?<=[^\W\d]|\)) ?(?:\^|\*\*) ?(?:[-+]?[1-9]\b|\([-+]?[1-9](?:/[1-9])?\))(?! ?(?:\^|\*\*))"
)
# a unit as in "g/cm3" and "kg m-3", whose exponent has no mark
_PLAIN_EXPONENT = re.compile(r"(?<=[^\W\d_])(-?[1-9])\b")
_PER = re.compile(
    r"(?:per\b|1?/) *"
)  # before the first unit of "34 per inch", "8.5 / cm" and "8.5 1/cm"

# a count, as in "8.5 yarns/cm"
_YARNS = re.compile(r"(?:yarns?|ends|picks|threads|counts?) *(?=/|per\b)")
# ends in ten centimetres, as ISO 7211-2 counts them
_IN_A_LENGTH = re.compile(r"(?:1?/|per\b) *([1-9][0-9]*) *([a-z]+)")
# length of a yarn in a mass, as glass is sold: "250 yd/lb" is a linear density all the same
_OF_MASS = re.compile(r"(yd|yards?|m|km) *(?:/|per) *(lb|lbs|pound|kg|g)")
# of a strip that breaks
_FORCES = {**dict.fromkeys(("lb", "lbs", "pound", "pounds"), "lbf"), "kg": "kgf"}
# words that are no unit, or another one in pint (its "grad" is a 400th of a turn): what is meant
_MEANT = {
    "grad": "deg",
    "mps": "m/s",
}
# what data sheets write, in small letters, as a unit of pint, whose own mil is an angle
_ALIASES = {
    # ends, picks and threads per inch
    **dict.fromkeys(("epi", "ppi", "tpi"), "/ inch"),
    # the gram of a tenacity is a force
    **dict.fromkeys(("g/den", "g/denier", "gf/den", "gpd"), "gf/denier"),
    **dict.fromkeys(("mil", "mils"), "thou"),
    **dict.fromkeys(("lbm", "lbs"), "pound"),
    # million pounds a square inch
    "msi": "megapsi",
    # ounces a square yard
    **dict.fromkeys(("osy", "opsy", "oz/sqyd", "oz/sq yd", "oz/sq. yd."), "oz/yd^2"),
    **dict.fromkeys(("g/sqm", "g/sq m", "g/sq. m."), "gsm"),
}


@cache
def _registry():
    import pint

    # empty at first: a registry keeps what it knows of its own units when it is made
    registry = pint.UnitRegistry(None, cache_folder=None, on_redefinition="ignore")
    registry.load_definitions(Path(pint.__file__).with_name("default_en.txt"))
    # without dimensions 30 % would be an angle, 20 rad/s a frequency, 3 bit a strain
    for line in (
        "radian = [angle] = rad",
        "bit = [information]",
        "count = [count]",
        "absorbance_unit = [absorbed] = AU",
        "refractive_index_unit = [refracted] = RIU",
        "gsm = gram / meter ** 2",
    ):
        registry.define(line)
    return registry


def si(value: Any, unit: str, *, file: FilePath | None = None, key: str | None = None) -> float:
    """Return `value` as a float in the SI unit `unit`.

    Parameters
    ----------
    value : a text of exactly one number, with a decimal point, and one unit ("92.5 m/s"); or a
        number where `unit` is "" (dimensionless; "2.18 %" is also understood)
    unit : the SI unit of the result, as text; "" for a dimensionless quantity
    file, key : named in the error

    Raises
    ------
    InputError : not a quantity, not finite, or of another dimension
    """
    return in_one_of(value, (unit,), file=file, key=key)[0]


def in_one_of(
    value: Any, units: tuple[str, ...], *, file: FilePath | None = None, key: str | None = None
) -> tuple[float, str]:
    """Convert a value to the first of the SI `units` that it fits, as `si` does: (number, unit).

    Raises
    ------
    InputError : it converts to none of them
    """
    for unit in units:
        try:
            number = _converted(value, unit)
        except Exception:
            # pint raises many types: of the parser, of undefined units, of dimensions
            continue
        if isfinite(number):
            return number, unit
    names = " or ".join(_NAMES.get(unit, unit) for unit in units if unit != "1")
    allowed = "a number"
    if names:
        allowed = f'a text with a unit that converts to {names}, such as "{example(units[0])}"'
    raise refused(value, allowed, file=file, key=key, needs_unit=all(units), units=units)


def refused(
    value: Any,
    allowed: str | None,
    *,
    file: FilePath | None = None,
    key: str | None = None,
    needs_unit: bool = False,
    units: tuple[str, ...] = (),
) -> InputError:
    """Return the InputError of a value that is not a quantity, or of a list with one; it names a
    decimal comma, a unit that is none, or that a quantity which `needs_unit` has none.

    units : SI units of which one is wanted, for the unit that may be meant
    """
    message = decimal_comma(value)
    if message is None and needs_unit and _is_bare(value):
        message = "has no unit"
    if message is None and units:
        message = unknown_unit(value, units)
    return InputError(message, file=file, key=key, value=value, allowed=allowed)


def _is_bare(value):
    """Tell whether a value is a number alone, as a text or not."""
    if isinstance(value, str):
        return NUMBER.fullmatch(value.strip()) is not None
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def unknown_unit(value: Any, units: tuple[str, ...]) -> str | None:
    """Say of a text with a unit that is none which one of `units` may be meant; None of all else."""
    number = NUMBER.match(value.strip()) if isinstance(value, str) else None
    if number is None:
        return None
    written = value.strip()[number.end() :].strip()
    usual = [each for unit in units for each in FACTORS.get(unit, {}) if each]
    meant = _MEANT.get(written.lower())
    if meant is None:
        # a second number is another fault
        if not re.fullmatch(r"[^\W\d_][^\d,]*", written) or _is_unit(written, usual):
            return None
        of_capitals = (each for each in usual if each.lower() == written.lower())
        # letters alone tell "denier", but not "us" from "ms"
        words = [each for each in usual if len(each) > 3]
        meant = next(of_capitals, None) or nearest(written.lower(), words)
    hint = f', did you mean "{meant}"?' if meant else ""
    return f'has an unknown unit, "{written}"{hint}'


@cache
def _parses(written):
    """Tell whether a text is a unit of some quantity."""
    try:
        _parsed(_ALIASES.get(written.lower(), written))
    # pint raises many types
    except Exception:
        return False
    return True


def _is_unit(written, usual):
    """Tell whether a text is a unit, and not one of the `usual` ones but for its capitals."""
    if written in usual:
        return True
    return written.lower() not in map(str.lower, usual) and _parses(written)


def decimal_comma(value: Any) -> str | None:
    """Say what to do about a decimal comma in a text, or in one of a list; None if there is
    none."""
    if isinstance(value, (list, tuple)):
        parts = value
    else:
        parts = (value,)
    has_comma = any(
        isinstance(part, str) and re.search("[0-9],[0-9]|^ *,[0-9]", part) for part in parts
    )
    if has_comma:
        return "write a decimal point and no comma"
    return None


def example(unit: str) -> str:
    """Return an example of a quantity of this SI unit, as a user would write it."""
    return EXAMPLES.get(unit, f"1 {unit}")


def _converted(value, unit):
    """`value` in SI; ValueError, or an error of pint, if it is not a quantity of the dimension of
    `unit`."""
    if isinstance(value, (int, float)) and not isinstance(value, bool) and unit in ("", "1"):
        return float(value)
    if not isinstance(value, str):
        raise ValueError("no text")
    text = value.strip()
    number = NUMBER.match(text)
    if number is None:
        raise ValueError("no number")
    written = text[number.end() :].lstrip()
    if unit == "kg/m" and _OF_MASS.fullmatch(written):
        return 1 / (float(number[0]) * _factor(written, "m/kg"))
    return float(number[0]) * _factor(written, unit)


@cache
def _factor(written, unit):
    """SI value of one of the unit that is `written`."""
    written = _ALIASES.get(written.lower(), written)
    if written.lower() in _MEANT or (unit == "1" and written):
        raise ValueError("no unit, or one of a number alone")
    if not written and unit not in ("", "1"):
        raise ValueError("a number alone")
    if unit == "1/m":
        written = _YARNS.sub("", written, count=1)
        length = _IN_A_LENGTH.fullmatch(written)
        if length:
            return _factor(f"/ {length[2]}", unit) / int(length[1])
    if unit == "N/m":
        return _force_over_width(written)
    factor = FACTORS.get(unit, {}).get(written)
    if factor is None:
        return _factor_by_pint(written, unit)
    return factor


def _force_over_width(written):
    """The factor of a strip's strength: "N/5cm", "daN / 50 mm" and "lb/in", whose pound is a force."""
    over = re.fullmatch(r"(\w+) ?(?:/|per) ?([0-9]+)? ?(\w+)", written)
    if over is None:
        return _factor_by_pint(written, "N/m")
    force = _FORCES.get(over[1].lower(), over[1])
    return _factor_by_pint(f"{force}/{over[3]}", "N/m") / int(over[2] or 1)


def _parsed(written):
    """Return (registry of pint, unit that is written); an error of many types if it is none."""
    text = _PLAIN_EXPONENT.sub(r"^\1", written)
    per = _PER.match(text)
    if per:
        text = text[per.end() :]
    if re.search(r"[0-9,.]|\([^)]*\(", _EXPONENT.sub("", text)):
        raise ValueError("more than one number, or brackets in brackets")
    registry = _registry()
    return registry, registry.parse_units(("1/" if per else "") + text.replace("%", " percent"))


def _factor_by_pint(written, unit):
    """Return the same by pint, to which nothing but the unit goes: digits stand in exponents
    alone."""
    registry, parsed = _parsed(written)
    none, one = (
        float(registry.Quantity(number, parsed).to(unit or "dimensionless").magnitude)
        for number in (0.0, 1.0)
    )
    # 20 degC is not 20 times 1 degC, nor 20 dB 20 times 1 dB
    if none != 0:
        raise ValueError("no unit that numbers are multiplied by")
    return one


amounts.use_units(FACTORS, si)
