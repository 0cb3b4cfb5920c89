"""What a user may ask of a crossover mesh: each choice checked, and turned into numbers."""

from __future__ import annotations

from math import isfinite
from numbers import Real

from fabrics.errors import InputError

YARNS = ("warp", "weft")
SIZES = {"coarse": (8, 6, 2), "medium": (16, 12, 4), "fine": (24, 18, 6)}


def one_of(key, value, allowed):
    """Raise InputError unless `value` is one of the words `allowed`."""
    if value not in allowed:
        raise InputError(key=key, value=value, allowed=" or ".join(allowed))


def size(value):
    """(nx, ny, nz), hexahedra along, across and through a quarter yarn, of a named size or of three whole numbers.

    Raises
    ------
    InputError : another name, or numbers below 2, 2 and 1
    """
    if isinstance(value, str):
        one_of("size", value, tuple(SIZES))
        return SIZES[value]
    try:
        numbers = tuple(int(n) for n in value)
        good = numbers == tuple(value) and len(numbers) == 3 and all(n >= low for n, low in zip(numbers, (2, 2, 1)))
    except (TypeError, ValueError, OverflowError):
        good = False
    if not good:
        wanted = "coarse, medium, fine or three whole numbers, at least 2 along, 2 across and 1 through"
        raise InputError(key="size", value=value, allowed=wanted)
    return numbers


def widths(weave, gap, width):
    """(warp, weft) [m] widths of the lenses; the spacing of one family is the cell length of the other.

    Parameters
    ----------
    weave : Weave
    gap : [m] between parallel yarns, from 0 to below half a spacing
    width : (warp, weft) [m] instead of a gap, at most the spacings; or None

    Raises
    ------
    InputError : a value is outside its range, or both are given
    """
    spacing = [2 * w for w in weave.w][::-1]
    if width is None:
        high = min(spacing) / 2
        if not (_number(gap) and 0 <= gap < high):
            raise InputError(key="gap", value=gap, allowed=f"from 0 to below half a spacing, {high:.4g} m")
        return [s - gap for s in spacing]
    if gap:
        raise InputError(key="gap", value=gap, allowed="0 where the widths are given")
    try:
        warp, weft = width
    except (TypeError, ValueError):
        raise InputError(key="width", value=width, allowed="two lengths, of warp and weft") from None
    for name, value, high in zip(YARNS, (warp, weft), spacing):
        if not (_number(value) and 0 < value <= high * (1 + 1e-12)):
            raise InputError(key=f"{name} width", value=value, allowed=f"above 0 and at most the spacing, {high:.4g} m")
    return [float(warp), float(weft)]


def fractions(fabric):
    """(warp, weft) initial fibre volume fractions of the fabric's solid laws, without which its yarns have no area.

    Raises
    ------
    InputError : the fabric has none
    """
    if fabric.solids is None:
        raise InputError(f"fabric {fabric.name} has no solid laws: a 3D crossover needs Vf0 of warp and weft")
    return [solid.Vf0 for solid in fabric.solids]


def _number(value):
    return isinstance(value, Real) and not isinstance(value, bool) and isfinite(value)
