"""Plots of packs of plies: cuts through the plies, and what each of them bears."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from meshing.pictures_style import BLUE, FAINT, ORANGE, RED, STEEL

if TYPE_CHECKING:
    from weavecell.results.pack import Cut

US, MM = 1e6, 1e3
_STEPS = ("#0b1a4a", "#1a4f92", "#2b83ba", "#6bb0d0", "#9fcbe0")  # front to rear


def shades(count: int) -> list:
    """Colours of plies from the front to the rear, in even steps."""
    from matplotlib.colors import LinearSegmentedColormap

    ramp = LinearSegmentedColormap.from_list("plies", _STEPS)
    return [ramp(n / max(1, count - 1)) for n in range(count)]


def cuts(
    pyplot: Any,
    chosen: Sequence[Cut],
    thickness: np.ndarray,
    mirrored: bool,
    projectile: np.ndarray,
    close_up: float,
) -> Any:
    """Cuts through the impact point, each whole and as a close-up, in which the lines are as thick as the plies.

    Parameters
    ----------
    chosen : sequence of results.pack.Cut
    thickness : (plies,) [m]
    mirrored : whether the modelled part continues mirrored in x = 0
    projectile : (n, 2) [m] its outline, the foremost point at height 0
    close_up : [m] half the width of a close-up
    """
    figure, grid = pyplot.subplots(
        len(chosen), 2, figsize=(10.4, 0.5 + 2.7 * len(chosen)), squeeze=False, width_ratios=(1.15, 1)
    )
    colours = shades(len(thickness))
    top = max(_foremost(cut) for cut in chosen)
    for row, cut in zip(grid, chosen):
        for axes, near in zip(row, (False, True)):
            axes.fill(
                MM * projectile[:, 0], MM * (projectile[:, 1] + cut.nose), fc="#d5dae0", ec=STEEL, lw=1.0, zorder=1
            )
            for line, t, colour in zip(cut.lines, thickness, colours):
                for part in pieces(line):
                    whole: Any = np.concatenate([[-1, 1] * part[:0:-1], part]) if mirrored and part[0, 0] == 0 else part
                    images = [whole] if whole is not part or not mirrored else [part, [-1, 1] * part]
                    for image in images:
                        axes.plot(*(MM * image.T), color=colour, lw=1.4, zorder=2, solid_joinstyle="round")
                        if near:
                            axes.fill(*(MM * _band(image, t).T), color=colour, alpha=0.45, lw=0, zorder=1.5)
            axes.grid(visible=near)
        reach = MM * max(float(np.nanmax(line[:, 0])) for line in cut.lines)
        row[0].set(xlim=(-reach, reach), ylim=(-8, MM * top + 3), ylabel="z [mm]")
        row[0].set_title(f"{US * cut.t:.0f} µs")
        high = MM * _foremost(cut) + 0.8
        row[1].set_aspect("equal")
        row[1].set(xlim=(-MM * close_up, MM * close_up), ylim=(high - 1.3e3 * close_up, high))
    for axes in grid[-1]:
        axes.set_xlabel("x [mm]")
    return figure


def pieces(line: np.ndarray) -> list[np.ndarray]:
    """The pieces of a line that is cut where it is not a number; a lone point is none."""
    ends = np.flatnonzero(np.isnan(line[:, 0]))
    found = np.split(line, ends)
    found = [part[~np.isnan(part[:, 0])] for part in found]
    return [part for part in found if len(part) > 1]


def _foremost(cut):
    """[m] highest point of the plies and the nose."""
    return max(cut.nose, *(float(part[:, 1].max()) for line in cut.lines for part in pieces(line)))


def _band(line, thickness):
    """Outline of a line as thick as its ply."""
    along = np.gradient(line, axis=0)
    normal = 0.5 * thickness * np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    return np.concatenate([line + normal, (line - normal)[::-1]])


def shares(pyplot: Any, peaks: np.ndarray, failed: np.ndarray, energy: np.ndarray) -> Any:
    """What each ply bears: highest tension, failed yarn segments, energy at the end.

    Parameters
    ----------
    peaks : (plies, 2) [-] highest tension of warp and weft over the strength
    failed : (plies,)
    energy : (plies,) [J]
    """
    figure, row = pyplot.subplots(1, 3, figsize=(10.4, 3.6))
    ply = np.arange(1, len(failed) + 1)
    for column, (name, colour) in enumerate((("warp", BLUE), ("weft", RED))):
        row[0].bar(ply + 0.2 * (2 * column - 1), peaks[:, column], 0.38, color=colour, label=name)
    row[0].axhline(1.0, color=FAINT, ls=":", lw=1.2)
    row[0].set(title="highest tension / strength", ylim=(0, max(1.1, 1.25 * float(peaks.max()))))
    row[0].legend(loc="upper right", ncols=2)
    row[1].bar(ply, failed, 0.7, color=ORANGE)
    row[1].set(title="failed yarn segments", ylim=(0, max(1.0, 1.1 * float(np.max(failed)))))
    row[2].bar(ply, energy, 0.7, color=BLUE)
    row[2].set(title="energy at the end [J]", ylim=(0, 1.1 * float(np.max(energy))))
    for axes in row:
        axes.set_xlabel("ply, from the front")
        axes.set_xticks(ply if len(ply) <= 8 else ply[:: -(-len(ply) // 8)])
        axes.grid(axis="x", visible=False)
    return figure


def pushes(pyplot: Any, t: np.ndarray, push: np.ndarray, deflection: np.ndarray) -> Any:
    """Force of the nose on each ply it touches, and deflections at the impact point.

    Parameters
    ----------
    t : (n,) [s]
    push, deflection : (n, plies) [N, m]
    """
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.4, 3.9))
    colours = shades(push.shape[1])
    for ply, colour in enumerate(colours):
        label = f"ply {ply + 1}" if ply in (0, push.shape[1] - 1) else None
        if np.any(push[:, ply]):
            left.plot(US * t, 1e-3 * push[:, ply], color=colour, lw=1.6, label=f"ply {ply + 1}")
        right.plot(US * t, MM * deflection[:, ply], color=colour, lw=1.6, label=label)
    left.set(title="force of the nose [kN]", xlabel="time after strike [µs]")
    right.set(title="deflection at the impact point [mm]", xlabel="time after strike [µs]")
    left.legend(loc="upper right", ncols=2)
    right.legend(loc="upper left")
    for axes in (left, right):
        axes.set_xlim(0, US * float(t[-1]))
    return figure
