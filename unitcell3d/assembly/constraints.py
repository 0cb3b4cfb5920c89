"""Symmetry planes, driven ends and the weave's two-fold axis, imposed by elimination.

Each of the 3 n displacement components is +-one unknown, plus what the load drives it by:

    u = sign * q[unknown] + drive p,    unknown = -1 where u is prescribed,

with the parameters p of the load: the end displacements d of a crossover.

A plain weave has a two-fold axis through the inflection point of each yarn, along its width: the
next crossover is the same one turned upside down. On the end face, with k counted through the
thickness from the middle, that is

    u_axial(k) - d = -(u_axial(-k) - d),    u_z(k) = -u_z(-k),    u_width(k) = u_width(-k).

Holding the middle of the face, or the whole of it, is not the weave's condition, and the first does
not converge with the mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse import csgraph

from fabrics.base.checks import FloatArray, IntArray

VERTICAL = 2
AXIAL, WIDTH = (0, 1), (1, 0)  # components of warp and weft


@dataclass(frozen=True)
class Constraints:
    """unknown, sign : (3 n,); drive : (3 n, p) share of the load's parameters; size : number of
    unknowns.

    ends : of warp and weft, the nodes of the end face at the positive end; none where there is no
        such yarn
    """

    unknown: np.ndarray
    sign: np.ndarray
    drive: np.ndarray
    size: int
    ends: tuple

    @cached_property
    def C(self) -> sparse.csr_matrix:
        """(3 n, size) of u = C q + drive p: +-1 in the column of the unknown that a component
        follows."""
        free = np.flatnonzero(self.unknown >= 0)
        places = (free, self.unknown[free])
        return sparse.csr_matrix((self.sign[free], places), shape=(len(self.unknown), self.size))

    def displacement(self, q: FloatArray, parameters: ArrayLike) -> FloatArray:
        """Compute the displacement (n, 3) [m] of the unknowns `q` and the load's parameters: of a
        crossover d : (2,) [m]."""
        return (self.drive @ np.asarray(parameters, float) + self.C @ q).reshape(-1, 3)

    def reduce(self, forces: FloatArray) -> FloatArray:
        """Reduce the nodal forces (n, 3) [N] to forces on the unknowns (size,)."""
        return self.C.T @ forces.ravel()

    def end_force(self, forces: FloatArray, yarn: int) -> float:
        """Compute the axial force [N] that drives the positive end of a yarn, the work conjugate of
        its end displacement."""
        return float(forces[self.ends[yarn], AXIAL[yarn]].sum())


class Ties:
    """Collects what is tied to what, in any order, and numbers the unknowns.

    A component that is tied to its own negative, by itself or by way of others, is prescribed: it is
    what the load drives it by.

    Parameters
    ----------
    n : number of nodes
    parameters : of the load
    """

    def __init__(self, n: int, parameters: int) -> None:
        self.drive = np.zeros((3 * n, parameters))
        self._ties: list[tuple[IntArray, IntArray, float]] = []

    def hold(self, nodes: ArrayLike, component: int) -> None:
        """Prescribe a component: it is what the load drives it by."""
        self.follow(nodes, nodes, component, -1.0)

    def follow(
        self, nodes: ArrayLike, leaders: ArrayLike, component: int, parity: float = 1.0
    ) -> None:
        """Let a component of `nodes` be `parity` times that of `leaders` but for what the load
        drives them by."""
        own, other = (3 * np.ravel(each).astype(np.int64) + component for each in (nodes, leaders))
        self._ties.append((own, other, parity))

    def follow_image(self, nodes: ArrayLike, leaders: ArrayLike, parity: float) -> None:
        """Let `nodes` be an image of `leaders`, as they are (parity 1) or upside down (-1)."""
        for component in AXIAL:
            self.follow(nodes, leaders, component)
        self.follow(nodes, leaders, VERTICAL, parity)

    def turn(self, face: IntArray, opposite: IntArray, axial: int, width: int) -> None:
        """Tie the end face `face` : (j, k) to itself or to another, `opposite`, by the two-fold
        axis."""
        layers = face.shape[1]
        same = face is opposite
        turned = layers
        if same:
            turned = layers // 2
        for k in range(turned):
            low = face[:, k]
            high = opposite[:, layers - 1 - k]
            for component, parity in ((axial, -1.0), (VERTICAL, -1.0), (width, 1.0)):
                self.follow(high, low, component, parity)
        if same and layers % 2:
            for component in (axial, VERTICAL):
                self.hold(face[:, layers // 2], component)

    def done(self, ends: tuple) -> Constraints:
        """Return the Constraints; `ends` as there."""
        size = len(self.drive)
        # each component is two points, itself and its negative, 2 c and 2 c + 1: what is tied is joined
        first = []
        second = []
        for own, other, parity in self._ties:
            for negative in (0, 1):
                first.append(2 * own + negative)
                second.append(2 * other + (negative if parity > 0 else 1 - negative))
        places = tuple(np.concatenate([np.empty(0, np.int64), *part]) for part in (first, second))
        joined = sparse.coo_matrix((np.ones(len(places[0])), places), shape=(2 * size, 2 * size))
        _, group = csgraph.connected_components(joined, directed=False)
        _, least = np.unique(group, return_index=True)
        leader, sign = np.divmod(least[group[::2]], 2)
        leader[group[::2] == group[1::2]] = -1
        carriers = np.unique(leader[leader >= 0])
        number = np.full(size, -1)
        number[carriers] = np.arange(len(carriers))
        unknown = np.where(leader >= 0, number[leader], -1)
        return Constraints(unknown, 1.0 - 2.0 * sign, self.drive, len(carriers), ends)


def build(
    grids: Sequence[IntArray],
    n: int,
    *,
    quarter: bool,
    families: Sequence[int] = (0, 1),
    opposite: Sequence[int] | None = None,
) -> Constraints:
    """Build the constraints of a crossover, or of any yarns that cross above the origin.

    Parameters
    ----------
    grids : per yarn, node numbers (i along, j across, k through)
    n : number of nodes
    quarter : whether i = 0 and j = 0 are symmetry planes; otherwise both ends of a yarn are driven
        apart
    families : per yarn 0 (warp) or 1 (weft)
    opposite : per yarn, the number of that which the two-fold axis turns it into; itself if not
        given
    """
    ties = Ties(n, 2)
    if opposite is None:
        opposite = range(len(grids))
    for yarn, (grid, family) in enumerate(zip(grids, families)):
        axial = AXIAL[family]
        width = WIDTH[family]
        if quarter:
            ties.hold(grid[0], axial)
            ties.hold(grid[:, 0], width)
        else:
            middle = tuple(size // 2 for size in grid.shape)
            ties.hold(grid[middle], width)  # a lone yarn could drift sideways
        # both ends are driven apart; a quarter has one of them
        ends = {-1: 1.0}
        if not quarter:
            ends[0] = -1.0
        for end, direction in ends.items():
            ties.drive[3 * grid[end] + axial, family] = direction
            if opposite[yarn] == yarn:
                face = grid[end]
                ties.turn(face, face, axial, width)
            elif opposite[yarn] > yarn:
                ties.turn(grid[end], grids[opposite[yarn]][end], axial, width)
    none = np.empty(0, np.int64)
    faces = ([none], [none])
    for grid, family in zip(grids, families):
        faces[family].append(grid[-1].ravel())
    return ties.done(tuple(map(np.concatenate, faces)))
