"""A deformed panel and its projectile in space, seen from behind or from the front, drawn off
screen by pyvista.

Without a display VTK draws by EGL. There is no scalar bar: VTK's aborts a process that has loaded
dolfinx.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from weavecell.report.pictures_style import CLAY, RED, STEEL, tension_map

# [pixels] width and height of an image
# pixels of a picture of a series
SIZE = (1120, 612)
# of one that a page shows, as large as it has it
STILL = (844, 461)
# The projectile is drawn this far [m] behind where it is: fabric that it touches would else be
# drawn inside of it.
_CLOTH_DEPTH = 1e-3
# direction from the panel to the viewer, who stands behind it
_VIEWER = np.array([0.55, -1.4, 0.95])
# [m] distance of the camera, larger than any panel; a parallel projection does not depend on it
_DISTANCE = 2.0
_MARGIN = 1.04  # of the height in which a panel is seen whole


def panel(
    grid: Any,
    strength: FloatArray,
    body: FloatArray,
    mirrors: Sequence[bool],
    half_height: float,
    centre: Sequence[float] | FloatArray = (0.0, 0.0, 0.0),
    *,
    front: bool = False,
    face: FloatArray | None = None,
    still: bool = False,
) -> np.ndarray:
    """Draw a panel in parallel projection: the image (rows, columns, 3).

    Parameters
    ----------
    grid, strength, mirrors : as in `colour_grid`
    body : (a, b, 3) [m] surface of the projectile
    half_height, centre : [m] of what is seen
    front : whether the panel is seen from the side that is struck
    face : (a, b, 3) [m] of `open_faces`, of a block behind the panel
    still : whether it is one picture of a page, which shows it at half of its size and so smooth
    """
    import pyvista

    from weavecell.report.pictures_mesh import plotter

    viewer = _toward_viewer(front)
    scene = plotter(STILL if still else SIZE, "three lights", smooth=not still)
    try:
        fabric = colour_grid(grid, strength, mirrors)
        scene.add_mesh(fabric, scalars="colour", rgb=True, ambient=0.5, diffuse=0.5)
        if face is not None and face.size:
            clay = pyvista.StructuredGrid(*np.moveaxis(face, -1, 0))
            scene.add_mesh(clay, color=CLAY, ambient=0.4, diffuse=0.6)
        surface = body - _CLOTH_DEPTH * viewer
        projectile = pyvista.StructuredGrid(*np.moveaxis(surface, -1, 0))
        scene.add_mesh(projectile, color=STEEL, ambient=0.3, diffuse=0.8, specular=0.3)
        scene.enable_parallel_projection()
        focus = np.asarray(centre, float)
        scene.camera_position = [focus + _DISTANCE * viewer, focus, (0, 0, 1)]
        scene.camera.parallel_scale = half_height
        scene.reset_camera_clipping_range()
        return scene.screenshot(return_img=True)
    finally:
        scene.close()


def _toward_viewer(front):
    """Direction from the panel to the viewer, who stands before or behind it."""
    viewer = _VIEWER / np.linalg.norm(_VIEWER)
    return viewer * [1, 1, -1] if front else viewer


def reach(
    nodes: FloatArray,
    mirrors: Sequence[bool],
    centre: Sequence[float] | FloatArray,
    *,
    front: bool = False,
) -> float:
    """Compute the least half height [m] of a picture of `panel` in which nodes (n, 3) [m] and their
    images in the planes of symmetry are seen; parameters as there."""
    viewer = _toward_viewer(front)
    right = np.cross((0.0, 0.0, 1.0), viewer)
    right /= np.linalg.norm(right)
    up = np.cross(viewer, right) * SIZE[0] / SIZE[1]
    found = 0.0
    for signs in product(*((1, -1) if mirrored else (1,) for mirrored in mirrors)):
        apart = nodes * [*signs, 1] - np.asarray(centre)
        found = max(found, float(np.abs(apart @ np.stack([right, up], axis=1)).max()))
    return _MARGIN * found * SIZE[1] / SIZE[0]


def colour_grid(grid: Any, strength: FloatArray, mirrors: Sequence[bool]) -> Any:
    """Make the grid of the whole panel with its "colour" (m, 3) uint8: tension, broken yarns in
    vermilion.

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


def open_faces(
    faces: Sequence[FloatArray], mirrors: Sequence[bool], reach: float
) -> list[FloatArray]:
    """Return what is drawn of the face of a block: the half of it at y > 0, so that the fabric
    before the other half is seen from behind too, and no further than the fabric.

    Parameters
    ----------
    faces : (nx, ny, 3) [m] nodes of what is modelled, from the first along x and y to the last, at
        several instants; the first of these says which are drawn
    mirrors : whether it is to be mirrored in the planes x = 0 and y = 0
    reach : [m] from the impact point

    Returns
    -------
    faces : (a, b, 3) [m]; empty of empty ones
    """
    if not faces[0].size:
        return list(faces)
    if mirrors[0]:
        faces = [np.concatenate([face[:0:-1] * [-1, 1, 1], face]) for face in faces]
    # grid lines at the edge of the block, where they have hardly moved
    along, across = faces[0][:, -1, 0], faces[0][-1, :, 1]
    inside = np.abs(along) <= max(reach, np.abs(along).min())
    beyond = (across >= -1e-9) & (across <= max(reach, np.abs(across).min()))
    return [face[inside][:, beyond] for face in faces]


def width(nodes: FloatArray, mirrored: bool) -> float:
    """Measure the width [m] of a panel along x, from the nodes (n, 3) of what is modelled."""
    return float(np.ptp(nodes[:, 0])) * (2 if mirrored else 1)
