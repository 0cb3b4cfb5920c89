"""Steps of a patch of solid yarns, struck by a rigid projectile: central differences.

    v(n+1/2) = v(n-1/2) - (dt(n-1) + dt(n)) / 2 f(n) / m,      x(n+1) = x(n) + dt(n) v(n+1/2)

The solids' law has no potential, so their energy is booked as the work that their forces have taken.
"""

import numpy as np

from shellfabric.jit.compile import entry, kernel
from validation.models.solids.facet_kernels import contact_forces
from validation.models.solids.nose_kernels import nose_forces
from validation.models.solids.tip_kernels import tip_forces
from validation.models.solids.yarn_kernels import (
    add_bar_rows,
    add_brick_rows,
    bar_forces,
    brick_forces,
)


@entry()
def forces(patch):
    """Set the internal forces of all yarns and contacts, and what they store."""
    dt = patch.last_dt
    for n in range(patch.mass.size):
        for c in range(3):
            patch.f_solid[n, c] = 0.0
            patch.f_other[n, c] = 0.0
    patch.fibre_energy = 0.0
    patch.hourglass_energy = 0.0
    for yarn in range(patch.first_node.size):
        bar_forces(patch, yarn, dt)
        brick_forces(patch, yarn, dt)
    contact_forces(patch, dt)
    tip_forces(patch, dt)
    nose_forces(patch, dt)


@kernel(fastmath={"contract"})
def move_nodes(patch, kick):
    """Set the velocities of the nodes over `kick` [s] and their places over a step."""
    power = 0.0
    kinetic = 0.0
    dt = patch.dt
    for n in range(patch.mass.size):
        for c in range(3):
            before = patch.v[n, c]
            force = patch.f_solid[n, c] + patch.f_other[n, c]
            after = before - kick * patch.free[n, c] / patch.mass[n] * force
            middle = 0.5 * (before + after)
            power += patch.f_solid[n, c] * middle
            kinetic += 0.5 * patch.mass[n] * middle * middle
            patch.v[n, c] = after
            patch.x[n, c] += dt * after
    patch.solid_work += kick * power
    patch.half_work = 0.5 * kick * power
    patch.kinetic_energy = kinetic


@kernel()
def move_projectile(patch, kick):
    """Set the velocity of the projectile over `kick` [s] and its place over a step."""
    energy = 0.0
    mass = patch.projectile_mass
    for c in range(3):
        before = patch.nose_velocity[c]
        after = before + kick * patch.projectile_free[c] / mass * patch.nose_force[c]
        middle = 0.5 * (before + after)
        energy += 0.5 * mass * middle * middle
        patch.nose_velocity[c] = after
        patch.nose_position[c] += patch.dt * after
    patch.projectile_energy = energy


@entry()
def run_steps(patch, steps):
    """Make `steps` steps of patch.dt [s]."""
    for _ in range(steps):
        forces(patch)
        kick = 0.5 * (patch.last_dt + patch.dt)
        move_nodes(patch, kick)
        move_projectile(patch, kick)
        patch.last_dt = patch.dt
        patch.time += patch.dt
        patch.steps += 1


@entry()
def highest_frequency(patch):
    """Bound the square of the highest frequency [1/s2] of the state by row sums of the tangent over
    the masses; and find the node where it is."""
    rows = np.zeros(patch.mass.size)
    for yarn in range(patch.first_node.size):
        add_bar_rows(patch, yarn, rows)
        add_brick_rows(patch, yarn, rows)
    highest = 0.0
    node = 0
    for n in range(rows.size):
        square = (rows[n] + patch.contact_stiffness[n]) / patch.mass[n]
        if not square <= highest:
            highest = square
            node = n
        if square != square:  # a brick is inverted
            break
    return highest, node
