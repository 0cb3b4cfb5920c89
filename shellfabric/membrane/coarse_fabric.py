"""Look for fabric of a graded panel that has come under the projectile from beyond the fine mesh.

Only what the contact window may hold (`Constants.window_limits`) touches the projectile, on a graded
panel a part of the first zone. What lies further out passes through it if yarns that have failed, or
whose ends are free, draw it in.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base import sums
from shellfabric.membrane.slots import places_of_nodes
from shellfabric.projectile import sdf_kernels


def depth_in_nose(panel: Any, const: Any, state: Any) -> float:
    """Compute the depth [m] in the projectile of the node from beyond the contact window that is
    deepest in it; 0 where none is.

    Parameters
    ----------
    panel, const, state : of one ply, in whose frame the projectile is
    """
    places = places_of_nodes(panel, const, state)
    outside = np.ones(places.shape[:2], bool)
    i0, i1, j0, j1 = const.window_limits
    outside[i0 : i1 + 1, j0 : j1 + 1] = False
    from_nose = sums.multiply(
        places[outside] - state.projectile_position, np.asarray(const.frame).T
    )
    widest = const.projectile_radius
    if const.nose.kind == sdf_kernels.PROFILE:
        widest = const.nose.profile.widest
    # the distance of one place at a time is slow, and hardly any is in the cylinder
    near = (np.hypot(*from_nose[:, :2].T) < widest) & (from_nose[:, 2] < 0.0)
    depth = 0.0
    for place in from_nose[near]:
        gap, _ = sdf_kernels.distance(const.nose, tuple(place))
        depth = max(depth, -gap)
    return depth
