"""What the histories of a shot show: zones, tensions, edge reactions, the cone (thesis sections 5.2.1, 6.2)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics import catalogue
from validation.claims.checks import series
from validation.claims.checks.impact import shot
from validation.claims.registry import Found, RunResult, check


@check(lambda fabric, t: {"run": shot(fabric)})
def extents(run: RunResult, fabric: str, t: float) -> Found:
    taken = series.snapshot(run, t)
    warp, weft = taken["pyramid"]
    return {
        "weft over warp": weft / warp,
        "off one": abs(weft / warp - 1),
        "note": f"{1e3 * warp:.0f} mm along the warp, {1e3 * weft:.0f} mm along the weft at {1e6 * taken['t']:.0f} us",
    }


@check(lambda fabric: {"run": shot(fabric)})
def reactions(run: RunResult, fabric: str) -> Found:
    peaks, starts = [], []
    for family in ("warp", "weft"):
        t, N = series.even(*series.reaction(run, family), 1e-6)
        peaks.append(series.smooth(t, N).max())
        starts.append(series.onset(run, family))
    larger, sooner = (
        ["weft", "warp"] if flag else ["warp", "weft"] for flag in (peaks[1] > peaks[0], starts[1] < starts[0])
    )
    return {
        "difference of the peaks": abs(peaks[0] / peaks[1] - 1),
        "larger": larger,
        "earlier": sooner,
        "note": f"peaks {peaks[0]:.0f} (warp) and {peaks[1]:.0f} N (weft)",
    }


@check(lambda fabric: {"run": shot(fabric)})
def two_zones(run: RunResult, fabric: str) -> Found:
    kink, before, after = series.zones(run)
    edge = [series.onset(run, family) for family in ("warp", "weft")]
    return {
        "transition": kink,
        "slope after over before": after / before,
        "transition less last arrival": kink - max(edge),
        "transition less mean arrival": kink - np.mean(edge),
        "note": f"{-1e-6 * before:.3f} and {-1e-6 * after:.3f} m/s per us; edges reached after "
        f"{1e6 * edge[0]:.0f} (warp) and {1e6 * edge[1]:.0f} us (weft)",
    }


@check(lambda fabric: {"run": shot(fabric)})
def kinetic_first(run: RunResult, fabric: str) -> Found:
    share, some = series.ratio(run)
    early = share[some & (run["t"] < 30e-6)]
    late = share[some & (run["t"] > 100e-6)]
    return {
        "least before 30 us": early.min(),
        "most after 100 us": late.max(),
        "late over early, means": late.mean() / early.mean(),
    }


@check(lambda fabric: {"run": shot(fabric)})
def tension_steps(run: RunResult, fabric: str) -> Found:
    """Tension of the weft beside the projectile: its slopes in zone I and in zone II to 100 us."""
    t, T = run["clock"], run["yarns"]["weft"]["tension"]
    beside = (run["yarns"]["weft"]["X"] > 5e-3) & (run["yarns"]["weft"]["X"] < 15e-3)
    T = T[:, beside].mean(axis=1)
    slopes = [
        np.polyfit(t[(t > a) & (t < b)], T[(t > a) & (t < b)], 1)[0] for a, b in ((15e-6, 55e-6), (60e-6, 100e-6))
    ]
    return {
        "plateau over ramp": slopes[0] / slopes[1],
        "note": f"{1e-6 * slopes[0]:.2f} and {1e-6 * slopes[1]:.2f} N/us; "
        f"{np.interp(15e-6, t, T):.0f} N after 15 us, {np.interp(55e-6, t, T):.0f} N after 55 us",
    }


@check(lambda fabric: {"run": shot(fabric)})
def weft_edge_peak(run: RunResult, fabric: str) -> Found:
    t, N = series.even(*series.reaction(run, "weft"), 1e-6)
    N = series.smooth(t, N)
    peak = t[int(np.argmax(N))]
    return {"time": peak, "end over peak": N[-1] / N.max(), "note": f"{N.max():.0f} N"}


OFFSETS = tuple((1e-3 * np.arange(3, 100, 3)).round(6))


def high_zone(
    run: RunResult, window: Sequence[float], levels: tuple[float, ...] = (0.1,)
) -> tuple[float, float, float, float, dict[float, float]]:
    """(width [m] at the first level, middle over plateau, middle and plateau [N], widths by level) of weft reactions.

    A mean over a window [s] of time; the zone ends where `level` of what the middle has more than the plateau is left.
    """
    t, N, offset = run["clock"], run["edge_tension"], run["edge_offset"]
    profile = N[:, (t > window[0]) & (t < window[1])].mean(axis=1)
    outer, width = profile[(offset > 50e-3) & (offset < 85e-3)].mean(), {}
    for level in levels:
        below = np.flatnonzero(profile < outer + level * (profile[0] - outer))
        width[level] = 2 * float(offset[below[0]]) if below.size else np.nan
    return width[levels[0]], profile[0] / outer, profile[0], outer, width


@check(lambda fabric, window: {"run": shot(fabric, offsets=list(OFFSETS))})
def reaction_profile(run: RunResult, fabric: str, window: Sequence[float]) -> Found:
    """Tension of the weft yarns at the edge over their distance from the middle (`high_zone`, at a tenth)."""
    early = 0.4 * window[0], 0.6 * window[0]
    wide, share, middle, outer, width = high_zone(run, window, (0.1, 0.25, 0.5))
    return {
        "centre over plateau": share,
        "width of the high zone": wide,
        "builds up": bool(middle > high_zone(run, early)[2]),
        "note": f"{middle:.0f} N in the middle, {outer:.0f} N beyond 50 mm; "
        + ", ".join(f"{1e3 * w:.0f} mm wide at {100 * level:.0f} %" for level, w in width.items())
        + " of the excess",
    }


def _bent(fabric, velocity, share):
    """Shots without and with a bending stiffness: a share of EA over the square of half a cell's length."""
    weave = catalogue.load(fabric).with_effective_density().weave
    stiffness = share * weave.warp.EA * weave.w1**2
    return {"slack": shot(fabric, velocity), "bent": shot(fabric, velocity, bending=stiffness)}


@check(_bent)
def bending(slack: RunResult, bent: RunResult, fabric: str, velocity: float, share: float) -> Found:
    """RMS above 30 kHz of the reactions before the yarns are taut."""
    found = []
    for run in (slack, bent):
        both = []
        for family in ("warp", "weft"):
            t, N = series.even(*series.reaction(run, family), 1e-6)
            both.append(series.noise(t[t < 150e-6], N[t < 150e-6]))
        found.append(np.hypot(*both))  # type: ignore[call-overload]
    return {
        "noise, with over without": found[1] / found[0],
        "note": f"{found[0]:.3f} N without and {found[1]:.3f} N with bending, of the reactions to 150 us",
    }
