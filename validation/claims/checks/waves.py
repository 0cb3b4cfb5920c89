"""Waves along lone, bare and woven yarns, and their arrivals at the edge (thesis section 5.2.4.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from fabrics import catalogue
from shellfabric.output import wave_fronts
from validation.claims.checks import series
from validation.claims.checks.geometry import KEVLAR, ranked
from validation.claims.registry import Found, Run, RunResult, check

NOSE = 3e-3  # [m] beyond the rounded edge of the projectile


def shot(fabric: str, velocity: float = 100.0, **changes: Any) -> Run:
    """Run of a shot."""
    return Run.of("shot", fabric=fabric, velocity=velocity, **changes)


def six(velocity: float = 100.0) -> dict[str, Run]:
    """Runs of all fabrics at one velocity; the name without its dash, so that a check can take it as keyword."""
    return {name.replace("-", ""): shot(name, velocity, snapshots=25e-6) for name in KEVLAR}


@dataclass
class _Yarn:
    """What `shellfabric.output.wave_fronts` reads of a yarn's history."""

    family: str
    X: np.ndarray
    tension: np.ndarray
    place: np.ndarray
    deflection: np.ndarray
    strength: float


def front(run: RunResult, family: str, kind: str) -> Any:
    """Speed [m/s] of a front along the yarn through the impact point."""
    yarn = _Yarn(family, **run["yarns"][family])
    return getattr(wave_fronts, kind)(yarn, run["clock"]).speed


@check(lambda fabric, velocity: {"run": Run.of("struck_yarn", fabric=fabric, velocity=velocity)})
def lone_yarn(run: RunResult, fabric: str, velocity: float) -> Found:
    return {"c": run["c"], "note": f"Smith's closed form {run['theory_c']:.0f} m/s"}


def _bare(fabric):
    """Straight yarns with the mass of those that cross, and without any coupling; then with the crimp of the warp."""
    crimp = catalogue.load(fabric).weave.warp.crimp
    both = {"cell_model": "decoupled", "interval": 0.5e-6}
    return {"straight": shot(fabric, straight=True, **both), "crimped": shot(fabric, crimps=[crimp, crimp], **both)}


@check(_bare)
def bare_speed(straight: RunResult, crimped: RunResult, fabric: str) -> Found:
    speed = front(straight, "warp", "longitudinal")
    return {"speed": speed, "over that of a lone yarn": speed / catalogue.load(fabric).weave.warp.wave_speed}


@check(_bare)
def crimp_slows(straight: RunResult, crimped: RunResult, fabric: str) -> Found:
    found = {}
    for kind in ("longitudinal", "transverse"):
        speeds = [front(run, "warp", kind) for run in (crimped, straight)]
        found[f"{kind}, crimped over straight"] = speeds[0] / speeds[1]
        found.setdefault("note", "")
        found["note"] += f"{kind} {speeds[0]:.0f} and {speeds[1]:.0f} m/s; "
    slopes = []
    for run in (crimped, straight):
        yarn = run["yarns"]["warp"]
        k = int(np.argmin(np.abs(run["clock"] - 100e-6)))
        x, z = yarn["place"][k], yarn["deflection"][k]
        part = (z > 0.3 * z.max()) & (z < 0.8 * z.max())
        slopes.append(-np.polyfit(x[part], z[part], 1)[0])
    return found | {"slope, crimped over straight": slopes[0] / slopes[1]}


@check(lambda fabric, velocity: {"run": Run.of("struck_yarn", fabric=fabric, velocity=velocity)})
def inflow(run: RunResult, fabric: str, velocity: float) -> Found:
    """Velocity of the material behind the front, from what it has moved, over that of Smith's closed form; the side."""
    X, c, e = run["X"], run["theory_c"], run["theory_strain"]
    t = run["nodes"][0, 1] / velocity
    kink = run["U"] * t
    between = (X > 1.5 * kink) & (X < 0.8 * c * t)
    inwards = -(run["nodes"][between, 0] - X[between]) / (t - X[between] / c)
    cone = run["nodes"][:, 0] < 0.9 * kink
    side = np.corrcoef(run["nodes"][cone, 0], run["nodes"][cone, 1])[0, 1] ** 2
    return {
        "spread of the inflow": np.ptp(inwards) / inwards.mean(),
        "inflow over c e": inwards.mean() / (c * e),
        "R2 of the side": side,
    }


@check(
    lambda fabric, velocity, slower, **_: {
        "run": Run.of("struck_yarn", fabric=fabric, velocity=velocity),
        "later": Run.of("struck_yarn", fabric=fabric, velocity=slower),
    }
)
def cone(
    run: RunResult, later: RunResult, fabric: str, velocity: float, slower: float, mass: float, time: float
) -> Found:
    """Side of the cone of a lone yarn, and what its slope V / U loses while the yarn slows a projectile of a mass down.

    The force on the striker is that of the march at constant velocity; two velocities give the slope's change with V.
    """
    inside = run["nodes"][:, 0] < 0.9 * run["U"] * run["nodes"][0, 1] / velocity
    side = np.corrcoef(*run["nodes"][inside].T)[0, 1] ** 2
    slope, slowed = velocity / run["U"], slower / later["U"]
    lost = run["force"] / mass * time
    change = (slope - slowed) / (velocity - slower) * lost / slope
    return {
        "R2": side,
        "fall of the slope": change,
        "note": f"slope {slope:.3f}; {run['force']:.0f} N take {lost:.2f} m/s off {1e3 * mass:g} g",
    }


@check(
    lambda fabric, velocity, length, times: {
        "run": Run.of("yarn_in_shell", fabric=fabric, velocity=velocity, length=length, end_time=max(times) + 2e-6)
    }
)
def shell_cone(run: RunResult, fabric: str, velocity: float, length: float, times: Sequence[float]) -> Found:
    """Sides of the cone of straight yarns of the shell that cross nothing: straightness, and slope at times [s]."""
    slopes, R2 = [], []
    for t in times:
        k = int(np.argmin(np.abs(run["clock"] - t)))
        x, z = run["place"][k], run["deflection"][k]
        side = (x > NOSE) & (z > 0.1 * z.max())
        slopes.append(-np.polyfit(x[side], z[side], 1)[0])
        R2.append(np.corrcoef(x[side], z[side])[0, 1] ** 2)
    return {
        "R2": min(R2),
        "fall of the slope": 1 - slopes[-1] / slopes[0],
        "note": ", ".join(f"{1e6 * t:.0f} us: slope {s:.3f}, R2 {r:.4f}" for t, s, r in zip(times, slopes, R2)),
    }


@check(lambda fabric, near, far: {"run": shot(fabric, interval=0.5e-6)})
def flattening(run: RunResult, fabric: str, near: float, far: float) -> Found:
    """Distance over which the tension of the weft rises from a tenth to half of the plateau behind, at two places."""
    yarn, width = run["yarns"]["weft"], {}
    speed = front(run, "weft", "longitudinal")
    for name, place in (("near", near), ("far", far)):
        T = yarn["tension"][:, int(np.argmin(np.abs(yarn["X"] - place)))]
        start = np.argmax(T > 0.01 * yarn["strength"])
        plateau = T[start : start + 40].max()  # within 20 us
        part = slice(max(start - 5, 0), start + 40)
        rise, clock = np.maximum.accumulate(T[part]), run["clock"][part]
        times = [clock[np.argmax(rise >= share * plateau)] for share in (0.1, 0.5)]
        width[name] = (times[1] - times[0]) * speed
    return {
        "far over near": width["far"] / width["near"],
        "note": f"{1e3 * width['near']:.1f} and {1e3 * width['far']:.1f} mm",
    }


@check(six)
def crimp_power_law(**runs: RunResult) -> Found:
    crimps, speeds, sides = [], [], []
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        for family, yarn in zip(("warp", "weft"), catalogue.load(name).weave.yarns):
            crimps.append(yarn.crimp)
            speeds.append(front(run, family, "longitudinal"))
            sides.append(front(run, family, "transverse"))
    x, y = np.log(crimps), np.log(speeds)
    sound = np.isfinite(sides)
    return {
        "log-log correlation": np.corrcoef(x, y)[0, 1],
        "points": len(x),
        "rank correlation of U": spearmanr(np.array(crimps)[sound], np.array(sides)[sound])[0],
        "note": f"C = {np.exp(np.polyfit(x, y, 1)[1]):.0f} crimp^{np.polyfit(x, y, 1)[0]:.2f} m/s; "
        f"{sound.sum()} transverse fronts found",
    }


@check(lambda fabric: {"run": shot(fabric, snapshots=25e-6)})
def anisotropy(run: RunResult, fabric: str) -> Found:
    U = [front(run, family, "transverse") for family in ("warp", "weft")]
    return {"weft over warp": U[1] / U[0], "note": f"U {U[0]:.0f} m/s along the warp, {U[1]:.0f} along the weft"}


@check(six)
def speed_and_split(**runs: RunResult) -> Found:
    C, uneven = {}, {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        C[name] = np.mean([front(run, family, "longitudinal") for family in ("warp", "weft")])
        share, some = series.ratio(run)
        uneven[name] = abs(series.over_displacement(run, share, some) - 1)
    return {
        "rank correlation": spearmanr(list(C.values()), list(uneven.values()))[0],
        "note": "; ".join(f"{n} {C[n]:.0f} m/s, {uneven[n]:.2f}" for n in ranked(C)),
    }


@check(lambda fabric: {"run": shot(fabric, snapshots=25e-6)})
def arrivals(run: RunResult, fabric: str) -> Found:
    t = [series.onset(run, family) for family in ("warp", "weft")]
    return {
        "warp": t[0],
        "weft": t[1],
        "warp less weft": t[0] - t[1],
        "order": ["weft", "warp"] if t[1] < t[0] else ["warp", "weft"],
        "note": f"edge reactions reach 2 % of the strength at {1e6 * t[0]:.0f} (warp) and {1e6 * t[1]:.0f} us (weft)",
    }


@check(
    lambda fabric, below, above: {
        "slow": Run.of("stability", fabric=fabric, velocity=50.0, factor=below, end_time=60e-6),
        "fast": Run.of("stability", fabric=fabric, velocity=50.0, factor=above, end_time=60e-6),
    }
)
def courant(slow: RunResult, fast: RunResult, fabric: str, below: float, above: float) -> Found:
    weave = catalogue.load(fabric).weave
    return {
        "length over speed": 2 * weave.w1 / weave.warp.wave_speed,
        f"stable at {below:g}": slow["stable"],
        f"stable at {above:g}": fast["stable"],
        "note": fast["message"],
    }
