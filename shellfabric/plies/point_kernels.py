"""Contact of one point of a ply with the surface of its neighbour; the method is that of `plies.contact_kernels`.

Weights of a point are (first, middle, last, middle along x or y): displacements normal to a plane of symmetry change
their sign there, so that the middle node of the three has another weight for them (`surface_kernels.form_weights`).
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.plies.contact_simd_kernels import (
    CLEAR,
    CP_JUMP,
    IN_CONTACT,
    LOST,
    MAX_COMPRESSION,
    MAX_CP_STEP,
    MAX_DEPTH_JUMP,
    MAX_SQUEEZE,
    extend_window,
)
from shellfabric.plies.graded_kernels import add_weighted_offset, scaled_by_area
from shellfabric.plies.law_kernels import law_at
from shellfabric.plies.normal_force_kernels import store_normal_force
from shellfabric.plies.surface_kernels import (
    FACETS,
    NODES,
    SMOOTH,
    form_weights,
    intact_about,
    intact_fraction_at,
    interpolate,
    point_number,
    point_place,
    scatter_weighted,
    search_closest_point,
    second_derivatives,
    surface_patch,
)
from shellfabric.plies.turn_kernels import turned, turned_back


@kernel(_nrt=False, forceinline=True)
def grow_window(touched, i, j, n):
    """Widen the window of nodes with forces by n by n nodes."""
    extend_window(touched, i, i + n, j, j + n)


@kernel(_nrt=False, forceinline=True)
def vector_at(F, k, s, wa, wb):
    """Components of a nodal vector at a point with the weights wa along the first index and wb along the second."""
    return (
        interpolate(F[0], k, s, wa[0], wa[3], wa[2], wb[0], wb[1], wb[2]),
        interpolate(F[1], k, s, wa[0], wa[1], wa[2], wb[0], wb[3], wb[2]),
        interpolate(F[2], k, s, wa[0], wa[1], wa[2], wb[0], wb[1], wb[2]),
    )


@kernel(_nrt=False, forceinline=True)
def scatter_vector(F, k, s, f, n, w):
    """Add f n to a nodal vector by the weights w = (wa, wb) of a point."""
    wa, wb = w
    scatter_weighted(F[0], k, s, f * n[0], wa[0], wa[3], wa[2], wb[0], wb[1], wb[2])
    scatter_weighted(F[1], k, s, f * n[1], wa[0], wa[1], wa[2], wb[0], wb[3], wb[2])
    scatter_weighted(F[2], k, s, f * n[2], wa[0], wa[1], wa[2], wb[0], wb[1], wb[2])


@kernel(_nrt=False, forceinline=True)
def in_front_frame(pair, v):
    """A vector of the rear ply's frame, in that of the front ply."""
    x, y = turned_back(pair.turn, v[0], v[1])
    return x, y, v[2]


@kernel(_nrt=False, forceinline=True)
def front_point(front, fc, pair, a, b):
    """The front ply's point at (a, b): its displacement [m], indices and slot of its first node, and its weights."""
    form = pair.surface_form if pair.surface_form != SMOOTH or intact_about(front, fc, a, b) else FACETS
    i, p0, p1, p2, _, _, _, p1x, _ = form_weights(form, a, fc.ni, fc.mirror_x)
    j, q0, q1, q2, _, _, _, q1y, _ = form_weights(form, b, fc.nj, fc.mirror_y)
    k = np.uint64(i * fc.row_stride + j)
    wa, wb = (p0, p1, p2, p1x), (q0, q1, q2, q1y)
    x, y, z = vector_at(front.u, k, fc.row_stride, wa, wb)
    x = add_weighted_offset(x, fc.line_offset1, i, p0, p1x, p2)
    y = add_weighted_offset(y, fc.line_offset2, j, q0, q1y, q2)
    return (x, y, z), i, j, k, (wa, wb)


@kernel(_nrt=False, forceinline=True)
def rear_surface(rear, rc, form, A, B):
    """The rear ply's surface at (A, B): indices and slot of the first node, weights and their slopes, displacement [m]
    and tangents [m]."""
    I, w0, w1, w2, d0, d1, d2, w1x, d1x = form_weights(form, A, rc.ni, rc.mirror_x)
    J, v0, v1, v2, e0, e1, e2, v1y, e1y = form_weights(form, B, rc.nj, rc.mirror_y)
    K = np.uint64(I * rc.row_stride + J)
    X, Xa, Xb = surface_patch(rear.u[0], K, rc.row_stride, (w0, w1x, w2), (v0, v1, v2), (d0, d1x, d2), (e0, e1, e2))
    Y, Ya, Yb = surface_patch(rear.u[1], K, rc.row_stride, (w0, w1, w2), (v0, v1y, v2), (d0, d1, d2), (e0, e1y, e2))
    Z, Za, Zb = surface_patch(rear.u[2], K, rc.row_stride, (w0, w1, w2), (v0, v1, v2), (d0, d1, d2), (e0, e1, e2))
    X = add_weighted_offset(X, rc.line_offset1, I, w0, w1x, w2)
    Y = add_weighted_offset(Y, rc.line_offset2, J, v0, v1y, v2)
    Xa = add_weighted_offset(Xa, rc.line_offset1, I, d0, d1x, d2)
    Yb = add_weighted_offset(Yb, rc.line_offset2, J, e0, e1y, e2)
    weights, slopes = ((w0, w1, w2, w1x), (v0, v1, v2, v1y)), ((d0, d1, d2, d1x), (e0, e1, e2, e1y))
    return I, J, K, weights, slopes, (X, Y, Z), ((Xa + rc.dx, Ya, Za), (Xb, Yb + rc.dy, Zb))


@kernel(_nrt=False, forceinline=True)
def contact_normal(rc, pair, q, off, tangents, changed):
    """Normal n towards the rear ply, area of the tangents, depth [m], |cos| to the normal of the step before where that
    decided, and whether n is the direction of the point: in a fold, on a rim, of fabric drawn to a line. changed :
    whether yarns have failed in this step, or the surface has changed from spline to facets or back."""
    (x, y, z), ((Xa, Ya, Za), (Xb, Yb, Zb)) = off, tangents
    n_x, n_y, n_z = Ya * Zb - Za * Yb, Za * Xb - Xa * Zb, Xa * Yb - Ya * Xb
    size = math.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    tiny = 1e-6 * rc.dx * rc.dy
    if size < tiny:  # fabric that is drawn to a line has no normal
        n_x, n_y, n_z, size = pair.normal[0][q], pair.normal[1][q], pair.normal[2][q], 1.0
    n_x, n_y, n_z = n_x / size, n_y / size, n_z / size
    size = max(size, tiny)
    along, far, slant = n_x * x + n_y * y + n_z * z, math.sqrt(x * x + y * y + z * z), False
    turned, known = along > 0.0, 0.0  # what comes near does so on its own side
    # so deep that it may come through, or has
    if pair.status[q] == IN_CONTACT and (pair.last_depth[q] > MAX_SQUEEZE * pair.thickness or changed):
        known = n_x * pair.normal[0][q] + n_y * pair.normal[1][q] + n_z * pair.normal[2][q]
        turned = known < 0.0 if abs(known) > 0.5 else turned
    if turned and pair.surface_form == SMOOTH:
        n_x, n_y, n_z, along = -n_x, -n_y, -n_z, -along
    depth = pair.thickness + along
    near = depth > -0.5 * pair.thickness
    if pair.surface_form == SMOOTH and abs(known) <= 0.5 and far > 0.3 * pair.thickness and along > -0.7 * far:
        # a fold, a rim or fabric drawn to a line, whose normal says nothing of where the point is
        n_x, n_y, n_z, depth, slant = -x / far, -y / far, -z / far, pair.thickness - far, True
    return (n_x, n_y, n_z), size, depth, abs(known), slant, near, far


@kernel(_nrt=False, forceinline=True)
def closest_point_step(rear, rc, form, place, K, weights, slopes, off, tangents, size, depth, near):
    """Step (along a, along b) [elements] to the closest point, and whether it is one of Newton.

    place : (A, B, I, J), the closest point so far and the indices of the first node about it
    """
    (x, y, z), ((Xa, Ya, Za), (Xb, Yb, Zb)) = off, tangents
    if not near:  # of fabric that stands on end nothing is straight ahead
        area = max(Xa * Yb - Xb * Ya, 0.01 * rc.dx * rc.dy)
        return (Yb * x - Xb * y) / area, (Xa * y - Ya * x) / area, False
    aa, ab, bb = Xa * Xa + Ya * Ya + Za * Za, Xa * Xb + Ya * Yb + Za * Zb, Xb * Xb + Yb * Yb + Zb * Zb
    ra, rb = Xa * x + Ya * y + Za * z, Xb * x + Yb * y + Zb * z
    go, turn, sure = (bb * ra - ab * rb) / (size * size), (aa * rb - ab * ra) / (size * size), False
    if depth > 0.0:
        c0, c1, c2, c1x = second_derivatives(form, place[0], rc.ni, rc.mirror_x)
        g0, g1, g2, g1y = second_derivatives(form, place[1], rc.nj, rc.mirror_y)
        twice_a = vector_at(rear.u, K, rc.row_stride, (c0, c1, c2, c1x), weights[1])
        mixed = vector_at(rear.u, K, rc.row_stride, slopes[0], slopes[1])
        twice_b = vector_at(rear.u, K, rc.row_stride, weights[0], (g0, g1, g2, g1y))
        aa -= x * add_weighted_offset(twice_a[0], rc.line_offset1, place[2], c0, c1x, c2)
        aa -= y * twice_a[1] + z * twice_a[2]
        ab -= x * mixed[0]
        ab -= y * mixed[1] + z * mixed[2]
        bb -= x * twice_b[0]
        bb -= y * add_weighted_offset(twice_b[1], rc.line_offset2, place[3], g0, g1y, g2) + z * twice_b[2]
        det = aa * bb - ab * ab
        if det > 0.1 * size * size and aa > 0.0:
            go, turn, sure = (bb * ra - ab * rb) / det, (aa * rb - ab * ra) / det, True
    return go, turn, sure


@kernel(_nrt=False, forceinline=True)
def move_closest_point(rc, pair, q, place, step, low):
    """Move a closest point from `place` by `step`, at rest from then on; whether that takes it beside the rear ply."""
    A = place[0] + min(max(step[0], -MAX_CP_STEP), MAX_CP_STEP)
    B = place[1] + min(max(step[1], -MAX_CP_STEP), MAX_CP_STEP)
    pair.closest_point[0][q] = min(max(A, low[0]), float(rc.ni))
    pair.closest_point[1][q] = min(max(B, low[1]), float(rc.nj))
    pair.cp_rate[0][q] = pair.cp_rate[1][q] = 0.0
    return A > rc.ni or (A < 0.0 and not rc.mirror_x) or B > rc.nj or (B < 0.0 and not rc.mirror_y)


@kernel(_nrt=False, forceinline=True)
def relative_velocity(front, fc, rear, rc, pair, k, w_front, K, w_rear):
    """[m/s] of a point over its closest point on the rear ply, in its frame."""
    v_x, v_y, v_z = vector_at(rear.v, K, rc.row_stride, w_rear[0], w_rear[1])
    v_x, v_y, v_z = -v_x, -v_y, -v_z
    p_x, p_y, p_z = vector_at(front.v, k, fc.row_stride, w_front[0], w_front[1])
    p_x, p_y = turned(pair.turn, p_x, p_y)
    return v_x + p_x, v_y + p_y, v_z + p_z


@kernel(_nrt=False, forceinline=True)
def closing_speed(front, fc, rear, rc, pair, k, w_front, K, w_rear, n):
    """[m/s] at which a point and its closest point come nearer, along n."""
    v_x, v_y, v_z = relative_velocity(front, fc, rear, rc, pair, k, w_front, K, w_rear)
    return n[0] * v_x + n[1] * v_y + n[2] * v_z


@kernel(_nrt=False, forceinline=True)
def update_spring(pair, q, depth, made, jump, before, touches, lost, sure):
    """Offset of the spring of a point that touches, from the `jump` of its depth beside the motion, over the thickness;
    and the rate of its closest point, which was at `before`. The jump is infinite where a tear has changed the
    surfaces: compression of the spring that motion has not made would be energy from nowhere."""
    if pair.surface_form == SMOOTH and (lost or abs(jump) > MAX_DEPTH_JUMP):
        kept = max(pair.last_depth[q] - pair.depth_offset[q] + (0.0 if lost else made), 0.0)
        pair.depth_offset[q] = max(depth - kept, 0.0)
    elif not touches:
        pair.depth_offset[q] = depth if depth > 0.5 * pair.thickness and pair.surface_form == FACETS else 0.0
    elif sure:
        pair.cp_rate[0][q] = min(max(pair.closest_point[0][q] - before[0], -MAX_CP_STEP), MAX_CP_STEP)
        pair.cp_rate[1][q] = min(max(pair.closest_point[1][q] - before[1], -MAX_CP_STEP), MAX_CP_STEP)


@kernel(_nrt=False, forceinline=True)
def spring_force(fc, pair, q, a, b, depth, closing, part):
    """Force [N] on a point that touches, by its part of the law, and the energy [J] in its spring."""
    squeezed = depth - pair.depth_offset[q]
    pair.energy[MAX_COMPRESSION] = max(pair.energy[MAX_COMPRESSION], squeezed)
    if pair.point_offset == 0.0:  # half an element, or a quarter, is modelled about points on planes of symmetry
        part *= (0.5 if a == 0.0 and fc.mirror_x else 1.0) * (0.5 if b == 0.0 and fc.mirror_y else 1.0)
    part = scaled_by_area(part, pair.area_factor1, pair.area_factor2, int(a), int(b))
    spring, damping, energy = law_at(pair, squeezed)
    f = max(0.0, part * (spring + damping * closing))
    store_normal_force(pair.normal_force, q, f)
    return f, part * energy


@kernel(_nrt=False, forceinline=True)
def share_of_law(pair, twin, rc, e, A, B):
    """Part of the law that a point of element e has with its closest point (A, B): half where both plies have points,
    which is where the elements of both are beside torn ones. Elsewhere the ply in front has all of it.

    twin : Pair with the points of the other ply
    """
    foot = max(min(int(A), rc.ni - 1), 0) * rc.nj + max(min(int(B), rc.nj - 1), 0)
    if pair.near_torn[e] and twin.near_torn[foot]:
        return 0.5
    return 1.0 if pair.rest_distance > 0.0 else 0.0


@kernel(_nrt=False)
def take_over_contact(fc, rc, pair, twin, q):
    """Point number q begins to exist in the contact that its ply has there: closest point, normal, depth and offset are
    those of the nearest point of the other ply that touches it, within an element. Without them its whole depth would
    count as another fold's, and go into the offset."""
    _, a, b = point_place(fc, pair, q)
    m, n, nearest, least = int(pair.closest_point[0][q]), int(pair.closest_point[1][q]), -1, 1.0
    for i in range(max(m - 2, 0), min(m + 3, rc.ni)):
        for j in range(max(n - 2, 0), min(n + 3, rc.nj)):
            for number in range(twin.points_per_side**2):
                other = point_number(rc, twin, i, j, number)
                far = (twin.closest_point[0][other] - a) ** 2 + (twin.closest_point[1][other] - b) ** 2
                if twin.status[other] == IN_CONTACT and far < least:
                    nearest, least = other, far
    if nearest < 0:
        return
    _, A, B = point_place(rc, twin, nearest)
    a, b = a - twin.closest_point[0][nearest], b - twin.closest_point[1][nearest]
    x, y = turned(pair.turn, a * fc.dx, b * fc.dy)
    pair.closest_point[0][q], pair.closest_point[1][q] = A + x / rc.dx, B + y / rc.dy
    n_x, n_y, n_z = in_front_frame(twin, (twin.normal[0][nearest], twin.normal[1][nearest], twin.normal[2][nearest]))
    pair.normal[0][q], pair.normal[1][q], pair.normal[2][q] = -n_x, -n_y, -n_z
    pair.last_depth[q], pair.depth_offset[q] = twin.last_depth[nearest], twin.depth_offset[nearest]
    pair.status[q] = IN_CONTACT


@kernel(_nrt=False, forceinline=True)
def contact_point(front, fc, rear, rc, pair, twin, q, often):
    """Follow the closest point of the front ply's point number q, and apply its force: (energy in its spring, depth).

    The depth is negative where the point is clear of the rear ply, and 0 where it cannot push. twin : Pair with the
    rear ply's points; often : whether the closest point beside torn fabric is to be searched anew in any case
    """
    e, a, b = point_place(fc, pair, q)
    (x, y, z), i, j, k, w_front = front_point(front, fc, pair, a, b)
    x, y = turned(pair.turn, x + fc.x0 + a * fc.dx, y + fc.y0 + b * fc.dy)
    at_x, at_y, at_z = x - rc.x0, y - rc.y0, z - pair.rest_distance  # from the first node of the rear ply at rest
    smooth, touches = pair.surface_form == SMOOTH, pair.status[q] == IN_CONTACT
    low_a, low_b = -0.5 if smooth and rc.mirror_x else 0.0, -0.5 if smooth and rc.mirror_y else 0.0
    before = pair.closest_point[0][q], pair.closest_point[1][q]
    A = min(max(before[0] + pair.cp_rate[0][q], low_a), float(rc.ni))
    B = min(max(before[1] + pair.cp_rate[1][q], low_b), float(rc.nj))
    whole = not smooth or intact_about(rear, rc, A, B)
    form = pair.surface_form if whole else FACETS
    I, J, K, w_rear, slopes, (X, Y, Z), tangents = rear_surface(rear, rc, form, A, B)
    off = at_x - X - A * rc.dx, at_y - Y - B * rc.dy, at_z - Z  # from the closest point
    changed, pair.on_facet[q] = pair.torn_counts[2] != 0 or (pair.on_facet[q] == 0) != whole, 0 if whole else 1
    n, size, depth, known, slant, near, far = contact_normal(rc, pair, q, off, tangents, changed)
    go, turn, sure = closest_point_step(
        rear, rc, form, (A, B, I, J), K, w_rear, slopes, off, tangents, size, depth, near
    )  # fmt: skip
    beside = move_closest_point(rc, pair, q, (A, B), (go, turn), (low_a, low_b))
    lost, leapt = pair.status[q] == LOST, depth > 0.0 and max(abs(go), abs(turn)) > CP_JUMP
    if not (touches or lost):
        pair.last_depth[q] = pair.depth_offset[q] = 0.0
    pair.status[q] = LOST if leapt or (slant and (touches or lost)) else CLEAR
    torn = pair.near_torn[e] != 0
    if smooth and (leapt or (torn and (often or not (whole or touches)))):
        search_closest_point(rear, rc, pair.closest_point, q, at_x, at_y, at_z, far)
    if depth <= 0.0:
        return 0.0, 0.0 if torn or slant else depth
    if beside or (leapt and pair.surface_form != NODES):
        return 0.0, 0.0
    left_x, left_y = intact_fraction_at(front, fc, a, b), intact_fraction_at(rear, rc, A, B)
    if left_x == 0.0 or left_y == 0.0:
        return 0.0, 0.0
    closing = closing_speed(front, fc, rear, rc, pair, k, w_front, K, w_rear, n)
    made = closing * fc.dt  # depth that the last step's motion has made
    jump = (depth - pair.last_depth[q] - made) / pair.thickness
    deep, ambiguous = depth > MAX_SQUEEZE * pair.thickness, known <= 0.5
    if smooth and deep and ambiguous and ((not touches and not whole) or (whole and jump > MAX_DEPTH_JUMP)):
        return 0.0, 0.0  # it has come from a hole, a rim or another fold, edge on, and is on no side yet
    back = in_front_frame(pair, n)
    update_spring(pair, q, depth, made, math.inf if torn and touches and changed else jump, before, touches, lost, sure)
    pair.normal[0][q], pair.normal[1][q], pair.normal[2][q] = n
    pair.status[q], pair.last_depth[q], pair.depth_offset[q] = IN_CONTACT, depth, min(pair.depth_offset[q], depth)
    f, energy = spring_force(fc, pair, q, a, b, depth, closing, share_of_law(pair, twin, rc, e, A, B))
    if f > 0.0:
        grow_window(pair.front_window, i, j, 3)
        grow_window(pair.rear_window, I, J, 3)
        scatter_vector(pair.f_front, k, fc.row_stride, -f, back, w_front)
        scatter_vector(pair.f_rear, K, rc.row_stride, f, n, w_rear)
    return energy, depth
