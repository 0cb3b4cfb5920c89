"""The options of a mesh, checked and converted to numbers."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, isfinite
from numbers import Real
from typing import Any, TypeAlias, TypedDict

import numpy as np

from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.weave import Weave
from meshing.conforming import YarnSection
from meshing.mesh_file import MeshFile

YARNS = ("warp", "weft")
TIP_THICKNESS_RATIO = 0.075
Size: TypeAlias = str | float | Sequence[int] | MeshFile
AUTO_LAYERS = 2
AUTO_ASPECT = 1.5
FACE_SAMPLES = 400
SIZES = {"coarse": (8, 6, 2), "medium": (16, 12, 4), "fine": (24, 18, 6)}


class MeshOptions(TypedDict, total=False):
    """Options of a crossover and of a patch, besides size and extent.

    section : "sine", "ellipse", "conforming" (`meshing.conforming`), or None for the fabric's
    gap : [m] between parallel yarns; the widths are the spacings less the gap
    width : (warp, weft) [m] instead of a gap; these widths are kept whatever the overlap
        (conforming: not exceeded)
    tip_thickness_ratio : [-] thickness of the cut tips over that of the middle
    overlap : "solve" or "refuse" an overlap too large for a shift (`meshing.section_fit`)
    crimp : "hand" measured, "micrograph" (thesis Tables 2-1 and A-2), or (warp, weft) [-]
    end_shells : [m] thickness of shells on the yarn ends (thesis Figure A-8), or None
    """

    section: str | None
    gap: float
    width: Sequence[float] | None
    tip_thickness_ratio: float
    overlap: str
    crimp: str | Sequence[float]
    end_shells: float | None


def one_of(key: str, value: Any, allowed: Sequence[str]) -> None:
    """Raise InputError unless `value` is one of the words `allowed`."""
    if value not in allowed:
        raise InputError(key=key, value=value, allowed=" or ".join(allowed))


def size(value: Any, weave: Weave, sections: Sequence[YarnSection]) -> tuple[int, int, int]:
    """Choose (nx, ny, nz), hexahedra along, across and through a quarter yarn.

    Parameters
    ----------
    value : "coarse", "medium", "fine"; three whole numbers; an edge length [m]; or "auto": two
        layers, and edges along and across of 1.5 times the height of an element in the middle of
        the thinner section
    weave : Weave
    sections : (Section, Section)

    Raises
    ------
    InputError : another name, numbers below 2, 2 and 1, or a length that is not above 0 and at most
        half a cell
    """
    if isinstance(value, str):
        one_of("size", value, (*SIZES, "auto"))
        if value != "auto":
            return SIZES[value]
        height = min(section.thickness for section in sections) / AUTO_LAYERS
        return (*_parts(AUTO_ASPECT * height, weave, sections), AUTO_LAYERS)
    if _number(value) and 0 < value <= min(weave.w):
        layers = max(section.thickness for section in sections) / value
        return (*_parts(value, weave, sections), max(1, _ceil(layers)))
    numbers = _whole_numbers(value, (2, 2, 1))
    if numbers is None:
        wanted = (
            f"coarse, medium, fine, auto, an edge length up to {min(weave.w):.4g} m, or "
            "three whole numbers, at least 2 along, 2 across and 1 through"
        )
        raise InputError(key="size", value=value, allowed=wanted)
    nx, ny, nz = numbers
    return nx, ny, nz


def _whole_numbers(value, least):
    """As many whole numbers as there are in `least`, none of them below it; None where they are not."""
    try:
        numbers = tuple(int(n) for n in value)
        if numbers != tuple(value) or len(numbers) != len(least):
            return None
    except (TypeError, ValueError, OverflowError):
        return None
    return numbers if np.all(np.asarray(numbers) >= least) else None


def _parts(length, weave, sections):
    """Elements along and across whose edges are at most `length` in both yarns, at least 2.

    Edges are equal steps along the fibre and along the faces of the section.
    """
    fibre = max(weave.S0) / 2
    face = max(_face_length(section) for section in sections)
    return [max(2, _ceil(edge / length)) for edge in (fibre, face)]


def _face_length(section):
    """[m] of one face of a section from its middle to its cut."""
    y = section.stations(FACE_SAMPLES)
    return np.hypot(np.diff(y), np.diff(section.half_thickness(y))).sum()


def _ceil(ratio):
    return ceil(ratio - 1e-9)  # a length that divides the cell is not spoilt by rounding


def counts(value: Sequence[int]) -> tuple[int, int]:
    """Read (n, m) whole numbers of warp and weft yarns, at least 1 each.

    Raises
    ------
    InputError : they are not
    """
    numbers = _whole_numbers(value, (1, 1))
    if numbers is None:
        allowed = "two whole numbers from 1, of warp and of weft yarns"
        raise InputError(key="count", value=value, allowed=allowed)
    warp, weft = numbers
    return warp, weft


def crimped(fabric: Fabric, crimp: str | Sequence[float]) -> Fabric:
    """Return the fabric with its crimp measured by hand, read from micrographs (thesis Tables 2-1
    and A-2), or given.

    The crossover of S-720 in the thesis uses both: by hand in Figure 3-7, from micrographs in Table
    A-3 (erratum E-27).

    Parameters
    ----------
    crimp : "hand", "micrograph", or (warp, weft) [-]

    Raises
    ------
    InputError : another word, the fabric has no micrographs, or a crimp that is no fraction from 0
        to below 1
    """
    if not isinstance(crimp, str):
        return fabric.with_yarns(crimp=_two("crimp", crimp, "two fractions, of warp and weft"))
    one_of("crimp", crimp, ("hand", "micrograph"))
    if crimp == "hand":
        return fabric
    if any(name not in fabric.micrograph for name in YARNS):
        raise InputError(
            f"fabric {fabric.name} has no micrographs of warp and weft: its crimp is that measured by hand"
        )
    return fabric.with_yarns(crimp=[fabric.micrograph[name]["crimp"] for name in YARNS])


def _two(key, value, allowed):
    """The two numbers of a pair."""
    try:
        warp, weft = map(float, value)
    except (TypeError, ValueError):
        raise InputError(key=key, value=value, allowed=allowed) from None
    return warp, weft


def thickness(key: str, value: float | None) -> None:
    """Raise InputError unless `value` is None or a positive length."""
    if value is not None and not (_number(value) and value > 0):
        raise InputError(key=key, value=value, allowed="a positive thickness in m, or none")


def widths(fabric: Fabric, gap: float, width: Sequence[float] | None) -> list[float]:
    """Choose the widths (warp, weft) [m] of the lenses; the spacing of one family is the cell
    length of the other.

    Without gap and width they are those of the fabric's yarns where known, else the spacings.

    Parameters
    ----------
    fabric : Fabric
    gap : [m] between parallel yarns, from 0 to below half a spacing
    width : (warp, weft) [m] instead of a gap, at most the spacings; or None

    Raises
    ------
    InputError : a value is outside its range, or both are given
    """
    spacing = [2 * w for w in fabric.weave.w][::-1]
    if width is None:
        high = min(spacing) / 2
        if not (_number(gap) and 0 <= gap < high):
            raise InputError(
                key="gap", value=gap, allowed=f"from 0 to below half a spacing, {high:.4g} m"
            )
        if gap:
            return [s - gap for s in spacing]
        known = [np.inf if width is None else width for width in fabric.yarn_width]
        return [min(s, width) for s, width in zip(spacing, known)]
    if gap:
        raise InputError(key="gap", value=gap, allowed="0 if the widths are given")
    warp, weft = _two("width", width, "two lengths, of warp and weft")
    for name, value, high in zip(YARNS, (warp, weft), spacing):
        if not (_number(value) and 0 < value <= high * (1 + 1e-12)):
            raise InputError(
                key=f"{name} width",
                value=value,
                allowed=f"above 0 and at most the spacing, {high:.4g} m",
            )
    return [warp, weft]


def fractions(fabric: Fabric) -> list[float]:
    """Return the (warp, weft) initial fibre volume fractions of the fabric's solid laws, without
    which its yarns have no area.

    Raises
    ------
    InputError : the fabric has none
    """
    if fabric.solid_laws is None:
        raise InputError(
            f"fabric {fabric.name} has no solid laws: a 3D crossover needs Vf0 of warp and weft"
        )
    return [solid.Vf0 for solid in fabric.solid_laws]


def _number(value):
    return isinstance(value, Real) and not isinstance(value, bool) and isfinite(value)
