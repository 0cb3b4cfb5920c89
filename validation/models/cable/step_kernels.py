"""The pin-jointed cable model: masses at the crossovers, joined by bars that only pull (thesis section 4.4.2).

Bars lie along warp and weft between neighbouring crossovers. A bar of natural length S0 whose nodes are L apart has

    e = max(L - S0, 0),   T = k e,   k = EA / S0     (crimp is slack, S0 > L at rest; erratum E-18: strain beyond crimp)

and pulls with T and, while taut, with a viscous force on its rate; never less than nothing in all. It fails where e
passes its limit, at once and for good. Time goes by central differences, forces standing at whole steps:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1) and L(n+1) - L(n)

Layout, as in `membrane_kernels`: arrays are flat, by component, node (i, j) in slot k = i s + j, s = nj + 1; the bar
along the warp from (i, j) to (i+1, j) and the bar along the weft from (i, j) to (i, j+1) have the slot k too. Where
there is no such bar, or no longer one, its stiffness is zero. Each loop has few arrays, so that it vectorises.
"""

import math

import numpy as np

from shellfabric.jit.compile import entry, kernel
from shellfabric.panel.motion_kernels import grow_active_rows
from validation.models.cable.contact_kernels import WARP, WEFT, contact_forces, mark_failed_bars, net_ahead_of_nose

RUNNING, STOPPED, PERFORATED, NOT_FINITE = 0, 1, 2, 3
STEP, IDLE, FAILURES = 0, 1, 2
VISCOUS, LOST = 0, 3  # of state.energy_sums, with CONTACT and SPRING
# columns of a history: the projectile's z, v_z and the force on it; the clamps' force on the cloth along z; the pulls
# of the middle warp and weft on their clamps, along the yarns at rest; the force along z that drives const.driven_node
Z, V_Z, NOSE_FORCE, CLAMP_FORCE, MIDDLE, DRIVE, COLUMNS = 0, 1, 2, 3, 4, 6, 7
WORK = 11  # rows of scratch
ONE = np.uint64(1)
FAST = {"reassoc", "contract", "nsz", "arcp"}
_MIN_VELOCITY = 1e-60
_MIN_LENGTH = 1e-12


@kernel(fastmath=FAST)
def differences(u, k0, n, offset, along, D):
    """One component of the vectors from node to node: D = along + u(other end) - u(this end)."""
    for j in range(n):
        k = k0 + j
        D[j] = along + (u[k + offset] - u[k])


@kernel(fastmath=FAST)
def lengths(n, dx, dy, dz, L):
    """Distances of the nodes of each bar."""
    for j in range(n):
        L[j] = math.sqrt(dx[j] * dx[j] + dy[j] * dy[j] + dz[j] * dz[j])


@kernel(fastmath=FAST)
def bar_forces(k0, n, S0, cv, stiff, L, L_old, drag_old, rate, e, a):
    """Axial force over the length of each bar, into a; its elongation; its rate per step. Returns the viscous work.

    cv : [-] viscous force per step's change of length, over the stiffness
    """
    work = 0.0
    for j in range(n):
        k = k0 + j
        length, stiffness = L[j], stiff[k]
        d = length - L_old[k]
        elongation = max(length - S0, 0.0)
        T = stiffness * elongation
        drag = cv * stiffness * d if T > 0.0 else 0.0
        drag = max(drag, -T)
        work += (drag + drag_old[k]) * d
        drag_old[k] = drag
        L_old[k] = length
        rate[j] = d
        e[j] = elongation if stiffness > 0.0 else 0.0
        a[j] = (T + drag) / max(length, _MIN_LENGTH)
    return 0.5 * work


@kernel(fastmath=FAST | {"nnan"})
def max_elongation(n, e):
    """Largest elongation; the solver checks that numbers are finite."""
    most = 0.0
    for j in range(n):
        most = max(most, e[j])
    return most


@kernel()
def remove_failed_bars(k0, n, limit, stiff, drag, rate, e, a):
    """Remove bars beyond their failure elongation. Returns (their energy, viscous work not done, failures).

    A step exchanges the mean of a bar's two forces times its change of length, and the last force of a failed bar is
    nothing: what is lost is the energy of the step before with half its force times the last change.
    """
    lost, undone, count = 0.0, 0.0, 0
    for j in range(n):
        if e[j] > limit:
            k = k0 + j
            lost += 0.5 * stiff[k] * max(e[j] - rate[j], 0.0) * e[j]
            undone += 0.5 * drag[k] * rate[j]
            stiff[k] = drag[k] = a[j] = 0.0
            count += 1
    return lost, undone, count


@kernel(fastmath={"contract", "nsz"})
def scatter_forces(k0, n, s, a1, D1, a2, D2, f):
    """One component of the forces on the nodes; scratch arrays begin one row before slot k0."""
    for j in range(n):
        here, back = j + s, j + s - ONE
        f[k0 + j] = (a1[here] * D1[here] - a1[j] * D1[j]) + (a2[here] * D2[here] - a2[back] * D2[back])


@kernel(fastmath={"contract", "nsz"})
def move_nodes(k0, n, dt, dt_over_mass, f, v, u):
    """Central-difference update of one component; dt_over_mass is 0 where the component is held."""
    for j in range(n):
        k = k0 + j
        speed = v[k] + dt_over_mass[k] * f[k]
        speed = speed if abs(speed) > _MIN_VELOCITY else 0.0
        v[k] = speed
        u[k] += dt * speed


@kernel()
def family_forces(state, const, family, k0, n, work, row):
    """Forces of one family of bars in the slots k0 .. k0 + n, into four rows of work: the three components, and a."""
    lead = const.row_stride
    dx, dy, dz, a = work[row, lead:], work[row + 1, lead:], work[row + 2, lead:], work[row + 3, lead:]
    L, rate, e = work[8], work[9], work[10]
    offset = np.uint64(const.row_stride) if family == WARP else ONE
    differences(state.u[0], k0, n, offset, const.dx if family == WARP else 0.0, dx)
    differences(state.u[1], k0, n, offset, const.dy if family == WEFT else 0.0, dy)
    differences(state.u[2], k0, n, offset, 0.0, dz)
    lengths(n, dx, dy, dz, L)
    stiff, drag = state.stiffness[family], state.viscous_force[family]
    viscous = bar_forces(k0, n, const.S0[family], const.cv, stiff, L, state.length[family], drag, rate, e, a)
    most = max_elongation(n, e)
    state.peak_elongation[family] = max(state.peak_elongation[family], most)
    if most > const.failure_elongation[family]:
        lost, undone, count = remove_failed_bars(k0, n, const.failure_elongation[family], stiff, drag, rate, e, a)
        state.energy_sums[LOST] += lost
        state.counter[FAILURES] += count
        viscous -= undone
    state.energy_sums[VISCOUS] += viscous


@kernel()
def forces(state, const, work):
    """Forces of all bars on the nodes of the active rows, block of rows by block."""
    first, last = state.active_rows[0], state.active_rows[1] + 1
    s = np.uint64(const.row_stride)
    work[0:8, 0 : const.row_stride] = 0.0
    for low in range(first, last, const.rows_per_block):
        high = min(low + const.rows_per_block, last)
        k0, n = np.uint64(low * const.row_stride), np.uint64((high - low) * const.row_stride)
        family_forces(state, const, WARP, k0, n, work, 0)
        family_forces(state, const, WEFT, k0, n, work, 4)
        for c in range(3):
            scatter_forces(k0, n, s, work[3], work[c], work[7], work[4 + c], state.f[c])
        for row in range(8):
            for j in range(s):
                work[row, j] = work[row, n + j]


@kernel()
def step(state, const, work):
    """One step (work: scratch); returns why it should be the last, or RUNNING."""
    first, last = state.active_rows[0], state.active_rows[1] + 1
    k0, n = np.uint64(first * const.row_stride), np.uint64((last - first) * const.row_stride)
    for c in range(3):
        move_nodes(k0, n, const.dt, state.dt_over_mass[c], state.f[c], state.v[c], state.u[c])
        state.projectile_velocity[c] += const.dt * const.free_dofs[c] * state.f_contact_nose[c] / const.projectile_mass
        state.projectile_position[c] += const.dt * state.projectile_velocity[c]
    grow_active_rows(state, const)
    failures = state.counter[FAILURES]
    forces(state, const, work)
    if state.counter[FAILURES] > failures:
        mark_failed_bars(state, const)
    contact_forces(state, const)
    state.counter[STEP] += 1
    if not (abs(state.projectile_velocity[2]) < 1e9 and abs(state.energy_sums[VISCOUS]) < 1e30):
        return NOT_FINITE
    if state.projectile_velocity[2] <= 0.0:
        return STOPPED
    # perforated: yarns have failed, nothing pushes, and nothing that holds is left in front, for a while
    idle = state.counter[FAILURES] > 0 and state.f_contact_nose[2] == 0.0 and not net_ahead_of_nose(state, const)
    state.counter[IDLE] = state.counter[IDLE] + 1 if idle else 0
    return PERFORATED if state.counter[IDLE] >= const.perforation_delay_steps else RUNNING


@kernel()
def record_step(state, const, row):
    """One row of the history (see COLUMNS)."""
    row[Z], row[V_Z], row[NOSE_FORCE] = (
        state.projectile_position[2],
        state.projectile_velocity[2],
        state.f_contact_nose[2],
    )
    edges = 0.0
    for k in const.clamped_nodes:
        edges -= state.f[2, k]
    row[CLAMP_FORCE] = edges
    for family in range(2):
        row[MIDDLE + family] = -state.f[family, const.middle_end_nodes[family]] / const.middle_yarn_fraction[family]
    row[DRIVE] = -state.f[2, const.driven_node]


@entry(nogil=True)
def run_steps(state, const, steps, history):
    """Make at most `steps` steps, a row of history (steps, COLUMNS) each; (steps made, why it ended or RUNNING)."""
    work = np.zeros((WORK, (const.rows_per_block + 1) * const.row_stride))
    for m in range(steps):
        reason = step(state, const, work)
        record_step(state, const, history[m])
        if reason != RUNNING:
            return m + 1, reason
    return steps, RUNNING


@entry(nogil=True)
def energies(state, const):
    """Kinetic energies of cloth and projectile, and the energy stored in the bars, at the present whole step.

    The kinetic ones are m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
    """
    cloth, stored, projectile = 0.0, 0.0, 0.0
    for k in range(state.mass.size):
        for c in range(3):
            v = state.v[c, k]
            cloth += 0.5 * state.mass[k] * v * (v + state.dt_over_mass[c, k] * state.f[c, k])
        for family in range(2):
            e = max(state.length[family, k] - const.S0[family], 0.0)
            stored += 0.5 * state.stiffness[family, k] * e * e
    for c in range(3):
        v = state.projectile_velocity[c]
        projectile += 0.5 * v * (const.projectile_mass * v + const.dt * const.free_dofs[c] * state.f_contact_nose[c])
    return cloth, projectile, stored
