"""What the ledger computes in functions that its expressions call: closed forms, quadratures, geometry, cells."""

from dataclasses import replace  # noqa: F401
from types import ModuleType

import numpy as np
from scipy.stats import spearmanr  # noqa: F401

from fabrics.compression import CompressionLaw  # noqa: F401
from fabrics.plate_curve import PlateCurve  # noqa: F401
from fabrics.variants import scale_yarns  # noqa: F401
from fabrics.weave import height_from_length  # noqa: F401
from shellfabric.cell.model import CellModel  # noqa: F401
from shellfabric.coupon.quasistatic import inextensible_shear  # noqa: F401
from shellfabric.plies.gap import compression_gap  # noqa: F401
from shellfabric.projectile.bar import Bar  # noqa: F401
from validation.cases.biaxial import CAUSES, choice  # noqa: F401
from validation.cases.block import march  # noqa: F401
from validation.claims import readers
from validation.claims.checks import cell, compression, weave
from validation.models import cell_equations, newton
from validation.models.crossover_law import fitted  # noqa: F401
from validation.published.biaxial_glass import free_edge  # noqa: F401
from validation.values import Values
from weavecell.studies.biaxial_path import to_strength  # noqa: F401

MODULES = (cell, compression, weave, cell_equations, newton, readers)


def names() -> Values:
    """Return all that expressions may name: numpy as np, what is imported here, and what readers
    and checks define."""
    known = [globals(), *map(vars, MODULES)]
    return {
        k: part for each in known for k, part in each.items() if not isinstance(part, ModuleType)
    } | {"np": np}
