"""The contact of a crossover: the two facing surfaces in two passes, and the two plates of a compression test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from unitcell3d import constraints, contact_kernels

# cells by which a contact point may slide before the tangent is laid out anew: a few blocks more for far fewer layouts
SLIP_MARGIN = 0.3
STENCIL = 17  # a slave node and the 16 nodes it acts on
NO_TANGENT = np.empty((0, STENCIL, STENCIL), np.int64)


@dataclass(frozen=True)
class _Side:
    """One contact surface: grid of nodes, tributary areas, and what `contact_kernels` needs to know of it as master."""

    grid: np.ndarray
    areas: np.ndarray
    axes: np.ndarray
    mirror: np.ndarray
    side: float


class FacingSurfaces:
    """The lower face of the warp and the upper face of the weft, each slave once with half the penalty.

    Parameters
    ----------
    points : (n, 3) [m] undeformed
    grids : per yarn, node numbers (i along, j across, k through)
    quarter : whether i = 0 and j = 0 are symmetry planes

    Attributes
    ----------
    gaps : per yarn, [m] of the nodes of its face at the last call of `touch`, infinite without a partner
    stencils : per yarn, (s, 17) nodes that its nodes acted on in the last call of `touch`, -1 without contact
    """

    def __init__(self, points, grids, quarter):
        self._sides = []
        for yarn, face in enumerate((grids[0][:, :, 0], grids[1][:, :, -1])):
            grid = np.ascontiguousarray(face, np.int64)
            corner = points[grid[0, 0]]
            upwards = np.sign(np.cross(points[grid[1, 0]] - corner, points[grid[0, 1]] - corner)[2])
            axes = np.array([constraints.AXIAL[yarn], constraints.WIDTH[yarn]])
            side = -upwards if yarn == 0 else upwards  # the warp lies on top
            self._sides.append(_Side(grid, tributary_areas(points, grid), axes, np.array([quarter, quarter]), side))
        self._guesses = [self._first_guess(points, slave) for slave in (0, 1)]
        self.gaps = [np.full(side.grid.size, np.inf) for side in self._sides]
        self.stencils = [np.full((side.grid.size, STENCIL), -1) for side in self._sides]

    def _first_guess(self, points, slave):
        """Parameters of the slave's nodes on the undeformed master, whose grid is straight in plan."""
        slaves, master = points[self._sides[slave].grid.ravel()], self._sides[1 - slave]
        lines = points[master.grid[:, 0], master.axes[0]], points[master.grid[0, :], master.axes[1]]
        return np.stack(
            [np.interp(slaves[:, axis], line, np.arange(len(line))) for axis, line in zip(master.axes, lines)], axis=1
        )

    def met(self):
        """(m, 17) the stencils that were in contact at the last call of `touch`."""
        stencils = np.concatenate(self.stencils)
        return stencils[stencils[:, 0] >= 0]

    def expected(self):
        """(m, 17) stencils of all nodes of both faces near their closest points: what may be met next."""
        weights, work, nodes = np.empty((6, 16, 3)), np.empty((4, 3, 4)), np.empty(16, np.int64)
        shifts = SLIP_MARGIN * np.array([(a, b) for a in (-1, 1) for b in (-1, 1)])
        found = set()
        for slave in (0, 1):
            master = self._sides[1 - slave]
            last = np.array(master.grid.shape) - 1
            for node, xi in zip(self._sides[slave].grid.ravel(), self._guesses[slave]):
                for near in np.clip(xi + shifts, 0, last):
                    contact_kernels.surface_stencil(near, master.grid, master.axes, master.mirror, nodes, weights, work)
                    found.add((node, *nodes))
        return np.array(sorted(found))

    def touch(self, x, numerics, forces, places, values):
        """Both passes: adds internal forces, and the tangent where `places` is given.

        Parameters
        ----------
        x : (n, 3) [m] current positions
        numerics : Numerics
        forces : (n, 3) [N] added to
        places, values : per yarn `contact_kernels.contact_pass`'s places, or None; blocks added to

        Returns
        -------
        force : [N] upwards on the warp
        """
        total = 0.0
        for slave, sign in ((0, 1.0), (1, -1.0)):
            nodes, master = self._sides[slave], self._sides[1 - slave]
            resultant = np.zeros(3)
            contact_kernels.contact_pass(
                x,
                nodes.grid.ravel(),
                nodes.areas.ravel(),
                master.grid,
                master.axes,
                master.mirror,
                master.side,
                0.5 * numerics.penalty,
                numerics.toe,
                self._guesses[slave],
                self.gaps[slave],
                self.stencils[slave],
                forces,
                NO_TANGENT if places is None else places[slave],
                values,
                resultant,
            )
            total += sign * resultant[2]
        return total


class Plates:
    """Two rigid plates, one above the warp and one below the weft, at equal distances from the middle plane."""

    def __init__(self, points, grids):
        outer = (grids[0][:, :, -1], grids[1][:, :, 0])
        self.faces = [(face.ravel().astype(np.int64), tributary_areas(points, face).ravel()) for face in outer]
        upper, lower = (points[nodes, 2] for nodes, _ in self.faces)
        self.at_rest = float(max(upper.max(), -lower.min()))  # [m] half the distance at which they just touch

    def press(self, x, half_distance, numerics, forces, places, values):
        """Adds internal forces, and the tangent where `places` (per plate, or None) is given; returns (2,) [N]."""
        pressed = np.zeros(2)
        if np.isfinite(half_distance):
            for plate, side in ((0, 1.0), (1, -1.0)):
                nodes, areas = self.faces[plate]
                pressed[plate] = contact_kernels.plate_pass(
                    x,
                    nodes,
                    areas,
                    side * half_distance,
                    side,
                    numerics.penalty,
                    numerics.toe,
                    forces,
                    np.empty(0, np.int64) if places is None else places[plate],
                    values,
                )
        return pressed


def tributary_areas(points, grid):
    """Areas [m2] of the nodes of a face: a quarter of each quadrilateral to each of its corners."""
    x = points[grid]
    quads = 0.5 * np.linalg.norm(np.cross(x[1:, 1:] - x[:-1, :-1], x[:-1, 1:] - x[1:, :-1]), axis=-1)
    areas = np.zeros(grid.shape)
    for i in (0, 1):
        for j in (0, 1):
            areas[i : i + quads.shape[0], j : j + quads.shape[1]] += quads / 4
    return areas
