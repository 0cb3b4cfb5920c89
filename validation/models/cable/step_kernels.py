"""Steps of the pin-jointed cable net (`cable.model`), and its contact with the projectile.

Arrays are flat, by component: node (i, j) in slot k = i s + j, s = nj + 1; the bar along the warp from (i, j) to
(i+1, j) and the bar along the weft from (i, j) to (i, j+1) have the slot k too. Where there is no such bar, or no
longer one, its stiffness is zero. The contact is the shell's own, on the surface whose control points are the nodes
(`contact_kernels`, `spline_kernels`), so that the two models differ in what lies under that surface alone.
"""

import math

import numpy as np

from shellfabric.cloth.membrane_kernels import WARP_FAILED, WEFT_FAILED
from shellfabric.jit.compile import entry, kernel
from shellfabric.projectile import contact_kernels, window_kernels

RUNNING, STOPPED, PERFORATED, NOT_FINITE = 0, 1, 2, 3
STEP, FAILURES = 0, 1  # of state.counter
VISCOUS, CONTACT, SPRING, LOST = 0, 1, 2, 3  # of state.energy_sums
# columns of a history: the projectile's z, v_z and the force on it; the clamps' force on the cloth along z; the pulls
# of the middle warp and weft on their clamps, along the yarns at rest
Z, V_Z, NOSE_FORCE, CLAMP_FORCE, MIDDLE, COLUMNS = 0, 1, 2, 3, 4, 6
FAST = {"reassoc", "contract", "nsz", "arcp"}
_MIN_VELOCITY = 1e-60
_MIN_LENGTH = 1e-12


@kernel(fastmath=FAST)
def pull(x, y, z, offset, along, across, S0, cv, stiff, length, drag, elongation, P):
    """Pulls of one family of bars on their near nodes, into P; their elongations. Returns the viscous work of the step.

    cv : [-] viscous force per step's change of length, over the stiffness
    """
    work = 0.0
    for k in range(elongation.size):
        dx, dy, dz = along + (x[k + offset] - x[k]), across + (y[k + offset] - y[k]), z[k + offset] - z[k]
        now = math.sqrt(dx * dx + dy * dy + dz * dz)
        change, e = now - length[k], max(now - S0, 0.0)
        T = stiff[k] * e
        viscous = max(cv * stiff[k] * change if T > 0.0 else 0.0, -T)
        work += 0.5 * (viscous + drag[k]) * change
        drag[k], length[k], elongation[k] = viscous, now, e if stiff[k] > 0.0 else 0.0
        force = (T + viscous) / max(now, _MIN_LENGTH)
        P[0, k], P[1, k], P[2, k] = force * dx, force * dy, force * dz
    return work


@kernel()
def fail(state, const, family, limit, before, P):
    """Remove the bars beyond their limit of elongation. `before`: their lengths a step ago.

    A step exchanges the mean of a bar's two forces times its change of length, and the last force of a failed bar is
    nothing: what is lost is the energy of the step before with half its force times the last change.
    """
    stiff, drag = state.stiffness[family], state.viscous_force[family]
    for k in range(state.elongation.shape[1]):
        e, change = state.elongation[family, k], state.length[family, k] - before[k]
        if e > limit:
            state.energy_sums[LOST] += 0.5 * stiff[k] * max(e - change, 0.0) * e
            state.energy_sums[VISCOUS] -= 0.5 * drag[k] * change
            state.counter[FAILURES] += 1
            stiff[k] = drag[k] = state.intact_fraction[family, k] = P[0, k] = P[1, k] = P[2, k] = 0.0
            i, j = k // const.row_stride, k % const.row_stride
            beside = i * const.row_stride + max(j - 1, 0) if family == 0 else max(i - 1, 0) * const.row_stride + j
            for element in (k, beside):
                state.element_flag[element] |= WARP_FAILED if family == 0 else WEFT_FAILED


@kernel()
def scratch(state, const):
    """Room for the pulls of both families, which begin one row before slot 0, and for lengths."""
    return np.zeros((7, state.elongation.shape[1] + const.row_stride))


@kernel()
def forces(state, const, work):
    """Forces of all bars on the nodes (work: scratch)."""
    s, n = const.row_stride, state.elongation.shape[1]
    u, f, before = state.u, state.f, work[6]
    for family in range(2):
        P, L = work[3 * family : 3 * family + 3, s:], state.length[family]
        before[:n] = L[:n]
        along, across = (const.dx, 0.0) if family == 0 else (0.0, const.dy)
        state.energy_sums[VISCOUS] += pull(
            u[0], u[1], u[2], s if family == 0 else 1, along, across, const.S0[family], const.cv,
            state.stiffness[family], L, state.viscous_force[family], state.elongation[family], P,
        )  # fmt: skip
        most = state.elongation[family].max()
        state.peak_elongation[family] = max(state.peak_elongation[family], most)
        if most > const.failure_elongation[family]:
            fail(state, const, family, const.failure_elongation[family], before, P)
    for c in range(3):
        P, Q = work[c], work[3 + c]  # begin one row before slot 0
        for k in range(n):
            f[c, k] = (P[k + s] - P[k]) + (Q[k + s] - Q[k + s - 1])


@kernel()
def contact(state, const):
    """Add the contact forces to state.f, and account for their energy."""
    before = contact_kernels.clear_forces(state, const)
    taken, spring = contact_kernels.contact_window(state, const, state.contact_scratch)
    state.energy_sums[CONTACT] += taken - before
    state.energy_sums[SPRING] = spring
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for k in range(i * const.row_stride + j0, i * const.row_stride + j1 + 1):
                state.f[c, k] += state.f_contact[c, k]


@kernel(fastmath={"contract", "nsz"})
def move(n, dt, dt_over_mass, f, v, u):
    """Central-difference update of one component; dt_over_mass is 0 where the component is held."""
    for k in range(n):
        speed = v[k] + dt_over_mass[k] * f[k]
        speed = speed if abs(speed) > _MIN_VELOCITY else 0.0
        v[k] = speed
        u[k] += dt * speed


@entry(nogil=True)
def run_steps(state, const, steps, history):
    """Make at most `steps` steps, a row of history (steps, COLUMNS) each; (steps made, why it ended or RUNNING)."""
    n = state.elongation.shape[1]
    work = scratch(state, const)
    for m in range(steps):
        for c in range(3):
            move(n, const.dt, state.dt_over_mass[c], state.f[c], state.v[c], state.u[c])
            push = const.free_dofs[c] * state.f_contact_nose[c]
            state.projectile_velocity[c] += const.dt * push / const.projectile_mass
            state.projectile_position[c] += const.dt * state.projectile_velocity[c]
        forces(state, const, work)
        contact(state, const)
        state.counter[STEP] += 1
        speed, row = state.projectile_velocity[2], history[m]
        row[Z], row[V_Z], row[NOSE_FORCE] = state.projectile_position[2], speed, state.f_contact_nose[2]
        row[CLAMP_FORCE] = 0.0
        for k in const.clamped_nodes:
            row[CLAMP_FORCE] -= state.f[2, k]
        for family in range(2):
            row[MIDDLE + family] = -2.0 * state.f[family, const.middle_end_nodes[family]]  # half of these yarns
        if not (abs(speed) < 1e9 and abs(state.energy_sums[VISCOUS]) < 1e30):
            return m + 1, NOT_FINITE
        if speed <= 0.0:
            return m + 1, STOPPED
    return steps, RUNNING
