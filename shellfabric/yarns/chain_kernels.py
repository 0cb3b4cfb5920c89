"""Yarns as chains of segments that bear tension alone, and their failure (docs/theory-panel.md, "Resolved
yarns"). A yarn of family 0 (warp) lies along x, of family 1 (weft) along y; node n and segment n, from
node n to n + 1, share a number. A segment fails by the criterion of the membrane
(`membrane.failure_kernels`), over the same segment of neighbouring yarns, in the step after F has passed
the strength.

Works of dissipative forces are those of the mean of the old and the new force, each in its own direction:
a segment that whips turns by a few hundredths in a step. What that mean leaves of the energy of a segment
that snaps taut or goes slack is in `zone.lost_in_snaps`, as the membrane's is in "yarn_snap".
"""

import math

from shellfabric.jit.compile import entry, kernel
from shellfabric.membrane import criterion_kernels
from shellfabric.surface.vector_kernels import column, dot, subtract

TINY = 1e-9  # [N] below which a force has no direction
ROUNDING = 1e-12  # strain below which a segment counts as at rest
# lets LLVM add up the energies in any order, in vectors: their last digit is that of the processor
SUM = {"reassoc", "nsz", "contract"}


@entry(_nrt=False)
def move(zone):
    """Move the nodes by one step; those that are tied or led have no mobility, and go on at their
    velocity."""
    for c in range(3):
        x = zone.x[c]
        v = zone.v[c]
        f = zone.f[c]
        for n in range(x.size):
            v[n] += zone.dt * zone.inverse_mass[n] * f[n]
            x[n] += zone.dt * v[n]


@kernel(_nrt=False)
def mirror_nodes(zone):
    """Put the images beyond planes of symmetry where their originals are."""
    for family in range(2):
        own = zone.mirror_first[family]
        across = 1 - family
        side = zone.mirror_first[across]
        nodes = zone.nodes[family]
        if own >= 0:
            plane = 2 * (own + 1)
            for y in range(zone.yarns[family]):
                start = zone.first[family] + y * nodes
                for k in range(plane + 1):
                    for c in range(3):
                        turn = 1.0
                        if c == family:
                            turn = -1.0
                            if k == plane:
                                turn = 0.0
                        n = start + k
                        m = start + 2 * plane - k
                        zone.x[c, n] = turn * zone.x[c, m]
                        zone.v[c, n] = turn * zone.v[c, m]
                    if k < plane:
                        zone.whole[start + k] = zone.whole[start + 2 * plane - 1 - k]
                        zone.breaking[start + k] = zone.breaking[start + 2 * plane - 1 - k]
                        zone.filtered[start + k] = zone.filtered[start + 2 * plane - 1 - k]
        if side >= 0:
            for y in range(side + 1):
                start = zone.first[family] + y * nodes
                other = zone.first[family] + (2 * side - y) * nodes
                for k in range(nodes):
                    for c in range(3):
                        turn = 1.0
                        if c == across:
                            turn = -1.0
                            if y == side:
                                turn = 0.0
                        zone.x[c, start + k] = turn * zone.x[c, other + k]
                        zone.v[c, start + k] = turn * zone.v[c, other + k]
                    zone.whole[start + k] = zone.whole[other + k]
                    zone.breaking[start + k] = zone.breaking[other + k]
                    zone.filtered[start + k] = zone.filtered[other + k]


@kernel()
def nodes_of(zone, family):
    """Return the first node of a family, and that after its last one."""
    first = zone.first[family]
    return first, first + zone.yarns[family] * zone.nodes[family]


@kernel()
def yarn_of(zone, family, n):
    """Return the number of the yarn, in its family, of a node."""
    return (n - zone.first[family]) // zone.nodes[family]


@kernel(_nrt=False)
def chain_forces(zone):
    """Compute the forces of all segments, in place of what zone.f has."""
    if zone.segments_to_break > 0:
        break_segments(zone)
    zone.stored = 0.0
    for family in range(2):
        stretch_segments(zone, family, *nodes_of(zone, family))
    for c in range(3):
        zone.f[c, 0] = zone.pull[c, 0]
        pull_nodes(zone.pull[c], zone.f[c])


@kernel(_nrt=False)
def break_segments(zone):
    """Take out the segments that are to break.

    Half of the work of a step is that of the force at its begin: their tension does it for the last
    time.
    """
    zone.segments_to_break = 0
    for family in range(2):
        for n in range(*nodes_of(zone, family)):
            if zone.breaking[n] and zone.whole[n]:
                side = subtract(column(zone.x, 0, n + 1), column(zone.x, 0, n))
                velocity = subtract(column(zone.v, 0, n + 1), column(zone.v, 0, n))
                way = 0.5 * zone.dt * dot(velocity, side) / math.sqrt(dot(side, side))
                strain = zone.tension[n] / zone.stiffness[family]
                stored = 0.5 * zone.tension[n] * strain * zone.rest_length[n]
                zone.lost_with_yarns += zone.segment_share[n] * (stored + zone.tension[n] * way)
                zone.damped += zone.segment_share[n] * zone.viscous_force[n] * way
                zone.torn_segments += zone.segment_share[n]
                zone.whole[n] = False
                zone.tension[n] = zone.viscous_force[n] = 0.0
                zone.torn[family, yarn_of(zone, family, n)] = True


@kernel(_nrt=False, fastmath=SUM)
def stretch_segments(zone, family, first, last):
    """Compute the tensions of the segments of a family, whose nodes are first .. last - 1; their
    forces on the nodes before them.

    A loop over all of them, which LLVM turns into vector instructions. What lies between the end of
    a yarn and the next one is not whole. The forces go into zone.pull.
    """
    count = last - first - 1
    x, y, z = parts_of(zone.x, first, count)
    next_x, next_y, next_z = parts_of(zone.x, first + 1, count)
    u, v, w = parts_of(zone.v, first, count)
    next_u, next_v, next_w = parts_of(zone.v, first + 1, count)
    pull_x = zone.pull[0, first : first + count]
    pull_y = zone.pull[1, first : first + count]
    pull_z = zone.pull[2, first : first + count]
    tension = zone.tension[first : first + count]
    viscous_force = zone.viscous_force[first : first + count]
    rest_length = zone.rest_length[first : first + count]
    whole = zone.whole[first : first + count]
    share = zone.segment_share[first : first + count]
    stiffness = zone.stiffness[family]
    drag = zone.drag[family]
    stored = 0.0
    damped = 0.0
    snapped = 0.0
    for n in range(count):
        side_x = next_x[n] - x[n]
        side_y = next_y[n] - y[n]
        side_z = next_z[n] - z[n]
        length = math.sqrt(side_x * side_x + side_y * side_y + side_z * side_z)
        per_length = 1.0 / length
        opening = (next_u[n] - u[n]) * side_x
        opening += (next_v[n] - v[n]) * side_y
        opening += (next_w[n] - w[n]) * side_z
        rate = opening * per_length
        rest = rest_length[n]
        strain = length / rest - 1.0
        bears = 1.0 * (whole[n] & (strain > ROUNDING))
        taut = bears * stiffness * strain
        damping = bears * max(drag * rate, -taut)
        energy = 0.5 * taut * strain * rest
        before = tension[n]
        released = 0.5 * before * before / stiffness * rest
        # the force at the beginning of the step acts in the direction that it had then
        held = before + viscous_force[n]
        rate_before = rate
        if held > TINY:
            work_rate = (next_u[n] - u[n]) * pull_x[n]
            work_rate += (next_v[n] - v[n]) * pull_y[n]
            work_rate += (next_w[n] - w[n]) * pull_z[n]
            rate_before = work_rate / held
        snap = (before * rate_before + taut * rate) * (0.5 * zone.dt) - energy + released
        snapped += share[n] * snap * ((before == 0.0) != (taut == 0.0))
        damped += share[n] * (viscous_force[n] * rate_before + damping * rate)
        stored += share[n] * energy
        tension[n] = taut
        viscous_force[n] = damping
        force = (taut + damping) * per_length
        pull_x[n] = force * side_x
        pull_y[n] = force * side_y
        pull_z[n] = force * side_z
    zone.stored += stored
    zone.damped += 0.5 * zone.dt * damped
    zone.lost_in_snaps += snapped


@kernel(_nrt=False, inline="always")
def parts_of(vectors, begin, count):
    """Return `count` entries from `begin` on, of each of the three rows of an array."""
    end = begin + count
    return vectors[0, begin:end], vectors[1, begin:end], vectors[2, begin:end]


@kernel(_nrt=False)
def pull_nodes(pull, f):
    """Add the forces f of the nodes between segments that pull, of one component."""
    before = pull[:-1]
    behind = pull[1:]
    inner = f[1:]
    for n in range(inner.size):
        inner[n] = behind[n] - before[n]


@kernel(_nrt=False)
def follow_tensions(zone):
    """Let F of each segment follow its M, and mark the segments that break; keep the highest
    tension."""
    for family in range(2):
        for n in range(*nodes_of(zone, family)):
            half = zone.half_strength[n]
            near = zone.tension[n] > min(zone.peak_tension[family], half)
            if zone.whole[n] and (near or zone.filtered[n] > half):
                follow_segment(zone, family, n)


@kernel(_nrt=False)
def follow_segment(zone, family, n):
    """Let F of one segment follow its M, and tell whether it breaks."""
    half = zone.half_strength[n]
    mean = mean_tension(zone, family, n)
    zone.filtered[n] = criterion_kernels.follow_mean(
        zone.filtered[n], mean, half, zone.filter_factor[family]
    )
    if zone.segment_share[n] > 0.0 and min(mean, zone.filtered[n]) > zone.peak_tension[family]:
        zone.peak_tension[family] = min(mean, zone.filtered[n])
        zone.peak_segment[family] = n
    if zone.filtered[n] <= half:
        return
    load = criterion_kernels.load_of(
        zone.panel, zone.filtered[n], zone.strength[n], zone.stiffness[family]
    )
    zone.breaking[n] = criterion_kernels.breaks(
        zone.rate_law, family, zone.dt, zone.rate_damage, n, load
    )
    if zone.breaking[n]:
        zone.segments_to_break += 1


@kernel(_nrt=False)
def mean_tension(zone, family, n):
    """Compute M [N] of a segment: mean over the whole segments beside it, by the weights of their
    yarns."""
    total = 0.0
    weight = 0.0
    yarn = yarn_of(zone, family, n)
    number = yarn + family * zone.yarns[0]
    for m in range(zone.mean_weights.shape[1]):
        if zone.mean_weights[number, m] == 0.0:
            continue
        other = zone.mean_first[number] + m
        beside = n + (other - yarn) * zone.nodes[family]
        if zone.whole[beside]:
            total += zone.mean_weights[number, m] * zone.tension[beside]
            weight += zone.mean_weights[number, m]
    return total / weight
