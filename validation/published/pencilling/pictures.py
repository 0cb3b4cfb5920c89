"""Pictures of the pencilling study, from its shots to PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from meshing.pictures_style import BLUE, GREEN, INK, ORANGE, RED, SKY

_COLOURS = (BLUE, SKY, RED, ORANGE, GREEN, INK)


def depths(shots: Any, path: Path) -> None:
    """Place of the projectile through time, and the profile of the crater's face, of all shots that have one."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    for (name, shot), colour in zip(shots.items(), _COLOURS):
        left.plot(1e6 * shot.t, 1e3 * shot.z, color=colour, lw=1.8, label=name)
        if shot.block is not None:
            order = np.argsort(shot.crater[:, 0])
            right.plot(1e3 * shot.crater[order, 0], 1e3 * shot.crater[order, 1], color=colour, lw=1.8, label=name)
    for axes in (left, right):
        axes.grid(alpha=0.25, lw=0.6)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    left.set(xlabel="time after strike [us]", ylabel="displacement of the projectile [mm]", title="penetration")
    left.set_xlim(left=0)
    left.set_ylim(bottom=0)
    left.legend(fontsize=9, frameon=False)
    right.set(xlabel="radius along the warp [mm]", ylabel="depth of the face [mm]", title="crater at the end")
    right.set_xlim(0, 45)
    right.invert_yaxis()
    _save(figure, path)


def craters(shots: Any, path: Path) -> None:
    """The blocks cut along the warp, mirrored, coloured by effective plastic strain, all to one scale."""
    blocks = {name: shot.block for name, shot in shots.items() if shot.block is not None}
    across = min(3, len(blocks))
    down = -(-len(blocks) // across)
    deepest = 1e3 * max(block.depth for block in blocks.values())
    reach = max(30.0, 1.1 * deepest)
    most = max(float(block.plastic[~block.gone].max()) for block in blocks.values())
    tall = 11 / across * (1.3 * deepest + 8) / (2 * reach)
    figure, grid = plt.subplots(
        down, across, figsize=(11, 0.6 + down * (0.8 * tall + 0.4)), squeeze=False, layout="constrained"
    )
    for axes in grid.flat[len(blocks) :]:
        axes.set_visible(False)
    for axes, (name, block) in zip(grid.flat, blocks.items()):
        x = block.nodes[block.bricks]
        cut = ~block.gone & (np.abs(x[:, [0, 1, 4, 5], 1]).max(axis=1) < 1e-9)
        corners = 1e3 * (x[cut][:, [0, 1, 5, 4]][..., [0, 2]] - np.array([0, block.face]))
        for side in (1, -1):
            faces = PolyCollection(corners * np.array([side, 1]), cmap="YlOrBr", ec="#6b5a45", lw=0.2)
            faces.set_array(block.plastic[cut])
            faces.set_clim(0, most)
            axes.add_collection(faces)
        axes.set(xlim=(-reach, reach), ylim=(1.3 * deepest + 2, -6), aspect="equal")
        axes.set_title(name, fontsize=10)
    figure.supxlabel("from the impact point [mm]", fontsize=10)
    figure.supylabel("depth [mm]", fontsize=10)
    figure.colorbar(faces, ax=grid, shrink=0.7, label="effective plastic strain")
    _save(figure, path)


def _save(figure, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
