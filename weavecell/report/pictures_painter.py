"""Coloured quadrilaterals in space as an image, by the painter's algorithm: from the farthest to the nearest.

For surfaces of small, opaque elements, such as a panel and its projectile. That takes a tenth of the time of a window
of OpenGL, of which most goes into opening it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

SIZE = (1120, 612)  # [pixels] width and height
_FINER = 2  # pixels are drawn this many times smaller, and averaged
_AMBIENT, _DIFFUSE = 0.48, 0.66
_LIGHTS = ((0.62, 0.58, 0.53), (-0.6, 0.1, 0.79))  # directions to them: along the view's right, its top, to the viewer
_SHARES = (0.72, 0.28)


@dataclass(frozen=True)
class Camera:
    """A parallel projection.

    Parameters
    ----------
    position, target : (3,) the view goes from one to the other; the third axis points up
    half_height : of what is seen, as long as the surfaces are given
    """

    position: Sequence[float]
    target: Sequence[float]
    half_height: float

    def axes(self) -> np.ndarray:
        """(3, 3) rows: unit vectors to the right, to the top and towards the viewer."""
        back = np.subtract(self.position, self.target).astype(float)
        back /= np.linalg.norm(back)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(back, right), back])


def paint(
    quads: np.ndarray, colours: np.ndarray, camera: Camera, size: tuple[int, int] = SIZE, further: ArrayLike = 0.0
) -> np.ndarray:
    """The picture of quadrilaterals on white.

    Parameters
    ----------
    quads : (n, 4, 3) corners
    colours : (n, 3) from 0 to 1
    camera : Camera
    size : (width, height) [pixels]
    further : (n,) or a number, that a quadrilateral counts as farther than it is: one that touches others from behind

    Returns
    -------
    image : (height, width, 3) uint8
    """
    from PIL import Image, ImageDraw

    seen = (np.asarray(quads, float) - np.asarray(camera.target, float)) @ camera.axes().T
    normal = np.cross(seen[:, 2] - seen[:, 0], seen[:, 3] - seen[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    normal[normal[:, 2] < 0] *= -1  # towards the viewer
    lights = np.maximum(normal @ np.array(_LIGHTS).T, 0.0) @ np.array(_SHARES)
    shaded = np.asarray(colours, float) * (_AMBIENT + _DIFFUSE * lights)[:, None]
    paints = np.round(255 * np.clip(shaded, 0.0, 1.0)).astype(int)
    width, height = (_FINER * n for n in size)
    scale = 0.5 * height / camera.half_height
    places = np.stack([0.5 * width + scale * seen[..., 0], 0.5 * height - scale * seen[..., 1]], axis=-1)
    inside = np.all((places.min(axis=1) < (width, height)) & (places.max(axis=1) > 0), axis=1)
    order = np.flatnonzero(inside)
    depth = seen[..., 2].mean(axis=1) - further
    order = order[np.argsort(depth[order], kind="stable")]
    image = Image.new("RGB", (width, height), "white")
    polygon = ImageDraw.Draw(image).polygon
    for corners, colour in zip(places[order].reshape(-1, 8).tolist(), map(tuple, paints[order].tolist())):
        polygon(corners, fill=colour)
    return np.asarray(image.reduce(_FINER))
