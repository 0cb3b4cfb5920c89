"""Quasi-static tests on coupons: bias extension, a cross pulled by its four arms, a yarn pulled out of a strip."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue, variants
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.coupon import pull_out as pulled
from shellfabric.coupon import quasistatic
from shellfabric.impact.setup import ImpactSetup
from validation.models import variants as comparison
from validation.published.bias_extension import coupon_fabric, measured
from validation.values import Values

if TYPE_CHECKING:
    from fabrics.fabric import Fabric


def _table(fabric: Fabric, model: str, law: str, size: int, crossovers: int) -> CellTable:
    """Table of the cell; `crossovers` along each side of an element."""
    fabric = comparison.with_law_form(fabric, law)
    if crossovers > 1:
        fabric = comparison.homogenised(fabric, crossovers)
    return CellModel(fabric, cell_model=model).table(size)


def bias(
    *,
    name: str = "locking",
    factor: float | None = None,
    locking: bool = True,
    model: str = "",
    law: str = "regularised",
    table: int = 201,
    crossovers: int = 1,
    **options: Any,
) -> Values:
    """Run a bias extension of balanced S-728.

    Parameters
    ----------
    name : of its fabric, as in `bias_extension.coupon_fabric`
    factor : [-] on the moduli of its trellis, the second of which is the first without `locking`; 0 for no trellis
    model, law, table : of the cell, of its compression, and the stretches of its table
    crossovers : along each side of an element of thicker yarns
    options : of `quasistatic.bias_extension`

    Returns
    -------
    dict of `bias_extension.measured`

    Raises
    ------
    UnstableError : as `quasistatic.bias_extension`
    """
    fabric, own, trellis = coupon_fabric(name)
    if factor is not None:
        shear = fabric.shear
        trellis = factor > 0
        locked = shear.G1
        if locking:
            locked = shear.G2
        if trellis:
            fabric = variants.with_shear(fabric, G1=factor * shear.G1, G2=factor * locked)
    of_cell = _table(fabric, model or own, law, table, crossovers)
    return measured(quasistatic.bias_extension(of_cell, trellis=trellis, **options))


def cross(
    *,
    fabric: str,
    strain: float,
    centre: int,
    arm: int,
    model: str = "compressible",
    law: str = "regularised",
    table: int = 201,
    crossovers: int = 1,
    **options: Any,
) -> dict[str, float]:
    """Pull a cross of a fabric to a strain of its arms.

    Parameters
    ----------
    strain : [-] of the arms
    centre, arm : [crossovers] width of the cross, length of its woven arms
    model, law, table, crossovers : as in `bias`
    options : of `quasistatic.biaxial`

    Returns
    -------
    dict with load_warp, load_weft [N]; strain_warp, strain_weft [-] of the middle
    """
    of_cell = _table(catalogue.load(fabric).with_effective_density(), model, law, table, crossovers)
    result = quasistatic.biaxial(
        of_cell,
        strain=(strain, strain),
        centre=centre // crossovers,
        arm=arm // crossovers,
        cross_yarns_removed=False,
        **options,
    )
    half = [0.5 * (centre // crossovers) * w for w in of_cell.model.fabric.weave.w]
    warp, weft = quasistatic.middle_strain(result, half)[-1]
    return {
        "load_warp": float(abs(result.force(1, 0)[-1])),
        "load_weft": float(abs(result.force(3, 1)[-1])),
        "strain_warp": float(warp),
        "strain_weft": float(weft),
    }


def pull_out(
    *,
    crossings: int,
    mu: float,
    cohesion: float = 0.0,
    stiffness: float | None = None,
    load: float = 0.0,
    pulled_by: float = 2e-3,
) -> dict[str, float]:
    """Pull a yarn of S-726 out of a strip.

    Parameters
    ----------
    crossings : yarns that cross it
    mu, cohesion : [-], [N] at a crossover
    stiffness : share between the bending stiffness of the fibres alone, 0, and that of a solid section, 1, in ratio;
        None for flexible yarns
    load : [N] of all crossing yarns together
    pulled_by : [m] of the crosshead

    Returns
    -------
    dict with peak [N], bending [N m2] of the warp, slip [m] of the yarn that slides at the peak
    """
    fabric = catalogue.load("S-726").with_effective_density()
    bending = (0.0, 0.0)
    if stiffness is not None:
        low, high = np.transpose([_bending_bounds(yarn) for yarn in fabric.weave.yarns])
        bending = tuple(low ** (1 - stiffness) * high**stiffness)
    coupon = pulled.PullOut(
        table=ImpactSetup(fabric, 1.0).table(kept=True),
        crossings=crossings,
        pre_tension=load / crossings,
        mu=mu,
        cohesion=cohesion,
        bending=bending,
    )
    found = pulled.follow(coupon, pulled_by)
    return {"peak": found.peak, "bending": float(bending[0]), "slip": found.slip_length}


def _bending_bounds(yarn, fibre_diameter=12e-6):
    """Compute the (lowest, highest) [N m2] bending stiffness of a yarn: of its fibres alone, which slide
    freely on one another, and of a solid section of their area.

    fibre_diameter : [m]; 12 um is that of aramid fibres
    """
    modulus = yarn.EA / yarn.A_s
    fibres = yarn.A_s / (0.25 * pi * fibre_diameter**2)
    return fibres * modulus * pi * fibre_diameter**4 / 64, modulus * yarn.A_s**2 / (4 * pi)
