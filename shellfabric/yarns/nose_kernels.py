"""The nose against the yarns of a zone: penalty on the signed distance D of any projectile (`sdf_kernels`), at
points of the chains, f = k <r - D> n, friction as for the membrane's contact (`friction_kernels`).

A yarn is a rod of the radius r, half its half of the ply's thickness. Points lie at the nodes and in the
middle of the segments, a quarter of a crossover apart, each three across the yarn: on the middle line and
at the two edges, `nose_edge` beside it, along the direction that is across the yarn in the plane of the
fabric at rest; each has a third of k. That direction does not turn: the force of an edge goes to the
nodes of the middle line and its moment is left out, and no energy with it.
"""

import math

from shellfabric.contact import friction_kernels, normal_kernels
from shellfabric.jit.compile import kernel
from shellfabric.projectile import sdf_kernels
from shellfabric.surface.vector_kernels import (
    add_scaled,
    column,
    combined,
    components,
    scaled,
    subtract,
    three,
)
from shellfabric.yarns.curve_kernels import FIXED, gather, scatter

AT_NODE, BETWEEN = 0, 1
MOST_STRETCH = 1.5  # of a whole segment
MIDDLE_WEIGHTS = (0.0, 0.5, 0.5)
ACROSS = 3  # points across a yarn: edge, middle line, edge


@kernel(_nrt=False)
def nose_forces(zone, state, const):
    """Add the forces of the nose to zone.f and state.f_contact_nose; count points of whole yarns
    ahead of it."""
    for c in range(3):
        state.f_contact_nose[c] = 0.0
    zone.stored_at_nose = 0.0
    zone.points_ahead = 0
    for family in range(2):
        for yarn in range(zone.yarns[family]):
            n = zone.first[family] + yarn * zone.nodes[family] + 1
            last = n + zone.nodes[family] - 2
            held = not zone.torn[family, yarn]
            while n < last:
                far = beyond_reach(zone, state, const, n, family)
                if far > 0.0:
                    if held:  # no node of a whole yarn is nearer than that
                        n += int(far / (MOST_STRETCH * zone.rest_length[n]))
                else:
                    after = zone.whole[n]
                    both = zone.whole[n - 1] and after
                    for beside in range(ACROSS):
                        edge = 1 - family, (beside - 1.0) * zone.nose_edge[family]
                        point = AT_NODE * ACROSS + beside
                        nose_point(zone, state, const, n, point, edge, FIXED, both, held)
                        point = BETWEEN * ACROSS + beside
                        nose_point(zone, state, const, n, point, edge, MIDDLE_WEIGHTS, after, held)
                n += 1


@kernel(_nrt=False)
def beyond_reach(zone, state, const, n, family):
    """Compute the distance [m] by which a node is farther from the line of flight than the nose,
    and a segment, reach."""
    place = subtract(column(zone.x, 0, n), three(state.projectile_position, 0))
    x, y, _ = components(const.frame, place)
    reach = const.projectile_radius + zone.rod + zone.nose_edge[family]
    reach += 2.0 * zone.rest_length[n]
    return math.sqrt(x * x + y * y) - reach


@kernel(_nrt=False)
def nose_point(zone, state, const, n, kind, edge, weights, whole, held):
    """Compute the contact of one point; edge : (axis, [m]) of its place beside the middle line."""
    share = zone.node_share[n]
    if kind >= BETWEEN * ACROSS:
        share = zone.segment_share[n]
    if not whole:
        zone.lost_with_yarns += share * zone.nose_energy[n, kind]
        zone.nose_energy[n, kind] = 0.0
        return
    axis, beside = edge
    place = add_scaled(gather(zone.x, n, weights), -1.0, state.projectile_position)
    if axis == 0:
        place = place[0] + beside, place[1], place[2]
    else:
        place = place[0], place[1] + beside, place[2]
    x, y, z = components(const.frame, place)
    reach = const.projectile_radius + zone.rod
    square = x * x + y * y
    zone.nose_energy[n, kind] = 0.0
    if square > reach * reach:
        return
    if held and share > 0.0 and z > -const.shoulder and square < const.projectile_radius**2:
        zone.points_ahead += 1
    if z > zone.rod:
        return
    distance, normal = sdf_kernels.distance(const.nose, (x, y, z))
    depth = zone.rod - distance
    if depth <= 0.0:
        if const.friction > 0.0:
            zone.friction_slip[n, kind] = 0.0
            zone.friction_force[n, kind] = 0.0
        return
    normal = combined(const.frame, normal)
    push, zone.nose_energy[n, kind] = normal_kernels.spring(zone.nose_stiffness / ACROSS, depth)
    zone.stored_at_nose += share * zone.nose_energy[n, kind]
    force = scaled(push, normal)
    if const.friction > 0.0:
        force = add_scaled(
            force, 1.0, nose_friction(zone, state, const, n, kind, weights, normal, push, share)
        )
    scatter(zone.f, n, weights, force)
    for c in range(3):
        state.f_contact_nose[c] -= share * force[c]


@kernel(_nrt=False)
def nose_friction(zone, state, const, n, kind, weights, normal, push, share):
    """Compute the friction of one point (`friction_kernels.friction_force`), without damping."""
    velocity = add_scaled(gather(zone.v, n, weights), -1.0, state.projectile_velocity)
    spring = zone.nose_stiffness / ACROSS, 0.0
    limit = const.friction * push
    slip = zone.friction_slip[n, kind]
    pull = zone.friction_force[n, kind]
    force, taken, _ = friction_kernels.friction_force(
        slip, pull, limit, spring, zone.dt, normal, velocity
    )
    zone.nose_friction_work += share * taken
    return force
