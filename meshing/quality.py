"""Scaled Jacobian of hexahedra: at each corner the triple product of the three unit edges that
leave it.

1 in a brick, 0 where two edges fall together, negative where the element is turned inside out; of
an element the worst of its corners counts (P. M. Knupp, Int. J. Numer. Meth. Engng 48, 2000).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base import sums
from fabrics.base.checks import FloatArray

# For each corner of a VTK hexahedron its three neighbours, in right-handed order.
NEIGHBOURS = np.array(
    [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)],
)


def corner_edges(points: ArrayLike, hexes: ArrayLike) -> FloatArray:
    """Compute the edges (m, 8, 3, 3) that leave each corner of hexahedra (m, 8) in VTK order, one a
    row."""
    corners = np.asarray(points, float)[np.asarray(hexes)]
    return corners[:, NEIGHBOURS] - corners[:, :, None]


def scaled_jacobian(points: ArrayLike, hexes: ArrayLike) -> FloatArray:
    """Compute the scaled Jacobian of the worst corner of each element.

    Parameters
    ----------
    points : (n, 3) [m]
    hexes : (m, 8) int, VTK order

    Returns
    -------
    quality : (m,) [-] from -1 to 1; 0 where an edge has no length
    """
    edges = corner_edges(points, hexes)
    length = np.linalg.norm(edges, axis=-1, keepdims=True)
    unit = np.divide(edges, length, out=np.zeros_like(edges), where=length > 0)
    return sums.determinant(unit).min(axis=1)
