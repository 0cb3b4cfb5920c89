"""A deformed panel and its projectile in space, drawn off screen by pyvista."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.checks import FloatArray
from meshing.pictures_style import RED, STEEL, tension_map

SIZE = (1120, 612)  # [pixels] width and height of an image
TOWARDS = np.array([0.55, -1.4, 0.95])  # the viewer, who is behind the panel
_CLOTH_DEPTH = 1e-3  # [m] by which the projectile is drawn behind fabric that it touches
_LIGHTS = ((0.62, 0.58, 0.53), 0.72), ((-0.6, 0.1, 0.79), 0.28)  # directions to the right, up, to the viewer; intensity
_MATTE = {"ambient": 0.48, "diffuse": 0.66, "specular": 0.0}


def panel(
    grid: Any, strength: FloatArray, body: FloatArray, mirrors: Sequence[bool], half_height: float,
    centre: Sequence[float] | FloatArray = (0.0, 0.0, 0.0), *, top_share: float = 1.0, open_quarter: bool = False,
) -> np.ndarray:  # fmt: skip
    """(rows, columns, 3) a deformed panel seen from behind, in parallel projection; parameters as of `add` and

    half_height, centre : [m] of what is seen
    """
    import pyvista

    from meshing.pictures import plotter

    scene = plotter(SIZE, "none")
    scene.enable_anti_aliasing("msaa", multi_samples=4)  # half the time of "ssaa", and smooth enough for opaque faces
    for direction, intensity in _LIGHTS:
        scene.add_light(pyvista.Light(position=direction, intensity=intensity, light_type="camera light"))
    add(scene, grid, strength, body, mirrors, top_share=top_share, open_quarter=open_quarter)
    scene.enable_parallel_projection()
    scene.camera_position = [tuple(np.add(centre, TOWARDS)), tuple(centre), (0, 0, 1)]
    scene.camera.parallel_scale = half_height
    scene.reset_camera_clipping_range()
    image = scene.screenshot(return_img=True)
    scene.close()
    return image


def add(
    scene: Any, grid: Any, strength: FloatArray, body: FloatArray | None, mirrors: Sequence[bool], *,
    top_share: float = 1.0, open_quarter: bool = False,
) -> None:  # fmt: skip
    """Add a panel to a plotter: tension in colour, broken yarns in vermilion, cells without a yarn left out.

    Parameters
    ----------
    scene : pyvista.Plotter
    grid : of `results.vtk.panel`, or read from its file
    strength : [N] of warp and weft, (2,) or (m, 2)
    body : (a, b, 3) [m] surface of the projectile, or None
    mirrors : whether the panel is to be mirrored in the planes x = 0 and y = 0
    top_share : [-] tension over strength at which the colours end
    open_quarter : whether the quarter of the fabric in front of the projectile is left out
    """
    from matplotlib.colors import to_rgb

    cloth, failed = grid.copy(deep=True), np.asarray(grid["failed_yarns"])
    share = (np.column_stack([grid["tension_warp_N"], grid["tension_weft_N"]]) / strength).max(axis=1)
    paint = np.where((failed == 1)[:, None], to_rgb(RED), tension_map()(np.clip(share / top_share, 0, 1))[:, :3])
    cloth.clear_data()
    cloth["colour"] = np.round(255 * paint).astype(np.uint8)
    cloth = cloth.extract_cells(failed < 2)
    for normal, mirrored in zip(((1, 0, 0), (0, 1, 0)), mirrors):
        if mirrored:
            cloth = cloth.merge(cloth.reflect(normal, point=(0, 0, 0)))
    if open_quarter and body is not None:
        (x, y), middle = tip(body)[:2], cloth.cell_centers().points
        cloth = cloth.extract_cells((middle[:, 0] < x) | (middle[:, 1] > y))
    scene.add_mesh(cloth, scalars="colour", rgb=True, smooth_shading=True, **_MATTE)
    if body is not None:
        import pyvista

        behind = body - _CLOTH_DEPTH * TOWARDS / np.linalg.norm(TOWARDS)
        scene.add_mesh(pyvista.StructuredGrid(*np.moveaxis(behind, -1, 0)), color=STEEL, **_MATTE)


def width(nodes: FloatArray, mirrored: bool) -> float:
    """[m] of a panel along x, from the nodes (n, 3) of what is modelled."""
    return float(np.ptp(nodes[:, 0])) * (2 if mirrored else 1)


def tip(body: FloatArray) -> FloatArray:
    """(3,) [m] middle of the foremost 0.1 mm of a projectile's surface (a, b, 3)."""
    return body[body[..., 2] > body[..., 2].max() - 1e-4].mean(axis=0)


def cropped(image: np.ndarray) -> np.ndarray:
    """What is drawn of an image on white."""
    drawn = np.any(image < 250, axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] if rows.size else image
