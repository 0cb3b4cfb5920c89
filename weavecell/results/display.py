"""Quantities in the units that are read: one table of SI units for tables, axes of pictures and
texts."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pandas import DataFrame

# SI unit: unit shown, factor
SHOWN = {
    "m": ("mm", 1e3),
    "s": ("µs", 1e6),
    "Pa": ("MPa", 1e-6),
    "m3": ("cm³", 1e6),
    "rad": ("°", 180 / pi),
}
MM = SHOWN["m"][1]
US = SHOWN["s"][1]
_SHARE = re.compile(
    r"strain|strength|_over_|fraction|ratio|share|error"
)  # in the names of numbers shown in %


def shown(unit: str, name: str = "") -> tuple[str, float]:
    """(unit shown, factor) of a quantity in an SI unit; a number "1" is shown in % where its name
    says it is a share.

    Examples
    --------
    >>> shown("m"), shown("1", "energy_error_max"), shown("1", "plies")
    (('mm', 1000.0), ('%', 100.0), ('', 1.0))
    """
    if name.startswith("wall"):
        return unit, 1.0  # of the computer
    if unit in ("1", "-"):
        if _SHARE.search(name):
            return ("%", 100.0)
        return ("", 1.0)
    return SHOWN.get(unit, (unit, 1.0))


def heading(label: str, unit: str, name: str = "") -> str:
    """Label of a column or an axis with the unit shown, such as "deflection [mm]"."""
    if mark := shown(unit, name or label)[0]:
        return f"{label} [{mark}]"
    return label


def number(value: Any, unit: str, name: str = "", form: str = ".4g") -> str:
    """A value, or several, in the unit shown and without it; a dash for None and what is not a
    number."""
    if np.ndim(value):
        return ", ".join(number(part, unit, name, form) for part in value)
    known = value is not None and np.isfinite(value)
    if known:
        return f"{shown(unit, name)[1] * value:{form}}"
    return "–"


def text(value: Any, unit: str, name: str = "", form: str = ".4g") -> str:
    """A value with the unit shown, such as "12.3 mm"."""
    return f"{number(value, unit, name, form)} {shown(unit, name)[0]}".rstrip()


def frame(columns: Mapping[str, tuple[str, Any]]) -> DataFrame:
    """The DataFrame of {label: (SI unit, values)} in shown units, which its headings name; texts
    and counts as is."""
    from pandas import DataFrame

    table = {}
    for label, (unit, values) in columns.items():
        if unit == "1" and np.asarray(values).dtype.kind not in "fiu":
            unit = ""  # texts, and what is true or false
        factor = shown(unit, label)[1]
        if factor != 1:
            table[heading(label, unit)] = np.asarray(values) * factor
        else:
            table[heading(label, unit)] = values
    return DataFrame(table)
