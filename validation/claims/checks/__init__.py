"""What the ledger computes in functions: closed forms, quadratures, geometry, and what takes more than two lines.

An expression calls them; or a claim names one as its `check`, which gets its runs and arguments and returns {name:
number in SI, text, list or bool}.
"""

from dataclasses import replace  # noqa: F401
from types import ModuleType
from typing import Any

import numpy as np
from scipy.integrate import trapezoid  # noqa: F401

from fabrics.compression import CompressionLaw  # noqa: F401
from fabrics.plate_curve import PlateCurve  # noqa: F401
from fabrics.weave import height_from_length  # noqa: F401
from shellfabric.cell.model import CellModel  # noqa: F401
from shellfabric.coupon.quasistatic import inextensible_shear  # noqa: F401
from shellfabric.plies.gap import compression_gap  # noqa: F401
from shellfabric.projectile.bar import Bar  # noqa: F401
from validation.claims import readers
from validation.claims.checks import cell, compression, crossover, geometry, shear, shots
from validation.models import cell_equations, newton
from validation.published.biaxial_glass.curves import at_ratio, free_edge  # noqa: F401
from validation.published.pencilling.study import Case, march  # noqa: F401

MODULES = (readers, cell, compression, crossover, geometry, shear, shots, cell_equations, newton)


def names() -> dict[str, Any]:
    """All that expressions may name: numpy as np, what is imported here, and what readers and checks define."""
    known = [globals(), *map(vars, MODULES), vars(readers)]
    return {name: part for each in known for name, part in each.items() if not isinstance(part, ModuleType)} | {
        "np": np
    }
