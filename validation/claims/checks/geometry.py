"""Geometry of the weave and of the projectile: areal density, arc length, micrographs (thesis chapters 2, 5, A)."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import quad

from fabrics import catalogue
from fabrics.trellis import locking_modulus
from fabrics.weave import arc_length
from shellfabric.cell.model import CellModel
from shellfabric.panel.model import Panel
from validation.claims.readers import FAMILIES, KEVLAR

if TYPE_CHECKING:
    from fabrics.fabric import Fabric


def micrographs() -> Iterator[tuple[Fabric, str, Any, dict[str, float]]]:
    """(fabric, family, yarn, values) of the twelve rows of Tables A-1 and A-2."""
    for name in KEVLAR:
        fabric = catalogue.load(name)
        for family, yarn in zip(FAMILIES, fabric.weave.yarns):
            yield fabric, family, yarn, fabric.micrograph[family]


def areal_density(fabric: Fabric) -> float:
    """[kg/m2] of a panel of the fabric."""
    return mass_per_area(Panel(CellModel(fabric).table(8)))


def mass_per_area(panel: Panel) -> float:
    """[kg/m2] mass of the nodes of a panel over its area."""
    return float(panel.masses().sum()) / float(np.prod([n * d for n, d in zip(panel.counts, panel.spacing)]))


def locked_modulus(fabric: Fabric) -> float:
    """[Pa] shear modulus once the yarns have locked (eq. 4-49)."""
    weave = fabric.weave
    return locking_modulus(weave.warp.E, weave.warp.A_s, weave.thickness, 2 * weave.w1)


def with_density_of_G2(fabric: Fabric) -> Fabric:
    """The fabric with the linear densities that G2 implies.

    The effective ones (erratum E-07) are inferred from areal densities. Here the factor on the nominal ones is G2 of
    Table 4-1 over eq. 4-49, into which no areal density enters.
    """
    factor = fabric.shear.G2 / locked_modulus(fabric)  # type: ignore[union-attr]
    return fabric.with_yarns(linear_density=tuple(factor * yarn.linear_density for yarn in fabric.weave.yarns))


def arc_length_error() -> float:
    """Relative difference of the length of a cosine yarn from its quadrature, the largest of all fabrics."""
    worst = 0.0
    for weave in (catalogue.load(name).weave for name in catalogue.list_names()):
        for w, h in zip(weave.w, weave.h0):
            k = pi * h / (2 * w)
            S = 2 * quad(lambda x, k=k, w=w: np.sqrt(1 + (k * np.sin(pi * x / (2 * w))) ** 2), 0, w, epsrel=1e-13)[0]
            worst = max(worst, abs(arc_length(w, h) / S - 1))
    return worst
