"""The biaxial tests of Buet-Gautier and Boisse on two glass weaves (thesis section 5.3, Tables 5-3 and 5-4).

A cross-shaped specimen is stretched along warp and weft at a fixed ratio of the two strains, and the tension per yarn
is recorded (`studies.biaxial_path.to_strength`). The thesis fits the compression law to equal strains and predicts the
ratios 0.5 and 2 and the free edge. Its measured points stand in figures that we do not have: the curves are those that
the thesis's own parameters give.
"""

from __future__ import annotations

import numpy as np

from shellfabric.cell.model import CellModel
from weavecell.studies.biaxial_path import CellPath


def free_edge(model: CellModel, direction: str) -> CellPath:
    """Stretch one direction, "warp" or "weft", with the other free, whose strain is not prescribed and nan.

    The yarn that crosses carries nothing, and so the contact carries nothing either (F = 2 T sin(alpha), eq. 4-8): the
    stretched yarn takes out its crimp alone, then pulls straight.
    """
    index = ("warp", "weft").index(direction)
    yarn = model.fabric.weave.yarns[index]
    end = (1 + yarn.crimp) * (1 + yarn.failure_strain) - 1
    strain = np.full((241, 2), np.nan)
    tension = np.zeros((241, 2))
    strain[:, index] = np.linspace(0, end, 241)
    tension[:, index] = model.alone(index, 1 + strain[:, index])
    return CellPath(
        (1.0 - index, float(index)), strain, dict(zip(("T1", "T2"), tension.T)), direction
    )
