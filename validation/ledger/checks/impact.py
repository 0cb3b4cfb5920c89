"""Impacts on one ply (source thesis chapters 2, 4, 5 and 6) with nothing fitted to them."""

from __future__ import annotations

import numpy as np

from fabrics import catalogue
from validation.ledger.cache import Run
from validation.ledger.checks import check, series
from validation.ledger.checks.geometry import KEVLAR, ranked
from validation.ledger.checks.waves import _over_displacement, six
from validation.ledger.checks.waves import shot as _shot

MODELS = ("incompressible", "compressible", "decoupled")
PERFORATED, STOPPED = "perforates", "stops"


def shot(fabric, velocity=100.0, **changes):
    """Run of a shot; those at 100 m/s are shared by most checks."""
    return _shot(fabric, velocity, snapshots=25e-6, **changes)


def told(run):
    """ "stops" or "perforates", as the source says it."""
    return {"stopped": STOPPED, "perforated": PERFORATED}.get(run["outcome"], run["outcome"])


def _captions(fabric, velocity, margin=0.0):
    runs = {"run": _shot(fabric, velocity)}
    return runs | ({"faster": _shot(fabric, velocity + margin)} if margin else {})


@check(_captions)
def outcome(run, fabric, velocity, margin=0.0, faster=None):
    """Outcome at a velocity, and within a margin above it."""
    found = {"outcome": told(run), "residual velocity": run["residual"]}
    if faster is not None:
        found["outcome within the margin"] = PERFORATED if PERFORATED in (told(run), told(faster)) else told(faster)
    share = run["peak"] / run["strength"]
    found["note"] = (
        f"{told(run)} at {velocity:g} m/s, {run['residual']:.1f} m/s left"
        if told(run) == PERFORATED
        else f"stops after {1e6 * run['t'][-1]:.0f} us and {1e3 * run['z'][-1]:.1f} mm, yarns at "
        f"{share[0]:.2f} and {share[1]:.2f} of their strength"
    )
    return found


def _curve(fabric, velocities):
    return {"curve": Run.of("shots", fabric=fabric, velocities=velocities), "found": Run.of("limit", fabric=fabric)}


@check(_curve)
def residual_curve(curve, found, fabric, velocities):
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
def all_stop(**runs):
    return {"stops": [name for name in KEVLAR if runs[name.replace("-", "")]["outcome"] == "stopped"]}


@check(six)
def back_face(**runs):
    z = {name: runs[name.replace("-", "")]["z"][-1] for name in KEVLAR}
    order = ranked(z)
    return {
        "largest": order[0],
        "smallest": order[-1],
        "S-728 over the smallest": z["S-728"] / z[order[-1]],
        "note": ", ".join(f"{name} {1e3 * z[name]:.1f} mm" for name in order),
    }


@check(six)
def kinetic_share(**runs):
    means, later = {}, {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        share, some = series.ratio(run)
        means[name] = _over_displacement(run, share, some)
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


@check(lambda fabric, t: {"run": shot(fabric)})
def extents(run, fabric, t):
    taken = series.snapshot(run, t)
    warp, weft = taken["pyramid"]
    return {
        "weft over warp": weft / warp,
        "off one": abs(weft / warp - 1),
        "note": f"{1e3 * warp:.0f} mm along the warp, {1e3 * weft:.0f} mm along the weft at {1e6 * taken['t']:.0f} us",
    }


@check(lambda fabric: {"run": shot(fabric)})
def reactions(run, fabric):
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


@check(lambda fabric, velocity: {"run": _shot(fabric, velocity)})
def first_to_fail(run, fabric, velocity):
    warp, weft = run["first_failure"]
    order = ["weft", "warp"] if np.nan_to_num(weft, nan=np.inf) < np.nan_to_num(warp, nan=np.inf) else ["warp", "weft"]
    return {"order": order, "note": f"warp after {1e6 * warp:.0f} us, weft after {1e6 * weft:.0f} us"}


def limits(**_):
    return {name.replace("-", ""): Run.of("limit", fabric=name) for name in KEVLAR}


@check(lambda fabric, brackets=None: {"found": Run.of("limit", fabric=fabric)})
def limit_of(found, fabric):
    return {"velocity": found["velocity"]}


@check(limits)
def limit_brackets(brackets, **runs):
    inside, told_ = [], []
    for name, (low, high) in brackets.items():
        V = runs[name.replace("-", "")]["velocity"]
        inside.append(min(V - low, high - V))
        told_.append(f"{name} {V:.1f}")
    return {"least distance inside": min(inside), "note": ", ".join(told_)}


@check(
    lambda fabric, guess: {"one": Run.of("limit", fabric=fabric), "other": Run.of("limit", fabric=fabric, guess=guess)}
)
def repeatable(one, other, fabric, guess):
    return {
        "difference": abs(one["velocity"] - other["velocity"]),
        "one limit": bool(one["single"] and other["single"]),
    }


@check(six)
def margins(**runs):
    share = {name: runs[name.replace("-", "")]["peak"] / runs[name.replace("-", "")]["strength"] for name in KEVLAR}
    return {
        "S-731 weft": share["S-731"][1],
        "S-745": share["S-745"].max(),
        "note": ", ".join(f"{n} {s[0]:.2f}/{s[1]:.2f}" for n, s in share.items()),
    }


@check(six)
def both_families(**runs):
    uneven = {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        uneven[name] = abs(np.log(run["peak"][0] / run["peak"][1]))
    return {
        "balanced over unbalanced": max(uneven["S-720"], uneven["S-728"]) / min(uneven["S-726"], uneven["S-731"]),
        "note": "|ln of warp over weft|: " + ", ".join(f"{n} {u:.2f}" for n, u in uneven.items()),
    }


def _no_crimp(fabric):
    return {
        "shell": _shot(fabric, straight=True, cell_model="decoupled"),
        "cables": Run.of("net", fabric=fabric, velocity=100.0, straight=True),
    }


def _apart(one, other, start=0.0, end=250e-6):
    """[m/s] largest difference of velocity between two runs."""
    t = np.linspace(start, min(end, one["fine"][-1, 0], other["fine"][-1, 0]), 300)
    return float(np.abs(series.velocity(one, t) - series.velocity(other, t)).max())


@check(_no_crimp)
def cable_without_crimp(shell, cables, fabric):
    return {"largest difference": _apart(shell, cables)}


@check(_no_crimp)
def cable_noise(shell, cables, fabric):
    end = min(shell["t"][-1], cables["fine"][-1, 0])
    t = np.arange(0, end, 1e-6)
    of_shell = np.interp(t, shell["t"], shell["reactions"]["warp"])
    of_cables = np.interp(t, cables["fine"][:, 0], series_mean(cables, "warp"))
    noise = [series.noise(t, record) for record in (of_shell, of_cables)]
    return {"shell over cable": noise[0] / noise[1], "note": f"{noise[0]:.1f} and {noise[1]:.1f} N"}


def series_mean(cables, family):
    """The reaction of the net as means over a microsecond, as the shell's audit is spaced."""
    N, dt = cables["reactions"][family], cables["fine"][1, 0] - cables["fine"][0, 0]
    width = max(1, round(1e-6 / dt))
    return np.convolve(N, np.ones(width) / width, "same")


def _coupling(fabric):
    runs = {model: shot(fabric, cell_model=model) for model in MODELS if model != "compressible"}
    return runs | {"compressible": shot(fabric), "cables": Run.of("net", fabric=fabric, velocity=100.0)}


@check(_coupling)
def cable_with_crimp(incompressible, compressible, decoupled, cables, fabric):
    return {"largest difference": _apart(decoupled, cables)}


@check(_coupling)
def coupling(incompressible, compressible, decoupled, cables, fabric):
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


@check(lambda fabric: {"run": shot(fabric)})
def two_zones(run, fabric):
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
def kinetic_first(run, fabric):
    share, some = series.ratio(run)
    early = share[some & (run["t"] < 30e-6)]
    late = share[some & (run["t"] > 100e-6)]
    return {
        "least before 30 us": early.min(),
        "most after 100 us": late.max(),
        "late over early, means": late.mean() / early.mean(),
    }


@check(lambda fabric: {"run": shot(fabric)})
def tension_steps(run, fabric):
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
def weft_edge_peak(run, fabric):
    t, N = series.even(*series.reaction(run, "weft"), 1e-6)
    N = series.smooth(t, N)
    peak = t[int(np.argmax(N))]
    return {"time": peak, "end over peak": N[-1] / N.max(), "note": f"{N.max():.0f} N"}


@check(lambda fabric, velocities: {f"v{v:g}".replace(".", "_"): _shot(fabric, v, interval=0.2e-6) for v in velocities})
def failure_by_speed(fabric, velocities, **runs):
    times = [np.nanmin(runs[f"v{v:g}".replace(".", "_")]["first_failure"]) for v in velocities]
    drops = np.diff(times)
    return {
        "greatest growth": drops.max(),
        "fastest": times[-1],
        "note": ", ".join(f"{v:g} m/s {1e6 * t:.1f} us" for v, t in zip(velocities, times)),
    }


@check(_coupling)
def bounds(incompressible, compressible, decoupled, cables, fabric):
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


@check(
    lambda fabric: {
        "quarter": _shot(fabric, end_time=150e-6),
        "whole": _shot(fabric, end_time=150e-6, symmetry="whole"),
    }
)
def quarter(quarter, whole, fabric):
    n = min(len(quarter["fine"]), len(whole["fine"]))
    return {
        "velocity": np.abs(quarter["fine"][:n, 2] - whole["fine"][:n, 2]).max() / 100.0,
        "peak tension": np.abs(quarter["peak"] / whole["peak"] - 1).max(),
    }


OFFSETS = tuple((1e-3 * np.arange(3, 100, 3)).round(6))


@check(lambda fabric, window: {"run": shot(fabric, offsets=list(OFFSETS))})
def reaction_profile(run, fabric, window):
    """Tension of the weft yarns at the edge over their distance from the middle, as a mean over a window [s] of time.

    The high zone ends where a tenth of what the middle has more than the plateau is left.
    """
    t, N, offset = run["clock"], run["edge_tension"], run["edge_offset"]
    profile = N[:, (t > window[0]) & (t < window[1])].mean(axis=1)
    early = N[:, (t > 0.4 * window[0]) & (t < 0.6 * window[0])].mean(axis=1)
    outer = profile[(offset > 50e-3) & (offset < 85e-3)].mean()
    width = {}
    for level in (0.1, 0.25, 0.5):
        below = np.flatnonzero(profile < outer + level * (profile[0] - outer))
        width[level] = 2 * float(offset[below[0]]) if below.size else np.nan
    return {
        "centre over plateau": profile[0] / outer,
        "width of the high zone": width[0.1],
        "builds up": bool(profile[0] > early[0]),
        "note": f"{profile[0]:.0f} N in the middle, {outer:.0f} N beyond 50 mm; "
        + ", ".join(f"{1e3 * w:.0f} mm wide at {100 * level:.0f} %" for level, w in width.items())
        + " of the excess",
    }


@check(six)
def shear_share(**runs):
    shares = {}
    for name in KEVLAR:
        run = runs[name.replace("-", "")]
        shares[name] = float(run["energies"]["shear"][-1] / series.internal(run)[-1])
    return {"largest": max(shares.values()), "note": ", ".join(f"{n} {100 * s:.1f} %" for n, s in shares.items())}


@check(six)
def largest_shear(**runs):
    """Largest shear angle of any whole element until the stop, in units of gamma1."""
    over, told_ = {}, []
    for name in KEVLAR:
        law = catalogue.load(name).shear
        most = max(float(taken["gamma"][taken["whole"]].max()) for taken in runs[name.replace("-", "")]["snapshots"])
        over[name] = most / law.gamma1
        told_.append(f"{name} {most:.2f} rad, {over[name]:.2f} gamma1, {most / law.gamma2:.2f} gamma2")
    rest = {name: value for name, value in over.items() if name != "S-731"}
    return {
        "exceed gamma1": [n for n in KEVLAR if over[n] > 1],
        "most over gamma1, without S-731": max(rest.values()),
        "note": "; ".join(told_),
    }


def _sheared(fabric, G_soft, G_hard, gamma):
    return {
        "trellis": shot(fabric),
        "soft": shot(fabric, shear={"G1": G_soft, "G2": G_soft * 1.000001}),
        "hard": shot(fabric, shear={"G1": G_hard, "G2": G_hard * 1.000001}),
        "tight": shot(fabric, shear={"gamma1": gamma[0], "gamma2": gamma[1]}),
    }


@check(_sheared)
def shear_laws(trellis, soft, hard, tight, fabric, **_):
    t = np.linspace(0, 400e-6, 401)
    v = {
        name: series.velocity(run, t)
        for name, run in (("trellis", trellis), ("low shear", soft), ("high shear", hard), ("tight", tight))
    }
    k = int(np.argmin(np.abs(t - 150e-6)))
    drop = {name: 100.0 - w[k] for name, w in v.items()}
    return {
        "soft apart": np.abs(v["low shear"] - v["trellis"]).max(),
        "tight apart": np.abs(v["tight"] - v["trellis"]).max(),
        "order": ranked({n: d for n, d in drop.items() if n != "tight"}),
        "drop, high over trellis": drop["high shear"] / drop["trellis"],
        "note": "lost after 150 us: "
        + ", ".join(f"{n} {d:.1f} m/s" for n, d in drop.items())
        + f"; high shear {told(hard)}, {1e6 * hard['t'][-1]:.0f} us after the strike; lost after 70 us: "
        + ", ".join(f"{n} {100 - float(np.interp(70e-6, t, w)):.1f} m/s" for n, w in v.items()),
    }


@check(_sheared)
def cone_base(trellis, soft, hard, tight, fabric, **_):
    """Radius of the cone's base at 45 degrees over that along the yarns, when it has spread to half the panel."""
    found = {}
    for name, run in (("low", soft), ("high", hard)):
        for taken in run["snapshots"]:
            ratio, axis = _base(taken)
            if axis > 50e-3:
                break
        found[name] = ratio
        found.setdefault("note", "")
        found["note"] += f"{name}: {ratio:.2f} at {1e6 * taken['t']:.0f} us, {1e3 * axis:.0f} mm along the yarns; "
    return found


def _base(taken, share=0.05):
    from scipy.interpolate import RegularGridInterpolator

    z = RegularGridInterpolator((taken["x"], taken["y"]), taken["z"], bounds_error=False, fill_value=0.0)
    top, reach = float(taken["z"].max()), np.linspace(0, min(taken["x"][-1], taken["y"][-1]), 800)
    radius = []
    for angle in (0.0, 0.25 * np.pi, 0.5 * np.pi):
        heights = z(np.stack([reach * np.cos(angle), reach * np.sin(angle)], axis=1))
        radius.append(reach[np.flatnonzero(heights > share * top)[-1]])
    axis = 0.5 * (radius[0] + radius[2])
    return radius[1] / axis, axis


@check(lambda fabric, velocity: {"run": _shot(fabric, velocity)})
def erosion(run, fabric, velocity):
    return {"eroded elements": run["eroded"] > 0, "note": f"{run['eroded']} elements of the quarter"}


@check(lambda fabric, velocity: {"run": _shot(fabric, velocity)})
def failed_yarns(run, fabric, velocity):
    """After a perforation: what a yarn that failed still carries, and the balance of energy with all masses left."""
    T = run["yarns"]["weft"]["tension"]
    return {
        "tension of the struck weft at the middle, end": float(np.abs(T[-1, 0])),
        "failed": run["failed"][-1] > 0,
        "energy balance": run["balance"],
    }


def _bracketing(fabrics):
    return {
        f"{name.replace('-', '')}_{model}": shot(name, **({} if model == "compressible" else {"cell_model": model}))
        for name in fabrics
        for model in MODELS
    }


@check(_bracketing)
def bracketed(fabrics, **runs):
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
