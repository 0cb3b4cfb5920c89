"""The mesh of a patch of solid yarns, yarn by yarn; whole, or a quarter of a symmetric one.

A plane through the middle of a yarn is a plane of symmetry of a plain weave: it sends warp i to warp
-i, and i + j stays even or odd. So a patch of odd numbers of yarns has two such planes, which cross
in the middle of a crossing, and a quarter of it is half the length of the yarns on one side, and half
the width of those in the middle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from fabrics.pattern import PLAIN
from meshing.mesh import YarnMesh


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Nodes and yarns of a patch.

    Parameters
    ----------
    points : (n, 3) [m], numbered yarn by yarn, through fastest, then across, then along
    grids : of each yarn (nx + 1, ny + 1, nz + 1) node numbers: along, across, through
    families : of each yarn, 0 along x, 1 along y
    numbers : of each yarn, its number in its family in the whole patch, from 0. Warp i lies over
        weft j where i + j is even
    axes : (yarns,) [m] place of each yarn's axis, y of a warp and x of a weft
    bar_area : of each yarn (ny + 1, nz + 1) [m2] of the fibre bars through a section
    quarter : whether x = 0 and y = 0 are planes of symmetry
    """

    points: np.ndarray
    grids: tuple[np.ndarray, ...]
    families: tuple[int, ...]
    numbers: tuple[int, ...]
    axes: np.ndarray
    bar_area: tuple[np.ndarray, ...]
    quarter: bool

    @classmethod
    def of(cls, mesh: YarnMesh, quarter: bool = False) -> SolidMesh:
        """Take the yarns of a whole `meshing.patch.Patch` or `meshing.crossover.Crossover`, or a
        quarter of them.

        Raises
        ------
        InputError : the mesh is a quarter already, or has an even number of yarns of which a
            quarter is wanted
        """
        if mesh.quarter:
            raise InputError(key="domain", value="quarter", allowed="whole")
        counts = [mesh.families.count(family) for family in (0, 1)]
        if quarter and not all(count % 2 for count in counts):
            raise InputError(
                f"a quarter of {counts[0]} x {counts[1]} yarns: a patch has two planes of symmetry "
                "only if both numbers are odd"
            )
        found = [_Cut.of(mesh, yarn, quarter) for yarn in range(len(mesh.grids))]
        kept = [cut for cut in found if cut is not None]
        points = np.concatenate([cut.points.reshape(-1, 3) for cut in kept])
        ends = np.cumsum([cut.points[..., 0].size for cut in kept])
        grids = []
        for cut, end in zip(kept, ends):
            shape = cut.points.shape[:3]
            grids.append(np.arange(end - np.prod(shape), end).reshape(shape))
        return cls(
            points=points,
            grids=tuple(grids),
            families=tuple(cut.family for cut in kept),
            numbers=tuple(cut.number for cut in kept),
            axes=np.array([cut.axis for cut in kept]),
            bar_area=tuple(cut.bar_area for cut in kept),
            quarter=quarter,
        )

    @property
    def share(self) -> float:
        """Modelled part of the whole [-]."""
        return 0.25 if self.quarter else 1.0

    @property
    def bricks(self) -> int:
        """Number of hexahedra."""
        return sum(int(np.prod(np.array(grid.shape) - 1)) for grid in self.grids)

    def cut_along(self, yarn: int) -> bool:
        """Tell whether half the width of a yarn is modelled."""
        return self.quarter and self.axes[yarn] == 0.0

    def partner(self, yarn: int, number: int) -> int | None:
        """Find the yarn of the other family with a number in its family; None if it is not
        modelled."""
        for other, (family, own) in enumerate(zip(self.families, self.numbers)):
            if family != self.families[yarn] and own == number:
                return other
        return None

    def over(self, yarn: int, other: int) -> bool:
        """Tell whether a yarn lies over one of the other family."""
        warp_over = PLAIN.is_warp_up(self.numbers[yarn], self.numbers[other])
        return bool(warp_over) == (self.families[yarn] == 0)


@dataclass(frozen=True, eq=False)
class _Cut:
    """What is modelled of a yarn."""

    points: FloatArray
    family: int
    number: int
    axis: float
    bar_area: FloatArray

    @classmethod
    def of(cls, mesh: YarnMesh, yarn: int, quarter: bool) -> _Cut | None:
        """Cut a yarn of a mesh; None if nothing of it is modelled."""
        family = mesh.families[yarn]
        same = [other for other, own in enumerate(mesh.families) if own == family]
        number = same.index(yarn)
        grid = mesh.grids[yarn]
        points = mesh.points[grid]
        area = mesh.bar_area[yarn][: grid.shape[1] * grid.shape[2]].reshape(grid.shape[1:])
        side = 1 - family
        axis = (number - (len(same) - 1) / 2) * 2 * mesh.w[side]
        if not quarter:
            return cls(points, family, number, axis, area.copy())
        if number < len(same) // 2:
            return None
        points = points[_middle(grid.shape[0]) :]
        area = area.copy()
        if number == len(same) // 2:
            axis = 0.0
            first = _middle(grid.shape[1])
            if points[0, 0, 0, side] < points[0, -1, 0, side]:
                points = points[:, first:]
                area = area[first:]
            else:
                points = points[:, first::-1]
                area = area[first::-1]
            area[0] *= 0.5
        return cls(points, family, number, axis, area)


def _middle(count: int) -> int:
    """The middle of an odd number of nodes."""
    return (count - 1) // 2


def facet_areas(points: FloatArray) -> FloatArray:
    """Compute the areas (p, q) [m2] of the facets of a surface (p + 1, q + 1, 3) [m]."""
    first = points[1:, 1:] - points[:-1, :-1]
    second = points[:-1, 1:] - points[1:, :-1]
    return 0.5 * np.linalg.norm(np.cross(first, second), axis=-1)


def corners(grid: IntArray) -> IntArray:
    """Return the nodes (m, 8) of the bricks of a yarn, through fastest, in the order of
    `block.hex8.CORNERS`."""
    low = slice(None, -1)
    high = slice(1, None)
    parts = [
        (low, low, low),
        (high, low, low),
        (high, high, low),
        (low, high, low),
        (low, low, high),
        (high, low, high),
        (high, high, high),
        (low, high, high),
    ]
    return np.stack([grid[part] for part in parts], axis=-1).reshape(-1, 8)
