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

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from meshing.patch import Patch
from unitcell3d.assembly.constraints import VERTICAL, Constraints, Ties
from unitcell3d.assembly.periodic_images import Images
from unitcell3d.assembly.symmetries import partners
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
        along = axes(self.gamma) * stretch
        side = across(self.gamma)
        warp = np.stack([along[:, 0], side[:, 0]], 1)
        weft = np.stack([side[:, 1], along[:, 1]], 1)
        return np.concatenate([warp.ravel(), weft.ravel(), along.ravel()])


def _axes(gamma):
    """(2, 2) columns e_1, e_2."""
    c = np.cos(gamma / 2)
    s = np.sin(gamma / 2)
    return np.array([[c, s], [s, c]])


def _across(gamma):
    """(2, 2) columns: what y is turned to with the warp, and x with the weft."""
    c = np.cos(gamma / 2)
    s = np.sin(gamma / 2)
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
        """Compute the tension [N] of a yarn as far as its direction is that of the undeformed cell:
        the size of the forces."""
        Q = self.work(forces).reshape(3, 2, 2)
        return float(Q[yarn, yarn, yarn] + Q[2, yarn, yarn]) / (2 * self.w[yarn] * self.crossings)

    def work(self, forces: FloatArray) -> FloatArray:
        """Compute the work (12,) [N m] that the nodal forces do on the load's parameters."""
        return self.drive.T @ forces.ravel()


class CellModel(YarnsModel):
    """A crossover, or a repeat of the weave or half of one, in the weave.

    What takes the weave and its load into themselves takes the yarns into each other too: nodes follow
    those that they are taken to (`assembly.symmetries`). So no yarn drifts, with nothing to hold it.

    Parameters
    ----------
    mesh : meshing.crossover.Crossover, a whole one, or meshing.patch.Patch of `Pattern.cell`
    fabric : Fabric
    sheared : whether loads shear it; mirror planes of the weave are none of it then, and a basket, whose
        groups nothing else holds, has no equilibrium
    numerics, failure : as in a `model.crossover.YarnsModel`

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
        sheared: bool = True,
        **choices: Any,
    ) -> None:
        check(mesh, fabric)
        pattern = fabric.weave.pattern
        self.called = f"cell of a {pattern.name} weave"
        symmetries = [each for each in pattern.symmetries if each.keeps_shear or not sheared]
        if isinstance(mesh, Patch):
            *least, parity = pattern.cell
            whole = [n % m == 0 for n, m in zip(mesh.count, pattern.matrix.shape)]
            fits = all(whole) or (parity < 0 and list(mesh.count) == least)
            self.parity = 1.0 if all(whole) else -1.0
            # crossings after which the weave repeats, along warp and weft
            self.period = mesh.count[::-1]
        else:
            fits = mesh.domain == "whole"
            self.period = 1, 1
            self.parity = -1.0
        if not fits:
            raise InputError("a cell needs a whole crossover or a patch of the weave's repeat")
        self.crossings = self.period[0] * self.period[1]
        self.w = mesh.w
        images = Images(mesh, self.period, self.parity)
        cells = (mesh.grids[0].shape[0] - 1) // self.period[0]
        # images of all pairs have to be there before the points are taken
        crossing = periodic.crossings(mesh, cells)
        edges = periodic.neighbours(mesh, images, cells)
        sides = periodic.sides(mesh, images, cells)
        self.beside = [*edges, *sides]
        beside = [(side,) for _, side in self.beside]
        self._columns = periodic.columns(mesh, cells)
        super().__init__(
            mesh,
            fabric,
            numerics,
            self._tied(mesh, images, cells, symmetries),
            SurfacePairs([*crossing, *beside]),
            None,
            points=images.points,
            **choices,
        )

    def _tied(self, mesh, images, cells, symmetries):
        ties = Ties(len(images.points), 12)
        ties.drive[:] = images.drive()
        for grid in mesh.grids:
            end = grid[-1]
            if self.parity <= 0:
                end = end[:, ::-1]
            ties.follow_image(end, grid[0], self.parity)
        for symmetry in symmetries:
            nodes, partner, signs = partners(mesh, cells, self.period, self.parity, symmetry)
            for component in (*PLANE, VERTICAL):
                for sign in (1.0, -1.0):
                    at = signs[:, component] == sign
                    ties.follow(partner[at], nodes[at], component, sign)
        if not any(symmetry.upside_down for symmetry in symmetries):
            # nothing else holds the cell at its height
            face = mesh.grids[0][0]
            ties.hold(face[face.shape[0] // 2, face.shape[1] // 2], VERTICAL)
        for image, base, flips in images.followers():
            ties.follow_image(image, base, -1.0 if flips else 1.0)
        held = ties.done(())
        return CellConstraints(
            held.unknown, held.sign, held.drive, held.size, (), self.crossings, mesh.w
        )

    def tensions(self, forces: FloatArray, load: CellLoad) -> FloatArray:  # type: ignore[override]
        """Compute the tensions (2,) [N] of a warp and a weft."""
        return load.by_d @ self.constraints.work(forces) / (2 * self.crossings)

    def moment(self, forces: FloatArray, load: CellLoad) -> float:
        """Compute the moment [N m] per crossing, conjugate to the shear angle."""
        return float(load.by_gamma @ self.constraints.work(forces)) / self.crossings

    def compression(self, x: FloatArray) -> float:
        """Compute what one yarn is compressed by [m]: half of what the middles of warp and weft have come
        closer at a crossing, in the mean of the crossings."""
        through = self._columns.shape[2]
        middle = self._columns[..., [(through - 1) // 2, through // 2]]
        apart = [
            abs(np.diff(place[middle, 2].mean(axis=2), axis=1)).mean() for place in (self.points, x)
        ]
        return float(0.5 * (apart[0] - apart[1]))

    def thickness(self, x: FloatArray) -> float:
        """Measure the thickness [m] from the lowest to the highest node."""
        return float(np.ptp(x[: len(self.crossover.points), 2]))
