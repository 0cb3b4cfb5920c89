"""The bias extension test of balanced S-728 (thesis section 4.4.3, Figures 4-25 to 4-27).

A coupon of 143.5 x 74 mm, its yarns at 45 degrees to the load, is stretched by 5 mm at each end (erratum E-31: or
5 mm in all). Balanced means the mean crimp, 1.35 %, in both families (E-31). Yarns do not fail. The thesis's figures
show the three zones without numbers; compared is the angle of yarns that do not stretch, a closed form.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fabrics import catalogue, variants
from validation.models.variants import with_straight_yarns
from validation.values import Values, largest
from weavecell.results import coupon

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from shellfabric.coupon.solver import Result


def coupon_fabric(name: str) -> tuple[Fabric, str, bool]:
    """Return (fabric, cell model's name, whether the trellis acts) of a coupon of the test.

    name : "locking", the trellis law as published; "soft", its modulus G1 at all angles; "none", no trellis, which runs
        into bands; "straight", straight yarns with G1, the fabric for which the closed form is meant
    """
    fabric = catalogue.load("S-728").with_effective_density()
    crimp = 0.5 * sum(yarn.crimp for yarn in fabric.weave.yarns)
    fabric = fabric.with_yarns(crimp=crimp)
    soft = variants.with_shear(fabric, G2=fabric.shear.G1)
    if name == "straight":
        return with_straight_yarns(soft), "decoupled", True
    return soft if name == "soft" else fabric, "compressible", name in ("locking", "soft")


def measured(result: Result) -> Values:
    """Read off a test what it measures, at each load step.

    Returns
    -------
    dict with moved [m], load [N] and angles (A, B, C) [deg] between warp and weft; concentrations [-] of the shear;
    not_stretching [deg], angle C of yarns that do not stretch, and concentration [-] at the end
    """
    found = coupon.record(None, result, test="bias_extension").columns
    return {
        "moved": result.prescribed,
        "load": found["load"],
        "angles": np.degrees([found[f"angle in zone {zone}"] for zone in "ABC"]).T,
        "not_stretching": np.degrees(found["zone C, yarns that do not stretch"][-1]),
        "concentrations": found["shear concentration"],
        "concentration": float(found["shear concentration"][-1]),
    }


def asymmetry(result: Result) -> float:
    """Compute the largest distance [-] of a node from its mirror image, left to right and end to
    end, over the width."""
    rest = result.coupon.points
    x = result.states[-1].x
    width = np.ptp(rest[:, 0])
    worst = 0.0
    keys = {tuple(key): k for k, key in enumerate(np.round(1e7 * rest).astype(int))}
    for sign in ((-1, 1), (1, -1)):
        image = [keys[tuple(key)] for key in np.round(1e7 * rest * sign).astype(int)]
        worst = max(worst, largest(x[image] - x * sign))
    return worst / width
