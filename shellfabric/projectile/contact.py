"""Constants, state and scratch of the contact of fabric and projectile (see `contact_kernels`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.cloth import spline_kernels
from shellfabric.jit.simd import WIDTH
from shellfabric.projectile import contact_kernels
from shellfabric.state import PointLaw, Scratch

PREDICTED = (
    "dv_other",
    "dv_contact",
)  # of the nodes, where the nose foresees what the other forces will do


def constants(
    points: int, mass: float, dt: float, penalty: float, damping: float
) -> dict[str, Any]:
    """Constants of the points, by the names that the kernels know; an explicit spring
    (`implicit_factor` 0).

    Parameters
    ----------
    points : along each side of an element
    mass : [kg] of an element
    dt : [s] time step that the stiffness is a matter of
    penalty : stiffness of an element's points in units of mass / dt^2
    damping : ratio to critical of that mass on that spring
    """
    room = -(-(points**2) // WIDTH) * WIDTH
    return {
        "points_per_side": points,
        "shape_functions": spline_kernels.shape_functions(points, room),
        "point_law": PointLaw(
            stiffness=penalty * mass / points**2 / dt**2,
            damping=2 * damping * penalty**0.5 * mass / points**2 / dt,
            mass=mass / points**2,
            implicit_factor=0.0,
        ),
    }


def contact_state(
    near: Sequence[int], points: int, shares: FloatArray, friction: float
) -> dict[str, Any]:
    """What is kept from step to step of the elements near = (i0, i1, j0, j1), by the names that the
    kernels know."""
    count = (near[1] - near[0]) * (near[3] - near[2])
    rubbing = 0, 0
    if friction > 0:
        rubbing = count, points**2
    return {
        "last_contact_force": np.zeros((count, shares.shape[2])),
        "in_contact": np.zeros(count, np.bool_),
        "friction_state": np.zeros((*rubbing, 6)),
        **{name: tuple(np.zeros((3, 0))) for name in PREDICTED},
        "force_scale": np.array([contact_kernels.MIN_FORCE_SCALE]),
    }


def scratch(*consts: Any) -> Scratch:
    """Room for one call, of any of several panels: four lines of nodes, the boxes of their columns,
    one element and eight of its points."""
    columns = max(const.window_limits[3] - const.window_limits[2] for const in consts) + 3
    room = max(const.shape_functions.shape[2] for const in consts)
    return Scratch(**Scratch.zeros(columns=columns, points=room))
