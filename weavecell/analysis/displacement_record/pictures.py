"""Pictures of reduced records: histories with their error bands, and the plots of strike against residual."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib

from fabrics.checks import FilePath
from weavecell.analysis.displacement_record.reduction import Reduction

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, RED

GREY = "#555555"


def history(name: str, found: Reduction, path: FilePath) -> None:
    """Displacement, velocity, absorbed energy and decelerating force of one record, with bands of 95 %."""
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.8), sharex=True, layout="constrained")
    t, every = 1e6 * found.record.t, max(1, found.record.t.size // 1500)
    axes[0, 0].plot(t[::every], 1e3 * found.record.x[::every], ".", ms=2, color=GREY, label="record")
    axes[0, 0].plot(t, 1e3 * found.x, color=BLUE, lw=1.6, label="fitted")
    axes[0, 0].legend(frameon=False)
    rows = ((axes[0, 1], found.v, found.v_error, 1, "velocity, m/s"),
            (axes[1, 0], found.absorbed, found.absorbed_error, 1, "absorbed energy, J"),
            (axes[1, 1], -found.mass * found.a, found.mass * found.a_error, 1, "decelerating force, N"))  # fmt: skip
    for axis, y, error, scale, label in rows:
        axis.fill_between(t, scale * (y - error), scale * (y + error), color=BLUE, alpha=0.25, lw=0)
        axis.plot(t, scale * y, color=BLUE, lw=1.6)
        axis.set_ylabel(label)
    axes[0, 0].set_ylabel("displacement, mm")
    for axis in axes.flat:
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
    for axis in axes[1]:
        axis.set_xlabel("time, µs")
    figure.suptitle(
        f"{name}: velocity over {1e6 * found.windows[0]:.0f} µs, force over {1e6 * found.windows[1]:.0f} µs; "
        "bands: noise and smoothing, 95 %"
    )
    _save(figure, path)


def shots(reductions: Mapping[str, Reduction], path: FilePath) -> None:
    """Residual against strike velocity, and absorbed against strike energy."""
    figure, (speeds, energies) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
    for found in reductions.values():
        Vs, dVs = found.strike
        Vr, dVr = (0.0, 0.0) if found.stopped else found.residual
        Es, Ea = 0.5 * found.mass * Vs**2, 0.5 * found.mass * (Vs**2 - Vr**2)
        dEs, dEa = found.mass * Vs * dVs, found.mass * np.hypot(Vs * dVs, Vr * dVr)
        looks = {"fmt": "o" if found.stopped else "s", "ms": 7, "capsize": 3, "color": BLUE if found.stopped else RED}
        speeds.errorbar(Vs, Vr, dVr, dVs, **looks)
        energies.errorbar(Es, Ea, dEa, dEs, **looks)
    for axis, label, unit in ((speeds, "velocity", "m/s"), (energies, "energy", "J")):
        end = 1.1 * axis.get_xlim()[1]
        axis.plot([0, end], [0, end], ":", color=GREY)
        axis.set(xlim=(0, end), ylim=(-0.03 * end, end), xlabel=f"strike {label}, {unit}")
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
    speeds.set_ylabel("residual velocity, m/s")
    energies.set_ylabel("absorbed energy, J")
    figure.suptitle("circles: stopped, squares: still moving at the end; dotted: equal")
    _save(figure, path)


def _save(figure, path):
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=140)
    plt.close(figure)
