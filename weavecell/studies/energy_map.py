"""Energy that a crossover stores over the strains of warp and weft, and how near its yarns are to
their strengths (thesis Figures 5-34 to 5-36)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from shellfabric.cell.model import CellModel
    from shellfabric.cell.surface_cell import SurfaceCell

STATES = 121  # of a cell along each side


@dataclass(frozen=True)
class EnergyMap:
    """A crossover over a grid of strains, from rest to beyond the strengths of its yarns.

    Parameters
    ----------
    fabric : name
    strain_warp, strain_weft : (n1,), (n2,) [-] of the fabric, from 0
    energy : (n1, n2) [J/m2] stored, over the area at rest
    share : (n1, n2, 2) [-] tension of warp and weft over the strength of the yarn. Below 1 in both
        lies what the thesis calls the no-failure zone
    residual : [-] of a sampled surface: rms of the part of its forces that no potential has, over
        the rms force; 0 of a cell
    """

    fabric: str
    strain_warp: np.ndarray
    strain_weft: np.ndarray
    energy: np.ndarray
    share: np.ndarray
    residual: float = 0.0

    @property
    def most(self) -> tuple[float, float, float]:
        """Largest energy in the no-failure zone [J/m2], and the strains of warp and weft there [-]."""
        whole = np.where(self.share.max(axis=2) < 1, self.energy, -np.inf)
        i, j = np.unravel_index(int(np.argmax(whole)), whole.shape)
        return float(whole[i, j]), float(self.strain_warp[i]), float(self.strain_weft[j])


def map_energy(cell: CellModel | SurfaceCell) -> EnergyMap:
    """Compute the energy of a crossover over its strains, from rest to the end of its table.

    Parameters
    ----------
    cell : of the fabric's law, or of a sampled surface; its reach decides how far the strains go
    """
    from shellfabric.cell.model import CellModel

    weave = cell.fabric.weave
    w1, w2 = weave.w
    if isinstance(cell, CellModel):
        warp, weft = (np.linspace(1, highest, STATES) for _, highest in cell.range())
        values = cell.solve_grid(warp, weft)
        residual = 0.0
    else:
        table = cell.table()
        # rest is a node of the grid
        first = [int(np.argmin(np.abs(axis - 1))) for axis in (table.stretch1, table.stretch2)]
        warp = table.stretch1[first[0] :]
        weft = table.stretch2[first[1] :]
        values = {name: table.values[name][first[0] :, first[1] :] for name in ("T1", "T2", "W")}
        residual = table.residual
    shares = [values[name] / yarn.strength for name, yarn in zip(("T1", "T2"), weave.yarns)]
    energy = (values["W"] - values["W"][0, 0]) / (4 * w1 * w2)
    return EnergyMap(cell.fabric.name, warp - 1, weft - 1, energy, np.stack(shares, 2), residual)
