"""Weave and trellis: areal density, arc length, micrographs; the law of Table 4-1, sheared coupons, the picture frame,
the bias test (thesis chapters 2, 5, A, sections 4.3.2, 4.4.3)."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np
from scipy.integrate import quad

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.trellis import locking_angle, locking_modulus, touching_angle
from fabrics.weave import arc_length
from shellfabric.cell.model import CellModel
from shellfabric.coupon.model import Coupon
from shellfabric.coupon.quasistatic import inextensible_shear
from shellfabric.membrane.model import Panel
from validation.claims import changed_fabrics
from validation.claims.checks.cell import rectangle
from validation.claims.readers import ALL, FAMILIES, KEVLAR, crimped
from validation.published.bias_extension import coupon_fabric
from validation.values import Values, largest


def micrographs() -> Iterator[tuple[Fabric, str, Any, dict[str, float]]]:
    """Yield (fabric, family, yarn, values) of the twelve rows of Tables A-1 and A-2."""
    for name in KEVLAR:
        fabric = changed_fabrics.load(name)
        for family, yarn in zip(FAMILIES, fabric.weave.yarns):
            yield fabric, family, yarn, fabric.micrograph[family]


def areal_density(fabric: Fabric) -> float:
    """Compute the areal density [kg/m2] of a panel of the fabric."""
    return mass_per_area(Panel(CellModel(fabric).table(8)))


def mass_per_area(panel: Panel) -> float:
    """Compute the mass of the nodes of a panel over its area [kg/m2]."""
    return float(panel.masses().sum()) / float(
        np.prod([n * d for n, d in zip(panel.counts, panel.spacing)])
    )


def locked_modulus(fabric: Fabric) -> float:
    """Compute the shear modulus [Pa] once the yarns have locked (eq. 4-49)."""
    weave = fabric.weave
    return locking_modulus(weave.warp.E, weave.warp.A_s, weave.thickness, 2 * weave.w1)


def with_density_of_G2(fabric: Fabric) -> Fabric:
    """Return the fabric with the linear densities that G2 implies.

    The effective ones (erratum E-07) are inferred from areal densities. Here the factor on the nominal ones is G2 of
    Table 4-1 over eq. 4-49, into which no areal density enters.
    """
    factor = fabric.shear.G2 / locked_modulus(fabric)  # type: ignore[union-attr]
    return fabric.with_yarns(
        linear_density=tuple(factor * yarn.linear_density for yarn in fabric.weave.yarns)
    )


def arc_length_error() -> float:
    """Compare the length of a cosine yarn with its quadrature: the largest relative difference of
    all fabrics."""
    worst = 0.0
    for w, h, *_ in crimped(ALL):
        k = pi / (2 * w)

        def ds(x, k=k, h=h):
            return np.sqrt(1 + (k * h * np.sin(k * x)) ** 2)

        S = 2 * quad(ds, 0, w, epsrel=1e-13)[0]
        worst = max(worst, abs(arc_length(w, h) / S - 1))
    return worst


def in_trellis(coupon: Coupon, gamma: float) -> FloatArray:
    """Shear the nodes [m] of a coupon evenly by gamma [rad]."""
    x, y = coupon.points.T
    c = np.cos(gamma / 2)
    s = np.sin(gamma / 2)
    return np.stack([c * x + s * y, s * x + c * y], axis=1)


def sheared_modulus(name: str, gamma: float, cells: int = 6, step: float = 1e-4) -> float:
    """Compute the tangent shear modulus [Pa] of a coupon of a fabric that is sheared evenly in a
    trellis by `gamma` [rad].

    From the coupon's own energy: its second difference over the change of angle, over the volume.
    """
    weave = changed_fabrics.load(name).weave
    coupon = rectangle(name, 1.000001 * cells * np.array(weave.w), 21)
    low, middle, high = (
        sum(coupon.forces(in_trellis(coupon, gamma + d))[2]) for d in (-step, 0.0, step)
    )
    volume = len(coupon.quads) * float(np.prod(coupon.spacing)) * weave.thickness
    return (high - 2 * middle + low) / (step**2 * volume)


def limit_angles(fabric: str, K_s: float) -> Values:
    """Compute gamma1 from the narrower micrograph width, gamma2 by the corrected eq. 4-34."""
    given = changed_fabrics.load(fabric)
    weave = given.weave
    touching = []
    for family, count in zip(FAMILIES, (weave.warp_count, weave.weft_count)):
        try:
            touching.append(touching_angle(given.micrograph[family]["width"], 1 / count))
        except InputError:
            continue  # wider than its spacing
    locking = locking_angle(weave.warp.A_s, K_s, weave.thickness, 1 / weave.warp_count)
    first = None
    if touching:
        first = touching[0]
    return {"gamma1": first, "gamma2": locking}


def law_shape() -> Values:
    """Check that the trellis laws are odd and continuous, and their moduli constant, rising,
    constant."""
    odd = step = 0.0
    shape = True
    for law in (changed_fabrics.load(name).shear for name in KEVLAR):
        g = np.linspace(-1.2, 1.2, 24001)
        tau = law.stress(g)
        odd = max(odd, largest(tau + tau[::-1]) / tau.max())
        for corner in (law.gamma1, law.gamma2):
            sides = law.stress(np.array([corner * (1 - 1e-14), corner * (1 + 1e-14)]))
            step = max(step, float(np.ptp(sides) / tau.max()))
        G = np.gradient(tau, g)
        low = abs(g) < law.gamma1 - 1e-3
        high = (g > law.gamma2 + 1e-3) & (g < 1.19)
        shape = (
            shape
            and np.allclose(G[low], law.G1, rtol=1e-6)
            and np.allclose(G[high], law.G2, rtol=1e-6)
        )
    return {"odd": odd, "jump": step, "constant, rising, constant": bool(shape)}


def trellis(gamma: float, cells: int = 8) -> tuple[FloatArray, ...]:
    """Shear a coupon of S-720 in a trellis: shear angles, stretches of its yarns, corners of its
    elements."""
    coupon = rectangle("S-720", 1.01 * cells * changed_fabrics.load("S-720").weave.w1, 21)
    moved = in_trellis(coupon, gamma)
    return coupon.shear_angles(moved), np.concatenate(coupon.stretches(moved)), moved[coupon.quads]


def tension_change_in_shear(stretch: float, gamma: float) -> float:
    """Compute the largest relative difference of the tensions of a coupon that is stretched evenly,
    square and sheared."""
    coupon = rectangle("S-720", 0.01, 101)
    both = zip(
        coupon.tensions(stretch * coupon.points),
        coupon.tensions(stretch * in_trellis(coupon, gamma)),
    )
    return max(largest(square - sheared) / square.max() for square, sheared in both)


def bias_load_of_zones(length: float, width: float, elongation: float) -> float:
    """Compute the load [N] of a bias coupon of yarns that do not stretch: its work shears zone C by
    gamma and zone B by half of it.

    Zone B has the area width^2, zone C length width - 1.5 width^2 (Figure 4-25); gamma as `inextensible_shear`; the
    fabric is that of straight yarns with G1 at all angles.
    """
    fabric = coupon_fabric("straight")[0]
    step = 1e-6 * length
    gamma, before, after = (
        inextensible_shear(length, width, elongation + d) for d in (0, -step, step)
    )
    C = length * width - 1.5 * width**2
    B = width**2
    moment = C * fabric.shear.stress(gamma) + 0.5 * B * fabric.shear.stress(0.5 * gamma)
    return float(fabric.weave.thickness * moment * (after - before) / (2 * step))
