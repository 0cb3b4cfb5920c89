"""Normal force of a contact point: penalty and damping, which push and never pull. With the depth d, the opening
velocity v_n, the stiffness k and the damping c of the point

    f = max(0, k d - c v_n),     U = k d^2 / 2                                    (1)

Where both are booked apart, the damping is at most max(-c v_n, -k d). Between plies the spring is no straight
line (`plies.law_kernels`). The implicit force is that of the end of the step: with the velocity v at which the
point, of the mass m that it moves, will approach by all other forces than this

    f = max(0, k d + (c + k dt) v) / (1 + (c + k dt) dt / m)                      (2)

Derivation: docs/theory-panel.md, "Contact with the projectile".
"""

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import maximum


@kernel(_nrt=False, forceinline=True)
def spring(stiffness, depth):
    """Return the force [N] and the energy [J] of a penalty spring at a depth [m]."""
    force = stiffness * depth
    return force, 0.5 * force * depth


@kernel(_nrt=False, forceinline=True)
def damped(force, damping, closing):
    """Return the force [N] of one point or of eight, eq. (1), from that of its spring.

    damping : [N s/m]; closing : [m/s] velocity at which the point approaches
    """
    return maximum(force + damping * closing, 0.0)


@kernel(_nrt=False, forceinline=True)
def damping_force(force, damping, opening):
    """Return the damping force [N] alone of one point or of eight, from that of the spring: both
    together never pull."""
    return maximum(0.0 - damping * opening, 0.0 - force)


@kernel(forceinline=True)
def implicit_penalty_force(const, spring, gap, last, usual):
    """Compute the implicit penalty force [N] on a point.

    spring : stiffness [N/m] and damping [N s/m]
    gap : distance [m] and predicted opening velocity [m/s]
    last : force on the point a step ago, and by what that and those on its neighbours have sped it
        up
    usual : force that every point is taken to have besides
    """
    stiffness, damping = spring
    depth, away = gap
    before, gave = last
    both = damping + stiffness * const.dt
    mobility = (max(gave, 0.0) + usual * const.dt / const.point_law.mass) / (before + usual)
    return max(0.0, (-stiffness * depth - both * away) / (1.0 + both * mobility))
