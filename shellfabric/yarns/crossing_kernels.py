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
from shellfabric.surface.vector_kernels import (
    add_scaled,
    cross,
    dot,
    scaled,
    subtract,
    three,
)
from shellfabric.yarns.curve_kernels import gather, scatter, spline

MOST_MOVE = 0.1  # of an index in one step of Gauss and Newton: a tenth of a segment
# of an index: a step that short is taken, and counts from the next time step on. An index that lags
# does work where n turns along the yarn
CLOSE = 1e-3
RUNS = 0.02  # of an index that is left to the common perpendicular: it runs along a loop
SLACK_LENGTH = 0.5  # of a tangent squared over that at rest: below, the yarn is slack
SLACK_SINE = 0.04  # square of the sine between the tangents: below, they are nearly parallel


@kernel(_nrt=False)
def crossing_forces(zone):
    """Add the forces of all crossings to zone.f."""
    stored = 0.0
    for i in range(zone.yarns[0]):
        for j in range(zone.yarns[1]):
            if zone.touching[i, j]:
                stored += crossing_force(zone, i, j)
    zone.stored_at_crossings = stored


@kernel(_nrt=False)
def compression(zone, closure):
    """Compute (force [N], energy [J]) of a crossing closed by `closure` [m]: the force is linear
    between samples and beyond."""
    k = min(int(closure * zone.law_scale), zone.law_force.size - 1)
    beyond = closure - k / zone.law_scale
    force = zone.law_force[k]
    slope = zone.law_stiffness[k]
    energy = zone.law_energy[k] + beyond * (force + 0.5 * slope * beyond)
    return force + slope * beyond, energy


@kernel(_nrt=False)
def common_perpendicular(zone, i, j):
    """Move a crossing's indices to the common perpendicular.

    Returns (node, weights) of the warp and of the weft, d, the two tangents, and whether the yarns
    are slack or the indices run.
    """
    first_a = zone.first[0] + i * zone.nodes[0]
    first_b = zone.first[1] + j * zone.nodes[1]
    s_a, s_b = zone.place[i, j, 0], zone.place[i, j, 1]
    left = 0.0
    for _ in range(3):
        k_a, weights_a, slopes_a = spline(s_a, zone.nodes[0])
        k_b, weights_b, slopes_b = spline(s_b, zone.nodes[1])
        n_a = first_a + k_a
        n_b = first_b + k_b
        apart = subtract(gather(zone.x, n_a, weights_a), gather(zone.x, n_b, weights_b))
        tangent_a = gather(zone.x, n_a, slopes_a)
        tangent_b = gather(zone.x, n_b, slopes_b)
        aa = dot(tangent_a, tangent_a)
        bb = dot(tangent_b, tangent_b)
        ab = -dot(tangent_a, tangent_b)
        rest_a = zone.rest_length[n_a] ** 2
        rest_b = zone.rest_length[n_b] ** 2
        slack = aa < SLACK_LENGTH * rest_a or bb < SLACK_LENGTH * rest_b
        slack = slack or aa * bb - ab * ab < SLACK_SINE * aa * bb
        if zone.pinned[i, j]:
            break
        if slack:  # the system may be singular: shorter steps
            aa += 0.2 * rest_a
            bb += 0.2 * rest_b
        a = -dot(apart, tangent_a)
        b = dot(apart, tangent_b)
        over = 1.0 / (aa * bb - ab * ab)
        step_a = over * (bb * a - ab * b)
        step_b = over * (aa * b - ab * a)
        s_a = moved(s_a, step_a, zone.nodes[0])
        s_b = moved(s_b, step_b, zone.nodes[1])
        left = max(abs(step_a), abs(step_b))
        if left < CLOSE:
            break
    zone.place[i, j, 0] = s_a
    zone.place[i, j, 1] = s_b
    return n_a, weights_a, n_b, weights_b, apart, tangent_a, tangent_b, slack or left > RUNS


@kernel()
def moved(s, step, count):
    """Return an index of a chain after a bounded step, within the chain."""
    step = min(max(step, -MOST_MOVE), MOST_MOVE)
    return min(max(s + step, 0.5), count - 1.5)


@kernel()
def has_left(s, count):
    """Tell whether a crossing has come to an end of a chain: the yarn has left it."""
    return s == 0.5 or s == count - 1.5


@kernel(_nrt=False)
def crossing_force(zone, i, j):
    """Compute the force of one crossing; return the energy [J] that it stores."""
    found = common_perpendicular(zone, i, j)
    n_a, weights_a, n_b, weights_b, apart, tangent_a, tangent_b, slack = found
    pinned = zone.pinned[i, j]
    whole = zone.whole[n_a - 1] and zone.whole[n_a] and zone.whole[n_b - 1] and zone.whole[n_b]
    normal = cross(tangent_a, tangent_b)
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
    if has_left(zone.place[i, j, 0], zone.nodes[0]) or has_left(zone.place[i, j, 1], zone.nodes[1]):
        zone.touching[i, j] = False
        slack = True
    if slack or not whole:
        drop(zone, i, j, whole)
        return 0.0
    velocity = subtract(gather(zone.v, n_a, weights_a), gather(zone.v, n_b, weights_b))
    push = normal_force(zone, i, j, distance, dot(velocity, normal))
    limit = zone.friction * push
    if pinned:
        limit = math.inf
    held, taken = friction_kernels.slide(
        zone.slider[i, j], limit, zone.friction_stiffness, zone.dt, normal, velocity
    )
    zone.friction_work += zone.crossing_share[i, j] * taken
    stored = zone.crossing_share[i, j] * (zone.contact_energy[i, j] + held)
    slider = three(zone.slider[i, j], 0)
    force = add_scaled(scaled(push, normal), -zone.friction_stiffness, slider)
    scatter(zone.f, n_a, weights_a, force)
    scatter(zone.f, n_b, weights_b, scaled(-1.0, force))
    return stored


@kernel(_nrt=False)
def drop(zone, i, j, whole):
    """Drop the contact of a crossing, for good if a yarn of it is not whole, and count what it
    stored."""
    slider = zone.slider[i, j]
    square = slider[0] ** 2 + slider[1] ** 2 + slider[2] ** 2
    dropped = zone.contact_energy[i, j] + 0.5 * zone.friction_stiffness * square
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
    slider[0] = slider[1] = slider[2] = 0.0


@kernel(_nrt=False)
def normal_force(zone, i, j, distance, opening):
    """Compute the normal force [N] with its damping, at a distance [m] that opens at the velocity
    `opening` [m/s]."""
    onset = min(zone.gap[i, j], max(zone.contact_onset[i, j], distance))
    force = 0.0
    energy = 0.0
    damping = 0.0
    if distance < onset:
        force, energy = compression(zone, onset - distance)
        damping = normal_kernels.damping_force(force, zone.damping, opening)
    both = damping + zone.contact_damping[i, j]
    zone.damped -= zone.crossing_share[i, j] * 0.5 * zone.dt * both * opening
    zone.contact_onset[i, j] = onset
    zone.contact_force[i, j] = force
    zone.contact_energy[i, j] = energy
    zone.contact_damping[i, j] = damping
    return force + damping
