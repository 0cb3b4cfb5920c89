"""Contact between any number of yarns: pairs of surfaces that are handled as the two of a crossover are.

Each pair is a `surfaces.FacingSurfaces`: the lower face of one yarn and the upper face of another. A yarn whose i runs
along y counts as the first one, and as the second one whose i runs along x, with its grid transposed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from fabrics.checks import FloatArray, IntArray
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact.interface import ContactSurfaces, PenaltyNumerics
from unitcell3d.contact.surfaces import FacingSurfaces, Plates


class SurfacePairs:
    """Several pairs of facing surfaces in one; none for a yarn alone.

    Parameters
    ----------
    pairs : sequence of surfaces.FacingSurfaces

    Attributes
    ----------
    forces : (pairs,) [N] of each pair in the last call of `assemble`: upwards on the upper surface
    """

    def __init__(self, pairs: Iterable[ContactSurfaces]) -> None:
        self.pairs = tuple(pairs)
        self.forces = np.zeros(len(self.pairs))

    @property
    def gaps(self) -> Sequence[FloatArray]:
        """[m] of the nodes of all surfaces."""
        return tuple(gaps for pair in self.pairs for gaps in pair.gaps)

    @property
    def deepest(self) -> float:
        """[m] largest penetration where there was a force in the last call of `assemble`."""
        return max((pair.deepest for pair in self.pairs), default=0.0)

    def expected_stencils(self) -> list[IntArray]:
        """As of `surfaces.FacingSurfaces`."""
        return [stencils for pair in self.pairs for stencils in pair.expected_stencils()]

    def build_pattern(self, pattern: Pattern) -> None:
        """As of `surfaces.FacingSurfaces`."""
        for pair in self.pairs:
            pair.build_pattern(pattern)

    def pattern_outdated(self) -> bool:
        """As of `surfaces.FacingSurfaces`."""
        return any(pair.pattern_outdated() for pair in self.pairs)

    def assemble(
        self,
        x: FloatArray,
        numerics: PenaltyNumerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """As of `surfaces.FacingSurfaces`; returns the sum of the sizes [N] of the pairs' forces."""
        for number, pair in enumerate(self.pairs):
            self.forces[number] = pair.assemble(x, numerics, forces, values)
        return float(np.abs(self.forces).sum())

    @property
    def anchors(self) -> list[FloatArray]:
        """As of `surfaces.FacingSurfaces`."""
        return [anchors for pair in self.pairs for anchors in pair.anchors]

    def commit(self, x: FloatArray, numerics: PenaltyNumerics) -> None:
        """As of `surfaces.FacingSurfaces`."""
        for pair in self.pairs:
            pair.commit(x, numerics)


class OuterPlates(Plates):
    """Two rigid plates on the upper faces of some yarns and the lower faces of others."""

    def __init__(
        self, points: FloatArray, upper: Sequence[IntArray], lower: Sequence[IntArray]
    ) -> None:
        self._face(points, [grid[:, :, -1] for grid in upper], [grid[:, :, 0] for grid in lower])


def facing(
    points: FloatArray,
    upper: IntArray,
    lower: IntArray,
    quarter: bool = False,
    families: Sequence[int] = (0, 1),
) -> FacingSurfaces:
    """The pair of the lower face of the grid `upper` and the upper face of the grid `lower`.

    Parameters
    ----------
    points : (n, 3) [m]
    upper, lower : node numbers (i along, j across, k through)
    quarter : whether i = 0 and j = 0 are symmetry planes of both
    families : of the two yarns, 0 along x, 1 along y
    """
    grids = [
        grid if family == role else grid.transpose(1, 0, 2)
        for role, (grid, family) in enumerate(zip((upper, lower), families))
    ]
    return FacingSurfaces(points, grids, quarter)
