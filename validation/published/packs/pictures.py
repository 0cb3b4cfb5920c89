"""Pictures of the study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, GREEN, ORANGE, RED, plots


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
