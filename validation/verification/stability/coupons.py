"""Bias extension with less and less trellis: where the shear runs into bands (thesis Figure 4-27)."""

from __future__ import annotations

import numpy as np

from fabrics import variants
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from validation.published.bias_extension import cases
from validation.verification.cost_accuracy import coupons, study
from validation.verification.stability.core import STABLE, WRONG, Outcome


def concentration(factor: float, locking: bool) -> float:
    """Concentration of the shear, the yarns of the cloth left as they are and the trellis times a factor."""
    fabric, base = cases.cloth("locking")[0], coupons.read(study.case_of("bias-extension"))
    shear = fabric.shear
    G2 = shear.G2 if locking else shear.G1
    if factor:
        fabric = variants.with_shear(fabric, G1=factor * shear.G1, G2=factor * G2)
    result = quasistatic.bias_extension(
        CellModel(fabric).table(51), length=base.length, width=base.width, elongation=base.elongation, steps=3,
        trellis=factor > 0, tolerance=1e-3, max_iterations=20_000,
    )  # fmt: skip
    centre = quasistatic.zones(result.coupon, *quasistatic.bias_size(result)) == quasistatic.ZONES.index("C")
    return quasistatic.concentration(np.abs(result.shear()), centre)


def bias(*, factor: float, locking: bool, calm: float) -> Outcome:
    """STABLE where the coupon shears as one, to a concentration of `calm`."""
    found = concentration(factor, locking)
    return Outcome(STABLE if found <= calm else WRONG, found)
