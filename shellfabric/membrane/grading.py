"""Graded panels: small elements about the impact point, longer ones further away (docs/theory-panel.md,
"Graded meshes").

A grading is a sequence of (until, side): up to `until` crossovers from the impact point elements are
`side` crossovers long, a whole number or one over a whole number. The last `until` is infinite. Each
zone but the last goes on until the rest can be filled with whole elements of the next. Lines are alike
along warp and weft, so that elements conform everywhere. Waves shorter than about eight of the longer
elements do not pass where zones meet.

Lines at whole crossovers are the axes of yarns: of one yarn each where elements are shorter than a
crossover, of all the yarns that the line stands for where they are longer.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from shellfabric.jit.aligned import aligned_zeros

MOST_LINES = 16  # elements along a crossover, at most
_SNAP = 0.01 + 1e-9  # relative distance of a side from 1/n at which it is 1/n: 0.33 is 1/3


def exact(side: float) -> Fraction:
    """Convert a side [crossovers] to a fraction, if it is a whole number or within 1 % of one over
    a whole number.

    Raises
    ------
    InputError : any other side
    """
    value = float(side)
    if 1 <= value <= 64 and value == int(value):
        return Fraction(int(value))
    if 0 < value < 1:
        n = round(1 / value)
    else:
        n = 0
    if not (2 <= n <= MOST_LINES and abs(value * n - 1) <= _SNAP):
        allowed = f"sides of 1, 2, ... 64 crossovers, or 1/2, 1/3, ... 1/{MOST_LINES} of one"
        raise InputError(key="grading", value=side, allowed=allowed)
    return Fraction(1, n)


def check(grading: Any) -> None:
    """Raise an InputError if a grading is none.

    Parameters
    ----------
    grading : ((until, side), ...) [crossovers]
    """
    allowed = "zones (until, side) in crossovers, the last until inf, such as [[8, 0.5], [16, 1], [inf, 2]]"
    try:
        zones = [(float(until), float(side)) for until, side in grading]
    except (TypeError, ValueError):
        raise InputError(key="grading", value=grading, allowed=allowed) from None
    if not zones or zones[-1][0] != inf:
        raise InputError(key="grading", value=grading, allowed=allowed)
    ends = [0.0, *(until for until, _ in zones)]
    if not all(a < b for a, b in pairwise(ends)):
        raise InputError(
            key="grading", value=grading, allowed="zones further and further from the impact point"
        )
    sides = [exact(side) for _, side in zones]
    if any(after % before for before, after in pairwise(sides)):
        raise InputError(
            key="grading", value=grading, allowed="sides each a multiple of that before it"
        )


def sides(grading: Sequence[tuple[float, float]], length: float) -> FloatArray:
    """Lay out the sides (n,) [crossovers] of the elements from the impact point out to `length`.

    Zones are laid out over the whole crossovers of the length. Elements like the last one fill what
    remains, and the last is as much longer as is needed to end at `length`.
    """
    zones = [(until, exact(side)) for until, side in grading]
    found = []
    at = Fraction(0)
    whole = Fraction(int(length + 1e-9))
    whole -= whole % zones[0][1]
    for (until, side), after in zip(zones, (*zones[1:], None)):
        while (at < until and at < whole) or (after is not None and (whole - at) % after[1]):
            found.append(side)
            at += side
    more = int((length - at) / found[-1] + 1e-9)
    found += more * [found[-1]]
    filled = np.array(found, float)
    filled[-1] += length - filled.sum()
    return filled


def with_line_at(sides: FloatArray, place: float) -> FloatArray:
    """Move the grid line inside of `place`, seen from the middle of the grid, out to it, and return
    the sides of the elements.

    Parameters
    ----------
    sides : (2 n,) [m] of which the middle is at 0
    place : [m] within the grid
    """
    if place < 0:
        return with_line_at(sides[::-1], -place)[::-1]
    lines = np.insert(np.cumsum(sides), 0, 0.0) - sides[: sides.size // 2].sum()
    lines[np.flatnonzero(lines <= place + 1e-9 * sides.min())[-1]] = place
    return np.diff(lines)


def nearest_yarns(places: ArrayLike, lines_per_crossover: int) -> tuple[IntArray, IntArray]:
    """Find which lines of the grid are axes of yarns, and which yarn is nearest to each line.

    Parameters
    ----------
    places : (lines,) [sides of the smallest element] of the lines at rest, whole numbers, 0 at the
        impact point
    lines_per_crossover : elements along a crossover where they are smallest

    Returns
    -------
    axes : (yarns,) numbers of the lines at whole crossovers
    yarns : (lines,) number of the yarn whose axis is nearest; of two that are as near, that nearer
        the impact point
    """
    at = np.asarray(places, np.int64)
    axes = np.flatnonzero(at % lines_per_crossover == 0)
    inwards = np.abs(at[axes]) / (1 + 2 * np.abs(at).max())
    return axes, np.argmin(np.abs(at[:, None] - at[axes]) + inwards, axis=1)


def weakest(factors: ArrayLike, places: ArrayLike, middle: int) -> FloatArray:
    """Find the strength factor (axes,) of the line at each axis: that of the weakest yarn that the
    line stands for.

    A line stands for the yarns up to halfway to its neighbours, and a yarn halfway belongs to both.
    Those between a last line and the end of `factors` belong to no line. A line that lies beyond
    the edge, in the clamp, has the strength of the yarn next to it.

    Parameters
    ----------
    factors : (yarns,) [-] of the yarns at whole crossovers, from edge to edge
    places : (axes,) [crossovers] of the axes, whole numbers that rise; 0 at the impact point
    middle : number of the yarn at the impact point
    """
    given = np.asarray(factors, float)
    at = np.asarray(places, np.int64) + middle
    halves = 0.5 * np.diff(at)
    low = np.ceil(at - np.insert(halves, 0, 0.0)).astype(int).clip(0, given.size - 1)
    high = np.floor(at + np.append(halves, 0.0)).astype(int).clip(0, given.size - 1)
    return np.array([given[a : b + 1].min() for a, b in zip(low, high)])


def tributary(sides: FloatArray) -> FloatArray:
    """Compute half of the elements on either side of each line, (n+1,)."""
    return 0.5 * (np.append(sides, 0.0) + np.insert(sides, 0, 0.0))


def edge_areas(warp_sides: FloatArray, weft_sides: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute (warp, weft) each (ni+1, nj+1) [m2] length of an edge times the width that its line
    stands for."""
    warp, weft = np.zeros((2, warp_sides.size + 1, weft_sides.size + 1))
    warp[:-1] = np.multiply.outer(warp_sides, tributary(weft_sides))
    weft[:, :-1] = np.multiply.outer(tributary(warp_sides), weft_sides)
    return warp, weft


def split(sides: FloatArray) -> FloatArray:
    """Compute the share (n+1,) [-] of the element before each line in the two beside it; one half
    at the ends."""
    before = np.insert(sides, 0, sides[0])
    behind = np.append(sides, sides[-1])
    return before / (before + behind)


def slots(
    sides: tuple[FloatArray, ...],
    finest: tuple[float, ...],
    thickness: float,
    viscosity: Sequence[float],
) -> dict[str, FloatArray]:
    """Compute what is a float of a plain panel and changes from slot to slot of a graded one: {name
    of Constants: (slots,)}.

    The viscosity grows with the element, so that its highest mode is damped by the same ratio
    everywhere.

    Parameters
    ----------
    sides : ((ni,), (nj,)) [m]
    finest : (dx, dy) [m] sides of the smallest element
    thickness : [m] of the fabric
    viscosity : (warp, weft) [N] of the smallest element
    """
    a, b = sides
    dx, dy = finest
    cv1, cv2 = viscosity
    ni = a.size
    nj = b.size

    def spread(row, column, factor=1.0):
        grid = np.multiply.outer(np.append(row, row[-1:]), np.append(column, column[-1:]))
        grid = grid[: ni + 1, : nj + 1]
        # kernels load eight slots at a time, beyond the last one too
        flat = aligned_zeros(1, (ni + 2) * (nj + 1) + 32)[0]
        flat[:] = factor * grid[0, 0]
        flat[: grid.size] = factor * grid.ravel()
        return flat

    rows = np.ones(ni + 1)
    columns = np.ones(nj + 1)
    return {
        "inv_dx": spread(1 / a, columns),
        "inv_dy": spread(rows, 1 / b),
        "trellis_volume": spread(a, b, thickness),
        "cv1": spread(a / dx, columns, cv1),
        "cv2": spread(rows, b / dy, cv2),
        "mean_weight1": spread(split(a), columns),
        "mean_weight2": spread(rows, split(b)),
    }


def bending(
    sides: Sequence[FloatArray],
    yarns: Sequence[float],
    stiffness: Sequence[float],
) -> tuple[FloatArray, ...]:
    """Compute (warp, weft) what `bending_kernels` has for each slot: n EI / L [J] of each node, L
    the mean of its two segments.

    Parameters
    ----------
    sides : ((ni,), (nj,)) [m]
    yarns : (warp, weft) [1/m] yarns per length
    stiffness : (warp, weft) [N m2] EI of a yarn
    """
    found = []
    for family, (count, EI) in enumerate(zip(yarns, stiffness)):
        own = sides[family]
        other = sides[1 - family]
        length = 0.5 * (np.append(own, own[-1]) + np.insert(own, 0, own[0]))
        grid = EI * np.multiply.outer(1 / length, count * tributary(other))
        flat = aligned_zeros(1, (sides[0].size + 2) * (sides[1].size + 1) + 32)[0]
        if family == 1:
            grid = grid.T
        flat[: grid.size] = grid.ravel()
        found.append(flat)
    return tuple(found)
