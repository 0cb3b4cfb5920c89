"""Who meets whom in a cell of the weave: crossing yarns, and parallel neighbours where they pass
each other.

Crossing yarns meet as in a crossover, over their crossing alone: beyond, the faces of their sharp
tips would be met from behind, and slack yarns would snap. Parallel neighbours are on opposite sides of the fabric over
every crossing and at one height between two, where the tips of their sections can meet: the edge of
one is held off the edge of the next.
"""

from __future__ import annotations

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray, IntArray
from meshing.mesh import YarnMesh
from unitcell3d.assembly.constraints import VERTICAL
from unitcell3d.assembly.periodic_images import Images
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact import edge_contact_kernels, side_contact_kernels
from unitcell3d.contact.surfaces import NO_VALUES, Pass, facing
from unitcell3d.material.numerics import Numerics

NO_PLACES = np.empty((0, 0), np.int64)


class Frictionless:
    """A contact that slides without friction: it has nothing to keep from a step to the next. What of it has
    been met is laid out in the tangent.

    nodes : (points, m) that acted on each other at the last call of `assemble`; -1 where none did
    """

    anchors = np.empty((0, 2))

    def __init__(self, nodes: IntArray) -> None:
        self._nodes = nodes
        self._met = np.empty((0, nodes.shape[1]), np.int64)
        self._pattern: Pattern  # from the first call of `build_pattern` on
        self.gaps = np.full(len(nodes), np.inf)

    def _acting(self):
        return self._nodes[self._nodes[:, 0] >= 0]

    def expected_stencils(self) -> IntArray:
        """Return the stencils that have been met: a contact at few points is cheap to lay out when
        it is."""
        self._met = np.unique(np.concatenate([self._met, self._acting()]), axis=0)
        return self._met

    def build_pattern(self, pattern: Pattern) -> None:
        """Keep the pattern, as `surfaces.SurfacePairs.build_pattern` does."""
        self._pattern = pattern

    def pattern_outdated(self) -> bool:
        """Tell whether the pattern lacks what was met, as `surfaces.SurfacePairs.pattern_outdated`
        does."""
        met = self._acting()
        return len(met) > 0 and not self._pattern.holds(met)

    def commit(self, x: FloatArray, numerics: Numerics) -> None:
        """Keep nothing."""

    def mobilised_friction(self, x: FloatArray, numerics: Numerics) -> tuple[float, float]:
        """Return 0 and 0: no friction resists."""
        return 0.0, 0.0


class Edges(Frictionless):
    """The edge of one yarn (`first`) and that of its neighbour towards growing x or y (`second`):
    node numbers (i, k).

    The edges count as the curves through the middle of their thickness. The penalty acts on the
    area over which strips as thick as the yarns would cross, t^2 / sin(angle): on that of the cut
    tips alone the edges would go through each other before the weave locks.

    across : component that leads from the one to the other
    thickness : [m] of the yarns
    """

    def __init__(
        self,
        points: FloatArray,
        first: IntArray,
        second: IntArray,
        across: int,
        thickness: float,
    ) -> None:
        middle = first.shape[1] // 2
        self._edges = [np.ascontiguousarray(edge[:, middle], np.int64) for edge in (first, second)]
        a, b = (points[edge[-1]] - points[edge[0]] for edge in self._edges)
        sine = float(sums.norm(np.cross(a, b)) / (sums.norm(a) * sums.norm(b)))
        self._area = thickness**2 / sine
        self._toward = np.eye(3)[across]
        super().__init__(np.full((1, 8), -1))

    @property
    def deepest(self) -> float:
        """[m] penetration at the last call of `assemble`."""
        return max(-float(self.gaps[0]), 0.0) if len(self._acting()) else 0.0

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
        acting = self._acting()
        if values is not None and len(acting):
            places = self._pattern.places(acting)[0]
        first, second = self._edges
        self.gaps[0], force = edge_contact_kernels.edge_pass(
            x,
            first,
            second,
            self._toward,
            self._area,
            numerics.penalty,
            numerics.toe,
            self._nodes[0],
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


class Sides(Frictionless):
    """The side of one yarn that lies along that of a parallel neighbour at its own height: points of its
    edge held off the neighbour's edge, with the normal in the plane, from the one to the other.

    Each flank, from the middle of its yarn to the tip, counts by the mean of its nodes. Points stand in the
    middles of its elements and press on as much area as they have length, times the yarn's thickness, as far as they
    face each other at rest.

    first, second : node numbers (i, m) of the slave flank and of the master's
    toward : component that leads from the first to the second
    sign : +1 where it grows
    areas : [m2] of the points
    share : [-] of the penalty
    offset : [m] sum of the distances of both tips from the means of their flanks, at rest
    """

    def __init__(
        self,
        first: IntArray,
        second: IntArray,
        toward: int,
        sign: float,
        areas: FloatArray,
        guess: FloatArray,
        share: float,
        offset: float,
    ) -> None:
        acting = np.flatnonzero(areas > 0)
        self._slaves = np.concatenate([first[:-1], first[1:]], axis=1)[acting].astype(np.int64)
        self._master = np.ascontiguousarray(second, np.int64)
        self._offset = offset
        self._size = 6 * second.shape[1]
        self._toward = sign * np.eye(3)[toward]
        self._areas = areas[acting]
        self._share = share
        self._t = guess[acting].astype(float)
        self.forces = np.zeros(len(acting))
        super().__init__(np.full((len(acting), self._size), -1))

    @property
    def deepest(self) -> float:
        """[m] penetration at the last call of `assemble`."""
        return float(max(-self.gaps.min(initial=np.inf), 0.0))

    def assemble(
        self,
        x: FloatArray,
        numerics: Numerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """Add forces and tangent as `surfaces.SurfacePairs.assemble` does; return the force [N]
        between the sides."""
        places = np.empty((0, self._size, self._size), np.int64)
        if values is not None and len(self._areas):
            places = self._pattern.places(np.maximum(self._nodes, 0))
        return side_contact_kernels.side_pass(
            x,
            self._slaves,
            self._master,
            self._toward,
            self._areas,
            self._offset,
            self._share * numerics.penalty,
            numerics.toe,
            self._t,
            self.gaps,
            self.forces,
            self._nodes,
            forces,
            places,
            NO_VALUES if values is None else values,
        )


def neighbours(mesh: YarnMesh, images: Images, cells: int) -> list[tuple[int, Edges]]:
    """Pair the parallel neighbours of a cell where they pass each other, first warps, then wefts; some of
    them are images. Returns each with its family.

    Parameters
    ----------
    mesh, cells : as in `crossings`
    images : periodic_images.Images
    """
    reach = cells // 2
    found = []
    for family, thick, first, second in _parallel_neighbours(mesh, images, reach):
        # they pass each other at each end of a crossing; of the two ends of the cell, one
        for end in range(cells, len(first) - 2 * reach, cells):
            # the grid begins `reach` columns early
            part = slice(end, end + 2 * reach + 1)
            one, other = first[part], second[part]
            rises = [
                images.points[g[-1], VERTICAL].mean() - images.points[g[0], VERTICAL].mean()
                for g in (one, other)
            ]
            if rises[0] * rises[1] < -1e-3 * thick**2:
                pair = one[:, -1], other[:, 0], 1 - family, thick
                found.append((family, pair))
    # all images are there now
    return [(family, Edges(images.points, *pair)) for family, pair in found]


def sides(mesh: YarnMesh, images: Images, cells: int) -> list[tuple[int, Sides]]:
    """Pair the parallel neighbours of a cell where they lie side by side, on one side of the fabric at a
    crossing. Returns each with its family; parameters as of `neighbours`."""
    reach = cells // 2
    found = []
    for family, thick, first, second in _parallel_neighbours(mesh, images, reach):
        size = len(first) - 2 * reach - 1
        at = np.arange(size) + reach  # elements of the cell in the extended grids
        heights = [images.points[g, VERTICAL].mean(axis=(1, 2)) for g in (first, second)]
        middle = reach + cells * (np.arange(size) // cells) + reach  # of the crossing of each
        level = heights[0][middle] * heights[1][middle] > 0
        apart = abs(heights[1] - heights[0])
        apart = 0.5 * (apart[at] + apart[at + 1])
        near = np.where(level, np.clip(1 - (2 * apart / thick) ** 2, 0, 1) ** 2, 0.0)
        if not near.any():
            continue
        half = first.shape[1] // 2
        ones = first[:, half + 1 :], second[:, :half]
        flanks = [one.reshape(len(one), -1) for one in ones]
        tips = first[:, -1], second[:, 0]
        offset = sum(
            abs(images.points[a][..., 1 - family].mean() - images.points[b][..., 1 - family].mean())
            for a, b in zip(flanks, tips)
        )
        for number, sign in ((0, 1.0), (1, -1.0)):
            slave, master = flanks[number], flanks[1 - number]
            place = images.points[slave].mean(axis=1)
            length = np.sqrt((np.diff(place, axis=0) ** 2).sum(axis=1))
            areas = length[at] * thick * near
            part = slave[reach : reach + size + 1]
            found.append(
                (family, Sides(part, master, 1 - family, sign, areas, at + 0.5, 0.5, offset))
            )
    return found


def columns(mesh: YarnMesh, cells: int) -> IntArray:
    """Find the columns of nodes (crossings, 2, through) in the middles of warp and weft at each
    crossing."""
    found = []
    for warp in _yarns(mesh, 0):
        for weft in _yarns(mesh, 1):
            parts = [_crossing(mesh, a, b, cells)[0] for a, b in ((warp, weft), (weft, warp))]
            found.append([g[len(g) // 2, g.shape[1] // 2] for g in parts])
    return np.array(found)


def _parallel_neighbours(mesh, images, reach):
    """Yield (family, thickness [m], grid, grid of the next yarn) of each yarn, with `reach` columns more at
    both ends."""
    for family in (0, 1):
        yarns = _yarns(mesh, family)
        for yarn, next_yarn in zip(yarns, [*yarns[1:], yarns[0]]):
            # the last one's neighbour is the image of the first, one cell further across
            step = int(yarn == yarns[-1])
            m, n = (0, step) if family == 0 else (step, 0)
            grids = images.extended(yarn, 0, 0, reach), images.extended(next_yarn, m, n, reach)
            yield family, mesh.sections[family].thickness, *grids


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
