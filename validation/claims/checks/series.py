"""What several checks read off a shot: velocity at an instant, arrivals, energies, smoothness."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.signal import butter, sosfiltfilt

from fabrics.checks import BoolArray, FloatArray

if TYPE_CHECKING:
    from validation.claims.registry import RunResult

FAMILIES = ("warp", "weft")
ONSET = 0.02  # of the yarn's strength: a reaction that has risen
QUIET = 30e3  # [Hz] below which an oscillation is response, above which it is noise


def velocity(run: RunResult, t: Any) -> Any:
    """[m/s] of the projectile at the instants `t` [s]; 0 after it has stopped, the last one after it has passed."""
    return np.interp(t, run["fine"][:, 0], run["fine"][:, 2])


def at(run: RunResult, name: str, t: FloatArray) -> FloatArray:
    """An energy or other sample at the instants `t`."""
    return np.interp(t, run["t"], run["energies"][name])


def internal(run: RunResult) -> FloatArray:
    """[J] stored, sheared and lost in failure, at the samples."""
    return run["energies"]["yarn_strain"] + run["energies"]["shear"] + run["energies"]["failure_dissipation"]


def ratio(run: RunResult) -> tuple[FloatArray, BoolArray]:
    """(KE / IE, where there is internal energy) of the fabric at the samples."""
    inside = internal(run)
    some = inside > 1e-3 * inside.max()
    return np.where(some, run["energies"]["kinetic_fabric"] / np.where(some, inside, 1), np.nan), some


def reaction(run: RunResult, family: str) -> tuple[FloatArray, FloatArray]:
    """(t, N) of the yarn through the impact point at its edge."""
    return run["t"], run["reactions"][family]


def onset(run: RunResult, family: str, share: float = ONSET) -> float:
    """[s] when the reaction at the edge first exceeds a share of the yarn's strength; nan where it never does."""
    t, N = reaction(run, family)
    level = share * run["strength"][FAMILIES.index(family)]
    above = np.flatnonzero(N > level)
    if above.size == 0 or above[0] == 0:
        return np.nan
    k = above[0]
    return float(t[k - 1] + (t[k] - t[k - 1]) * (level - N[k - 1]) / (N[k] - N[k - 1]))


def smooth(t: FloatArray, y: FloatArray, cut: float = QUIET) -> FloatArray:
    """A record without what is faster than `cut` [Hz], shifted in no way."""
    return sosfiltfilt(butter(3, 2 * cut * (t[1] - t[0]), output="sos"), y)


def noise(t: FloatArray, y: FloatArray, cut: float = QUIET) -> float:
    """RMS of what is faster than `cut`."""
    return float(np.sqrt(np.mean((y - smooth(t, y, cut)) ** 2)))


def even(t: FloatArray, y: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """A record at even instants."""
    clock = np.arange(t[0], t[-1], step)
    return clock, np.interp(clock, t, y)


def zones(run: RunResult, end: float = 200e-6) -> tuple[float, float, float]:
    """(instant of the kink, slopes before and after) of two straight lines through the velocity history."""
    t = np.linspace(0, min(end, run["fine"][-1, 0]), 401)
    best: tuple[Any, ...] = (np.inf, None, None)
    v = velocity(run, t)
    for kink in t[20:-20]:
        basis = np.stack([np.ones_like(t), np.minimum(t, kink), np.maximum(t - kink, 0)], axis=1)
        found, *_ = np.linalg.lstsq(basis, v, rcond=None)
        off = float(np.sum((basis @ found - v) ** 2))
        if off < best[0]:
            best = off, kink, found
    return best[1], best[2][1], best[2][2]


def snapshot(run: RunResult, t: float) -> dict[str, Any]:
    """The snapshot nearest an instant."""
    return min(run["snapshots"], key=lambda taken: abs(taken["t"] - t))


def strain(run: RunResult, family: str) -> FloatArray:
    """(samples,) [-] fibre strain of the yarn through the impact point beside the projectile's edge, at `clock`."""
    yarn = run["yarns"][family]
    beside = (yarn["X"] > 3e-3) & (yarn["X"] < 10e-3)
    return 0.03 * yarn["tension"][:, beside].mean(axis=1) / yarn["strength"]


def over_displacement(run: RunResult, values: FloatArray, some: BoolArray) -> float:
    """Mean of a sample over the projectile's displacement."""
    z, y = run["z"][some], values[some]
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(z)) / (z[-1] - z[0]))
