"""Parallel neighbours: yarns side by side touch, and cannot come closer than round yarns packed
side by side (docs/theory-panel.md, "Resolved yarns", Neighbours).

Points fixed on a yarn meet the closest points of the yarn beside it, that on the side of the line of
flight: the contacts of a fabric that has a plane of symmetry along its middle yarn have it too, and
that yarn has no points. w2 is closer where the crossing yarn floats over both than where it passes
between them. A closest point that runs along a loop of a slack yarn carries no force and comes back
as a crossing does. A point farther away than w1 is looked at again when it can have come to w1 at
twice its present velocity, after LONGEST_WAIT steps at the latest; found below w1, its contact begins
at that distance, so that being late makes no energy.
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.surface.vector_kernels import dot, scaled, subtract
from shellfabric.yarns.crossing_kernels import CLOSE, RUNS, moved
from shellfabric.yarns.curve_kernels import FIXED, gather, scatter, spline

FAR = 1.2  # w1^2, beyond which a foot is not sought to the end
LONGEST_WAIT = 8.0  # steps
FASTER = 2.0  # than they do now: how fast two yarns may come closer while a point waits


@kernel(_nrt=False)
def neighbour_forces(zone):
    """Add the forces of all neighbours to zone.f."""
    stored = 0.0
    for family in range(2):
        middle = zone.middle[family]
        first = 0
        if zone.mirror_first[1 - family] >= 0:  # of images the first alone meets what is no image
            first = middle - 1
        for yarn in range(first, zone.yarns[family]):
            if yarn == middle:
                continue
            start = zone.first[family] + yarn * zone.nodes[family]
            inwards = zone.nodes[family]
            if yarn > middle:
                inwards = -inwards
            for n in range(start + 2, start + zone.nodes[family] - 2, 2):
                if zone.foot[n] < 0.0:
                    continue
                if zone.foot_wait[n] > 0.0:
                    zone.foot_wait[n] -= 1.0
                    continue
                stored += neighbour_force(zone, family, start + inwards, n)
    zone.stored_at_neighbours = stored


@kernel(_nrt=False)
def closest_point(zone, family, start, n):
    """Move the foot of the point n to the closest point of the yarn beside it, whose first node is
    `start`.

    Returns (its node, weights, d from the point to it, |d|^2, what is left of its way [-]).
    """
    count = zone.nodes[family]
    point = gather(zone.x, n, FIXED)
    s = zone.foot[n]
    for turn in range(4):
        k, weights, slopes = spline(s, count)
        m = start + k
        d = subtract(gather(zone.x, m, weights), point)
        tangent = gather(zone.x, m, slopes)
        square = dot(d, d)
        step = -dot(d, tangent) / max(dot(tangent, tangent), 0.25 * zone.rest_length[m] ** 2)
        s = moved(s, step, count)
        far = turn == 1 and square > FAR * zone.touch_distance[family] ** 2
        if far or abs(step) < CLOSE:
            break
    zone.foot[n] = s
    if s == 0.5 or s == count - 1.5:  # at the end of the yarn it is as close as it gets
        step = 0.0
    return m, weights, d, square, step


@kernel(_nrt=False)
def neighbour_force(zone, family, start, n):
    """Compute the force of one point on the yarn that begins at the node `start`; return the energy
    [J] that it stores."""
    touch = zone.touch_distance[family]
    m, weights, d, square, step = closest_point(zone, family, start, n)
    if not (zone.whole[n - 1] and zone.whole[n] and zone.whole[m - 1] and zone.whole[m]):
        zone.lost_with_yarns += zone.node_share[n] * zone.foot_energy[n]
        zone.foot[n] = -1.0
        zone.foot_energy[n] = 0.0
        return 0.0
    if abs(step) > RUNS:
        zone.lost_when_slack += zone.node_share[n] * zone.foot_energy[n]
        zone.foot_energy[n] = 0.0
        zone.foot_onset[n] = -1.0
        return 0.0
    if square >= touch * touch:
        zone.foot_energy[n] = 0.0
        zone.foot_onset[n] = touch
        velocity = subtract(gather(zone.v, m, weights), gather(zone.v, n, FIXED))
        way = FASTER * zone.dt * math.sqrt(dot(velocity, velocity))
        wait = int(min((math.sqrt(square) - touch) / max(way, 1e-30), LONGEST_WAIT))
        zone.foot_wait[n] = wait
        if wait > 0:
            zone.foot_onset[n] = -1.0
        return 0.0
    distance = math.sqrt(square)
    force = lateral_force(zone, family, n, distance)
    push = scaled(force / distance, d)
    scatter(zone.f, n, FIXED, scaled(-1.0, push))
    scatter(zone.f, m, weights, push)
    return zone.node_share[n] * zone.foot_energy[n]


@kernel(_nrt=False)
def lateral_force(zone, family, n, distance):
    """Compute the force [N] of a point on the next yarn at a distance [m], and keep its energy."""
    soft = zone.touch_stiffness[family]
    hard = zone.closest_stiffness[family]
    onset = min(zone.touch_distance[family], max(zone.foot_onset[n], distance))
    near = onset - distance
    nearest = max(min(onset, zone.closest_distance[n]) - distance, 0.0)
    zone.foot_onset[n] = onset
    zone.foot_energy[n] = 0.5 * (soft * near * near + hard * nearest * nearest)
    return soft * near + hard * nearest
