"""Quantities in the units that are read: one table of SI units for tables, axes of pictures and
texts."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pandas import DataFrame

# unit: unit shown, factor
SHOWN = {
    "m": ("mm", 1e3),
    "fine m": ("µm", 1e6),
    "m/N": ("µm/N", 1e6),
    "m N^(1/3)": ("mm N^(1/3)", 1e3),
    "s": ("µs", 1e6),
    "Pa": ("MPa", 1e-6),
    "m3": ("cm³", 1e6),
    "rad": ("°", 180 / pi),
    "1": ("", 1.0),
    "-": ("", 1.0),
    "%": ("%", 100.0),
    "wall s": ("s", 1.0),
}
# of quantities that are not shown as other quantities in their SI unit are
_SI = {"%": "1", "wall s": "s", "fine m": "m"}
MM = SHOWN["m"][1]
US = SHOWN["s"][1]


def si_unit(unit: str) -> str:
    """Return the SI unit of the number in a file: "1" of a share, whose unit here is "%", "s"
    of the time that a computer took, whose unit here is "wall s", and "m" of a length within
    a yarn, such as a closure or a misfit, whose unit here is "fine m"."""
    return _SI.get(unit, unit)


def choose_unit(unit: str) -> tuple[str, float]:
    """Return (unit shown, factor) of a quantity: its unit alone decides, "%" of a share.

    Examples
    --------
    >>> choose_unit("m"), choose_unit("%"), choose_unit("1")
    (('mm', 1000.0), ('%', 100.0), ('', 1.0))
    """
    return SHOWN.get(unit, (unit, 1.0))


def heading(label: str, unit: str) -> str:
    """Return the label of a column or an axis with the unit shown, such as "deflection [mm]"."""
    if mark := choose_unit(unit)[0]:
        return f"{label} [{mark}]"
    return label


def number(value: Any, unit: str, form: str = ".4g") -> str:
    """Format a value, or several, in the unit shown and without it; a dash for None and what is not
    a number. Numbers below a million have no exponent."""
    if np.ndim(value):
        return ", ".join(number(part, unit, form) for part in value)
    known = value is not None and np.isfinite(value)
    if known:
        shown = f"{choose_unit(unit)[1] * value:{form}}"
        if "e+" in shown and abs(float(shown)) < 1e6:
            sign = "+" if form.startswith("+") else ""
            return f"{float(shown):{sign}.0f}"
        return shown
    return "–"


def text(value: Any, unit: str, form: str = ".4g") -> str:
    """Format a value with the unit shown, such as "12.3 mm"."""
    return f"{number(value, unit, form)} {choose_unit(unit)[0]}".rstrip()


def frame(columns: Mapping[str, tuple[str, Any]]) -> DataFrame:
    """Return the DataFrame of {label: (unit, values)} in shown units, which its headings name;
    texts and counts as is."""
    from pandas import DataFrame

    table = {}
    for label, (unit, values) in columns.items():
        if unit in ("1", "%") and np.asarray(values).dtype.kind not in "fiu":
            unit = ""  # texts, and what is true or false
        factor = choose_unit(unit)[1]
        if factor != 1:
            table[heading(label, unit)] = np.asarray(values) * factor
        else:
            table[heading(label, unit)] = values
    return DataFrame(table)
