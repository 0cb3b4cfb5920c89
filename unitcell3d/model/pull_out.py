"""A whole crossover through which one of its yarns is pulled along its own axis.

The pulled yarn p carries on beyond the cell by the glide plane of a plain weave. With u the displacements
of its end faces, k counted through the thickness from the middle, s the pull and d_p the end displacement,

    u_axial(+, k) - (s + d_p) = u_axial(-, -k) - (s - d_p) = -(u_axial(+, -k) - (s + d_p)),
    u_z(+, k) = -u_z(-, -k),    u_width(+, k) = u_width(-, -k)

The crimp can travel along the yarn, and the tension grows by the axial force P that the crossing yarn takes.
That is held by the fabric: its end faces have the weave's two-fold axis (`assembly.constraints`) and no mean
displacement across the yarn, so that it takes P by its tension, as a string.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from unitcell3d.assembly.constraints import AXIAL, WIDTH, Constraints, Ties
from unitcell3d.contact.surfaces import Plates, SurfacePairs, facing
from unitcell3d.model.crossover import LinearLoad, Numerics, YarnsModel, axis_height, check


@dataclass(frozen=True)
class PullLoad(LinearLoad):
    """End displacements d1, d2 [m] per end and the pull [m] of one yarn along its axis.

    plates : [m] half the distance of two platens; infinite for none
    """

    d: tuple = (0.0, 0.0)
    pull: float = 0.0
    plates: float = np.inf

    @property
    def drive(self) -> tuple:
        """(3,) what the prescribed displacements are proportional to."""
        return (*self.d, self.pull)


class PullOutModel(YarnsModel):
    """A whole crossover of which one yarn is pulled.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover, a whole one
    fabric, numerics : as in a `model.crossover.YarnsModel`
    pulled : 0 pulls the warp, 1 the weft
    platens : whether two rigid platens without friction stand above and below the yarns

    Raises
    ------
    InputError : the fabric has no solid laws, is not the one that was meshed, or the mesh is not a
        whole crossover
    """

    def __init__(
        self,
        crossover: Crossover,
        fabric: Fabric,
        numerics: Numerics | None = None,
        pulled: int = 0,
        *,
        platens: bool = False,
    ) -> None:
        check(crossover, fabric)
        if crossover.domain != "whole":
            raise InputError(
                key="domain", value=crossover.domain, allowed="whole if a yarn is pulled through"
            )
        points = np.ascontiguousarray(crossover.points, float)
        self.pulled = pulled
        held = pull_constraints(crossover.grids, len(points), pulled)
        warp, weft = crossover.grids
        plates = None
        if platens:
            plates = Plates(points, [warp[:, :, -1]], [weft[:, :, 0]])
        super().__init__(
            crossover,
            fabric,
            numerics,
            held,
            SurfacePairs([facing(points, warp, weft)]),
            plates,
        )

    def _press(self, x, load, forces, places=None):
        """Platens take no axial force of the yarn: that force is to be the crossing yarn's
        alone."""
        if self.plates is None:
            return np.zeros(2)
        smooth = replace(self.numerics, friction=0.0)
        return self.plates.press(x, load.plates, smooth, forces, places, self.pattern.values)

    def axial_force(self, forces: FloatArray) -> float:
        """Compute P [N], by which the tension of the pulled yarn differs between its ends, from
        nodal forces (n, 3) [N]."""
        return float(forces[np.unique(self.crossover.grids[self.pulled]), AXIAL[self.pulled]].sum())

    def geometric_force(self, x: FloatArray) -> float:
        """Compute the part of P [N] that the normal pressures take, in the state at positions `x` :
        (n, 3) [m]."""
        forces = np.zeros_like(x)
        self.surfaces.assemble(x, replace(self.numerics, friction=0.0), forces)
        return self.axial_force(forces)

    def heights(self, x: FloatArray) -> FloatArray:
        """Compute the heights h1, h2 (2,) [m] of the centrelines at the crossing over (warp), under
        (weft) the mean of their ends."""
        found = []
        for grid in self.crossover.grids:
            i = grid.shape[0] // 2
            j = grid.shape[1] // 2
            ends = 0.5 * (axis_height(x, grid[0, j]) + axis_height(x, grid[-1, j]))
            found.append(axis_height(x, grid[i, j]) - ends)
        return np.array([found[0], -found[1]])


def pull_constraints(grids: Sequence[IntArray], n: int, pulled: int) -> Constraints:
    """Build the constraints of a whole crossover, with the parameters (d1, d2, pull) of the load.

    Parameters
    ----------
    grids : of warp and weft, node numbers (i along, j across, k through)
    n : number of nodes
    pulled : 0 pulls the warp, 1 the weft
    """
    ties = Ties(n, 3)
    for yarn, grid in enumerate(grids):
        axial = AXIAL[yarn]
        width = WIDTH[yarn]
        start = grid[0]
        end = grid[-1]
        ties.drive[3 * end + axial, yarn] = 1.0
        ties.drive[3 * start + axial, yarn] = -1.0
        if yarn == pulled:
            for face in (start, end):
                ties.drive[3 * face + axial, 2] = 1.0
            middle = tuple(size // 2 for size in grid.shape)
            ties.hold(grid[middle], width)  # it could drift sideways
            _odd(ties, start, axial, through=True)
            ties.follow_image(end, start[:, ::-1], -1.0)
        else:
            for face in (start, end):
                _odd(ties, face, width, through=False)
                ties.turn(face, face, axial, width)
    return ties.done(tuple(grid[-1].ravel() for grid in grids))


def _odd(ties, face, component, through):
    """Let a displacement of a face (j, k) have no mean: odd through the thickness, or across the
    yarn."""
    lines = face
    if through:
        lines = face.T
    count = len(lines)
    for line in range(count // 2):
        ties.follow(lines[count - 1 - line], lines[line], component, -1.0)
    if count % 2:
        ties.hold(lines[count // 2], component)
