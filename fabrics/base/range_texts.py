"""Numbers that are given with a range: "0.15 to 0.25", "0.2 ± 0.05", "220 N ± 5 %".

± is one standard deviation; `read` cuts the distribution off at two, so that its ends are ends of a range
like those of the other form, whose value is its middle. Any text for a number of ranged keys
and of fabric files goes through here.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from fabrics.base.errors import InputError
from fabrics.base.units import NUMBER

EXAMPLE = '"0.15 to 0.25" or "0.2 ± 0.05"'
CUT_OFF = 2.0  # [standard deviations]
_FORM = re.compile(
    rf"\s*(?P<first>{NUMBER.pattern})\s*(?P<unit>[^\s±+]\S*(?: \S+)*?)??\s*(?P<sign>±|\+-|\+/-|\bto\b)\s*"
    rf"(?P<second>{NUMBER.pattern})\s*(?P<last>\S.*?)?\s*"
)


@dataclass(frozen=True)
class RangeText:
    """A range as it is written: value and ends with their unit.

    Parameters
    ----------
    value, low, high : texts
    deviations : standard deviations from value to high; 0 where any number is as likely
    """

    value: str
    low: str
    high: str
    deviations: float

    @property
    def texts(self) -> dict[str, str]:
        """{"value", "low", "high": text}, as a fabric file has them."""
        return {"value": self.value, "low": self.low, "high": self.high}


def read(text: object) -> RangeText | None:
    """Read a text; None if it is none of a range.

    Raises
    ------
    InputError : units that differ, an end that is not above the other, or a deviation that is not positive
    """
    found = _FORM.fullmatch(text) if isinstance(text, str) else None
    if found is None:
        return None
    first, second = float(found["first"]), float(found["second"])
    unit = found["unit"] or ""
    last = found["last"] or ""
    deviates = found["sign"] != "to"
    share = last == "%" and unit not in ("", "%")
    if not (share and deviates) and unit not in ("", last) and last:
        raise InputError(value=text, allowed="a range in one unit")
    if deviates and last == "%" and not unit:
        allowed = (
            f'said of which: "{first:g} % ± {second:g} %", or of a number without unit ± a number'
        )
        raise InputError(value=text, allowed=allowed)
    if share and deviates:
        second = abs(first) * second / 100
    elif last:
        unit = last
    if deviates:
        value, low, high = first, first - CUT_OFF * second, first + CUT_OFF * second
    else:
        value, low, high = 0.5 * (first + second), first, second
    if not low < high:
        raise InputError(value=text, allowed=f"a range whose ends rise, such as {EXAMPLE}")
    middle, lower, upper = (f"{number:.12g} {unit}".rstrip() for number in (value, low, high))
    return RangeText(middle, lower, upper, CUT_OFF if deviates else 0.0)


def looks_like_one(value: object) -> bool:
    """Tell whether a value is a text that is meant as a range."""
    return isinstance(value, str) and _FORM.fullmatch(value) is not None
