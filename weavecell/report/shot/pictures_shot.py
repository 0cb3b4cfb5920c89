"""Plots of one impact, on one ply or on a pack: histories, cuts through the fabric, and where the energy is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from meshing.pictures_style import COLOURS, DASHES, FAINT, INK, STEEL
from weavecell.report.pictures import ENERGIES, place
from weavecell.report.shot.pictures_pack import shades

if TYPE_CHECKING:
    from weavecell.results.impact_shapes import Cut

US, MM = 1e6, 1e3


def histories(pyplot: Any, runs: Any) -> Any:
    """Velocity of the projectile, deflection of the back face and contact force over time, one below the other.

    Parameters
    ----------
    runs : {label: (t, velocity, deflection, nose, force)} [s, m/s, m, m, N]; of runs of one strike velocity the next
        are dashed
    """
    figure, (top, middle, low) = pyplot.subplots(
        3, 1, figsize=(10.4, 8.6), sharex=True, height_ratios=(1.2, 1, 1), layout="none"
    )
    place(figure, 1.05, 0.2, 0.65, 0.15, down=0.2)
    strikes = list(dict.fromkeys(round(float(run[1][0]), 6) for run in runs.values()))
    seen = dict.fromkeys(strikes, 0)
    for label, (t, velocity, deflection, nose, force) in runs.items():
        strike = round(float(velocity[0]), 6)
        style: dict[str, Any] = {"ls": DASHES[seen[strike] % 4], "color": COLOURS[strikes.index(strike) % 6]}
        seen[strike] += 1
        top.plot(US * t, velocity, label=label, **style)
        middle.plot(US * t, MM * deflection, **style)
        if len(runs) == 1:
            middle.plot(US * t, MM * nose, color=STEEL, ls=":", label="nose of the projectile")
        low.plot(US * t, 1e-3 * force, **{**style, "lw": 1.4})
    top.axhline(0.0, color=FAINT, lw=1)
    top.set_ylabel("velocity [m/s]")
    middle.set_ylabel("deflection of the\nback face [mm]")
    middle.set_ylim(0, 1.35 * MM * max(float(np.nanmax(run[2])) for run in runs.values()) + 0.1)
    low.set(xlabel="time after strike [µs]", ylabel="contact force [kN]")
    low.set_ylim(bottom=min(0.0, low.get_ylim()[0]))
    low.set_xlim(0, US * max(float(run[0][-1]) for run in runs.values()))
    if len(runs) > 1:
        top.legend(loc="best", fontsize=10)
    else:
        middle.legend(loc="upper left", fontsize=10)
    return figure


@dataclass(frozen=True)
class CutView:
    """One row of `cuts`.

    Parameters
    ----------
    title : of the row
    cut : weavecell.results.impact_shapes.Cut
    thickness : (plies,) [m]
    mirrored : whether the modelled part continues mirrored in x = 0
    projectile : (n, 2) [m] its outline, the foremost point at height 0
    """

    title: str
    cut: Cut
    thickness: np.ndarray
    mirrored: bool
    projectile: np.ndarray


def cuts(pyplot: Any, rows: Sequence[CutView], close_up: float, top: float | None = None) -> Any:
    """Cuts through the impact point, each whole and as a close-up, in which the lines are as thick as the plies.

    Parameters
    ----------
    rows : sequence of CutView
    close_up : [m] half the width of a close-up
    top : [m] highest point of all that is drawn; None takes that of the rows
    """
    figure, grid = pyplot.subplots(
        len(rows), 2, figsize=(10.4, 0.5 + 2.7 * len(rows)), squeeze=False, width_ratios=(1.15, 1), layout="none"
    )
    place(figure, 0.8, 0.15, 0.65, 0.4, across=0.45, down=0.6)
    top = max(foremost(row.cut) for row in rows) if top is None else top
    for axes_row, row in zip(grid, rows):
        cut, colours = row.cut, shades(len(row.thickness))
        for axes, near in zip(axes_row, (False, True)):
            body = row.projectile
            axes.fill(MM * body[:, 0], MM * (body[:, 1] + cut.nose), fc="#d5dae0", ec=STEEL, lw=1.0, zorder=1)
            for line, thickness, colour in zip(cut.lines, row.thickness, colours):
                for image in _images(line, row.mirrored):
                    axes.plot(*(MM * image.T), color=colour, lw=1.4, zorder=2, solid_joinstyle="round")
                    if near:
                        axes.fill(*(MM * _band(image, thickness).T), color=colour, alpha=0.45, lw=0, zorder=1.5)
            axes.grid(visible=near)
        reach = MM * max(float(np.nanmax(line[:, 0])) for line in cut.lines)
        axes_row[0].set(xlim=(-reach, reach), ylim=(-8, MM * top + 3), ylabel="z [mm]")
        axes_row[0].set_title(row.title, y=1.0)  # at a given height it is not moved above all else, which takes long
        axes_row[1].set_title("to scale", y=1.0, fontweight="normal", color=FAINT)
        high = MM * foremost(cut) + 0.8
        axes_row[1].set_aspect("equal")
        axes_row[1].set(xlim=(-MM * close_up, MM * close_up), ylim=(high - 1.3e3 * close_up, high))
    for axes in grid[-1]:
        axes.set_xlabel("x [mm]")
    return figure


def outline(projectile: np.ndarray) -> np.ndarray:
    """(n, 2) [m] convex outline of a surface (a, b, 3) as it is seen from the side, the foremost point at height 0."""
    from scipy.spatial import ConvexHull

    points = projectile[..., [0, 2]].reshape(-1, 2)
    found = points[ConvexHull(points).vertices]
    found[:, 1] -= found[:, 1].max()
    return found


def pieces(line: np.ndarray) -> list[np.ndarray]:
    """The pieces of a line that is cut where it is not a number; a lone point is none."""
    ends = np.flatnonzero(np.isnan(line[:, 0]))
    found = np.split(line, ends)
    found = [part[~np.isnan(part[:, 0])] for part in found]
    return [part for part in found if len(part) > 1]


def _images(line, mirrored):
    """The pieces of a line, and of its mirror image where there is one; a piece that begins at the mirror is joined."""
    found: list[np.ndarray] = []
    for part in pieces(line):
        if mirrored and part[0, 0] == 0:
            found.append(np.concatenate([[-1, 1] * part[:0:-1], part]))
        else:
            found += [part, [-1, 1] * part] if mirrored else [part]
    return found


def foremost(cut: Cut) -> float:
    """[m] highest point of the plies and the nose."""
    return max(cut.nose, *(float(part[:, 1].max()) for line in cut.lines for part in pieces(line)))


def _band(line, thickness):
    """Outline of a line as thick as its ply."""
    along = np.gradient(line, axis=0)
    normal = 0.5 * thickness * np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    return np.concatenate([line + normal, (line - normal)[::-1]])


def energies(pyplot: Any, runs: Any) -> Any:
    """Where the strike energy is at every instant, stacked, and below it the energy error, for each run.

    Parameters
    ----------
    runs : {title: (t, parts, strike_energy, error)}: [s], {name of ENERGIES: (n,)} [J], [J], (n,) [J]; parts that are
        absent or zero throughout are left out
    """
    across = min(2, len(runs))
    down = -(-len(runs) // across)
    size = (5.6, 5.8) if len(runs) == 1 else (10.4, 0.9 + 4.1 * down)
    figure, grid = pyplot.subplots(
        2 * down,
        across,
        figsize=size,
        squeeze=False,
        height_ratios=(3.2, 1) * down,
        sharex="col" if down == 1 else False,
        layout="none" if len(runs) == 1 else "constrained",
    )
    parts_of = [parts for _, parts, _, _ in runs.values()]
    known = [row for row in ENERGIES if any(np.any(parts.get(row[0], 0.0)) for parts in parts_of)]
    handles: Any = []
    for number, (title, (t, parts, strike_energy, error)) in enumerate(runs.items()):
        top, low = grid[2 * (number // across), number % across], grid[2 * (number // across) + 1, number % across]
        values = [np.maximum(parts.get(name, np.zeros_like(t)), 0.0) for name, _, _ in known]
        handles = top.stackplot(US * t, values, colors=[colour for *_, colour in known], lw=0.4, ec="white")
        top.axhline(strike_energy, color=INK, lw=1, ls=":")
        top.set(ylabel="energy [J]", title=title if len(runs) > 1 else "", ylim=(0, 1.04 * strike_energy))
        low.axhspan(-1, 1, color="#e8f5f0", lw=0)
        low.plot(US * t, 100 * error / strike_energy, color=INK, lw=1.6)
        reach = max(1.25, 1.15 * float(np.max(np.abs(100 * error / strike_energy))))
        low.set(xlabel="time after strike [µs]", ylabel="error [%]", ylim=(-reach, reach))
        for axes in (top, low):
            axes.set_xlim(0, US * float(t[-1]))
    for number in range(len(runs), down * across):
        for row in range(2):
            grid[2 * (number // across) + row, number % across].set_visible(False)
    labels, columns = [label for _, label, _ in known], 2 * across
    if len(runs) == 1:
        rows = -(-len(labels) // columns)
        place(figure, 0.9, 0.2, 0.75 + 0.215 * rows, 0.15, down=0.2)
    side = "lower center" if len(runs) == 1 else "outside lower center"
    figure.legend(handles, labels, loc=side, ncols=columns, fontsize=10)
    return figure
