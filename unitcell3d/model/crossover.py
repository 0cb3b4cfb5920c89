"""Quasi-static yarns: solids, fibre bars and contact as residual and tangent of one set of
unknowns.

    r(q, load) = C^T [ solid(u) + bars(u) + contact(u) + plates(u) ] = 0,   u = C q + drive d

(thesis chapter 3; `material.solid_law`, `material.fibre_kernels`, `contact.surface_contact_kernels`
and `assembly.constraints` hold the equations). Any set of yarns is a `YarnsModel`; the crossover is
one of them. A quarter crossover is half of each yarn's width and length: its axial end forces count
twice, its vertical forces four times.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, cast

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from meshing.mesh import YarnMesh
from meshing.quality import corner_edges
from unitcell3d.assembly import constraints
from unitcell3d.assembly.compat import Assembler, HexSpace
from unitcell3d.assembly.constraints import Constraints
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact.surfaces import Plates, SurfacePairs, facing
from unitcell3d.material import solid_law
from unitcell3d.material.fibres import Fibres
from unitcell3d.material.numerics import Numerics, fraction_of

# a weft brick's local axes run along i, k, j; the law wants the fibre, across, through in both
# yarns
ACROSS_BEFORE_THROUGH = ([0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 1, 0, 7, 6, 2, 3])


class LinearLoad:
    """A dataclass of numbers and tuples of numbers, on straight lines between loads."""

    def towards(self, other: Any, share: float) -> Any:
        """Return the load at `share` of the way to another."""
        names = [field.name for field in fields(cast(Any, self))]
        values = {n: _between(getattr(self, n), getattr(other, n), share) for n in names}
        return replace(cast(Any, self), **values)


def _between(a, b, share):
    if isinstance(a, tuple):
        return tuple(_between(x, y, share) for x, y in zip(a, b))
    if not np.isfinite(a):
        return a  # no plates here, none on the way
    return a + share * (b - a)


@dataclass(frozen=True)
class Load(LinearLoad):
    """Load of a crossover.

    Parameters
    ----------
    d : (d1, d2) [m] end displacements of warp and weft, per end
    plates : [m] half the distance of two platens; infinite for none
    """

    d: tuple = (0.0, 0.0)
    plates: float = np.inf

    @property
    def drive(self) -> tuple:
        """(2,) what the prescribed displacements are proportional to."""
        return self.d


class YarnsModel:
    """Meshed yarns with their laws; holds scratch arrays, and no history but the damage of fibres
    that may fail.

    Parameters
    ----------
    mesh : meshing.mesh.YarnMesh
    fabric : Fabric, with solid laws
    numerics : Numerics
    held : constraints.Constraints
    surfaces : surfaces.SurfacePairs
    plates : surfaces.Plates, or None
    points : (n, 3) [m] nodes, the mesh's first; more where contact has images of yarns
    copies : of axial and of vertical forces, that the domain stands for
    integration : solid_law.FULL or solid_law.ONE_POINT
    failure : fibres fail

    Raises
    ------
    InputError : the fabric has no solid laws, or is not the one that was meshed
    """

    called = "crossover"  # in messages

    def __init__(
        self,
        mesh: YarnMesh,
        fabric: Fabric,
        numerics: Numerics | None,
        held: Constraints,
        surfaces: SurfacePairs,
        plates: Plates | None,
        *,
        points: FloatArray | None = None,
        copies: tuple[float, float] = (1.0, 1.0),
        integration: int = solid_law.FULL,
        failure: bool = False,
    ) -> None:
        check(mesh, fabric)
        self.crossover = mesh
        self.fabric = fabric
        self.numerics = numerics or Numerics()
        self.points = np.ascontiguousarray(mesh.points if points is None else points, float)
        self.copies = copies
        self.constraints = held
        self.surfaces = surfaces
        self.plates = plates
        self.fibres = Fibres(mesh, fabric, failure)
        self._solid(mesh, fabric, integration)
        self._build_pattern()

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.constraints.size

    def _solid(self, mesh, fabric, integration):
        family = np.asarray(mesh.families)[mesh.yarn]
        self.hexes = np.where(
            family[:, None] == 0,
            mesh.hexes[:, ACROSS_BEFORE_THROUGH[0]],
            mesh.hexes[:, ACROSS_BEFORE_THROUGH[1]],
        )
        self._real = len(mesh.points)
        self._space = HexSpace.build(mesh.points, self.hexes)
        constants = _cell_laws(mesh, fabric, self.numerics.fibre_fraction)
        self._cell_laws = self._space.cell_constants(constants)
        self._solids = Assembler(
            self._space, *solid_law.forms(self._space, self._cell_laws, integration)
        )

    def take_solid_laws(self, fabric: Fabric) -> None:
        """Go on with the solid laws of a fabric that differs from the meshed one in these alone."""
        constants = _cell_laws(self.crossover, fabric, self.numerics.fibre_fraction)
        self._space.set_cell_constants(self._cell_laws, constants)
        self.fabric = fabric

    def _build_pattern(self):
        """Lay out the tangent for the solids and the contact that is expected or has been met."""
        self.pattern = Pattern(
            len(self.points), [self.hexes, *self.surfaces.expected_stencils()], self.constraints
        )
        self.surfaces.build_pattern(self.pattern)
        self._solid_places = self.pattern.scalar_places(self._solids.rows, self._solids.columns)
        self._bar_places = self.pattern.places(self.fibres.pairs)
        faces = () if self.plates is None else self.plates.faces
        self._plate_places = [self.pattern.places(face.nodes[:, None])[:, 0, 0] for face in faces]

    def positions(self, q: FloatArray, load: Any) -> FloatArray:
        """Compute the deformed positions (n, 3) [m]."""
        return self.points + self.constraints.displacement(q, load.drive)

    def forces(self, q: FloatArray, load: Any) -> tuple[FloatArray, float, FloatArray]:
        """Compute the internal forces (n, 3) [N] and the vertical forces of contact and plates.

        Returns
        -------
        forces : (n, 3) [N]; not finite where an element is inverted
        contact : [N] of the meshed part: upwards on the warp
        plates : (2,) [N] on the upper and the lower plate
        """
        x = self.positions(q, load)
        self._deform(x)
        forces = np.zeros_like(x)
        forces[: self._real] = self._solids.residual()
        self.fibres.forces(x, self.numerics, forces)
        contact = self.surfaces.assemble(x, self.numerics, forces)
        return forces, contact, self._press(x, load, forces)

    def system(self, q: FloatArray, load: Any) -> bool:
        """Assemble the tangent into `pattern`; returns True where its pattern had to grow."""
        grown = self.surfaces.pattern_outdated()
        if grown:
            self._build_pattern()
        x = self.positions(q, load)
        n = self.numerics
        pattern = self.pattern
        self._deform(x)
        pattern.values[:] = 0
        pattern.values.reshape(-1)[self._solid_places] += self._solids.tangent()
        self.fibres.tangent(x, n, self._bar_places, pattern.values)
        discarded = np.zeros_like(x)
        self.surfaces.assemble(x, n, discarded, pattern.values)
        self._press(x, load, discarded, self._plate_places)
        pattern.reduce()
        return grown

    def _deform(self, x):
        self._space.set_displacement((x - self.points)[: self._real])

    def _press(self, x, load, forces, places=None):
        if self.plates is None:
            return np.zeros(2)
        return self.plates.press(x, load.plates, self.numerics, forces, places, self.pattern.values)

    def commit(self, q: FloatArray, load: Any) -> None:
        """Let friction go on from this state, an equilibrium; nothing happens without friction."""
        if self.numerics.friction > 0:
            self.forces(q, load)  # the state that the contact search belongs to may be a trial
            x = self.positions(q, load)
            self.surfaces.commit(x, self.numerics)
            if self.plates is not None:
                self.plates.commit(x, load.plates, self.numerics)

    @property
    def stick_state(self) -> FloatArray:
        """(s,) where the points of contact stick: what friction keeps of the past, see `commit`."""
        return np.concatenate([anchors.ravel() for anchors in self._anchors()])

    @stick_state.setter
    def stick_state(self, values: FloatArray) -> None:
        start = 0
        for anchors in self._anchors():
            anchors[:] = values[start : start + anchors.size].reshape(anchors.shape)
            start += anchors.size

    def _anchors(self):
        return [*self.surfaces.anchors, *(() if self.plates is None else self.plates.anchors)]

    def tensions(self, forces: FloatArray) -> FloatArray:
        """Compute the tensions (2,) [N] of the whole warp and weft yarn, from the reactions at
        their ends."""
        return np.array(
            [self.copies[0] * self.constraints.end_force(forces, yarn) for yarn in (0, 1)]
        )

    def fibre_strains(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Compute the strain of every bar (b,), and its mean over the fibres of each yarn."""
        strain = self.fibres.strains(x)
        return strain, self.fibres.means(strain)

    def worst_element(self, x: FloatArray) -> tuple[int, float]:
        """Find the number of the hexahedron with the least corner volume ratio to the undeformed,
        and that ratio."""
        with np.errstate(invalid="ignore"):  # positions of a state that has gone wrong
            volumes = sums.determinant(corner_edges(x, self.hexes))
        ratio = volumes / sums.determinant(corner_edges(self.points, self.hexes))
        cell = int(np.argmin(ratio.min(axis=1)))
        return cell, float(ratio[cell].min())


class CrossoverModel(YarnsModel):
    """A meshed crossover of one warp and one weft.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric, numerics : as in a `YarnsModel`
    **choices : integration, failure: as in a `YarnsModel`

    Raises
    ------
    InputError : the fabric has no solid laws, or is not the one that was meshed
    """

    plates: Plates

    def __init__(
        self, crossover: Crossover, fabric: Fabric, numerics: Numerics | None = None, **choices: Any
    ) -> None:
        check(crossover, fabric)
        quarter = crossover.domain == "quarter"
        points = np.ascontiguousarray(crossover.points, float)
        warp, weft = crossover.grids
        super().__init__(
            crossover,
            fabric,
            numerics,
            constraints.build(crossover.grids, len(points), quarter=quarter),
            SurfacePairs([facing(points, warp, weft, quarter)]),
            Plates(points, [warp[:, :, -1]], [weft[:, :, 0]]),
            copies=(2.0, 4.0) if quarter else (1.0, 1.0),
            **choices,
        )

    def heights(self, x: FloatArray) -> FloatArray:
        """Compute the heights h1, h2 (2,) [m] of the centrelines: middle of the yarn's axis above
        (warp), below (weft) its end."""
        ends = [axis_height(x, grid[-1, self._crossing(grid)[1]]) for grid in self.crossover.grids]
        middles = [axis_height(x, grid[self._crossing(grid)]) for grid in self.crossover.grids]
        return np.array([middles[0] - ends[0], ends[1] - middles[1]])

    def half_thicknesses(self, x: FloatArray) -> FloatArray:
        """Compute the distances (2,) [m] of the axis of warp and weft from the face that meets the
        other, at the crossing."""
        warp, weft = (grid[self._crossing(grid)] for grid in self.crossover.grids)
        return np.array(
            [axis_height(x, warp) - x[warp[0], 2], x[weft[-1], 2] - axis_height(x, weft)]
        )

    def _crossing(self, grid):
        """Place (i, j) of the crossing in the grid of a yarn."""
        if self.crossover.domain == "quarter":
            return 0, 0
        return grid.shape[0] // 2, grid.shape[1] // 2


def _cell_laws(mesh, fabric, fibre_fraction):
    """(m, 6) E_a, a_E [Pa], b_E, Vf0, V_c [-], G [Pa] of each hexahedron."""
    laws = fabric.solid_laws
    if (fibre_fraction or fraction_of(fabric)) == "mesh":
        # the crimp may leave more or less room than was stated (YarnMesh.Vf0)
        laws = [replace(law, Vf0=Vf0) for law, Vf0 in zip(laws, mesh.Vf0)]
    parameters = np.array([(law.E_a, law.a_E, law.b_E, law.Vf0, law.V_c, law.G) for law in laws])
    return parameters[np.asarray(mesh.families)[mesh.yarn]]


def check(mesh: YarnMesh, fabric: Fabric) -> None:
    """Refuse a fabric without solid laws, or a mesh of another fabric.

    Raises
    ------
    InputError : either
    """
    if fabric.solid_laws is None:
        raise InputError(f"fabric {fabric.name} has no [solid] tables, which a 3D crossover needs")
    if mesh.fabric != fabric.name:
        raise InputError(key="fabric", value=fabric.name, allowed=f"the meshed one, {mesh.fabric}")


def axis_height(x: FloatArray, column: IntArray) -> float:
    """Compute the height [m] of the middle of a column of nodes through the thickness."""
    return 0.5 * (x[column[(len(column) - 1) // 2], 2] + x[column[len(column) // 2], 2])
