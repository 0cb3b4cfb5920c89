"""The checks of the ledger. Each file registers its own (`validation.claims.registry`); here they are all."""

from validation.claims.checks import (
    biaxial,
    cell,
    cell_bounds,
    compression,
    cost,
    coupling,
    crossover,
    geometry,
    histories,
    impact,
    newton,
    packs,
    pencilling,
    sensitivity,
    shear,
    solids,
    waves,
)
from validation.claims.registry import CHECKS, Check

__all__ = [
    "CHECKS",
    "Check",
    "biaxial",
    "cell",
    "cell_bounds",
    "compression",
    "cost",
    "coupling",
    "crossover",
    "geometry",
    "histories",
    "impact",
    "newton",
    "packs",
    "pencilling",
    "sensitivity",
    "shear",
    "solids",
    "waves",
]
