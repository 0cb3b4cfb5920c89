"""Contact of crossing yarns in explicit dynamics: the middle of each facet is held off another yarn's face
(docs/theory-panel.md, "Woven solid yarns"). Each face, lower and upper, is slave once and master once, with half of
the penalty k. What the facet gets the 16 nodes of its foot give, with their weights in S: no momentum is made.

    p = k [0; g^2 / 2t; -g - t/2]  for  [g >= 0; 0 < -g < t; -g > t],    Pi = int p dg,
    U = A w(xi) Pi,    f = A w p n - A Pi grad w

Besides acts a damper c (-dg/dt), never less than nothing with the spring, and friction
(`contact.friction_kernels.slide`), a spring of the stiffness A k along the face. A facet of a brick that is torn, or
whose foot meets one, has no partner any more; what it had stored counts as lost to failure.
"""

import math

import numpy as np

from shellfabric.contact.friction_kernels import slide
from shellfabric.jit.compile import entry, kernel
from shellfabric.surface.vector_kernels import add_scaled, cross, dot, scaled, subtract, three
from validation.models.solids.spline_kernels import STENCIL, make_scratch, sign_of, surface_point

LONGEST_WAIT = 60  # steps
TRIES = 6  # steps of Newton's method from a foot that has been left behind
CLOSE = 0.02  # facets by which a foot may be off
LONGEST_STRIDE = 2.0  # facets in one of these steps
FADE = 0.5  # facets beyond the sides of a face over which contact fades
FACES = 2  # of a yarn: lower, upper
SIDE_BY_SIDE = 2  # from one crossing yarn on a side of a yarn to the next


@kernel(fastmath={"contract"})
def pressure(depth, penalty, toe):
    """Compute pressure [Pa], its integral [J/m2], and the share in which the contact is closed, at a
    depth [m] above 0."""
    if depth < toe:
        share = depth / toe
        return 0.5 * penalty * depth * share, penalty * depth * depth * share / 6.0, share
    stored = penalty * (0.5 * depth * (depth - toe) + toe * toe / 6.0)
    return penalty * (depth - 0.5 * toe), stored, 1.0


@kernel(fastmath={"contract"})
def fading(xi, cells, mirrored):
    """Compute the share of a facet that lies over a face of `cells` facets in one direction, the
    slope of it, and how far [facets] it is beyond where that ends."""
    beyond = xi - cells
    sign = 1.0
    if xi < 0.0 and not mirrored:
        beyond = -xi
        sign = -1.0
    if beyond <= 0.0:
        return 1.0, 0.0, 0.0
    t = beyond / FADE
    if t >= 1.0:
        return 0.0, 0.0, beyond - FADE
    return 1.0 - t * t * (3.0 - 2.0 * t), -6.0 * sign * t * (1.0 - t) / FADE, 0.0


@kernel()
def facet_corners(patch, face, a, b, corners):
    """Fill in the nodes (4,) of a facet and return its middle."""
    yarn = face // FACES
    sheet = (patch.ny[yarn] + 1) * (patch.nz + 1)
    stride = patch.nz + 1
    n = patch.face_node[face] + a * sheet + b * stride
    corners[0] = n
    corners[1] = n + sheet
    corners[2] = n + sheet + stride
    corners[3] = n + stride
    return mean(patch.x, corners)


@kernel(fastmath={"contract"})
def mean(values, corners):
    """Return the mean of the rows of an array (n, 3) at four corners."""
    middle = (0.0, 0.0, 0.0)
    for k in range(4):
        middle = add_scaled(middle, 0.25, three(values[corners[k]], 0))
    return middle


@kernel()
def facet_brick(patch, face, a, b):
    """Return the brick under a facet."""
    yarn = face // FACES
    ny = patch.ny[yarn]
    nz = patch.nz
    brick = patch.first_brick[yarn] + (a * ny + b) * nz
    if face % FACES == 1:
        brick += nz - 1
    return brick


@kernel(fastmath={"contract"})
def metric_step(away, S):
    """Compute the step of Newton's method (Gauss-Newton, in xi) to the foot of the point that lies
    `away` from S, and the inverse of the metric (11, 12, 22)."""
    first = three(S[1], 0)
    second = three(S[2], 0)
    m11 = dot(first, first)
    m12 = dot(first, second)
    m22 = dot(second, second)
    determinant = m11 * m22 - m12 * m12
    inverse = (m22 / determinant, -m12 / determinant, m11 / determinant)
    r1 = dot(away, first)
    r2 = dot(away, second)
    return inverse[0] * r1 + inverse[1] * r2, inverse[1] * r1 + inverse[2] * r2, inverse


@kernel()
def move_foot(patch, facet, step0, step1):
    """Move the foot of a facet, not far beyond the ends of its face."""
    face = patch.partner[facet]
    yarn = face // FACES
    nx = patch.nx[yarn]
    ny = patch.ny[yarn]
    room = FADE + 1.0
    low = -room
    if patch.quarter == 1:
        low = -0.5
    foot = patch.foot[facet, 0] + min(max(step0, -LONGEST_STRIDE), LONGEST_STRIDE)
    patch.foot[facet, 0] = min(max(foot, low), nx + room)
    low = -room
    if patch.cut[yarn]:
        low = -0.5
    foot = patch.foot[facet, 1] + min(max(step1, -LONGEST_STRIDE), LONGEST_STRIDE)
    patch.foot[facet, 1] = min(max(foot, low), ny + room)


@kernel(fastmath={"contract"})
def find_foot(patch, facet, middle, scratch):
    """Find the foot of the middle of a facet on its partner, whose point and weights are left in
    `scratch`; one more step of Newton's method is made for the next call.

    Returns
    -------
    away : (3,) [m] from the foot to the middle
    seen : (2,) place of that foot
    inverse : of the metric there
    found : whether it is the foot; where it has run on it is found in a later call
    """
    S = scratch[4]
    moved = 0.0
    for tried in range(TRIES):
        seen = (patch.foot[facet, 0], patch.foot[facet, 1])
        surface_point(patch, patch.partner[facet], seen[0], seen[1], scratch)
        away = subtract(middle, three(S[0], 0))
        step0, step1, inverse = metric_step(away, S)
        move_foot(patch, facet, step0, step1)
        moved = max(abs(patch.foot[facet, 0] - seen[0]), abs(patch.foot[facet, 1] - seen[1]))
        if moved < CLOSE or tried == TRIES - 1:
            break
    return away, seen, inverse, moved < CLOSE


@kernel()
def let_go(patch, facet):
    """Take the partner of a facet away; what its contact had stored is lost to failure."""
    patch.failure_energy += patch.contact_energy[facet]
    patch.contact_energy[facet] = 0.0
    patch.partner[facet] = -1


@kernel()
def open_contact(patch, facet, slider):
    """Let a facet slip freely, since it is clear: what its friction held is lost to sliding."""
    held = 0.5 * tangential(patch, facet) * dot(slider, slider)
    patch.friction_work += held
    patch.contact_energy[facet] = 0.0


@kernel()
def over_overlap(patch, facet, gap, share):
    """Return the gap [m] of a facet less its overlap, which changes while the facet is clear.

    Nothing in a mesh at rest stores energy: where it overlaps, g_0 is that overlap. A facet that is
    found within a face, deeper than it can have come in a step, has come in from beside, or from
    behind where a yarn has rolled over: it has that overlap for g_0, since to push it out would
    make energy. As it comes out, g_0 goes with it.
    """
    overlap = patch.overlap[facet]
    if patch.contact_energy[facet] == 0.0:
        overlap = max(overlap, min(gap, 0.0))
        if overlap - gap > patch.reach > 0.0:
            overlap = gap
        if share == 0.0:
            overlap = 0.0
        patch.overlap[facet] = overlap
    return gap - overlap


@kernel()
def tangential(patch, facet):
    """Return the stiffness [N/m] of the friction spring of a facet in one pass."""
    return 0.5 * patch.penalty * patch.area[facet]


@kernel()
def steps_to(patch, distance):
    """Return the number of steps in which no motion closes a distance [m]."""
    if patch.reach <= 0.0:
        return 0
    return int(min(distance / patch.reach, LONGEST_WAIT))


@kernel(fastmath={"contract"})
def yielding(patch, corners, nodes, weights):
    """Return the inverse mass [1/kg] of a gap: that of its facet and of its foot."""
    found = 0.0
    for k in range(4):
        found += 0.0625 / patch.whole_mass[corners[k]]
    for m in range(STENCIL):
        found += weights[m] * weights[m] / patch.whole_mass[nodes[m]]
    return found


@kernel(fastmath={"contract"})
def relative_velocity(patch, corners, axial, scratch):
    """Return the velocity [m/s] of the middle of a facet over its foot."""
    nodes, weights, flips, _, _ = scratch
    v = mean(patch.v, corners)
    v0, v1, v2 = v
    for m in range(STENCIL):
        n = nodes[m]
        v0 -= weights[m] * patch.v[n, 0] * sign_of(flips, m, 0, axial)
        v1 -= weights[m] * patch.v[n, 1] * sign_of(flips, m, 1, axial)
        v2 -= weights[m] * patch.v[n, 2]
    return v0, v1, v2


@kernel(fastmath={"contract"})
def share_out(patch, corners, axial, scratch, push):
    """Add a force [N] on a facet, and its opposite on the foot, to the internal forces."""
    nodes, weights, flips, _, _ = scratch
    for k in range(4):
        for c in range(3):
            patch.f_other[corners[k], c] -= 0.25 * push[c]
    for m in range(STENCIL):
        for c in range(3):
            patch.f_other[nodes[m], c] += weights[m] * sign_of(flips, m, c, axial) * push[c]


@kernel(fastmath={"contract"})
def meet_partner(patch, face, a, b, facet, dt, corners, scratch):
    """Add the forces of one facet on its partner.

    dt : [s] since the last call; 0 at the first
    corners : (4,) int scratch;  scratch : of `spline_kernels.make_scratch`
    """
    if patch.torn[facet_brick(patch, face, a, b)]:
        let_go(patch, facet)
        return
    middle = facet_corners(patch, face, a, b, corners)
    away, seen, inverse, found = find_foot(patch, facet, middle, scratch)
    nodes, weights, _, _, S = scratch
    partner = patch.partner[facet]
    yarn = partner // FACES
    normal = cross(three(S[1], 0), three(S[2], 0))
    normal = scaled(patch.face_turn[partner] / math.sqrt(dot(normal, normal)), normal)
    gap = dot(away, normal)
    nx = patch.nx[yarn]
    ny = patch.ny[yarn]
    w0, slope0, beyond0 = fading(seen[0], nx, patch.quarter == 1)
    w1, slope1, beyond1 = fading(seen[1], ny, patch.cut[yarn])
    share = w0 * w1
    gap = over_overlap(patch, facet, gap, share if found else 0.0)
    if gap >= 0.0 or share == 0.0 or not found:
        if patch.contact_energy[facet] > 0.0:
            open_contact(patch, facet, three(patch.slider[facet], 0))
        for c in range(3):
            patch.slider[facet, c] = 0.0
        length0 = math.sqrt(dot(three(S[1], 0), three(S[1], 0)))
        length1 = math.sqrt(dot(three(S[2], 0), three(S[2], 0)))
        clear = max(gap, max(beyond0 * length0, beyond1 * length1))
        patch.wait[facet] = steps_to(patch, clear) if found else 0
        return
    under = min(max(int(seen[1]), 0), ny - 1)
    if patch.torn[facet_brick(patch, partner, min(max(int(seen[0]), 0), nx - 1), under)]:
        let_go(patch, facet)
        return
    axial = patch.family[yarn]
    area = patch.area[facet]
    p, stored, closed = pressure(-gap, 0.5 * patch.penalty, patch.toe)
    v = relative_velocity(patch, corners, axial, scratch)
    opening = dot(v, normal)
    push = area * p * share
    drag = max(-closed * patch.damping[facet] * opening * share, -push)
    push += drag
    mobility = yielding(patch, corners, nodes, weights)
    # the damper acts at the velocity in the middle of the push
    patch.contact_damping -= drag * (opening + 0.5 * dt * mobility * push) * dt
    force = scaled(push, normal)
    # the share is part of the energy: its slope acts along the face
    held = -area * stored
    up0 = held * slope0 * w1
    up1 = held * w0 * slope1
    force = add_scaled(force, inverse[0] * up0 + inverse[1] * up1, three(S[1], 0))
    force = add_scaled(force, inverse[1] * up0 + inverse[2] * up1, three(S[2], 0))
    energy = area * stored * share
    if patch.friction > 0.0:
        stiffness = tangential(patch, facet)
        limit = patch.friction * area * p * share
        kept, slid = slide(patch.slider[facet], limit, stiffness, dt, normal, v)
        force = add_scaled(force, -stiffness, three(patch.slider[facet], 0))
        energy += kept
        patch.friction_work += slid
    patch.contact_energy[facet] = energy
    share_out(patch, corners, axial, scratch, force)


@kernel()
def contact_forces(patch, dt):
    """Add the forces of all yarns on each other."""
    corners = np.empty(4, np.int64)
    scratch = make_scratch()
    for face in range(patch.face_node.size):
        yarn = face // FACES
        facet = patch.face_facet[face] - 1
        for a in range(patch.nx[yarn]):
            for b in range(patch.ny[yarn]):
                facet += 1
                if patch.partner[facet] < 0:
                    continue
                if patch.wait[facet] > 0:
                    patch.wait[facet] -= 1
                    continue
                meet_partner(patch, face, a, b, facet, dt, corners, scratch)


@kernel()
def near_node(patch, face, xi0):
    """Return the node in the middle of a face at the station nearest to xi0."""
    yarn = face // FACES
    sheet = (patch.ny[yarn] + 1) * (patch.nz + 1)
    station = min(max(int(xi0 + 0.5), 0), patch.nx[yarn])
    return patch.face_node[face] + station * sheet + middle_row(patch, yarn)


@kernel()
def middle_row(patch, yarn):
    """Return the number of nodes of a section before the row in the middle of a yarn."""
    if patch.cut[yarn]:
        return 0
    return patch.ny[yarn] // 2 * (patch.nz + 1)


@kernel()
def distance_to(patch, face, xi0, middle):
    """Return the square of the distance [m2] of a point to the middle of a face."""
    away = subtract(middle, three(patch.x[near_node(patch, face, xi0)], 0))
    return dot(away, away)


@entry()
def choose_partners(patch):
    """Give each facet that is clear of its partner the nearest of the yarns that cross on its
    side.

    Of a yarn's lower or upper face a facet may meet the yarns that cross it on that side, every
    other one of the family. Two such yarns are further apart than they are wide, so a partner
    changes where neither is in touch. Parallel neighbours: `tip_kernels`.
    """
    corners = np.empty(4, np.int64)
    for face in range(patch.face_node.size):
        own = face // FACES
        facet = patch.face_facet[face] - 1
        for a in range(patch.nx[own]):
            for b in range(patch.ny[own]):
                facet += 1
                if patch.partner[facet] < 0 or patch.contact_energy[facet] > 0.0:
                    continue
                middle = facet_corners(patch, face, a, b, corners)
                partner = patch.partner[facet]
                best = distance_to(patch, partner, patch.foot[facet, 0], middle)
                for way in (-SIDE_BY_SIDE, SIDE_BY_SIDE):
                    other = patch.partner[facet] + way * FACES
                    if other < 0 or other >= patch.face_node.size:
                        continue
                    family = patch.family[other // FACES]
                    if family == patch.family[own]:
                        continue
                    found = distance_to(patch, other, patch.foot[facet, 0], middle)
                    if found < best:
                        best = found
                        partner = other
                if partner != patch.partner[facet]:
                    patch.partner[facet] = partner
                    patch.foot[facet, 1] = 0.5 * patch.ny[partner // FACES]
                    patch.wait[facet] = 0


@entry()
def find_feet(patch, gaps, shares):
    """Find the feet of all facets from where they are; fills the gaps (facets,) [m], without what
    is taken off, and the shares (facets,) [-]."""
    corners = np.empty(4, np.int64)
    scratch = make_scratch()
    S = scratch[4]
    for face in range(patch.face_node.size):
        yarn = face // FACES
        facet = patch.face_facet[face] - 1
        for a in range(patch.nx[yarn]):
            for b in range(patch.ny[yarn]):
                facet += 1
                shares[facet] = 0.0
                gaps[facet] = np.inf
                if patch.partner[facet] < 0:
                    continue
                middle = facet_corners(patch, face, a, b, corners)
                for _ in range(TRIES):
                    away, seen, _, _ = find_foot(patch, facet, middle, scratch)
                partner = patch.partner[facet]
                normal = cross(three(S[1], 0), three(S[2], 0))
                size = patch.face_turn[partner] / math.sqrt(dot(normal, normal))
                gaps[facet] = size * dot(away, normal)
                other = partner // FACES
                along = fading(seen[0], patch.nx[other], patch.quarter == 1)[0]
                across = fading(seen[1], patch.ny[other], patch.cut[other])[0]
                shares[facet] = along * across
