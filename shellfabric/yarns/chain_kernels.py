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
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    both,
    broadcast,
    equal_bytes,
    greater,
    load,
    maximum,
    minimum,
    reduce_add,
    sqrt,
    store,
    where,
)
from shellfabric.membrane import criterion_kernels
from shellfabric.surface.vector_kernels import add, column, dot, scaled, subtract

TINY = 1e-9  # [N] below which a force has no direction
ROUNDING = 1e-12  # strain below which a segment counts as at rest


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


@kernel(_nrt=False)
def stretch_segments(zone, family, first, last):
    """Compute the tensions of the segments of a family, whose nodes are first .. last - 1, and their
    forces on the nodes before them, into zone.pull: eight segments at once, the last few one by one.

    What lies between the end of a yarn and the next one is not whole.
    """
    law = zone.stiffness[family], zone.drag[family], 0.5 * zone.dt
    last -= 1
    tail = last - (last - first) % WIDTH
    none = broadcast(0.0)
    works = none, none, none
    for n in range(first, tail, WIDTH):
        forces, pull, work = stretch(
            (
                subtract(eight(zone.x, n + 1), eight(zone.x, n)),
                subtract(eight(zone.v, n + 1), eight(zone.v, n)),
            ),
            (equal_bytes(zone.whole, n, 1), load(zone.rest_length, n)),
            (load(zone.tension, n), load(zone.viscous_force, n), eight(zone.pull, n)),
            law,
        )
        works = add(works, scaled(load(zone.segment_share, n), work))
        store(zone.tension, n, forces[0])
        store(zone.viscous_force, n, forces[1])
        for c in range(3):
            store(zone.pull[c], n, pull[c])
    total = reduce_add(works[0]), reduce_add(works[1]), reduce_add(works[2])
    for n in range(tail, last):
        forces, pull, work = stretch(
            (
                subtract(column(zone.x, 0, n + 1), column(zone.x, 0, n)),
                subtract(column(zone.v, 0, n + 1), column(zone.v, 0, n)),
            ),
            (zone.whole[n], zone.rest_length[n]),
            (zone.tension[n], zone.viscous_force[n], column(zone.pull, 0, n)),
            law,
        )
        total = add(total, scaled(zone.segment_share[n], work))
        zone.tension[n], zone.viscous_force[n] = forces
        zone.pull[0, n], zone.pull[1, n], zone.pull[2, n] = pull
    zone.stored += total[0]
    zone.damped += total[1]
    zone.lost_in_snaps += total[2]


@kernel(_nrt=False, forceinline=True)
def eight(vectors, n):
    """Return eight vectors from column n of an array of three rows on."""
    return load(vectors[0], n), load(vectors[1], n), load(vectors[2], n)


@kernel(_nrt=False, forceinline=True)
def stretch(ends, own, before, law):
    """Compute one segment, or eight.

    Parameters
    ----------
    ends : what its end is from its begin [m], and how much faster [m/s]
    own : whether it bears, its length at rest [m]
    before : tension [N], viscous force [N] and force on its node [N] a step ago
    law : EA [N], viscosity [N s/m], half a time step [s]

    Returns
    -------
    (tension, viscous force), force on its node, energies [J]: stored; damped, lost in a snap in the
    step
    """
    side, apart = ends
    whole, rest = own
    tension, viscous, pull = before
    stiffness, drag, half_step = law
    length = sqrt(dot(side, side))
    per_length = 1.0 / length
    rate = dot(apart, side) * per_length
    strain = length / rest - 1.0
    bears = both(whole, greater(strain, ROUNDING))
    taut = where(bears, stiffness * strain, 0.0)
    damping = where(bears, maximum(drag * rate, 0.0 - taut), 0.0)
    energy = 0.5 * taut * strain * rest
    released = (0.5 / stiffness) * tension * tension * rest
    # the force at the beginning of the step acts in the direction that it had then
    held = tension + viscous
    rate_before = where(greater(held, TINY), dot(apart, pull) / held, rate)
    snap = (tension * rate_before + taut * rate) * half_step - energy + released
    snapped = where(greater(tension, 0.0), where(greater(taut, 0.0), 0.0, snap), 0.0)
    snapped = snapped + where(greater(tension, 0.0), 0.0, where(greater(taut, 0.0), snap, 0.0))
    damped = half_step * (viscous * rate_before + damping * rate)
    force = scaled((taut + damping) * per_length, side)
    return (taut, damping), force, (energy, damped, snapped)


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
        first, last = nodes_of(zone, family)
        for begin in range(first, last, WIDTH):
            if begin + WIDTH <= last and not followed8(zone, family, begin):
                continue
            for n in range(begin, min(begin + WIDTH, last)):
                half = zone.half_strength[n]
                near = zone.tension[n] > min(zone.peak_tension[family], half)
                if zone.whole[n] and (near or zone.filtered[n] > half):
                    follow_segment(zone, family, n)


@kernel(_nrt=False, forceinline=True)
def followed8(zone, family, n):
    """Tell whether one of eight segments from n on has a tension, or an F, that is to be followed."""
    half = load(zone.half_strength, n)
    near = greater(load(zone.tension, n), minimum(half, zone.peak_tension[family]))
    return any_lane(near) or any_lane(greater(load(zone.filtered, n), half))


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
