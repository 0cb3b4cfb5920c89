"""Constants, state and scratch of the contact of fabric and projectile (see `contact_kernels`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from shellfabric.contact import friction
from shellfabric.jit.simd import WIDTH
from shellfabric.projectile import contact_kernels
from shellfabric.state import PointLaw, Scratch


def point_law(mass: float, stiffness: float, damping: float, cfl: float, dt: float) -> PointLaw:
    """Compute the law of a contact point with the projectile.

    Parameters
    ----------
    mass : [kg] of the fabric at the point
    stiffness : [N/m] of the point
    damping : ratio to critical of that mass on that spring
    cfl : [-] Courant factor of the fabric at this step
    dt : [s] time step
    """
    stick_stiffness, stick_damping = friction.stick(cfl, mass, dt, stiffness, room=2.0)
    return PointLaw(
        stiffness=stiffness,
        damping=2 * damping * (stiffness * mass) ** 0.5,
        mass=mass,
        implicit=0.0,
        share_drag=0.0,
        stick_stiffness=stick_stiffness,
        stick_damping=stick_damping,
    )


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
