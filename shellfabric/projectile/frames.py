"""Frames that are turned about the panel's normal: the opening's, the pack's, and a ply's along its
own yarns."""

from math import cos, sin

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray


def axes(angle: float) -> FloatArray:
    """Return the first two axes, as rows (2, 2), of a frame that is turned by `angle` [rad], in the
    frame that it is turned from."""
    c = cos(angle)
    s = sin(angle)
    return np.array([[c, s], [-s, c]])


def turned_back(vectors: FloatArray, rows: FloatArray | None) -> FloatArray:
    """Turn vectors (..., 2) or (..., 3) of a frame with such axes back into the frame that it is
    turned from; None: one frame."""
    if rows is None:
        return vectors
    return np.concatenate([sums.multiply(vectors[..., :2], rows), vectors[..., 2:]], axis=-1)
