"""Panels between the bounds and beside the cable net, and what the trellis does (thesis sections 4.4.2, 6.4)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from validation.claims.checks import series
from validation.claims.checks.geometry import KEVLAR, ranked
from validation.claims.checks.impact import bare_shot, outcome_of, shot
from validation.claims.checks.waves import six
from validation.claims.registry import Found, Run, RunResult, check

MODELS = ("incompressible", "compressible", "decoupled")


def _no_crimp(fabric):
    return {
        "shell": bare_shot(fabric, straight=True, cell_model="decoupled"),
        "cables": Run.of("net", fabric=fabric, velocity=100.0, straight=True),
    }


def _apart(one, other, start=0.0, end=250e-6):
    """[m/s] largest difference of velocity between two runs."""
    t = np.linspace(start, min(end, one["fine"][-1, 0], other["fine"][-1, 0]), 300)
    return float(np.abs(series.velocity(one, t) - series.velocity(other, t)).max())


@check(_no_crimp)
def cable_without_crimp(shell: RunResult, cables: RunResult, fabric: str) -> Found:
    return {"largest difference": _apart(shell, cables)}


@check(_no_crimp)
def cable_noise(shell: RunResult, cables: RunResult, fabric: str) -> Found:
    end = min(shell["t"][-1], cables["fine"][-1, 0])
    t = np.arange(0, end, 1e-6)
    of_shell = np.interp(t, shell["t"], shell["reactions"]["warp"])
    of_cables = np.interp(t, cables["fine"][:, 0], series_mean(cables, "warp"))
    noise = [series.noise(t, record) for record in (of_shell, of_cables)]
    return {"shell over cable": noise[0] / noise[1], "note": f"{noise[0]:.1f} and {noise[1]:.1f} N"}


def series_mean(cables: RunResult, family: str) -> FloatArray:
    """The reaction of the net as means over a microsecond, as the shell's audit is spaced."""
    N, dt = cables["reactions"][family], cables["fine"][1, 0] - cables["fine"][0, 0]
    width = max(1, round(1e-6 / dt))
    return np.convolve(N, np.ones(width) / width, "same")


def _coupling(fabric):
    runs = {model: shot(fabric, cell_model=model) for model in MODELS if model != "compressible"}
    return runs | {"compressible": shot(fabric), "cables": Run.of("net", fabric=fabric, velocity=100.0)}


@check(_coupling)
def cable_with_crimp(
    incompressible: RunResult, compressible: RunResult, decoupled: RunResult, cables: RunResult, fabric: str
) -> Found:
    return {"largest difference": _apart(decoupled, cables)}


@check(_coupling)
def coupling(
    incompressible: RunResult, compressible: RunResult, decoupled: RunResult, cables: RunResult, fabric: str
) -> Found:
    t = np.linspace(60e-6, 250e-6, 100)
    v = {
        name: series.velocity(run, t)
        for name, run in (("inc", incompressible), ("com", compressible), ("dec", decoupled), ("net", cables))
    }
    net = (v["dec"] - v["com"]) / (v["dec"] - v["inc"])
    k = int(np.argmin(np.abs(t - 200e-6)))
    return {
        "least lag of the decoupled": (v["dec"] - v["com"]).min(),
        "least lag of the net": (v["net"] - v["com"]).min(),
        "share of the way, 200 us": net[k],
        "note": f"at 200 us: coupled {v['com'][k]:.1f}, decoupled {v['dec'][k]:.1f}, "
        f"net {v['net'][k]:.1f}, incompressible {v['inc'][k]:.1f} m/s",
    }


@check(_coupling)
def bounds(
    incompressible: RunResult, compressible: RunResult, decoupled: RunResult, cables: RunResult, fabric: str
) -> Found:
    """Velocities and kinetic shares between the bounds, from 60 us on to where the first has stopped."""
    runs = {"incompressible": incompressible, "compressible": compressible, "decoupled": decoupled}
    end = min(run["fine"][-1, 0] for run in runs.values())
    t = np.linspace(60e-6, end, 200)
    v = {name: series.velocity(run, t) for name, run in runs.items()}
    z = {name: run["z"][-1] for name, run in runs.items()}
    share = {}
    for name, run in runs.items():
        r, some = series.ratio(run)
        share[name] = float(np.nanmean(r[some & (run["t"] > 60e-6) & (run["t"] < end)]))
    way = (v["decoupled"] - v["compressible"]) / (v["decoupled"] - v["incompressible"])
    sure = (v["decoupled"] - v["incompressible"]) > 1.0
    position = float(np.mean(way[sure])) if sure.any() else np.nan
    return {
        "least distance, incompressible": (v["compressible"] - v["incompressible"]).min(),
        "least distance, decoupled": (v["decoupled"] - v["compressible"]).min(),
        "order": sorted(v, key=lambda name: v[name].mean()),
        "highest kinetic share": ranked(share)[0],
        "mean share of the way": position,
        "kinetic share of the way": (share["decoupled"] - share["compressible"])
        / (share["decoupled"] - share["incompressible"]),
        "note": "KE/IE "
        + ", ".join(f"{n} {s:.2f}" for n, s in share.items())
        + "; back face "
        + ", ".join(f"{n} {1e3 * d:.1f} mm" for n, d in z.items()),
    }


def _bracketing(fabrics):
    return {
        f"{name.replace('-', '')}_{model}": shot(name, **({} if model == "compressible" else {"cell_model": model}))
        for name in fabrics
        for model in MODELS
    }


@check(_bracketing)
def bracketed(fabrics: Sequence[str], **runs: RunResult) -> Found:
    least, note = np.inf, []
    for name in fabrics:
        own = {model: runs[f"{name.replace('-', '')}_{model}"] for model in MODELS}
        t = np.linspace(0, min(run["fine"][-1, 0] for run in own.values()), 300)
        v = {model: series.velocity(run, t) for model, run in own.items()}
        for slower, faster in (("incompressible", "compressible"), ("compressible", "decoupled")):
            k = int(np.argmin(v[faster] - v[slower]))
            least = min(least, v[faster][k] - v[slower][k])
            outside = 100 * np.mean(v[faster] < v[slower] - 1e-9)
            note.append(
                f"{name} {slower} over {faster} by {v[slower][k] - v[faster][k]:.2f} m/s at most, after "
                f"{1e6 * t[k]:.0f} us, {outside:.0f} % of the time"
            )
    return {"least distance inside": least, "note": "; ".join(note)}


@check(six)
def shear_share(**runs: RunResult) -> Found:
    shares = {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        shares[name] = float(run["energies"]["shear"][-1] / series.internal(run)[-1])
    return {"largest": max(shares.values()), "note": ", ".join(f"{n} {100 * s:.1f} %" for n, s in shares.items())}


@check(six)
def largest_shear(**runs: RunResult) -> Found:
    """Largest shear angle of any whole element until the stop, in units of gamma1."""
    over, lines = {}, []
    for name in KEVLAR:
        law = catalogue.load(name).shear
        most = max(float(taken["gamma"][taken["whole"]].max()) for taken in runs[name.replace("-", "")]["snapshots"])
        over[name] = most / law.gamma1
        lines.append(f"{name} {most:.2f} rad, {over[name]:.2f} gamma1, {most / law.gamma2:.2f} gamma2")
    rest = {name: value for name, value in over.items() if name != "S-731"}
    return {
        "exceed gamma1": [n for n in KEVLAR if over[n] > 1],
        "most over gamma1, without S-731": max(rest.values()),
        "note": "; ".join(lines),
    }


def sheared(fabric: str, G_soft: float, G_hard: float, gamma: list[float]) -> dict[str, Run]:
    return {
        "trellis": shot(fabric),
        "soft": shot(fabric, shear={"G1": G_soft, "G2": G_soft * 1.000001}),
        "hard": shot(fabric, shear={"G1": G_hard, "G2": G_hard * 1.000001}),
        "tight": shot(fabric, shear={"gamma1": gamma[0], "gamma2": gamma[1]}),
    }


@check(sheared)
def shear_laws(trellis: RunResult, soft: RunResult, hard: RunResult, tight: RunResult, fabric: str, **_: Any) -> Found:
    t = np.linspace(0, 400e-6, 401)
    v = {
        name: series.velocity(run, t)
        for name, run in (("trellis", trellis), ("low shear", soft), ("high shear", hard), ("tight", tight))
    }
    k = int(np.argmin(np.abs(t - 150e-6)))
    drop = {name: 100.0 - w[k] for name, w in v.items()}
    apart = {name: float(np.abs(w - v["trellis"]).max()) for name, w in v.items()}
    locked = apart["high shear"]
    return {
        "soft apart": apart["low shear"],
        "soft apart over hard apart": apart["low shear"] / locked if locked else np.nan,
        "tight apart": np.abs(v["tight"] - v["trellis"]).max(),
        "order": ranked({n: d for n, d in drop.items() if n != "tight"}),
        "drop, high over trellis": drop["high shear"] / drop["trellis"],
        "note": "lost after 150 us: "
        + ", ".join(f"{n} {d:.1f} m/s" for n, d in drop.items())
        + f"; high shear {outcome_of(hard)}, {1e6 * hard['t'][-1]:.0f} us after the strike; lost after 70 us: "
        + ", ".join(f"{n} {100 - float(np.interp(70e-6, t, w)):.1f} m/s" for n, w in v.items()),
    }


@check(sheared)
def cone_base(trellis: RunResult, soft: RunResult, hard: RunResult, tight: RunResult, fabric: str, **_: Any) -> Found:
    """Radius of the cone's base at 45 degrees over that along the yarns, when it has spread to half the panel."""
    found: Found = {}
    for name, run in (("low", soft), ("high", hard)):
        for taken in run["snapshots"]:
            ratio, axis = base_ratio(taken)
            if axis > 50e-3:
                break
        found[name] = ratio
        found.setdefault("note", "")
        found["note"] += f"{name}: {ratio:.2f} at {1e6 * taken['t']:.0f} us, {1e3 * axis:.0f} mm along the yarns; "
    return found


def base_ratio(taken: dict[str, Any], share: float = 0.05) -> tuple[float, float]:
    from scipy.interpolate import RegularGridInterpolator

    z = RegularGridInterpolator((taken["x"], taken["y"]), taken["z"], bounds_error=False, fill_value=0.0)
    top, reach = float(taken["z"].max()), np.linspace(0, min(taken["x"][-1], taken["y"][-1]), 800)
    radius = []
    for angle in (0.0, 0.25 * np.pi, 0.5 * np.pi):
        heights = z(np.stack([reach * np.cos(angle), reach * np.sin(angle)], axis=1))
        radius.append(reach[np.flatnonzero(heights > share * top)[-1]])
    axis = 0.5 * (radius[0] + radius[2])
    return radius[1] / axis, axis
