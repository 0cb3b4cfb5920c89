"""The checks of the ledger. Each file registers its own (`validation.ledger.registry`); here they are all."""

from validation.ledger.checks import (  # they register themselves
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
from validation.ledger.registry import CHECKS, Check

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
