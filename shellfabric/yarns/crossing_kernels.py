"""Where warp and weft cross: contact along the common normal, friction across it
(docs/theory-panel.md, "Resolved yarns", Crossings and Slack yarns).

A crossing is a pair of indices (s_a, s_b) on the B-splines of its two chains (`curve_kernels`),
moved in each step by at most three steps of Gauss and Newton. Those of the outer rows are pinned:
their indices stay, and nothing slips. One whose yarns are slack (or nearly parallel), or whose
indices run along a loop or the whipping end of a yarn, carries no force; what it stored is counted:
away from the common perpendicular F_n would do work where n turns. It comes back at the distance at
which it is found, and that distance follows the yarns as they come apart, up to h: coming back does
no work. A yarn leaves a crossing for good at its end.
"""

import math

from shellfabric.contact import friction_kernels, normal_kernels
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    add_at,
    both,
    equal_bytes,
    fabs,
    floor,
    gather_rows4,
    gather_runs,
    greater,
    lane_numbers,
    load,
    mask_from_bits,
    maximum,
    minimum,
    movemask,
    reduce_add,
    sqrt,
    store,
    to_int32,
    where,
)
from shellfabric.surface.surface_kernels import quadratic_weights
from shellfabric.surface.vector_kernels import cross, dot, scaled, subtract
from shellfabric.yarns.curve_kernels import gather, scatter, spline, weighted

MOST_MOVE = 0.1  # of an index in one step of Gauss and Newton: a tenth of a segment
# of an index: a step that short is taken, and counts from the next time step on. An index that lags
# does work where n turns along the yarn
CLOSE = 1e-3
RUNS = 0.02  # of an index that is left to the common perpendicular: it runs along a loop
SLACK_LENGTH = 0.5  # of a tangent squared over that at rest: below, the yarn is slack
SLACK_SINE = 0.04  # square of the sine between the tangents: below, they are nearly parallel


@kernel(_nrt=False)
def crossing_forces(zone):
    """Add the forces of all crossings to zone.f: eight at once, of one warp yarn, and those that need
    more than the formulas one by one."""
    stored = 0.0
    count = zone.yarns[1]
    for i in range(zone.yarns[0]):
        for first in range(0, count, WIDTH):
            j = max(min(first, count - WIDTH), 0)
            left = (1 << min(count, WIDTH)) - (1 << (first - j))
            if count >= WIDTH:
                left, energy = crossing_forces8(zone, i, j, left)
                stored += energy
            if left == 0:
                continue
            for lane in range(WIDTH):
                if left >> lane & 1 and zone.touching[i, j + lane]:
                    stored += crossing_force(zone, i, j + lane)
    zone.stored_at_crossings = stored


@kernel(_nrt=False, forceinline=True)
def compression(zone, closure):
    """Compute (force [N], energy [J]) of a crossing closed by `closure` [m], or of eight: the force is
    linear between samples and beyond."""
    k = to_int32(minimum(closure * zone.law_scale, zone.law.shape[0] - 1.0))
    force, slope, energy, at = gather_rows4(zone.law, k)
    beyond = closure - at
    return force + slope * beyond, energy + beyond * (force + 0.5 * slope * beyond)


@kernel(_nrt=False)
def common_perpendicular(zone, i, j):
    """Move a crossing's indices to the common perpendicular.

    Returns (node, weights) of the warp and of the weft, d, the two tangents, and whether the yarns
    are slack or the indices run.
    """
    first_a = zone.first[0] + i * zone.nodes[0]
    first_b = zone.first[1] + j * zone.nodes[1]
    s_a, s_b = zone.place[0, i, j], zone.place[1, i, j]
    left = 0.0
    for _ in range(3):
        k_a, weights_a, slopes_a = spline(s_a, zone.nodes[0])
        k_b, weights_b, slopes_b = spline(s_b, zone.nodes[1])
        n_a = first_a + k_a
        n_b = first_b + k_b
        apart = subtract(gather(zone.x, n_a, weights_a), gather(zone.x, n_b, weights_b))
        tangents = gather(zone.x, n_a, slopes_a), gather(zone.x, n_b, slopes_b)
        rest = zone.rest_length[n_a] ** 2, zone.rest_length[n_b] ** 2
        products, taut = tangent_products(tangents, rest)
        if zone.pinned[i, j]:
            break
        if not taut:  # the system may be singular: shorter steps
            aa, bb, ab = products
            products = aa + 0.2 * rest[0], bb + 0.2 * rest[1], ab
        step_a, step_b = step_to_perpendicular(apart, tangents, products)
        s_a = moved(s_a, step_a, zone.nodes[0])
        s_b = moved(s_b, step_b, zone.nodes[1])
        left = max(abs(step_a), abs(step_b))
        if left < CLOSE:
            break
    zone.place[0, i, j] = s_a
    zone.place[1, i, j] = s_b
    return n_a, weights_a, n_b, weights_b, apart, tangents, not taut or left > RUNS


@kernel(_nrt=False, forceinline=True)
def tangent_products(tangents, rest):
    """Compute the products (aa, bb, -ab) of two tangents, and whether both yarns are taut and far from
    parallel; rest : [m2] squares of their segments at rest. Of one crossing or eight."""
    a, b = tangents
    aa = dot(a, a)
    bb = dot(b, b)
    ab = 0.0 - dot(a, b)
    taut = both(greater(aa, SLACK_LENGTH * rest[0]), greater(bb, SLACK_LENGTH * rest[1]))
    return (aa, bb, ab), both(taut, greater(aa * bb - ab * ab, SLACK_SINE * aa * bb))


@kernel(_nrt=False, forceinline=True)
def step_to_perpendicular(apart, tangents, products):
    """Compute the step of Gauss and Newton of both indices, of one crossing or eight."""
    aa, bb, ab = products
    a = 0.0 - dot(apart, tangents[0])
    b = dot(apart, tangents[1])
    over = 1.0 / (aa * bb - ab * ab)
    return over * (bb * a - ab * b), over * (aa * b - ab * a)


@kernel(_nrt=False, forceinline=True)
def moved(s, step, count):
    """Return an index of a chain, or eight, after a bounded step, within the chain."""
    step = minimum(maximum(step, -MOST_MOVE), MOST_MOVE)
    return minimum(maximum(s + step, 0.5), count - 1.5)


@kernel()
def has_left(s, count):
    """Tell whether a crossing has come to an end of a chain: the yarn has left it."""
    return s == 0.5 or s == count - 1.5


@kernel(_nrt=False)
def crossing_force(zone, i, j):
    """Compute the force of one crossing; return the energy [J] that it stores."""
    n_a, weights_a, n_b, weights_b, apart, tangents, slack = common_perpendicular(zone, i, j)
    pinned = zone.pinned[i, j]
    whole = zone.whole[n_a - 1] and zone.whole[n_a] and zone.whole[n_b - 1] and zone.whole[n_b]
    normal = cross(*tangents)
    size = zone.sign[i, j] * math.sqrt(dot(normal, normal))
    if pinned:
        normal = apart
        size = math.sqrt(dot(apart, apart))
    normal = scaled(1.0 / size, normal)
    distance = dot(apart, normal)
    if whole and not slack and distance <= 0.0:
        # the yarns have changed sides: of slack ones no more than a loop, of taut ones the order is
        # lost
        slack = zone.contact_onset[i, j] < zone.gap[i, j]
        if not slack:
            whole = False
            zone.tangled += zone.crossing_share[i, j]
    if has_left(zone.place[0, i, j], zone.nodes[0]) or has_left(zone.place[1, i, j], zone.nodes[1]):
        zone.touching[i, j] = False
        slack = True
    if slack or not whole:
        drop(zone, i, j, whole)
        return 0.0
    velocity = subtract(gather(zone.v, n_a, weights_a), gather(zone.v, n_b, weights_b))
    share = zone.crossing_share[i, j]
    opening = dot(velocity, normal)
    kept = zone.contact_onset[i, j], zone.contact_damping[i, j]
    onset, force, energy, damping, damped = normal_force(
        zone, zone.gap[i, j], kept, distance, opening
    )
    zone.damped += share * damped
    zone.contact_onset[i, j] = onset
    zone.contact_force[i, j] = force
    zone.contact_energy[i, j] = energy
    zone.contact_damping[i, j] = damping
    push = force + damping
    limit = zone.friction * push
    if pinned:
        limit = math.inf
    before = slider_at(zone, i, j)
    slider, held, taken = friction_kernels.slipped(
        before, limit, zone.friction_stiffness, zone.dt, normal, velocity
    )
    zone.slider[0, i, j], zone.slider[1, i, j], zone.slider[2, i, j] = slider
    zone.friction_work += share * taken
    force = subtract(scaled(push, normal), scaled(zone.friction_stiffness, slider))
    scatter(zone.f, n_a, weights_a, force)
    scatter(zone.f, n_b, weights_b, scaled(-1.0, force))
    return share * (energy + held)


@kernel(_nrt=False)
def crossing_forces8(zone, i, j, which):
    """Compute the forces of those of eight crossings, from weft yarn j on, whose bits are set and that
    `crossing_force` would move by one step and find taut, whole, free and on their sides.

    Returns (bits of those that are left, energy [J] that the others store).
    """
    fit = which & movemask(equal_bytes(zone.touching[i], j, 1))
    fit &= movemask(both(equal_bytes(zone.pinned[i], j, 0), equal_bytes(zone.torn[1], j, 0)))
    if zone.torn[0, i] or fit == 0:
        return which, 0.0
    first_b = zone.first[1] + zone.nodes[1] * (lane_numbers() + float(j))
    s_a = load(zone.place[0, i], j)
    s_b = load(zone.place[1, i], j)
    at_a, weights_a, slopes_a = spline8(
        s_a, float(zone.first[0] + i * zone.nodes[0]), zone.nodes[0]
    )
    at_b, weights_b, slopes_b = spline8(s_b, first_b, zone.nodes[1])
    nodes_a = columns8(zone.x, at_a)
    nodes_b = columns8(zone.x, at_b)
    apart = subtract(weighted(weights_a, nodes_a), weighted(weights_b, nodes_b))
    tangents = weighted(slopes_a, nodes_a), weighted(slopes_b, nodes_b)
    _, rest_a, _, _ = gather_runs(zone.rest_length, at_a)
    _, rest_b, _, _ = gather_runs(zone.rest_length, at_b)
    products, usual = tangent_products(tangents, (rest_a * rest_a, rest_b * rest_b))
    step_a, step_b = step_to_perpendicular(apart, tangents, products)
    usual = both(usual, greater(CLOSE, maximum(fabs(step_a), fabs(step_b))))
    s_a = moved(s_a, step_a, zone.nodes[0])
    s_b = moved(s_b, step_b, zone.nodes[1])
    usual = both(usual, both(greater(s_a, 0.5), greater(zone.nodes[0] - 2.5, s_a)))
    usual = both(usual, both(greater(s_b, 0.5), greater(zone.nodes[1] - 2.5, s_b)))
    normal = cross(*tangents)
    normal = scaled(load(zone.sign[i], j) / sqrt(dot(normal, normal)), normal)
    distance = dot(apart, normal)
    fit &= movemask(both(usual, greater(distance, 0.0)))
    if fit == 0:
        return which, 0.0
    found = mask_from_bits(fit)
    store_found(zone.place[0, i], j, found, s_a)
    store_found(zone.place[1, i], j, found, s_b)
    velocity = subtract(
        weighted(weights_a, columns8(zone.v, at_a)), weighted(weights_b, columns8(zone.v, at_b))
    )
    opening = dot(velocity, normal)
    kept = load(zone.contact_onset[i], j), load(zone.contact_damping[i], j)
    onset, force, energy, damping, damped = normal_force(
        zone, load(zone.gap[i], j), kept, distance, opening
    )
    store_found(zone.contact_onset[i], j, found, onset)
    store_found(zone.contact_force[i], j, found, force)
    store_found(zone.contact_energy[i], j, found, energy)
    store_found(zone.contact_damping[i], j, found, damping)
    push = force + damping
    before = load(zone.slider[0, i], j), load(zone.slider[1, i], j), load(zone.slider[2, i], j)
    slider, held, taken = friction_kernels.slipped(
        before, zone.friction * push, zone.friction_stiffness, zone.dt, normal, velocity
    )
    force = subtract(scaled(push, normal), scaled(zone.friction_stiffness, slider))
    for c in range(3):
        store_found(zone.slider[c, i], j, found, slider[c])
        acting = where(found, force[c], 0.0)
        for n in range(3):
            add_at(zone.f[c, n:], at_a, weights_a[n] * acting)
            add_at(zone.f[c, n:], at_b, 0.0 - weights_b[n] * acting)
    share = where(found, load(zone.crossing_share[i], j), 0.0)
    zone.damped += reduce_add(share * where(found, damped, 0.0))
    zone.friction_work += reduce_add(share * where(found, taken, 0.0))
    return which & ~fit, reduce_add(share * where(found, energy + held, 0.0))


@kernel(_nrt=False, forceinline=True)
def spline8(s, first, count):
    """Compute `curve_kernels.spline` at eight indices, but for the last node: the number of the first
    of three nodes, of chains of `count` nodes that begin at `first`, their weights, and the slopes
    of these."""
    k = minimum(maximum(floor(s + 0.5), 1.0), count - 3.0)
    u = s - k
    return to_int32(first + k - 1.0), quadratic_weights(u), (u - 0.5, -2.0 * u, u + 0.5)


@kernel(_nrt=False, forceinline=True)
def columns8(x, at):
    """Gather eight times three columns of x (3, nodes), from column `at` on."""
    X = gather_runs(x[0], at)
    Y = gather_runs(x[1], at)
    Z = gather_runs(x[2], at)
    return (X[0], Y[0], Z[0]), (X[1], Y[1], Z[1]), (X[2], Y[2], Z[2])


@kernel(_nrt=False, forceinline=True)
def store_found(values, j, found, new):
    """Store those of eight new values from place j on that are `found`."""
    store(values, j, where(found, new, load(values, j)))


@kernel(_nrt=False, forceinline=True)
def slider_at(zone, i, j):
    """Return the friction spring of a crossing."""
    return zone.slider[0, i, j], zone.slider[1, i, j], zone.slider[2, i, j]


@kernel(_nrt=False)
def drop(zone, i, j, whole):
    """Drop the contact of a crossing, for good if a yarn of it is not whole, and count what it
    stored."""
    slider = slider_at(zone, i, j)
    dropped = zone.contact_energy[i, j] + 0.5 * zone.friction_stiffness * dot(slider, slider)
    dropped *= zone.crossing_share[i, j]
    if whole:
        zone.lost_when_slack += dropped
    else:
        zone.touching[i, j] = False
        zone.lost_with_yarns += dropped
    zone.contact_force[i, j] = 0.0
    zone.contact_energy[i, j] = 0.0
    zone.contact_damping[i, j] = 0.0
    zone.contact_onset[i, j] = -1.0
    for c in range(3):
        zone.slider[c, i, j] = 0.0


@kernel(_nrt=False, forceinline=True)
def normal_force(zone, gap, kept, distance, opening):
    """Compute the normal contact of a crossing, or of eight, at a distance [m] that opens at the
    velocity `opening` [m/s].

    gap : [m] between the yarns at rest; kept : onset [m] and damping force [N] a step ago

    Returns (onset [m], force [N], energy [J], damping force [N], work [J] of damping in the step).
    """
    before, damping_before = kept
    onset = minimum(gap, maximum(before, distance))
    touches = greater(onset, distance)
    force, energy = compression(zone, maximum(onset - distance, 0.0))
    force = where(touches, force, 0.0)
    energy = where(touches, energy, 0.0)
    damping = where(touches, normal_kernels.damping_force(force, zone.damping, opening), 0.0)
    damped = 0.0 - (0.5 * zone.dt) * (damping + damping_before) * opening
    return onset, force, energy, damping, damped
