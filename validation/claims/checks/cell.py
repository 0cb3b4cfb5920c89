"""The unit cell of section 4.3, alone and between its bounds. Equations are the thesis's: the equilibrium form.

Where the printed compression law is meant, it is used; else the regularised one (erratum E-05).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import quad

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.compression import CompressionLaw
from fabrics.weave import arc_length
from shellfabric.cell import crossover_kernels
from shellfabric.cell.model import CellModel
from validation.claims.checks.by_hand import departure
from validation.claims.checks.geometry import KEVLAR
from validation.claims.registry import Found, Run, RunResult, check

if TYPE_CHECKING:
    from fabrics.yarn import Yarn

_N = 161


def cell(name: str, model: str = "compressible", **changes: Any) -> CellModel:
    return CellModel(catalogue.load(name), model=model, form="equilibrium", **changes)


def printed(name: str, a: None = None) -> CellModel:
    """The cell with the law as printed."""
    given = catalogue.load(name)
    laws = tuple(CompressionLaw(a or law.a, law.b, form="printed") for law in given.laws)
    return CellModel(given, laws, form="equilibrium")  # type: ignore[arg-type]


def end(yarn: Yarn) -> float:
    """Stretch of the cell at which a yarn alone is at its strength."""
    return (1 + yarn.crimp) * (1 + yarn.failure_strain)


def warp_pull(model: CellModel, n: int = _N) -> tuple[FloatArray, dict[str, FloatArray]]:
    """(strain, solution) along warp extension with the weft held, to the failure of the first yarn."""
    weave = model.fabric.weave
    strain = np.linspace(0, end(weave.warp) - 1, n)
    found = model.solve(1 + strain, 1.0)
    safe = (found["T1"] <= weave.warp.strength) & (found["T2"] <= weave.weft.strength)
    last = n if safe.all() else int(np.argmin(safe))
    return strain[:last], {name: values[:last] for name, values in found.items()}


def random_states(name: str, n: int = 400, seed: int = 3) -> tuple[FloatArray, ...]:
    """Stretches between rest and failure at which the yarns touch."""
    weave = catalogue.load(name).weave
    rng = np.random.default_rng(seed)
    return tuple(1 + rng.uniform(0, 1, n) * (end(yarn) - 1) for yarn in weave.yarns)


@check()
def knees(fabric: str) -> Found:
    """A lone yarn: where the taut line meets no load, and its slope on the strain of the yarn's own length."""
    model = cell(fabric, "decoupled")
    found: Found = {}
    weave = model.fabric.weave
    for name, family, yarn in zip(("warp", "weft"), (0, 1), weave.yarns):
        stretch = np.linspace(1, end(yarn), 400)
        T = model.solve(*((stretch, 1.0) if family == 0 else (1.0, stretch)))[f"T{family + 1}"]
        taut = T > 0.01 * yarn.strength
        slope, start = np.polyfit(stretch[taut] - 1, T[taut], 1)
        found |= {
            f"knee {name}": -start / slope,
            f"stiffness {name}": slope * (1 + yarn.crimp),
            f"slack load {name}": T[stretch - 1 < yarn.crimp - 1e-9].max(),
        }
    return found | {"order": sorted(("warp", "weft"), key=lambda name: found[f"knee {name}"])}


def _both_outcomes(failure_strain: float, velocities: dict[str, list[float]]) -> dict[str, Run]:
    """Shots at each fabric, at each of its velocities."""
    return {
        f"{name} at {velocity:g}": Run.of("shot", fabric=name, velocity=velocity)
        for name, own in velocities.items()
        for velocity in own
    }


@check(_both_outcomes)
def strengths(failure_strain: float, velocities: dict[str, list[float]], **runs: RunResult) -> Found:
    """Tension of the warp in the coupled cell once its fibres are strained by so much and the weft has lost contact.

    And the largest tension of shots over E A times this strain, of those in which yarns fail and of the others.
    """
    failing: list[float] = []
    whole: list[float] = []
    for name, run in runs.items():
        yarns = catalogue.load(name.split(" at ")[0]).weave.yarns
        loads = [S * failure_strain / yarn.failure_strain for S, yarn in zip(run["strength"], yarns)]
        peak = max(T / load for T, load in zip(run["peak"], loads))
        (failing if run["failed"][-1] else whole).append(float(peak))
    found = {
        "least peak where yarns fail": min(failing, default=np.nan),
        "greatest peak where none fails": max(whole, default=np.nan),
    }
    for name in KEVLAR:
        model = cell(name)
        slack = model.range()[1][0]
        found[name] = float(model.solve((1 + model.fabric.weave.warp.crimp) * (1 + failure_strain), slack)["T1"])
    return found


@check()
def failure_extensions() -> Found:
    """Cell strain at which the tension of a lone crimped yarn reaches its strength."""
    found = {}
    for fabric in KEVLAR:
        model = cell(fabric, "decoupled")
        for family, (name, yarn) in enumerate(zip(("warp", "weft"), model.fabric.weave.yarns)):
            low, high = 1.0, 1.5
            while high - low > 1e-10:
                middle = 0.5 * (low + high)
                pair = (middle, 1.0) if family == 0 else (1.0, middle)
                low, high = (low, middle) if model.solve(*pair)[f"T{family + 1}"] >= yarn.strength else (middle, high)
            found[f"{fabric} {name}"] = high - 1
    return found


@check()
def no_compression() -> Found:
    worst = 0.0
    for fabric in KEVLAR:
        model = cell(fabric, "decoupled")
        for strain in (0.005, 0.02, 0.05):
            found = model.solve(1 - strain, 1 - strain)
            worst = max(
                worst,
                *(float(abs(found[T])) / (yarn.EA * strain) for T, yarn in zip(("T1", "T2"), model.fabric.weave.yarns)),
            )
    return {"compression over tension": worst}


@check()
def equilibrium() -> Found:
    force = closing = 0.0
    for name in catalogue.list_names():
        model = cell(name)
        s1, s2 = random_states(name)
        found, weave = model.solve(s1, s2), model.fabric.weave
        contact = found["F"] > 0
        for T, h, w, s in zip(("T1", "T2"), ("h1", "h2"), weave.w, (s1, s2)):
            k = np.pi * found[h] / (2 * w * s)
            F = 2 * found[T] * k / np.sqrt(1 + k * k)
            force = max(force, np.abs(F / found["F"] - 1)[contact].max())
        law = model.fabric.laws[0]
        sum_h = found["h1"] + found["h2"]
        closing = max(closing, np.abs((sum_h + 2 * law.d(found["F"]) - sum(weave.h0)) / sum_h)[contact].max())
    return {"equilibrium": force, "compatibility": closing}


@check()
def jacobian() -> Found:
    """dS/dh by differences of the arc length, over eq. 4-24 as printed."""
    ratios = []
    for name in KEVLAR:
        weave = catalogue.load(name).weave
        for w, h in zip(weave.w, weave.h0):
            step = 1e-4 * h
            S = [arc_length(w, h + k * step) for k in (-2, -1, 1, 2)]
            slope = (S[0] - 8 * S[1] + 8 * S[2] - S[3]) / (12 * step)
            k = np.pi / (2 * w)
            part = quad(
                lambda x, k=k, h=h: np.sin(k * x) ** 2 / np.sqrt(1 + (k * h * np.sin(k * x)) ** 2),
                0,
                w,
                epsabs=0,
                epsrel=1e-12,
            )[0]
            ratios.append(slope / (k * k * h * part))
            assert abs(crossover_kernels.arc(w, h)[1] / slope - 1) < 1e-6
    return {"numerical over printed": max(ratios, key=lambda ratio: abs(ratio - 2))}


@check()
def slope_derivative() -> Found:
    """d sin(alpha)/dh that the contact force of the cell's equilibrium form has, over eq. 4-21.

    F = 2 T sin(alpha), so that dF/dh = 2 (dT/dh sin(alpha) + T dsin(alpha)/dh), with dT/dh = EA/S0 dS/dh.
    """
    worst = 0.0
    for name in KEVLAR:
        weave = catalogue.load(name).weave
        for w, h, S0, yarn in zip(weave.w, weave.h0, weave.S0, weave.yarns):
            stretched = 1.02 * w
            F, slope, T = crossover_kernels.contact_force(stretched, h, S0, yarn.EA, crossover_kernels.EQUILIBRIUM)
            dT = yarn.EA / S0 * crossover_kernels.arc(stretched, h)[1]
            found = (0.5 * slope - dT * 0.5 * F / T) / T
            printed = 4 * np.pi * stretched**2 / np.hypot(2 * stretched, np.pi * h) ** 3
            worst = max(worst, abs(found / printed - 1))
    return {"relative difference": worst}


@check()
def printed_at_rest() -> Found:
    found = {}
    for name in catalogue.list_names():
        rest = printed(name).solve(1.0, 1.0)
        found[f"F {name}"] = rest["F"]
        if name in KEVLAR:
            found |= {f"T warp {name}": rest["T1"], f"T weft {name}": rest["T2"]}
    return {name: float(value) for name, value in found.items()}


@check()
def printed_start() -> Found:
    return {name: catalogue.load(name).laws[0].F0 for name in catalogue.list_names()}


@check()
def warp_in_weave(fabric: str) -> Found:
    strain, woven = warp_pull(cell(fabric))
    alone = cell(fabric, "decoupled").solve(1 + strain, 1.0)
    crimp = catalogue.load(fabric).weave.warp.crimp
    before = (strain > 0.1 * crimp) & (strain < crimp)
    ratio = woven["T2"][before] / woven["T1"][before]
    return {
        "least lead of the woven yarn": (woven["T1"] - alone["T1"]).min(),
        "least lead before it is straight": (woven["T1"] - alone["T1"])[before].min(),
        "least growth of the weft": np.diff(woven["T2"]).min(),
        "least of weft over warp": ratio.min(),
        "greatest of weft over warp": ratio.max(),
        "off the equations": departure(cell(fabric), 1 + strain, 1.0),
    }


@check()
def tension_surface(fabric: str) -> Found:
    model = cell(fabric)
    s1, s2 = (np.linspace(1, end(yarn), 61) for yarn in model.fabric.weave.yarns)
    found = model.solve(*np.meshgrid(s1, s2, indexing="ij"))
    touching = (found["F"][:, 1:] > 0) & (found["F"][:, :-1] > 0) & (found["h1"][:, 1:] > 0)
    return {
        "least slope": (np.diff(found["T1"], axis=1) / np.diff(s2))[touching].min(),
        "off the equations": departure(model, *np.meshgrid(s1, s2, indexing="ij")),
    }


@check()
def exchange(fabric: str) -> Found:
    strain, found = warp_pull(cell(fabric))
    return {
        "greatest growth of h1": np.diff(found["h1"]).max(),
        "least growth of h2": np.diff(found["h2"]).min(),
        "off the equations": departure(cell(fabric), 1 + strain, 1.0),
        "note": f"h1 {1e3 * found['h1'][0]:.4f} to {1e3 * found['h1'][-1]:.4f} mm, "
        f"h2 {1e3 * found['h2'][0]:.4f} to {1e3 * found['h2'][-1]:.4f} mm",
    }


@check()
def incompressible_exchange() -> Found:
    worst = 0.0
    for name in catalogue.list_names():
        model = cell(name, "incompressible")
        found = model.solve(*random_states(name))
        full = sum(model.fabric.weave.h0)
        worst = max(worst, np.abs((found["h1"] + found["h2"])[found["F"] > 0] / full - 1).max())
    return {"relative change": worst}


@check()
def decoupled_limit() -> Found:
    worst = soft = 0.0
    for name in catalogue.list_names():
        stretches = random_states(name)
        model = cell(name, "decoupled")
        yielding = CompressionLaw(1.0, 1e-5)  # gives way by a metre under a force that no tension notices
        found = [given.solve(*stretches) for given in (model, cell(name, laws=(yielding, yielding)))]
        for T, s, w, S0, yarn in zip(
            ("T1", "T2"), stretches, model.fabric.weave.w, model.fabric.weave.S0, model.fabric.weave.yarns
        ):
            alone = yarn.EA * np.maximum(2 * w * s / S0 - 1, 0)
            worst, soft = (max(old, np.abs(f[T] - alone).max() / yarn.EA) for old, f in zip((worst, soft), found))
    return {"decoupled": worst, "very soft law": soft}


@check()
def stress_resultant() -> Found:
    """Forces at the edge of a stretched coupon over the force of the stresses of two half layers (eqs. 4-46 to 4-48).

    Each yarn acts in one half of the thickness, over the width of its cell; the mean over the whole thickness, times
    thickness and width, is to be what the nodes of the coupon are pulled with.
    """
    from shellfabric.coupon.model import mesh_coupon

    worst = 0.0
    for name in ("S-720", "S-726", "S-731"):
        model = CellModel(catalogue.load(name), form="variational")
        weave, table = model.fabric.weave, model.table(201)
        half = 8.000001 * np.array(weave.w)
        coupon = mesh_coupon(table, lambda x, y, half=half: (np.abs(x) < half[0]) & (np.abs(y) < half[1]), max(half))
        stretch = [1 + 0.6 * (end(yarn) - 1) for yarn in weave.yarns]
        forces = -coupon.forces(coupon.points * stretch)[0]
        state, width = model.solve(*stretch), 2 * np.array(weave.w[::-1])
        for axis in (0, 1):
            rim = coupon.points[:, axis] > coupon.points[:, axis].max() - 0.1 * weave.w[axis]
            across = np.ptp(coupon.points[rim, 1 - axis])
            layer = float(state[f"N{axis + 1}"]) / (0.5 * weave.thickness * width[axis])
            mean = 0.5 * layer
            pulled = abs(forces[rim, axis].sum())
            worst = max(worst, abs(mean * weave.thickness * across / pulled - 1))
    return {"relative difference": worst}


@check()
def lone_yarn() -> Found:
    """A yarn whose partner is gone, in a coupon of warp alone."""
    from shellfabric.coupon.model import mesh_coupon

    worst = 0.0
    for name in ("S-720", "S-731"):
        model = CellModel(catalogue.load(name), form="variational")
        weave = model.fabric.weave
        # the weft has been drawn out of the right half, as it has to be somewhere in a coupon
        coupon = mesh_coupon(
            model.table(51),
            lambda x, y: (np.abs(x) < 0.01) & (np.abs(y) < 0.01),
            0.01,
            woven=lambda x, y: (np.ones(x.shape, bool), x < 0),
        )
        lone = coupon.points[coupon.edges[0]][:, :, 0].min(axis=1) > 2 * weave.w1
        for stretch in (1.01, end(weave.warp) - 0.005):
            T = coupon.tensions(coupon.points * [stretch, 1.0])[0][lone]
            alone = weave.warp.EA * max(2 * weave.w1 * stretch - weave.S01, 0) / weave.S01
            worst = max(worst, np.abs(T - alone).max() / weave.warp.strength)
        # the printed w for 2w leaves it slack whatever the stretch
        as_printed = max(weave.w1 * end(weave.warp) - weave.S01, 0)
    return {"difference over strength": worst, "as printed, at failure": as_printed}
