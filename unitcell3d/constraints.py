"""Symmetry planes, driven ends and the weave's two-fold axis, imposed by elimination.

Each of the 3 n displacement components is +-one unknown, plus the end displacement of its yarn where that drives it:

    u = sign * q[unknown] + drive d,    unknown = -1 where u is prescribed.

A plain weave has a two-fold axis through the inflection point of each yarn, along its width: the next crossover is
the same one turned upside down. On the end face, with k counted through the thickness from the middle, that is

    u_axial(k) - d = -(u_axial(-k) - d),    u_z(k) = -u_z(-k),    u_width(k) = u_width(-k).

Holding the middle of the face, or the whole of it, is not the weave's condition, and the first does not converge with
the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

VERTICAL = 2
AXIAL, WIDTH = (0, 1), (1, 0)  # components of warp and weft


@dataclass(frozen=True)
class Constraints:
    """unknown, sign : (3 n,); drive : (3 n, 2) share of the end displacements d1, d2; size : number of unknowns.

    ends : per yarn, the nodes of its end face at the positive end
    """

    unknown: np.ndarray
    sign: np.ndarray
    drive: np.ndarray
    size: int
    ends: tuple

    def displacement(self, q, d):
        """Displacement (n, 3) [m] of the unknowns `q` and the end displacements `d` : (2,) [m]."""
        u = self.drive @ np.asarray(d, float)
        free = self.unknown >= 0
        u[free] += self.sign[free] * q[self.unknown[free]]
        return u.reshape(-1, 3)

    def reduce(self, forces):
        """Forces on the unknowns (size,) of the nodal forces (n, 3) [N]."""
        free = self.unknown >= 0
        return np.bincount(self.unknown[free], self.sign[free] * forces.ravel()[free], self.size)

    def end_force(self, forces, yarn):
        """Axial force [N] that drives the positive end of a yarn, the work conjugate of its end displacement."""
        return float(forces[self.ends[yarn], AXIAL[yarn]].sum())


def build(grids, n, *, quarter):
    """Constraints of a crossover.

    Parameters
    ----------
    grids : per yarn, node numbers (i along, j across, k through)
    n : number of nodes
    quarter : whether i = 0 and j = 0 are symmetry planes; otherwise both ends of a yarn are driven apart
    """
    sign, drive = np.ones(3 * n), np.zeros((3 * n, 2))
    leader = np.arange(3 * n)  # the component that carries the unknown; -1: prescribed
    for yarn, grid in enumerate(grids):
        axial, width = AXIAL[yarn], WIDTH[yarn]
        if quarter:
            leader[3 * grid[0] + axial] = -1
            leader[3 * grid[:, 0] + width] = -1
        else:
            middle = tuple(size // 2 for size in grid.shape)
            leader[3 * grid[middle] + width] = -1  # a lone yarn could drift sideways
        faces = ((grid[-1], 1.0),) if quarter else ((grid[-1], 1.0), (grid[0], -1.0))
        for face, direction in faces:
            drive[3 * face + axial, yarn] = direction
            layers = face.shape[1]
            for k in range(layers // 2):
                low, high = face[:, k], face[:, layers - 1 - k]
                for component, parity in ((axial, -1.0), (VERTICAL, -1.0), (width, 1.0)):
                    leader[3 * high + component] = leader[3 * low + component]
                    sign[3 * high + component] = parity
            if layers % 2:
                middle = face[:, layers // 2]
                leader[3 * middle + axial] = leader[3 * middle + VERTICAL] = -1
    carriers = np.unique(leader[leader >= 0])
    number = np.full(3 * n, -1)
    number[carriers] = np.arange(len(carriers))
    unknown = np.where(leader >= 0, number[leader], -1)
    ends = tuple(grid[-1].ravel() for grid in grids)
    return Constraints(unknown, sign, drive, len(carriers), ends)
