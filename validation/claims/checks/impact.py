"""Impacts on one ply (thesis chapters 2, 4, 5 and 6) with nothing fitted to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from validation.claims.checks import series
from validation.claims.checks.geometry import KEVLAR, ranked
from validation.claims.checks.waves import shot as bare_shot
from validation.claims.checks.waves import six
from validation.claims.registry import Found, Run, RunResult, check

PERFORATED, STOPPED = "perforates", "stops"


def shot(fabric: str, velocity: float = 100.0, **changes: Any) -> Run:
    """Run of a shot; those at 100 m/s are shared by most checks."""
    return bare_shot(fabric, velocity, snapshots=25e-6, **changes)


def outcome_of(run: RunResult) -> str:
    """ "stops" or "perforates", as the thesis says it."""
    return {"stopped": STOPPED, "perforated": PERFORATED}.get(run["outcome"], run["outcome"])


@check(lambda fabric, velocity: {"run": bare_shot(fabric, velocity)})
def outcome(run: RunResult, fabric: str, velocity: float) -> Found:
    """Outcome at a velocity."""
    found = {"outcome": outcome_of(run), "residual velocity": run["residual"]}
    share = run["peak"] / run["strength"]
    found["note"] = (
        f"{outcome_of(run)} at {velocity:g} m/s, {run['residual']:.1f} m/s left"
        if outcome_of(run) == PERFORATED
        else f"stops after {1e6 * run['t'][-1]:.0f} us and {1e3 * run['z'][-1]:.1f} mm, yarns at "
        f"{share[0]:.2f} and {share[1]:.2f} of their strength"
    )
    return found


def _curve(fabric, velocities):
    return {"curve": Run.of("shots", fabric=fabric, velocities=velocities), "found": Run.of("limit", fabric=fabric)}


@check(_curve)
def residual_curve(curve: RunResult, found: RunResult, fabric: str, velocities: Sequence[float]) -> Found:
    Vs, Vr, below = curve["strike"], np.maximum(curve["residual"], 0), curve["stopped"]
    absorbed = 1 - (Vr / Vs) ** 2
    above = ~below
    return {
        "residual below the limit": Vr[below].max(initial=0.0),
        "absorbed below the limit": absorbed[below].min(),
        "least growth above": np.diff(Vr[above]).min(),
        "residual over strike, fastest": Vr[-1] / Vs[-1],
        "note": f"limit {found['velocity']:.1f} m/s",
    }


@check(six)
def all_stop(**runs: RunResult) -> Found:
    return {"stops": [name for name in KEVLAR if runs[name.replace("-", "")]["outcome"] == "stopped"]}


@check(six)
def back_face(**runs: RunResult) -> Found:
    z = {name: runs[name.replace("-", "")]["z"][-1] for name in KEVLAR}
    order = ranked(z)
    return {
        "largest": order[0],
        "smallest": order[-1],
        "S-728 over the smallest": z["S-728"] / z[order[-1]],
        "note": ", ".join(f"{name} {1e3 * z[name]:.1f} mm" for name in order),
    }


@check(six)
def velocity_order(**runs: RunResult) -> Found:
    """Which fabric has taken most and least from the projectile at equal displacements, and the velocities' order.

    At all displacements from half of the least back face on, to it; and the order of the six velocities after 150 us.
    """
    stop = min(run["z"][-1] for run in runs.values())
    z, left, late = np.linspace(0.5 * stop, stop, 50), {}, {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        left[name] = np.interp(z, run["z"], run["v"])
        late[name] = float(series.velocity(run, 150e-6))
    by = [sorted(KEVLAR, key=lambda name, k=k: left[name][k]) for k in range(len(z))]  # type: ignore[misc]
    return {
        "takes most": by[-1][0],
        "takes least, at all displacements": by[0][-1] if len({order[-1] for order in by}) == 1 else "changes",
        "fastest after 150 us": max(late, key=late.get),
        "note": "after 150 us "
        + ", ".join(f"{n} {late[n]:.1f}" for n in ranked(late))
        + f" m/s; {by[0][-1]} takes least after {1e3 * z[0]:.1f} mm, {by[-1][-1]} after {1e3 * z[-1]:.1f} mm",
    }


@check(six)
def kinetic_share(**runs: RunResult) -> Found:
    means, later = {}, {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        share, some = series.ratio(run)
        means[name] = series.over_displacement(run, share, some)
        second = some & (run["z"] > 0.5 * run["z"][-1])
        later[name] = share[second]
    high = min(means[name] for name in ("S-745", "S-731"))
    rest = max(value for name, value in means.items() if name not in ("S-745", "S-731"))
    low = np.concatenate([later[name] for name in ("S-720", "S-728")])
    return {
        "least of S-745, S-731 over most of the rest": high / rest,
        "low crimp, later, mean": low.mean(),
        "low crimp, later, least": low.min(),
        "low crimp, later, most": low.max(),
        "note": ", ".join(f"{name} {means[name]:.2f}" for name in ranked(means)),
    }


@check(lambda fabric, velocity: {"run": bare_shot(fabric, velocity)})
def first_to_fail(run: RunResult, fabric: str, velocity: float) -> Found:
    warp, weft = run["first_failure"]
    order = ["weft", "warp"] if np.nan_to_num(weft, nan=np.inf) < np.nan_to_num(warp, nan=np.inf) else ["warp", "weft"]
    return {"order": order, "note": f"warp after {1e6 * warp:.0f} us, weft after {1e6 * weft:.0f} us"}


def limits(**_: Any) -> dict[str, Run]:
    return {name.replace("-", ""): Run.of("limit", fabric=name) for name in KEVLAR}


@check(lambda fabric, brackets=None: {"found": Run.of("limit", fabric=fabric)})
def limit_of(found: RunResult, fabric: str) -> Found:
    return {"velocity": found["velocity"]}


@check(limits)
def limit_brackets(brackets: dict[str, Any], **runs: RunResult) -> Found:
    inside, lines = [], []
    for name, (low, high) in brackets.items():
        V = runs[name.replace("-", "")]["velocity"]
        inside.append(min(V - low, high - V))
        lines.append(f"{name} {V:.1f}")
    return {"least distance inside": min(inside), "note": ", ".join(lines)}


@check(
    lambda fabric, guess: {"one": Run.of("limit", fabric=fabric), "other": Run.of("limit", fabric=fabric, guess=guess)}
)
def repeatable(one: RunResult, other: RunResult, fabric: str, guess: float) -> Found:
    return {
        "difference": abs(one["velocity"] - other["velocity"]),
        "one limit": bool(one["single"] and other["single"]),
    }


@check(six)
def margins(**runs: RunResult) -> Found:
    share = {name: runs[name.replace("-", "")]["peak"] / runs[name.replace("-", "")]["strength"] for name in KEVLAR}
    return {
        "S-731 weft": share["S-731"][1],
        "S-745": share["S-745"].max(),
        "note": ", ".join(f"{n} {s[0]:.2f}/{s[1]:.2f}" for n, s in share.items()),
    }


BESIDE = 10e-3  # [m] from the middle: elements that surround the projectile


@check(six)
def both_families(**runs: RunResult) -> Found:
    """Tensions of the two yarns through the impact point beside the projectile, when one of them is closest to failing.

    Each over its strength; the largest within BESIDE of the middle.
    """
    uneven = {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        shares = []
        for family in ("warp", "weft"):
            yarn = run["yarns"][family]
            shares.append(yarn["tension"][:, np.asarray(yarn["X"]) < BESIDE].max(axis=1) / yarn["strength"])
        warp, weft = np.array(shares)[:, np.argmax(np.maximum(*shares))]
        uneven[name] = abs(np.log(warp / weft))
    return {
        "balanced over unbalanced": max(uneven["S-720"], uneven["S-728"]) / min(uneven["S-726"], uneven["S-731"]),
        "note": "|ln of warp over weft|: " + ", ".join(f"{n} {u:.2f}" for n, u in uneven.items()),
    }


@check(
    lambda fabric, velocities: {f"v{v:g}".replace(".", "_"): bare_shot(fabric, v, interval=0.2e-6) for v in velocities}
)
def failure_by_speed(fabric: str, velocities: Sequence[float], **runs: RunResult) -> Found:
    times = [np.nanmin(runs[f"v{v:g}".replace(".", "_")]["first_failure"]) for v in velocities]
    drops = np.diff(times)
    jump = int(np.argmin(drops))
    return {
        "greatest growth": drops.max(),
        "fastest": times[-1],
        "largest drop over the whole fall": drops[jump] / (times[-1] - times[0]),
        "after the jump": times[jump + 1],
        "before the jump": times[jump],
        "note": ", ".join(f"{v:g} m/s {1e6 * t:.1f} us" for v, t in zip(velocities, times)),
    }


@check(
    lambda fabric: {
        "quarter": bare_shot(fabric, end_time=150e-6),
        "whole": bare_shot(fabric, end_time=150e-6, symmetry="whole"),
    }
)
def quarter(quarter: RunResult, whole: RunResult, fabric: str) -> Found:
    n = min(len(quarter["fine"]), len(whole["fine"]))
    return {
        "velocity": np.abs(quarter["fine"][:n, 2] - whole["fine"][:n, 2]).max() / 100.0,
        "peak tension": np.abs(quarter["peak"] / whole["peak"] - 1).max(),
    }


@check(lambda fabric, velocity: {"run": bare_shot(fabric, velocity)})
def erosion(run: RunResult, fabric: str, velocity: float) -> Found:
    return {"eroded elements": run["eroded"] > 0, "note": f"{run['eroded']} elements of the quarter"}


@check(lambda fabric, velocity: {"run": bare_shot(fabric, velocity)})
def failed_yarns(run: RunResult, fabric: str, velocity: float) -> Found:
    """After a perforation: what a yarn that failed still carries, and the balance of energy with all masses left."""
    T = run["yarns"]["weft"]["tension"]
    return {
        "tension of the struck weft at the middle, end": float(np.abs(T[-1, 0])),
        "failed": run["failed"][-1] > 0,
        "energy balance": run["balance"],
    }
