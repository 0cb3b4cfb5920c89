"""Pictures of the study of slipping edges, from its shots to PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from meshing.pictures_style import BLUE, GREEN, INK, ORANGE, PURPLE, RED, SKY

_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, RED, SKY, INK)


def _plain(axes, **labels):
    axes.set(**labels)
    axes.grid(alpha=0.25, lw=0.6)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def led(shots: Any, slow: Any, path: Path) -> None:
    """Velocity with led edges at 100 and at 36 m/s, and how far it leads the clamped panel's."""
    figure, grid = plt.subplots(2, 2, figsize=(11, 7), sharex="col", height_ratios=(1.4, 1), layout="constrained")
    for column, (group, title) in enumerate(((shots, "100 m/s"), (slow, "36 m/s"))):
        clamped = group["clamped"]
        for (name, shot), colour in zip(group.items(), (INK, *_COLOURS)):
            late = name.startswith("3 mm, from")
            grid[0, column].plot(1e6 * shot.t, shot.v, color=colour, ls="--" if late else "-", lw=1.6, label=name)
            t = np.linspace(0, min(shot.end, clamped.end), 400)
            if shot is not clamped:
                grid[1, column].plot(1e6 * t, shot.lead(clamped, t), color=colour, ls="--" if late else "-", lw=1.6)
        grid[0, column].axvline(60, color="#aaaaaa", lw=0.8, ls=":")
        grid[1, column].axvline(60, color="#aaaaaa", lw=0.8, ls=":")
        _plain(
            grid[0, column], title=f"S-728, {title}, weft ends led in", ylabel="velocity [m/s]" if column == 0 else ""
        )
        _plain(
            grid[1, column],
            xlabel="time after strike [us]",
            ylabel="lead over the clamped [m/s]" if column == 0 else "",
        )
        grid[0, column].legend(fontsize=9, frameon=False)
        grid[0, column].set_xlim(left=0)
    _save(figure, path)


def gripped(shots: Any, path: Path) -> None:
    """Velocity with grips, and the slip of the ends of the weft yarns over their place along the edge."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    for (name, shot), colour in zip(shots.items(), _COLOURS):
        colour = INK if name == "clamped" else colour
        left.plot(1e6 * shot.t, shot.v, color=colour, lw=1.6, label=name)
        if name != "clamped":
            right.plot(1e3 * shot.place["weft"], 1e3 * shot.slip["weft"], color=colour, lw=1.6, label=name)
    _plain(left, title="S-728, 100 m/s, all sides gripped", xlabel="time after strike [us]", ylabel="velocity [m/s]")
    _plain(
        right, title="at the end", xlabel="yarn's distance from the impact point [mm]", ylabel="slip of weft ends [mm]"
    )
    left.legend(title="grip per yarn", fontsize=9, frameon=False)
    left.set_xlim(left=0)
    right.set_xlim(left=0)
    right.set_ylim(bottom=0)
    _save(figure, path)


def _save(figure, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
