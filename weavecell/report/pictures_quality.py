"""A picture of a mesh's quality: the scaled Jacobian of each hexahedron on the yarns, and how many
there are of each.

The scene is drawn by pyvista without a scalar bar and set into a figure by matplotlib.
"""

from __future__ import annotations

import numpy as np
import pyvista
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.files import replace_whole
from meshing.inputs import YARNS
from meshing.mesh import YarnMesh
from weavecell.report.pictures_figure import TitledFigure, say_doubts
from weavecell.report.pictures_mesh import COLOURS, INK, VIEWS, aim, plotter

# distinct to colour-blind readers, and in grey
MAP = "cividis"
STEPS = (
    0.01,
    0.02,
    0.05,
    0.1,
    0.2,
)  # of the scale and the bars: the least that gives at most `BARS`
BARS = 12
SCENE = (1500, 1000)


def picture(mesh: YarnMesh, path: FilePath) -> None:
    """Draw the quality of a `Crossover` or `Patch` as a PNG.

    Parameters
    ----------
    path : of the .png file, written whole or not at all
    """
    quality = mesh.scaled_jacobian
    step = next((step for step in STEPS if 1 - quality.min() <= BARS * step), STEPS[-1])
    low = min(step * np.floor(quality.min() / step), 1 - 2 * step)
    figure = TitledFigure(figsize=(16, 7), facecolor="white", layout="constrained")
    scene, bars = figure.subplots(1, 2, width_ratios=(1.9, 1))
    scene.imshow(_scene(mesh, quality, low))
    scene.set_axis_off()
    bar = figure.colorbar(
        ScalarMappable(Normalize(low, 1), MAP),
        ax=scene,
        orientation="horizontal",
        fraction=0.05,
        pad=0.01,
        aspect=40,
    )
    bar.set_label("scaled Jacobian", fontsize=13, color=INK)
    _bars(bars, mesh, quality, low, step)
    nx, ny, nz = (n - 1 for n in mesh.grids[0].shape)
    figure.suptitle(
        f"{mesh.fabric}: {counted(len(mesh.hexes), 'hexahedron')} ({nx} x {ny} x {nz} in each warp yarn), "
        f"worst scaled Jacobian {quality.min():.3f}",
        fontsize=15,
        color=INK,
        x=0.01,
        ha="left",
    )
    say_doubts(figure)
    with replace_whole(path) as beside:
        FigureCanvasAgg(figure).print_png(str(beside))


def _scene(mesh, quality, low):
    scene = plotter(SCENE)
    bodies = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: mesh.hexes}, mesh.points * 1e3)
    bodies.cell_data["quality"] = quality
    scene.add_mesh(
        bodies,
        scalars="quality",
        cmap=MAP,
        clim=(low, 1),
        show_edges=True,
        edge_color=INK,
        line_width=1.0,
        edge_opacity=0.5,
        ambient=0.7,
        diffuse=0.35,
        show_scalar_bar=False,
    )
    aim(scene, mesh.points * 1e3, VIEWS[getattr(mesh, "domain", "whole")], SCENE, foot=0.0)
    image = scene.screenshot(return_img=True)
    scene.close()
    return image


def _bars(axes, mesh, quality, low, step):
    """How many hexahedra of each family have which quality, and the worst of all."""
    family = np.array(mesh.families)[mesh.yarn]
    bounds = np.arange(low, 1 + step / 2, step)
    # the Jacobian of a brick may exceed 1 by rounding
    bounds[-1] = 1 + 1e-9
    counts = [np.histogram(quality[family == f], bounds)[0] for f in (0, 1)]
    shares = [100 * count / count.sum() for count in counts]
    for f, (name, share) in enumerate(zip(YARNS, shares)):
        axes.bar(
            bounds[:-1] + (0.27 + 0.46 * f) * step,
            share,
            0.42 * step,
            color=COLOURS[name],
            label=name,
            zorder=2,
        )
    worst = quality.min()
    axes.axvline(worst, color=INK, lw=1.4, ls="--", zorder=3)
    axes.text(
        worst,
        1.01,
        f"worst {worst:.3f}",
        transform=axes.get_xaxis_transform(),
        ha="left",
        fontsize=12,
        color=INK,
    )
    axes.set_xlabel("scaled Jacobian", fontsize=13, color=INK)
    axes.set_ylabel("share of the yarns' hexahedra [%]", fontsize=13, color=INK)
    axes.set_xlim(low - 0.2 * step, 1 + 0.2 * step)
    axes.legend(frameon=False, fontsize=13, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    axes.grid(axis="y", color="#e6e9ed", zorder=0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
