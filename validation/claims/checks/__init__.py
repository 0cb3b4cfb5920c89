"""What the ledger computes in functions: closed forms, quadratures, geometry, and what takes more than two lines.

A claim names one of them as its `check`, which gets its runs and arguments and returns {name: number in SI, text, list
or bool}; or an expression calls it.
"""

from types import ModuleType
from typing import Any

from validation.claims import readers
from validation.claims.checks import cell, compression, crossover, geometry, newton, shear, shots, unit_cell

MODULES = (readers, cell, compression, crossover, geometry, newton, shear, shots, unit_cell)


def names() -> dict[str, Any]:
    """All that expressions may name: what readers and checks define, and numpy."""
    return {name: value for module in MODULES for name, value in vars(module).items() if _public(name, value)}


def _public(name, value):
    return (not name.startswith("_") and not isinstance(value, ModuleType)) or name == "np"
