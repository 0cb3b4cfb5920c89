"""Arguments of the Python interface: numbers in SI units, or texts with a unit."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.units import si

if TYPE_CHECKING:
    from fabrics.fabric import Fabric


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


def laws(fabric: Fabric, law: Any = None) -> tuple[CompressionLaw, CompressionLaw]:
    """(warp, weft) compression laws.

    Parameters
    ----------
    fabric : Fabric, whose own laws are taken where `law` is None
    law : one CompressionLaw for both families, a pair (warp, weft), the path of a law.json, an object with the
        attribute `law` such as the result of `calibrate`; None or "published" for the fabric's own

    Raises
    ------
    InputError : none of these, a law of another fabric, or None for a fabric without laws
    """
    written, law = law, getattr(law, "law", law)
    if law is None or law == "published":
        if fabric.laws is None:
            raise InputError(
                f"fabric {fabric.name} has no compression law: give law=, or use weavecell.calibrate(fabric).fabric"
            )
        return fabric.laws
    if isinstance(law, (str, Path)):
        law = CompressionLaw.from_json(law)
    warp, weft = law if isinstance(law, (tuple, list)) and len(law) == 2 else (law, law)
    for found in (warp, weft):
        if not isinstance(found, CompressionLaw):
            allowed = "a CompressionLaw, a pair (warp, weft) of them, or a law.json"
            raise InputError(key="law", value=written, allowed=allowed)
        found.require_fabric(fabric.name, key="law", value=str(written) if isinstance(written, (str, Path)) else None)
    return warp, weft


def numbers(value: Any, unit: str, key: str) -> list[float]:
    """Numbers in SI units: of a text such as "5 um, 9 um", of one number, or of several numbers or texts."""
    parts = value.split(",") if isinstance(value, str) else value if isinstance(value, (tuple, list)) else (value,)
    return [number(part.strip() if isinstance(part, str) else part, unit, key) for part in parts]


def pair(value: Any, unit: str, key: str, what: str = "of warp and weft") -> tuple[float, float]:
    """`numbers`, of which there may be one, for both, or two: (first, second).

    Raises
    ------
    InputError : as `number`, or more than two
    """
    found = numbers(value, unit, key)
    if len(found) > 2:
        raise InputError(key=key, value=value, allowed=f"one value, or two separated by a comma, {what}")
    return found[0], found[-1]
