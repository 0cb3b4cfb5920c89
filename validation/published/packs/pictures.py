"""Pictures of the study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, GREEN, INK, ORANGE, RED

_NAMES = {"smooth": "smooth surfaces", "facets": "nodes on facets", "nodes": "node to node"}


def formulations(found: dict[str, Any], single: dict[str, float], path: Path) -> None:
    """Velocity at which the first yarn of a pack fails, against the formulation of contact.

    Parameters
    ----------
    found : {fabric: {form: velocity}} [m/s]
    single : {fabric: velocity} [m/s] at which the thesis says that four plies stop the shot
    """
    figure, axes = _one((8.6, 4.6))
    place = np.arange(len(found))
    for column, (form, colour) in enumerate(zip(_NAMES, (BLUE, ORANGE, RED))):
        values = [row.get(form, np.nan) for row in found.values()]
        if np.isnan(values).all():
            continue
        bars = axes.bar(place + 0.27 * (column - 1), values, 0.25, color=colour, label=_NAMES[form])
        axes.bar_label(bars, fmt="%.0f", fontsize=9, color=INK, padding=2)
    for number, velocity in enumerate(single.values()):
        label = "stopped in the thesis's test and run" if number == 0 else None
        axes.plot([number - 0.42, number + 0.42], [velocity] * 2, color=INK, lw=1.6, ls="--", label=label)
    axes.set_xticks(place, [f"4 plies of {name}" for name in found])
    axes.set(ylabel="velocity at first failure [m/s]", ylim=(0, 1.3 * max(max(row.values()) for row in found.values())))
    axes.legend(loc="upper center", ncols=2, frameon=False, fontsize=10)
    axes.grid(axis="y", alpha=0.3)
    _save(figure, path)


def velocities(runs: dict[str, Any], path: Path, note: str = "") -> None:
    """Velocity of the projectile over time, one line a run.

    Parameters
    ----------
    runs : {label: found}, as study.shoot gives them
    """
    figure, axes = _one((8.6, 4.4))
    for (label, found), colour, dash in zip(runs.items(), (BLUE, ORANGE, GREEN, RED), ("-", "-", "-", "-")):
        axes.plot(1e6 * np.array(found["t"]), found["v"], dash, color=colour, lw=1.9, label=label)
    axes.set(xlabel="time after strike [µs]", ylabel="velocity of the projectile [m/s]", title=note)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    _save(figure, path)


def forces(runs: dict[str, Any], path: Path, width: float = 2e-6) -> None:
    """Force on the projectile, averaged over `width` [s], one panel a run.

    Parameters
    ----------
    runs : {label: found}
    """
    figure, column = plt.subplots(len(runs), 1, figsize=(8.6, 1.0 + 1.75 * len(runs)), sharex=True, sharey=True)
    for axes, (label, found), colour in zip(np.atleast_1d(column), runs.items(), (BLUE, ORANGE, GREEN, RED)):
        t, force = np.array(found["t"]), -np.array(found["force"])
        count = max(1, round(width / (t[1] - t[0])))
        axes.plot(1e6 * t, 1e-3 * np.convolve(force, np.ones(count) / count, "same"), color=colour, lw=1.4)
        axes.set_title(label, loc="left", fontsize=10)
        axes.grid(alpha=0.3)
        _bare(axes)
    column[-1].set_xlabel("time after strike [µs]")
    column[-1].set_xlim(left=0)
    column[-1].set_ylim(bottom=0)
    figure.supylabel("force on the projectile [kN]", fontsize=10)
    figure.tight_layout()
    _save(figure, path, False)


def _one(size):
    figure, axes = plt.subplots(figsize=size)
    _bare(axes)
    return figure, axes


def _bare(axes):
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _save(figure, path, tight=True):
    if tight:
        figure.tight_layout()
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=150)
    plt.close(figure)
