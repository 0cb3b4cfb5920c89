"""Plots of one impact, on one ply or on a pack: histories, cuts, and where the energy is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures import list_bands, place
from weavecell.report.pictures_style import CLAY, FAINT, INK, STEEL
from weavecell.results.display import MM, US
from weavecell.results.keys import find_axis

if TYPE_CHECKING:
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Cut

# colours of plies from the front, dark, to the rear, of the first fabric of a pack and the others
_RAMPS = (
    ("#0b1a4a", "#1a4f92", "#2b83ba", "#6bb0d0", "#9fcbe0"),
    ("#6b2600", "#b34700", "#e07a1f", "#f3a95c", "#f8cb98"),
    ("#00382b", "#006b52", "#009e73", "#5cc4a4", "#a3dfcd"),
    ("#4a1236", "#8a2f66", "#c0608f", "#d892b5", "#ecc3d8"),
)
_MOST_NAMED = 6  # plies of one fabric in a legend
_IN_A_ROW = 3, 2  # names in a row of a legend: of plies alone, with their fabrics


def histories(pyplot: Any, record: ImpactRecord) -> Any:
    """Draw velocity of the projectile, deflection of the back face and contact force over time, one
    below the other."""
    figure, (top, middle, low) = pyplot.subplots(
        3, 1, figsize=(5.6, 12.4), sharex=True, height_ratios=(1.2, 1, 1), layout="none"
    )
    place(figure, 1.05, 0.2, 0.65, 0.15, down=0.2)
    time, velocity, deflection, force = (
        find_axis(name, "histories") for name in ("time", "velocity", "deflection", "contact_force")
    )
    t = time.factor * record.time
    top.plot(t, velocity.factor * record.velocity)
    top.axhline(0.0, color=FAINT, lw=1)
    top.set_ylabel(velocity.label)
    nose = deflection.factor * record.nose_position
    middle.plot(t, deflection.factor * record.deflection)
    middle.plot(t, nose, color=STEEL, ls=":", label="nose of the projectile")
    middle.set_ylabel(deflection.label)
    middle.set_ylim(0, 1.35 * deflection.factor * float(np.nanmax(record.deflection)) + 0.1)
    middle.legend(loc="upper left", fontsize=10)
    low.plot(t, force.factor * record.contact_force, lw=1.4)
    low.set(xlabel=time.label, ylabel=force.label, xlim=(0, float(t[-1])))
    low.set_ylim(bottom=min(0.0, low.get_ylim()[0]))
    return figure


def plies(pyplot: Any, record: ImpactRecord) -> Any:
    """Draw deflection, force of the nose and energy of each ply over time, one below the other."""
    figure, grid = pyplot.subplots(3, 1, figsize=(5.6, 9), sharex=True)
    time = find_axis("time", "histories")
    fabrics = record.ply_fabrics
    colours = shades(fabrics or ("",) * record.count)
    t = time.factor * record.time
    for axes, name in zip(grid, ("deflection", "push", "energy")):
        label, factor = find_axis(name, "ply_histories")
        for k, colour in enumerate(colours):
            values = factor * record.plies[name][:, k]
            axes.plot(t, values, color=colour, lw=1.4, label=record.ply_name(k))
        axes.set_ylabel(label)
    grid[-1].set(xlabel=time.label, xlim=(0, float(t[-1])))
    # of many plies a few are named
    lines, names = grid[0].get_legend_handles_labels()
    named = _named_plies(fabrics or ("",) * record.count)
    columns = _IN_A_ROW[bool(fabrics)]
    grid[0].legend(
        [lines[k] for k in named],
        [names[k] for k in named],
        ncols=columns,
        fontsize=10,
        loc="upper left",
    )
    low, high = grid[0].get_ylim()
    # the legend stands above the curves
    rows = -(-len(named) // columns)
    grid[0].set_ylim(low, low + (1.12 + 0.16 * rows) * (high - low))
    return figure


def _named_plies(fabrics):
    """Numbers of the plies that a legend names: some of many, of each fabric at least the first and the
    last."""
    every = -(-len(fabrics) // _MOST_NAMED)
    named = set(range(0, len(fabrics), every))
    if len(set(fabrics)) > 1:
        for plies in _plies_of(fabrics).values():
            named |= {plies[0], plies[-1]}
    return sorted(named)


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
    fabrics : (plies,) names, of a pack of several fabrics
    """

    title: str
    cut: Cut
    thickness: np.ndarray
    mirrored: bool
    projectile: np.ndarray
    fabrics: tuple[str, ...] = ()

    @property
    def colours(self) -> list:
        """Of each ply."""
        return shades(self.fabrics or ("",) * len(self.thickness))


def cuts(pyplot: Any, rows: Sequence[CutView], close_up: float, top: float | None = None) -> Any:
    """Draw cuts through the impact point, each whole and as a close-up, in which the lines are as
    thick as the plies.

    Parameters
    ----------
    rows : sequence of CutView
    close_up : [m] half the width of a close-up
    top : [m] highest point of all that is drawn; None takes that of the rows
    """
    figure, grid = pyplot.subplots(
        len(rows),
        2,
        figsize=(5.6, 0.5 + 2.1 * len(rows)),
        squeeze=False,
        layout="none",
    )
    fabrics = rows[0].fabrics
    below = 0.35 if fabrics else 0.0
    figure.set_figheight(figure.get_figheight() + below)
    place(figure, 0.8, 0.15, 0.65 + below, 0.4, across=0.45, down=0.6)
    if fabrics:
        colours = rows[0].colours
        handles = [_swatch(colours, name, plies) for name, plies in _plies_of(fabrics).items()]
        figure.legend(handles=handles, loc="lower center", ncols=len(handles), fontsize=10)
    if top is None:
        top = max(foremost(row.cut) for row in rows)
    for axes_row, row in zip(grid, rows):
        whole, near = axes_row
        whole.set_ylabel("z [mm]")
        near.set_title("to scale", y=1.0, fontweight="normal", color=FAINT)
        near.set_aspect("equal")
        for axes in axes_row:
            axes.grid(visible=axes is near)
            axes.locator_params(nbins=5)
        fill_cut(whole, near, row, close_up, top)
    for axes in grid[-1]:
        axes.set_xlabel("x [mm]")
    return figure


def fill_cut(whole: Any, near: Any, row: CutView, close_up: float, top: float) -> None:
    """Draw a cut on a pair of axes of `cuts`, in place of what they show: to make axes takes longer
    than to draw what is on them."""
    cut = row.cut
    body = row.projectile + np.array([0.0, cut.nose_position])
    for axes in (whole, near):
        for artist in (*axes.lines, *axes.patches):
            artist.remove()
        axes.fill(*(MM * body.T), fc="#d5dae0", ec=STEEL, lw=1.0, zorder=1)
        for line, thickness, colour in zip(cut.lines, row.thickness, row.colours):
            for image in _images(line, row.mirrored):
                axes.plot(*(MM * image.T), color=colour, lw=1.4, zorder=2, solid_joinstyle="round")
                if axes is near:
                    band = MM * _band(image, thickness)
                    axes.fill(*band.T, color=colour, alpha=0.45, lw=0, zorder=1.5)
    reach = MM * max(float(np.nanmax(line[:, 0])) for line in cut.lines)
    if cut.face.size:
        _fill_block(whole, near, cut.face_line, row.mirrored)
    whole.set(xlim=(-reach, reach), ylim=(-8, MM * top + 3))
    # at a given height it is not moved above all else, which takes long
    whole.set_title(row.title, y=1.0)
    high = MM * foremost(cut) + 0.8
    near.set(xlim=(-MM * close_up, MM * close_up), ylim=(high - 1.3e3 * close_up, high))


def _fill_block(whole, near, line, mirrored):
    """Draw the block below its face, a line (n, 2) [m], as far down as a picture shows."""
    if mirrored:
        line = np.concatenate([[-1, 1] * line[:0:-1], line])
    below = np.full(2, 1.0)  # [m], deeper than any picture
    ends = np.column_stack([line[[-1, 0], 0], below])
    for axes in (whole, near):
        axes.fill(*(MM * np.concatenate([line, ends]).T), fc=CLAY, lw=0, zorder=0.5)
        axes.plot(*(MM * line.T), color="#7d5f38", lw=1.0, zorder=0.6)


def outline(projectile: np.ndarray) -> np.ndarray:
    """Compute the convex outline (n, 2) [m] of a surface (a, b, 3) as it is seen from the side, the
    foremost point at height 0."""
    from scipy.spatial import ConvexHull

    points = projectile[..., [0, 2]].reshape(-1, 2)
    hull = points[ConvexHull(points).vertices]
    hull[:, 1] -= hull[:, 1].max()
    return hull


def pieces(line: np.ndarray) -> list[np.ndarray]:
    """Split a line that is cut where it is not a number into its pieces; a lone point is none."""
    ends = np.flatnonzero(np.isnan(line[:, 0]))
    cut = np.split(line, ends)
    cut = [part[~np.isnan(part[:, 0])] for part in cut]
    return [part for part in cut if len(part) > 1]


def _images(line, mirrored):
    """The pieces of a line, and of its mirror image where there is one; a piece that begins at the
    mirror is joined."""
    drawn: list[np.ndarray] = []
    for part in pieces(line):
        if mirrored and part[0, 0] == 0:
            drawn.append(np.concatenate([[-1, 1] * part[:0:-1], part]))
        else:
            drawn += [part, [-1, 1] * part] if mirrored else [part]
    return drawn


def foremost(cut: Cut) -> float:
    """Find the highest point [m] of the plies, the nose and the dent of a block."""
    lines = [float(part[:, 1].max()) for line in cut.lines for part in pieces(line)]
    return max(cut.nose_position, *lines, cut.face_line[:, 1].max(initial=-np.inf))


def _band(line, thickness):
    """Outline of a line as thick as its ply."""
    along = np.gradient(line, axis=0)
    normal = (
        0.5 * thickness * np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    )
    return np.concatenate([line + normal, (line - normal)[::-1]])


def parts(energies: Mapping[str, Any], recoil: float = 0.0) -> dict[str, Any]:
    """Add up energies as they are drawn: membrane with the work that no yarn stores; all contacts,
    all friction; `recoil` [J] of cut yarns, by its own name, for the last of the viscous energy."""
    drawn = dict(energies)
    viscous = energies["viscous"]
    drawn["viscous"] = np.minimum(viscous, viscous[-1] - recoil)
    drawn["recoil_of_cut_yarns"] = viscous - drawn["viscous"]
    drawn["yarn_strain"] = energies["yarn_strain"] + energies.get("formulation_residual", 0.0)
    for name in ("contact", "friction"):
        drawn[name] = (
            energies.get(name, 0.0) + energies.get(f"ply_{name}", 0.0) + 0 * drawn["yarn_strain"]
        )
    return drawn


def energies(pyplot: Any, record: ImpactRecord) -> Any:
    """Draw where the strike energy is at every instant, stacked, and below it the energy error;
    parts that are absent or zero throughout are left out."""
    figure, (top, low) = pyplot.subplots(
        2, 1, figsize=(5.6, 5.8), height_ratios=(3.2, 1), sharex=True, layout="none"
    )
    t = US * record.time
    error = 100 * record.energies["error"] / record.strike_energy
    drawn = parts(record.energies, record.recoil_of_cut_yarns)
    known = [row for row in list_bands(drawn) if np.any(drawn.get(row[0], 0.0))]
    values = [np.maximum(drawn[name], 0.0) for name, _, _ in known]
    handles = top.stackplot(t, values, colors=[colour for *_, colour in known], lw=0.4, ec="white")
    top.axhline(record.strike_energy, color=INK, lw=1, ls=":")
    top.set(ylabel="energy [J]", ylim=(0, 1.04 * record.strike_energy))
    low.axhspan(-1, 1, color="#e8f5f0", lw=0)
    low.plot(t, error, color=INK, lw=1.6)
    reach = max(1.25, 1.15 * float(np.max(np.abs(error))))
    low.set(
        xlabel=find_axis("time", "histories").label,
        ylabel="error [%]",
        ylim=(-reach, reach),
        xlim=(0, float(t[-1])),
    )
    place(figure, 0.9, 0.2, 0.75 + 0.215 * -(-len(known) // 2), 0.15, down=0.2)
    figure.legend(
        handles, [label for _, label, _ in known], loc="lower center", ncols=2, fontsize=10
    )
    return figure


def shades(fabrics: Sequence[str]) -> list:
    """Choose the colour of each ply of a pack, given the name of its fabric: one ramp for each fabric,
    in even steps from its front ply to its rear one."""
    from matplotlib.colors import LinearSegmentedColormap

    colours: list = [None] * len(fabrics)
    for number, plies in enumerate(_plies_of(fabrics).values()):
        steps = _RAMPS[number % len(_RAMPS)]
        ramp = LinearSegmentedColormap.from_list("plies", steps)
        for n, k in enumerate(plies):
            colours[k] = ramp(n / max(1, len(plies) - 1))
    return colours


def _plies_of(fabrics):
    """{name of a fabric: its plies from the front, the first of the pack is 0}, in their order."""
    plies = {name: [] for name in fabrics}
    for k, name in enumerate(fabrics):
        plies[name].append(k)
    return plies


def _swatch(colours, name, plies):
    """The entry of a legend for a fabric of a pack: a ply near the middle of its own has the colour
    that it is known by."""
    from matplotlib.patches import Patch

    where = "ply" if len(plies) == 1 else "plies"
    numbers = ", ".join(_spans(plies))
    return Patch(color=colours[plies[len(plies) // 2]], label=f"{name}, {where} {numbers}")


def _spans(plies):
    """Numbers of plies from 1, those that follow each other as "2 to 5"."""
    spans = []
    for k in plies:
        if spans and spans[-1][1] == k:
            spans[-1][1] = k + 1
        else:
            spans.append([k + 1, k + 1])
    return [f"{first}" if first == last else f"{first} to {last}" for first, last in spans]
