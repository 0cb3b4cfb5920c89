"""A picture of a meshed crossover, drawn off screen: the two yarns in two colours, mesh lines, size
and quality."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from ctypes.util import find_library
from typing import Any

import numpy as np
import pyvista
from vtkmodules.vtkCommonCore import vtkLogger

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.files import replace_whole
from meshing.crossover import Crossover
from meshing.inputs import YARNS
from weavecell.report.pictures_style import INK
from weavecell.report.pictures_style import TINTS as COLOURS

WINDOW = (1600, 1000)
# share of the window's height that is kept for the caption
FOOT = 0.15
# share of the window's height that stays free around the crossover
MARGIN = 0.05
# Direction from the crossing to the camera. A quarter is seen from its cut faces, which show both
# sections.
VIEWS = {"quarter": (-1.0, -0.75, 0.62), "whole": (-0.75, -1.0, 0.8)}


def picture(crossover: Crossover, path: FilePath) -> None:
    """Draw the crossover as a PNG.

    Parameters
    ----------
    crossover : Crossover
    path : of the .png file, written whole or not at all
    """
    scene = plotter(WINDOW)
    for index, name in enumerate(YARNS):
        scene.add_mesh(
            _solid(crossover, index),
            color=COLOURS[name],
            show_edges=True,
            edge_color=INK,
            line_width=1.4,
            ambient=0.42,
            diffuse=0.72,
        )
    aim(scene, crossover.points * 1e3, VIEWS[crossover.domain], WINDOW)
    _caption(scene, crossover)
    save(scene, path)


def save(scene: Any, path: FilePath) -> None:
    """Write the picture of a scene, and close it."""
    try:
        with replace_whole(path) as beside:
            scene.screenshot(str(beside))
    finally:
        scene.close()


def can_draw() -> bool:
    """Tell whether there is a library that draws off screen: VTK ends a process in which it finds
    none."""
    if sys.platform != "linux":
        return True
    libraries = ["EGL", "OSMesa"]
    if os.environ.get("DISPLAY"):
        libraries.append("GL")
    return any(find_library(name) for name in libraries)


def plotter(
    window: Sequence[int],
    lights: Any = "light kit",
    off_screen: bool = True,
    smooth: bool = True,
) -> Any:
    """Make a scene on white, in a window or off screen.

    Parameters
    ----------
    smooth : whether edges are drawn smooth, which takes three times as long without a graphics card

    Raises
    ------
    InputError : there is no library to draw with
    """
    if not can_draw():
        raise InputError("no OpenGL library for pictures in space was found: install libegl1")
    vtkLogger.SetStderrVerbosity(
        vtkLogger.VERBOSITY_ERROR
    )  # else a warning for each kind of screen that is missing
    scene: Any = pyvista.Plotter(off_screen=off_screen, window_size=list(window), lighting=lights)
    scene.set_background("white")
    if smooth:
        scene.enable_anti_aliasing("ssaa")
    return scene


def _solid(crossover, index):
    """The hexahedra of one yarn, in millimetres."""
    hexes = crossover.hexes[crossover.yarn == index]
    return pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: hexes}, crossover.points * 1e3)


def aim(
    scene: Any,
    points: FloatArray,
    view: Sequence[float],
    window: Sequence[int],
    foot: float = FOOT,
    margin: float = MARGIN,
) -> None:
    """Set parallel projection along a view; the points [mm] fill the window above a foot kept free.

    Parameters
    ----------
    scene : of `plotter`
    points : (n, 3) [mm] that are to be seen
    view : direction from the points to the camera
    window : (width, height) [pixels]
    foot, margin : shares of the window's height that stay free below, and on every side
    """
    toward = np.array(view) / np.linalg.norm(view)
    right = np.cross((0, 0, 1), toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    seen = points @ np.stack([right, up], axis=1)
    left, bottom = seen.min(axis=0)
    far, top = seen.max(axis=0)
    free = 1 - 2 * margin
    tall = (top - bottom) / (free - foot)
    wide = (far - left) * window[1] / window[0] / free
    scale = max(tall, wide) / 2
    middle = (left + far) / 2 * right + ((bottom + top) / 2 - foot * scale) * up
    scene.enable_parallel_projection()
    scene.camera_position = [tuple(middle + 10 * scale * toward), tuple(middle), (0, 0, 1)]
    scene.camera.parallel_scale = scale
    scene.reset_camera_clipping_range()


def _caption(scene, crossover):
    nx, ny, nz = (n - 1 for n in crossover.grids[0].shape)
    cell = " x ".join(f"{2e3 * w:.3f}" for w in crossover.w)
    text = (
        f"{crossover.fabric}: {crossover.domain} crossover, section {crossover.sections[0].kind}, cell {cell} mm\n"
        f"{counted(len(crossover.hexes), 'hexahedron')} ({nx} x {ny} x {nz} in each yarn), "
        f"worst scaled Jacobian {crossover.min_scaled_jacobian:.3f}"
    )
    scene.add_text(text, position=(40, 30), font_size=16, color=INK)
    for row, (name, axis) in enumerate(zip(YARNS, "xy")):
        label = f"{name}, along {axis}"
        scene.add_text(
            label, position=(40, WINDOW[1] - 60 - 45 * row), font_size=16, color=COLOURS[name]
        )
