"""Coulomb friction between plies: what the kernels need of it (`plies.pressure_kernels`).

Below the limit mu f a point yields slowly: friction is a damper c_t there, of which nothing is
remembered. With the Courant factor C of the plies, the highest mode of a ply in its own plane has
(w dt)^2 = 4 C^2; in a stack of plies of the mass m a point, dampers between neighbours, which lag
by half a step, add 8 c_t dt / m to that. Central differences are stable up to a sum of 4:

    c_t = (1 - C^2) m / (2 dt)

Plies of the areal density A that are pressed by p and should stick slip at up to 2 mu p dt / ((1 -
C^2) A): 0.2 m/s at 1 MPa, mu = 0.2, A = 0.2 kg/m2, C = 0.9 and dt = 0.02 us. In slip the force is
bounded, whatever the step.
"""

from __future__ import annotations

from math import inf

from fabrics.base.errors import InputError

MAX_CFL = 0.95  # Courant factor above which stick has no damper worth the name


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
        raise InputError(
            key="cfl", value=cfl, allowed=f"at most {MAX_CFL} with friction between plies"
        )


def stick_damping(cfl: float, mass: float, step: float) -> float:
    """Compute the damping c_t [N s/m] of a point in stick.

    Parameters
    ----------
    cfl : [-] Courant factor of the plies at this step
    mass : [kg] that a contact point stands for
    step : [s] time step
    """
    return (1 - cfl**2) * mass / (2 * step)
