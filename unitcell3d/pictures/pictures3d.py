"""The deformed crossover off screen: fibre strain of both yarns, and the contact pressure on the lower one.

pyvista draws the bodies and matplotlib the colour bars: VTK's own scalar bar parses its label format with std::regex,
which crashes in a process that has loaded dolfinx.
"""

from __future__ import annotations

import matplotlib
import numpy as np
import pyvista

from fabrics.checks import FilePath
from fabrics.files import replace_whole
from meshing.crossover import Crossover
from meshing.pictures import COLOURS, plotter
from unitcell3d.contact.surface_contact_kernels import pressure
from unitcell3d.model.crossover import Numerics
from unitcell3d.solver.history import History

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize

PANEL = (1200, 860)
SURFACE = "#dfe4ea"
STRAINS = LinearSegmentedColormap.from_list(
    "strain", ("#eceff2", "#b5d5e6", "#6bb0d0", "#2b83ba", "#1a4f92", "#0b1a4a")
)
PRESSURES = LinearSegmentedColormap.from_list("pressure", ("#f7f3ee", "#fdd49e", "#fc8d59", "#d7301f", "#7f0000"))


def deformed(history: History, crossover: Crossover, path: FilePath, numerics: Numerics | None = None) -> None:
    """Draw the last state of a history as a PNG: left the fibres by their strain, right the weft by contact pressure.

    A quarter crossover is completed by its mirror images. The pressure at a node is that of its own gap.

    Parameters
    ----------
    history : History
    crossover : the Crossover it was computed on
    path : of the .png file
    numerics : Numerics of the run
    """
    numerics = Numerics() if numerics is None else numerics
    x = 1e3 * (crossover.points + history.u)
    strain, pressures = _strains(crossover, x), _pressures(crossover, history, numerics)
    if np.isfinite(history.plates[-1]):
        state = f"plates {2e3 * history.plates[-1]:.4f} mm apart"
        forces = f"plate force {history.F_plate[-1].mean():.1f} N, F_c {history.F_c[-1]:.1f} N"
    else:
        state = f"d1 {1e3 * history.d1[-1]:.4f} mm, d2 {1e3 * history.d2[-1]:.4f} mm"
        forces = f"T1 {history.T1[-1]:.0f} N, T2 {history.T2[-1]:.0f} N, F_c {history.F_c[-1]:.1f} N"
    panels = (
        (_fibres, strain, STRAINS, "fibre strain [%]", f"{history.fabric}, {history.case}: {state}"),
        (_pressed, pressures, PRESSURES, "contact pressure on the weft [MPa]", forces),
    )
    figure, axes = pyplot.subplots(1, 2, figsize=(14, 5.6), layout="constrained")
    try:
        for axis, (draw, values, colours, label, title) in zip(axes, panels):
            limits = (0.0, float(values.max()) or 1.0)
            axis.imshow(_render(draw, crossover, x, values, colours, limits))
            axis.set(xticks=[], yticks=[])
            axis.spines[:].set_visible(False)
            axis.set_title(title, fontsize=12)
            figure.colorbar(
                ScalarMappable(Normalize(*limits), colours), ax=axis, orientation="horizontal", shrink=0.6, label=label
            )
        with replace_whole(path) as beside:
            figure.savefig(beside, dpi=130)
    finally:
        pyplot.close(figure)


def _strains(crossover, x):
    """Strain [%] at the nodes, the mean of the bars that meet there."""
    total, count = np.zeros(len(x)), np.zeros(len(x))
    for pairs in crossover.bars:
        now, then = (np.linalg.norm(p[pairs[:, 1]] - p[pairs[:, 0]], axis=1) for p in (x, 1e3 * crossover.points))
        for end in (0, 1):
            np.add.at(total, pairs[:, end], 100 * (now / then - 1))
            np.add.at(count, pairs[:, end], 1)
    return total / np.maximum(count, 1)


def _pressures(crossover, history, numerics):
    """Contact pressure [MPa] at the nodes of the weft's upper face, zero elsewhere."""
    values = np.zeros(len(crossover.points))
    values[crossover.grids[1][:, :, -1].ravel()] = [
        1e-6 * pressure(gap, numerics.penalty, numerics.toe)[0] for gap in history.gaps[1]
    ]
    return values


def _render(draw, crossover, x, values, colours, limits):
    scene = plotter(PANEL)
    try:
        images = [np.ones(3)]
        if crossover.domain == "quarter":
            images = [np.array([a, b, 1.0]) for a in (1, -1) for b in (1, -1)]
        for image in images:
            draw(scene, crossover, x * image, values, {"cmap": colours, "clim": limits, "show_scalar_bar": False})
        scene.enable_parallel_projection()
        scene.camera_position = [(-5.0, -7.0, 6.5), (0, 0, 0), (0, 0, 1)]
        scene.camera.parallel_scale = 0.6 * np.ptp(x[:, 0]) * (2 if len(images) == 4 else 1)
        scene.reset_camera_clipping_range()
        return _cropped(scene.screenshot(return_img=True))
    finally:
        scene.close()


def _cropped(image, margin=12):
    """The image without its white border."""
    rows, columns = (np.flatnonzero((image < 250).any(axis=(axis, 2))) for axis in (1, 0))
    return image[max(rows[0] - margin, 0) : rows[-1] + margin, max(columns[0] - margin, 0) : columns[-1] + margin]


def _fibres(scene, crossover, x, values, colouring):
    for yarn, name in enumerate(("warp", "weft")):
        grid = crossover.grids[yarn]
        for sheet in (grid[:, :, 0], grid[:, :, -1], grid[:, -1], grid[:, 0], grid[-1], grid[0]):
            scene.add_mesh(_sheet(sheet, x, values), scalars="values", ambient=0.75, diffuse=0.25, **colouring)
        lines = [pyvista.lines_from_points(x[grid[:, j, -1]]) for j in range(grid.shape[1])]
        scene.add_mesh(pyvista.merge(lines), color=COLOURS[name], line_width=1.8)


def _pressed(scene, crossover, x, values, colouring):
    grid = crossover.grids[1]
    for sheet in (grid[:, :, 0], grid[:, -1], grid[:, 0], grid[-1], grid[0]):
        scene.add_mesh(_sheet(sheet, x, values), color=SURFACE)
    scene.add_mesh(
        _sheet(grid[:, :, -1], x, values),
        scalars="values",
        show_edges=True,
        edge_color="#8a94a0",
        line_width=0.6,
        lighting=False,
        **colouring,
    )


def _sheet(nodes, x, values):
    """A structured sheet of nodes with their values."""
    sheet = pyvista.StructuredGrid(*(x[nodes][..., c] for c in range(3)))
    sheet["values"] = values[nodes].ravel(order="F")
    return sheet
