"""Who meets whom in a cell of the weave: crossing yarns, and parallel neighbours where they pass each other.

Crossing yarns meet as in a crossover, over their crossing and a margin beyond, for a sheared yarn is wider along the
other than it was. Parallel neighbours are on opposite sides of the fabric over every crossing and at one height between
two, where the tips of their sections can meet: the edge of one is held off the edge of the next.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.checks import FloatArray, IntArray
from meshing.mesh import YarnMesh
from unitcell3d.assembly.periodic_images import Images
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact import edge_contact_kernels
from unitcell3d.contact.interface import PenaltyNumerics
from unitcell3d.contact.pairs import SurfacePairs, facing
from unitcell3d.contact.surfaces import NO_VALUES, FacingSurfaces

NO_PLACES = np.empty((0, 0), np.int64)


class CellPairs(SurfacePairs):
    """The crossings first, then the neighbours.

    crossings, neighbours : numbers of pairs
    """

    def __init__(self, crossings: Sequence[FacingSurfaces], neighbours: Sequence[Edges]) -> None:
        super().__init__((*crossings, *neighbours))
        self.crossings, self.neighbours = len(crossings), len(neighbours)


class Edges:
    """The edge of one yarn (`first`) and that of its neighbour towards growing x or y (`second`): node numbers (i, k).

    The edges count as the curves through the middle of their thickness. The penalty acts on the area over which strips
    as thick as the yarns would cross, t1 t2 / sin(angle): on that of the cut tips alone the edges would go through each
    other before the weave locks.

    across : component that leads from the one to the other
    thicknesses : (2,) [m] of the yarns
    """

    def __init__(
        self,
        points: FloatArray,
        first: IntArray,
        second: IntArray,
        across: int,
        thicknesses: Sequence[float],
    ) -> None:
        self._edges = [
            np.ascontiguousarray(edge[:, edge.shape[1] // 2], np.int64) for edge in (first, second)
        ]
        slopes = [points[edge[-1]] - points[edge[0]] for edge in self._edges]
        sine = np.linalg.norm(np.cross(*slopes)) / np.prod(
            [np.linalg.norm(slope) for slope in slopes]
        )
        self._area = thicknesses[0] * thicknesses[1] / sine
        self._toward = np.eye(3)[across]
        self.gaps = (np.array([np.inf]),)
        self._nodes = np.full(8, -1)  # that acted on each other at the last call of `assemble`
        self._met = np.empty((0, 8), np.int64)
        self._pattern: Pattern  # from the first call of `build_pattern` on

    @property
    def deepest(self) -> float:
        """[m] penetration at the last call of `assemble`."""
        return max(-float(self.gaps[0][0]), 0.0) if self._nodes[0] >= 0 else 0.0

    def expected_stencils(self) -> list[IntArray]:
        """What has been met: a contact at one point is cheap to lay out when it is."""
        if self._nodes[0] >= 0:
            self._met = np.unique(np.concatenate([self._met, self._nodes[None]]), axis=0)
        return [self._met]

    def build_pattern(self, pattern: Pattern) -> None:
        """As of `surfaces.FacingSurfaces`."""
        self._pattern = pattern

    def pattern_outdated(self) -> bool:
        """As of `surfaces.FacingSurfaces`."""
        return self._nodes[0] >= 0 and not self._pattern.holds(self._nodes[None])

    @property
    def anchors(self) -> list[FloatArray]:
        """None: edges slide without friction."""
        return []

    def commit(self, x: FloatArray, numerics: PenaltyNumerics) -> None:
        """Edges slide without friction."""

    def assemble(
        self,
        x: FloatArray,
        numerics: PenaltyNumerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """As of `surfaces.FacingSurfaces`; returns the force [N] between the edges."""
        places = NO_PLACES
        if values is not None and self._nodes[0] >= 0:
            places = self._pattern.places(self._nodes[None])[0]
        first, second = self._edges
        self.gaps[0][0], force = edge_contact_kernels.edge_pass(
            x,
            first,
            second,
            self._toward,
            self._area,
            numerics.penalty,
            numerics.toe,
            self._nodes,
            forces,
            places,
            NO_VALUES if values is None else values,
        )
        return force


def contacts(mesh: YarnMesh, images: Images, cells: int, margin: int) -> CellPairs:
    """All pairs of a cell.

    Parameters
    ----------
    mesh : meshing.mesh.YarnMesh
    images : periodic_images.Images
    cells : columns of elements of one crossing
    margin : columns beyond it in which crossing yarns meet
    """
    crossings = [_crossing(mesh, images, a, b, cells, margin) for a, b in _crossing_yarns(mesh)]
    reach, neighbours = cells // 2, []
    thick = [section.thickness for section in mesh.sections]
    for family in (0, 1):
        own = [yarn for yarn, of in enumerate(mesh.families) if of == family]
        for place, yarn in enumerate(own):
            last = place == len(own) - 1
            next_yarn, step = (own[0], 1) if last else (own[place + 1], 0)
            m, n = (0, step) if family == 0 else (step, 0)
            first, second = (
                images.extended(yarn, 0, 0, reach),
                images.extended(next_yarn, m, n, reach),
            )
            # they pass each other at each end of a crossing; of the two ends of the cell, one
            for end in range(cells, len(mesh.grids[yarn]), cells):
                part = slice(end, end + 2 * reach + 1)  # the grid begins `reach` columns early
                neighbours.append(
                    (first[part, -1], second[part, 0], 1 - family, (thick[family],) * 2)
                )
    points = images.points
    return CellPairs(
        [facing(points, *pair) for pair in crossings], [Edges(points, *pair) for pair in neighbours]
    )


def _crossing_yarns(mesh):
    """Numbers of the warp and the weft of each crossing."""
    warps, wefts = (
        [yarn for yarn, of in enumerate(mesh.families) if of == family] for family in (0, 1)
    )
    return [(a, b) for a in warps for b in wefts]


def _crossing(mesh, images, warp, weft, cells, margin):
    """(upper grid, lower grid, quarter, families) of a crossing."""
    parts = []
    for yarn, other, axis in ((warp, weft, 0), (weft, warp, 1)):
        grid, place = (
            images.extended(yarn, 0, 0, margin),
            mesh.points[mesh.grids[other], axis].mean(),
        )
        at = int(np.argmin(np.abs(images.points[grid[:, grid.shape[1] // 2, 0], axis] - place)))
        parts.append(grid[at - cells // 2 - margin : at + cells // 2 + margin + 1])
    middle = [part[len(part) // 2, part.shape[1] // 2, part.shape[2] // 2] for part in parts]
    over = images.points[middle[0], 2] > images.points[middle[1], 2]
    return (*(parts if over else parts[::-1]), False, (0, 1) if over else (1, 0))
