"""What 20 % more or less of modulus, crimp and areal density do, and slip at the edges (thesis chapter 6).

Areal density changes mass alone; the stiffness of the yarns is kept (section 6.3.3).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics import catalogue, variants
from shellfabric.cell.model import CellModel
from validation.claims.checks import series
from validation.claims.checks.by_hand import departure
from validation.claims.checks.impact import shot
from validation.claims.registry import Found, Run, RunResult, check

FACTORS = (0.8, 1.0, 1.2)
NAMES = {"modulus": "modulus", "crimp": "crimp", "mass": "areal density"}
ZONE_I = 60e-6
FINE = 0.25  # [m/s] of critical velocities that are compared


def three(fabric: str, parameter: str, velocity: float = 100.0) -> dict[str, Run]:
    """Runs at -20 %, as it is, +20 %."""
    return {
        name: shot(fabric, velocity, **({} if f == 1 else {parameter: f}))
        for name, f in zip(("less", "same", "more"), FACTORS)
    }


def all_three(fabric: str, **_: Any) -> dict[str, Run]:
    """Runs of all three parameters."""
    found: Found = {}
    for parameter in NAMES:
        found |= {f"{parameter}_{name}": run for name, run in three(fabric, parameter).items()}
    return found


def limits(fabric: str, parameter: str) -> dict[str, Run]:
    return {
        name: Run.of("limit", fabric=fabric, tolerance=FINE, **({} if f == 1 else {parameter: f}))
        for name, f in zip(("low", "mid", "high"), FACTORS)
    }


@check()
def cell(fabric: str, parameter: str, strain: float) -> Found:
    """Warp tension of the cell at a warp strain with held weft; the thesis's equations, nominal yarns."""
    T, off = [], []
    for factor in FACTORS:
        given = catalogue.load(fabric)
        field = {"modulus": "E", "crimp": "crimp"}[parameter]
        changed = variants.scale_yarns(given, **{field: factor})
        model = CellModel(changed, form="equilibrium")
        T.append(float(model.solve(1 + strain, 1.0)["T1"]))
        off.append(departure(model, 1 + np.linspace(0, strain, 41), 1.0))
    return {
        "off the equations": max(off),
        "less": T[0],
        "same": T[1],
        "more": T[2],
        "change of less": T[0] / T[1] - 1,
        "change of more": T[2] / T[1] - 1,
        "rises": T[0] < T[1] < T[2],
        "falls": T[0] > T[1] > T[2],
    }


def _curves(less, same, more, start=ZONE_I):
    end = min(run["fine"][-1, 0] for run in (less, same, more))
    t = np.linspace(start, end, 200)
    return t, [series.velocity(run, t) for run in (less, same, more)]


def _strain_falls(*runs):
    """[-] share of the time after zone I in which the strain of the weft falls from each of the runs to the next.

    Of strains without what is faster than `series.QUIET`.
    """
    n = min(len(run["clock"]) for run in runs)
    strains = np.array([series.smooth(run["clock"][:n], series.strain(run, "weft")[:n]) for run in runs])
    later = runs[0]["clock"][:n] > ZONE_I
    return float(np.mean((np.diff(strains, axis=0) < 0).all(axis=0)[later]))


@check(lambda fabric, parameter: three(fabric, parameter))
def impact(less: RunResult, same: RunResult, more: RunResult, fabric: str, parameter: str) -> Found:
    """Velocities after zone I; peak strain of the weft through the impact point; back face."""
    _t, (a, b, c) = _curves(less, same, more)
    v = [float(series.velocity(run, 200e-6)) for run in (less, same, more)]
    strain = [series.strain(run, "weft").max() for run in (less, same, more)]
    z = [run["z"][-1] for run in (less, same, more)]
    return {
        "largest change after 200 us": max(abs(v[0] - v[1]), abs(v[2] - v[1])),
        "velocity falls": bool((a > b).all() and (b > c).all()),
        "velocity rises": bool((a < b).all() and (b < c).all()),
        "share of time falling": float(np.mean((a > b) & (b > c))),
        "peak strain falls": strain[0] > strain[1] > strain[2],
        "share of time strain falls": _strain_falls(less, same, more),
        "back face rises": z[0] < z[1] < z[2],
        "note": f"after 200 us {v[0]:.1f}, {v[1]:.1f}, {v[2]:.1f} m/s; peak strain of the weft "
        + ", ".join(f"{100 * e:.2f}" for e in strain)
        + " %; back face "
        + ", ".join(f"{1e3 * d:.1f}" for d in z)
        + " mm",
    }


@check(lambda fabric, parameter: three(fabric, parameter))
def strain_before_peak(less: RunResult, same: RunResult, more: RunResult, fabric: str, parameter: str) -> Found:
    runs = (less, same, more)
    clock = same["clock"]
    peak = series.strain(same, "weft").max()
    top = clock[int(np.argmax(series.strain(same, "weft")))]
    t = np.linspace(0, 0.9 * top, 300)
    e = [np.interp(t, run["clock"], series.strain(run, "weft")) for run in runs]
    spread = np.max(e, axis=0) - np.min(e, axis=0)
    return {
        "largest difference over peak": float(spread.max() / peak),
        "note": f"mean {100 * spread.mean() / peak:.0f} % of the peak, before {1e6 * top:.0f} us",
    }


@check(
    lambda fabric, velocities, **_: {
        f"{name}{v:g}": shot(fabric, v, **({} if f == 1 else {"modulus": f}))
        for v in velocities
        for name, f in (("less", 0.8), ("same", 1.0))
    }
)
def failure_times(fabric: str, velocities: Sequence[float], **runs: RunResult) -> Found:
    sooner, note = [], []
    for v in velocities:
        t = [float(np.nanmin(runs[f"{name}{v:g}"]["first_failure"])) for name in ("less", "same")]
        sooner.append(t[0] < t[1])
        note.append(f"{v:g} m/s: {1e6 * t[0]:.1f} and {1e6 * t[1]:.1f} us")
    return {"sooner": all(sooner), "note": "; ".join(note)}


@check(limits)
def critical(low: RunResult, mid: RunResult, high: RunResult, fabric: str, parameter: str) -> Found:
    V = [run["velocity"] for run in (low, mid, high)]
    return {
        "rises": V[0] < V[1] < V[2],
        "largest change": max(abs(V[0] / V[1] - 1), abs(V[2] / V[1] - 1)),
        "note": ", ".join(f"{v:.1f}" for v in V) + " m/s",
    }


@check(lambda fabric: limits(fabric, "crimp") | three(fabric, "crimp"))
def tradeoff(
    low: RunResult, mid: RunResult, high: RunResult, less: RunResult, same: RunResult, more: RunResult, fabric: str
) -> Found:
    V, z = [run["velocity"] for run in (low, mid, high)], [run["z"][-1] for run in (less, same, more)]
    return {
        "critical velocity rises": V[0] < V[1] < V[2],
        "back face rises": z[0] < z[1] < z[2],
        "note": ", ".join(f"{v:.1f}" for v in V) + " m/s; " + ", ".join(f"{1e3 * d:.1f}" for d in z) + " mm",
    }


def _effects(runs, t):
    """|velocity at +20 % less that at -20 %| of each parameter at an instant."""
    return {
        name: abs(float(series.velocity(runs[f"{p}_more"], t) - series.velocity(runs[f"{p}_less"], t)))
        for p, name in NAMES.items()
    }


@check(all_three)
def zone_one(fabric: str, **runs: RunResult) -> Found:
    effect = _effects(runs, ZONE_I)
    others = max(value for name, value in effect.items() if name != "areal density")
    return {
        "areal density over the next": effect["areal density"] / others,
        "order": sorted(effect, key=lambda name: -effect[name]),
        "note": ", ".join(f"{n} {e:.2f} m/s" for n, e in effect.items()),
    }


@check(all_three)
def zone_two(fabric: str, t: float, **runs: RunResult) -> Found:
    effect = _effects(runs, t)
    return {
        "largest over least": max(effect.values()) / min(effect.values()),
        "note": ", ".join(f"{n} {e:.2f} m/s" for n, e in effect.items()),
    }


@check(all_three)
def absorbed(fabric: str, t: float, **runs: RunResult) -> Found:
    """Change of what the panel has taken from the projectile, from -20 to +20 %, as a mean over the time to `t`."""
    clock = np.linspace(0, t, 200)
    change = {}
    for p, name in NAMES.items():
        more, less = (series.velocity(runs[f"{p}_{which}"], clock) ** 2 for which in ("more", "less"))
        change[name] = float(np.mean(np.abs(more - less)) / 100.0**2)
    return {
        "largest over least": max(change.values()) / min(change.values()),
        "note": ", ".join(f"{n} {100 * c:.1f} % of the strike energy" for n, c in change.items()),
    }


def all_limits(fabric: str) -> dict[str, Run]:
    """Runs of the critical velocity with each parameter 20 % less and more."""
    return {f"{p}_{name}": run for p in NAMES for name, run in limits(fabric, p).items()}


@check(all_limits)
def critical_energy(fabric: str, **runs: RunResult) -> Found:
    """Change of the critical strike energy, from -20 to +20 % of each parameter, over that of the fabric as it is."""
    change = {}
    for p, name in NAMES.items():
        low, mid, high = (runs[f"{p}_{which}"]["velocity"] ** 2 for which in ("low", "mid", "high"))
        change[name] = abs(high - low) / mid
    return {
        "largest over least": max(change.values()) / max(min(change.values()), 1e-12),
        "note": ", ".join(f"{n} {100 * c:.1f} % of the critical energy" for n, c in change.items()),
    }


def _pair(fabric, **_):
    crimps = [yarn.crimp for yarn in catalogue.load(fabric).weave.yarns]
    even = {"crimps": [round(sum(crimps) / 2, 6)] * 2}
    return {
        "as_woven": Run.of("limit", fabric=fabric),
        "balanced": Run.of("limit", fabric=fabric, **even),
        "woven_shot": shot(fabric),
        "balanced_shot": shot(fabric, **even),
    }


@check(_pair)
def imbalance(
    as_woven: RunResult, balanced: RunResult, woven_shot: RunResult, balanced_shot: RunResult, fabric: str
) -> Found:
    z = [run["z"][-1] for run in (balanced_shot, woven_shot)]
    t = np.linspace(ZONE_I, min(run["fine"][-1, 0] for run in (balanced_shot, woven_shot)), 200)
    lead = series.velocity(woven_shot, t) - series.velocity(balanced_shot, t)
    return {
        "back face, balanced over as woven": z[0] / z[1],
        "mean lead of velocity, as woven": lead.mean(),
        "note": f"{fabric} with its crimp shared out evenly: limit "
        f"{balanced['velocity']:.1f} against {as_woven['velocity']:.1f} m/s, back face {1e3 * z[0]:.1f} against "
        f"{1e3 * z[1]:.1f} mm at 100 m/s",
    }


@check(
    lambda fabric, modulus, strain: {
        "virgin": shot(fabric),
        "woven": shot(fabric, modulus=modulus),
        "virgin_limit": Run.of("limit", fabric=fabric),
        "woven_limit": Run.of("limit", fabric=fabric, modulus=modulus, strain=strain),
    }
)
def damaged(
    virgin: RunResult, woven: RunResult, virgin_limit: RunResult, woven_limit: RunResult, fabric: str, modulus: float,
    strain: float,
) -> Found:  # fmt: skip
    """Modulus, and with it the strength at a given failure strain, lowered by weaving."""
    t = np.linspace(ZONE_I, min(virgin["fine"][-1, 0], woven["fine"][-1, 0]), 200)
    lead = series.velocity(woven, t) - series.velocity(virgin, t)
    return {
        "least lead of velocity": lead.min(),
        "limit falls": woven_limit["velocity"] < virgin_limit["velocity"],
        "note": f"limit {virgin_limit['velocity']:.1f} to {woven_limit['velocity']:.1f} m/s",
    }


def pulled(
    fabric: str, lengths: list[float], start: float, end: float, velocity: float = 100.0, **_: Any
) -> dict[str, Run]:
    runs = {
        f"mm{1e3 * length:g}".replace(".", "_"): shot(
            fabric, velocity, pull={"length": length, "start": start, "end": end}
        )
        for length in lengths
    }
    return {"held": shot(fabric, velocity)} | runs


@check(pulled)
def slip(held: RunResult, fabric: str, lengths: Sequence[float], start: float, end: float, **runs: RunResult) -> Found:
    """Velocities with the weft edges held and drawn in by ever more."""
    own = [held, *(runs[f"mm{1e3 * length:g}".replace(".", "_")] for length in lengths)]
    last = min(run["fine"][-1, 0] for run in own)
    late, early = np.linspace(200e-6, last, 50), np.linspace(0, ZONE_I, 100)
    v = [series.velocity(run, late) for run in own]
    apart = max(np.abs(series.velocity(run, early) - series.velocity(held, early)).max() for run in own[1:])
    return {
        "least lead, late": min(float((b - a).min()) for a, b in itertools.pairwise(v)),
        "largest change in zone I": apart,
        "note": "after 200 us " + ", ".join(f"{w[0]:.1f}" for w in v) + " m/s",
    }


@check(
    lambda fabric, length, starts, span: (
        {"held": shot(fabric)}
        | {f"from{1e6 * s:.0f}": shot(fabric, pull={"length": length, "start": s, "end": s + span}) for s in starts}
    )
)
def slip_onset(
    held: RunResult, fabric: str, length: float, starts: Sequence[float], span: float, **runs: RunResult
) -> Found:
    """When the velocity leaves that of the held panel by half a metre a second, after the beginning of the slip."""
    delays = []
    for s in starts:
        run = runs[f"from{1e6 * s:.0f}"]
        t = np.linspace(0, min(run["fine"][-1, 0], held["fine"][-1, 0]), 2000)
        apart = np.abs(series.velocity(run, t) - series.velocity(held, t)) > 0.5
        delays.append(float(t[np.argmax(apart)]) - s if apart.any() else np.nan)
    return {
        "largest delay": max(delays),
        "spread of the delays": float(np.ptp(delays)),
        "note": ", ".join(f"window from {1e6 * s:.0f} us: {1e6 * d:.0f} us later" for s, d in zip(starts, delays)),
    }


def _slow(fabric, velocity, length, start, end):
    return {
        "held": shot(fabric, velocity, end_time=1.5e-3),
        "slipping": shot(fabric, velocity, end_time=1.5e-3, pull={"length": length, "start": start, "end": end}),
    }


@check(_slow)
def slow_slip(
    held: RunResult, slipping: RunResult, fabric: str, velocity: float, length: float, start: float, end: float
) -> Found:
    last = min(held["fine"][-1, 0], slipping["fine"][-1, 0])
    t = np.linspace(start + 100e-6, last, 200)
    lead = series.velocity(slipping, t) - series.velocity(held, t)
    return {
        "mean lead of the slipping": lead.mean(),
        "note": f"from {1e6 * t[0]:.0f} us to the stop after {1e6 * last:.0f} us "
        f"{lead.min():+.2f} to {lead.max():+.2f} m/s; back face {1e3 * held['z'][-1]:.1f} and "
        f"{1e3 * slipping['z'][-1]:.1f} mm",
    }
