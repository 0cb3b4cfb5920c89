"""What the expressions of the ledger read: runs and fabrics; `checks` has what reads cells and coupons.

Times are in s, places in m, velocities in m/s, forces in N; a `run` is what a function of `runs` returns.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.signal import butter, sosfiltfilt
from scipy.stats import spearmanr

from fabrics import catalogue
from fabrics.checks import BoolArray, FloatArray
from fabrics.fabric import Fabric
from fabrics.weave import Weave
from shellfabric.cell.model import CellModel
from shellfabric.output import wave_fronts
from shellfabric.output.snapshots import pyramid
from shellfabric.panel.model import Panel

FAMILIES = ("warp", "weft")
KEVLAR = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
ALL = catalogue.list_names()
ZONE_I = 60e-6  # [s] at which zone I of a shot at 100 m/s ends
OFFSETS = tuple((1e-3 * np.arange(0, 100, 3)).round(6).tolist())  # [m] of weft yarns from the middle to the corner
ONSET = 0.02  # of the yarn's strength: a reaction that has risen
QUIET = 30e3  # [Hz] below which an oscillation is response, above which it is noise
STOPPED, PERFORATED = "stops", "perforates"


def fabric(name: str) -> Fabric:
    """The fabric with the linear densities of its data sheet."""
    return catalogue.load(name)


def effective(name: str) -> Fabric:
    """The fabric with the linear densities that the tables of the thesis imply (erratum E-07)."""
    return catalogue.load(name).with_effective_density()


def weave(name: str) -> Weave:
    """The weave of `fabric`."""
    return catalogue.load(name).weave


def panel(name: str, size: int = 8) -> Panel:
    """A panel of `fabric`, with a table of its cell of that size."""
    return Panel(CellModel(catalogue.load(name)).table(size))


def rank(values: dict[str, float]) -> list[str]:
    """Names from the largest value to the smallest."""
    return sorted(values, key=lambda name: -values[name])


def slope(x: Any, y: Any) -> float:
    """Of the line of least squares."""
    return float(np.polyfit(x, y, 1)[0])


def taut_line(strain: FloatArray, T: FloatArray, above: float) -> tuple[float, float]:
    """(strain at which the line through the tensions above a value meets no load, its slope)"""
    rise, start = np.polyfit(strain[T > above], T[T > above], 1)
    return float(-start / rise), float(rise)


def correlation(x: Any, y: Any) -> float:
    return float(np.corrcoef(x, y)[0, 1])


def rank_correlation(x: Any, y: Any) -> float:
    """Spearman's, of the pairs that are finite."""
    x, y = np.array(x), np.array(y)
    sound = np.isfinite(x) & np.isfinite(y)
    return float(spearmanr(x[sound], y[sound])[0])


def rising(*values: Any) -> BoolArray:
    """Where each value is above the one before."""
    return (np.diff(np.array(values), axis=0) > 0).all(axis=0)


def drop(values: FloatArray) -> float:
    """[-] largest fall below an earlier value, over the largest value."""
    return float(np.max(np.maximum.accumulate(values) - values) / values.max())


def outcome(run: Any) -> str:
    """ "stops" or "perforates", as the thesis says it."""
    return {"stopped": STOPPED, "perforated": PERFORATED}.get(run.outcome, run.outcome)


def v(run: Any, t: Any) -> Any:
    """Velocity of the projectile at the instants t; 0 after it has stopped, the last one after it has passed."""
    return np.interp(t, run.step_history[:, 0], run.step_history[:, 2])


def end(*runs: Any) -> float:
    """Instant at which the first of the runs ended."""
    return float(min(run.step_history[-1, 0] for run in runs))


def depth(run: Any) -> float:
    """Of the nose at the end: the back face of a shot that stops."""
    return float(run.nose_position[-1])


def apart(first: Any, second: Any, start: float = 0.0, stop: float = 250e-6, count: int = 300) -> float:
    """Largest difference of velocity between two runs."""
    t = np.linspace(start, min(stop, end(first, second)), count)
    return float(np.abs(v(first, t) - v(second, t)).max())


def lead(first: Any, second: Any, start: float, stop: float | None = None, count: int = 200) -> FloatArray:
    """Velocity of the first run less that of the second, at even instants."""
    t = np.linspace(start, stop or end(first, second), count)
    return v(first, t) - v(second, t)


def internal(run: Any) -> FloatArray:
    """[J] stored, sheared and lost in failure, at the samples."""
    return run.energies["yarn_strain"] + run.energies["shear"] + run.energies["failure_dissipation"]


def shear_share(run: Any) -> float:
    """[-] of shear in the internal energy at the end."""
    return float(run.energies["shear"][-1] / internal(run)[-1])


def kinetic_ratio(run: Any) -> tuple[FloatArray, BoolArray]:
    """(KE / IE, where there is internal energy) of the fabric at the samples."""
    inside = internal(run)
    some = inside > 1e-3 * inside.max()
    return np.where(some, run.energies["kinetic_fabric"] / np.where(some, inside, 1), np.nan), some


def mean_kinetic_ratio(run: Any, start: float, stop: float) -> float:
    """Its mean over the samples between two instants."""
    ratio, some = kinetic_ratio(run)
    return float(np.nanmean(ratio[some & (run.t > start) & (run.t < stop)]))


def late_kinetic_ratio(run: Any) -> FloatArray:
    """Its samples in the later half of the projectile's displacement."""
    ratio, some = kinetic_ratio(run)
    return ratio[some & (run.nose_position > 0.5 * run.nose_position[-1])]


def over_displacement(run: Any, values: FloatArray, some: BoolArray) -> float:
    """Mean of a sample over the projectile's displacement."""
    z, y = run.nose_position[some], values[some]
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(z)) / (z[-1] - z[0]))


def yarn(run: Any, family: str) -> Any:
    """History of the yarn through the impact point."""
    return run.histories[0].through(family)


def tension(run: Any, family: str, low: float, high: float) -> FloatArray:
    """Mean tension of that yarn between two distances from the impact point, at its instants."""
    history = yarn(run, family)
    return history.tension[:, (history.X > low) & (history.X < high)].mean(axis=1)


def strain(run: Any, family: str) -> FloatArray:
    """[-] fibre strain of that yarn beside the projectile's edge, at its instants."""
    return 0.03 * tension(run, family, 3e-3, 10e-3) / yarn(run, family).strength


def onset(run: Any, family: str) -> float:
    """Instant at which its reaction at the edge first exceeds ONSET; nan where it never does."""
    t, N = run.t, run.reactions[family]
    level = ONSET * strength(run)[FAMILIES.index(family)]
    above = np.flatnonzero(N > level)
    if above.size == 0 or above[0] == 0:
        return np.nan
    k = above[0]
    return float(t[k - 1] + (t[k] - t[k - 1]) * (level - N[k - 1]) / (N[k] - N[k - 1]))


def reaction(run: Any, family: str) -> tuple[FloatArray, FloatArray]:
    """(instants a microsecond apart, its reaction at the edge)"""
    return even(run.t, run.reactions[family], 1e-6)


def smooth_reaction(run: Any, family: str) -> tuple[FloatArray, FloatArray]:
    """The same without noise."""
    t, N = reaction(run, family)
    return t, smooth(t, N)


def front(run: Any, family: str, kind: str) -> float:
    """[m/s] of the "longitudinal" or "transverse" front along that yarn."""
    return getattr(wave_fronts, kind)(yarn(run, family), run.histories[0].t).speed


def strength(run: Any) -> FloatArray:
    """(2,) of warp and weft of the struck ply."""
    return np.array([yarn.strength for yarn in run.panel.weave.yarns])


def off_square(run: Any, ply: int, t: float) -> float:
    """Extent of the cone of a ply along the weft over that along the warp, in the snapshot nearest an instant."""
    shot, place = min(run.snapshots, key=lambda shots: abs(shots[0].t - t))[ply], run.target.places[ply]
    warp, weft = pyramid(run.panels[ply], replace(shot, nodes=shot.nodes - [0.0, 0.0, place]))
    return weft / warp


def largest_shear(run: Any) -> float:
    """[rad] of any element of the struck ply in which no yarn has failed, in all snapshots."""
    most = 0.0
    for shot in (shots[0] for shots in run.snapshots):
        a, b = np.diff(shot.nodes, axis=0), np.diff(shot.nodes, axis=1)
        warp, weft = 0.5 * (a[:, :-1] + a[:, 1:]), 0.5 * (b[:-1] + b[1:])
        lengths = np.linalg.norm(warp, axis=2) * np.linalg.norm(weft, axis=2)
        gamma = np.abs(np.arcsin(np.einsum("ijk,ijk->ij", warp, weft) / lengths))
        most = max(most, float(gamma[~shot.failed.any(axis=2)].max()))
    return most


def even(t: FloatArray, y: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """A record at even instants."""
    clock = np.arange(t[0], t[-1], step)
    return clock, np.interp(clock, t, y)


def smooth(t: FloatArray, y: FloatArray) -> FloatArray:
    """A record without what is faster than QUIET, shifted in no way."""
    return sosfiltfilt(butter(3, 2 * QUIET * (t[1] - t[0]), output="sos"), y)


def noise(t: FloatArray, y: FloatArray, start: float = -np.inf, stop: float = np.inf) -> float:
    """RMS of what is faster than QUIET in a part of a record."""
    part = (t > start) & (t < stop)
    return float(np.sqrt(np.mean((y[part] - smooth(t[part], y[part])) ** 2)))
