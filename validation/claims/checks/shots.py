"""What takes more than two lines to read off shots at one ply and at packs (thesis chapters 4, 5 and 6)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from fabrics.checks import FloatArray
from validation.claims.judge import Found
from validation.claims.readers import (
    FAMILIES,
    ZONE_I,
    end,
    front,
    noise,
    rising,
    smooth,
    strain,
    v,
    yarn,
)  # fmt: skip

NOSE = 3e-3  # [m] beyond the rounded edge of the projectile


def unevenness(run: Any, beside: float = 10e-3) -> float:
    """|ln| of warp over weft tension, each over its strength, of the yarns through the impact point when one of them is
    closest to failing; the largest within `beside` [m] of the middle."""
    shares = np.array([
        yarn(run, f).tension[:, yarn(run, f).X < beside].max(axis=1) / yarn(run, f).strength for f in FAMILIES
    ])  # fmt: skip
    warp, weft = shares[:, np.argmax(np.maximum(*shares))]
    return abs(np.log(warp / weft))


def zones(run: Any, stop: float = 200e-6) -> Found:
    """Instant of the kink of two straight lines through the velocity history, and their slopes."""
    t, best = np.linspace(0, min(stop, end(run)), 401), (np.inf, None, None)
    for kink in t[20:-20]:
        basis = np.stack([np.ones_like(t), np.minimum(t, kink), np.maximum(t - kink, 0)], axis=1)
        found, *_ = np.linalg.lstsq(basis, v(run, t), rcond=None)
        best = min(best, (float(np.sum((basis @ found - v(run, t)) ** 2)), kink, found), key=lambda one: one[0])
    return {"kink": best[1], "before": best[2][1], "after": best[2][2]}  # type: ignore[index]


def high_zone(run: Any, start: float, stop: float, level: float = 0.1) -> Found:
    """Weft reactions across the edge, as means over a window [s]: of the middle and of the plateau [N], and the width
    [m] of the zone, which ends where `level` of what the middle has more than the plateau is left."""
    clock, wefts = run.histories[0].t, (yarn for yarn in run.histories[0].yarns if yarn.family == "weft")
    ends = {abs(yarn.offset): yarn.tension[(clock > start) & (clock < stop), -1].mean() for yarn in wefts}
    offset = np.array(sorted(ends))
    profile = np.array([ends[place] for place in offset])
    plateau = profile[(offset > 50e-3) & (offset < 85e-3)].mean()
    below = np.flatnonzero(profile < plateau + level * (profile[0] - plateau))
    return {"middle": profile[0], "plateau": plateau, "width": 2 * float(offset[below[0]]) if below.size else np.nan}


def noise_over_net(shell: Any, cables: Any) -> float:
    """Noise of the reaction of the warp: shell over cable net, as means over a microsecond, as the shell's are."""
    t, clock = np.arange(0, min(shell.t[-1], end(cables)), 1e-6), cables.step_history[:, 0]
    width = max(1, round(1e-6 / (clock[1] - clock[0])))
    of_cables = np.interp(t, clock, np.convolve(cables.reactions["warp"], np.ones(width) / width, "same"))
    return noise(t, np.interp(t, shell.t, shell.reactions["warp"])) / noise(t, of_cables)


def cone_base(run: Any, reach: float = 50e-3, share: float = 0.05) -> float:
    """Radius of the cone's base at 45 degrees over that along the yarns, when it has spread to `reach` [m]."""
    X, Y = run.panel.coordinates()
    r = np.linspace(0, min(X[-1, 0], Y[0, -1]), 800)
    for height in (shots[0].nodes[..., 2].astype(np.float32) for shots in run.snapshots):
        z, radius = RegularGridInterpolator((X[:, 0], Y[0]), height, bounds_error=False, fill_value=0.0), []
        for angle in (0.0, 0.25 * np.pi, 0.5 * np.pi):
            heights = z(np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1))
            radius.append(r[np.flatnonzero(heights > share * float(height.max()))[-1]])
        axis = 0.5 * (radius[0] + radius[2])
        if axis > reach:
            break
    return radius[1] / axis


def straight_side(run: Any, velocity: float) -> float:
    """R2 of the line through the side of the cone of a lone yarn."""
    inside = run.nodes[:, 0] < 0.9 * run.U * run.nodes[0, 1] / velocity
    return np.corrcoef(*run.nodes[inside].T)[0, 1] ** 2


def cone_sides(run: Any, times: Sequence[float]) -> Found:
    """Sides of the cone of a shell's yarn: straightness at times [s], and what the slope loses from first to last."""
    warp, slopes, R2 = yarn(run, "warp"), [], []
    for t in times:
        k = int(np.argmin(np.abs(run.histories[0].t - t)))
        x, z = warp.place[k], warp.deflection[k]
        side = (x > NOSE) & (z > 0.1 * z.max())
        slopes.append(-np.polyfit(x[side], z[side], 1)[0])
        R2.append(np.corrcoef(x[side], z[side])[0, 1] ** 2)
    return {"R2": min(R2), "fall of the slope": 1 - slopes[-1] / slopes[0]}


def cone_slope(run: Any, t: float) -> float:
    """Of the side of the cone along the warp at an instant, from 30 to 80 % of its height."""
    k = int(np.argmin(np.abs(run.histories[0].t - t)))
    x, z = yarn(run, "warp").place[k], yarn(run, "warp").deflection[k]
    part = (z > 0.3 * z.max()) & (z < 0.8 * z.max())
    return -np.polyfit(x[part], z[part], 1)[0]


def front_width(run: Any, place: float) -> float:
    """[m] over which the tension of the weft at a place rises from a tenth to half of the plateau behind the front."""
    weft, clock = yarn(run, "weft"), run.histories[0].t
    T = weft.tension[:, int(np.argmin(np.abs(weft.X - place)))]
    start = np.argmax(T > 0.01 * weft.strength)
    plateau, part = T[start : start + 40].max(), slice(max(start - 5, 0), start + 40)  # within 20 us
    rise = np.maximum.accumulate(T[part])
    times = [clock[part][np.argmax(rise >= share * plateau)] for share in (0.1, 0.5)]
    return (times[1] - times[0]) * front(run, "weft", "longitudinal")


def share_of_time_falling(*runs: Any) -> float:
    """[-] of the time after zone I in which the strain of the weft, without noise, falls from each run to the next."""
    n, clock = min(len(run.histories[0].t) for run in runs), runs[0].histories[0].t
    strains = [smooth(run.histories[0].t[:n], strain(run, "weft")[:n]) for run in runs]
    return float(np.mean(rising(*strains[::-1])[clock[:n] > ZONE_I]))


def spread_before_peak(less: Any, same: Any, more: Any) -> float:
    """Largest difference of the strains of the weft of three runs before the peak of the middle one, over the peak."""
    clock, strains = same.histories[0].t, strain(same, "weft")
    t = np.linspace(0, 0.9 * clock[int(np.argmax(strains))], 300)
    each = [np.interp(t, run.histories[0].t, strain(run, "weft")) for run in (less, same, more)]
    return float((np.max(each, axis=0) - np.min(each, axis=0)).max() / strains.max())


def slip_delay(run: Any, held: Any, start: float) -> float:
    """[s] from the start of a slip until the velocity has left that of the held panel by half a metre a second."""
    t = np.linspace(0, end(run, held), 2000)
    gone = np.abs(v(run, t) - v(held, t)) > 0.5
    return float(t[np.argmax(gone)]) - start if gone.any() else np.nan


def slip(run: Any) -> FloatArray:
    """[m] of each weft yarn out of its clamp at the end."""
    return run.panel.coordinates()[1][:, -1] - run.last[0].nodes[:, -1, 1]
