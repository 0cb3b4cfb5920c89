"""Blocks of tissue simulant: the targets of thesis section 6.5."""

from __future__ import annotations

from typing import Any

import numpy as np

from validation.published.pencilling import study


def target(
    *, plies: int, modulus: float = 1.0, mass: float = 0.0, edge: str = "free", elements: int = 2
) -> dict[str, Any]:
    """A target of Table 6-2 before its block, or the bare block without plies; keywords of `study.Case`, `study.shoot`.

    Returns
    -------
    dict with outcome, end [s], depth, crater, half_width [m], wall [deg] against the face, eroded hexahedra, error,
    hourglass [-] of the energy lost
    """
    found = study.bare() if plies == 0 else study.shoot(study.Case(plies, modulus, mass), edge=edge, elements=elements)
    glass = found.energies.get("backing_hourglass", found.energies.get("hourglass"))
    lost = found.energies.get("kinetic_projectile", found.energies.get("projectile"))
    return {
        "outcome": found.outcome,
        "end": float(found.t[-1]),
        "depth": found.depth,
        "crater": found.crater_depth,
        "half_width": found.half_width,
        "wall": float(np.degrees(found.steepness)),
        "error": found.balance,
        "eroded": None if found.block is None else int(found.block.gone.sum()),
        "hourglass": float(glass[-1] / (lost[0] - lost[-1])),
    }
