"""A body of revolution of metal in motion, in steps of its own, as a part of a run.

What touches the body gives its forces to the rings of its outline (`projectile.profile_kernels`);
they are held over the next step of the run, in which the body makes as many steps as its elements
ask for (velocity Verlet). A held force does the work force times advance of its ring, and the
body's momentum grows by force times time, both exactly.

What contact sees of the motion along the axis is the foremost point: its place is that of the
projectile, and its advance over the step divided by the step the projectile's velocity.
"""

import math

from shellfabric.jit.compile import entry, kernel
from shellfabric.metal.element_kernels import forces
from shellfabric.metal.state import BodyRow
from shellfabric.projectile.bar_kernels import CENTRE, TAIL, TIP
from shellfabric.projectile.profile_kernels import foremost, place_profile
from shellfabric.state import unit

MOST_OWN_STEPS = 64  # in one of the run
INSIDE_OUT, TOO_SHORT = 1, 2  # of BodyRow.fault


@kernel()
def kick(own, duration):
    """Update the velocities over a duration [s] of the present forces; the axis stays straight, and
    a wall holds what is on it."""
    for n in range(own.mass.size):
        for c in range(2):
            own.v[n, c] += duration * (own.f[n, c] + own.outer[n, c]) / own.mass[n]
        if own.x[n, 0] <= 0.0:
            own.v[n, 0] = 0.0
        if own.x[n, 1] >= own.wall:
            own.v[n, 1] = min(own.v[n, 1], 0.0)


@kernel()
def drift(own, duration):
    """Move the nodes over a duration [s]; work of the outer forces."""
    for n in range(own.mass.size):
        for c in range(2):
            way = duration * own.v[n, c]
            own.outer_work += own.outer[n, c] * way
            own.x[n, c] += way
        own.x[n, 0] = max(own.x[n, 0], 0.0)
        own.x[n, 1] = min(own.x[n, 1], own.wall)


@entry()
def advance(own, dt):
    """Move over the time dt [s] under the forces own.outer, which are held, in as few steps as the
    elements bear. A body with a fault stays as it is."""
    done = 0.0
    count = 0
    while done < dt and own.fault == 0:
        if not own.longest_step > 0.0:
            own.fault = INSIDE_OUT
            break
        left = math.ceil((dt - done) / own.longest_step)
        if count + left > MOST_OWN_STEPS:
            own.fault = TOO_SHORT
            break
        step = (dt - done) / left
        kick(own, 0.5 * step)
        drift(own, step)
        forces(own, step)
        kick(own, 0.5 * step)
        count += 1
        if left == 1:
            break
        done += step
    own.own_steps = count
    own.most_own_steps = max(own.most_own_steps, count)
    note_motion(own)


@entry()
def note_motion(own):
    """Note the kinetic energy, and velocities and ways of tip, tail and centre of mass."""
    kinetic = 0.0
    momentum = 0.0
    mass = 0.0
    way = 0.0
    for n in range(own.mass.size):
        kinetic += 0.5 * own.mass[n] * (own.v[n, 0] ** 2 + own.v[n, 1] ** 2)
        momentum += own.mass[n] * own.v[n, 1]
        way += own.mass[n] * own.x[n, 1]
        mass += own.mass[n]
    own.kinetic_energy = kinetic
    tip = own.outline[0]
    tail = own.outline[own.outline.size - 1]
    own.motion[TIP] = own.v[tip, 1]
    own.motion[TAIL] = own.v[tail, 1]
    own.motion[CENTRE] = momentum / mass
    own.motion[3 + TIP] = own.x[tip, 1] - own.start[TIP]
    own.motion[3 + TAIL] = own.x[tail, 1] - own.start[TAIL]
    own.motion[3 + CENTRE] = way / mass - own.start[CENTRE]


@kernel()
def take_forces(own):
    """Sum the forces of all that touches the outline into own.outer."""
    own.outer[:] = 0.0
    for k in range(own.outline.size):
        n = own.outline[k]
        for c in range(2):
            for p in range(own.ring_force.shape[0]):
                own.outer[n, c] += own.ring_force[p, k, c]


@entry()
def show_outline(own, radius, dt):
    """Show the outline to what touches it: its profile with an edge radius [m], and the velocities
    of its rings over that of the nose; the advance [m] of the nose, over the last dt [s]."""
    nose = foremost(own.before)
    for k in range(own.outline.size):
        n = own.outline[k]
        for c in range(2):
            own.profile.velocity[k, c] = (own.x[n, c] - own.before[k, c]) / dt
            own.before[k, c] = own.x[n, c]
    advance_of_nose = foremost(own.before) - nose
    for k in range(own.outline.size):
        own.profile.velocity[k, 1] -= advance_of_nose / dt
    place_profile(own.profile, own.before, radius)
    return advance_of_nose


@unit(later=True, own=BodyRow, force="number")
def move_body(state, const, own, force):
    """Move the body by a step under what touches its rings, whose sum along the axis is the force
    [N]; the velocity of the projectile along its axis is that of its foremost point."""
    rigid = 0.0
    for c in range(3):
        rigid += const.frame[2, c] * state.projectile_velocity[c]
    take_forces(own)
    advance(own, const.dt)
    tip = show_outline(own, const.nose.edge_radius, const.dt) / const.dt
    for c in range(3):
        state.projectile_velocity[c] += const.frame[2, c] * (tip - rigid)
