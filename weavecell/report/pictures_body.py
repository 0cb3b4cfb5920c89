"""Plots of a projectile that deforms and of the block behind a panel, from results in SI units to
matplotlib figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures_style import BLUE, FAINT, INK, ORANGE, RED, STEEL
from weavecell.results.display import MM, US
from weavecell.results.keys import find_axis

if TYPE_CHECKING:
    from shellfabric.metal.body import MetalHistory
    from shellfabric.projectile.dynamics import BarHistory
    from shellfabric.projectile.turned import Turned

# [m] the cut is shown at least this far to either side
_AT = 24e-3
# [m] depth at which the picture of a block begins at the latest: a little above its face
_RIM = -4e-3


def bar(pyplot: Any, history: BarHistory) -> Any:
    """Draw the velocities of tip, tail and centre of mass, and how far tip and tail have moved
    against the centre.

    Parameters
    ----------
    history : shellfabric.projectile.dynamics.BarHistory
    """
    figure, (top, low) = pyplot.subplots(
        2, 1, figsize=(10.4, 6.2), sharex=True, height_ratios=(1.5, 1)
    )
    t = US * history.t
    top.plot(t, history.tip_velocity, color=RED, lw=1.0, label="tip")
    top.plot(t, history.tail_velocity, color=BLUE, lw=1.2, label="tail")
    top.plot(t, history.centre_velocity, color=INK, lw=2.0, label="centre of mass")
    top.set(ylabel=find_axis("tip_velocity", "bar").label)
    top.legend(loc="upper right")
    low.plot(t, US * (history.tip - history.centre), color=RED, lw=1.0, label="tip")
    low.plot(t, US * (history.tail - history.centre), color=BLUE, lw=1.2, label="tail")
    low.axhline(0.0, color=FAINT, lw=1)
    low.set(xlabel=find_axis("time", "bar").label, ylabel="from the centre [µm]")
    low.set_xlim(0, t[-1] if t.size else 1)
    return figure


def mushroom(pyplot: Any, body: MetalHistory) -> Any:
    """Draw a projectile of metal at rest and at the end, cut along its axis and coloured by effective
    plastic strain, its jacket framed, beside the velocities of tip, tail and centre of mass.

    Parameters
    ----------
    body : shellfabric.metal.body.MetalHistory
    """
    figure, (rest, end, side) = pyplot.subplots(
        1, 3, figsize=(10.4, 4.8), width_ratios=(1, 1, 1.4), layout="constrained"
    )
    wide = 0.6 * MM * max(body.width, body.width_at_rest)
    long = MM * body.length_at_rest
    most = max(float(body.plastic.max()), 0.1)
    shown = (
        (rest, "at rest", body.rest, 0 * body.plastic),
        (end, "at the end", body.places, body.plastic),
    )
    for axes, title, places, strain in shown:
        drawn = _cut_open(axes, places, body.corners, body.jacketed)
        for half in drawn:
            half.set(cmap="YlOrBr", clim=(0, most), array=strain)
        axes.set(xlim=(-wide, wide), ylim=(-1.05 * long, 0.05 * long), aspect="equal")
        axes.set(title=title, xlabel="r [mm]")
    rest.set(ylabel="along the axis [mm]")
    figure.colorbar(
        drawn[0],
        ax=(rest, end),
        label="plastic strain [-]",
        location="bottom",
        shrink=0.7,
        aspect=40,
    )
    t = US * body.t
    side.plot(t, body.tip_velocity, color=RED, lw=1.0, label="tip")
    side.plot(t, body.tail_velocity, color=BLUE, lw=1.2, label="tail")
    side.plot(t, body.centre_velocity, color=INK, lw=2.0, label="centre of mass")
    velocity = find_axis("tip_velocity", "metal").label
    side.set(xlabel=find_axis("time", "metal").label, ylabel=velocity)
    side.legend(loc="best")
    return figure


def drawings(pyplot: Any, bodies: Mapping[str, tuple[Turned, str, str]]) -> Any:
    """Draw projectiles of metal at rest in one scale, cut along their axes, with mesh and measures.

    Parameters
    ----------
    bodies : {title: (Turned, name of the metal of its core, of its jacket or "")}
    """
    from matplotlib.patches import Patch

    drawn = [body for body, _, _ in bodies.values()]
    wide = MM * max(body.radius for body in drawn)
    long = MM * max(body.length for body in drawn)
    tall = 1.7 + 2.5 * 1.1 * long / (2.6 * wide)
    figure, all_axes = pyplot.subplots(1, len(bodies), figsize=(3.4 * len(bodies), tall))
    for axes, (title, (body, core, jacket)) in zip(np.ravel(all_axes), bodies.items()):
        for half in _cut_open(axes, body.places, body.corners, body.jacketed):
            half.set_facecolor([ORANGE if jacketed else STEEL for jacketed in body.jacketed])
            half.set_edgecolor("white")
        keys = [Patch(color=STEEL, label=core)]
        if jacket:
            keys.append(Patch(color=ORANGE, label=f"{jacket}, {MM * body.jacket_thickness:.2g} mm"))
        axes.set(xlim=(-1.3 * wide, 1.3 * wide), ylim=(-1.05 * long, 0.05 * long), aspect="equal")
        axes.set(xlabel="r [mm]", ylabel="along the axis [mm]")
        measures = f"{2 * MM * body.radius:.4g} x {MM * body.length:.4g} mm"
        axes.set_title(f"{title}\n{measures}, {1e3 * body.drawn_mass:.4g} g", fontsize=12)
        axes.legend(handles=keys, loc="upper center", bbox_to_anchor=(0.5, -0.13))
    return figure


def _cut_open(axes, places, corners, jacketed):
    """Add the elements of a body of metal to `axes`, cut along its axis, its tip at 0 and above; the
    two halves, with the elements of the jacket framed."""
    from matplotlib.collections import PolyCollection

    elements = MM * places[corners]
    elements[..., 1] -= MM * places[:, 1].max()
    halves = []
    for way in (1, -1):
        half = PolyCollection(elements * [way, 1], lw=0.4)
        half.set_edgecolor([INK if framed else FAINT for framed in jacketed])
        axes.add_collection(half)
        halves.append(half)
    return halves


def crater(pyplot: Any, blocks: Any) -> Any:
    """Draw blocks cut along the warp through the impact point, mirrored, coloured by effective
    plastic strain.

    Parameters
    ----------
    blocks : {title: shellfabric.block.coupling.BackingResult}
    """
    from matplotlib.collections import PolyCollection

    deepest = max(block.depth for block in blocks.values())
    reach = max(_AT, 1.2 * deepest, 2.5 * max(block.half_width for block in blocks.values()))
    # the clay that the dent has driven out stands above the face
    rim = min(_RIM, *(1.1 * float(block.crater[:, 1].min()) for block in blocks.values()))
    across = min(3, len(blocks))
    down = -(-len(blocks) // across)
    tall = (1.35 * deepest + 2e-3 - rim) / (2 * reach) * 10.4 / across
    figure, grid = pyplot.subplots(
        down,
        across,
        figsize=(10.4, 0.8 + down * (0.84 * tall + 0.45)),
        squeeze=False,
    )
    for axes in grid.flat[len(blocks) :]:
        axes.set_visible(False)
    most = max(float(block.plastic[~block.gone].max(initial=0.1)) for block in blocks.values())
    for axes, (title, block) in zip(grid.flat, blocks.items()):
        x = block.nodes[block.bricks]
        cut = ~block.gone & (np.abs(x[:, [0, 1, 4, 5], 1]).max(axis=1) < 1e-9)
        corners = MM * x[cut][:, [0, 1, 5, 4]][..., [0, 2]] - np.array([0, MM * block.face])
        for side in (1, -1) if block.share < 1 else (1,):
            faces = PolyCollection(
                corners * np.array([side, 1]), cmap="YlOrBr", ec="#6b5a45", lw=0.25
            )
            faces.set_array(block.plastic[cut])
            faces.set_clim(0, most)
            axes.add_collection(faces)
        for side in (1, -1):
            axes.plot(side * MM * block.crater[:, 0], MM * block.crater[:, 1], color=INK, lw=1.4)
        axes.set(
            xlim=(-MM * reach, MM * reach),
            ylim=(MM * (1.35 * deepest + 2e-3), MM * rim),
            title=title,
            aspect="equal",
        )
        axes.grid(False)
    figure.supxlabel("from the impact point [mm]", fontsize=12)
    figure.supylabel("depth [mm]", fontsize=12)
    bar_ = figure.colorbar(faces, ax=grid, shrink=0.8, pad=0.01, label="effective plastic strain")
    bar_.outline.set_visible(False)
    return figure
