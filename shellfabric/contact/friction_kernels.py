"""Coulomb friction at a contact point: of fabric and projectile, and of yarns that cross.

A point that sticks is held by a spring k along the surface that remembers its elastic slip s, with a
damper c; what is beyond Coulomb's limit mu f the spring lets slip, and the damper has what the
spring leaves of the limit. With v the velocity of the fabric over the projectile along the surface

    t = -(k s + c v),     s' = v,     k |s| <= mu f,     c |v| <= mu f - k |s|.              (1)

So the damper takes energy, whatever the slip, and never winds up the spring. Stiffness and most of
the damping are those of `contact.friction.stick`, which the time step has room for.
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import greater, sqrt, where
from shellfabric.surface.vector_kernels import across, add_scaled, dot, scaled, three


@kernel()
def friction_force(last_slip, last_force, limit, spring, dt, normal, v):
    """Compute the friction at one point over one step.

    Parameters
    ----------
    last_slip, last_force : (3,) elastic slip [m] and friction force [N] of the last step, updated
    limit : [N] mu f
    spring : stiffness k [N/m], damping c [N s/m] at most
    normal : unit vector of the surface
    v : [m/s] velocity of the fabric over it

    Returns
    -------
    force on the fabric, energy [J] taken in over the step (trapezoid rule), energy that the spring
    holds
    """
    k, c = spring
    taken = -0.5 * dt * dot(three(last_force, 0), v)
    v = across(v, normal)
    # the surface may have turned since the last step
    slip = across(add_scaled(three(last_slip, 0), dt, v), normal)
    held = k * math.sqrt(dot(slip, slip))
    if held > limit:  # it slides
        slip = scaled(limit / held, slip)
        held = limit
    speed = math.sqrt(dot(v, v))
    if c * speed > limit - held:
        c = (limit - held) / speed
    force = add_scaled(scaled(-k, slip), -c, v)  # eq. (1)
    taken -= 0.5 * dt * dot(force, v)
    for axis in range(3):
        last_slip[axis] = slip[axis]
        last_force[axis] = force[axis]
    return force, taken, 0.5 * k * dot(slip, slip)


@kernel()
def slide(slider, limit, k, dt, normal, v):
    """Move the friction spring of a point without damping, and return the energy [J] that it holds
    and the work [J] of friction in the step.

    Parameters
    ----------
    slider : (3,) elastic slip [m], updated
    limit : [N] mu f; infinity for a point that nothing lets slip
    k : [N/m] stiffness of the spring
    normal : unit vector of the surface
    v : [m/s] velocity of one body over the other
    """
    after, held, work = slipped(three(slider, 0), limit, k, dt, normal, v)
    for axis in range(3):
        slider[axis] = after[axis]
    return held, work


@kernel(_nrt=False, forceinline=True)
def slipped(before, limit, k, dt, normal, v):
    """Return the slip of a friction spring after a step, the energy [J] that it holds and the work
    [J] of friction: as `slide`, of one point or of eight; before : elastic slip [m]."""
    v = across(v, normal)
    after = across(add_scaled(before, dt, v), normal)
    most = limit / k
    square = dot(after, after)
    after = scaled(where(greater(square, most * most), most / sqrt(square), 1.0), after)
    held = 0.5 * k * dot(after, after)
    work = (0.5 * k * dt) * dot(add_scaled(before, 1.0, after), v)
    return after, held, work - held + 0.5 * k * dot(before, before)
