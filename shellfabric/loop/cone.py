"""How far the cone about the nose has spread: the place of the transverse wave along a line.

Behind the transverse wave the fabric moves with the nose, before it the fabric is flat. The side of
the cone is nearly straight, so that the chord through the side at 3/4 and 1/4 of its height meets
the flat fabric at the foot of the cone. On a straight yarn the side is straight and the foot is the
kink, which runs at Smith's U (Smith, McCrackin and Schiefer, Textile Research Journal 28 (1958)
288).
"""

from __future__ import annotations

import numpy as np

from fabrics.base.checks import FloatArray

# shares of the height of the profile
HIGH, LOW = 0.75, 0.25
SIDE = 3  # elements that the side of a cone covers at least, between these heights


def find_foot(x: FloatArray, z: FloatArray, spacing: float) -> float:
    """Find the foot [m] of the cone on the side x >= 0 of a profile.

    Parameters
    ----------
    x, z : (n,) [m] places along the line from the impact point, rising, and deflections
    spacing : [m] of the nodes at rest

    Returns
    -------
    foot : [m] from the impact point; not a number of flat fabric, of a side that covers fewer than
        SIDE elements, and of one that goes down and up again: yarns that are pressed together near
        the nose at first rise elsewhere
    """
    ahead = x >= 0
    x = x[ahead]
    z = z[ahead]
    top = float(z.max(initial=0.0))
    high = _crossing(x, z, HIGH * top)
    low = _crossing(x, z, LOW * top)
    if not (top > 0 and low - high >= SIDE * spacing):
        return np.nan
    side = (x >= x[np.argmax(z)]) & (x <= low)
    if np.any(z[side] < LOW * top):
        return np.nan
    return float(low + (low - high) * LOW / (HIGH - LOW))


def _crossing(x, z, height):
    """[m] outermost place at which the profile comes down through a height."""
    above = np.flatnonzero(z > height)
    if above.size == 0 or above[-1] + 1 == z.size:
        return np.nan
    k = above[-1]
    return x[k] + (x[k + 1] - x[k]) * (z[k] - height) / (z[k] - z[k + 1])
