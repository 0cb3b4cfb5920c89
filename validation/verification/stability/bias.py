"""Bias extension with less and less trellis: where the shear runs into bands (thesis Figure 4-27)."""

from __future__ import annotations

import numpy as np

from fabrics import variants
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from validation.published.bias_extension import cases
from validation.verification.cost_accuracy import coupons
from validation.verification.stability.core import BELOW, STABLE, WRONG, Axis, Map, Outcome, guarded

MODULI = (0.0, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0)
LAWS = ("locking at 7°, as published", "no locking: G1 at all angles")
CALM = 1.5  # concentration of the shear of a coupon that shears as one


def pull(factor: float, law: str) -> float:
    """Concentration of the shear, the yarns of the cloth left as they are and the trellis times a factor."""
    fabric, base = cases.cloth("locking")[0], coupons.read("bias-extension")
    shear = fabric.shear
    G2 = shear.G2 if law == LAWS[0] else shear.G1
    if factor:
        fabric = variants.with_shear(fabric, G1=factor * shear.G1, G2=factor * G2)
    result = quasistatic.bias_extension(
        CellModel(fabric).table(51), length=base.length, width=base.width, elongation=base.elongation, steps=3,
        trellis=factor > 0, tolerance=1e-3, max_iterations=20_000,
    )  # fmt: skip
    centre = quasistatic.zones(result.coupon, *quasistatic.bias_size(result)) == quasistatic.ZONES.index("C")
    return quasistatic.concentration(np.abs(result.shear()), centre)


def point(factor: float, law: str) -> Outcome:
    """STABLE where the coupon shears as one."""

    def run():
        found = pull(factor, law)
        return Outcome(STABLE if found <= CALM else WRONG, found)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "bias", "Bias extension with less and less trellis",
        "Balanced S-728 on the bias, half the size of the thesis's coupon and as strained. The yarns stay as they are, "
        "the moduli of the trellis are multiplied by a factor. Without trellis nothing says where the cloth shears; "
        "without locking, but with the published first modulus, it stays calm.",
        Axis("modulus G1 of the trellis over the published", (0.0, 1.0) if quick else MODULI),
        Axis("shear law", LAWS[:1] if quick else LAWS), point, "concentration of the shear",
        f"a concentration above {CALM:g}: shear begins to gather",
        "shear in bands (concentration above 3), yarns that pass one another, no equilibrium",
        (1.0, LAWS[0]), (BELOW,),
    )  # fmt: skip
