"""Variants of a fabric for comparison, beside those of `fabrics.variants`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.pattern import Pattern
from fabrics.variants import Value, scale_laws, scale_shear, scale_yarns, with_shear, with_solids

KEVLAR = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")  # the fabrics of the thesis
NEARLY_STRAIGHT = (
    1e-6  # [-] crimp: the thickness of the fabric is that of its crimp, and must not be zero
)


def with_law_form(fabric: Fabric, form: str) -> Fabric:
    """Return the fabric with its compression laws in another form, "regularised" or "printed"
    (erratum E-05).

    Raises
    ------
    InputError : the fabric has no compression laws, or the form is unknown
    """
    if fabric.laws is None:
        raise InputError(f"fabric {fabric.name} has no compression law")
    warp, weft = (replace(law, form=form) for law in fabric.laws)
    return replace(fabric, laws=(warp, weft))


def with_pattern(fabric: Fabric, pattern: Pattern) -> Fabric:
    """Return the fabric with the same yarns, spacings and crimps in another pattern."""
    return replace(fabric, weave=replace(fabric.weave, pattern=pattern))


def homogenised(fabric: Fabric, n: float) -> Fabric:
    """Return a weave of fewer, thicker yarns with the same response to stretch and shear: one
    crossover for n x n.

    The spacing is n-fold; yarns have the n-fold area with the same fibres, crimp and strain at failure, hence n-fold
    length, height and tension. Angles are kept, so that the contact force is n-fold at the same stretches, and the
    compression must be n-fold too. With d = a - b / (F + F0)^(1/3), F0 = (b/a)^3, that is a' = n a, b' = n^(4/3) b.
    The fabric is n-fold as thick, so that the moduli of the trellis, whose stress acts on the thickness, are divided
    by n. What happens within n x n crossovers is not resolved.

    Parameters
    ----------
    n : [-] crossovers along each side
    """
    weave = fabric.weave
    weave = replace(weave, warp_count=weave.warp_count / n, weft_count=weave.weft_count / n)
    coarse = scale_yarns(replace(fabric, weave=weave), linear_density=n)
    if fabric.shear is not None:
        coarse = with_shear(coarse, G1=fabric.shear.G1 / n, G2=fabric.shear.G2 / n)
    return scale_laws(coarse, n, n ** (4 / 3))


def with_straight_yarns(fabric: Fabric, crimp: Value = NEARLY_STRAIGHT) -> Fabric:
    """Return the fabric with yarns of next to no crimp, with a trellis of the same stiffness per
    width.

    The fabric gets thinner with its crimp, and the stress of the trellis acts on the thickness: its moduli grow by the
    ratio of the thicknesses.
    """
    straight = fabric.with_yarns(crimp=crimp)
    return scale_shear(straight, fabric.weave.thickness / straight.weave.thickness)


def scale_solids(fabric: Fabric, factors: Mapping[str, float]) -> Fabric:
    """Multiply values of the solid laws by factors [-], named by the fields of `SolidLaw`.

    Raises
    ------
    InputError : the fabric has no solid laws
    """
    laws = with_solids(fabric).solid_laws
    return with_solids(
        fabric,
        **{name: tuple(getattr(law, name) * f for law in laws) for name, f in factors.items()},
    )
