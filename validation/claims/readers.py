"""What the expressions of the ledger read: runs and fabrics; `checks` has what reads cells and coupons.

Times are in s, places in m, velocities in m/s, forces in N; a `run` is what a function of `runs` returns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.integrate import trapezoid
from scipy.interpolate import RegularGridInterpolator
from scipy.signal import butter, sosfiltfilt

from fabrics import catalogue
from fabrics.base.checks import BoolArray, FloatArray
from fabrics.fabric import Fabric
from fabrics.weave import Weave
from shellfabric.cell.model import CellModel
from shellfabric.loop.snapshots import pyramid
from shellfabric.membrane.model import Panel
from validation.claims import changed_fabrics
from validation.models.variants import KEVLAR
from validation.values import Values, largest, rms
from weavecell.results import wave_fronts

FAMILIES = ("warp", "weft")
ALL = catalogue.list_names()
ZONE_I = 60e-6  # [s] at which zone I of a shot at 100 m/s ends
OFFSETS = tuple(
    (1e-3 * np.arange(0, 100, 3)).round(6).tolist()
)  # [m] of weft yarns from the middle to the corner
ONSET = 0.02  # of the yarn's strength: a reaction that has risen
QUIET = 30e3  # [Hz] below which an oscillation is response, above which it is noise
NOSE = 3e-3  # [m] beyond the rounded edge of the projectile


def fabric(name: str) -> Fabric:
    """Load the fabric with the linear densities of its data sheet."""
    return changed_fabrics.load(name)


def effective(name: str) -> Fabric:
    """Load the fabric with the linear densities that the tables of the thesis imply (erratum
    E-07)."""
    return changed_fabrics.load(name).with_effective_density()


def weave(name: str) -> Weave:
    """Load the weave of `fabric`."""
    return changed_fabrics.load(name).weave


def crimped(names: Sequence[str] = KEVLAR) -> Iterator[Any]:
    """Yield (half length of the cell [m], height [m], length [m], Yarn) of each family of some
    fabrics."""
    for name in names:
        weave = changed_fabrics.load(name).weave
        yield from zip(weave.w, weave.h0, weave.S0, weave.yarns)


def derivative(function: Callable[[float], Any], x: float, step: float) -> Any:
    """Compute the central difference of four points, whose error falls with step^4."""
    before2, before, after, after2 = (function(x + k * step) for k in (-2, -1, 1, 2))
    return (before2 - 8 * before + 8 * after - after2) / (12 * step)


def panel(name: str, size: int = 8) -> Panel:
    """Make a panel of `fabric`, with a table of its cell of that size."""
    return Panel(CellModel(changed_fabrics.load(name)).table(size))


def rank(values: dict[str, float]) -> list[str]:
    """Sort names from the largest value to the smallest."""
    return sorted(values, key=lambda name: -values[name])


def slope(x: Any, y: Any) -> float:
    """Compute the slope of the line of least squares."""
    return float(np.polyfit(x, y, 1)[0])


def taut_line(strain: FloatArray, T: FloatArray, above: float) -> tuple[float, float]:
    """Fit a line to the tensions above a value: (strain at which it meets no load, its slope)."""
    rise, start = np.polyfit(strain[T > above], T[T > above], 1)
    return float(-start / rise), float(rise)


def rising(*values: Any) -> BoolArray:
    """Mark where each value is above the one before."""
    return (np.diff(np.array(values), axis=0) > 0).all(axis=0)


def drop(values: FloatArray) -> float:
    """Compute the largest fall [-] below an earlier value, over the largest value."""
    return float(np.max(np.maximum.accumulate(values) - values) / values.max())


def outcome(run: Any) -> str:
    """Return "stops" or "perforates", as the thesis says it."""
    return {"stopped": "stops", "perforated": "perforates"}.get(run.outcome, run.outcome)


def v(run: Any, t: Any) -> Any:
    """Interpolate the velocity of the projectile at the instants t; 0 after it has stopped, the
    last one after it has passed."""
    return np.interp(t, run.step_history[:, 0], run.step_history[:, 2])


def end(*runs: Any) -> float:
    """Return the instant at which the first of the runs ended."""
    return float(min(run.step_history[-1, 0] for run in runs))


def apart(
    first: Any, second: Any, start: float = 0.0, stop: float = 250e-6, count: int = 300
) -> float:
    """Compute the largest difference of velocity between two runs."""
    return largest(lead(first, second, start, min(stop, end(first, second)), count))


def lead(
    first: Any, second: Any, start: float, stop: float | None = None, count: int = 200
) -> FloatArray:
    """Compute the velocity of the first run less that of the second, at even instants."""
    t = np.linspace(start, stop or end(first, second), count)
    return v(first, t) - v(second, t)


def internal(run: Any) -> FloatArray:
    """Sum the energy [J] stored, sheared and lost in failure, at the samples."""
    return run.energies["yarn_strain"] + run.energies["shear"] + run.energies["failure_dissipation"]


def shear_share(run: Any) -> float:
    """Compute the share [-] of shear in the internal energy at the end."""
    return float(run.energies["shear"][-1] / internal(run)[-1])


def kinetic_ratio(run: Any) -> Any:
    """Compute KE / IE of the fabric at the samples, masked where there is no internal energy."""
    inside = internal(run)
    return (
        np.ma.masked_where(inside <= 1e-3 * inside.max(), run.energies["kinetic_fabric"]) / inside
    )


def over_displacement(run: Any, values: Any) -> float:
    """Average a masked sample over the projectile's displacement."""
    z = run.nose_position[~values.mask]
    y = values.compressed()
    return float(trapezoid(y, z) / (z[-1] - z[0]))


def yarn(run: Any, family: str) -> Any:
    """Return the history of the yarn through the impact point."""
    return run.measured[0].through(family)


def tension(run: Any, family: str, low: float, high: float) -> FloatArray:
    """Average the tension of that yarn between two distances from the impact point, at its
    instants."""
    history = yarn(run, family)
    return history.tension[:, (history.X > low) & (history.X < high)].mean(axis=1)


def strain(run: Any, family: str) -> FloatArray:
    """Compute the fibre strain [-] of that yarn beside the projectile's edge, at its instants."""
    return 0.03 * tension(run, family, 3e-3, 10e-3) / yarn(run, family).strength


def onset(run: Any, family: str) -> float:
    """Find the instant at which its reaction at the edge first exceeds ONSET; nan if it never
    does."""
    N = run.reactions[family]
    level = ONSET * strength(run)[FAMILIES.index(family)]
    first = int(np.argmax(N > level))
    # argmax is 0 as well if the level is never passed
    if first == 0:
        return np.nan
    around = slice(first - 1, first + 1)
    return float(np.interp(level, N[around], run.time[around]))


def reaction(run: Any, family: str) -> tuple[FloatArray, FloatArray]:
    """Resample its reaction at the edge: (instants a microsecond apart, reaction)."""
    return even(run.time, run.reactions[family], 1e-6)


def front(run: Any, family: str, kind: str) -> float:
    """Measure the speed [m/s] of the "longitudinal" or "transverse" front along that yarn."""
    return getattr(wave_fronts, kind)(yarn(run, family), run.measured[0].t).speed


def strength(run: Any) -> FloatArray:
    """Return the strengths (2,) of warp and weft of the struck ply."""
    return np.array([yarn.strength for yarn in run.panel.weave.yarns])


def off_square(run: Any, ply: int, t: float) -> float:
    """Measure the extent of the cone of a ply along the weft over that along the warp, in the
    snapshot nearest an instant."""
    shot = min(run.snapshots, key=lambda shots: abs(shots[0].t - t))[ply]
    place = run.target.places[ply]
    warp, weft = pyramid(run.panels[ply], replace(shot, nodes=shot.nodes - [0.0, 0.0, place]))
    return weft / warp


def largest_shear(run: Any) -> float:
    """Find the largest shear [rad] of any element of the struck ply in which no yarn has failed, in
    all snapshots."""
    most = 0.0
    for shot in (shots[0] for shots in run.snapshots):
        a = np.diff(shot.nodes, axis=0)
        b = np.diff(shot.nodes, axis=1)
        warp = 0.5 * (a[:, :-1] + a[:, 1:])
        weft = 0.5 * (b[:-1] + b[1:])
        lengths = np.linalg.norm(warp, axis=2) * np.linalg.norm(weft, axis=2)
        gamma = abs(np.arcsin(np.einsum("ijk,ijk->ij", warp, weft) / lengths))
        most = max(most, float(gamma[~shot.failed.any(axis=2)].max()))
    return most


def even(t: FloatArray, y: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Resample a record at even instants."""
    clock = np.arange(t[0], t[-1], step)
    return clock, np.interp(clock, t, y)


def smooth(t: FloatArray, y: FloatArray) -> FloatArray:
    """Smooth a record: without what is faster than QUIET, shifted in no way."""
    return sosfiltfilt(butter(3, 2 * QUIET * (t[1] - t[0]), output="sos"), y)


def noise(t: FloatArray, y: FloatArray, start: float = -np.inf, stop: float = np.inf) -> float:
    """Compute the RMS of what is faster than QUIET in a part of a record."""
    part = (t > start) & (t < stop)
    return rms(y[part] - smooth(t[part], y[part]))


def unevenness(run: Any, beside: float = 10e-3) -> float:
    """Compute |ln| of warp over weft tension, each over its strength, of the yarns through the
    impact point when one of them is closest to failing; the largest within `beside` [m] of the
    middle."""
    shares = []
    for family in FAMILIES:
        history = yarn(run, family)
        shares.append(history.tension[:, history.X < beside].max(axis=1) / history.strength)
    closest = np.argmax(np.maximum(*shares))
    return abs(np.log(shares[0][closest] / shares[1][closest]))


def zones(run: Any, stop: float = 200e-6) -> Values:
    """Find the instant of the kink of two straight lines through the velocity history, and their
    slopes."""
    t = np.linspace(0, min(stop, end(run)), 401)
    velocity = v(run, t)
    least = np.inf
    for kink in t[20:-20]:
        basis = np.stack([np.ones_like(t), np.minimum(t, kink), np.maximum(t - kink, 0)], axis=1)
        line, *_ = np.linalg.lstsq(basis, velocity, rcond=None)
        off = float(np.sum((basis @ line - velocity) ** 2))
        if off < least:
            least = off
            found = {"kink": kink, "before": line[1], "after": line[2]}
    return found


def high_zone(run: Any, start: float, stop: float, level: float = 0.1) -> Values:
    """Average weft reactions across the edge over a window [s]: of the middle and of the plateau
    [N], and the width [m] of the zone, which ends where `level` of what the middle has more than
    the plateau is left."""
    clock = run.measured[0].t
    window = (clock > start) & (clock < stop)
    ends = {}
    for yarn in run.measured[0].yarns:
        if yarn.family == "weft":
            ends[abs(yarn.offset)] = yarn.tension[window, -1].mean()
    offset, profile = np.array(sorted(ends.items())).T
    plateau = profile[(offset > 50e-3) & (offset < 85e-3)].mean()
    below = np.flatnonzero(profile < plateau + level * (profile[0] - plateau))
    width = np.nan
    if below.size:
        width = 2 * float(offset[below[0]])
    return {
        "middle": profile[0],
        "plateau": plateau,
        "width": width,
    }


def noise_over_net(shell: Any, cables: Any) -> float:
    """Compare the noise of the reaction of the warp: shell over cable net, as means over a
    microsecond, as the shell's are."""
    t = np.arange(0, min(shell.time[-1], end(cables)), 1e-6)
    clock = cables.step_history[:, 0]
    width = max(1, round(1e-6 / (clock[1] - clock[0])))
    of_cables = np.interp(
        t, clock, np.convolve(cables.reactions["warp"], np.ones(width) / width, "same")
    )
    return noise(t, np.interp(t, shell.time, shell.reactions["warp"])) / noise(t, of_cables)


def cone_base(run: Any, reach: float = 50e-3, share: float = 0.05) -> float:
    """Compute the radius of the cone's base at 45 degrees over that along the yarns, when it has
    spread to `reach` [m]."""
    X, Y = run.panel.coordinates()
    r = np.linspace(0, min(X[-1, 0], Y[0, -1]), 800)
    for height in (shots[0].nodes[..., 2].astype(np.float32) for shots in run.snapshots):
        z = RegularGridInterpolator((X[:, 0], Y[0]), height, bounds_error=False, fill_value=0.0)
        radius = []
        for angle in (0.0, 0.25 * np.pi, 0.5 * np.pi):
            heights = z(np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1))
            radius.append(r[np.flatnonzero(heights > share * float(height.max()))[-1]])
        axis = 0.5 * (radius[0] + radius[2])
        if axis > reach:
            break
    return radius[1] / axis


def straight_side(run: Any, velocity: float) -> float:
    """Compute R2 of the line through the side of the cone of a lone yarn."""
    inside = run.nodes[:, 0] < 0.9 * run.U * run.nodes[0, 1] / velocity
    return np.corrcoef(*run.nodes[inside].T)[0, 1] ** 2


def _profile(run, t):
    """Positions along the warp through the impact point and their deflections at the instant nearest t."""
    warp = yarn(run, "warp")
    k = int(np.argmin(abs(run.measured[0].t - t)))
    return warp.place[k], warp.deflection[k]


def cone_sides(run: Any, times: Sequence[float]) -> Values:
    """Measure the sides of the cone of a shell's yarn: straightness at times [s], and what the
    slope loses from first to last."""
    slopes = []
    R2 = []
    for t in times:
        x, z = _profile(run, t)
        side = (x > NOSE) & (z > 0.1 * z.max())
        slopes.append(-np.polyfit(x[side], z[side], 1)[0])
        R2.append(np.corrcoef(x[side], z[side])[0, 1] ** 2)
    return {"R2": min(R2), "fall of the slope": 1 - slopes[-1] / slopes[0]}


def cone_slope(run: Any, t: float) -> float:
    """Fit the slope of the side of the cone along the warp at an instant, from 30 to 80 % of its
    height."""
    x, z = _profile(run, t)
    part = (z > 0.3 * z.max()) & (z < 0.8 * z.max())
    return -np.polyfit(x[part], z[part], 1)[0]


def front_width(run: Any, place: float) -> float:
    """Measure the length [m] over which the tension of the weft at a place rises from a tenth to
    half of the plateau behind the front."""
    weft = yarn(run, "weft")
    clock = run.measured[0].t
    T = weft.tension[:, int(np.argmin(abs(weft.X - place)))]
    start = np.argmax(T > 0.01 * weft.strength)
    # the plateau is reached within 20 us
    plateau = T[start : start + 40].max()
    part = slice(max(start - 5, 0), start + 40)
    rise = np.maximum.accumulate(T[part])
    times = [clock[part][np.argmax(rise >= share * plateau)] for share in (0.1, 0.5)]
    return (times[1] - times[0]) * front(run, "weft", "longitudinal")


def share_of_time_falling(*runs: Any) -> float:
    """Compute the share [-] of the time after zone I in which the strain of the weft, without
    noise, falls from each run to the next."""
    n = min(len(run.measured[0].t) for run in runs)
    clock = runs[0].measured[0].t
    strains = [smooth(run.measured[0].t[:n], strain(run, "weft")[:n]) for run in runs]
    return float(np.mean(rising(*strains[::-1])[clock[:n] > ZONE_I]))


def spread_before_peak(less: Any, same: Any, more: Any) -> float:
    """Compute the largest difference of the strains of the weft of three runs before the peak of
    the middle one, over the peak."""
    clock = same.measured[0].t
    strains = strain(same, "weft")
    t = np.linspace(0, 0.9 * clock[int(np.argmax(strains))], 300)
    each = [np.interp(t, run.measured[0].t, strain(run, "weft")) for run in (less, same, more)]
    return float((np.max(each, axis=0) - np.min(each, axis=0)).max() / strains.max())


def slip_delay(run: Any, held: Any, start: float) -> float:
    """Measure the time [s] from the start of a slip until the velocity has left that of the held
    panel by half a metre a second."""
    t = np.linspace(0, end(run, held), 2000)
    gone = abs(v(run, t) - v(held, t)) > 0.5
    if gone.any():
        return float(t[np.argmax(gone)]) - start
    return np.nan


def slip(run: Any) -> FloatArray:
    """Compute how far [m] each weft yarn is out of its clamp at the end."""
    return run.panel.coordinates()[1][:, -1] - run.last[0].nodes[:, -1, 1]
