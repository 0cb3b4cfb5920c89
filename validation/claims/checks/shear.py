"""Shear: the trellis law of Table 4-1, the picture frame, the bias test (source thesis sections 4.3.2 and 4.4.3)."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.trellis import locking_angle, locking_modulus, touching_angle
from shellfabric.coupon.quasistatic import inextensible_shear
from validation.claims.checks.geometry import FAMILIES, KEVLAR, ranked
from validation.claims.registry import check
from validation.claims.run import Run


@check()
def locked_modulus(fabric):
    found = {}
    for name, given in (
        ("nominal", catalogue.load(fabric)),
        ("effective", catalogue.load(fabric).with_effective_density()),
    ):
        weave = given.weave
        found[name] = locking_modulus(weave.warp.E, weave.warp.A_s, weave.thickness, 2 * weave.w1)
    return found


@check()
def initial_modulus():
    ratios = [catalogue.load(name).shear.G1 / catalogue.load(name).shear.G2 for name in KEVLAR]
    return {"least": min(ratios), "greatest": max(ratios)}


@check()
def limit_angles(fabric, K_s):
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


@check()
def packing_order(K_s):
    packing = {"hexagonal": pi / (2 * sqrt(3)), "square": pi / 4, "fitted": K_s}
    implied = []
    for name in KEVLAR:
        given = catalogue.load(name)
        u2 = np.cos(given.shear.gamma2) / given.weave.warp_count
        implied.append(8 * given.weave.warp.A_s / (pi * u2 * given.weave.thickness))
    return {"order": ranked(packing), "note": f"Table 4-1 implies {min(implied):.2f} to {max(implied):.2f}"}


@check()
def law_shape():
    odd = step = 0.0
    shape = True
    for name in KEVLAR:
        law = catalogue.load(name).shear
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


@check()
def law_integral(fabric, gamma):
    return {f"at {g:g}": float(catalogue.load(fabric).shear.stress(g)) for g in gamma}


def trellis(gamma, cells=8):
    """A coupon of S-720 in a trellis: shear angles, stretches of its yarns, corners of its elements."""
    from shellfabric.cell.model import CellModel
    from shellfabric.coupon.model import mesh_coupon

    table = CellModel(catalogue.load("S-720"), form="variational").table(21)
    reach = 1.01 * cells * table.model.fabric.weave.w1
    coupon = mesh_coupon(table, lambda x, y: (np.abs(x) < reach) & (np.abs(y) < reach), reach)
    x, y = coupon.points.T
    c, s = np.cos(gamma / 2), np.sin(gamma / 2)
    moved = np.stack([c * x + s * y, s * x + c * y], axis=1)
    return coupon.shear_angles(moved), np.concatenate(coupon.stretches(moved)), moved[coupon.quads]


@check()
def rhombus(gamma):
    """Spacing of the sheared yarns over the side of their rhombus, against the cosine of the shear angle."""
    angles, _, x = trellis(gamma)
    side, across = x[:, 1] - x[:, 0], x[:, 3] - x[:, 0]
    area = np.abs(side[:, 0] * across[:, 1] - side[:, 1] * across[:, 0])
    spacing = area / np.linalg.norm(side, axis=1)
    return {"difference": np.abs(spacing / np.linalg.norm(across, axis=1) - np.cos(angles)).max()}


@check()
def trellis_kinematics(gamma):
    angles, stretches, _ = trellis(gamma)
    return {"angle change": float(np.abs(angles).mean()), "largest departure from 1": np.abs(stretches - 1).max()}


@check()
def heights_in_shear():
    """Heights and thickness of the cell hang on the stretches alone, which a trellis leaves at one."""
    from shellfabric.cell.model import CellModel

    worst = 0.0
    for name in KEVLAR:
        given = catalogue.load(name)
        rest = CellModel(given).solve(1.0, 1.0)
        worst = max(worst, *(abs(float(rest[h]) / h0 - 1) for h, h0 in zip(("h1", "h2"), given.weave.h0)))
    return {"relative change": worst}


@check()
def tension_in_shear(stretch, gamma):
    """Tension of every segment of a coupon, stretched evenly, square and sheared."""
    from shellfabric.cell.model import CellModel
    from shellfabric.coupon.model import mesh_coupon

    table = CellModel(catalogue.load("S-720"), form="variational").table(101)
    coupon = mesh_coupon(table, lambda x, y: (np.abs(x) < 0.01) & (np.abs(y) < 0.01), 0.01)
    x, y = coupon.points.T
    square = np.stack([stretch * x, stretch * y], axis=1)
    c, s = np.cos(gamma / 2), np.sin(gamma / 2)
    sheared = np.stack([stretch * (c * x + s * y), stretch * (s * x + c * y)], axis=1)
    differences = [np.abs(a - b).max() / a.max() for a, b in zip(coupon.tensions(square), coupon.tensions(sheared))]
    return {"relative difference": max(differences)}


def _bias(*names):
    return lambda **_: {name: Run.of("bias", cloth=name) for name in names}


@check(_bias("locking"))
def bias_zones(locking):
    A, B, C = np.degrees(locking["angles"][-1])
    return {"least distance": np.radians(min(A - B, B - C)), "note": f"A {A:.1f}, B {B:.1f}, C {C:.1f} degrees"}


@check(_bias("locking"))
def bias_mean(locking):
    A, B, C = locking["angles"].T
    return {"B less mean": (B - 0.5 * (A + C))[np.argmax(np.abs(B - 0.5 * (A + C)))]}


@check(_bias("locking", "straight"))
def bias_angle(locking, straight, length, width, elongation):
    C = pi / 2 - inextensible_shear(length, width, elongation)
    run = straight["angles"][-1]
    return {
        "C, closed form": C,
        "B, closed form": 0.5 * (C + pi / 2),
        "C, straight yarns": run[2],
        "B, straight yarns": run[1],
        "note": f"with the published trellis, which locks from {np.degrees(0.12):.0f} "
        f"degrees on, C is {np.degrees(locking['angles'][-1][2]):.1f} degrees",
    }


@check(_bias("locking"))
def bias_symmetry(locking):
    return {"asymmetry": locking["asymmetry"]}


@check(_bias("locking", "soft", "none"))
def bias_bands(locking, soft, none):
    return {
        "locking": locking["concentration"][-1],
        "G2 = G1": soft["concentration"].max(),
        "no trellis": none["concentration"].max(),
        "note": none["problem"],
    }
