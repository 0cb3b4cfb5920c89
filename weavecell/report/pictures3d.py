"""Pictures of meshes and panels, drawn off screen by pyvista."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from meshing.pictures_style import RED, STEEL, tension_map
from weavecell.results.paraview import panel_grid


def new_plotter(off_screen: bool = True, size: tuple[int, int] = (1500, 820)) -> Any:
    """A plotter in this project's look: white, with even light."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # it warns once for each kind of screen it does not find
    plotter: Any = pyvista.Plotter(off_screen=off_screen, window_size=list(size), lighting="three lights")
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def plotter_image(plotter: Any, crop: bool = True) -> np.ndarray:
    """The plotter's picture as an array (rows, columns, 3), cropped to what is drawn."""
    image = plotter.screenshot(return_img=True)
    plotter.close()
    if not crop:
        return image
    drawn = np.any(image < 250, axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if rows.size == 0:
        return image
    return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def panel(
    nodes: np.ndarray,
    quads: np.ndarray,
    share: np.ndarray,
    failed: np.ndarray,
    projectile: np.ndarray,
    mirrors: Sequence[bool],
    reach: float | None = None,
) -> np.ndarray:
    """A deformed panel seen from behind: tension in colour, broken yarns in vermilion, cells without a yarn left out.

    Parameters
    ----------
    nodes : (n, 3) [m]
    quads : (m, 4)
    share : (m,) the higher of the two yarn tensions over its strength [-]
    failed : (m,) how many of the two yarns have failed, 0 to 2
    projectile : (a, b, 3) [m] surface of the projectile
    mirrors : (x, y) whether the panel is to be mirrored in the planes x = 0 and y = 0
    reach : [m] half the width of a close-up of the impact point; the whole panel if not given

    Returns
    -------
    image : (rows, columns, 3)
    """
    import pyvista

    plotter = new_plotter()
    grid = panel_grid(1e3 * np.asarray(nodes), quads)
    grid.cell_data["tension"], grid.cell_data["failed"] = np.asarray(share, float), np.asarray(failed)
    parts = [grid]
    for mirrored, normal in zip(mirrors, ((1, 0, 0), (0, 1, 0))):
        parts += [part.reflect(normal) for part in parts] if mirrored else []
    for part in parts:
        whole, torn = (part.extract_cells(np.flatnonzero(part.cell_data["failed"] == count)) for count in (0, 1))
        if whole.n_cells:
            plotter.add_mesh(
                whole,
                scalars="tension",
                cmap=tension_map(),
                clim=(0, 1),
                show_scalar_bar=False,
                ambient=0.45,
                diffuse=0.6,
            )
        if torn.n_cells:
            plotter.add_mesh(torn, color=RED, ambient=0.6)
    body = pyvista.StructuredGrid(*np.moveaxis(1e3 * projectile, -1, 0))
    plotter.add_mesh(body, color=STEEL, ambient=0.3, specular=0.3)
    plotter.enable_parallel_projection()
    span = 1e3 * float(np.ptp(np.asarray(nodes)[:, 0])) * (2 if mirrors[0] else 1)
    top = 1e3 * float(np.asarray(nodes)[:, 2].max()) if reach else 0.0
    front = projectile[projectile[..., 2] > projectile[..., 2].max() - 1e-4]  # where a close-up looks
    x, y = 1e3 * front.mean(axis=0)[:2] if reach else (0.0, 0.0)
    plotter.camera_position = [(x + 0.55 * span, y - 1.4 * span, top + 0.95 * span), (x, y, top), (0, 0, 1)]
    plotter.camera.parallel_scale = 0.6e3 * reach if reach else 0.48 * span
    return plotter_image(plotter, crop=reach is None)
