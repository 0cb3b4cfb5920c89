"""An elastic-plastic bar along the projectile's axis: lumped masses on springs, by velocity Verlet (thesis
section 4.4.2). Node 0 is the tip; u counts forwards along the axis from rest. Tension is positive.

    l_k = 1 + (u_k - u_(k+1)) / h_k,   e = ln l,   tau = E (e - e_p)                    (1)
    |tau - H e_p| <= sigma_y            kinematic, by radial return: exact for a step    (2)
    m_k dv_k/dt = (A tau / l)_(k-1) - (A tau / l)_k,   at the tip the target's force    (3)

A section grows as it is squeezed: a wall that carries no more than sigma_y would else be driven together
in the element next to where it is loaded; this growth alone spreads the flow, at (sigma_y / rho)^(1/2).
The bar is a part (`dynamics.BarBody`), `move_bar` its unit. The projectile moves rigidly across its axis;
contact sees the place of the tip, and as velocity its advance over the step divided by the step.
"""

import math

import numpy as np

from shellfabric.jit.compile import entry, kernel
from shellfabric.projectile.state import BarRow
from shellfabric.state import unit
from shellfabric.subcycle_kernels import subcycle

TIP, TAIL, CENTRE = 0, 1, 2  # of Stack.motion: velocities; three further on the displacements


@kernel()
def stretch_of(bar, k):
    """Return the stretch of element k."""
    return 1.0 + (bar.u[k] - bar.u[k + 1]) / bar.h[k]


@kernel()
def update_velocities(bar, force, duration):
    """Update the velocities over a duration [s] of the present stresses and a force [N] at the
    tip."""
    # eq. (3): `before` is what acts on the node from its front, at the tip the target's force
    before = force
    for k in range(bar.mass.size):
        behind = 0.0
        if k < bar.h.size:
            behind = bar.area[k] * bar.stress[k] / stretch_of(bar, k)
        bar.v[k] += duration * (before - behind) / bar.mass[k]
        before = behind


@kernel()
def update_stress(bar):
    """Update the stresses at the present positions; plastic strains grow to where the stress is
    admissible.

    Returns
    -------
    work : [J] of the stress on the growth of the plastic strain
    """
    work = 0.0
    for k in range(bar.h.size):
        strain = math.log(stretch_of(bar, k))
        before = bar.plastic[k]
        stress = bar.modulus * (strain - before)
        shifted = stress - bar.hardening * before
        over = abs(shifted) - bar.yield_stress
        if over > 0.0:  # eq. (2): back along the yield surface, which moves with the plastic strain
            bar.plastic[k] = before + np.sign(shifted) * over / (bar.modulus + bar.hardening)
            stress = bar.modulus * (strain - bar.plastic[k])
            work += stress * (bar.plastic[k] - before) * bar.area[k] * bar.h[k]
        bar.stress[k] = stress
    return work


@kernel()
def step_bar(pushed, dt, left):
    """Make one of the bar's own steps, of `pushed`: the bar and the force [N] at its tip."""
    bar, force = pushed
    update_velocities(bar, force, 0.5 * dt)
    for k in range(bar.u.size):
        bar.u[k] += dt * bar.v[k]
    bar.plastic_work += update_stress(bar)
    update_velocities(bar, force, 0.5 * dt)


@entry()
def advance(bar, force, dt):
    """Move the bar over the time `dt` [s] under a force [N] that is held at its tip.

    A held force does the work force times advance of the tip, and the bar's momentum grows by force
    times time, both exactly.
    The force is positive forwards along the axis: what stops the projectile is negative. Its own
    steps are short enough for the bar at rest (`bar.Bar.substeps`). Where an element is
    squeezed below 0.95 of its length there are more in its measure: a wave crosses it sooner.
    """
    least = 1.0
    before = bar.u[0]
    for k in range(bar.h.size):
        least = min(least, stretch_of(bar, k))
    count = math.ceil(bar.substeps / max(min(least + 0.05, 1.0), 0.01))
    subcycle(step_bar, (bar, force), count, dt)
    bar.tip_work += force * (bar.u[0] - before)
    note_motion(bar)


@entry()
def note_motion(bar):
    """Note velocities and displacements of tip, tail and centre of mass in bar.motion."""
    tail = bar.h.size
    bar.motion[TIP] = bar.v[0]
    bar.motion[TAIL] = bar.v[tail]
    bar.motion[CENTRE] = mass_average(bar.mass, bar.v)
    bar.motion[3 + TIP] = bar.u[0]
    bar.motion[3 + TAIL] = bar.u[tail]
    bar.motion[3 + CENTRE] = mass_average(bar.mass, bar.u)


@kernel()
def mass_average(mass, values):
    """Average nodal values, weighted by mass: of the centre of mass."""
    total = 0.0
    weight = 0.0
    for k in range(mass.size):
        total += mass[k] * values[k]
        weight += mass[k]
    return total / weight


@entry()
def kinetic_energy(bar):
    """Compute the kinetic energy [J] of the motion along the axis."""
    energy = 0.0
    for k in range(bar.mass.size):
        energy += 0.5 * bar.mass[k] * bar.v[k] * bar.v[k]
    return energy


@entry()
def elastic_energy(bar):
    """Compute the energy [J] that the elements store."""
    energy = 0.0
    for k in range(bar.h.size):
        energy += 0.5 * bar.stress[k] * bar.stress[k] / bar.modulus * bar.area[k] * bar.h[k]
    return energy


@unit(later=True, own=BarRow, force="number")
def move_bar(state, const, own, force):
    """Move the bar by a step under a force [N]; the velocity of the projectile along its axis is
    that of the tip, as contact sees it."""
    rigid = 0.0
    for c in range(3):
        rigid += const.frame[2, c] * state.projectile_velocity[c]
    before = own.u[0]
    advance(own, force, const.dt)
    tip = (own.u[0] - before) / const.dt
    for c in range(3):
        state.projectile_velocity[c] += const.frame[2, c] * (tip - rigid)
