"""Named tuples that the kernels of contact take: plain arrays under names (symbols as in
`surface_contact_kernels`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fabrics.base.checks import FloatArray, IntArray


class ContactLaw(NamedTuple):
    """Penalty law and Coulomb friction.

    penalty : [Pa/m] k
    toe : [m] t, depth over which the penalty sets in
    friction : [-] f
    slip : [m] s, regularisation slip
    """

    penalty: float
    toe: float
    friction: float
    slip: float


class SlavePoints(NamedTuple):
    """The Gauss points of the slave's f bilinear faces, g in each.

    quads : (f, 4) nodes of the faces
    shapes : (g, 4) [-] shape functions at the Gauss points
    areas : (f g,) [m2] of the points on the undeformed surface
    """

    quads: IntArray
    shapes: FloatArray
    areas: FloatArray


class Face(NamedTuple):
    """A structured surface, as master.

    grid : (ni, nj) node numbers
    axes : (2,) component (0 x, 1 y) along i and along j
    mirror : (2,) bool, whether i = 0 and j = 0 are symmetry planes
    side : [-] +1 where the normal S_,1 x S_,2 points to the slave, else -1
    """

    grid: IntArray
    axes: IntArray
    mirror: NDArray[np.bool_]
    side: float


class PassState(NamedTuple):
    """State of the f g slave points of one pass.

    xi : (f g, 2) [-] closest points on the master; the guess before a pass
    anchors : (f g, 2) [-] where each point stuck last; not read without friction
    gaps : (f g,) [m] infinite where the point has no partner
    codes : (f g,) face * (cells of the master) + cell of the master; -1 where there is no contact
    """

    xi: FloatArray
    anchors: FloatArray
    gaps: FloatArray
    codes: IntArray


class Blocks(NamedTuple):
    """Where a pass adds its tangent.

    row_of : row of `places` for each code
    places : (m, 20, 20) block of `values` of each pair of the nodes of a code; (0, 20, 20) for
        forces alone
    values : (k, 3, 3) [N/m] blocks
    """

    row_of: IntArray
    places: IntArray
    values: FloatArray


class PlateFace(NamedTuple):
    """The nodes that a plate may touch.

    nodes : (s,) node numbers
    areas : (s,) [m2] tributary areas
    side : [-] +1 for a plate above the nodes, -1 below
    anchors : (s, 2) [m] where on the plate each node stuck last
    """

    nodes: IntArray
    areas: FloatArray
    side: float
    anchors: FloatArray
