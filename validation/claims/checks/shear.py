"""Shear: the trellis law of Table 4-1, the picture frame, the bias test (thesis sections 4.3.2 and 4.4.3)."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.trellis import locking_angle, locking_modulus, touching_angle
from shellfabric.coupon.quasistatic import inextensible_shear
from validation.claims.checks.geometry import FAMILIES, KEVLAR, ranked
from validation.claims.registry import Found, Run, RunResult, check


@check()
def locked_modulus(fabric: str) -> Found:
    found = {}
    for name, given in (
        ("nominal", catalogue.load(fabric)),
        ("effective", catalogue.load(fabric).with_effective_density()),
    ):
        weave = given.weave
        found[name] = locking_modulus(weave.warp.E, weave.warp.A_s, weave.thickness, 2 * weave.w1)
    return found


def sheared_modulus(name: str, gamma: float, cells: int = 6, step: float = 1e-4) -> float:
    """[Pa] tangent shear modulus of a coupon of a fabric that is sheared evenly in a trellis by `gamma` [rad].

    From the coupon's own energy: its second difference over the change of angle, over the volume.
    """
    from shellfabric.cell.model import CellModel
    from shellfabric.coupon.model import mesh_coupon

    table = CellModel(catalogue.load(name), form="variational").table(21)
    half = 1.000001 * cells * np.array(table.model.fabric.weave.w)
    coupon = mesh_coupon(table, lambda x, y: (np.abs(x) < half[0]) & (np.abs(y) < half[1]), max(half))
    x, y = coupon.points.T

    def energy(angle):
        c, s = np.cos(angle / 2), np.sin(angle / 2)
        return sum(coupon.forces(np.stack([c * x + s * y, s * x + c * y], axis=1))[2])

    volume = len(coupon.quads) * np.prod(coupon.spacing) * table.model.fabric.weave.thickness
    return (energy(gamma + step) - 2 * energy(gamma) + energy(gamma - step)) / (step**2 * volume)


@check()
def initial_modulus() -> Found:
    """Tangent shear modulus of coupons before the yarns touch, over that after they have locked."""
    ratios = {}
    for name in KEVLAR:
        law = catalogue.load(name).shear
        ratios[name] = sheared_modulus(name, 0.5 * law.gamma1) / sheared_modulus(name, law.gamma2 + 0.1)
    return {
        "least": min(ratios.values()),
        "greatest": max(ratios.values()),
        "note": ", ".join(f"{name} {1e3 * ratio:.4f}e-3" for name, ratio in ratios.items()),
    }


@check(lambda fabric, gamma: {"run": Run.of("frame", fabric=fabric, shear_angle=0.9, steps=18, cells=4)})
def frame_load(run: RunResult, fabric: str, gamma: float) -> Found:
    """Force of a picture frame at a shear angle over that of the published law, and its growth after locking."""
    law, weave = catalogue.load(fabric).with_effective_density().shear, catalogue.load(fabric).weave
    side = float(np.sqrt(np.prod(run["side"])))
    expected = law.stress(gamma) * side * weave.thickness / np.cos(0.25 * pi + 0.5 * gamma)
    force = np.interp(gamma, run["gamma"], run["force"])
    locked = run["gamma"] > law.gamma2
    free = run["gamma"] < law.gamma1
    return {
        "force over the law's": float(force / expected),
        "stiffer once locked": float(
            np.diff(run["force"][locked]).min() / max(np.diff(np.append(0.0, run["force"][free])).max(), 1e-300)
        ),
        "note": f"{force:.3g} N on a frame of {1e3 * side:.1f} mm at {gamma:g} rad",
    }


@check()
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


@check()
def packing_order(K_s: float) -> Found:
    packing = {"hexagonal": pi / (2 * sqrt(3)), "square": pi / 4, "fitted": K_s}
    implied = []
    for name in KEVLAR:
        given = catalogue.load(name)
        u2 = np.cos(given.shear.gamma2) / given.weave.warp_count
        implied.append(8 * given.weave.warp.A_s / (pi * u2 * given.weave.thickness))
    return {"order": ranked(packing), "note": f"Table 4-1 implies {min(implied):.2f} to {max(implied):.2f}"}


@check()
def law_shape() -> Found:
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
def law_integral(fabric: str, gamma: Sequence[float]) -> Found:
    return {f"at {g:g}": float(catalogue.load(fabric).shear.stress(g)) for g in gamma}


def trellis(gamma: float, cells: int = 8) -> tuple[FloatArray, ...]:
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
def rhombus(gamma: float) -> Found:
    """Spacing of the sheared yarns over the side of their rhombus, against the cosine of the shear angle."""
    angles, _, x = trellis(gamma)
    side, across = x[:, 1] - x[:, 0], x[:, 3] - x[:, 0]
    area = np.abs(side[:, 0] * across[:, 1] - side[:, 1] * across[:, 0])
    spacing = area / np.linalg.norm(side, axis=1)
    return {"difference": np.abs(spacing / np.linalg.norm(across, axis=1) - np.cos(angles)).max()}


@check()
def trellis_kinematics(gamma: float) -> Found:
    angles, stretches, _ = trellis(gamma)
    return {"angle change": float(np.abs(angles).mean()), "largest departure from 1": np.abs(stretches - 1).max()}


@check()
def heights_in_shear(gamma: float) -> Found:
    """Heights of the yarns of a coupon that is sheared in a trellis, from its cells' stretches, over those at rest."""
    from shellfabric.cell.model import CellModel

    angles, stretches, _ = trellis(gamma)
    half = len(stretches) // 2
    model = CellModel(catalogue.load("S-720"))
    state = model.solve(stretches[:half], stretches[half : 2 * half])
    thickness = 2 * (state["h1"] + state["h2"])
    return {
        "relative change": float(np.abs(thickness / model.fabric.weave.thickness - 1).max()),
        "sheared by": float(np.abs(angles).mean()),
    }


@check()
def tension_in_shear(stretch: float, gamma: float) -> Found:
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
def bias_zones(locking: RunResult) -> Found:
    A, B, C = np.degrees(locking["angles"][-1])
    return {"least distance": np.radians(min(A - B, B - C)), "note": f"A {A:.1f}, B {B:.1f}, C {C:.1f} degrees"}


@check(_bias("locking"))
def bias_mean(locking: RunResult) -> Found:
    A, B, C = locking["angles"].T
    return {"B less mean": (B - 0.5 * (A + C))[np.argmax(np.abs(B - 0.5 * (A + C)))]}


@check(_bias("locking", "straight"))
def bias_angle(locking: RunResult, straight: RunResult, length: float, width: float, elongation: float) -> Found:
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
def bias_symmetry(locking: RunResult) -> Found:
    return {"asymmetry": locking["asymmetry"]}


@check(_bias("locking", "none"))
def bias_bands(locking: RunResult, none: RunResult) -> Found:
    """Largest over typical shear of the coupon (`quasistatic.concentration`) with the trellis and without it."""
    return {
        "locking": locking["concentration"][-1],
        "no trellis": none["concentration"].max(),
        "note": none["problem"],
    }


@check(_bias("soft"))
def bias_unhardened(soft: RunResult) -> Found:
    """The same with the trellis at its first modulus at all angles."""
    return {"G2 = G1": soft["concentration"].max()}


def bias_load_of_zones(law: Any, thickness: float, length: float, width: float, elongation: float) -> float:
    """[N] load of a bias coupon of yarns that do not stretch: its work shears zone C by gamma and zone B by half of it.

    Zone B has the area width^2, zone C length width - 1.5 width^2 (Figure 4-25); gamma as `inextensible_shear`.
    """
    step = 1e-6 * length
    gamma, before, after = (inextensible_shear(length, width, elongation + d) for d in (0, -step, step))
    C, B = length * width - 1.5 * width**2, width**2
    moment = C * law.stress(gamma) + 0.5 * B * law.stress(0.5 * gamma)
    return float(thickness * moment * (after - before) / (2 * step))


@check(lambda **_: {name: Run.of("bias_load", cloth=name) for name in ("locking", "soft", "straight")})
def bias_loads(locking: RunResult, soft: RunResult, straight: RunResult, length: float, width: float) -> Found:
    """Load of the bias coupon at its full elongation: published law over G1 at all angles; straight yarns over zones.

    The load of straight yarns with G1 at all angles is held against `bias_load_of_zones`.
    """
    from validation.published.bias_extension import cases

    load = [run["load"][-1] for run in (locking, soft)]
    fabric = cases.cloth("straight")[0]
    zones = bias_load_of_zones(fabric.shear, fabric.weave.thickness, length, width, straight["moved"][-1])
    return {
        "published over soft": load[0] / load[1],
        "straight over closed form": straight["load"][-1] / zones,
        "least growth": float(np.diff(locking["load"]).min()),
        "note": f"{load[0]:.1f} and {load[1]:.2f} N at {1e3 * locking['moved'][-1]:.0f} mm",
    }
