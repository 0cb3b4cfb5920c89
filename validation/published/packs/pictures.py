"""Pictures of the study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, GREEN, INK, ORANGE, RED, plots

_NAMES = {"smooth": "smooth surfaces", "facets": "nodes on facets", "nodes": "node to node"}


def formulations(found: dict[str, Any], single: dict[str, float], path: Path) -> None:
    """Velocity at which the first yarn of a pack fails, against the formulation of contact.

    Parameters
    ----------
    found : {fabric: {form: velocity}} [m/s]
    single : {fabric: velocity} [m/s] of the caption in which four plies stop the shot in the thesis
    """
    with plots() as pyplot:
        figure, axes = pyplot.subplots(figsize=(9.4, 4.8))
        place = np.arange(len(found))
        for column, (form, colour) in enumerate(zip(_NAMES, (BLUE, ORANGE, RED))):
            values = [row.get(form, np.nan) for row in found.values()]
            if np.isnan(values).all():
                continue
            bars = axes.bar(place + 0.27 * (column - 1), values, 0.25, color=colour, label=_NAMES[form])
            axes.bar_label(bars, fmt="%.0f", fontsize=10, color=INK, padding=2)
        for number, velocity in enumerate(single.values()):
            label = "stopped in the thesis's simulation" if number == 0 else None
            axes.plot([number - 0.42, number + 0.42], [velocity] * 2, color=INK, lw=1.6, ls="--", label=label)
        axes.set_xticks(place, [f"4 plies of {name}" for name in found])
        axes.set(ylabel="velocity at first failure [m/s]")
        axes.set_ylim(0, 1.1 * max(max(row.values()) for row in found.values()))
        axes.grid(axis="x", visible=False)
        figure.legend(loc="outside lower center", ncols=2)
        _save(figure, path)


def velocities(runs: dict[str, Any], path: Path, note: str = "") -> None:
    """Velocity of the projectile over time, one line a run.

    Parameters
    ----------
    runs : {label: found}, as study.shoot gives them
    note : title
    """
    with plots() as pyplot:
        figure, axes = pyplot.subplots(figsize=(9.4, 4.4))
        for (label, found), colour, dash in zip(runs.items(), (BLUE, ORANGE, GREEN, RED), ("-", "--", "-.", ":")):
            axes.plot(1e6 * np.array(found["t"]), found["v"], dash, color=colour, label=label)
        axes.set(xlabel="time after strike [µs]", ylabel="velocity of the projectile [m/s]", title=note)
        axes.set_xlim(left=0)
        axes.set_ylim(bottom=0)
        axes.legend()
        _save(figure, path)


def forces(runs: dict[str, Any], path: Path, width: float = 2e-6) -> None:
    """Force on the projectile, averaged over `width` [s], one panel a run.

    Parameters
    ----------
    runs : {label: found}
    """
    with plots() as pyplot:
        figure, column = pyplot.subplots(len(runs), 1, figsize=(9.4, 1.0 + 1.9 * len(runs)), sharex=True, sharey=True)
        for axes, (label, found), colour in zip(np.atleast_1d(column), runs.items(), (BLUE, ORANGE, GREEN, RED)):
            t, force = np.array(found["t"]), -np.array(found["force"])
            count = max(1, round(width / (t[1] - t[0])))
            mean = np.convolve(force, np.ones(count) / count, "valid")  # no window reaches beyond the ends
            axes.plot(1e6 * (t[: mean.size] + 0.5 * (count - 1) * (t[1] - t[0])), 1e-3 * mean, color=colour, lw=1.6)
            axes.set_title(label, fontsize=11)
        column = np.atleast_1d(column)
        column[-1].set_xlabel("time after strike [µs]")
        column[-1].set(xlim=(0, None), ylim=(0, None))
        figure.supylabel("force on the projectile [kN]", fontsize=12)
        _save(figure, path)


def _save(figure, path):
    with replace_whole(path) as beside:
        figure.savefig(beside, format="png", dpi=120)
