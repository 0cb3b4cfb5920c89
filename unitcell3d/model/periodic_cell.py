"""The weave's own cell with neighbours on all sides: stretched along both yarns and sheared as a
trellis.

A plain weave repeats after one crossing along each yarn, turned upside down (a glide plane), and
after two as it is. In-plane stretch and shear keep both. So one whole crossover ("whole") with the
glide, or a patch of 2 x 2 ("periodic") with plain repetition, stands for the weave:

    x(X + a) - M x(X) = F a,    M = diag(1, 1, -1) or 1,   a: one or two crossings along a yarn.

Lengths of the yarns between crossings are w_i lambda_i, their directions e_1 and e_2; with the
shear angle g, half of it on each side (thesis section 4.3.2, the trellis of Figure 4-6),

    F = [lambda_1 e_1, lambda_2 e_2],   e_1 = (cos g/2, sin g/2),  e_2 = (sin g/2, cos g/2),  lambda_i = 1 + d_i / w_i.

Each yarn is driven by the turn and stretch of its own axis, and the unknowns are what it does
besides: they are tied between the ends of the yarn. Contact meets neighbours in images of nodes:
nodes without mass or law that follow those of the cell. The load does the work Q . dp on its
parameters p (the turns and stretches), so

    T_i = Q . dp/dd_i / 2,    M = Q . dp/dg    (per crossing),    tau = M / (cell area x shell thickness).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from meshing.patch import Patch
from unitcell3d.assembly.constraints import VERTICAL, Constraints, Ties
from unitcell3d.assembly.periodic_images import Images
from unitcell3d.contact import periodic
from unitcell3d.contact.surfaces import SurfacePairs
from unitcell3d.model.crossover import LinearLoad, Numerics, YarnsModel, check

PLANE = (0, 1)


@dataclass(frozen=True)
class CellLoad(LinearLoad):
    """End displacements d1, d2 [m] per end of a crossing, and the shear angle gamma [rad] between
    the yarns.

    w : (2,) [m] half lengths of the cell
    plates : [m] half the distance of two plates, infinite without
    """

    w: tuple
    d: tuple = (0.0, 0.0)
    gamma: float = 0.0
    plates: float = np.inf

    @property
    def F(self) -> FloatArray:
        """(2, 2) deformation gradient of the weave."""
        return _axes(self.gamma) * (1 + np.asarray(self.d) / self.w)

    @property
    def drive(self) -> FloatArray:
        """(12,) entries of H_warp, H_weft and F - I."""
        return self._parts(_axes, _across) - np.tile([1.0, 0.0, 0.0, 1.0], 3)

    @property
    def by_d(self) -> FloatArray:
        """(2, 12) derivatives of `drive` by d1 and d2."""
        rows = []
        for yarn in (0, 1):
            part = np.zeros((3, 2, 2))
            part[yarn, :, yarn] = part[2, :, yarn] = _axes(self.gamma)[:, yarn] / self.w[yarn]
            rows.append(part.ravel())
        return np.array(rows)

    @property
    def by_gamma(self) -> FloatArray:
        """(12,) derivative of `drive` by gamma."""
        return self._parts(_axes_by_gamma, _across_by_gamma)

    def _parts(self, axes, across):
        stretch = 1 + np.asarray(self.d) / self.w
        along, side = axes(self.gamma) * stretch, across(self.gamma)
        warp, weft = np.stack([along[:, 0], side[:, 0]], 1), np.stack([side[:, 1], along[:, 1]], 1)
        return np.concatenate([warp.ravel(), weft.ravel(), along.ravel()])


def _axes(gamma):
    """(2, 2) columns e_1, e_2."""
    c, s = np.cos(gamma / 2), np.sin(gamma / 2)
    return np.array([[c, s], [s, c]])


def _across(gamma):
    """(2, 2) columns: what y is turned to with the warp, and x with the weft."""
    c, s = np.cos(gamma / 2), np.sin(gamma / 2)
    return np.array([[-s, c], [c, -s]])


def _axes_by_gamma(gamma):
    return _axes(gamma + np.pi) / 2


def _across_by_gamma(gamma):
    return _across(gamma + np.pi) / 2


@dataclass(frozen=True)
class CellConstraints(Constraints):
    """Constraints of a cell of a number of `crossings`; the ends are not nodes but parameters of
    the load."""

    crossings: int = 1
    w: tuple = ()

    def end_force(self, forces: FloatArray, yarn: int) -> float:
        """[N] tension of a yarn as far as its direction is that of the undeformed cell: the size of
        the forces."""
        Q = self.work(forces).reshape(3, 2, 2)
        return float(Q[yarn, yarn, yarn] + Q[2, yarn, yarn]) / (2 * self.w[yarn] * self.crossings)

    def work(self, forces: FloatArray) -> FloatArray:
        """(12,) [N m] what the nodal forces do on the load's parameters."""
        return self.drive.T @ forces.ravel()


class CellModel(YarnsModel):
    """A crossover or four in the weave.

    Parameters
    ----------
    mesh : meshing.crossover.Crossover, a whole one, or meshing.patch.Patch of 2 x 2
    fabric : Fabric
    numerics, failure : as of a `model.crossover.YarnsModel`
    margin : columns of elements beyond a crossing's own in which its two yarns may meet too;
        beyond, the faces of their sharp tips are met from behind, and slack yarns snap

    Raises
    ------
    InputError : another mesh
    """

    constraints: CellConstraints

    def __init__(
        self,
        mesh: Crossover | Patch,
        fabric: Fabric,
        numerics: Numerics | None = None,
        *,
        margin: int = 0,
        **choices: Any,
    ) -> None:
        check(mesh, fabric)
        four = isinstance(mesh, Patch)
        if (mesh.count != (2, 2)) if isinstance(mesh, Patch) else (mesh.domain != "whole"):
            raise InputError("a cell needs a whole crossover or a patch of 2 x 2")
        self.period = 2 if four else 1  # crossings after which the weave repeats, along each yarn
        self.parity = 1.0 if four else -1.0
        self.crossings, self.w = self.period**2, mesh.w
        images = Images(mesh, self.period, self.parity)
        cells = (mesh.grids[0].shape[0] - 1) // self.period
        # images of all pairs have to be there before the points are taken
        crossing = periodic.crossings(mesh, images, cells, margin)
        beside = periodic.neighbours(mesh, images, cells)
        super().__init__(
            mesh,
            fabric,
            numerics,
            self._tied(mesh, images),
            SurfacePairs([*crossing, *beside]),
            None,
            points=images.points,
            **choices,
        )

    def _tied(self, mesh, images):
        ties = Ties(len(images.points), 12)
        ties.drive[:] = images.drive()
        for yarn, grid in enumerate(mesh.grids):
            start, end = grid[0], grid[-1] if self.parity > 0 else grid[-1][:, ::-1]
            for component in (*PLANE, VERTICAL):
                ties.follow(end, start, component, self.parity if component == VERTICAL else 1.0)
            # crossings are centres of two-fold axes: they stay where the trellis takes them
            middle = grid[
                tuple(
                    size // 2 // (self.period if axis == 0 else 1)
                    for axis, size in enumerate(grid.shape)
                )
            ]
            for component in PLANE:
                ties.hold(middle, component)
            if yarn == 0 and self.parity > 0:
                ties.hold(start[start.shape[0] // 2, start.shape[1] // 2], VERTICAL)
                ties.hold(end[start.shape[0] // 2, start.shape[1] // 2], VERTICAL)
        for image, base, flips in images.followers():
            for component in (*PLANE, VERTICAL):
                ties.follow(
                    image, base, component, -1.0 if flips and component == VERTICAL else 1.0
                )
        held = ties.done(())
        return CellConstraints(
            held.unknown, held.sign, held.drive, held.size, (), self.crossings, mesh.w
        )

    def tensions(self, forces: FloatArray, load: CellLoad) -> FloatArray:  # type: ignore[override]
        """(2,) [N] tensions of a warp and a weft."""
        return load.by_d @ self.constraints.work(forces) / (2 * self.crossings)

    def moment(self, forces: FloatArray, load: CellLoad) -> float:
        """[N m] per crossing, conjugate to the shear angle."""
        return float(load.by_gamma @ self.constraints.work(forces)) / self.crossings

    def thickness(self, x: FloatArray) -> float:
        """[m] from the lowest to the highest node."""
        return float(np.ptp(x[: len(self.crossover.points), 2]))
