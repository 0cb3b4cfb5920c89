"""Bias extension of a small coupon of balanced S-728: load, and shear of the zones B and C."""

from __future__ import annotations

from validation.verification.cost_accuracy import coupons
from validation.verification.cost_accuracy.core import Quantity, Scene

QUANTITIES = (
    Quantity("load", "N", "load"),
    Quantity("shear angle of B", "deg", "shear angles"),
    Quantity("shear angle of C", "deg", "shear angles"),
)


def scene(quick: bool = False) -> Scene:
    """The scene; `quick` takes coarser references."""
    base = coupons.read("bias-extension")
    meshes, finer = coupons.references(base, (0.5, 1, 2) if quick else (1, 2, 3, 4))
    text = (
        f"Balanced S-728 cut on the bias, {1e3 * base.length:g} mm between the clamps and {1e3 * base.width:g} mm "
        f"wide, is pulled by {1e3 * base.elongation:g} mm. Quantities: the load, and the shear angles in the zones B "
        "and C, which one and none of the yarn families clamp; the explicit runs tell no load."
    )
    return Scene(
        "bias-extension", "Bias extension of balanced S-728", text, QUANTITIES, coupons.methods(base), coupons.run,
        coupons.warm, meshes, finer,
    )  # fmt: skip
