"""Explicit time steps of the panel and its projectile: central differences.

Velocities stand at half steps, everything else at whole ones:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1), v(n+1/2)

Only rows that motion can have reached are worked on, which is exact: an element whose nodes are all at rest has no
force on them. Velocities below 1e-60 m/s are set to zero, without which the
front of the wave would be preceded by denormal numbers.

The kernels that hand the state on allocate nothing and are compiled without numba's reference counts (_nrt=False): a
pair of them for each array of the state would cost as much as a hundred elements in every block.
"""

import numpy as np

from shellfabric.cloth import (
    bending_kernels,
    boundary_kernels,
    energy_kernels,
    failure_kernels,
    jamming_kernels,
    membrane_kernels,
)
from shellfabric.jit.barrier import STOP, meet
from shellfabric.jit.compile import entry, kernel
from shellfabric.jit.simd import WIDTH, above, fabs, fma, keep, load, where
from shellfabric.projectile import bar_kernels, contact_kernels

RUNNING, STOPPED, PERFORATED, NOT_FINITE, CHECK = 0, 1, 2, 3, 4  # CHECK: energy is to be audited before the next step
# of state.sums; what is lost with failed yarns, and with trellis and turns; what yarns do not store of the work
WORK, VISCOUS, LOST, TORN, OVER = 0, 1, 2, 3, 4
KINETIC, STORED, SHEAR, BENDING, JAM = 0, 1, 2, 3, 4  # of `energies`
WHOLE, THINNED, AGAIN = 0, 1, 2  # of state.thin: a block without failures, with some, with some of this step
STEP, IDLE, FAILURES = 0, 1, 2
_STILL = 1e-60


@kernel()
def move(k0, n, dt, kick, g0, g1, both, v, u):
    """Central-difference update of the nodes k0 .. k0 + n: forces f_int [N], or `both` f_int + f_int_above."""
    for j in range(0, n, WIDTH):
        k, left = k0 + j, n - j
        impulse = load(kick, k)
        for c in range(3):
            force = load(g0[c], k)
            if both:
                force = force + load(g1[c], k)
            speed = fma(impulse, force, load(v[c], k))
            speed = where(above(fabs(speed), _STILL), speed, 0.0)
            keep(v[c], k, speed, left)
            keep(u[c], k, fma(speed, dt, load(u[c], k)), left)


@kernel(_nrt=False, forceinline=True)
def symmetry(state, const, first, last):
    """Zero the force across planes of symmetry, on the node rows first .. last - 1."""
    if const.mirror_x and first == 0:
        for k in range(const.s):
            state.g0[0][k] = state.g1[0][k] = 0.0
    if const.mirror_y:
        for i in range(first, last):
            k = np.uint64(i * const.s)
            state.g0[1][k] = state.g1[1][k] = 0.0


@kernel(_nrt=False)
def moved(state, const, i):
    """Whether a node of row i has a displacement."""
    for k in range(np.uint64(i * const.s), np.uint64((i + 1) * const.s)):
        if state.u[0][k] != 0.0 or state.u[1][k] != 0.0 or state.u[2][k] != 0.0:
            return True
    return False


@kernel(_nrt=False, forceinline=True)
def widen(state, const):
    """Grow the window of active element rows, state.rows, ahead of the motion.

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


@kernel(_nrt=False)
def elements(state, const, block, first, last, work):
    """Internal forces of the element rows first .. last - 1 of one block, from the present displacements."""
    s, thin = const.s, state.thin[block] != WHOLE
    k0, n = first * s, (last - first) * s
    n2 = n + s if last == const.ni else n  # weft edges: those on the far side of the panel have no row of their own
    stretch(state, const, first, last, thin, work)
    trellis(state, const, first, last, thin, work)
    N1, N2 = work.T1, work.T2
    if const.variational:
        N1, N2 = work.N1, work.N2
        slack = gradient(state, const, block, first, last, thin, work)
    if not (const.variational and slack):
        look_up(state, const, block, first, last, thin, work)
    advance_yarns(state, const, block, k0, n, n2, N1, N2, work)
    give(state, const, block, first, last, work)


@kernel(_nrt=False, forceinline=True)
def give(state, const, block, first, last, work):
    """Scatter the element forces of a block to its nodes, and to the first row of nodes of the next block.

    A row of nodes in whose middle of a block the window begins or ends is at rest: it keeps the forces that it has.
    """
    s, k0, m0, n, w = const.s, first * const.s, 2 * const.s, (last - first) * const.s, work
    g0, kept, within = state.g0, work.i1, first > block * const.block
    if within:
        for c in range(3):
            for j in range(s):
                kept[c * s + j] = g0[c][k0 + j]
    membrane_kernels.gather(k0, m0, n, s, const.rx0, const.ry0, w.A, w.B, w.on1, w.on2, w.cross, w.up, g0)
    if within:
        for c in range(3):
            for j in range(s):
                g0[c][k0 + j] = kept[c * s + j]
    if last == const.ni:
        membrane_kernels.gather_last(k0 + n, m0 + n, s, w.on2, w.B, w.up, g0)
    elif last == (block + 1) * const.block:
        for c in range(3):
            record(k0 + n, m0 + n, s, w.up[c], state.g1[c])


@kernel(_nrt=False, forceinline=True)
def stretch(state, const, first, last, thin, work):
    """Edge vectors, stretches, and means of the crossing stretches, of a block's rows and one beyond at each end."""
    s, w = const.s, work
    low = max(first - 1, 0)
    m0, n = (low - first + 2) * s, (last - low + 1) * s
    membrane_kernels.edges(low * s, m0, n, s, state.u, const.rx0, const.ry0, w.A, w.B, w.l1, w.i1, w.l2, w.i2)
    membrane_kernels.rest(m0, n, s, w.B, w.l2, w.i2)
    if first == 0:
        membrane_kernels.copy(s, 2 * s, s, w.l1)
    if last == const.ni:
        end = (last - first + 2) * s
        membrane_kernels.copy(s, end - s, end, w.l1)
    membrane_kernels.across_warp(low * s, m0, (last - low) * s, s, const.split2, w.l2, w.m2)
    membrane_kernels.across_weft(first * s, 2 * s, (last - first + 1) * s, s, const.split1, w.l1, w.m1)
    if thin:
        shift = (first - 2) * s
        failure_kernels.thin_means(const, state, 0, low, last, shift, w.l2, w.m2)
        failure_kernels.thin_means(const, state, 1, first, last + 1, shift, w.l1, w.m1)


@kernel(_nrt=False, forceinline=True)
def look_up(state, const, block, first, last, thin, work):
    """Interpolate the tensions of a block's edges from the cell table; the largest of each family."""
    s, c, w, most = const.s, const, work, state.most[block]
    k0, m0, n = first * s, 2 * s, (last - first) * s
    n2, shift = n + s if last == c.ni else n, (first - 2) * s
    most[0] = membrane_kernels.tensions(m0, n, w.l1, w.m2, c.grid, c.tension1, w.T1)
    most[1] = membrane_kernels.tensions(m0, n2, w.m1, w.l2, c.grid, c.tension2, w.T2)
    if thin:
        failure_kernels.thin_forces(const, state, 0, first, last, shift, w.l1, w.T1)
        failure_kernels.thin_forces(const, state, 1, first, last + 1, shift, w.l2, w.T2)
        most[0], most[1] = membrane_kernels.largest(m0, n, w.T1), membrane_kernels.largest(m0, n2, w.T2)
    if c.variational:
        record(k0, m0, n, w.T1, state.T[0])
        record(k0, m0, n2, w.T2, state.T[1])
        state.stale[block] = False


@kernel(_nrt=False)
def bound(const, p, q, N, unit, ceiling):
    """Upper bound [N] of the tensions of a family, from the largest table coordinates and the largest force N.

    p, q in cells of the table; unit, ceiling : see `cell_kernels.ceiling`.
    """
    if not (p <= const.top1 + 1 and q <= const.top2 + 1 and N < unit * ceiling.shape[0]):
        return np.inf
    step = int(N / unit)
    return max(ceiling[step, 0], N + ceiling[step, 1])


@kernel(_nrt=False)
def freshen(state, const, first, last, work):
    """Update the stale tensions of the blocks first .. last - 1 (lazy evaluation)."""
    for block in range(first, last):
        if state.stale[block]:
            low, high = max(state.rows[0], block * const.block), min(state.rows[1], (block + 1) * const.block)
            stretch(state, const, low, high, False, work)
            look_up(state, const, block, low, high, False, work)


@kernel(_nrt=False, forceinline=True)
def gradient(state, const, block, first, last, thin, work):
    """Forces of the variational form, into work.N1 and work.N2 (see `membrane_kernels`).

    Returns whether no tension can be past the peak so far or a strength, so that none need be looked up.
    """
    s, c, w, low = const.s, const, work, max(first - 1, 0)
    m0, m1 = 2 * s, (low - first + 2) * s
    n, n1, n2 = (last - first) * s, (last - low) * s, (last - first + 1) * s
    p1, q1, high1, _ = membrane_kernels.potential_forces(
        m1, n1, w.l1, w.m2, c.grid, c.spline, c.per1, c.per2, 2.0 * c.per1 * c.rx, 0.0, w.spots, w.own1, w.given1, w.K1
    )
    p2, q2, _, high2 = membrane_kernels.potential_forces(
        m0, n2, w.m1, w.l2, c.grid, c.spline, c.per1, c.per2, 0.0, 2.0 * c.per2 * c.ry, w.spots, w.given2, w.own2, w.K2
    )
    if first == 0:
        membrane_kernels.copy(s, m0, s, work.given1)
    if last == const.ni:
        end = (last - first + 2) * s
        membrane_kernels.copy(s, end - s, end, work.given1)
    shift = (first - 2) * s
    if thin:
        failure_kernels.thin_gradient(const, state, 0, first, last, shift, w.l1, w.own1, w.given2, w.N1, w.K1)
        failure_kernels.thin_gradient(const, state, 1, first, last + 1, shift, w.l2, w.own2, w.given1, w.N2, w.K2)
        return False
    membrane_kernels.share_warp(first * s, m0, n, s, c.split2, work.own1, work.given2, work.N1)
    membrane_kernels.share_weft(first * s, m0, n2, s, c.split1, work.own2, work.given1, work.N2)
    most = state.most[block]
    most[0] = bound(const, p1, q1, high1, c.unit1, c.ceiling1)
    most[1] = bound(const, p2, q2, high2, c.unit2, c.ceiling2)
    state.stale[block] = (
        const.lag == 0.0
        and most[0] <= min(state.peak[0], const.strength1)
        and most[1] <= min(state.peak[1], const.strength2)
    )
    return state.stale[block]


@kernel(forceinline=True)
def record(k0, m0, n, x, kept):
    """Copy scratch to the panel's slots."""
    for j in range(0, n, WIDTH):
        keep(kept, k0 + j, load(x, m0 + j), n - j)


@kernel(_nrt=False, forceinline=True)
def advance_yarns(state, const, block, k0, n, n2, N1, N2, work):
    """Axial forces of the block's edges, into work.on1 and work.on2, and their work."""
    L, N, D, S, y, c, w, s = state.L, state.N, state.D, state.slope, state.y, const, work, const.s
    again = state.thin[block] == AGAIN
    work1, viscous1, over1 = membrane_kernels.yarns(
        k0, 2 * s, n, 1, again, c.rx0, c.cv1, w.l1, w.i1, w.turn1, N1, w.K1, y[0], L[0], N[0], D[0], S[0], w.on1
    )
    work2, viscous2, over2 = membrane_kernels.yarns(
        k0, 2 * s, n2, s, again, c.ry0, c.cv2, w.l2, w.i2, w.turn2, N2, w.K2, y[1], L[1], N[1], D[1], S[1], w.on2
    )
    if not again:
        state.sums[block, WORK] += work1 + work2
        state.sums[block, VISCOUS] += viscous1 + viscous2
        state.sums[block, OVER] += 0.5 * (over1 + over2)  # what has the slope is half of N


@kernel(_nrt=False, forceinline=True)
def trellis(state, const, first, last, thin, work):
    """Shear forces of the block's elements and of the row before them, which shares their first weft edges."""
    s, c, w, low = const.s, const, work, max(first - 1, 0)
    m0, n = (low - first + 2) * s, (last - low) * s
    membrane_kernels.shear(
        low * s, m0, n, s, w.A, w.B, w.l1, w.l2, c.V, c.G1, c.G2, c.gamma1, c.gamma2, w.turn1, w.turn2, w.cross
    )
    if thin:
        failure_kernels.thin_trellis(const, state, low, last, (first - 2) * s, w.turn1, w.turn2, w.cross)
    # beyond the panel there is none
    if first == 0:
        for j in range(s, 2 * s):
            w.turn1[j] = w.turn2[j] = w.cross[j] = 0.0
    if last == const.ni:
        for j in range(m0 + n, m0 + n + s):
            w.turn2[j] = 0.0


@kernel(_nrt=False)
def taut(state, const):
    """(first, last) element rows that may hold a new peak or a failure: conservative, from block maxima.

    The mean over a yarn is no higher than the highest of its edges, which are as many rows as a crossover has elements.
    A filtered tension follows the tension at any height: all active rows.
    """
    first, last = state.rows[0], state.rows[1]
    if const.lag > 0.0:
        return first, last
    bound1, bound2 = min(state.peak[0], const.strength1), min(state.peak[1], const.strength2)
    low, high = last, first
    for block in range(first // const.block, (last + const.block - 1) // const.block):
        if state.most[block, 0] > bound1 or state.most[block, 1] > bound2:
            low = min(low, max(first, block * const.block - const.per + 1))
            high = max(high, min(last, (block + 1) * const.block + const.per - 1))
    return low, high


@kernel(_nrt=False)
def resist(state, const, first, last, acting):
    """Bending and jamming energy [J] of the node rows first .. last; adds their forces to state.g0 if `acting`."""
    turns = bending_kernels.bend(state, const, first, last, acting)
    return turns + jamming_kernels.jam(state, const, first, last, acting)


@kernel(_nrt=False)
def fail(state, const, work):
    """Failure criterion: remove failed yarns, and compute the forces of their blocks again."""
    first, last = taut(state, const)
    if first >= last:
        return
    start, end = max(state.rows[0], first - const.per + 1), min(state.rows[1], last + const.per - 1)
    freshen(state, const, start // const.block, (end + const.block - 1) // const.block, work)
    most1, most2 = 0.0, 0.0
    for block in range(first // const.block, (last + const.block - 1) // const.block):
        most1, most2 = max(most1, state.most[block, 0]), max(most2, state.most[block, 1])
    # looking for failures cuts yarns: what was before is asked for first where there may be one
    near = (
        const.lag > 0.0
        or (most1 > const.strength1 and failure_kernels.past_strength(const, state, 0, first, last))
        or (most2 > const.strength2 and failure_kernels.past_strength(const, state, 1, first, last))
    )
    stored, sheared, worked, damped = 0.0, 0.0, 0.0, 0.0
    # a failure changes what its neighbours store, two rows away at most
    low, high = max(first - const.per - 3, 0), min(last + const.per + 3, const.ni)
    if near:
        stored, sheared = failure_kernels.stored_energy(const, state, low, high)
        sheared += resist(state, const, low, high, False)
        worked, damped = failure_kernels.half_step_work(const, state, low, high)
    count = failure_kernels.look_for_failures(const, state, 0, first, last)
    count += failure_kernels.look_for_failures(const, state, 1, first, last)
    if count == 0:
        return
    state.counter[FAILURES] += count
    first, last = state.rows[0], state.rows[1]
    for block in range(first // const.block, (last + const.block - 1) // const.block):
        if state.thin[block] == AGAIN:
            start, end = max(first, block * const.block), min(last, (block + 1) * const.block)
            elements(state, const, block, start, end, work)
            state.thin[block] = THINNED
    now_stored, now_sheared = failure_kernels.stored_energy(const, state, low, high)
    now_sheared += resist(state, const, low, high, False)
    now_worked, now_damped = failure_kernels.half_step_work(const, state, low, high)
    state.sums[0, WORK] += now_worked - worked
    state.sums[0, VISCOUS] += now_damped - damped
    state.sums[0, LOST] += stored - now_stored + now_worked - worked
    state.sums[0, TORN] += sheared - now_sheared


@kernel(_nrt=False, forceinline=True)
def move_rows(state, const, first, last):
    """Move the node rows first .. last - 1 by one step. A block's first row has forces from the block before too."""
    symmetry(state, const, first, last)
    row = first
    while row < last:
        met = row > 0 and row % const.block == 0
        end = row + 1 if met else min(last, (row // const.block + 1) * const.block)
        k0, n = row * const.s, (end - row) * const.s
        move(k0, n, const.dt, state.kick, state.g0, state.g1, met, state.v, state.u)
        row = end


@kernel(_nrt=False)
def part(state, const, me, count):
    """(first, last) active blocks of thread `me` among `count`; the last thread has at least one."""
    start, end = state.rows[0] // const.block, (state.rows[1] + const.block - 1) // const.block
    return start + (end - start) * me // count, start + (end - start) * (me + 1) // count


@kernel(_nrt=False, forceinline=True)
def sweep(state, const, work, shared, me, count):
    """Update the active nodes and compute the active element forces, block by block while they are in cache.

    The blocks are fixed, whatever the window and the number of threads, and so is what is found in them. The node rows
    that the elements of a block need are moved first: its own, and one beyond. Those at the ends of a thread's blocks,
    which its neighbours need too, are moved before all.
    """
    first, last = part(state, const, me, count)
    low, high = max(state.rows[0], first * const.block), min(state.rows[1], last * const.block)
    end = high + 1 if me == count - 1 else high  # the node rows are low .. end - 1
    done = min(low + 2, end)
    tail = max(end - 2, done)
    if first < last:
        move_rows(state, const, low, done)
        move_rows(state, const, tail, end)
    meet(shared, count)
    for block in range(first, last):
        begin, stop = max(low, block * const.block), min(high, (block + 1) * const.block)
        ahead = max(done, min(stop + 2, tail))
        move_rows(state, const, done, ahead)
        done = ahead
        elements(state, const, block, begin, stop, work)


@kernel(_nrt=False)
def lean(state, const):
    """v += dt f / m of nodes and projectile, with the forces of the backing block (state.behind, state.outer)."""
    for c in range(3):
        for k in range(np.uint64(state.rows[0] * const.s), np.uint64((state.rows[1] + 1) * const.s)):
            state.v[c][k] += state.kick[k] * state.behind[c][k]
        state.speed[c] += const.dt * const.free[c] * state.outer[c] / const.projectile_mass


@kernel(_nrt=False, forceinline=True)
def begin(state, const):
    """Before the nodes move: contact impulses, motion of the projectile, active rows."""
    contact_kernels.push(state, const)
    if const.backed:
        lean(state, const)
    if const.bar_mass.size > 0:
        bar_kernels.fly(state, const, bar_kernels.along(state, const))
    for c in range(3):
        state.position[c] += const.dt * state.speed[c]
    widen(state, const)


@kernel(_nrt=False, forceinline=True)
def conclude(state, const, work):
    """After the element forces: failure, bending, contact, boundary; returns RUNNING or the reason to end."""
    fail(state, const, work)
    resist(state, const, state.rows[0], state.rows[1], True)
    failures = state.counter[FAILURES]
    taken, spring = contact_kernels.contact(state, const, work.touch)
    state.contact_energy[0] += taken
    state.contact_energy[1] = spring
    state.counter[STEP] += 1
    boundary_kernels.hold(state, const, state.counter[STEP] * const.dt)
    speed = bar_kernels.approach(state, const)
    if not abs(speed) < 1e9:
        return NOT_FINITE
    if speed <= 0.0:
        return STOPPED
    # perforated: yarns have failed, nothing pushes, and nothing that is held is left in front, for a while
    alone = state.reaction[2] == 0.0 and state.outer[2] == 0.0
    idle = failures > 0 and alone and not contact_kernels.in_the_way(state, const)
    state.counter[IDLE] = state.counter[IDLE] + 1 if idle else 0
    return PERFORATED if state.counter[IDLE] >= const.idle_steps else RUNNING


@kernel(forceinline=True)
def tell(state, const, force, row):
    """One row of the history: foremost z, v_z and the force [N] along z; of a bar also the velocities of tip, tail and
    centre of mass, and how far they have come, all along its axis."""
    row[0], row[1] = state.position[2] + const.top, bar_kernels.approach(state, const)
    row[2] = force
    if const.bar_mass.size > 0:
        tail = const.bar_h.size
        row[3], row[4], row[5] = state.bar_v[0], state.bar_v[tail], bar_kernels.mean(const.bar_mass, state.bar_v)
        row[6], row[7], row[8] = state.bar_u[0], state.bar_u[tail], bar_kernels.mean(const.bar_mass, state.bar_u)


@kernel(_nrt=False)
def worked(state):
    """[J] work done so far on yarns, their viscosity and the contact with the nose."""
    total = state.contact_energy[contact_kernels.CONTACT]
    for block in range(state.sums.shape[0]):
        total += state.sums[block, WORK] + state.sums[block, VISCOUS]
    return total


@entry(nogil=True, _nrt=False)
def lead(state, const, work, steps, history, shared, count, allowed):
    """Make at most `steps` steps, with `count` - 1 worker threads in `follow`, all with scratch of their own.

    history (steps, 3): the projectile's foremost z, v_z of its centre of mass and the force on it after each; of a bar
    (steps, 9), see `tell`. shared : see `barrier.meet`. allowed [J] : energy exchange, the sum over steps of the
    change of `worked`, after which CHECK ends the call: no energy error can exceed the energy exchanged.
    Returns (steps made, RUNNING or the reason to end).
    """
    made, reason, exchanged, before = 0, RUNNING, 0.0, worked(state)
    while made < steps and reason == RUNNING:
        begin(state, const)
        meet(shared, count)
        sweep(state, const, work, shared, 0, count)
        meet(shared, count)
        reason = conclude(state, const, work)
        tell(state, const, state.reaction[2] + state.outer[2], history[made])
        made += 1
        now = worked(state)
        exchanged, before = exchanged + abs(now - before), now
        if reason == RUNNING and not exchanged <= allowed:
            reason = CHECK
    shared[STOP] = 1
    meet(shared, count)
    first, last = part(state, const, 0, count)
    freshen(state, const, first, last, work)
    meet(shared, count)
    return made, reason


@entry(nogil=True, _nrt=False)
def follow(state, const, work, shared, me, count):
    """Worker thread `me` of the steps that `lead` makes."""
    while True:
        meet(shared, count)
        if shared[STOP] != 0:
            break
        sweep(state, const, work, shared, me, count)
        meet(shared, count)
    first, last = part(state, const, me, count)
    freshen(state, const, first, last, work)
    meet(shared, count)


@entry(nogil=True, _nrt=False)
def advance(state, const, work, steps, history):
    """`lead` without worker threads."""
    return lead(state, const, work, steps, history, work.shared, 1, np.inf)


@entry(nogil=True, _nrt=False)
def first_forces(state, const, work):
    """Internal forces of the initial state, before the first step."""
    for block in range((const.ni + const.block - 1) // const.block):
        elements(state, const, block, block * const.block, min(const.ni, (block + 1) * const.block), work)
    resist(state, const, 0, const.ni, True)


@entry(nogil=True)
def energies(state, const, out):
    """Energy audit [J] at the present whole step, into out (5,): kinetic, yarns, trellis, bending, jamming.

    Kinetic energy is m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
    """
    out[:] = 0.0
    for i in range(const.ni + 1):
        out[KINETIC] += energy_kernels.motion(const, state, i)
    out[STORED], out[SHEAR] = failure_kernels.stored_energy(const, state, 0, const.ni)
    out[BENDING] = bending_kernels.bend(state, const, 0, const.ni, False)
    out[JAM] = jamming_kernels.jam(state, const, 0, const.ni, False)
