"""Images of yarns beyond the cell: nodes that follow those of the cell, for contact alone.

The image of a yarn under the lattice vector a (m periods along x, n along y) stands at X + a, and
upside down about the level of its ends where m + n is odd and the weave repeats by a glide: its
node (i, j, k) is then that of (i, j, -k).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.pattern import PLAIN
from meshing.mesh import YarnMesh


class Images:
    """Nodes of a cell, and of the images that are requested.

    Parameters
    ----------
    mesh : meshing.mesh.YarnMesh
    period : (2,) crossings along warp and weft after which the weave repeats
    parity : +1 as it is, -1 upside down

    Attributes
    ----------
    points : (n, 3) [m] of the cell's nodes and the images' so far
    """

    def __init__(self, mesh: YarnMesh, period: tuple[int, int], parity: float) -> None:
        self._mesh = mesh
        self._parity = parity
        self._step = [2 * w * crossings for w, crossings in zip(mesh.w, period)]
        self._level = [float(mesh.points[grid[[0, -1]], 2].mean()) for grid in mesh.grids]
        self.points = np.asarray(mesh.points, float)
        self._found: dict[tuple[int, int, int], IntArray] = {}
        self._followers: list[tuple[IntArray, IntArray, bool]] = []
        self._of = [(yarn, 0, 0) for yarn in range(len(mesh.grids))]

    def extended(self, yarn: int, m: int, n: int, margin: int) -> IntArray:
        """Return the node numbers (i, j, k) of a yarn's image, with `margin` columns of its own
        next images at each end."""
        place = np.array([m, n])
        step = np.eye(2, dtype=int)[self._mesh.families[yarn]]
        grid = self.image(yarn, *place)
        before = self.image(yarn, *(place - step))
        after = self.image(yarn, *(place + step))
        return np.concatenate([before[-1 - margin : -1], grid, after[1 : 1 + margin]])

    def image(self, yarn: int, m: int, n: int) -> IntArray:
        """Return the node numbers (i, j, k) of the image of a yarn, new ones if it is requested the
        first time."""
        if (m, n) == (0, 0):
            return self._mesh.grids[yarn]
        if (yarn, m, n) not in self._found:
            base = self._mesh.grids[yarn]
            flips = self._parity < 0 and not PLAIN.is_warp_up(m, n)
            if flips:
                base = base[:, :, ::-1]
            points = self.points[base]
            points[..., :2] += (m * self._step[0], n * self._step[1])
            if flips:
                points[..., 2] = 2 * self._level[yarn] - points[..., 2]
            nodes = np.arange(base.size).reshape(base.shape) + len(self.points)
            self.points = np.concatenate([self.points, points.reshape(-1, 3)])
            self._found[yarn, m, n] = nodes
            self._followers.append((nodes.ravel(), base.ravel(), flips))
            self._of.append((yarn, m, n))
        return self._found[yarn, m, n]

    def followers(self) -> Iterator[tuple[IntArray, IntArray, bool]]:
        """Yield (nodes, the cell's nodes that they follow, whether upside down)."""
        yield from self._followers

    def drive(self) -> FloatArray:
        """Compute the displacement (3 n, 12) by the entries of H_warp, H_weft and F - I: u = H (X -
        c) + (F - I) c.

        c is a point of the yarn's axis: each yarn turns about it, and it goes with the weave.
        """
        drive = np.zeros((len(self.points), 3, 12))
        for yarn, m, n in self._of:
            family = self._mesh.families[yarn]
            nodes = self.image(yarn, m, n).ravel()
            points = self.points[nodes]
            centre = np.zeros_like(points[:, :2])
            centre[:, 1 - family] = points[:, 1 - family].mean()
            for a in (0, 1):
                for b in (0, 1):
                    drive[nodes, a, 4 * family + 2 * a + b] = points[:, b] - centre[:, b]
                    drive[nodes, a, 8 + 2 * a + b] = centre[:, b]
        return drive.reshape(-1, 12)
