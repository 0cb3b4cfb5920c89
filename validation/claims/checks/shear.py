"""Shear: the trellis law of Table 4-1, sheared coupons, the picture frame, the bias test (sections 4.3.2, 4.4.3)."""

from __future__ import annotations

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.trellis import locking_angle, touching_angle
from shellfabric.cell.model import CellModel
from shellfabric.coupon.model import Coupon, mesh_coupon
from shellfabric.coupon.quasistatic import inextensible_shear
from validation.claims.judge import Found
from validation.claims.readers import FAMILIES, KEVLAR


def _coupon(name, half, size=21):
    """A coupon of a fabric of this half size, or these half sizes [m]; its yarns in the variational form."""
    table = CellModel(catalogue.load(name), form="variational").table(size)
    half = np.broadcast_to(half, 2)
    return mesh_coupon(table, lambda x, y: (np.abs(x) < half[0]) & (np.abs(y) < half[1]), max(half))


def in_trellis(coupon: Coupon, gamma: float) -> FloatArray:
    """[m] nodes of a coupon that is sheared evenly by gamma [rad]."""
    (x, y), c, s = coupon.points.T, np.cos(gamma / 2), np.sin(gamma / 2)
    return np.stack([c * x + s * y, s * x + c * y], axis=1)


def sheared_modulus(name: str, gamma: float, cells: int = 6, step: float = 1e-4) -> float:
    """[Pa] tangent shear modulus of a coupon of a fabric that is sheared evenly in a trellis by `gamma` [rad].

    From the coupon's own energy: its second difference over the change of angle, over the volume.
    """
    weave = catalogue.load(name).weave
    coupon = _coupon(name, 1.000001 * cells * np.array(weave.w))
    low, middle, high = (sum(coupon.forces(in_trellis(coupon, gamma + d))[2]) for d in (-step, 0.0, step))
    return (high - 2 * middle + low) / (step**2 * len(coupon.quads) * np.prod(coupon.spacing) * weave.thickness)


def limit_angles(fabric: str, K_s: float) -> Found:
    """gamma1 from the narrower micrograph width, gamma2 by the corrected eq. 4-34."""
    given = catalogue.load(fabric)
    weave, touching = given.weave, []
    for family, count in zip(FAMILIES, (weave.warp_count, weave.weft_count)):
        try:
            touching.append(touching_angle(given.micrograph[family]["width"], 1 / count))
        except InputError:
            continue  # wider than its spacing
    locking = locking_angle(weave.warp.A_s, K_s, weave.thickness, 1 / weave.warp_count)
    return {"gamma1": touching[0] if touching else None, "gamma2": locking}


def law_shape() -> Found:
    """Whether the trellis laws are odd and continuous, and their moduli constant, rising, constant."""
    odd = step = 0.0
    shape = True
    for law in (catalogue.load(name).shear for name in KEVLAR):
        g = np.linspace(-1.2, 1.2, 24001)
        tau = law.stress(g)
        odd = max(odd, float(np.abs(tau + tau[::-1]).max() / tau.max()))
        for corner in (law.gamma1, law.gamma2):
            sides = law.stress(np.array([corner * (1 - 1e-14), corner * (1 + 1e-14)]))
            step = max(step, float(np.ptp(sides) / tau.max()))
        G = np.gradient(tau, g)
        low, high = (np.abs(g) < law.gamma1 - 1e-3), (g > law.gamma2 + 1e-3) & (g < 1.19)
        shape = shape and np.allclose(G[low], law.G1, rtol=1e-6) and np.allclose(G[high], law.G2, rtol=1e-6)
    return {"odd": odd, "jump": step, "constant, rising, constant": bool(shape)}


def trellis(gamma: float, cells: int = 8) -> tuple[FloatArray, ...]:
    """A coupon of S-720 in a trellis: shear angles, stretches of its yarns, corners of its elements."""
    coupon = _coupon("S-720", 1.01 * cells * catalogue.load("S-720").weave.w1)
    moved = in_trellis(coupon, gamma)
    return coupon.shear_angles(moved), np.concatenate(coupon.stretches(moved)), moved[coupon.quads]


def tension_change_in_shear(stretch: float, gamma: float) -> float:
    """Largest relative difference of the tensions of a coupon that is stretched evenly, square and sheared."""
    coupon = _coupon("S-720", 0.01, 101)
    both = zip(coupon.tensions(stretch * coupon.points), coupon.tensions(stretch * in_trellis(coupon, gamma)))
    return max(np.abs(square - sheared).max() / square.max() for square, sheared in both)


def bias_load_of_zones(length: float, width: float, elongation: float) -> float:
    """[N] load of a bias coupon of yarns that do not stretch: its work shears zone C by gamma and zone B by half of it.

    Zone B has the area width^2, zone C length width - 1.5 width^2 (Figure 4-25); gamma as `inextensible_shear`; the
    cloth is that of straight yarns with G1 at all angles.
    """
    from validation.published.bias_extension import cases

    fabric, step = cases.cloth("straight")[0], 1e-6 * length
    gamma, before, after = (inextensible_shear(length, width, elongation + d) for d in (0, -step, step))
    C, B = length * width - 1.5 * width**2, width**2
    moment = C * fabric.shear.stress(gamma) + 0.5 * B * fabric.shear.stress(0.5 * gamma)
    return float(fabric.weave.thickness * moment * (after - before) / (2 * step))
