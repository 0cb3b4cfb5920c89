"""Slip of the yarns at the nodes: stick, slip and reversal as one implicit update of the material fluxes.

A node has, besides its velocity v, the fluxes q1 and q2 [m/s]: the velocities, along their unit tangents t1 and t2, at
which the warp's and the weft's material moves through it. The material of a yarn moves at v + t q there. With the
masses m1, m2 of the node's two yarns, m = m1 + m2, the sum F of all forces on the node and the difference C of the
configurational forces ahead of and behind the node (`forces_kernels`),

    m a + m1 (t1 dq1/dt + dt1/dt q1) + m2 (t2 dq2/dt + dt2/dt q2) = F
    m1 (t1 . a + dq1/dt) = C1 - f1            and likewise of the weft
    |f1| <= Tf = c0 + mu F_c + mu |f_nose|,   f1 = Tf sign(q1) where q1 != 0

F_c is the contact force of the cell at the effective stretches about the node, f_nose the force of the projectile on
it: round the nose a yarn of tension T that turns by an angle is pressed on with T times it, which makes this the
capstan's law. Without a, dq1/dt = [C1 - f1 - (m1/m) t1.(F - m2 t2 dq2/dt)] / (m1 - m1^2/m); both families are
solved by Gauss-Seidel iteration, each with the implicit Coulomb law |q*| - dt Tf / M. A held node has 1/m = 0. The
works of friction, of the bounds of a flux, and of the residual of the iteration are counted apart, in slip.work.
The yarn moves on by its flux: the share of the segment ahead grows by dt q over its length at rest, that behind loses
as much.
"""

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    broadcast,
    copysign,
    fabs,
    floor,
    fma,
    gather_rows4,
    greater,
    head_mask,
    load,
    masked_store,
    maximum,
    minimum,
    reduce_add,
    rsqrt,
    shift_in_prev,
    sqrt,
    to_int32,
    where,
)
from shellfabric.sliding.slip_energy_kernels import FRICTION, RESIDUAL, STOPS

SWEEPS = (
    3  # Gauss-Seidel: leaves (t1 . t2)^5 of the fluxes' change, t1 . t2 being 0.4 in locked fabric
)
# of t1 . t2 in that iteration: where yarns lie along each other a common flux of both would have no mass
MOST_COSINE = 0.7
FASTEST = 1e9  # [m/s]: no bound


@kernel(_nrt=False)
def slip_nodes(state, const, slip):
    """New fluxes of the active nodes; reduces state.f_int by what they take. Adds up the work of friction."""
    for i in range(state.active_rows[0], state.active_rows[1] + 1):
        slip_row(state, const, slip, i)


@kernel(_nrt=False)
def slip_row(state, const, slip, i):
    """`slip_nodes` of one row."""
    s, k0, moving = const.row_stride, i * const.row_stride, False
    rubbed, stopped, off = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    up, down, inner = (s if i < const.ni else 0), (s if i > 0 else 0), (1.0 if i > 0 else 0.0)
    for j in range(0, s, WIDTH):
        k, left = k0 + j, s - j
        f = node_force(state, k)
        C1 = load(slip.config[0], k) - inner * load(slip.config[0], k - down)
        C2 = load(slip.config[1], k) - load_before(slip.config[1], k)
        flux = maximum(fabs(load(slip.q[0], k)), fabs(load(slip.q[1], k)))
        last = maximum(fabs(load(slip.q_before[0], k)), fabs(load(slip.q_before[1], k)))
        # no drive is above this, whatever the tangents: most nodes need neither them nor a threshold
        most = maximum(fabs(C1), fabs(C2)) + fabs(f[0]) + fabs(f[1]) + fabs(f[2])
        slips = any_lane(greater(flux + last, 0.0))
        b1 = load(state.intact_fraction[0], k), inner * load(state.intact_fraction[0], k - down)
        b2 = load(state.intact_fraction[1], k), load_before(state.intact_fraction[1], k)
        cohesion = slip.cohesion * load(slip.part, k) * both_there(b1, b2)
        if not (slips or any_lane(greater(most, cohesion))):
            continue
        limit = threshold(state, const, slip, k, down, b1, b2)
        if not (slips or any_lane(greater(most, limit))):
            continue
        mobile1 = load(slip.mobility[0], k) * minimum(b1[0] + b1[1], 1.0)
        mobile2 = load(slip.mobility[1], k) * minimum(b2[0] + b2[1], 1.0)
        along = directions(
            state.u, k, up, down, b1, b2, (const.dx * (b1[0] + b1[1]), const.dy * (b2[0] + b2[1]))
        )
        t1, per1 = unit(*along[0])
        t2, per2 = unit(*along[1])
        drive1 = C1 - load(slip.pull[0], k) * dot(t1, f)
        drive2 = C2 - load(slip.pull[1], k) * dot(t2, f)
        most = maximum(
            where(greater(mobile1, 0.0), fabs(drive1), 0.0),
            where(greater(mobile2, 0.0), fabs(drive2), 0.0),
        )
        if not (slips or any_lane(greater(most, limit))):
            continue
        change = directions(state.v, k, up, down, b1, b2, (broadcast(0.0), broadcast(0.0)))
        rates = turning(change[0], t1, per1), turning(change[1], t2, per2)
        room = (
            flux_bounds(slip, 0, k, k - down, b1),
            flux_bounds(slip, 1, k, k - 1 if k > 0 else k, b2),
        )
        moves, work, more, rest = update_nodes(
            state,
            slip,
            k,
            left,
            const.dt,
            (t1, t2),
            rates,
            (drive1, drive2),
            (mobile1, mobile2, *room),
            limit,
        )
        moving = moves or moving
        rubbed, stopped, off = rubbed + work, stopped + more, off + rest
    slip.row_slips[i] = moving
    slip.work[FRICTION] += reduce_add(rubbed)
    slip.work[STOPS] += reduce_add(stopped)
    slip.work[RESIDUAL] += reduce_add(off)


@kernel(_nrt=False, forceinline=True)
def load_before(x, k):
    """Eight numbers of the slots before k; zero before the first."""
    return load(x, k - 1) if k > 0 else shift_in_prev(broadcast(0.0), load(x, k))


@kernel(_nrt=False, forceinline=True)
def directions(x, k, up, down, b1, b2, rest):
    """Sums of the changes of x over the whole segments about eight nodes, along warp and weft: of the displacements,
    with the lengths at rest `rest` [m], vectors along the yarns; of the velocities, their rates."""
    a1, c1 = central_difference(x[0], k, k + up, load(x[0], k - down), load_before(x[0], k), b1, b2)
    a2, c2 = central_difference(x[1], k, k + up, load(x[1], k - down), load_before(x[1], k), b1, b2)
    a3, c3 = central_difference(x[2], k, k + up, load(x[2], k - down), load_before(x[2], k), b1, b2)
    return (a1 + rest[0], a2, a3), (c1, c2 + rest[1], c3)


@kernel(_nrt=False, forceinline=True)
def central_difference(x, k, ahead, behind1, behind2, b1, b2):
    """Differences of x along warp and weft, over the whole segments about eight nodes."""
    here = load(x, k)
    return (
        b1[0] * (load(x, ahead) - here) + b1[1] * (here - behind1),
        b2[0] * (load(x, k + 1) - here) + b2[1] * (here - behind2),
    )


@kernel(_nrt=False, forceinline=True)
def turning(rate, t, per):
    """Rate [1/s] of the unit vector t of vectors of the length 1 / per, which change at `rate`."""
    stretching = dot(rate, t)
    return (
        per * (rate[0] - stretching * t[0]),
        per * (rate[1] - stretching * t[1]),
        per * (rate[2] - stretching * t[2]),
    )


@kernel(_nrt=False, forceinline=True)
def dot(a, b):
    """Scalar product of two vectors of eight nodes."""
    return fma(a[2], b[2], fma(a[1], b[1], a[0] * b[0]))


@kernel(_nrt=False, forceinline=True)
def unit(a, b, c):
    """(the vectors over their lengths, 1 / length); zero where there is none."""
    square = fma(c, c, fma(b, b, a * a))
    some = greater(square, 1e-30)
    inverse = where(some, rsqrt(where(some, square, 1.0)), 0.0)
    return (a * inverse, b * inverse, c * inverse), inverse


@kernel(_nrt=False, forceinline=True)
def node_force(state, k):
    """Sum of the forces on eight nodes."""
    return (
        load(state.f_int[0], k) + load(state.f_int_above[0], k) + load(state.f_contact[0], k),
        load(state.f_int[1], k) + load(state.f_int_above[1], k) + load(state.f_contact[1], k),
        load(state.f_int[2], k) + load(state.f_int_above[2], k) + load(state.f_contact[2], k),
    )


@kernel(_nrt=False, forceinline=True)
def mean_stretch(b, ahead, behind):
    """Mean effective stretch of the segments about eight nodes, of those that are whole; 1 where there is none."""
    count = b[0] + b[1]
    total = b[0] * ahead + b[1] * behind
    return where(greater(count, 1.5), 0.5 * total, where(greater(count, 0.5), total, 1.0))


@kernel(_nrt=False, forceinline=True)
def threshold(state, const, slip, k, down, b1, b2):
    """Largest friction [N] of eight nodes, Tf, none where one of the two yarns has left the node; and of a clamp."""
    x0, rx, top1, y0, ry, top2, across = const.table_grid
    found = broadcast(slip.cohesion)
    if slip.mu > 0.0:
        x1 = mean_stretch(b1, load(slip.x[0], k), load(slip.x[0], k - down))
        x2 = mean_stretch(b2, load(slip.x[1], k), load_before(slip.x[1], k))
        p, q = maximum((x1 - x0) * rx, 0.0), maximum((x2 - y0) * ry, 0.0)
        cell1, cell2 = floor(minimum(p, top1)), floor(minimum(q, top2))
        c = gather_rows4(slip.table, to_int32(fma(cell1, across, cell2)))
        p, q = p - cell1, q - cell2
        found = found + slip.mu * maximum(fma(q, fma(c[3], p, c[2]), fma(c[1], p, c[0])), 0.0)
    f = load(state.f_contact[0], k), load(state.f_contact[1], k), load(state.f_contact[2], k)
    found = load(slip.part, k) * found + slip.mu * sqrt(dot(f, f))
    return both_there(b1, b2) * found + load(slip.grip, k)


@kernel(_nrt=False, forceinline=True)
def both_there(b1, b2):
    """1 at those of eight nodes at which both yarns are, 0 where one has left; less where part of it has."""
    return minimum(b1[0] + b1[1], 1.0) * minimum(b2[0] + b2[1], 1.0)


@kernel(_nrt=False, forceinline=True)
def flux_bounds(slip, family, ahead, behind, b):
    """(lowest, highest) flux of eight nodes: a segment gives no yarn that holds the least between yarns that touch."""
    low_ahead = where(greater(slip.least, load(slip.share[family], ahead)), b[0], 0.0)
    low_behind = where(greater(slip.least, load(slip.share[family], behind)), b[1], 0.0)
    return where(greater(low_ahead, 0.0), 0.0, -FASTEST), where(
        greater(low_behind, 0.0), 0.0, FASTEST
    )


@kernel(_nrt=False, forceinline=True)
def coulomb(q, kick, mobile, limit, bounds):
    """Flux after an impulse per mass `kick` against friction of at most `limit` over the reduced mass 1 / mobile.

    Returns it, what friction has taken of it, and what the bounds of the flux have.
    """
    trial = q + kick
    slipping = copysign(maximum(fabs(trial) - limit * mobile, 0.0), trial)
    new = where(greater(mobile, 0.0), minimum(maximum(slipping, bounds[0]), bounds[1]), 0.0)
    return new, trial - slipping, slipping - new


@kernel(_nrt=False)
def update_nodes(state, slip, k, left, dt, t, rates, drives, mobile, limit):
    """Fluxes of eight nodes: (whether one of them is not zero, work [J] of friction, of bounds, of the iteration)."""
    (t1, t2), (r1, r2), (D1, D2) = t, rates, drives
    q1, q2, m1, m2 = (
        load(slip.q[0], k),
        load(slip.q[1], k),
        load(slip.mass[0], k),
        load(slip.mass[1], k),
    )
    g1, g2 = m1 * q1, m2 * q2
    turn = g1 * r1[0] + g2 * r2[0], g1 * r1[1] + g2 * r2[1], g1 * r1[2] + g2 * r2[2]
    D1, D2 = (
        fma(load(slip.pull[0], k), dot(t1, turn), D1),
        fma(load(slip.pull[1], k), dot(t2, turn), D2),
    )
    cosine, coupling, per, most = dot(t1, t2), load(slip.coupling, k), 1.0 / dt, dt * limit
    both = coupling * minimum(maximum(cosine, -MOST_COSINE), MOST_COSINE)
    bounds1, bounds2 = mobile[2], mobile[3]
    n2, taken1, stopped1, taken2, stopped2 = q2, D1, D1, D2, D2
    for _ in range(SWEEPS):
        E1 = D1 + both * (per * (n2 - q2))
        n1, taken1, stopped1 = coulomb(q1, dt * mobile[0] * E1, mobile[0], most, bounds1)
        E2 = D2 + both * (per * (n1 - q1))
        n2, taken2, stopped2 = coulomb(q2, dt * mobile[1] * E2, mobile[1], most, bounds2)
    E1, E2 = D1 + coupling * cosine * (per * (n2 - q2)), D2 + coupling * cosine * (per * (n1 - q1))
    g1, g2 = m1 * (per * (n1 - q1)), m2 * (per * (n2 - q2))
    work1 = opposing_work(slip, 0, k, left, (q1, n1, per), (E1, taken1, stopped1), mobile[0])
    work2 = opposing_work(slip, 1, k, left, (q2, n2, per), (E2, taken2, stopped2), mobile[1])
    for c in range(3):
        masked_store(
            state.f_int[c], k, load(state.f_int[c], k) - (turn[c] + (g1 * t1[c] + g2 * t2[c])), left
        )
    flux, within = where(head_mask(left), fabs(n1) + fabs(n2), 0.0), head_mask(left)
    half = 0.5 * dt
    return (
        any_lane(greater(flux, 0.0)),
        where(within, half * (work1[0] + work2[0]), 0.0),
        where(within, half * (work1[1] + work2[1]), 0.0),
        where(within, half * (work1[2] + work2[2]), 0.0),
    )


@kernel(_nrt=False, forceinline=True)
def opposing_work(slip, family, k, left, fluxes, impulses, mobile):
    """Store the fluxes of a family and what opposes them; (power of friction, of bounds, of the iteration), doubled.

    fluxes : (before, after, 1 / dt)
    impulses : (drive [N]; changes of the flux that friction and bounds have made, in the last sweep)
    """
    (q, new, per), (drive, taken, stopped) = fluxes, impulses
    moves = greater(mobile, 0.0)
    reduced = load(slip.mass[family], k) * (1.0 - load(slip.pull[family], k))
    weight = where(moves, per * reduced, 0.0)
    friction, stop = weight * taken, weight * stopped
    residual = where(moves, drive - weight * (new - q), 0.0) - (friction + stop)
    work = (
        q * (friction + load(slip.friction[family], k)),
        q * (stop + load(slip.stop[family], k)),
        q * (residual + load(slip.residual[family], k)),
    )
    masked_store(slip.friction[family], k, friction, left)
    masked_store(slip.stop[family], k, stop, left)
    masked_store(slip.residual[family], k, residual, left)
    masked_store(slip.q_before[family], k, q, left)
    masked_store(slip.q[family], k, new, left)
    return work
