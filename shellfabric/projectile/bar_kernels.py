"""An elastic-plastic bar along the projectile's axis: lumped masses on springs, by velocity Verlet in steps of its own.

Node 0 is the tip, the last one the tail; u counts forwards along the axis from the places at rest.

    l_k = 1 + (u_k - u_(k+1)) / h_k,   e = ln l,   tau = E (e - e_p),   |tau - H e_p| <= sigma_y   (tension positive)
    m_k dv_k/dt = (A tau / l)_(k-1) - (A tau / l)_k,     and at the tip the target's force

Plasticity is kinematic with linear hardening H, by radial return, which is exact for a step of strain (the thesis uses
a kinematic plasticity model, thesis section 4.4.2). With logarithmic strain and Kirchhoff stress tau a section grows as
it is squeezed, at constant volume. A wall that carries no more than sigma_y would else be driven together in the one
element next to where it is loaded, whatever its length; this growth alone spreads the flow, at (sigma_y / rho)^(1/2).
A force that is held over a step does the work force times advance of the tip, and the bar's momentum grows by force
times time, both exactly.

In a run (`advance_bar`) the axis of the projectile is such a bar and moves rigidly across itself. What contact sees
is the tip: its place, and as its velocity its advance over the step divided by the step.
"""

import math

import numpy as np

from shellfabric.jit.compile import entry, kernel
from shellfabric.state import unit

WORK, PLASTIC = 0, 1  # of the sums [J]: of the tip's force; of the stress on plastic strain
KINETIC, ELASTIC = 0, 1  # of `energies`


@kernel()
def update_velocities(u, v, mass, h, area, stress, force, half):
    """Velocity update over the time `half` [s]."""
    n, before = stress.size, force
    for k in range(n + 1):
        behind = area[k] * stress[k] / (1.0 + (u[k] - u[k + 1]) / h[k]) if k < n else 0.0
        v[k] += half * (before - behind) / mass[k]
        before = behind


@kernel()
def update_stress(u, h, area, modulus, yields, hardening, plastic, stress):
    """Stress of every element at the places u, plastic strains grown to where it is admissible.

    Returns
    -------
    work : [J] of the stress on the growth of the plastic strain
    """
    work = 0.0
    for k in range(h.size):
        strain, was = math.log(1.0 + (u[k] - u[k + 1]) / h[k]), plastic[k]
        trial = modulus * (strain - was)
        over = abs(trial - hardening * was) - yields
        if over > 0.0:
            plastic[k] = was + np.sign(trial - hardening * was) * over / (modulus + hardening)
            trial = modulus * (strain - plastic[k])
            work += trial * (plastic[k] - was) * area[k] * h[k]
        stress[k] = trial
    return work


@entry()
def advance(u, v, mass, h, area, law, plastic, stress, sums, force, dt, substeps):
    """Move the bar over `dt` under a force that is held at its tip.

    Parameters
    ----------
    u, v, mass : (n + 1,) [m], [m/s], [kg]; places and velocities are overwritten
    h, area : (n,) [m], [m2]
    law : (3,) [Pa] E, sigma_y, H
    plastic, stress : (n,) plastic strain and Kirchhoff stress [Pa] at the places u; overwritten
    sums : (2,) WORK and PLASTIC [J], added to
    force : [N] forwards along the axis: what stops the projectile is negative
    dt, substeps : [s], and equal parts of it, short enough for the bar at rest (`bar.Bar.substeps`); where an element
        is squeezed below 0.95 of its length there are more in its measure, as a wave crosses it sooner

    Returns
    -------
    displacement, velocity : [m], [m/s] of the tip
    """
    modulus, yields, hardening = law[0], law[1], law[2]
    least, before = 1.0, u[0]
    for k in range(h.size):
        least = min(least, 1.0 + (u[k] - u[k + 1]) / h[k])
    parts = math.ceil(substeps / max(min(least + 0.05, 1.0), 0.01))
    part = dt / parts
    for _ in range(parts):
        update_velocities(u, v, mass, h, area, stress, force, 0.5 * part)
        for k in range(u.size):
            u[k] += part * v[k]
        sums[PLASTIC] += update_stress(u, h, area, modulus, yields, hardening, plastic, stress)
        update_velocities(u, v, mass, h, area, stress, force, 0.5 * part)
    sums[WORK] += force * (u[0] - before)
    return u[0], v[0]


@entry()
def energies(v, mass, h, area, modulus, stress, out):
    """KINETIC and ELASTIC energy [J] into out : (2,)."""
    out[KINETIC] = out[ELASTIC] = 0.0
    for k in range(mass.size):
        out[KINETIC] += 0.5 * mass[k] * v[k] * v[k]
    for k in range(h.size):
        out[ELASTIC] += 0.5 * stress[k] * stress[k] / modulus * area[k] * h[k]


@kernel(_nrt=False)
def axial_force(state, const):
    """[N] force of a ply, and of what lies behind it, on the projectile along its axis."""
    force = 0.0
    for c in range(3):
        force += (
            const.frame[2, c]
            * const.free_dofs[c]
            * (state.f_contact_nose[c] + state.f_block_nose[c])
        )
    return force


@unit(later=True, force="number")
def advance_bar(state, const, force):
    """One step of the bar along its axis; replaces the axial part of the rigid body's velocity,
    state.projectile_velocity.

    force : [N] along its axis, of all plies (`axial_force`)
    state.bar_* are the arrays of `advance`; const.bar_* mass, h, area, law (E, sigma_y, H) [Pa], parts of a step
    """
    rigid = 0.0
    for c in range(3):
        rigid += const.frame[2, c] * state.projectile_velocity[c]
    before = state.bar_u[0]
    advance(
        state.bar_u,
        state.bar_v,
        const.bar_mass,
        const.bar_h,
        const.bar_area,
        const.bar_law,
        state.bar_plastic,
        state.bar_stress,
        state.bar_energy,
        force,
        const.dt,
        const.bar_substeps,
    )
    tip = (state.bar_u[0] - before) / const.dt
    for c in range(3):
        state.projectile_velocity[c] += const.frame[2, c] * (tip - rigid)


@entry()
def mass_average(mass, values):
    """Mass-weighted mean of nodal values, as of the centre of mass."""
    total, weight = 0.0, 0.0
    for k in range(mass.size):
        total += mass[k] * values[k]
        weight += mass[k]
    return total / weight


@kernel()
def normal_velocity(state, const):
    """[m/s] velocity of the projectile's centre of mass along the panel's normal."""
    if const.bar_mass.size == 0:
        return state.projectile_velocity[2]
    tip = 0.0
    for c in range(3):
        tip += const.frame[2, c] * state.projectile_velocity[c]
    return state.projectile_velocity[2] + const.frame[2, 2] * (
        mass_average(const.bar_mass, state.bar_v) - tip
    )
