"""Contact of neighbouring plies: penalty between two smooth surfaces.

Surfaces. Those of `plies.surface_kernels`: splines, and facets where yarns have failed.

Gap. Each element of the front ply, which the projectile meets first, carries p x p points x of its surface. y is the
foot of x on the rear ply's surface and n the normal there, the way that the shot flies:

    depth = t - n.(y - x),      f = max(0, k depth + c n.(v_x - v_y))   where depth > 0

with t the mean thickness of the two plies: thickness lies on both sides of a middle surface, so that curved plies that
nest keep t along their normals. -f n acts on the nodes of the front ply by their weights in x, f n on those of the rear
ply by their weights in y: the sum is zero to the last digits. Whole cloth that came through, where depth > t, would
still be pushed back, and the harder; it is counted, and ends the run. Beside torn cloth, where folds are found deep and
pressed on, what springs cannot hold is stopped before that (`plies.torn_contact_kernels`).

Sides. Contact does not ask which way a normal points, but on which side of the cloth a point is: what comes near is on
its own side, and stays there. Cloth that is drawn in until an element lies upside down has a normal that turns over
within a step: a point 0.006 t deep was found 1.99 t deep, and thrown. So n points away from x as long as x cannot have
come through, which takes a depth close to t in the step before, or a yarn that has just failed, or a foot that goes
over from facets to the spline or back: the one surface is on the other side of x in a bend. Then n goes on from that of
the step before. In folds, on rims and where cloth is drawn to a line the normal says nothing of x - y, and n is its
direction.

The foot follows from step to step by one step of Gauss and Newton; of a point that touches by one of Newton, from where
the foot will be if it goes on as it did in the last step. From where it was, n is that of a step ago: a hundredth of an
element, but always to the same side. Plies that slide on each other over a bend were pulled along by that, and contact
gave several per cent of a shot's energy. Where the plies are further apart than half their thickness the foot is the
point straight ahead of x, which is never ambiguous.

Failed yarns. What is left of a yarn pushes as the whole: its mass is the same. Nothing pushes where both yarns next to
x or y are gone: that is a hole, and a point may go through it. What comes out of a hole is on either side, and pushes
from there. Found in the very middle, edge on, it is on no side yet. So is what comes round the rim of a free panel, and
what another fold is in the middle of: through the face of cloth it comes by motion, and only what does so from a side
that it had is counted as having come through.

Springs. A spring is squeezed by motion alone. To first order the depth grows by n.(v_x - v_y) dt in a step, on any
smooth surface. Where it has changed by something else, more than JUMP thicknesses, the foot is on another fold, the
normal has turned over, or the surface is another since a yarn has failed: the rest of the depth loads no spring. It
goes on as it was, with the energy that it had, from the new depth; one that has just begun has nothing but what the
motion has made. It is as much stiffer as the rest of the thickness is less, three times at most. What is found so,
inside the thickness, is let no deeper. A point whose foot leaps, as in folds of whole cloth, is let go until it has one
again, and goes on likewise. With springs of their new depths such points gave 1 to 3 % of the energy of random shots
each, and a shot was ended for it.

Beside torn cloth feet get lost, so they are looked for anew, and elements are as long as the holes, so both plies have
points there (`contact_forces_back`), with half the stiffness each: the middle of an element behind otherwise goes
through what hangs before it, between the points of that. Those behind begin without load, wherever they are found.

Naive forms, for comparison: the nodes of the front ply against the bilinear facets of the rear one (FACETS), or against
the node there, along z (NODES).

Which points are looked at. Plies that are deflected by less than a quarter of the gap between them cannot touch: there
is a box about those nodes of each ply that are deflected by more, three elements wider, renewed every eight steps, in
which a transverse wave comes less than an element further. A point that is clear of the other ply is left alone for as
long as it would need to get there at one and a half times the highest speeds of both plies. The others are looked at
eight at once where nothing is the matter with them (`plies.contact_simd_kernels`).

Work. What a step's contact takes from the motion is summed over the nodes: half a step's work of the old forces, half a
step's of the new, on the same velocities. So it balances to the last digits, whatever the weights.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    fabs,
    fma,
    greater,
    head_mask,
    load,
    masked_store,
    maximum,
    movemask,
    reduce_add,
    reduce_max,
    where,
)
from shellfabric.panel.step_kernels import FAILURES
from shellfabric.plies.contact_simd_kernels import (
    AMBIGUOUS_DEPTH,
    CLEAR,
    CP_JUMP,
    IN_CONTACT,
    LOST,
    MAX_COMPRESSION,
    MAX_CP_STEP,
    MAX_DEPTH,
    MAX_DEPTH_JUMP,
    MAX_DEPTH_POINT,
    MAX_STEPS_SKIPPED,
    MAX_STIFFNESS_FACTOR,
    PASSED_COUNT,
    PASSED_POINT,
    PASSED_STEP,
    SPRING,
    WORK,
    contact_points8,
    extend_window,
    penalty_force,
)
from shellfabric.plies.graded_kernels import (
    add_line_offset,
    add_middle_offset,
    add_weighted_offset,
    place_in_elements,
    scaled_by_area,
)
from shellfabric.plies.surface_kernels import (
    FACETS,
    NODES,
    SMOOTH,
    element_mean,
    form_weights,
    intact_about,
    intact_fraction_at,
    interpolate,
    scatter_to_element,
    scatter_weighted,
    search_closest_point,
    second_derivatives,
    surface_patch,
)

_SCAN_INTERVAL, _MARGIN = 8, 3  # steps between scans, elements about what they find
_SPEED_MARGIN = 1.5  # than at the last scan nodes may become
_TORN_NEIGHBOURS = 3  # elements about torn ones that count as beside them


@kernel(_nrt=False)
def scan_deflections(state, const, least, box):
    """Widen the box (first and last row, and column, of nodes) to all that are deflected by more than `least`.

    Returns the highest speed of a node.
    """
    s, fastest = const.row_stride, broadcast(0.0)
    for i in range(const.ni + 1):
        for j in range(0, s, WIDTH):
            k, own = i * s + j, head_mask(s - j)
            v_x, v_y, v_z = load(state.v[0], k), load(state.v[1], k), load(state.v[2], k)
            fastest = maximum(fastest, where(own, v_x * v_x + v_y * v_y + v_z * v_z, 0.0))
            if box[0] <= i <= box[1] and box[2] <= j and j + WIDTH <= box[3] + 1:
                continue
            beyond = movemask(own) & movemask(greater(fabs(load(state.u[2], k)), least))
            for m in range(WIDTH if beyond != 0 else 0):
                if (beyond >> m) & 1:
                    box[0], box[1] = min(box[0], i), max(box[1], i)
                    box[2], box[3] = min(box[2], j + m), max(box[3], j + m)
    return math.sqrt(reduce_max(fastest))


@kernel(_nrt=False, forceinline=True)
def half_step_work(state, const, force, touched, over):
    """Half a step's work of the nodal forces on the present velocities, which are those of half a step ago; takes them
    away where they are `over`."""
    work, none = broadcast(0.0), broadcast(0.0)
    for i in range(touched[0], touched[1]):
        for j in range(touched[2], touched[3], WIDTH):
            k, inside = i * const.row_stride + j, head_mask(touched[3] - j)
            power = load(force[0], k) * load(state.v[0], k)
            power = fma(load(force[1], k), load(state.v[1], k), power)
            power = fma(load(force[2], k), load(state.v[2], k), power)
            work = work + where(inside, power, 0.0)
            if over:
                masked_store(force[0], k, none, touched[3] - j)
                masked_store(force[1], k, none, touched[3] - j)
                masked_store(force[2], k, none, touched[3] - j)
    if over:
        touched[0], touched[1], touched[2], touched[3] = const.ni + 1, 0, const.row_stride, 0
    return 0.5 * const.dt * reduce_add(work)


@kernel(_nrt=False, forceinline=True)
def grow_window(touched, i, j, n):
    """Widen the window of nodes with forces by n by n nodes."""
    extend_window(touched, i, i + n, j, j + n)


@kernel(_nrt=False)
def apply_symmetry(const, force, touched):
    """Nodes on a plane of symmetry keep to it."""
    if const.mirror_x and touched[0] == 0:
        for k in range(touched[2], touched[3]):
            force[0][k] = 0.0
    if const.mirror_y and touched[2] == 0:
        for i in range(touched[0], touched[1]):
            force[1][i * const.row_stride] = 0.0


@kernel(_nrt=False, forceinline=True)
def row_of_node(fc, rc, i):
    """Element row of the front ply in which row i of nodes of the rear ply is at rest."""
    x = add_line_offset(rc.x0 + i * rc.dx, rc.line_offset1, i) - fc.x0
    return int(place_in_elements(x, fc.dx, fc.line_offset1, fc.ni))


@kernel(_nrt=False, forceinline=True)
def column_of_node(fc, rc, j):
    """Element column of the front ply in which column j of nodes of the rear ply is at rest."""
    y = add_line_offset(rc.y0 + j * rc.dy, rc.line_offset2, j) - fc.y0
    return int(place_in_elements(y, fc.dy, fc.line_offset2, fc.nj))


@kernel(_nrt=False, forceinline=True)
def element_of_middle(fc, rc, i, j):
    """Element (row, column) of the front ply in which the middle of element (i, j) of the rear ply is at rest."""
    x = add_middle_offset(rc.x0 + (i + 0.5) * rc.dx, rc.line_offset1, i) - fc.x0
    y = add_middle_offset(rc.y0 + (j + 0.5) * rc.dy, rc.line_offset2, j) - fc.y0
    row, column = (
        place_in_elements(x, fc.dx, fc.line_offset1, fc.ni),
        place_in_elements(y, fc.dy, fc.line_offset2, fc.nj),
    )
    return int(row), int(column)


@kernel(_nrt=False, forceinline=True)
def candidate_window(pair, fc, rc):
    """Element rows and columns of the front ply where either ply's deflection can bring them into contact."""
    i0, i1, j0, j1 = pair.front_box[0], pair.front_box[1], pair.front_box[2], pair.front_box[3]
    if pair.rear_box[0] <= pair.rear_box[1]:
        i0 = min(i0, row_of_node(fc, rc, pair.rear_box[0]))
        i1 = max(i1, row_of_node(fc, rc, pair.rear_box[1]) + 1)
        j0 = min(j0, column_of_node(fc, rc, pair.rear_box[2]))
        j1 = max(j1, column_of_node(fc, rc, pair.rear_box[3]) + 1)
    return max(i0 - _MARGIN, 0), min(i1 + _MARGIN, fc.ni), max(j0 - _MARGIN, 0), min(j1 + _MARGIN, fc.nj)


@kernel(_nrt=False, forceinline=True)
def contact_forces(front, fc, rear, rc, pair, step):
    """Forces between two plies at their present positions, into pair.f_front and pair.f_rear."""
    if step % _SCAN_INTERVAL == 0:
        pair.max_speed[0] = scan_deflections(front, fc, pair.min_deflection, pair.front_box)
        pair.max_speed[1] = scan_deflections(rear, rc, pair.min_deflection, pair.rear_box)
    mark_torn(front, fc, rear, rc, pair)
    taken = -half_step_work(front, fc, pair.f_front, pair.front_window, True)
    taken -= half_step_work(rear, rc, pair.f_rear, pair.rear_window, True)
    i0, i1, j0, j1 = candidate_window(pair, fc, rc)
    p, spring, now, often = pair.points_per_side, 0.0, float(step), step % _SCAN_INTERVAL == 0
    shot = math.sqrt(
        front.projectile_velocity[0] ** 2 + front.projectile_velocity[1] ** 2 + front.projectile_velocity[2] ** 2
    )
    nearer = _SPEED_MARGIN * fc.dt * (max(pair.max_speed[0], shot) + max(pair.max_speed[1], shot))
    for i in range(i0, i1):
        start, end = (i * fc.nj + j0) * p * p, (i * fc.nj + j1) * p * p
        for q0 in range(start, end, WIDTH):
            count = min(WIDTH, end - q0)
            due = movemask(head_mask(count)) & ~movemask(greater(load(pair.recheck_step, q0), now))
            if due != 0 and p == 1 and pair.surface_form == SMOOTH:
                due, energy = contact_points8(front, fc, rear, rc, pair, q0, i, q0 - i * fc.nj, count, nearer, now, due)
                spring += energy
            if due == 0:
                continue
            for q in range(q0, q0 + count):
                if (due >> (q - q0)) & 1 == 0:
                    continue
                j, m = q // (p * p) - i * fc.nj, q % (p * p)
                a, b = i + (m // p + pair.point_offset) / p, j + (m % p + pair.point_offset) / p
                energy, depth = contact_point(front, fc, rear, rc, pair, q, a, b, often)
                if depth < 0.0:
                    pair.recheck_step[q] = now + 1.0 + steps_until_contact(depth, nearer)
                spring += energy
                if depth > pair.energy[MAX_DEPTH]:
                    pair.energy[MAX_DEPTH], pair.energy[MAX_DEPTH_POINT] = depth, q
    apply_symmetry(fc, pair.f_front, pair.front_window)
    apply_symmetry(rc, pair.f_rear, pair.rear_window)
    taken -= half_step_work(front, fc, pair.f_front, pair.front_window, False)
    taken -= half_step_work(rear, rc, pair.f_rear, pair.rear_window, False)
    book_energies(pair, taken, spring, step)


@kernel(_nrt=False, forceinline=True)
def contact_forces_back(front, fc, rear, rc, pair, step):
    """As `contact_forces`, for the points beside torn cloth of a ply that lies behind, on the one before it."""
    mark_torn(front, fc, rear, rc, pair)
    if pair.torn_counts[1] == 0:
        return
    taken = -half_step_work(front, fc, pair.f_front, pair.front_window, True)
    taken -= half_step_work(rear, rc, pair.f_rear, pair.rear_window, True)
    p, spring, often = pair.points_per_side, 0.0, step % _SCAN_INTERVAL == 0
    for e in pair.torn_elements[: pair.torn_counts[1]]:
        for m in range(p * p):
            a, b = e // fc.nj + (m // p + pair.point_offset) / p, e % fc.nj + (m % p + pair.point_offset) / p
            energy, depth = contact_point(front, fc, rear, rc, pair, e * p * p + m, a, b, often)
            spring += energy
            if depth > pair.energy[MAX_DEPTH]:
                pair.energy[MAX_DEPTH], pair.energy[MAX_DEPTH_POINT] = depth, e * p * p + m
    apply_symmetry(fc, pair.f_front, pair.front_window)
    apply_symmetry(rc, pair.f_rear, pair.rear_window)
    taken -= half_step_work(front, fc, pair.f_front, pair.front_window, False)
    taken -= half_step_work(rear, rc, pair.f_rear, pair.rear_window, False)
    book_energies(pair, taken, spring, step)


@kernel(_nrt=False)
def book_energies(pair, taken, spring, step):
    """Book the energies of a step, and when the first point went through."""
    pair.energy[WORK] += taken
    pair.energy[SPRING] = spring
    if pair.energy[PASSED_COUNT] > 0.0 and pair.energy[PASSED_STEP] == 0.0:
        pair.energy[PASSED_STEP] = step


@kernel(_nrt=False, forceinline=True)
def mark_torn(front, fc, rear, rc, pair):
    """Note, when more yarns have failed, the elements of the front ply that are next to torn ones of either ply."""
    failures = front.counter[FAILURES] + rear.counter[FAILURES]
    pair.torn_counts[2] = failures - pair.torn_counts[0]
    if pair.torn_counts[2] != 0:
        pair.torn_counts[0] = failures
        list_torn_elements(front, fc, rear, rc, pair)


@kernel(_nrt=False)
def list_torn_elements(front, fc, rear, rc, pair):
    """The elements of the front ply that are next to torn ones of either ply, into pair.near_torn and
    pair.torn_elements."""
    pair.torn_counts[1] = 0
    pair.near_torn[:] = 0
    for i in range(fc.ni):
        for j in range(fc.nj):
            if front.element_flag[i * fc.row_stride + j]:
                mark_neighbours(fc, pair, i, j)
    for i in range(rc.ni):
        for j in range(rc.nj):
            if rear.element_flag[i * rc.row_stride + j]:
                m, n = element_of_middle(fc, rc, i, j)
                mark_neighbours(fc, pair, m, n)
    for e in range(fc.ni * fc.nj):
        if pair.near_torn[e]:
            pair.torn_elements[pair.torn_counts[1]] = e
            pair.torn_counts[1] += 1


@kernel(_nrt=False)
def mark_neighbours(const, pair, i, j):
    """Note the elements about (i, j)."""
    for m in range(max(i - _TORN_NEIGHBOURS, 0), min(i + _TORN_NEIGHBOURS + 1, const.ni)):
        for n in range(max(j - _TORN_NEIGHBOURS, 0), min(j + _TORN_NEIGHBOURS + 1, const.nj)):
            pair.near_torn[m * const.nj + n] = 1


@kernel(_nrt=False, forceinline=True)
def steps_until_contact(depth, nearer):
    """Steps that a point which is clear by -depth [m] can be left alone, where it comes nearer by `nearer` in each."""
    return float(MAX_STEPS_SKIPPED) if -depth > MAX_STEPS_SKIPPED * nearer else math.floor(-depth / nearer)


@kernel(_nrt=False, forceinline=True)
def contact_point(front, fc, rear, rc, pair, q, a, b, often):
    """Follow the foot of the front ply's point at (a, b), and let it push: (energy in its spring, depth).

    The depth is negative where the point is clear of the rear ply, and 0 where it cannot push. often : whether a foot
    beside torn cloth is to be looked for anew, if it has been followed well or not
    """
    # the spline goes through the middles of the elements
    central = pair.points_per_side == 1 and pair.surface_form == SMOOTH
    if central:
        i, j, p0, p1, p2, p1x, q0, q1, q2, q1y = int(a), int(b), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        k = np.uint64(i * fc.row_stride + j)
        x, y, z = (
            element_mean(front.u[0], k, fc.row_stride),
            element_mean(front.u[1], k, fc.row_stride),
            element_mean(front.u[2], k, fc.row_stride),
        )
        x, y = add_middle_offset(x, fc.line_offset1, i), add_middle_offset(y, fc.line_offset2, j)
    else:
        form_x = pair.surface_form if pair.surface_form != SMOOTH or intact_about(front, fc, a, b) else FACETS
        i, p0, p1, p2, _, _, _, p1x, _ = form_weights(form_x, a, fc.ni, fc.mirror_x)
        j, q0, q1, q2, _, _, _, q1y, _ = form_weights(form_x, b, fc.nj, fc.mirror_y)
        k = np.uint64(i * fc.row_stride + j)
        x = interpolate(front.u[0], k, fc.row_stride, p0, p1x, p2, q0, q1, q2)
        y = interpolate(front.u[1], k, fc.row_stride, p0, p1, p2, q0, q1y, q2)
        z = interpolate(front.u[2], k, fc.row_stride, p0, p1, p2, q0, q1, q2)
        x = add_weighted_offset(x, fc.line_offset1, i, p0, p1x, p2)
        y = add_weighted_offset(y, fc.line_offset2, j, q0, q1y, q2)
    x, y = x + fc.x0 + a * fc.dx, y + fc.y0 + b * fc.dy
    at_x, at_y, at_z = x - rc.x0, y - rc.y0, z - pair.rest_distance  # from the first node of the rear ply at rest
    low = -0.5 if pair.surface_form == SMOOTH else 0.0
    low_a, low_b = low if rc.mirror_x else 0.0, low if rc.mirror_y else 0.0
    before_a, before_b = pair.closest_point[0][q], pair.closest_point[1][q]
    A = min(max(before_a + pair.cp_rate[0][q], low_a), float(rc.ni))
    B = min(max(before_b + pair.cp_rate[1][q], low_b), float(rc.nj))
    whole = pair.surface_form != SMOOTH or intact_about(rear, rc, A, B)
    form = pair.surface_form if whole else FACETS
    I, w0, w1, w2, d0, d1, d2, w1x, d1x = form_weights(form, A, rc.ni, rc.mirror_x)
    J, v0, v1, v2, e0, e1, e2, v1y, e1y = form_weights(form, B, rc.nj, rc.mirror_y)
    K = np.uint64(I * rc.row_stride + J)
    X, Xa, Xb = surface_patch(rear.u[0], K, rc.row_stride, (w0, w1x, w2), (v0, v1, v2), (d0, d1x, d2), (e0, e1, e2))
    Y, Ya, Yb = surface_patch(rear.u[1], K, rc.row_stride, (w0, w1, w2), (v0, v1y, v2), (d0, d1, d2), (e0, e1y, e2))
    Z, Za, Zb = surface_patch(rear.u[2], K, rc.row_stride, (w0, w1, w2), (v0, v1, v2), (d0, d1, d2), (e0, e1, e2))
    X = add_weighted_offset(X, rc.line_offset1, I, w0, w1x, w2)
    Y = add_weighted_offset(Y, rc.line_offset2, J, v0, v1y, v2)
    Xa = add_weighted_offset(Xa, rc.line_offset1, I, d0, d1x, d2) + rc.dx
    Yb = add_weighted_offset(Yb, rc.line_offset2, J, e0, e1y, e2) + rc.dy
    x, y, z = at_x - X - A * rc.dx, at_y - Y - B * rc.dy, at_z - Z  # from the foot
    n_x, n_y, n_z = Ya * Zb - Za * Yb, Za * Xb - Xa * Zb, Xa * Yb - Ya * Xb
    size = math.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    tiny = 1e-6 * rc.dx * rc.dy
    if size < tiny:  # cloth that is drawn to a line has no normal
        n_x, n_y, n_z, size = pair.normal[0][q], pair.normal[1][q], pair.normal[2][q], 1.0
    n_x, n_y, n_z = n_x / size, n_y / size, n_z / size
    size = max(size, tiny)
    touches = pair.status[q] == IN_CONTACT
    along, far, slant = n_x * x + n_y * y + n_z * z, math.sqrt(x * x + y * y + z * z), False
    turned, known = along > 0.0, 0.0  # what comes near does so on its own side
    # so deep that it may come through, or has; or the surface has just changed from spline to facets, or back
    other, pair.on_facet[q] = pair.torn_counts[2] != 0 or (pair.on_facet[q] == 0) != whole, 0 if whole else 1
    if touches and (pair.last_depth[q] > (1.0 - AMBIGUOUS_DEPTH) * pair.thickness or other):
        known = n_x * pair.normal[0][q] + n_y * pair.normal[1][q] + n_z * pair.normal[2][q]
        turned = known < 0.0 if abs(known) > 0.5 else turned
    if turned and pair.surface_form == SMOOTH:
        n_x, n_y, n_z, along = -n_x, -n_y, -n_z, -along
    depth = pair.thickness + along
    near = depth > -0.5 * pair.thickness
    if pair.surface_form == SMOOTH and abs(known) <= 0.5 and far > 0.3 * pair.thickness and along > -0.7 * far:
        # a fold, a rim or cloth drawn to a line, whose normal says nothing of where the point is
        n_x, n_y, n_z, depth, slant = -x / far, -y / far, -z / far, pair.thickness - far, True
    if near:
        aa, ab, bb = Xa * Xa + Ya * Ya + Za * Za, Xa * Xb + Ya * Yb + Za * Zb, Xb * Xb + Yb * Yb + Zb * Zb
        ra, rb = Xa * x + Ya * y + Za * z, Xb * x + Yb * y + Zb * z
        go, turn, sure = (bb * ra - ab * rb) / (size * size), (aa * rb - ab * ra) / (size * size), False
        if depth > 0.0:
            c0, c1, c2, c1x = second_derivatives(form, A, rc.ni, rc.mirror_x)
            g0, g1, g2, g1y = second_derivatives(form, B, rc.nj, rc.mirror_y)
            F = rear.u
            Xaa = interpolate(F[0], K, rc.row_stride, c0, c1x, c2, v0, v1, v2)
            Ybb = interpolate(F[1], K, rc.row_stride, w0, w1, w2, g0, g1y, g2)
            aa -= x * add_weighted_offset(Xaa, rc.line_offset1, I, c0, c1x, c2)
            aa -= y * interpolate(F[1], K, rc.row_stride, c0, c1, c2, v0, v1y, v2) + z * interpolate(
                F[2], K, rc.row_stride, c0, c1, c2, v0, v1, v2
            )
            ab -= x * interpolate(F[0], K, rc.row_stride, d0, d1x, d2, e0, e1, e2)
            ab -= y * interpolate(F[1], K, rc.row_stride, d0, d1, d2, e0, e1y, e2) + z * interpolate(
                F[2], K, rc.row_stride, d0, d1, d2, e0, e1, e2
            )
            bb -= x * interpolate(F[0], K, rc.row_stride, w0, w1x, w2, g0, g1, g2)
            bb -= y * add_weighted_offset(Ybb, rc.line_offset2, J, g0, g1y, g2) + z * interpolate(
                F[2], K, rc.row_stride, w0, w1, w2, g0, g1, g2
            )
            det = aa * bb - ab * ab
            if det > 0.1 * size * size and aa > 0.0:
                go, turn, sure = (bb * ra - ab * rb) / det, (aa * rb - ab * ra) / det, True
    else:
        # of cloth that stands on end nothing is straight ahead
        area = max(Xa * Yb - Xb * Ya, 0.01 * rc.dx * rc.dy)
        go, turn, sure = (Yb * x - Xb * y) / area, (Xa * y - Ya * x) / area, False
    A2, B2 = A + min(max(go, -MAX_CP_STEP), MAX_CP_STEP), B + min(max(turn, -MAX_CP_STEP), MAX_CP_STEP)
    pair.closest_point[0][q] = min(max(A2, low_a), float(rc.ni))
    pair.closest_point[1][q] = min(max(B2, low_b), float(rc.nj))
    pair.cp_rate[0][q] = pair.cp_rate[1][q] = 0.0
    lost, leapt = pair.status[q] == LOST, depth > 0.0 and max(abs(go), abs(turn)) > CP_JUMP
    if not (touches or lost):
        pair.last_depth[q] = pair.depth_offset[q] = 0.0
    pair.status[q] = LOST if leapt or (slant and (touches or lost)) else CLEAR
    torn = pair.near_torn[q // (pair.points_per_side * pair.points_per_side)] != 0
    if pair.surface_form == SMOOTH and (leapt or (torn and (often or not (whole or touches)))):
        search_closest_point(rear, rc, pair.closest_point, q, at_x, at_y, at_z, far)
    if depth <= 0.0:
        return 0.0, 0.0 if torn or slant else depth
    beside_x, beside_y = A2 > rc.ni or (A2 < 0.0 and not rc.mirror_x), B2 > rc.nj or (B2 < 0.0 and not rc.mirror_y)
    if beside_x or beside_y or (leapt and pair.surface_form != NODES):
        return 0.0, 0.0
    left_x, left_y = intact_fraction_at(front, fc, a, b), intact_fraction_at(rear, rc, A, B)
    if left_x == 0.0 or left_y == 0.0:
        return 0.0, 0.0
    smooth = pair.surface_form == SMOOTH
    v_x = -interpolate(rear.v[0], K, rc.row_stride, w0, w1x, w2, v0, v1, v2)
    v_y = -interpolate(rear.v[1], K, rc.row_stride, w0, w1, w2, v0, v1y, v2)
    v_z = -interpolate(rear.v[2], K, rc.row_stride, w0, w1, w2, v0, v1, v2)
    if central:
        v_x, v_y, v_z = (
            v_x + element_mean(front.v[0], k, fc.row_stride),
            v_y + element_mean(front.v[1], k, fc.row_stride),
            v_z + element_mean(front.v[2], k, fc.row_stride),
        )
    else:
        v_x += interpolate(front.v[0], k, fc.row_stride, p0, p1x, p2, q0, q1, q2)
        v_y += interpolate(front.v[1], k, fc.row_stride, p0, p1, p2, q0, q1y, q2)
        v_z += interpolate(front.v[2], k, fc.row_stride, p0, p1, p2, q0, q1, q2)
    closing = n_x * v_x + n_y * v_y + n_z * v_z
    # depth that the last step's motion has made
    made, deep = closing * fc.dt, depth > (1.0 - AMBIGUOUS_DEPTH) * pair.thickness
    jump = (depth - pair.last_depth[q] - made) / pair.thickness
    if smooth and deep and abs(known) <= 0.5 and ((not touches and not whole) or (whole and jump > MAX_DEPTH_JUMP)):
        return 0.0, 0.0  # it has come from a hole, a rim or another fold, edge on, and is on no side yet
    # by motion, from a side that it had
    moved = jump <= MAX_DEPTH_JUMP and pair.depth_offset[q] <= (1.0 - AMBIGUOUS_DEPTH) * pair.thickness
    if touches and smooth and whole and depth > pair.thickness and left_x == 1.0 and left_y == 1.0 and moved:
        pair.energy[PASSED_COUNT], pair.energy[PASSED_POINT] = pair.energy[PASSED_COUNT] + 1.0, q
    if smooth and (lost or abs(jump) > MAX_DEPTH_JUMP):
        kept = max(pair.last_depth[q] - pair.depth_offset[q] + (0.0 if lost else made), 0.0)
        softer = stiffness_factor(pair, pair.depth_offset[q]) / stiffness_factor(pair, max(depth - kept, 0.0))
        pair.depth_offset[q] = max(depth - kept * math.sqrt(softer), 0.0)
    elif not touches:
        pair.depth_offset[q] = depth if depth > 0.5 * pair.thickness and pair.surface_form == FACETS else 0.0
    elif sure:
        pair.cp_rate[0][q] = min(max(pair.closest_point[0][q] - before_a, -MAX_CP_STEP), MAX_CP_STEP)
        pair.cp_rate[1][q] = min(max(pair.closest_point[1][q] - before_b, -MAX_CP_STEP), MAX_CP_STEP)
    pair.status[q] = IN_CONTACT
    pair.normal[0][q], pair.normal[1][q], pair.normal[2][q] = n_x, n_y, n_z
    pair.last_depth[q], pair.depth_offset[q] = depth, min(pair.depth_offset[q], depth)
    squeezed, part = depth - pair.depth_offset[q], 0.5 if torn else 1.0
    pair.energy[MAX_COMPRESSION] = max(pair.energy[MAX_COMPRESSION], squeezed)
    if pair.point_offset == 0.0:  # half an element, or a quarter, is modelled about points on planes of symmetry
        part *= (0.5 if a == 0.0 and fc.mirror_x else 1.0) * (0.5 if b == 0.0 and fc.mirror_y else 1.0)
    part = scaled_by_area(part, pair.area_factor1, pair.area_factor2, int(a), int(b))
    drag = part * pair.damping
    part *= stiffness_factor(pair, pair.depth_offset[q])
    f = max(0.0, penalty_force(pair, part, squeezed, drag, closing))
    if f > 0.0:
        grow_window(pair.front_window, i, j, 2 if central else 3)
        grow_window(pair.rear_window, I, J, 3)
        F = pair.f_front
        if central:
            scatter_to_element(F[0], k, fc.row_stride, -f * n_x)
            scatter_to_element(F[1], k, fc.row_stride, -f * n_y)
            scatter_to_element(F[2], k, fc.row_stride, -f * n_z)
        else:
            scatter_weighted(F[0], k, fc.row_stride, -f * n_x, p0, p1x, p2, q0, q1, q2)
            scatter_weighted(F[1], k, fc.row_stride, -f * n_y, p0, p1, p2, q0, q1y, q2)
            scatter_weighted(F[2], k, fc.row_stride, -f * n_z, p0, p1, p2, q0, q1, q2)
        F = pair.f_rear
        scatter_weighted(F[0], K, rc.row_stride, f * n_x, w0, w1x, w2, v0, v1, v2)
        scatter_weighted(F[1], K, rc.row_stride, f * n_y, w0, w1, w2, v0, v1y, v2)
        scatter_weighted(F[2], K, rc.row_stride, f * n_z, w0, w1, w2, v0, v1, v2)
    return 0.5 * part * pair.stiffness * squeezed * squeezed, depth


@kernel(_nrt=False, forceinline=True)
def stiffness_factor(pair, slack):
    """By how much a spring that begins at the depth `slack` is stiffer: what is left of the thickness has to hold as
    much."""
    return (
        min(MAX_STIFFNESS_FACTOR, pair.thickness / max(pair.thickness - slack, 0.1 * pair.thickness))
        if slack > 0.0
        else 1.0
    )


@kernel(_nrt=False)
def apply_impulses(state, const, force, touched):
    """Give a ply the impulses of a neighbour's forces; widens its window of rows to them."""
    if touched[1] <= touched[0]:
        return
    for i in range(touched[0], touched[1]):
        for j in range(touched[2], touched[3], WIDTH):
            k, count = i * const.row_stride + j, touched[3] - j
            kick = load(state.dt_over_mass, k)
            masked_store(state.v[0], k, fma(kick, load(force[0], k), load(state.v[0], k)), count)
            masked_store(state.v[1], k, fma(kick, load(force[1], k), load(state.v[1], k)), count)
            masked_store(state.v[2], k, fma(kick, load(force[2], k), load(state.v[2], k)), count)
    state.active_rows[0] = min(state.active_rows[0], max(touched[0] - 4, 0))
    state.active_rows[1] = max(state.active_rows[1], min(touched[1] + 3, const.ni))
