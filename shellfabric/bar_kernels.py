"""An elastic-plastic bar along the projectile's axis: lumped masses on springs, by velocity Verlet in steps of its own.

Node 0 is the tip, the last one the tail; u counts forwards along the axis from the places at rest.

    e_k = (u_k - u_(k+1)) / h_k,     sigma = E (e - e_p),     |sigma - H e_p| <= sigma_y        (tension positive)
    m_k dv_k/dt = (A sigma)_(k-1) - (A sigma)_k,     and at the tip the target's force

Plasticity is kinematic with linear hardening H, by radial return, which is exact for a step of strain (the source uses
a kinematic plasticity model, thesis section 4.4.2). Strains are small and sections nominal. A force that is held over
a step does the work force times advance of the tip, and the bar's momentum grows by force times time, both exactly.
"""

import numpy as np
from numba import njit

WORK, PLASTIC = 0, 1  # of the sums [J]: of the tip's force; of the stress on plastic strain
KINETIC, ELASTIC = 0, 1  # of `energies`


@njit(cache=True, error_model="numpy")
def kick(v, mass, area, stress, force, half):
    """Velocities over the time `half` [s]."""
    n = stress.size
    for k in range(n + 1):
        pull = force if k == 0 else area[k - 1] * stress[k - 1]
        if k < n:
            pull -= area[k] * stress[k]
        v[k] += half * pull / mass[k]


@njit(cache=True, error_model="numpy")
def stretch(u, h, area, modulus, yields, hardening, plastic, stress):
    """Stress of every element at the places u, plastic strains grown to where it is admissible.

    Returns
    -------
    work : [J] of the stress on the growth of the plastic strain
    """
    work = 0.0
    for k in range(h.size):
        strain, was = (u[k] - u[k + 1]) / h[k], plastic[k]
        trial = modulus * (strain - was)
        over = abs(trial - hardening * was) - yields
        if over > 0.0:
            plastic[k] = was + np.sign(trial - hardening * was) * over / (modulus + hardening)
            trial = modulus * (strain - plastic[k])
            work += trial * (plastic[k] - was) * area[k] * h[k]
        stress[k] = trial
    return work


@njit(cache=True, error_model="numpy")
def advance(u, v, mass, h, area, modulus, yields, hardening, plastic, stress, sums, force, dt, substeps):
    """Move the bar over `dt` under a force that is held at its tip.

    Parameters
    ----------
    u, v, mass : (n + 1,) [m], [m/s], [kg]; places and velocities are overwritten
    h, area : (n,) [m], [m2]
    modulus, yields, hardening : [Pa] E, sigma_y, H
    plastic, stress : (n,) plastic strain and stress [Pa] at the places u; overwritten
    sums : (2,) WORK and PLASTIC [J], added to
    force : [N] forwards along the axis: what stops the projectile is negative
    dt, substeps : [s], and equal parts of it, short enough for the bar (`bar.Bar.substeps`)

    Returns
    -------
    displacement, velocity : [m], [m/s] of the tip
    """
    part, before = dt / substeps, u[0]
    for _ in range(substeps):
        kick(v, mass, area, stress, force, 0.5 * part)
        for k in range(u.size):
            u[k] += part * v[k]
        sums[PLASTIC] += stretch(u, h, area, modulus, yields, hardening, plastic, stress)
        kick(v, mass, area, stress, force, 0.5 * part)
    sums[WORK] += force * (u[0] - before)
    return u[0], v[0]


@njit(cache=True, error_model="numpy")
def energies(v, mass, h, area, modulus, stress, out):
    """KINETIC and ELASTIC energy [J] into out : (2,)."""
    out[KINETIC] = out[ELASTIC] = 0.0
    for k in range(mass.size):
        out[KINETIC] += 0.5 * mass[k] * v[k] * v[k]
    for k in range(h.size):
        out[ELASTIC] += 0.5 * stress[k] * stress[k] / modulus * area[k] * h[k]
