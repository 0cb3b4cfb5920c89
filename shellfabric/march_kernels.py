"""One time step of the panel and its projectile, and many of them: central differences.

Velocities stand at half steps, everything else at whole ones:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1), v(n+1/2)

Only rows that motion can have reached are worked on, which is exact: an element whose nodes are all at rest has no
force on them. Velocities below 1e-60 m/s are set to zero, without which the
front of the wave would be preceded by denormal numbers.

The kernels that hand the state on allocate nothing and are compiled without numba's reference counts (_nrt=False): a
pair of them for each array of the state would cost as much as a hundred elements in every block.
"""

import numpy as np
from numba import njit

from shellfabric import contact_kernels, edges_kernels, membrane_kernels
from shellfabric.membrane_kernels import ERODED, ONE

RUNNING, STOPPED, PERFORATED, NOT_FINITE = 0, 1, 2, 3
VISCOUS, HOURGLASS, LOST = 0, 1, 2
STEP, IDLE, FAILURES = 0, 1, 2
_STILL = 1e-60


@njit(cache=True, fastmath={"contract", "nsz"}, error_model="numpy")
def move(k0, n, dt, kick, g0, g1, v, u):
    """One component of velocity and displacement of the nodes k0 .. k0 + n; kick = dt / m."""
    for j in range(n):
        k = k0 + j
        speed = v[k] + kick[k] * (g0[k] + g1[k])
        speed = speed if abs(speed) > _STILL else 0.0
        v[k] = speed
        u[k] += dt * speed


@njit(cache=True, error_model="numpy", _nrt=False)
def symmetry(state, const, first, last):
    """Take out the force across a plane of symmetry, on the node rows first .. last - 1."""
    if const.mirror_x and first == 0:
        for k in range(const.s):
            state.g0[0][k] = state.g1[0][k] = 0.0
    if const.mirror_y:
        for i in range(first, last):
            k = np.uint64(i * const.s)
            state.g0[1][k] = state.g1[1][k] = 0.0


@njit(cache=True, error_model="numpy", _nrt=False)
def moved(state, const, i):
    """Whether some node of row i has left its place."""
    for k in range(np.uint64(i * const.s), np.uint64((i + 1) * const.s)):
        if state.u[0][k] != 0.0 or state.u[1][k] != 0.0 or state.u[2][k] != 0.0:
            return True
    return False


@njit(cache=True, error_model="numpy", _nrt=False)
def widen(state, const):
    """Let the window of active element rows, state.rows, go ahead of the motion.

    A node row moves in this step only if an element row beside it has moved nodes already. So the outermost active row
    is let grow when its inner nodes have moved, which is a step before they can move its outer ones.
    """
    first, last = state.rows[0], state.rows[1]
    if first > 0 and (moved(state, const, first) or moved(state, const, first + 1)):
        state.rows[0] -= 1
    if last < const.ni and (moved(state, const, last) or moved(state, const, last - 1)):
        state.rows[1] += 1


@njit(cache=True, error_model="numpy")
def largest_of(n, values):
    """The largest of the first n values, at least 0."""
    largest = 0.0
    for j in range(n):
        largest = max(largest, values[j])
    return largest


@njit(cache=True, error_model="numpy", _nrt=False)
def elements(state, const, block, first, last, work):
    """Forces of the element rows first .. last, which lie in one block, from the present displacements."""
    s = np.uint64(const.s)
    k0, n = np.uint64(first * const.s), np.uint64((last - first) * const.s)
    u, v, A, B, H, dH = state.u, state.v, work.A, work.B, work.H, work.dH
    l1, l2, ia, ib, sine, T1, T2 = work.l1, work.l2, work.ia, work.ib, work.sine, work.T1, work.T2
    membrane_kernels.kinematics(u[0], v[0], k0, n, s, const.ra, const.rb, const.dt, 1.0, 0.0, A[0], B[0], H[0], dH[0])
    membrane_kernels.kinematics(u[1], v[1], k0, n, s, const.ra, const.rb, const.dt, 0.0, 1.0, A[1], B[1], H[1], dH[1])
    membrane_kernels.kinematics(u[2], v[2], k0, n, s, const.ra, const.rb, const.dt, 0.0, 0.0, A[2], B[2], H[2], dH[2])
    membrane_kernels.rest(n, s, A, B, H, dH)
    membrane_kernels.stretches(n, A[0], A[1], A[2], B[0], B[1], B[2], l1, l2, ia, ib, sine)
    peak1, peak2 = membrane_kernels.tensions(
        n, l1, l2, const.tension, const.x0t, const.rx, const.top1, const.y0t, const.ry, const.top2, T1, T2
    )
    N1, N2 = T1, T2
    if const.variational:
        N1, N2 = work.N1, work.N2
        membrane_kernels.potential_forces(
            n, l1, l2, const.potential, const.x0t, const.rx, const.top1, const.y0t, const.ry, const.top2,
            const.per1, const.per2, N1, N2,
        )  # fmt: skip
    for j in range(s - ONE, n, s):
        T1[j] = T2[j] = N1[j] = N2[j] = 0.0
    sums = state.sums
    if state.dirty[block] or peak1 > const.strength1 or peak2 > const.strength2:
        lost, viscous, count = membrane_kernels.settle_failures(
            k0, n, l1, l2, sine, T1, T2, N1, N2, H, dH, state, const
        )
        sums[block, LOST] += lost
        sums[block, VISCOUS] += viscous
        if count > 0:
            state.dirty[block] = True
            state.fresh[block] += count
        peak1, peak2 = largest_of(n, T1), largest_of(n, T2)
    state.peak[0], state.peak[1] = max(state.peak[0], peak1), max(state.peak[1], peak2)
    sums[block, VISCOUS] += membrane_kernels.yarn_work(
        k0, n, const.c1, const.cv1, l1, N1, state.L1, state.P1, state.D1, state.W, work.force1
    )
    sums[block, VISCOUS] += membrane_kernels.yarn_work(
        k0, n, const.c2, const.cv2, l2, N2, state.L2, state.P2, state.D2, state.W, work.force2
    )
    membrane_kernels.shear_slope(n, sine, const.V, const.G1, const.G2, const.gamma1, const.gamma2, work.slope)
    membrane_kernels.projections(
        n, work.force1, work.force2, work.slope, sine, ia, ib, const.ra, const.rb,
        work.on_a, work.cross_a, work.cross_b, work.on_b,
    )  # fmt: skip
    sums[block, HOURGLASS] += membrane_kernels.nodal_parts(
        k0, n, A[0], B[0], H[0], dH[0], work.on_a, work.cross_a, work.cross_b, work.on_b,
        const.kh, const.ch, state.dH[0], work.Q, work.R, work.G,
    )  # fmt: skip
    membrane_kernels.gather(k0, n, s, work.Q, work.R, work.G, state.g0[0], state.g1[0])
    sums[block, HOURGLASS] += membrane_kernels.nodal_parts(
        k0, n, A[1], B[1], H[1], dH[1], work.on_a, work.cross_a, work.cross_b, work.on_b,
        const.kh, const.ch, state.dH[1], work.Q, work.R, work.G,
    )  # fmt: skip
    membrane_kernels.gather(k0, n, s, work.Q, work.R, work.G, state.g0[1], state.g1[1])
    sums[block, HOURGLASS] += membrane_kernels.nodal_parts(
        k0, n, A[2], B[2], H[2], dH[2], work.on_a, work.cross_a, work.cross_b, work.on_b,
        const.kh, const.ch, state.dH[2], work.Q, work.R, work.G,
    )  # fmt: skip
    membrane_kernels.gather(k0, n, s, work.Q, work.R, work.G, state.g0[2], state.g1[2])


@njit(cache=True, error_model="numpy", _nrt=False)
def move_rows(state, const, first, last):
    """Move the node rows first .. last - 1 by one step."""
    symmetry(state, const, first, last)
    k0, n = np.uint64(first * const.s), np.uint64((last - first) * const.s)
    move(k0, n, const.dt, state.kick, state.g0[0], state.g1[0], state.v[0], state.u[0])
    move(k0, n, const.dt, state.kick, state.g0[1], state.g1[1], state.v[1], state.u[1])
    move(k0, n, const.dt, state.kick, state.g0[2], state.g1[2], state.v[2], state.u[2])


@njit(cache=True, error_model="numpy", _nrt=False)
def sweep(state, const, work):
    """Move the active nodes, and find the forces of the active elements, block by block while they are in cache.

    The blocks are fixed, whatever the window. Those rows of a block that its elements need are moved first.
    """
    first, last = state.rows[0], state.rows[1]
    move_rows(state, const, first, first + 1)
    for block in range(first // const.block, (last + const.block - 1) // const.block):
        low, high = max(first, block * const.block), min(last, (block + 1) * const.block)
        move_rows(state, const, low + 1, high + 1)
        elements(state, const, block, low, high, work)


@njit(cache=True, error_model="numpy", _nrt=False)
def step(state, const, work):
    """One step; returns why it should be the last, or RUNNING."""
    contact_kernels.push(state, const)
    for c in range(3):
        state.position[c] += const.dt * state.speed[c]
    widen(state, const)
    sweep(state, const, work)
    failures = state.fresh.sum()
    state.counter[FAILURES] = failures
    taken, spring = contact_kernels.contact(state, const, work.x, work.v)
    state.contact_energy[0] += taken
    state.contact_energy[1] = spring
    state.counter[STEP] += 1
    edges_kernels.hold(state, const, state.counter[STEP] * const.dt)
    if not abs(state.speed[2]) < 1e9:
        return NOT_FINITE
    if state.speed[2] <= 0.0:
        return STOPPED
    # perforated: yarns have failed, nothing pushes, and nothing that is held is left in front, for a while
    idle = failures > 0 and state.reaction[2] == 0.0 and not contact_kernels.in_the_way(state, const, work.x, work.v)
    state.counter[IDLE] = state.counter[IDLE] + 1 if idle else 0
    return PERFORATED if state.counter[IDLE] >= const.idle_steps else RUNNING


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def advance(state, const, work, steps, history):
    """March at most `steps` steps. history (steps, 3): the projectile's foremost z, v_z and the force on it after each.

    Returns (steps made, RUNNING or the reason to end).
    """
    for m in range(steps):
        reason = step(state, const, work)
        history[m, 0] = state.position[2] + const.top
        history[m, 1] = state.speed[2]
        history[m, 2] = state.reaction[2]
        if reason != RUNNING:
            return m + 1, reason
    return steps, RUNNING


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def first_forces(state, const, work):
    """Forces of the cloth as it is, before the first step."""
    for block in range((const.ni + const.block - 1) // const.block):
        elements(state, const, block, block * const.block, min(const.ni, (block + 1) * const.block), work)


@njit(cache=True, nogil=True, error_model="numpy")
def energies(state, const, out):
    """The energy audit at the present whole step, into out (4): kinetic of the cloth, stored, shear, hourglass springs.

    Kinetic energy is m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
    """
    out[:] = 0.0
    s = np.uint64(const.s)
    for i in range(const.ni + 1):
        for j in range(const.nj + 1):
            k = i * const.s + j
            for c in range(3):
                if state.inverse_mass[k] == 0.0 or (c == 0 and i == 0 and const.mirror_x):
                    continue
                if c == 1 and j == 0 and const.mirror_y:
                    continue
                v = state.v[c][k]
                f = state.g0[c][k] + state.g1[c][k] + state.contact[c][k]
                out[0] += 0.5 * state.mass[k] * v * (v + const.dt * state.inverse_mass[k] * f)
    for i in range(const.ni):
        for j in range(const.nj):
            k = np.uint64(i * const.s + j)
            out[1] += state.W[k]
            if state.flag[k] == 0:
                out[2] += membrane_kernels.shear_energy(
                    sine_of(state.u, k, const), const.V, const.G1, const.G2, const.gamma1, const.gamma2
                )
            if state.flag[k] & ERODED:
                continue
            for c in range(3):
                u = state.u[c]
                h = (u[k + s + ONE] - u[k + ONE]) - (u[k + s] - u[k])
                out[3] += 0.5 * const.kh * h * h


@njit(cache=True, error_model="numpy")
def sine_of(u, k, const):
    """sin(gamma) of the element in slot k, as `membrane_kernels.stretches` has it."""
    s = np.uint64(const.s)
    aa, bb, ab = 0.0, 0.0, 0.0
    for c in range(3):
        u00, u01, u10, u11 = u[c][k], u[c][k + ONE], u[c][k + s], u[c][k + s + ONE]
        a = const.ra * (u10 - u00 + u11 - u01) + (1.0 if c == 0 else 0.0)
        b = const.rb * (u01 - u00 + u11 - u10) + (1.0 if c == 1 else 0.0)
        aa, bb, ab = aa + a * a, bb + b * b, ab + a * b
    return ab / np.sqrt(aa * bb)
