"""Steps of the pin-jointed cable net (`cable.net`).

Arrays are flat, by component: node (i, j) in slot k = i s + j, s = nj + 1; the bar along the warp from (i, j) to
(i+1, j) and the bar along the weft from (i, j) to (i, j+1) have the slot k too. Where there is no such bar its
stiffness is zero. The contact is the shell's own, on the surface whose control points are the nodes
(`contact_kernels`), so that the two models differ in what lies under that surface alone.
"""

import math

from shellfabric.jit.compile import entry, kernel
from shellfabric.projectile import contact_kernels
from shellfabric.projectile.window_kernels import place_near_nose

# places in `spent`
VISCOUS = 0
CONTACT = 1
# columns of a history: the projectile's z, v_z and the force on it; the clamps' force on the net along z; the pulls
# of the middle warp and weft on their clamps, along the yarns at rest
Z = 0
V_Z = 1
NOSE_FORCE = 2
CLAMP_FORCE = 3
MIDDLE = 4
COLUMNS = 6
_MIN_VELOCITY = 1e-60
_MIN_LENGTH = 1e-12


@kernel(fastmath={"reassoc", "contract", "nsz", "arcp"})
def pull(x, y, z, offset, along, across, S0, cv, stiffness, length, drag, P):
    """Add the pulls of one family of bars on their near nodes to P. Returns the viscous work of the
    step.

    cv : [-] viscous force per step's change of length, over the stiffness
    length, drag : [m] of the bars, [N] their viscous forces; those of the step before, replaced by those of this one
    """
    work = 0.0
    for k in range(P.shape[1]):
        dx = along + (x[k + offset] - x[k])
        dy = across + (y[k + offset] - y[k])
        dz = z[k + offset] - z[k]
        now = math.sqrt(dx * dx + dy * dy + dz * dz)
        change = now - length[k]
        T = stiffness[k] * max(now - S0, 0.0)
        viscous = max(cv * stiffness[k] * change if T > 0.0 else 0.0, -T)
        work += 0.5 * (viscous + drag[k]) * change
        drag[k] = viscous
        length[k] = now
        force = (T + viscous) / max(now, _MIN_LENGTH)
        P[0, k] = force * dx
        P[1, k] = force * dy
        P[2, k] = force * dz
    return work


@kernel()
def forces(state, const, S0, cv, stiffness, length, drag, pulls, scratch, spent):
    """Add the forces of all bars and of the projectile on the nodes to state.f_int."""
    s = const.row_stride
    n = pulls.shape[2] - const.row_stride
    x, y, z = state.u
    # both begin one row before slot 0
    P = pulls[0]
    Q = pulls[1]
    for family in range(2):
        along, across, offset = (const.dx, 0.0, s) if family == 0 else (0.0, const.dy, 1)
        spent[VISCOUS] += pull(
            x,
            y,
            z,
            offset,
            along,
            across,
            S0[family],
            cv,
            stiffness[family],
            length[family],
            drag[family],
            pulls[family, :, s:],
        )
    place_near_nose(state, const)
    taken, _ = contact_kernels.contact_forces(state, const, scratch)
    spent[CONTACT] += taken
    for c in range(3):
        f = state.f_int[c]
        push = state.f_contact[c]
        for k in range(n):
            f[k] = (P[c, k + s] - P[c, k]) + (Q[c, k + s] - Q[c, k + s - 1]) + push[k]


@entry()
def march(
    state,
    const,
    kick,
    S0,
    cv,
    stiffness,
    length,
    drag,
    pulls,
    scratch,
    spent,
    clamped,
    ends,
    history,
):
    """Make a step for each row of history (steps, COLUMNS), until the projectile has stopped; the number of steps.

    Central differences: kick is dt over the mass of each component of the nodes, 0 where it is held.
    """
    n = pulls.shape[2] - const.row_stride
    for m in range(len(history)):
        for c in range(3):
            u = state.u[c]
            v = state.v[c]
            f = state.f_int[c]
            for k in range(n):
                speed = v[k] + kick[c, k] * f[k]
                v[k] = speed if abs(speed) > _MIN_VELOCITY else 0.0
                u[k] += const.dt * v[k]
            push = const.free_dofs[c] * state.f_contact_nose[c]
            state.projectile_velocity[c] += const.dt * push / const.projectile_mass
            state.projectile_position[c] += const.dt * state.projectile_velocity[c]
        forces(state, const, S0, cv, stiffness, length, drag, pulls, scratch, spent)
        row = history[m]
        row[Z] = state.projectile_position[2]
        row[V_Z] = state.projectile_velocity[2]
        row[NOSE_FORCE] = state.f_contact_nose[2]
        row[CLAMP_FORCE] = 0.0
        for k in clamped:
            row[CLAMP_FORCE] -= state.f_int[2][k]
        for family in range(2):
            row[MIDDLE + family] = -2.0 * state.f_int[family][ends[family]]  # half of these yarns
        if row[V_Z] <= 0.0:
            return m + 1
    return len(history)
