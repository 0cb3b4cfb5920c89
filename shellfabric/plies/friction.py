"""Coulomb friction between plies: what the kernels need of it (`plies.ply_friction_kernels`).

Stability. Friction in stick is a spring k_t with a damper c_t between neighbouring plies, along the fabric, where the
yarns are stiff already. With the Courant factor C of the plies, the highest mode of a ply in its own plane has
(w dt)^2 = 4 C^2; in a stack of plies of the mass m a point, the springs add 4 k_t dt^2 / m to that and the dampers,
which lag by half a step, 8 c_t dt / m. Central differences are stable up to a sum of 4:

    k_t dt^2 / m + 2 c_t dt / m = 1 - C^2

with c_t = zeta sqrt(k_t m) and the damping ratio zeta of the normal contact. Both follow from that. The slip at which a
point begins to slide is mu f / k_t. In slip the force is bounded, whatever the step.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Any

import numpy as np

from fabrics.errors import InputError

MAX_CFL = 0.95  # Courant factor above which stick has no stable stiffness worth the name


def check(friction: float, cfl: float) -> None:
    """Refuse a coefficient out of its range, or a time step without room for friction.

    Parameters
    ----------
    friction : [-] Coulomb's coefficient
    cfl : [-] Courant factor of the plies

    Raises
    ------
    InputError : either
    """
    if not 0 <= friction < inf:
        raise InputError(key="ply_friction", value=friction, allowed="at least 0")
    if friction > 0 and cfl > MAX_CFL:
        raise InputError(key="cfl", value=cfl, allowed=f"at most {MAX_CFL} with friction between plies")


def slip_constants(cfl: float, mass: float, step: float, normal: float, damping: float) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] of a point in stick.

    Parameters
    ----------
    cfl : [-] Courant factor of the plies at this step
    mass : [kg] that a contact point stands for
    step : [s] time step
    normal : [N/m] highest stiffness of the normal contact of a point; stick is no stiffer
    damping : [-] ratio, of `PlyContact`
    """
    root = sqrt(damping**2 + 1 - cfl**2) - damping  # of k_t dt^2 / m
    root = min(root, step * sqrt(normal / mass))
    return root**2 * mass / step**2, damping * root * mass / step


def fields(friction: float, points: int, constants: tuple[float, float]) -> dict[str, Any]:
    """The fields of `arrays.Pair` that friction needs, of `points` contact points and their `slip_constants`.

    Without friction the arrays are None, and the kernels have no friction.
    """
    stiffness, damping = constants
    return {
        "friction": float(friction), "slip_stiffness": stiffness, "slip_damping": damping,
        "friction_state": np.zeros((points, 6)) if friction > 0 else None,
        "normal_force": np.zeros(points) if friction > 0 else None,
    }  # fmt: skip
