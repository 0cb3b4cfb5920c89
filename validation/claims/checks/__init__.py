"""The checks of the ledger. Each file registers its own (`validation.claims.registry`); here they are all."""

from validation.claims.checks import (  # noqa: F401
    biaxial,
    cell,
    cell_bounds,
    compression,
    cost,
    coupling,
    crossover,
    edges,
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
)  # fmt: skip
from validation.claims.registry import CHECKS, Check

__all__ = ["CHECKS", "Check"]
