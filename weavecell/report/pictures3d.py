"""Pictures of meshes, by pyvista, and of panels in motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from meshing.pictures_style import RED, STEEL, tension_map
from weavecell.report.pictures_painter import SIZE, Camera, paint

_HALF_HEIGHT = 0.6  # [reach] of a close-up
CLOTH_DEPTH = 1.0  # [mm] by which the projectile is drawn behind fabric that it touches


def new_plotter(off_screen: bool = True, size: tuple[int, int] = (1500, 820)) -> Any:
    """A plotter in this project's look: white, with even light."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # it warns once for each kind of screen it does not find
    plotter: Any = pyvista.Plotter(off_screen=off_screen, window_size=list(size), lighting="three lights")
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def pixels_per_mm(reach: float) -> float:
    """Of the image of a close-up of half the width `reach` [m], across the view."""
    return SIZE[1] / (2 * _HALF_HEIGHT * 1e3 * reach)


def _cropped(image):
    """What is drawn of an image on white."""
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
    camera: Camera | None = None,
    *,
    top_share: float = 1.0,
    open_quarter: bool = False,
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
    camera : Camera of a view of its own, in mm, in place of these two; nothing is cropped
    top_share : [-] at which the colours of tension end
    open_quarter : whether the quarter of the fabric in front of the projectile is left out

    Returns
    -------
    image : (rows, columns, 3)
    """
    from matplotlib.colors import to_rgb

    nodes, body = 1e3 * np.asarray(nodes, float), 1e3 * np.asarray(projectile, float)
    share, failed = np.asarray(share, float), np.asarray(failed)
    drawn = failed < 2
    colours = np.where((failed == 1)[:, None], to_rgb(RED), tension_map()(np.clip(share / top_share, 0.0, 1.0))[:, :3])
    cloth, paints = nodes[np.asarray(quads)[drawn]], colours[drawn]
    for axis, mirrored in enumerate(mirrors):
        if mirrored:
            image = cloth.copy()
            image[..., axis] *= -1
            cloth, paints = np.concatenate([cloth, image]), np.concatenate([paints, paints])
    corners = np.stack([body[:-1, :-1], body[1:, :-1], body[1:, 1:], body[:-1, 1:]], axis=2).reshape(-1, 4, 3)
    span = float(np.ptp(nodes[:, 0])) * (2 if mirrors[0] else 1)
    top = float(nodes[:, 2].max()) if reach else 0.0
    front = body[body[..., 2] > body[..., 2].max() - 0.1]  # where a close-up looks
    x, y = front.mean(axis=0)[:2] if reach else (0.0, 0.0)
    if open_quarter:
        middle = cloth.mean(axis=1)
        shown = (middle[:, 0] < x) | (middle[:, 1] > y)
        cloth, paints = cloth[shown], paints[shown]
    position, target = (x + 0.55 * span, y - 1.4 * span, top + 0.95 * span), (x, y, top)
    view = camera or Camera(position, target, _HALF_HEIGHT * 1e3 * reach if reach else 0.48 * span)
    steel, behind = np.tile(to_rgb(STEEL), (len(corners), 1)), np.zeros(len(cloth) + len(corners))
    behind[len(cloth) :] = CLOTH_DEPTH
    image = paint(np.concatenate([cloth, corners]), np.concatenate([paints, steel]), view, further=behind)
    return image if reach or camera else _cropped(image)
