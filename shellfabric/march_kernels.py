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

from shellfabric import bending_kernels, contact_kernels, edges_kernels, failure_kernels, membrane_kernels
from shellfabric.membrane_kernels import ONE

RUNNING, STOPPED, PERFORATED, NOT_FINITE = 0, 1, 2, 3
WORK, VISCOUS, LOST, TORN = 0, 1, 2, 3  # of state.sums; what is lost with failed yarns, and with trellis and turns
KINETIC, STORED, SHEAR, BENDING = 0, 1, 2, 3  # of `energies`
WHOLE, THINNED, AGAIN = 0, 1, 2  # of state.thin: a block without failures, with some, with some of this step
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

    The forces of a node reach two rows further than the nodes that have moved: over the segments that cross, and in the
    variational form over those that cross these. So in a step motion goes ahead by two rows at most, and its forces by
    two more, and there is a window in time if its outer four rows are kept at rest.
    """
    for _ in range(2):
        first, last = state.rows[0], state.rows[1]
        stirred = False
        for i in range(first, min(first + 4, const.ni + 1)):
            stirred = stirred or moved(state, const, i)
        if first > 0 and stirred:
            state.rows[0] -= 1
        stirred = False
        for i in range(max(last - 3, 0), last + 1):
            stirred = stirred or moved(state, const, i)
        if last < const.ni and stirred:
            state.rows[1] += 1


@njit(cache=True, error_model="numpy", _nrt=False)
def elements(state, const, block, first, last, work):
    """Forces of the element rows first .. last - 1, which lie in one block, from the present displacements."""
    s, thin = np.uint64(const.s), state.thin[block] != WHOLE
    n, m0 = np.uint64((last - first) * const.s), np.uint64(2 * const.s)
    k0 = np.uint64(first * const.s)
    n2 = n + s if last == const.ni else n  # weft edges: those on the far side of the panel have no row of their own
    stretch(state, const, first, last, work)
    shift = (first - 2) * const.s
    if thin:
        low = max(first - 1, 0)
        failure_kernels.thin_means(const, state, 0, low, last, shift, work.l2, work.m2)
        failure_kernels.thin_means(const, state, 1, first, last + 1, shift, work.l1, work.m1)
    low, T1, T2, N1, N2, most = max(first - 1, 0), work.T1, work.T2, work.T1, work.T2, state.most[block]
    m1, near, far = np.uint64((low - first + 2) * const.s), np.uint64((last - low) * const.s), n + s
    c, w = const, work
    membrane_kernels.place(m1, near, w.l1, c.x0t, c.rx, c.top1, w.p1, w.q1)
    membrane_kernels.place(m1, near, w.m2, c.y0t, c.ry, c.top2, w.p2, w.q2)
    membrane_kernels.place(m0, far, w.m1, c.x0t, c.rx, c.top1, w.p3, w.q3)
    membrane_kernels.place(m0, far, w.l2, c.y0t, c.ry, c.top2, w.p4, w.q4)
    most[0] = membrane_kernels.tensions(m0, n, w.p1, w.q1, w.p2, w.q2, c.tension1, c.across, T1)
    most[1] = membrane_kernels.tensions(m0, n2, w.p3, w.q3, w.p4, w.q4, c.tension2, c.across, T2)
    if thin:
        failure_kernels.thin_forces(const, state, 0, first, last, shift, work.l1, T1)
        failure_kernels.thin_forces(const, state, 1, first, last + 1, shift, work.l2, T2)
        most[0], most[1] = membrane_kernels.largest(m0, n, T1), membrane_kernels.largest(m0, n2, T2)
    if const.variational:
        N1, N2 = work.N1, work.N2
        gradient(state, const, first, last, thin, work)
        record(k0, m0, n, T1, state.T[0])
        record(k0, m0, n2, T2, state.T[1])
    advance_yarns(state, const, block, k0, m0, n, n2, N1, N2, work)
    trellis(state, const, first, last, thin, work)
    rx, ry, X, Y = const.rx0, const.ry0, work.X, work.Y
    membrane_kernels.pulls(m0, n, ONE, rx, work.force1, work.turn1, work.i1, work.on1)
    membrane_kernels.pulls(m0, n2, s, ry, work.force2, work.turn2, work.i2, work.on2)
    for x in range(3):
        A, B, g0, g1 = work.A[x], work.B[x], state.g0[x], state.g1[x]
        membrane_kernels.times(m0, n, s, work.cross, B, X)
        membrane_kernels.times(m0, n, ONE, work.cross, A, Y)
        membrane_kernels.gather(k0, m0, n, rx, ry, work.on1, A, work.on2, B, X, Y, g0)
        membrane_kernels.gather_next(k0 + s, m0, n, rx, ry, work.on1, A, X, Y, g1)
        if last == const.ni:
            membrane_kernels.gather_last(k0 + n, m0 + n, s, work.on2, B, g0)


@njit(cache=True, error_model="numpy", _nrt=False)
def stretch(state, const, first, last, work):
    """Edge vectors, stretches, and means of the crossing stretches, of a block's rows and one beyond at each end."""
    s = np.uint64(const.s)
    low, high = max(first - 1, 0), min(last + 1, const.ni)
    k0, m0 = np.uint64(low * const.s), np.uint64((low - first + 2) * const.s)
    n1, n2 = np.uint64((high - low) * const.s), np.uint64((min(last, const.ni) - low + 1) * const.s)
    A, B, u = work.A, work.B, state.u
    membrane_kernels.edges(u[0], k0, m0, n1, s, const.rx0, 1.0, A[0])
    membrane_kernels.edges(u[1], k0, m0, n1, s, const.rx0, 0.0, A[1])
    membrane_kernels.edges(u[2], k0, m0, n1, s, const.rx0, 0.0, A[2])
    membrane_kernels.edges(u[0], k0, m0, n2, ONE, const.ry0, 0.0, B[0])
    membrane_kernels.edges(u[1], k0, m0, n2, ONE, const.ry0, 1.0, B[1])
    membrane_kernels.edges(u[2], k0, m0, n2, ONE, const.ry0, 0.0, B[2])
    membrane_kernels.rest(m0, n2, s, B)
    membrane_kernels.stretches(m0, n1, A[0], A[1], A[2], work.l1, work.i1)
    membrane_kernels.stretches(m0, n2, B[0], B[1], B[2], work.l2, work.i2)
    if first == 0:
        membrane_kernels.copy(s, np.uint64(2) * s, s, work.l1)
    if last == const.ni:
        end = np.uint64((last - first + 2) * const.s)
        membrane_kernels.copy(s, end - s, end, work.l1)
    membrane_kernels.across_warp(m0, np.uint64((last - low) * const.s), s, work.l2, work.m2)
    membrane_kernels.across_weft(np.uint64(2) * s, np.uint64((last - first + 1) * const.s), s, work.l1, work.m1)


@njit(cache=True, error_model="numpy", _nrt=False)
def gradient(state, const, first, last, thin, work):
    """Forces of the variational form, into work.N1 and work.N2 (see `membrane_kernels`)."""
    s, c, w, low = np.uint64(const.s), const, work, max(first - 1, 0)
    m0, m1 = np.uint64(2 * const.s), np.uint64((low - first + 2) * const.s)
    n, n1, n2 = (last - first) * const.s, np.uint64((last - low) * const.s), np.uint64((last - first + 1) * const.s)
    membrane_kernels.potential_forces(
        m1, n1, w.p1, w.q1, w.p2, w.q2, c.potential, c.across, c.per1, c.per2, w.own1, w.given1
    )
    membrane_kernels.potential_forces(
        m0, n2, w.p3, w.q3, w.p4, w.q4, c.potential, c.across, c.per1, c.per2, w.given2, w.own2
    )
    if first == 0:
        membrane_kernels.copy(s, m0, s, work.given1)
    if last == const.ni:
        end = np.uint64((last - first + 2) * const.s)
        membrane_kernels.copy(s, end - s, end, work.given1)
    n, shift = np.uint64(n), (first - 2) * const.s
    if thin:
        failure_kernels.thin_gradient(const, state, 0, first, last, shift, work.l1, work.own1, work.given2, work.N1)
        failure_kernels.thin_gradient(const, state, 1, first, last + 1, shift, work.l2, work.own2, work.given1, work.N2)
        return
    membrane_kernels.across_warp(m0, n, s, work.given2, work.on1)
    membrane_kernels.halves(m0, n, work.own1, work.on1, work.N1)
    membrane_kernels.across_weft(m0, n2, s, work.given1, work.on2)
    membrane_kernels.halves(m0, n2, work.own2, work.on2, work.N2)


@njit(cache=True, error_model="numpy")
def record(k0, m0, n, x, kept):
    """Keep scratch in the panel's slots."""
    for j in range(n):
        kept[k0 + j] = x[m0 + j]


@njit(cache=True, error_model="numpy", _nrt=False)
def advance_yarns(state, const, block, k0, m0, n, n2, N1, N2, work):
    """Forces of the block's edges along themselves, with the viscous ones, and what they work."""
    L, N, D, y = state.L, state.N, state.D, state.y
    if state.thin[block] == AGAIN:
        membrane_kernels.yarn_again(k0, m0, n, const.cv1, N1, y[0], N[0], D[0], work.force1)
        membrane_kernels.yarn_again(k0, m0, n2, const.cv2, N2, y[1], N[1], D[1], work.force2)
        return
    done1, viscous1 = membrane_kernels.yarn_work(k0, m0, n, const.cv1, work.l1, N1, y[0], L[0], N[0], D[0], work.force1)
    done2, viscous2 = membrane_kernels.yarn_work(
        k0, m0, n2, const.cv2, work.l2, N2, y[1], L[1], N[1], D[1], work.force2
    )
    state.sums[block, WORK] += done1 + done2
    state.sums[block, VISCOUS] += viscous1 + viscous2


@njit(cache=True, error_model="numpy", _nrt=False)
def trellis(state, const, first, last, thin, work):
    """The trellis of the block's quadrilaterals and of the row before them, which shares their first weft edges."""
    s, low, A, B, l1, l2 = np.uint64(const.s), max(first - 1, 0), work.A, work.B, work.l1, work.l2
    m0, n = np.uint64((low - first + 2) * const.s), np.uint64((last - low) * const.s)
    membrane_kernels.shear(m0, n, s, A[0], A[1], A[2], B[0], B[1], B[2], l1, l2, work.sine)
    for j in range(m0 + s - ONE, m0 + n, s):
        work.sine[j] = 0.0
    membrane_kernels.shear_slope(m0, n, work.sine, const.V, const.G1, const.G2, const.gamma1, const.gamma2, work.slope)
    if thin:
        failure_kernels.thin_trellis(const, state, low, last, (first - 2) * const.s, work.slope)
    membrane_kernels.turn(m0, n, ONE, work.slope, work.sine, l1, work.turn1)
    membrane_kernels.turn(m0, n, s, work.slope, work.sine, l2, work.turn2)
    membrane_kernels.cross(m0, n, s, work.slope, l1, l2, work.cross)
    # beyond the panel there is none
    if first == 0:
        for j in range(s, s + s):
            work.turn1[j] = work.turn2[j] = work.X[j] = work.Y[j] = 0.0
    if last == const.ni:
        for j in range(m0 + n, m0 + n + s):
            work.turn2[j] = 0.0


@njit(cache=True, error_model="numpy", _nrt=False)
def fail(state, const, work):
    """Let yarns fail, and find the forces about them again."""
    first, last = state.rows[0], state.rows[1]
    most1, most2 = 0.0, 0.0
    for block in range(first // const.block, (last + const.block - 1) // const.block):
        most1, most2 = max(most1, state.most[block, 0]), max(most2, state.most[block, 1])
    # the mean over a yarn is no higher than the highest of its edges
    if (
        const.lag == 0.0
        and most1 <= min(state.peak[0], const.strength1)
        and most2 <= min(state.peak[1], const.strength2)
    ):
        return
    # looking for failures cuts yarns: what was before is asked for first where there may be one
    near = const.lag > 0.0 or most1 > const.strength1 or most2 > const.strength2
    stored, sheared, worked, damped = 0.0, 0.0, 0.0, 0.0
    if near:
        stored, sheared = failure_kernels.stored_energy(const, state, first, last)
        sheared += bending_kernels.bend(state, const, first, last, False)
        worked, damped = failure_kernels.half_step_work(const, state, first, last)
    count = failure_kernels.look_for_failures(const, state, 0, first, last)
    count += failure_kernels.look_for_failures(const, state, 1, first, last)
    if count == 0:
        return
    state.counter[FAILURES] += count
    for block in range(first // const.block, (last + const.block - 1) // const.block):
        if state.thin[block] == AGAIN:
            low, high = max(first, block * const.block), min(last, (block + 1) * const.block)
            elements(state, const, block, low, high, work)
            state.thin[block] = THINNED
    now_stored, now_sheared = failure_kernels.stored_energy(const, state, first, last)
    now_sheared += bending_kernels.bend(state, const, first, last, False)
    now_worked, now_damped = failure_kernels.half_step_work(const, state, first, last)
    state.sums[0, WORK] += now_worked - worked
    state.sums[0, VISCOUS] += now_damped - damped
    state.sums[0, LOST] += stored - now_stored + now_worked - worked
    state.sums[0, TORN] += sheared - now_sheared


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

    The blocks are fixed, whatever the window. The node rows that the elements of a block need are moved first: its
    own, and one beyond.
    """
    first, last = state.rows[0], state.rows[1]
    done = min(first + 2, last + 1)
    move_rows(state, const, first, done)
    for block in range(first // const.block, (last + const.block - 1) // const.block):
        low, high = max(first, block * const.block), min(last, (block + 1) * const.block)
        ahead = min(high + 2, last + 1)
        move_rows(state, const, done, ahead)
        done = ahead
        elements(state, const, block, low, high, work)


@njit(cache=True, error_model="numpy", _nrt=False)
def step(state, const, work):
    """One step; returns why it should be the last, or RUNNING."""
    contact_kernels.push(state, const)
    for c in range(3):
        state.position[c] += const.dt * state.speed[c]
    widen(state, const)
    sweep(state, const, work)
    fail(state, const, work)
    bending_kernels.bend(state, const, state.rows[0], state.rows[1], True)
    failures = state.counter[FAILURES]
    taken, spring = contact_kernels.contact(state, const, work.x, work.v, work.strip)
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
    bending_kernels.bend(state, const, 0, const.ni, True)


@njit(cache=True, nogil=True, error_model="numpy")
def energies(state, const, out):
    """The energy audit at the present whole step, into out (4): kinetic, of the yarns, of the trellis, of turns.

    Kinetic energy is m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
    """
    out[:] = 0.0
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
                out[KINETIC] += 0.5 * state.mass[k] * v * (v + const.dt * state.inverse_mass[k] * f)
    out[STORED], out[SHEAR] = failure_kernels.stored_energy(const, state, 0, const.ni)
    out[BENDING] = bending_kernels.bend(state, const, 0, const.ni, False)
