"""Pictures of the pencilling study, from its shots to PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, GREEN, INK, ORANGE, RED, SKY, STEEL, plots
from validation.published.pencilling.study import PROJECTILE

_COLOURS = (BLUE, SKY, RED, ORANGE, GREEN, INK)
_DASHES = ("-", "--", "-", "--", "-.", "-")


def depths(shots: Any, path: Path) -> None:
    """Displacement of the projectile through time, and the crater's face; the bare block, far deeper, on its own."""
    with plots() as pyplot:
        figure = compose_depths(pyplot, shots)
        with replace_whole(path) as beside:
            figure.savefig(beside, format="png", dpi=110)


def compose_depths(pyplot: Any, shots: Any) -> Any:
    """The figure of `depths`."""
    covered = {name: shot for name, shot in shots.items() if shot.block is not None}
    alone = {name: shot for name, shot in shots.items() if shot.block is None}
    widths = [1.25, 1, 0.7] if alone else [1.25, 1]
    figure, row = pyplot.subplots(1, len(widths), figsize=(12.4, 5.2), width_ratios=widths)
    left, right = row[:2]
    for (name, shot), colour, dash in zip(covered.items(), _COLOURS, _DASHES):
        left.plot(1e6 * shot.t, 1e3 * shot.z, dash, color=colour, label=name)
        order = np.argsort(shot.crater[:, 0])
        right.plot(1e3 * shot.crater[order, 0], 1e3 * shot.crater[order, 1], dash, color=colour)
    left.set(title="targets", ylabel="displacement of the projectile [mm]")
    right.set(title="crater at the end", xlabel="radius along the warp [mm]", ylabel="depth of the face [mm]")
    right.set_xlim(0, 45)
    right.invert_yaxis()
    for name, shot in alone.items():
        row[2].plot(1e6 * shot.t, 1e3 * shot.z, color=INK, label=name)
        row[2].set(title=name)
    for axes in (left, *row[2:]):
        axes.set(xlabel="time after strike [µs]", xlim=(0, None), ylim=(0, None))
    if covered:
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def craters(shots: Any, path: Path) -> None:
    """The blocks cut along the warp, mirrored, coloured by effective plastic strain, all to one scale, and the nose."""
    with plots() as pyplot:
        figure = compose_craters(pyplot, {name: shot for name, shot in shots.items() if shot.block is not None})
        with replace_whole(path) as beside:
            figure.savefig(beside, format="png", dpi=110)


def compose_craters(pyplot: Any, shots: Any) -> Any:
    """The figure of `craters`."""
    from matplotlib.collections import PolyCollection

    across = min(3, len(shots))
    down = -(-len(shots) // across)
    deepest = 1e3 * max(shot.block.depth for shot in shots.values())
    reach = max(30.0, 1.1 * deepest)
    most = max(float(shot.block.plastic[~shot.block.gone].max()) for shot in shots.values())
    tall = 10.6 / across * (1.3 * deepest + 14) / (2 * reach)
    figure, grid = pyplot.subplots(
        down, across, figsize=(11.4, 1.0 + down * (0.8 * tall + 0.5)), squeeze=False, sharex=True, sharey=True
    )
    for axes in grid.flat[len(shots) :]:
        axes.set_visible(False)
    for axes, (name, shot) in zip(grid.flat, shots.items()):
        block = shot.block
        x = block.nodes[block.bricks]
        cut = ~block.gone & (np.abs(x[:, [0, 1, 4, 5], 1]).max(axis=1) < 1e-9)
        corners = 1e3 * (x[cut][:, [0, 1, 5, 4]][..., [0, 2]] - np.array([0, block.face]))
        for side in (1, -1):
            faces = PolyCollection(corners * np.array([side, 1]), cmap="cividis_r", ec="#6b5a45", lw=0.2)
            faces.set_array(block.plastic[cut])
            faces.set_clim(0, most)
            axes.add_collection(faces)
        radius = 1e3 * PROJECTILE.radius
        nose = 1e3 * (float(shot.z[-1]) - block.face)
        axes.add_patch(pyplot.Rectangle((-radius, nose - 40), 2 * radius, 40, fc=STEEL, ec=INK, lw=0.6, zorder=3))
        axes.set(xlim=(-reach, reach), ylim=(1.3 * deepest + 2, -12), aspect="equal")
        axes.grid(False)
        axes.set_title(name, fontsize=10)
    for axes in grid[:, 0]:
        axes.set_ylabel("depth [mm]")
    for number, axes in enumerate(grid.flat[: len(shots)]):
        if number + across >= len(shots):
            axes.set_xlabel("from the impact point [mm]")
            axes.tick_params(labelbottom=True)
    bar = figure.colorbar(faces, ax=grid, shrink=0.7)
    bar.set_label("effective plastic strain [-]")
    bar.outline.set_visible(False)
    return figure
