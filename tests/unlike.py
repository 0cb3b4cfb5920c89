"""Fabrics in which no two numbers are alike, for whatever could take warp for weft or one ply for another."""

from dataclasses import replace
from functools import cache

from fabrics import catalogue, variants
from fabrics.fabric import Fabric
from fabrics.families.strain_rate import RateLaw

# of the plies from the front, over those of the first: counts (warp, weft), linear density, modulus, strain at failure
PLIES = (
    ("first", (1.0, 1.0), 1.0, 1.0, 1.0),
    ("second", (0.93, 1.04), 1.13, 1.21, 0.87),
    ("third", (1.06, 0.91), 0.88, 0.94, 1.19),
)


@cache
def fabrics() -> tuple[Fabric, ...]:
    """Return three fabrics: warp and weft of each, and the three among each other, differ in every number."""
    plain = variants.scale_yarns(
        catalogue.load("S-726").with_effective_density(),
        linear_density=(1.0, 1.17),
        E=(1.0, 0.83),
        failure_strain=(1.0, 1.31),
    )
    plain = plain.with_yarns(crimp=(0.006, 0.011))
    plain = variants.with_solids(plain, K_G=(0.7, 0.43), K_r=(0.9, 0.62))
    warp, weft = plain.laws
    laws = (warp, replace(weft, a=1.07 * weft.a, b=1.12 * weft.b))
    rates = RateLaw((10.0, 300.0, 2000.0), (1.0, 1.15, 1.4))
    weave = replace(plain.weave, weft_count=0.81 * plain.weave.weft_count)
    first = replace(plain, laws=laws, strain_rate=rates, weave=weave)
    found = []
    for name, (warp_count, weft_count), density, modulus, strain in PLIES:
        factors = {"linear_density": density, "E": modulus, "failure_strain": strain}
        one = variants.scale_yarns(first, **factors)
        weave = replace(
            one.weave,
            warp_count=warp_count * one.weave.warp_count,
            weft_count=weft_count * one.weave.weft_count,
        )
        found.append(replace(one, name=name, weave=weave))
    return tuple(found)


def fabric() -> Fabric:
    """Return the first of them."""
    return fabrics()[0]
