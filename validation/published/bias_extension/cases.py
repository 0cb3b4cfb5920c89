"""The four cloths of the bias extension test, and what is measured on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue, variants
from fabrics.checks import FloatArray
from fabrics.errors import UnstableError
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from validation.models import variants as comparison

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from shellfabric.coupon.solver import Result

CLOTHS = {
    "locking": "trellis law as published",
    "soft": "modulus G1 at all angles",
    "none": "no trellis",
    "straight": "straight yarns, modulus G1",
}


@dataclass(frozen=True)
class Case:
    """One cloth, tested.

    Parameters
    ----------
    name : of CLOTHS
    result : quasistatic.Result
    zone : (q,) index into quasistatic.ZONES
    problem : what the run found wrong, or None
    """

    name: str
    result: quasistatic.Result
    zone: np.ndarray
    problem: str | None

    def means(self, step: int = -1) -> FloatArray:
        """(3,) [deg] mean angle between warp and weft in the zones A, B, C."""
        gamma = np.degrees(self.result.shear(step))
        return np.array([90 - gamma[self.zone == k].mean() for k in range(3)])

    def inextensible(self, step: int = -1) -> float:
        """[deg] angle in zone C of yarns that do not stretch."""
        size = quasistatic.bias_size(self.result)
        return 90 - np.degrees(quasistatic.inextensible_shear(*size, self.result.prescribed[step]))

    def concentration(self, step: int = -1) -> float:
        """[-] see quasistatic.concentration"""
        return quasistatic.concentration(self.result.shear(step), self.zone == 2)


def cloth(name: str) -> tuple[Fabric, str, bool]:
    """(fabric, cell model's name, whether the trellis acts) of one of CLOTHS."""
    fabric = catalogue.load("S-728").with_effective_density()
    crimp = 0.5 * sum(yarn.crimp for yarn in fabric.weave.yarns)
    fabric = fabric.with_yarns(crimp=crimp)
    soft = variants.with_shear(fabric, G2=fabric.shear.G1)
    if name == "straight":
        return comparison.with_straight_yarns(soft), "decoupled", True
    return soft if name == "soft" else fabric, "compressible", name in ("locking", "soft")


def run(name: str, *, steps: int = 20, table_size: int = 201, **changes: Any) -> Case:
    """Test one of CLOTHS; `changes` go to quasistatic.bias_extension.

    At rest is what is within 1e-5 of the load: at 1e-4 the halves of the cloth still differ by 2e-6 of its width. A
    cloth without trellis is pulled in two steps of 6000 iterations at most: there is no equilibrium to be found.
    """
    fabric, model, trellis = cloth(name)
    table = CellModel(fabric, model=model).table(table_size)
    options = {"trellis": trellis, "steps": steps, "tolerance": 1e-5} | changes
    problem = None
    if name == "none":
        options |= {"steps": 2, "max_iterations": 6000}
    try:
        result = quasistatic.bias_extension(table, **options)
    except UnstableError as found:
        result, problem = found.result, str(found)
    return Case(name, result, quasistatic.zones(result.coupon, *quasistatic.bias_size(result)), problem)


def asymmetry(result: Result) -> float:
    """[-] largest distance of a node from its mirror image, left to right and end to end, over the width."""
    rest, x = result.coupon.points, result.states[-1].x
    width, worst = np.ptp(rest[:, 0]), 0.0
    keys = {tuple(key): k for k, key in enumerate(np.round(1e7 * rest).astype(int))}
    for sign in ((-1, 1), (1, -1)):
        image = [keys[tuple(key)] for key in np.round(1e7 * rest * sign).astype(int)]
        worst = max(worst, float(np.abs(x[image] - x * sign).max()))
    return worst / width
