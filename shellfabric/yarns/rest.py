"""Where yarns of a patch touch at rest: the common perpendiculars of their splines.

In plain weave that is at the nodes of a crossing, about which both yarns are symmetric. A yarn that
changes sides behind a crossing and floats on before it is closest to the crossing yarn on its flank.
`crossing_kernels` finds the same place, from the place before, in each step; here Newton's method finds
all of a patch at once, so that a patch begins without forces.
"""

from __future__ import annotations

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray

STEPS = 40
LONGEST = 0.1  # of an index in a step, as of the kernels
EXACT = 1e-13  # of an index


def find_contacts(
    warp: FloatArray, weft: FloatArray, start: FloatArray, leaning: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Move indices of crossings to the common perpendiculars of their yarns.

    Parameters
    ----------
    warp, weft : (yarns, nodes of a yarn, 3) [m] nodes at rest
    start : (warp yarns, weft yarns, 2) indices on warp and weft
    leaning : (warp yarns, weft yarns) those to move

    Returns
    -------
    (warp yarns, weft yarns, 2) indices, (warp yarns, weft yarns) [m] distances of the yarns there
    """
    found = start.copy()
    i, j = np.nonzero(leaning)
    s = start[i, j].T
    for _ in range(STEPS):
        x, t, c = _point(warp, i, s[0])
        y, r, e = _point(weft, j, s[1])
        d = x - y
        # slopes of half of the square of the distance, and their slopes
        first, second = _dot(d, t), -_dot(d, r)
        a, b, mixed = _dot(t, t) + _dot(d, c), _dot(r, r) - _dot(d, e), -_dot(t, r)
        over = a * b - mixed**2
        step = np.stack([mixed * second - b * first, mixed * first - a * second]) / over
        s = s + np.clip(step, -LONGEST, LONGEST)
        if not step.size or abs(step).max() < EXACT:
            break
    found[i, j] = s.T
    numbers = np.indices(leaning.shape)
    d = _point(warp, numbers[0], found[..., 0])[0] - _point(weft, numbers[1], found[..., 1])[0]
    return found, np.sqrt(_dot(d, d))


def _point(nodes, yarn, index):
    """(place, tangent, curvature) of yarns at indices of their chains, as `curve_kernels.spline`."""
    k = np.clip((index + 0.5).astype(int), 1, nodes.shape[1] - 2)
    u = (index - k)[..., None]
    before, own, after = (nodes[yarn, k + step] for step in (-1, 0, 1))
    place = 0.5 * (0.5 - u) ** 2 * before + (0.75 - u**2) * own + 0.5 * (0.5 + u) ** 2 * after
    return place, (u - 0.5) * before - 2 * u * own + (u + 0.5) * after, before - 2 * own + after


def _dot(a, b):
    return (a * b).sum(axis=-1)
