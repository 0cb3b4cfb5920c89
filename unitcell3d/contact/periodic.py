"""Who meets whom in a cell of the weave: crossing yarns, and parallel neighbours where they pass
each other.

Crossing yarns meet as in a crossover, over their crossing alone: beyond, the faces of their sharp
tips would be met from behind, and slack yarns would snap. Parallel neighbours are on opposite sides of the fabric over
every crossing and at one height between two, where the tips of their sections can meet: the edge of
one is held off the edge of the next.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray, IntArray
from meshing.mesh import YarnMesh
from unitcell3d.assembly.constraints import VERTICAL
from unitcell3d.assembly.periodic_images import Images
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact import edge_contact_kernels
from unitcell3d.contact.surfaces import NO_VALUES, Pass, facing
from unitcell3d.material.numerics import Numerics

NO_PLACES = np.empty((0, 0), np.int64)


class Edges:
    """The edge of one yarn (`first`) and that of its neighbour towards growing x or y (`second`):
    node numbers (i, k).

    The edges count as the curves through the middle of their thickness. The penalty acts on the
    area over which strips as thick as the yarns would cross, t1 t2 / sin(angle): on that of the cut
    tips alone the edges would go through each other before the weave locks.

    across : component that leads from the one to the other
    thicknesses : (2,) [m] of the yarns
    """

    anchors = np.empty((0, 2))  # edges slide without friction

    def __init__(
        self,
        points: FloatArray,
        first: IntArray,
        second: IntArray,
        across: int,
        thicknesses: Sequence[float],
    ) -> None:
        middle = first.shape[1] // 2
        self._edges = [np.ascontiguousarray(edge[:, middle], np.int64) for edge in (first, second)]
        a, b = (points[edge[-1]] - points[edge[0]] for edge in self._edges)
        sine = float(sums.norm(np.cross(a, b)) / (sums.norm(a) * sums.norm(b)))
        self._area = thicknesses[0] * thicknesses[1] / sine
        self._toward = np.eye(3)[across]
        self.gaps = np.array([np.inf])
        # that acted on each other at the last call of `assemble`
        self._nodes = np.full(8, -1)
        self._met = np.empty((0, 8), np.int64)
        self._pattern: Pattern  # from the first call of `build_pattern` on

    @property
    def deepest(self) -> float:
        """[m] penetration at the last call of `assemble`."""
        return max(-float(self.gaps[0]), 0.0) if self._nodes[0] >= 0 else 0.0

    def expected_stencils(self) -> IntArray:
        """Return the stencils that have been met: a contact at one point is cheap to lay out when
        it is."""
        if self._nodes[0] >= 0:
            self._met = np.unique(np.concatenate([self._met, self._nodes[None]]), axis=0)
        return self._met

    def build_pattern(self, pattern: Pattern) -> None:
        """Keep the pattern, as `surfaces.SurfacePairs.build_pattern` does."""
        self._pattern = pattern

    def pattern_outdated(self) -> bool:
        """Tell whether the pattern lacks what was met, as `surfaces.SurfacePairs.pattern_outdated`
        does."""
        return self._nodes[0] >= 0 and not self._pattern.holds(self._nodes[None])

    def commit(self, x: FloatArray, numerics: Numerics) -> None:
        """Keep nothing: edges slide without friction."""

    def assemble(
        self,
        x: FloatArray,
        numerics: Numerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """Add forces and tangent as `surfaces.SurfacePairs.assemble` does; return the force [N]
        between the edges."""
        places = NO_PLACES
        if values is not None and self._nodes[0] >= 0:
            places = self._pattern.places(self._nodes[None])[0]
        first, second = self._edges
        self.gaps[0], force = edge_contact_kernels.edge_pass(
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


def crossings(mesh: YarnMesh, cells: int) -> list[tuple[Pass, Pass]]:
    """Pair the crossing yarns of a cell, each warp with each weft.

    Parameters
    ----------
    mesh : meshing.mesh.YarnMesh
    cells : columns of elements of one crossing
    """
    points = np.asarray(mesh.points, float)
    found = []
    for warp in _yarns(mesh, 0):
        for weft in _yarns(mesh, 1):
            over, height = _crossing(mesh, warp, weft, cells)
            under, depth = _crossing(mesh, weft, warp, cells)
            if height > depth:
                found.append(facing(points, over, under))
            else:
                found.append(facing(points, under, over, families=(1, 0)))
    return found


def neighbours(mesh: YarnMesh, images: Images, cells: int) -> list[tuple[Edges]]:
    """Pair the parallel neighbours of a cell, first warps, then wefts; some of them are images.

    Parameters
    ----------
    mesh, cells : as in `crossings`
    images : periodic_images.Images
    """
    reach = cells // 2
    found = []
    for family in (0, 1):
        thick = mesh.sections[family].thickness
        yarns = _yarns(mesh, family)
        for yarn, next_yarn in zip(yarns, [*yarns[1:], yarns[0]]):
            # the last one's neighbour is the image of the first, one cell further across
            step = int(yarn == yarns[-1])
            m, n = (0, step) if family == 0 else (step, 0)
            first = images.extended(yarn, 0, 0, reach)
            second = images.extended(next_yarn, m, n, reach)
            # they pass each other at each end of a crossing; of the two ends of the cell, one
            for end in range(cells, len(mesh.grids[yarn]), cells):
                # the grid begins `reach` columns early
                part = slice(end, end + 2 * reach + 1)
                found.append((first[part, -1], second[part, 0], 1 - family, (thick, thick)))
    return [(Edges(images.points, *pair),) for pair in found]


def _yarns(mesh, family):
    """Numbers of the yarns of a family."""
    return [yarn for yarn, of in enumerate(mesh.families) if of == family]


def _crossing(mesh, yarn, other, cells):
    """The part of a yarn's grid where it crosses another, and the height [m] of its middle."""
    axis = mesh.families[yarn]
    grid = mesh.grids[yarn]
    place = mesh.points[mesh.grids[other], axis].mean()
    middle = mesh.points[grid[:, grid.shape[1] // 2, 0], axis]
    at = int(np.argmin(abs(middle - place)))
    part = grid[at - cells // 2 : at + cells // 2 + 1]
    nx, ny, nz = part.shape
    return part, mesh.points[part[nx // 2, ny // 2, nz // 2], VERTICAL]
