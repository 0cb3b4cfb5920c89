"""The contact of a crossover: the two facing surfaces in two passes, and the two plates of a compression test."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.checks import FloatArray, IntArray
from unitcell3d.assembly import constraints
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact import plate_contact_kernels, slip_kernels, surface_contact_kernels
from unitcell3d.contact.interface import PenaltyNumerics
from unitcell3d.contact.kernel_arguments import (
    Blocks,
    ContactLaw,
    Face,
    PassState,
    PlateFace,
    SlavePoints,
)
from unitcell3d.contact.surface_tangent_kernels import STENCIL

# cells by which a contact point may slide before the tangent is laid out anew: a few blocks more for far fewer layouts
SLIP_MARGIN = 0.3
GAUSS = 2  # points along each side of a slave face
NO_VALUES = np.empty((0, 3, 3))
UNPLACED = np.empty((0, STENCIL, STENCIL), np.int64)


def face(points: FloatArray, grid: IntArray, family: int, quarter: bool, upwards: bool) -> Face:
    """The contact surface `Face` of a yarn.

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
    return Face(grid, axes, np.array([quarter, quarter]), float(normal if upwards else -normal))


class Pass:
    """The Gauss points of one face on the C1 surface of another.

    Parameters
    ----------
    points : (n, 3) [m] undeformed
    slave, master : Face
    """

    def __init__(self, points: FloatArray, slave: Face, master: Face) -> None:
        self._master = master
        grid = slave.grid
        self._nodes = grid.ravel()
        corners = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        self._quads = np.stack([corner.ravel() for corner in corners], axis=1)
        self._shapes, areas = gauss(points[self._quads])
        self._areas = areas.ravel()
        self._points = SlavePoints(self._quads, self._shapes, self._areas)
        self._cells = np.array(master.grid.shape) - 1
        guess, n = self._first_guess(points), areas.size
        self._state = PassState(guess, guess.copy(), np.full(n, np.inf), np.full(n, -1))
        self._known = np.empty(0, np.int64)
        self._row_of = np.full(len(self._quads) * self._cells.prod(), -1)
        self._places = UNPLACED

    def _first_guess(self, points):
        """Parameters of the points on the undeformed master, whose grid is straight in plan."""
        slaves, master = (
            np.einsum("gk,fkc->fgc", self._shapes, points[self._quads]).reshape(-1, 3),
            self._master,
        )
        lines = points[master.grid[:, 0], master.axes[0]], points[master.grid[0, :], master.axes[1]]
        return np.stack(
            [
                np.interp(slaves[:, axis], line, np.arange(len(line)))
                for axis, line in zip(master.axes, lines)
            ],
            axis=1,
        )

    def _met(self):
        """Codes of the points in contact in the last call of `assemble`."""
        return self._state.codes[self._state.codes >= 0]

    def expected_stencils(self) -> IntArray:
        """(m, 20) stencils of what has been met, and of all points near their closest points: what may be met next."""
        face = np.arange(len(self._areas)) // len(self._shapes)
        codes = [self._known, self._met()]
        for shift in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            cell = np.clip(
                np.floor(self._state.xi + SLIP_MARGIN * np.array(shift)), 0, self._cells - 1
            ).astype(np.int64)
            codes.append((face * self._cells[0] + cell[:, 0]) * self._cells[1] + cell[:, 1])
        self._known = np.unique(np.concatenate(codes))
        face, cell = np.divmod(self._known, self._cells.prod())
        ni, nj = self._master.grid.shape
        i = np.clip((cell // self._cells[1])[:, None] + np.arange(-1, 3), 0, ni - 1)
        j = np.clip((cell % self._cells[1])[:, None] + np.arange(-1, 3), 0, nj - 1)
        return np.concatenate(
            [self._quads[face], self._master.grid[i[:, :, None], j[:, None, :]].reshape(-1, 16)],
            axis=1,
        )

    def build_pattern(self, pattern: Pattern) -> None:
        """Look up the places of what `expected_stencils` returned last in the tangent's `pattern`."""
        stencils = self.expected_stencils()
        self._row_of[self._known] = np.arange(len(self._known))
        self._places = pattern.places(stencils)

    def pattern_outdated(self) -> bool:
        """Whether the last call of `assemble` met what has no places."""
        return bool(np.any(self._row_of[self._met()] < 0))

    def assemble(
        self,
        x: FloatArray,
        numerics: PenaltyNumerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> FloatArray:
        """Adds internal forces, and the tangent where `values` is given.

        Parameters
        ----------
        x : (n, 3) [m] current positions
        numerics : Numerics
        forces : (n, 3) [N] added to
        values : (k, 3, 3) [N/m] blocks of the pattern laid out, added to, or None

        Returns
        -------
        resultant : (3,) [N] on the slave
        """
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
        return resultant

    def commit(self, x: FloatArray, numerics: PenaltyNumerics) -> None:
        """The state at `x`, that of the last call of `assemble`, is where friction goes on from."""
        surface_contact_kernels.update_anchors(x, self._master, numerics.slip, self._state)

    def mobilised_friction(self, x: FloatArray, numerics: PenaltyNumerics) -> tuple[float, float]:
        """[N] sums over the points, at the state of the last call of `assemble`: of the normal force times the
        mobilised share of Coulomb's limit (0 in rest, 1 in slip), and of the normal force."""
        law = contact_law(numerics, 0.5)
        found: tuple[float, float] = slip_kernels.mobilised_friction(
            x, self._points, self._master, law, self._state
        )
        return found

    @property
    def anchors(self) -> FloatArray:
        """(s, 2) [-] where each point stuck last, in parameters of the master; may be written to."""
        return self._state.anchors

    @property
    def deepest(self) -> float:
        """[m] largest penetration of a point with a force in the last call of `assemble`."""
        return float(-self._state.gaps[self._state.codes >= 0].min(initial=0.0))

    @property
    def node_gaps(self) -> FloatArray:
        """[m] of the slave's nodes: mean of the points on the faces that meet there, infinite without a partner."""
        share = self._areas.reshape(-1, len(self._shapes), 1) * self._shapes
        gaps = np.broadcast_to(self._state.gaps.reshape(share.shape[:2])[:, :, None], share.shape)
        share = np.where(np.isfinite(gaps), share, 0.0)
        nodes = np.broadcast_to(self._quads[:, None, :], share.shape)
        size = self._nodes.max() + 1
        total = np.bincount(nodes.ravel(), (share * np.where(share > 0, gaps, 0.0)).ravel(), size)[
            self._nodes
        ]
        weight = np.bincount(nodes.ravel(), share.ravel(), size)[self._nodes]
        return np.where(weight > 0, total / np.where(weight > 0, weight, 1.0), np.inf)


class FacingSurfaces:
    """The lower face of the warp and the upper face of the weft, each slave once with half the penalty.

    Parameters
    ----------
    points : (n, 3) [m] undeformed
    grids : per yarn, node numbers (i along, j across, k through)
    quarter : whether i = 0 and j = 0 are symmetry planes
    """

    def __init__(self, points: FloatArray, grids: Sequence[IntArray], quarter: bool) -> None:
        warp = face(points, grids[0][:, :, 0], 0, quarter, upwards=False)
        weft = face(points, grids[1][:, :, -1], 1, quarter, upwards=True)
        self._passes = Pass(points, warp, weft), Pass(points, weft, warp)

    @property
    def gaps(self) -> Sequence[FloatArray]:
        """Per yarn, [m] of the nodes of its face at the last call of `assemble`, infinite without a partner."""
        return [side.node_gaps for side in self._passes]

    @property
    def deepest(self) -> float:
        """[m] largest penetration where there was a force in the last call of `assemble`."""
        return max(side.deepest for side in self._passes)

    def expected_stencils(self) -> list[IntArray]:
        """Arrays (m, s) of the stencils to lay the tangent out for: nodes that all act on each other."""
        return [side.expected_stencils() for side in self._passes]

    def build_pattern(self, pattern: Pattern) -> None:
        """Look up the places of the `expected_stencils` in a pattern that holds them."""
        for side in self._passes:
            side.build_pattern(pattern)

    def pattern_outdated(self) -> bool:
        """Whether the last call of `assemble` met what the pattern was not laid out for."""
        return any(side.pattern_outdated() for side in self._passes)

    def assemble(
        self,
        x: FloatArray,
        numerics: PenaltyNumerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """Both passes, as `Pass.assemble`; returns the force [N] upwards on the warp."""
        up, down = (side.assemble(x, numerics, forces, values) for side in self._passes)
        return up[2] - down[2]

    @property
    def anchors(self) -> list[FloatArray]:
        """Per pass, where each point stuck last, in parameters of the master; written to as well."""
        return [side.anchors for side in self._passes]

    def commit(self, x: FloatArray, numerics: PenaltyNumerics) -> None:
        """The state of the last call of `assemble` is where friction goes on from."""
        for side in self._passes:
            side.commit(x, numerics)

    def mobilised_friction(self, x: FloatArray, numerics: PenaltyNumerics) -> float:
        """[-] share of Coulomb's limit that is mobilised at the state of the last call of `assemble`: 0 where all
        points stick without load, 1 where all slide; 0 without contact."""
        sums = [side.mobilised_friction(x, numerics) for side in self._passes]
        whole = sum(normal for _, normal in sums)
        return sum(part for part, _ in sums) / whole if whole > 0 else 0.0


class Plates:
    """Two rigid plates, one above the warp and one below the weft, at equal distances from the middle plane."""

    def __init__(self, points: FloatArray, grids: Sequence[IntArray]) -> None:
        self._face(points, [grids[0][:, :, -1]], [grids[1][:, :, 0]])

    def _face(self, points, upper, lower):
        """Take up the faces, grids of nodes, that the upper and the lower plate may touch."""
        self.faces = [plate_face(points, *of) for of in ((upper, 1.0), (lower, -1.0))]
        above, below = (points[face.nodes, 2] for face in self.faces)
        self.at_rest = float(
            max(above.max(), -below.min())
        )  # [m] half the distance at which they just touch

    @property
    def anchors(self) -> list[FloatArray]:
        """Per plate (s, 2) [m] where each node stuck last; may be written to."""
        return [face.anchors for face in self.faces]

    def press(
        self,
        x: FloatArray,
        half_distance: float,
        numerics: PenaltyNumerics,
        forces: FloatArray,
        places: Sequence[IntArray] | None,
        values: FloatArray,
    ) -> FloatArray:
        """Adds internal forces, and the tangent where `places` (per plate, or None) is given; returns (2,) [N]."""
        pressed = np.zeros(2)
        if np.isfinite(half_distance):
            law = contact_law(numerics)
            for plate, face in enumerate(self.faces):
                blocks = np.empty(0, np.int64) if places is None else places[plate]
                height = face.side * half_distance
                pressed[plate] = plate_contact_kernels.plate_pass(
                    x, face, height, law, forces, blocks, values
                )
        return pressed

    def commit(self, x: FloatArray, half_distance: float, numerics: PenaltyNumerics) -> None:
        """The state at `x` is where friction goes on from."""
        for face in self.faces:
            plate_contact_kernels.update_plate_anchors(
                x, face, face.side * half_distance, numerics.slip
            )


def contact_law(numerics: PenaltyNumerics, share: float = 1.0) -> ContactLaw:
    """The `ContactLaw` of a `model.crossover.Numerics`, with a share [-] of the penalty."""
    return ContactLaw(
        float(share * numerics.penalty),
        float(numerics.toe),
        float(numerics.friction),
        float(numerics.slip),
    )


def plate_face(points: FloatArray, grids: Sequence[IntArray], side: float) -> PlateFace:
    """The `PlateFace` of the faces `grids` of nodes; `side`: +1 for a plate above, -1 below."""
    nodes = np.concatenate([grid.ravel() for grid in grids]).astype(np.int64)
    areas = np.concatenate([tributary_areas(points, grid).ravel() for grid in grids])
    return PlateFace(nodes, areas, side, points[nodes, :2].copy())


def gauss(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shape functions (g, 4) at the Gauss points of quadrilaterals (f, 4, 3) [m], and the areas (f, g) [m2] there."""
    places, weights = np.polynomial.legendre.leggauss(GAUSS)
    s, t = (axis.ravel() for axis in np.meshgrid(places, places, indexing="ij"))
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    shapes = np.stack([0.25 * (1 + a * s) * (1 + b * t) for a, b in signs], axis=1)
    slopes = [
        np.stack([0.25 * a * (1 + b * t) for a, b in signs], axis=1),
        np.stack([0.25 * b * (1 + a * s) for a, b in signs], axis=1),
    ]
    along, across = (np.einsum("gk,fkc->fgc", slope, corners) for slope in slopes)
    return shapes, np.linalg.norm(np.cross(along, across), axis=-1) * np.outer(
        weights, weights
    ).ravel()


def tributary_areas(points: FloatArray, grid: IntArray) -> FloatArray:
    """Areas [m2] of the nodes of a face: a quarter of each quadrilateral to each of its corners."""
    x = points[grid]
    quads = 0.5 * np.linalg.norm(
        np.cross(x[1:, 1:] - x[:-1, :-1], x[:-1, 1:] - x[1:, :-1]), axis=-1
    )
    areas = np.zeros(grid.shape)
    for i in (0, 1):
        for j in (0, 1):
            areas[i : i + quads.shape[0], j : j + quads.shape[1]] += quads / 4
    return areas
