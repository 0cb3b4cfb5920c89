"""The 3D crossover of hexahedra of order 2: the bricks of a mesh in blocks of 2 x 2 x 2, on the same nodes.

Bars and contact are those of the mesh, so that it compares the order of the solids alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from unitcell3d.assembly.compat import Assembler, HexSpace, second_order_places
from unitcell3d.material import solid_law
from unitcell3d.model import crossover

POINTS = 5  # degree of the Gauss rule of 3 x 3 x 3 points


class SecondOrderCrossover(crossover.CrossoverModel):
    """A crossover of hexahedra of order 2; entries as in `CrossoverModel`, without `integration`.

    Raises
    ------
    InputError : an odd number of bricks along, across or through a yarn
    """

    def _solid(self, mesh, fabric, integration):
        blocks = [blocks_of(mesh.points, grid) for grid in mesh.grids]
        super()._solid(mesh, fabric, integration)
        of_bricks = crossover._cell_laws(mesh, fabric, self.numerics.fibre_fraction)
        firsts = [np.argmax(mesh.yarn == yarn) for yarn in range(len(blocks))]
        self._blocks = np.concatenate(blocks)
        self._space = HexSpace.build(mesh.points, self._blocks)
        constants = np.repeat(of_bricks[firsts], [*map(len, blocks)], axis=0)
        self._cell_laws = self._space.cell_constants(constants)
        forms = solid_law.forms(self._space, self._cell_laws, POINTS)
        self._solids = Assembler(self._space, *forms)

    def _build_pattern(self):
        bricks, self.hexes = self.hexes, self._blocks
        super()._build_pattern()
        self.hexes = bricks


def blocks_of(points: FloatArray, grid: IntArray) -> IntArray:
    """Number the points (m, 27) of the blocks of a yarn's grid of nodes (along, across, through).

    Raises
    ------
    InputError : an odd number of bricks
    """
    counts = np.array(grid.shape) - 1
    if (counts % 2).any():
        raise InputError(key="size", value=tuple(counts), allowed="even numbers of hexahedra")
    start, *ends = points[grid[[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]]
    if np.linalg.det(ends - start) < 0:
        grid = grid[:, ::-1]
    places: Any = second_order_places()
    firsts = np.stack(np.meshgrid(*(np.arange(0, n, 2) for n in counts), indexing="ij"), -1)
    at = firsts.reshape(-1, 1, 3) + places
    return grid[at[..., 0], at[..., 1], at[..., 2]]
