"""Yarns as chains of segments that bear tension alone, and their failure.

    T = E A (l / l0 - 1), at least 0,    T_v = xi sqrt(E A lambda) dl/dt, at least -T

with the linear density lambda: xi is the damping ratio of the highest mode of a chain with lumped masses. A yarn of
family 0 (warp) lies along x, of family 1 (weft) along y; node n and segment n, from node n to n + 1, share a number.

A segment fails by the criterion of the membrane (`cloth.failure_kernels`), whose lines are here the yarns themselves:
M, the mean of the tensions of the same segment of neighbouring yarns over the fabric's failure length, and F, which
follows M over the time of a wave across that length. It breaks in the step after F has passed the strength.

Books. The kinetic energy of central differences changes in a step by v(n-1/2) (f(n) + f(n-1)) dt / 2: works of
dissipative forces are those of the mean of the old and the new force. That mean is not the change of the energy of a
segment that snaps taut or goes slack within the step: SNAP has the rest, as "yarn_snap" of the membrane has it.
"""

import math

from shellfabric.cloth import strength_kernels
from shellfabric.cloth.vector_kernels import add_scaled, dot, scaled
from shellfabric.jit.compile import entry, kernel
from shellfabric.yarns.curve_kernels import row

# of zone.books [J]: energies at present, then works so far, then counts
STORED, CROSSINGS, NEIGHBOURS, NOSE = 0, 1, 2, 3
VISCOUS, FRICTION, FAILED, SLACK, NOSE_FRICTION, SNAP = 4, 5, 6, 7, 8, 9
TORN, TANGLED = 10, 11
BOOKS = 12
ROUNDING = 1e-12  # strain below which a segment counts as at rest


@entry(_nrt=False)
def move(zone):
    """Move the nodes by one step; those that are tied or led have no mobility, and go on at their velocity."""
    for n in range(zone.x.shape[0]):
        for c in range(3):
            zone.v[n, c] += zone.dt * zone.inverse_mass[n] * zone.f[n, c]
            zone.x[n, c] += zone.dt * zone.v[n, c]
            zone.f[n, c] = 0.0


@kernel(_nrt=False)
def chain_forces(zone):
    """Forces of all segments, into zone.f."""
    stored = 0.0
    damped = 0.0
    for family in range(2):
        for yarn in range(zone.yarns[family]):
            start = zone.first[family] + yarn * zone.nodes[family]
            for n in range(start, start + zone.nodes[family] - 1):
                if not zone.whole[n]:
                    continue
                if zone.breaking[n]:
                    zone.torn[family, yarn] = True
                energy, work = segment_force(zone, family, n)
                stored += energy
                damped += work
    zone.books[STORED] = stored
    zone.books[VISCOUS] += damped


@kernel(_nrt=False)
def segment_force(zone, family, n):
    """Force of a segment; the energy [J] that it stores, and what its viscosity takes in the step."""
    side = add_scaled(row(zone.x, n + 1), -1.0, row(zone.x, n))
    length = math.sqrt(dot(side, side))
    along = scaled(1.0 / length, side)
    rate = dot(add_scaled(row(zone.v, n + 1), -1.0, row(zone.v, n)), along)
    damping = zone.viscous_force[n]
    zone.viscous_force[n] = 0.0
    strain = length / zone.rest_length[n] - 1.0
    before = zone.tension[n]
    zone.tension[n] = zone.stiffness[family] * strain if strain > ROUNDING else 0.0
    stored = 0.5 * zone.tension[n] * strain * zone.rest_length[n]
    if zone.breaking[n]:
        zone.whole[n] = False
        zone.tension[n] = 0.0
        zone.books[FAILED] += stored
        zone.books[TORN] += 1.0
        return 0.0, 0.5 * zone.dt * damping * rate
    if (before == 0.0) != (zone.tension[n] == 0.0):
        released = 0.5 * before * before / zone.stiffness[family] * zone.rest_length[n]
        work = 0.5 * zone.dt * rate * (before + zone.tension[n])
        zone.books[SNAP] += work - stored + released
    if zone.tension[n] == 0.0:
        return 0.0, 0.5 * zone.dt * damping * rate
    zone.viscous_force[n] = max(zone.drag[family] * rate, -zone.tension[n])
    pull = zone.tension[n] + zone.viscous_force[n]
    for c in range(3):
        zone.f[n, c] += pull * along[c]
        zone.f[n + 1, c] -= pull * along[c]
    return stored, 0.5 * zone.dt * (damping + zone.viscous_force[n]) * rate


@kernel(_nrt=False)
def follow_tensions(zone):
    """Let F of each segment follow its M, and mark the segments that break; keep the highest tension."""
    for family in range(2):
        for yarn in range(zone.yarns[family]):
            start = zone.first[family] + yarn * zone.nodes[family]
            for n in range(start, start + zone.nodes[family] - 1):
                half = zone.half_strength[n]
                near = zone.tension[n] > min(zone.peak_tension[family], half)
                if zone.whole[n] and (near or zone.filtered[n] > half):
                    follow_segment(zone, family, yarn, n)


@kernel(_nrt=False)
def follow_segment(zone, family, yarn, n):
    """F of one segment, and whether it breaks."""
    half = zone.half_strength[n]
    mean = mean_tension(zone, family, yarn, n)
    if max(mean, zone.filtered[n]) > half:
        followed = zone.filtered[n] + zone.filter_factor[family] * (mean - zone.filtered[n])
        zone.filtered[n] = max(half, followed)
    if min(mean, zone.filtered[n]) > zone.peak_tension[family]:
        zone.peak_tension[family] = min(mean, zone.filtered[n])
        zone.peak_segment[family] = n
    if zone.filtered[n] <= half:
        return
    load = zone.filtered[n] / zone.strength[n]
    damage = strength_kernels.damage(zone.rate_law, family, zone.dt, zone.rate_damage, n, load)
    strength_kernels.keep_damage(zone.rate_law, zone.rate_damage, n, damage)
    zone.breaking[n] = load > strength_kernels.highest_load(zone.rate_law) or damage >= 1.0


@kernel(_nrt=False)
def mean_tension(zone, family, yarn, n):
    """M [N] of a segment: mean over the whole segments beside it, by the weights of their yarns."""
    total = 0.0
    weight = 0.0
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
