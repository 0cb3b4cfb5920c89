"""What the contact between graded plies needs of their grids: areas of contact points, and offsets of the lines."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.checks import FloatArray
from shellfabric.jit.simd import WIDTH

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel


def area_factors(front: Panel, rear: Panel, places: FloatArray | None = None) -> dict[str, Any]:
    """Rows and columns whose products are the areas that contact points of a ply stand for, over that of the smallest
    element: {name of Pair: (ni,) or (nj,) [-]}; None on uniform grids.

    Where elements of the rear ply are shorter, as they may be in an alternating pack, it is the side of the shortest
    that is below a point's element: more than its nodes' mass would bear no stable spring.

    places : (2, ni, points, points, nj) [elements] of the points of the front ply on a rear ply that is turned against
        it, or None. Of such plies the first of the two has all products, (ni, nj); a point then has at most the area of
        the smallest element of the rear ply next to it
    """
    names = "area_factor1", "area_factor2"
    if front.sides is None:
        return dict.fromkeys(names)
    if places is not None:
        return {"area_factor1": _of_turned(front, rear, places), "area_factor2": None}
    found = {}
    for name, mine, other, d in zip(names, front.lines(), rear.lines(), front.spacing):
        factors = np.zeros(mine.size - 1 + WIDTH)
        for i, (low, high) in enumerate(pairwise(mine)):
            slack = 1e-6 * d
            below = np.diff(other)[(other[1:] > low + slack) & (other[:-1] < high - slack)]
            factors[i] = min(high - low, below.min(initial=np.inf)) / d
        found[name] = factors
    return found


def _of_turned(front, rear, places):
    """(ni, nj) `area_factors` of plies that are turned against each other."""
    own, other = (np.multiply.outer(*ply.sides) for ply in (front, rear))
    wide = np.pad(other, 1, mode="edge")
    (m, n), shifts = other.shape, [(a, b) for a in range(3) for b in range(3)]
    least = np.min([wide[a : a + m, b : b + n] for a, b in shifts], axis=0)
    at = np.minimum(places.astype(np.int64), np.array(other.shape)[:, None, None, None, None] - 1)
    return np.minimum(own, places.shape[2] ** 2 * least[at[0], at[1]].min(axis=(1, 2))) / np.prod(front.spacing)
