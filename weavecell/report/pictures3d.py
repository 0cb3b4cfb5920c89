"""A deformed panel and its projectile in space, seen from behind or from the front.

Images are drawn by matplotlib, from the farthest element to the nearest: VTK ends a process in which it finds no OpenGL
library, as on nodes of a cluster, and takes seconds for its first picture. A window has the same elements by pyvista.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from weavecell.report.pictures_style import RED, STEEL, tension_map

SIZE = (1120, 612)  # [pixels] width and height of an image
_CLOTH_DEPTH = 1e-3  # [m] by which the projectile lies behind fabric that it touches
_VIEWER = 0.55, -1.4, 0.95  # direction of the viewer behind the panel
_LIGHTS, _INTENSITIES = (
    np.array([(0.62, 0.58, 0.53), (-0.6, 0.1, 0.79)]),
    (0.475, 0.185),
)  # directions in these axes
_AMBIENT = 0.48


def panel(
    grid: Any,
    strength: FloatArray,
    body: FloatArray,
    mirrors: Sequence[bool],
    half_height: float,
    centre: Sequence[float] | FloatArray = (0.0, 0.0, 0.0),
    *,
    front: bool = False,
) -> np.ndarray:
    """The image (rows, columns, 3) of a panel in parallel projection.

    Parameters
    ----------
    grid, strength, mirrors : as of `coloured`
    body : (a, b, 3) [m] surface of the projectile
    half_height, centre : [m] of what is seen
    front : whether the panel is seen from the side that is struck
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure

    fabric = coloured(grid, strength, mirrors)
    quads, colours = fabric.points[fabric.cells.reshape(-1, 5)[:, 1:]], fabric["colour"] / 255
    steel = np.stack([body[:-1, :-1], body[1:, :-1], body[1:, 1:], body[:-1, 1:]], axis=2).reshape(
        -1, 4, 3
    )
    colours = np.vstack([colours, np.tile(to_rgb(STEEL), (len(steel), 1))])
    side, axes_of_view = -1 if front else 1, _axes(front)
    seen = (
        np.concatenate([quads, steel - side * _CLOTH_DEPTH * axes_of_view[2]]) - centre
    ) @ axes_of_view.T
    normal = np.cross(seen[:, 2] - seen[:, 0], seen[:, 3] - seen[:, 1])
    normal *= np.where(normal[:, 2:] < 0, -1, 1) / np.maximum(
        np.linalg.norm(normal, axis=1, keepdims=True), 1e-300
    )
    light = _AMBIENT + np.maximum(normal @ (_LIGHTS * (1, side, 1)).T, 0) @ _INTENSITIES
    order = np.argsort(seen[..., 2].mean(axis=1), kind="stable")
    paint = np.clip(colours * light[:, None], 0, 1)[order]
    figure = Figure(figsize=(SIZE[0] / 100, SIZE[1] / 100), dpi=100, facecolor="white")
    figure.set_layout_engine("none")
    axes = figure.add_axes((0, 0, 1, 1), xlim=np.array([-1, 1]) * half_height * SIZE[0] / SIZE[1])
    axes.set_ylim(-half_height, half_height)
    axes.axis("off")
    elements = PolyCollection(
        seen[order, :, :2], facecolors=paint, edgecolors=paint, linewidths=0.5
    )
    axes.add_collection(elements, autolim=False)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba())[..., :3]


def _axes(front):
    """(3, 3) axes of the view: to the right, up, towards the viewer."""
    x, y, z = _VIEWER
    viewer = np.array([x, y, -z if front else z]) / np.linalg.norm(_VIEWER)
    right = np.cross((0, 0, 1), viewer) / np.linalg.norm(np.cross((0, 0, 1), viewer))
    return np.array([right, np.cross(viewer, right), viewer])


def coloured(grid: Any, strength: FloatArray, mirrors: Sequence[bool]) -> Any:
    """The grid of the whole panel with its "colour" (m, 3) uint8: tension, broken yarns in vermilion.

    Elements without a yarn are left out.

    Parameters
    ----------
    grid : of `results.vtk.panel`, or read from its file
    strength : [N] of warp and weft, (2,) or (m, 2)
    mirrors : whether the panel is to be mirrored in the planes x = 0 and y = 0
    """
    from matplotlib.colors import to_rgb

    failed = np.asarray(grid["failed_yarns"])
    share = (np.column_stack([grid["tension_warp_N"], grid["tension_weft_N"]]) / strength).max(
        axis=1
    )
    paint = np.where(
        (failed == 1)[:, None], to_rgb(RED), tension_map()(np.clip(share, 0, 1))[:, :3]
    )
    whole = grid.copy(deep=True)
    whole.clear_data()
    whole["colour"] = np.round(255 * paint).astype(np.uint8)
    whole = whole.extract_cells(failed < 2)
    for normal, mirrored in zip(((1, 0, 0), (0, 1, 0)), mirrors):
        if mirrored:
            whole = whole.merge(whole.reflect(normal, point=(0, 0, 0)), merge_points=False)
    return whole


def width(nodes: FloatArray, mirrored: bool) -> float:
    """[m] of a panel along x, from the nodes (n, 3) of what is modelled."""
    return float(np.ptp(nodes[:, 0])) * (2 if mirrored else 1)


def tip(body: FloatArray) -> FloatArray:
    """(3,) [m] middle of the foremost 0.1 mm of a projectile's surface (a, b, 3)."""
    return body[body[..., 2] > body[..., 2].max() - 1e-4].mean(axis=0)
