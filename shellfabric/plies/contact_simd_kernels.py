"""Contact of plies, eight points at once: most calls of `plies.point_kernels.contact_point`.

Points with the same place in neighbouring elements are side by side, and so are their closest points, to within a node:
eight of them lie over four rows of four nodes each, that of the next a slot further. Each has its weights at three of
the four and none at the other, since closest points go over to the next segment of the spline one by one. The results
are those of one point at a time, to round-off. All that needs more than a formula is left to `contact_point`: torn
fabric, rims, planes of symmetry, folds, lost closest points, and what is so deep that it might have come through.
"""

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    broadcast,
    equal_bytes,
    fabs,
    floor,
    greater,
    head_mask,
    load,
    mask_from_bits,
    masked_store,
    maximum,
    minimum,
    movemask,
    reduce_add,
    reduce_max,
    sqrt,
    where,
)
from shellfabric.panel.motion_kernels import FAILURES
from shellfabric.plies.graded_kernels import (
    add_column_offset8,
    add_row_offset8,
    add_weighted_offset,
    scaled_by_area8,
)
from shellfabric.plies.law_kernels import law_at8
from shellfabric.plies.normal_force_kernels import store_normal_force8
from shellfabric.plies.surface_kernels import (
    intact_about,
    interpolate8,
    point_mean8,
    point_place,
    scatter_to_points8,
    scatter_weighted8,
    second_derivatives8,
    spline_weights8,
    surface_patch8,
)

# of pair.energy; WORK is of all contact forces, friction included
WORK, SPRING, MAX_DEPTH, MAX_COMPRESSION, FRICTION_WORK = range(5)
# of pair.status; a point whose foot leaps or lies aside is lost until it has one again
CLEAR, IN_CONTACT, LOST = 0, 1, 2
# [thicknesses] by which plies may come nearer than at the first touch; deeper, the side that a point is on is in doubt
MAX_SQUEEZE = 0.85
# [thicknesses] that a depth may change beside the motion: sliding by a tenth of an element over a bend as narrow as an
# element makes a few hundredths (second order), another fold or side several tenths
MAX_DEPTH_JUMP = 0.1
MAX_CP_STEP, CP_JUMP = 0.25, 0.2  # [elements] longest step of a closest point; a longer one is no solution
MAX_STEPS_SKIPPED = 8  # most steps for which a point is skipped


@kernel(_nrt=False, forceinline=True)
def contact_points8(front, fc, rear, rc, pair, q, count, nearer, now, due):
    """`contact_point` for those of the points q .. q + count - 1, with one place in elements side by side, that
    need no special case, eight at once: whole fabric on whole fabric, closest points side by side and away from rims
    and planes of symmetry, not lost, in no fold, not so deep that it might come through, and not deeper at once than
    motion may have made it.

    due : points to be looked at, as bits. Returns (those left for `contact_point`, spring energy of the others).
    """
    (i, j, m, n), w_front, start = front_weights8(fc, pair, q)
    k, own = i * fc.row_stride + j, inner_points8(fc, pair, m, n, count)
    held = own & movemask(equal_bytes(pair.status, q, IN_CONTACT))
    fit = (own & movemask(equal_bytes(pair.status, q, CLEAR)) | held) & movemask(equal_bytes(front.element_flag, k, 0))
    A = load(pair.closest_point[0], q) + load(pair.cp_rate[0], q)
    B = load(pair.closest_point[1], q) + load(pair.cp_rate[1], q)
    rank, fit = load(pair.lane_index, 0), intact8(rear, rc, pair, q, i * fc.nj + j, count, fit)
    I, J = floor(minimum(maximum(A + 0.5, 1.0), rc.ni - 1.0)), floor(minimum(maximum(B + 0.5, 1.0), rc.nj - 1.0))
    r, t = A - I, B - J
    fit &= ~movemask(greater(maximum(fabs(r), fabs(t)), 0.5))
    chosen = mask_from_bits(fit)
    I0, J0 = -reduce_max(where(chosen, 0.0 - I, -1e9)), -reduce_max(where(chosen, rank - J, -1e9))
    slot = (I0 - 1.0) * rc.row_stride + (J0 - 1.0)
    if fit == 0 or slot < 0.0:
        return due, 0.0
    K = int(slot)
    I, J = I - I0, J - rank - J0  # from the first of all nodes
    fit &= ~movemask(greater(maximum(I, J), 1.5))
    tall = any_lane(greater(where(mask_from_bits(fit), I, 0.0), 0.5))
    (wa, da, ca), (wb, db, cb) = spline_weights8(r, greater(I, 0.5)), spline_weights8(t, greater(J, 0.5))
    row, column = int(I0) - 1, int(J0) - 1
    values, slopes, curves = (wa, wb), (da, db), (ca, cb)
    off, tangents = offsets8(
        front, fc, rear, rc, pair, (m, n, row, column), (start, w_front), (A, B), rank, (K, values, slopes, tall)
    )  # fmt: skip
    (x, y, z), ((Xa, Ya, Za), (Xb, Yb, Zb)) = off, tangents
    n_x, n_y, n_z = Ya * Zb - Za * Yb, Za * Xb - Xa * Zb, Xa * Yb - Ya * Xb
    square, tiny, thick = n_x * n_x + n_y * n_y + n_z * n_z, 1e-6 * rc.dx * rc.dy, pair.thickness
    size = sqrt(square)
    along, far = (n_x * x + n_y * y + n_z * z) / size, x * x + y * y + z * z
    depth = thick + along
    slant = movemask(greater(far, 0.09 * thick * thick)) & movemask(greater(0.49 * far, along * along))
    fit &= movemask(greater(square, tiny * tiny))
    clear, inside, pressed = by_depth8(pair, q, fit, held, slant, depth, nearer)
    near, weights = greater(depth, -0.5 * thick), (values, slopes, curves)
    go, turn, sure, pressed = closest_point_step8(
        rear, rc, K, (row, column), weights, off, tangents, square, near, pressed, tall
    )
    done = clear | pressed
    recheck_later8(pair, q, count, (clear, inside), depth, nearer, now)
    changed = pressed | (held & clear) != 0
    move_closest_points8(rc, pair, q, count, (A, B), (go, turn), done, pressed & held & sure, changed)
    for lane in range(count if changed else 0):
        if (done >> lane) & 1:
            pair.status[q + lane], pair.on_facet[q + lane] = IN_CONTACT if (pressed >> lane) & 1 else CLEAR, 0
    energy = 0.0
    if pressed != 0:
        normal, at = (n_x / size, n_y / size, n_z / size), (i, j, m, n, row, column)
        energy = apply_forces8(
            front, fc, rear, rc, pair, q, at, count, (pressed, held), depth, normal, (w_front, wa, wb, tall)
        )  # fmt: skip
    return (due & ~done) | (inside & ~pressed), energy


@kernel(_nrt=False, forceinline=True)
def inner_points8(fc, pair, m, n, count):
    """Those of eight points, as bits, whose three by three nodes lie within the front ply's edges, those of the first
    from node (m, n) on."""
    own = movemask(head_mask(count)) & movemask(greater(fc.nj - n - 1.5, load(pair.lane_index, 0)))
    own &= ~1 if n < 0 else -1
    return own if m >= 0 and m + 2 <= fc.ni and m * fc.row_stride + n >= 0 else own & 0


@kernel(_nrt=False, forceinline=True)
def recheck_later8(pair, q, count, bits, depth, nearer, now):
    """Set from which step on eight points are to be looked at: those that are (clear, inside), as bits."""
    clear, inside = bits
    later = now + 1.0 + minimum(floor(depth * (-1.0 / nearer)), float(MAX_STEPS_SKIPPED))
    now_or_before = where(mask_from_bits(inside), now, load(pair.recheck_step, q))
    masked_store(pair.recheck_step, q, where(mask_from_bits(clear), later, now_or_before), count)


@kernel(_nrt=False, forceinline=True)
def by_depth8(pair, q, fit, held, slant, depth, nearer):
    """Which of the points that are `fit`, as bits, are clear of the rear ply, inside it, and of these in a contact that
    needs no more than its formula: in no fold, not too deep, and without a jump of the depth, whatever part of it the
    motion has made, which is at most `nearer` [m]."""
    thick, was = pair.thickness, load(pair.last_depth, q)
    deep = movemask(greater(was, MAX_SQUEEZE * thick))
    slow = movemask(greater(MAX_DEPTH_JUMP * thick - nearer, fabs(depth - where(mask_from_bits(held), was, 0.0))))
    fit &= ~(held & (slant | deep))
    clear, inside = fit & movemask(greater(0.0, depth)), fit & movemask(greater(depth, 0.0))
    return clear, inside, inside & ~slant & movemask(greater(MAX_SQUEEZE * thick - nearer, depth)) & slow


@kernel(_nrt=False, forceinline=True)
def front_weights8(fc, pair, q):
    """Of eight points from number q on: ((i, j) element of the first, (m, n) first of the three by three nodes about
    it), weights of the nodes along a and b, (a, b) place of the first. The weights are alike for all eight."""
    e, a, b = point_place(fc, pair, q)
    i, j, m, n = e // fc.nj, e % fc.nj, int(a + 0.5) - 1, int(b + 0.5) - 1
    r, t = a - m - 1.0, b - n - 1.0
    wa = 0.5 * (0.5 - r) * (0.5 - r), 0.75 - r * r, 0.5 * (0.5 + r) * (0.5 + r), 0.0
    wb = 0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t), 0.0
    return (i, j, m, n), (wa, wb), (a, b)


@kernel(_nrt=False, forceinline=True)
def offsets8(front, fc, rear, rc, pair, at, place, foot, rank, patch):
    """Of eight points, the first of them at `place`: their offsets [m] from the points of the rear ply's surface at
    `foot`, and the tangents there [m].

    at : first nodes (row, column) of the front ply's points and of the rear ply's surface; place : (a, b) of the first
    point and weights of `front_weights8`; patch : slot of the first node, weights, their slopes, and `tall`
    """
    (m, n, row, column), ((a, b), (fa, fb)), (A, B), (K, (wa, wb), (da, db), tall) = at, place, foot, patch
    k = m * fc.row_stride + n
    X, Xa, Xb = surface_patch8(rear.u[0], K, rc.row_stride, wa, wb, da, db, tall)
    Y, Ya, Yb = surface_patch8(rear.u[1], K, rc.row_stride, wa, wb, da, db, tall)
    Z, Za, Zb = surface_patch8(rear.u[2], K, rc.row_stride, wa, wb, da, db, tall)
    X, Xa = add_row_offset8(X, rc.line_offset1, row, wa), add_row_offset8(Xa, rc.line_offset1, row, da)
    Y, Yb = add_column_offset8(Y, rc.line_offset2, column, wb), add_column_offset8(Yb, rc.line_offset2, column, db)
    at_x = add_weighted_offset(fc.x0 + a * fc.dx - rc.x0, fc.line_offset1, m, fa[0], fa[1], fa[2])
    x = point_mean8(front.u[0], k, fc.row_stride, fa, fb) - X - A * rc.dx + at_x
    y = point_mean8(front.u[1], k, fc.row_stride, fa, fb) - Y - B * rc.dy + (fc.y0 + b * fc.dy - rc.y0) + rank * fc.dy
    y = add_column_offset8(y, fc.line_offset2, n, fb)
    z = point_mean8(front.u[2], k, fc.row_stride, fa, fb) - Z - pair.rest_distance
    return (x, y, z), ((Xa + rc.dx, Ya, Za), (Xb, Yb + rc.dy, Zb))


@kernel(_nrt=False, forceinline=True)
def closest_point_step8(rear, rc, K, first, weights, off, tangents, square, near, pressed, tall):
    """Steps of eight closest points along a and b, of which of the `pressed` they are Newton's, as bits, and those of
    the pressed whose steps are not too long.

    first : (row, column) of the first node; weights : values, slopes and second slopes along a and b; square : squared
    area of the tangents
    """
    (x, y, z), ((Xa, Ya, Za), (Xb, Yb, Zb)) = off, tangents
    aa, ab, bb = Xa * Xa + Ya * Ya + Za * Za, Xa * Xb + Ya * Yb + Za * Zb, Xb * Xb + Yb * Yb + Zb * Zb
    ra, rb = Xa * x + Ya * y + Za * z, Xb * x + Yb * y + Zb * z
    area = maximum(Xa * Yb - Xb * Ya, 0.01 * rc.dx * rc.dy)
    over = 1.0 / where(near, square, area)
    go = where(near, bb * ra - ab * rb, Yb * x - Xb * y) * over
    turn = where(near, aa * rb - ab * ra, Xa * y - Ya * x) * over
    sure = 0
    if pressed != 0:
        (wa, wb), (da, db), (ca, cb) = weights
        Xaa, Xab, Xbb = second_derivatives8(rear.u[0], K, rc.row_stride, wa, wb, da, db, ca, cb, tall)
        Yaa, Yab, Ybb = second_derivatives8(rear.u[1], K, rc.row_stride, wa, wb, da, db, ca, cb, tall)
        Zaa, Zab, Zbb = second_derivatives8(rear.u[2], K, rc.row_stride, wa, wb, da, db, ca, cb, tall)
        Xaa = add_row_offset8(Xaa, rc.line_offset1, first[0], ca)
        Ybb = add_column_offset8(Ybb, rc.line_offset2, first[1], cb)
        aa = aa - (x * Xaa + y * Yaa + z * Zaa)
        ab = ab - (x * Xab + y * Yab + z * Zab)
        bb = bb - (x * Xbb + y * Ybb + z * Zbb)
        det = aa * bb - ab * ab
        sure = pressed & movemask(greater(det, 0.1 * square)) & movemask(greater(aa, 0.0))
        go = where(mask_from_bits(sure), (bb * ra - ab * rb) / det, go)
        turn = where(mask_from_bits(sure), (aa * rb - ab * ra) / det, turn)
        pressed &= ~movemask(greater(maximum(fabs(go), fabs(turn)), CP_JUMP))
    return go, turn, sure, pressed


@kernel(_nrt=False, forceinline=True)
def move_closest_points8(rc, pair, q, count, place, step, done, steady, changed):
    """Move those of eight closest points whose bits are set in `done` from `place` by `step`; where a point has
    `changed`, set their rates, zero but for the `steady`."""
    (A, B), (go, turn) = place, step
    before_a, before_b = load(pair.closest_point[0], q), load(pair.closest_point[1], q)
    low_a, low_b = -0.5 if rc.mirror_x else 0.0, -0.5 if rc.mirror_y else 0.0
    A2 = maximum(minimum(A + maximum(minimum(go, MAX_CP_STEP), -MAX_CP_STEP), float(rc.ni)), low_a)
    B2 = maximum(minimum(B + maximum(minimum(turn, MAX_CP_STEP), -MAX_CP_STEP), float(rc.nj)), low_b)
    masked_store(pair.closest_point[0], q, where(mask_from_bits(done), A2, before_a), count)
    masked_store(pair.closest_point[1], q, where(mask_from_bits(done), B2, before_b), count)
    if changed:
        lanes = mask_from_bits(steady)
        rate_a = where(lanes, maximum(minimum(A2 - before_a, MAX_CP_STEP), -MAX_CP_STEP), 0.0)
        rate_b = where(lanes, maximum(minimum(B2 - before_b, MAX_CP_STEP), -MAX_CP_STEP), 0.0)
        masked_update(pair.cp_rate[0], q, rate_a, done, count)
        masked_update(pair.cp_rate[1], q, rate_b, done, count)


@kernel(_nrt=False, forceinline=True)
def intact8(rear, rc, pair, q, e, count, fit):
    """Those of eight points, of the elements from number e on, that are not beside torn fabric, of either ply."""
    if pair.torn_counts[1] > 0 or rear.counter[FAILURES] > 0:
        for m in range(count):
            a, b = (
                pair.closest_point[0][q + m] + pair.cp_rate[0][q + m],
                pair.closest_point[1][q + m] + pair.cp_rate[1][q + m],
            )
            if (fit >> m) & 1 and (pair.near_torn[e + m] or not intact_about(rear, rc, max(a, 0.0), max(b, 0.0))):
                fit &= ~(1 << m)
    return fit


@kernel(_nrt=False, forceinline=True)
def apply_forces8(front, fc, rear, rc, pair, q, at, count, bits, depth, normal, weights):
    """Apply the forces of those of eight points whose bits are set in `pressed`; returns the energy in their springs.

    at : (i, j) of the first element, and where the nodes begin, of the front ply and of the rear one; bits : of points
        that are pressed, and that were in contact; weights : of the points and of their closest points, along a and b,
        and whether the latter are over four lines of nodes
    """
    (i, j, m, n, I, J), (pressed, held), (front_weights, wa, wb, tall) = at, bits, weights
    slack = minimum(where(mask_from_bits(held), load(pair.depth_offset, q), 0.0), depth)
    masked_update(pair.last_depth, q, depth, pressed, count)
    masked_update(pair.depth_offset, q, slack, pressed, count)
    for c in range(3):
        masked_update(pair.normal[c], q, normal[c], pressed, count)
    pair.energy[MAX_DEPTH] = max(pair.energy[MAX_DEPTH], reduce_max(where(mask_from_bits(pressed), depth, 0.0)))
    k, K, closing, (fa, fb) = m * fc.row_stride + n, I * rc.row_stride + J, broadcast(0.0), front_weights
    for c in range(3):
        closing = closing + normal[c] * (
            point_mean8(front.v[c], k, fc.row_stride, fa, fb) - interpolate8(rear.v[c], K, rc.row_stride, wa, wb, tall)
        )
    squeezed = depth - slack
    pair.energy[MAX_COMPRESSION] = max(
        pair.energy[MAX_COMPRESSION], reduce_max(where(mask_from_bits(pressed), squeezed, 0.0))
    )
    spring, damping, energy = law_at8(pair, squeezed)
    part = scaled_by_area8(broadcast(1.0), pair.area_factor1, pair.area_factor2, i, j)
    f = where(mask_from_bits(pressed), maximum(part * (spring + damping * closing), 0.0), 0.0)
    store_normal_force8(pair.normal_force, q, f, pressed, count)
    if movemask(greater(f, 0.0)) != 0:
        extend_window(pair.front_window, m, m + 3, max(n, 0), min(n + WIDTH + 2, fc.row_stride))
        extend_window(pair.rear_window, I, I + (4 if tall else 3), max(J, 0), min(J + WIDTH + 3, rc.row_stride))
        for c in range(3):
            scatter_to_points8(pair.f_front[c], k, fc.row_stride, 0.0 - f * normal[c], fa, fb)
            scatter_weighted8(pair.f_rear[c], K, rc.row_stride, f * normal[c], wa, wb, tall)
    return reduce_add(where(mask_from_bits(pressed), part * energy, 0.0))


@kernel(_nrt=False, forceinline=True)
def extend_window(touched, i0, i1, j0, j1):
    """Widen the window of nodes with forces to i0 .. i1 - 1, j0 .. j1 - 1."""
    touched[0], touched[1] = min(touched[0], i0), max(touched[1], i1)
    touched[2], touched[3] = min(touched[2], j0), max(touched[3], j1)


@kernel(_nrt=False, forceinline=True)
def masked_update(array, q, value, which, count):
    """Write those of eight numbers whose bits are set."""
    masked_store(array, q, where(mask_from_bits(which), value, load(array, q)), count)
