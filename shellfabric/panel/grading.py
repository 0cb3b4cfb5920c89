"""Graded panels: elements of one crossover about the impact point, of more of them further away.

Lines of the grid are further apart the further they are from the impact point, along warp and weft alike, so that the
elements conform everywhere: squares of 1 x 1 crossovers in the middle, 2 x 2 or 4 x 4 in the corners, 1 x 2 or 1 x 4 in
the arms between. Each line stands for the yarns up to halfway to its neighbours: their mass, forces and trellis
(`membrane_kernels`). What an element feels is per yarn, as before: stretches, tension, strength; its yarns fail
together. Waves shorter than about eight of the longer elements do not pass where zones meet.

A grading is a sequence of (until, side): up to `until` crossovers from the impact point elements are `side` crossovers
long. The last `until` is infinite. Each zone but the last goes on until what is left can be filled with whole elements
of the next.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import InputError


def check(grading: Any) -> None:
    """InputError where a grading is none.

    Parameters
    ----------
    grading : ((until, side), ...) [crossovers]
    """
    allowed = "zones (until, side) in crossovers, the last until inf, such as [[10, 1], [20, 2], [inf, 4]]"
    try:
        zones = [(float(until), float(side)) for until, side in grading]
    except (TypeError, ValueError):
        raise InputError(key="grading", value=grading, allowed=allowed) from None
    if not zones or zones[-1][0] != inf:
        raise InputError(key="grading", value=grading, allowed=allowed)
    ends = [0.0, *(until for until, _ in zones)]
    if not all(a < b for a, b in pairwise(ends)):
        raise InputError(key="grading", value=grading, allowed="zones further and further from the impact point")
    sides = [side for _, side in zones]
    if not all(side == int(side) and 1 <= side <= 64 for side in sides):
        raise InputError(key="grading", value=grading, allowed="sides of 1, 2, ... 64 whole crossovers")
    if any(after % before for before, after in pairwise(sides)):
        raise InputError(key="grading", value=grading, allowed="sides each a multiple of that before it")


def sides(grading: Sequence[tuple[float, float]], length: float) -> FloatArray:
    """(n,) [crossovers] sides of the elements from the impact point out to `length`, a whole number of crossovers.

    What is less than an element of the first zone is left out.
    """
    found, at = [], 0
    length -= length % int(grading[0][1])
    for (until, side), after in zip(grading, (*grading[1:], None)):
        side = int(side)
        while at < min(until, length) or (after is not None and (length - at) % int(after[1])):
            found.append(side)
            at += side
    return np.array(found, float)


def tributary(sides: FloatArray) -> FloatArray:
    """(n+1,) half of the elements on either side of each line."""
    return 0.5 * (np.append(sides, 0.0) + np.insert(sides, 0, 0.0))


def split(sides: FloatArray) -> FloatArray:
    """(n+1,) [-] share of the element before each line in the two beside it; one half at the ends."""
    before, behind = np.insert(sides, 0, sides[0]), np.append(sides, sides[-1])
    return before / (before + behind)


def slots(
    sides: tuple[FloatArray, ...], finest: tuple[float, ...], thickness: float, viscosity: Sequence[float],
    room: Callable[..., Any],
) -> dict[str, FloatArray]:  # fmt: skip
    """What is a float of a plain panel and changes from slot to slot of a graded one: {name of Constants: (slots,)}.

    The viscosity grows with the element, so that its highest mode is damped by the same ratio everywhere.

    Parameters
    ----------
    sides : ((ni,), (nj,)) [m]
    finest : (dx, dy) [m] sides of the smallest element
    thickness : [m] of the cloth
    viscosity : (warp, weft) [N] of the smallest element
    room : as `aligned.aligned_zeros`, makes flat arrays that begin with a cache line
    """
    (a, b), (dx, dy), (cv1, cv2) = sides, finest, viscosity
    ni, nj = a.size, b.size

    def spread(row, column, factor=1.0):
        grid = np.multiply.outer(np.append(row, row[-1:]), np.append(column, column[-1:]))[: ni + 1, : nj + 1]
        flat = room(1, (ni + 2) * (nj + 1) + 32)[0]
        flat[:] = factor * grid[0, 0]
        flat[16 : 16 + grid.size] = factor * grid.ravel()
        return flat[16:]  # `membrane_kernels.difference` reads one slot before the first

    rows, columns = np.ones(ni + 1), np.ones(nj + 1)
    return {
        "inv_dx": spread(1 / a, columns),
        "inv_dy": spread(rows, 1 / b),
        "trellis_volume": spread(a, b, thickness),
        "cv1": spread(a / dx, columns, cv1),
        "cv2": spread(rows, b / dy, cv2),
        "mean_weight1": spread(split(a), columns),
        "mean_weight2": spread(rows, split(b)),
    }


def line_offsets(
    lines: tuple[FloatArray, ...], origin: tuple[float, ...], finest: tuple[float, ...], room: Callable[..., Any]
) -> dict[str, FloatArray]:
    """What a graded grid has in place of x0 + i dx: {name of Constants: (lines + 16,) [m]}.

    Zeros stand before the first line, where vectors of eight begin, and beyond the last, where they end.

    Parameters
    ----------
    lines : ((ni+1,), (nj+1,)) [m] places of the lines at rest
    origin : (x0, y0) [m] place of the first line if all elements were the smallest
    finest : (dx, dy) [m] sides of the smallest element
    room : as for `slots`
    """
    found = {}
    for name, x, x0, d in zip(("line_offset1", "line_offset2"), lines, origin, finest):
        flat = room(1, x.size + 32)[0]
        flat[16 : 16 + x.size] = x - (x0 + d * np.arange(x.size))
        found[name] = flat[16:]
    return found
