"""Constants, state and scratch of the contact of fabric and projectile (see `contact_kernels`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from shellfabric.jit.simd import WIDTH
from shellfabric.projectile import contact_kernels
from shellfabric.state import PointLaw, Scratch


def constants(
    points: int, mass: float, dt: float, penalty: float, damping: float
) -> dict[str, Any]:
    """Compute the constants of the points, by the names that the kernels know; an explicit spring
    (`implicit_factor` 0).

    Parameters
    ----------
    points : along each side of an element
    mass : [kg] of an element
    dt : [s] time step that the stiffness is a matter of
    penalty : stiffness of an element's points in units of mass / dt^2
    damping : ratio to critical of that mass on that spring
    """
    return {
        "points_per_side": points,
        "point_law": PointLaw(
            stiffness=penalty * mass / points**2 / dt**2,
            damping=2 * damping * penalty**0.5 * mass / points**2 / dt,
            mass=mass / points**2,
            implicit_factor=0.0,
            share_drag=0.0,
        ),
    }


def contact_state(near: Sequence[int], points: int, friction: float) -> dict[str, Any]:
    """Return what is kept from step to step of the elements of a window, by the names that kernels know.

    near : first row of elements and the end, first column and the end
    """
    first_row, end_row, first_column, end_column = near
    count = (end_row - first_row) * (end_column - first_column)
    rubbing = 0, 0
    if friction > 0:
        rubbing = count, points**2
    return {
        "last_contact_force": np.zeros((points**2, count + WIDTH)),
        "in_contact": np.zeros(count, np.bool_),
        "friction_slip": np.zeros((*rubbing, 3)),
        "friction_force": np.zeros((*rubbing, 3)),
        "dv_other": tuple(np.zeros((3, 0))),
        "dv_contact": tuple(np.zeros((3, 0))),
        "force_scale": np.array(contact_kernels.MIN_FORCE_SCALE),
    }


def scratch() -> Scratch:
    """Allocate the scratch of one call."""
    return Scratch(**Scratch.zeros())
