"""Coulomb friction between plies and on the nose: a point that sticks has a spring k_t along the surface that remembers
its elastic slip, and a damper c_t (docs/theory-panel.md, "Packs: contact law of plies"), per area

    k_t = STIFFNESS K,     c_t = DAMPING sqrt(k_t A)

with the steepest K of the law of the plies and the density A of the lighter one: neither depends on mesh or step. With
the Courant factor C of the plies they stay stable, whatever their nodes share, if

    C^2 + k_t dt^2 / A + 2 c_t dt / A < 1,       k_n dt^2 / A + 2 c_n dt / A < 2 (1 - C^2)         (1), (2)

(2) of a nose, which leaves the ply its step. Where the step has no room for that both are cut down to it.
"""

from __future__ import annotations

from math import inf, sqrt

from fabrics.base.errors import InputError

# Courant factor above which the springs of stick have no room worth the name: plies are refused, and
# a nose sticks with the springs that there is room for at this one
MAX_CFL = 0.95
STIFFNESS = 0.7  # of stick, over that of the contact
DAMPING = 0.15  # of stick, over sqrt(k_t A)
_ROOM = 0.95  # of what eq. (1) leaves, that is used at most
_SPRING = 2 / 3  # of it for the spring


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


def stick(
    cfl: float, mass: float, step: float, stiffness: float, room: float = 1.0
) -> tuple[float, float]:
    """Compute the spring k_t [N/m] and the damper c_t [N s/m] of a point in stick.

    Let M, Q and D be the matrices of mass, stiffness and dampers, which lag by half a step. Twice
    the energy (v, M v) + (u_n, Q u_n+1) less dt (v, D v) / 2 never grows, and it is a norm if 4 M -
    2 dt D - dt^2 Q > 0, whether these have modes in common or not. dt^2 Q of a ply in its plane is
    at most 4 C^2 M. A point moves by the mean of its nodes, whose square is at most the mean of
    squares: the springs of the points on both sides of a ply add at most 4 k_t dt^2 / A and their
    dampers 8 c_t dt / A, which gives (1). A nose is on one side of the first ply alone and moves by
    itself: the sum must be below 4 - 4 C^2, of which the plies behind use at most half, which gives
    (2).

    Parameters
    ----------
    cfl : [-] Courant factor of the plies at this step
    mass : [kg] that a contact point stands for
    step : [s] time step
    stiffness : [N/m] of the point across the surface, at the steepest
    room : [-] that the points have, over that of points between plies: 2 on the nose
    """
    room = room * _ROOM * (1 - min(cfl, MAX_CFL) ** 2)
    spring = min(STIFFNESS * stiffness * step**2 / mass, _SPRING * room)
    damper = min(DAMPING * sqrt(spring), (room - spring) / 2)
    return spring * mass / step**2, damper * mass / step
