"""The contact of yarns: pairs of facing surfaces, each in two passes, and the two platens of a
compression test.

What stands in a pair is a side: a `Pass`, or an edge of a yarn (`periodic.Edges`). Each lays out
its part of the tangent, adds its forces, and keeps where its points stuck. `SurfacePairs` hands
every call on to all sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from unitcell3d.assembly import constraints
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact import plate_contact_kernels, slip_kernels, surface_contact_kernels
from unitcell3d.contact.kernel_arguments import (
    Blocks,
    ContactLaw,
    Face,
    PassState,
    PlateFace,
    SlavePoints,
)
from unitcell3d.contact.surface_tangent_kernels import STENCIL
from unitcell3d.material.numerics import Numerics

# cells by which a contact point may slide before the tangent is laid out anew: a few blocks more
# for far fewer layouts
SLIP_MARGIN = 0.3
GAUSS = 2  # points along each side of a slave face
NO_VALUES = np.empty((0, 3, 3))
UNPLACED = np.empty((0, STENCIL, STENCIL), np.int64)


class SurfacePairs:
    """Pairs of surfaces in contact; none for a yarn alone.

    Parameters
    ----------
    pairs : of each pair its sides, such as `facing` makes them

    Attributes
    ----------
    forces : (pairs,) [N] of each pair in the last call of `assemble`: upwards on the upper surface
    """

    def __init__(self, pairs: Sequence[Sequence[Any]]) -> None:
        self.pairs = tuple(pairs)
        self.forces = np.zeros(len(self.pairs))
        self._sides = [side for pair in self.pairs for side in pair]

    @property
    def gaps(self) -> list[FloatArray]:
        """Per side, [m] of the nodes of its surface at the last call of `assemble`, infinite
        without a partner."""
        return [side.gaps for side in self._sides]

    @property
    def deepest(self) -> float:
        """[m] largest penetration where there was a force in the last call of `assemble`."""
        return max((side.deepest for side in self._sides), default=0.0)

    @property
    def anchors(self) -> list[FloatArray]:
        """Per side, where each point stuck last, in parameters of the master; may be written to."""
        return [side.anchors for side in self._sides]

    def expected_stencils(self) -> list[IntArray]:
        """Return the stencils, arrays (m, s), to lay the tangent out for: nodes that all act on
        each other."""
        return [side.expected_stencils() for side in self._sides]

    def build_pattern(self, pattern: Pattern) -> None:
        """Look up the places of the `expected_stencils` in a pattern that holds them."""
        for side in self._sides:
            side.build_pattern(pattern)

    def pattern_outdated(self) -> bool:
        """Tell whether the last call of `assemble` met what the pattern was not laid out for."""
        return any(side.pattern_outdated() for side in self._sides)

    def assemble(
        self,
        x: FloatArray,
        numerics: Numerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """Add internal forces, and the tangent where `values` is given.

        Parameters
        ----------
        x : (n, 3) [m] current positions
        forces : (n, 3) [N] added to
        values : (k, 3, 3) [N/m] blocks of the pattern laid out, added to, or None

        Returns
        -------
        force : [N] the sum of the sizes of the pairs' forces
        """
        for number, pair in enumerate(self.pairs):
            self.forces[number] = sum(side.assemble(x, numerics, forces, values) for side in pair)
        return float(abs(self.forces).sum())

    def commit(self, x: FloatArray, numerics: Numerics) -> None:
        """Let friction go on from the state at `x`, that of the last call of `assemble`."""
        for side in self._sides:
            side.commit(x, numerics)

    def mobilised_friction(self, x: FloatArray, numerics: Numerics) -> float:
        """Compute the share [-] of Coulomb's limit that is mobilised at the state of the last call
        of `assemble`: 0 if all points stick without load, 1 if all slide; 0 without contact."""
        sums = np.array([side.mobilised_friction(x, numerics) for side in self._sides])
        mobilised, normal = sums.sum(axis=0)
        return float(mobilised / normal) if normal > 0 else 0.0


class Pass:
    """The Gauss points of one face on the C1 surface of another.

    Parameters
    ----------
    points : (n, 3) [m] undeformed
    slave, master : Face
    upwards : [-] +1 if the slave lies above the master, else -1
    """

    def __init__(self, points: FloatArray, slave: Face, master: Face, upwards: float) -> None:
        self._master = master
        self._upwards = upwards
        grid = slave.grid
        self._nodes = grid.ravel()
        corners = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        self._quads = np.stack([corner.ravel() for corner in corners], axis=1)
        self._shapes, areas = gauss(points[self._quads])
        self._areas = areas.ravel()
        self._points = SlavePoints(self._quads, self._shapes, self._areas)
        self._cells = np.array(master.grid.shape) - 1
        guess = self._first_guess(points)
        n = areas.size
        self._state = PassState(guess, guess.copy(), np.full(n, np.inf), np.full(n, -1))
        self._known = np.empty(0, np.int64)
        self._row_of = np.full(len(self._quads) * self._cells.prod(), -1)
        self._places = UNPLACED

    def _first_guess(self, points):
        """Parameters of the points on the undeformed master, whose grid is straight in plan."""
        slaves = np.einsum("gk,fkc->fgc", self._shapes, points[self._quads]).reshape(-1, 3)
        grid = self._master.grid
        along, across = self._master.axes
        i = np.interp(slaves[:, along], points[grid[:, 0], along], np.arange(grid.shape[0]))
        j = np.interp(slaves[:, across], points[grid[0, :], across], np.arange(grid.shape[1]))
        return np.stack([i, j], axis=1)

    def _met(self):
        """Codes of the points in contact in the last call of `assemble`."""
        return self._state.codes[self._state.codes >= 0]

    def expected_stencils(self) -> IntArray:
        """Return the stencils (m, 20) of what has been met, and of all points near their closest
        points: what may be met next."""
        face = np.arange(len(self._areas)) // len(self._shapes)
        codes = [self._known, self._met()]
        for shift in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            near = np.floor(self._state.xi + SLIP_MARGIN * np.array(shift))
            cell = np.clip(near, 0, self._cells - 1).astype(np.int64)
            codes.append((face * self._cells[0] + cell[:, 0]) * self._cells[1] + cell[:, 1])
        self._known = np.unique(np.concatenate(codes))
        face, cell = np.divmod(self._known, self._cells.prod())
        ni, nj = self._master.grid.shape
        i = np.clip((cell // self._cells[1])[:, None] + np.arange(-1, 3), 0, ni - 1)
        j = np.clip((cell % self._cells[1])[:, None] + np.arange(-1, 3), 0, nj - 1)
        masters = self._master.grid[i[:, :, None], j[:, None, :]].reshape(-1, 16)
        return np.concatenate([self._quads[face], masters], axis=1)

    def build_pattern(self, pattern: Pattern) -> None:
        """Look up the places of what `expected_stencils` returned last in the tangent's
        `pattern`."""
        stencils = self.expected_stencils()
        self._row_of[self._known] = np.arange(len(self._known))
        self._places = pattern.places(stencils)

    def pattern_outdated(self) -> bool:
        """Tell whether the last call of `assemble` met what has no places."""
        return bool(np.any(self._row_of[self._met()] < 0))

    def assemble(
        self,
        x: FloatArray,
        numerics: Numerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """Add forces and tangent as `SurfacePairs.assemble` does; return the force [N] that presses
        the surfaces apart."""
        resultant = np.zeros(3)
        blocks = Blocks(self._row_of, UNPLACED, NO_VALUES)
        if values is not None:
            blocks = Blocks(self._row_of, self._places, values)
        surface_contact_kernels.contact_pass(
            x,
            self._points,
            self._master,
            contact_law(numerics, 0.5),
            self._state,
            forces,
            blocks,
            resultant,
        )
        return self._upwards * float(resultant[2])

    def commit(self, x: FloatArray, numerics: Numerics) -> None:
        """Let friction go on from the state at `x`, as `SurfacePairs.commit` does."""
        surface_contact_kernels.update_anchors(x, self._master, numerics.slip, self._state)

    def mobilised_friction(self, x: FloatArray, numerics: Numerics) -> tuple[float, float]:
        """Sum over the points [N], at the state of the last call of `assemble`: the normal force
        times the mobilised share of Coulomb's limit (0 in rest, 1 in slip), and the normal
        force."""
        law = contact_law(numerics, 0.5)
        found: tuple[float, float] = slip_kernels.mobilised_friction(
            x, self._points, self._master, law, self._state
        )
        return found

    @property
    def anchors(self) -> FloatArray:
        """(s, 2) [-] where each point stuck last, in parameters of the master; may be written
        to."""
        return self._state.anchors

    @property
    def deepest(self) -> float:
        """[m] largest penetration of a point with a force in the last call of `assemble`."""
        return float(-self._state.gaps[self._state.codes >= 0].min(initial=0.0))

    @property
    def gaps(self) -> FloatArray:
        """[m] of the slave's nodes: mean of the points on the faces that meet there, infinite
        without a partner."""
        gaps = self._state.gaps.reshape(len(self._quads), -1, 1)
        met = np.isfinite(gaps)
        weights = np.where(met, self._areas.reshape(gaps.shape) * self._shapes, 0.0)
        nodes = np.broadcast_to(self._quads[:, None, :], weights.shape).ravel()
        total = np.bincount(nodes, (weights * np.where(met, gaps, 0.0)).ravel())[self._nodes]
        weight = np.bincount(nodes, weights.ravel())[self._nodes]
        return np.divide(total, weight, out=np.full(len(total), np.inf), where=weight > 0)


def facing(
    points: FloatArray,
    upper: IntArray,
    lower: IntArray,
    quarter: bool = False,
    families: Sequence[int] = (0, 1),
) -> tuple[Pass, Pass]:
    """Pair the lower face of one yarn and the upper face of another, each slave once with half the
    penalty.

    A yarn along y counts as the upper one, and one along x as the lower one, with its grid
    transposed.

    Parameters
    ----------
    points : (n, 3) [m] undeformed
    upper, lower : node numbers (i along, j across, k through)
    quarter : whether i = 0 and j = 0 are symmetry planes of both
    families : of the two yarns, 0 along x, 1 along y
    """
    if families[0] == 1:
        upper = upper.transpose(1, 0, 2)
    if families[1] == 0:
        lower = lower.transpose(1, 0, 2)
    over = face(points, upper[:, :, 0], 0, quarter, upwards=False)
    under = face(points, lower[:, :, -1], 1, quarter, upwards=True)
    return Pass(points, over, under, 1.0), Pass(points, under, over, -1.0)


def face(points: FloatArray, grid: IntArray, family: int, quarter: bool, upwards: bool) -> Face:
    """Return the contact surface `Face` of a yarn.

    Parameters
    ----------
    points : (n, 3) [m] undeformed
    grid : (ni, nj) node numbers
    family : 0 warp, 1 weft
    quarter : whether i = 0 and j = 0 are symmetry planes
    upwards : whether the other surface lies above it
    """
    grid = np.ascontiguousarray(grid, np.int64)
    corner = points[grid[0, 0]]
    normal = np.sign(np.cross(points[grid[1, 0]] - corner, points[grid[0, 1]] - corner)[2])
    axes = np.array([constraints.AXIAL[family], constraints.WIDTH[family]])
    mirror = np.array([quarter, quarter])
    return Face(grid, axes, mirror, float(normal if upwards else -normal))


class Plates:
    """Two rigid plates, one above and one below, at equal distances from the middle plane.

    Parameters
    ----------
    points : (n, 3) [m] undeformed
    upper, lower : grids (i, j) of the nodes that the upper and the lower plate may touch

    Attributes
    ----------
    at_rest : [m] half the distance at which they just touch
    """

    def __init__(
        self, points: FloatArray, upper: Sequence[IntArray], lower: Sequence[IntArray]
    ) -> None:
        self.faces = plate_face(points, upper, 1.0), plate_face(points, lower, -1.0)
        above, below = (points[face.nodes, 2] for face in self.faces)
        self.at_rest = float(max(above.max(), -below.min()))

    @property
    def anchors(self) -> list[FloatArray]:
        """Per plate (s, 2) [m] where each node stuck last; may be written to."""
        return [face.anchors for face in self.faces]

    def press(
        self,
        x: FloatArray,
        half_distance: float,
        numerics: Numerics,
        forces: FloatArray,
        places: Sequence[IntArray] | None,
        values: FloatArray,
    ) -> FloatArray:
        """Add internal forces, and the tangent if `places` (per plate, or None) is given; return
        the forces (2,) [N] of the plates."""
        pressed = np.zeros(2)
        if not np.isfinite(half_distance):
            return pressed
        law = contact_law(numerics)
        for plate, face in enumerate(self.faces):
            blocks = np.empty(0, np.int64) if places is None else places[plate]
            height = face.side * half_distance
            pressed[plate] = plate_contact_kernels.plate_pass(
                x, face, height, law, forces, blocks, values
            )
        return pressed

    def commit(self, x: FloatArray, half_distance: float, numerics: Numerics) -> None:
        """Let friction go on from the state at `x`."""
        for face in self.faces:
            height = face.side * half_distance
            plate_contact_kernels.update_plate_anchors(x, face, height, numerics.slip)


def contact_law(numerics: Numerics, share: float = 1.0) -> ContactLaw:
    """Return the `ContactLaw` of the kernels, with a share [-] of the penalty."""
    numbers = (share * numerics.penalty, numerics.toe, numerics.friction, numerics.slip)
    return ContactLaw(*map(float, numbers))


def plate_face(points: FloatArray, grids: Sequence[IntArray], side: float) -> PlateFace:
    """Return the `PlateFace` of the faces `grids` of nodes; `side`: +1 for a plate above, -1
    below."""
    nodes = np.concatenate([grid.ravel() for grid in grids]).astype(np.int64)
    areas = np.concatenate([tributary_areas(points, grid).ravel() for grid in grids])
    return PlateFace(nodes, areas, side, points[nodes, :2].copy())


def gauss(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the shape functions (g, 4) at the Gauss points of quadrilaterals (f, 4, 3) [m], and
    the areas (f, g) [m2] there."""
    places, weights = np.polynomial.legendre.leggauss(GAUSS)
    s, t = (axis.ravel()[:, None] for axis in np.meshgrid(places, places, indexing="ij"))
    a, b = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]).T
    shapes = 0.25 * (1 + a * s) * (1 + b * t)
    along = np.einsum("gk,fkc->fgc", 0.25 * a * (1 + b * t), corners)
    across = np.einsum("gk,fkc->fgc", 0.25 * b * (1 + a * s), corners)
    weights = np.outer(weights, weights).ravel()
    return shapes, np.linalg.norm(np.cross(along, across), axis=-1) * weights


def tributary_areas(points: FloatArray, grid: IntArray) -> FloatArray:
    """Compute the areas [m2] of the nodes of a face: a quarter of each quadrilateral to each of its
    corners."""
    x = points[grid]
    diagonals = np.cross(x[1:, 1:] - x[:-1, :-1], x[:-1, 1:] - x[1:, :-1])
    quads = 0.5 * np.linalg.norm(diagonals, axis=-1)
    areas = np.zeros(grid.shape)
    for i in (0, 1):
        for j in (0, 1):
            areas[i : i + quads.shape[0], j : j + quads.shape[1]] += quads / 4
    return areas
