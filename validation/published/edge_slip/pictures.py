"""Pictures of the study of slipping edges, from its shots to PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, RED, SKY, plots
from validation.published.edge_slip.study import ZONE_I

_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, RED, SKY, INK)


def led(shots: Any, slow: Any, path: Path) -> None:
    """Velocity with pulled-in edges at 100 and at 36 m/s, and its difference to that of the clamped panel."""
    with plots() as pyplot:
        figure, grid = pyplot.subplots(2, 2, figsize=(11.4, 7.4), sharex="col", height_ratios=(1.4, 1))
        for column, (group, title) in enumerate(((shots, "100 m/s"), (slow, "36 m/s"))):
            clamped = group["clamped"]
            for (name, shot), colour in zip(group.items(), (INK, *_COLOURS)):
                dash = "--" if name.startswith("3 mm, from") else "-"
                grid[0, column].plot(1e6 * shot.t, shot.v, dash, color=colour, lw=1.8, label=name)
                t = np.linspace(0, min(shot.end, clamped.end), 400)
                if shot is not clamped:
                    grid[1, column].plot(1e6 * t, shot.lead(clamped, t), dash, color=colour, lw=1.8)
            for axes in grid[:, column]:
                axes.axvline(1e6 * ZONE_I, color=FAINT, lw=1.2, ls=":", label="end of zone I of the thesis")
            grid[0, column].set_title(f"S-728, {title}, weft ends pulled in")
            grid[1, column].set(xlabel="time after strike [µs]", xlim=(0, None))
            grid[0, column].legend(fontsize=9.5)
        grid[0, 0].set_ylabel("velocity [m/s]")
        grid[1, 0].set_ylabel("difference to clamped [m/s]")
        _save(figure, path)


def gripped(shots: Any, path: Path) -> None:
    """Velocity with friction clamps, and the slip of the ends of the weft yarns over their place along the edge."""
    with plots() as pyplot:
        figure, (left, right) = pyplot.subplots(1, 2, figsize=(11.4, 4.6))
        for number, (name, shot) in enumerate(shots.items()):
            clamped = name == "clamped"
            colour, dash = (INK, ":") if clamped else (_COLOURS[number % len(_COLOURS)], "-")
            left.plot(1e6 * shot.t, shot.v, dash, color=colour, lw=1.8, label=name, zorder=3 if clamped else 2)
            if not clamped:
                right.plot(1e3 * shot.place["weft"], 1e3 * shot.slip["weft"], color=colour, lw=1.8, label=name)
        left.set(title="S-728, 100 m/s, all sides", xlabel="time after strike [µs]", ylabel="velocity [m/s]")
        right.set(title="slip at the end", xlabel="yarn's distance from the impact point [mm]")
        right.set(ylabel="slip of weft ends [mm]", xlim=(0, None), ylim=(0, None))
        left.set_xlim(left=0)
        left.legend(title="clamp force per yarn")
        _save(figure, path)


def _save(figure, path):
    with replace_whole(path) as beside:
        figure.savefig(beside, format="png", dpi=110)
