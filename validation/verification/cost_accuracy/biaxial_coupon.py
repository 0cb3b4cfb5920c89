"""A cross-shaped coupon of S-720 pulled by its four arms: their loads, and the strains of the middle."""

from __future__ import annotations

from validation.verification.cost_accuracy import coupons
from validation.verification.cost_accuracy.core import Quantity, Scene

QUANTITIES = (
    Quantity("load of the warp", "N", "load"),
    Quantity("load of the weft", "N", "load"),
    Quantity("strain of the warp", "-", "strain of the middle"),
    Quantity("strain of the weft", "-", "strain of the middle"),
)


def scene(quick: bool = False) -> Scene:
    """The scene; `quick` takes coarser references."""
    base = coupons.read("biaxial-coupon")
    meshes, finer = coupons.references(base, (1, 2, 3) if quick else (1, 2, 3, 4))
    text = (
        f"A cross of {base.fabric}, {base.centre} crossovers wide with woven arms of {base.arm}, "
        f"is pulled by all four arms to {100 * base.strain:g} % of its length. Quantities: the loads of the arms, and "
        "the strains of the middle."
    )
    return Scene(
        "biaxial-coupon", f"Biaxial coupon of {base.fabric}", text, QUANTITIES, coupons.methods(base), coupons.run,
        coupons.warm, meshes, finer,
    )  # fmt: skip
