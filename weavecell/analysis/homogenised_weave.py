"""Elements of several crossovers: a weave of fewer, thicker yarns that answers to stretch and shear as the given one.

n x n crossovers become one with n-fold spacing, yarns of n-fold area and the same fibres, crimp and strength, hence
n-fold length, height and tension. Angles are kept, so that the contact force is n-fold at the same stretches; the
compression has to be n-fold too. With d = a - b / (F + F0)^(1/3), F0 = (b/a)^3, that is

    a' = n a,   b' = n^(4/3) b.

The cloth is n-fold as thick, so that the trellis, whose stress acts on the thickness, takes moduli over n. What is
left out is what goes on within n crossovers.
"""

from __future__ import annotations

from dataclasses import replace

from fabrics.fabric import Fabric


def coarse(fabric: Fabric, laws, n):
    """(Fabric, laws) of elements of n x n crossovers; `laws` (warp, weft) of compression or None for the fabric's."""
    weave, laws = fabric.weave, laws or fabric.laws
    yarns = {
        name: replace(yarn, linear_density=n * yarn.linear_density)
        for name, yarn in (("warp", weave.warp), ("weft", weave.weft))
    }
    weave = replace(weave, warp_count=weave.warp_count / n, weft_count=weave.weft_count / n, **yarns)
    shear = fabric.shear and replace(fabric.shear, G1=fabric.shear.G1 / n, G2=fabric.shear.G2 / n)
    if laws is not None:
        laws = tuple(replace(law, a=n * law.a, b=n ** (4 / 3) * law.b) for law in laws)
    return replace(fabric, weave=weave, shear=shear, laws=laws), laws
