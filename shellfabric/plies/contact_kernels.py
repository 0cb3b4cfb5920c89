"""Contact of neighbouring plies: penalty between two smooth surfaces.

Surfaces. Those of `ply_surface_kernels`: splines, and facets where yarns have failed.

Gap. Each element of the front ply, which the projectile meets first, carries p x p points x of its surface. y is the
foot of x on the rear ply's surface and n the normal there, the way that the shot flies:

    depth = t - n.(y - x),      f = max(0, k depth + c n.(v_x - v_y))   where depth > 0

with t the mean thickness of the two plies: thickness lies on both sides of a middle surface, so that curved plies that
nest keep t along their normals. -f n acts on the nodes of the front ply by their weights in x, f n on those of the rear
ply by their weights in y: the sum is zero to the last digits. Whole cloth that came through, where depth > t, would
still be pushed back, and the harder; it is counted, and ends the run. Beside torn cloth, where folds are found deep and
pressed on, what springs cannot hold is stopped before that (`ply_stop_kernels`).

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
points there (`contact_back`), with half the stiffness each: the middle of an element behind otherwise goes through what
hangs before it, between the points of that. Those behind begin without load, wherever they are found.

Naive forms, for comparison: the nodes of the front ply against the bilinear facets of the rear one (FACETS), or against
the node there, along z (NODES).

Which points are looked at. Plies that are deflected by less than a quarter of the gap between them cannot touch: there
is a box about those nodes of each ply that are deflected by more, three elements wider, renewed every eight steps, in
which a transverse wave comes less than an element further. A point that is clear of the other ply is left alone for as
long as it would need to get there at one and a half times the highest speeds of both plies. The others are looked at
eight at once where nothing is the matter with them (`ply_lanes_kernels`).

Work. What a step's contact takes from the motion is summed over the nodes: half a step's work of the old forces, half a
step's of the new, on the same velocities. So it balances to the last digits, whatever the weights.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, above, bits, fabs, first, fma, highest, keep, load, most, splat, total, where
from shellfabric.panel.step_kernels import FAILURES
from shellfabric.plies.contact_simd_kernels import (
    CLOSE,
    DEEPEST,
    FREE,
    JUMP,
    LEAP,
    LONGEST,
    LOST,
    PASSED,
    PLACE,
    SPRING,
    SQUEEZED,
    STEP,
    STIFFER,
    TAKEN,
    TOUCHING,
    WHEN,
    WHERE,
    force,
    touch8,
    widen,
)
from shellfabric.plies.surface_kernels import (
    FACETS,
    NODES,
    SMOOTH,
    across,
    curving,
    left,
    middle,
    patch,
    seek,
    share,
    spread,
    weights,
    whole_about,
)

_EVERY, _MARGIN = 8, 3  # steps between scans, elements about what they find
_FASTER = 1.5  # than at the last scan nodes may become
_ABOUT = 3  # elements about torn ones that count as beside them


@kernel(_nrt=False)
def scan(state, const, least, box):
    """Widen the box (first and last row, and column, of nodes) to all that are deflected by more than `least`.

    Returns the highest speed of a node.
    """
    s, fastest = const.s, splat(0.0)
    for i in range(const.ni + 1):
        for j in range(0, s, WIDTH):
            k, own = i * s + j, first(s - j)
            v_x, v_y, v_z = load(state.v[0], k), load(state.v[1], k), load(state.v[2], k)
            fastest = most(fastest, where(own, v_x * v_x + v_y * v_y + v_z * v_z, 0.0))
            if box[0] <= i <= box[1] and box[2] <= j and j + WIDTH <= box[3] + 1:
                continue
            beyond = bits(own) & bits(above(fabs(load(state.u[2], k)), least))
            for m in range(WIDTH if beyond != 0 else 0):
                if (beyond >> m) & 1:
                    box[0], box[1] = min(box[0], i), max(box[1], i)
                    box[2], box[3] = min(box[2], j + m), max(box[3], j + m)
    return math.sqrt(highest(fastest))


@kernel(_nrt=False, forceinline=True)
def settle(state, const, force, touched, over):
    """Half a step's work of the nodal forces on the present velocities, which are those of half a step ago; takes them
    away where they are `over`."""
    work, none = splat(0.0), splat(0.0)
    for i in range(touched[0], touched[1]):
        for j in range(touched[2], touched[3], WIDTH):
            k, inside = i * const.s + j, first(touched[3] - j)
            power = load(force[0], k) * load(state.v[0], k)
            power = fma(load(force[1], k), load(state.v[1], k), power)
            power = fma(load(force[2], k), load(state.v[2], k), power)
            work = work + where(inside, power, 0.0)
            if over:
                keep(force[0], k, none, touched[3] - j)
                keep(force[1], k, none, touched[3] - j)
                keep(force[2], k, none, touched[3] - j)
    if over:
        touched[0], touched[1], touched[2], touched[3] = const.ni + 1, 0, const.s, 0
    return 0.5 * const.dt * total(work)


@kernel(_nrt=False, forceinline=True)
def note(touched, i, j, n):
    """Widen the window of nodes with forces by n by n nodes."""
    widen(touched, i, i + n, j, j + n)


@kernel(_nrt=False)
def symmetric(const, force, touched):
    """Nodes on a plane of symmetry keep to it."""
    if const.mirror_x and touched[0] == 0:
        for k in range(touched[2], touched[3]):
            force[0][k] = 0.0
    if const.mirror_y and touched[2] == 0:
        for i in range(touched[0], touched[1]):
            force[1][i * const.s] = 0.0


@kernel(_nrt=False, forceinline=True)
def window(pair, fc, rc):
    """Element rows and columns of the front ply where either ply's deflection can bring them into contact."""
    i0, i1, j0, j1 = pair.front_box[0], pair.front_box[1], pair.front_box[2], pair.front_box[3]
    if pair.rear_box[0] <= pair.rear_box[1]:
        i0 = min(i0, int((rc.x0 + pair.rear_box[0] * rc.dx - fc.x0) / fc.dx))
        i1 = max(i1, int((rc.x0 + pair.rear_box[1] * rc.dx - fc.x0) / fc.dx) + 1)
        j0 = min(j0, int((rc.y0 + pair.rear_box[2] * rc.dy - fc.y0) / fc.dy))
        j1 = max(j1, int((rc.y0 + pair.rear_box[3] * rc.dy - fc.y0) / fc.dy) + 1)
    return max(i0 - _MARGIN, 0), min(i1 + _MARGIN, fc.ni), max(j0 - _MARGIN, 0), min(j1 + _MARGIN, fc.nj)


@kernel(_nrt=False, forceinline=True)
def contact(front, fc, rear, rc, pair, step):
    """Forces between two plies at their present positions, into pair.on_front and pair.on_rear."""
    if step % _EVERY == 0:
        pair.speed[0] = scan(front, fc, pair.least, pair.front_box)
        pair.speed[1] = scan(rear, rc, pair.least, pair.rear_box)
    tear(front, fc, rear, rc, pair)
    taken = -settle(front, fc, pair.on_front, pair.front_touched, True)
    taken -= settle(rear, rc, pair.on_rear, pair.rear_touched, True)
    i0, i1, j0, j1 = window(pair, fc, rc)
    p, spring, now, often = pair.points, 0.0, float(step), step % _EVERY == 0
    shot = math.sqrt(front.speed[0] ** 2 + front.speed[1] ** 2 + front.speed[2] ** 2)
    nearer = _FASTER * fc.dt * (max(pair.speed[0], shot) + max(pair.speed[1], shot))
    for i in range(i0, i1):
        start, end = (i * fc.nj + j0) * p * p, (i * fc.nj + j1) * p * p
        for q0 in range(start, end, WIDTH):
            count = min(WIDTH, end - q0)
            due = bits(first(count)) & ~bits(above(load(pair.until, q0), now))
            if due != 0 and p == 1 and pair.form == SMOOTH:
                due, energy = touch8(front, fc, rear, rc, pair, q0, i, q0 - i * fc.nj, count, nearer, now, due)
                spring += energy
            if due == 0:
                continue
            for q in range(q0, q0 + count):
                if (due >> (q - q0)) & 1 == 0:
                    continue
                j, m = q // (p * p) - i * fc.nj, q % (p * p)
                a, b = i + (m // p + pair.start) / p, j + (m % p + pair.start) / p
                energy, depth = touch(front, fc, rear, rc, pair, q, a, b, often)
                if depth < 0.0:
                    pair.until[q] = now + 1.0 + leave(depth, nearer)
                spring += energy
                if depth > pair.energy[DEEPEST]:
                    pair.energy[DEEPEST], pair.energy[PLACE] = depth, q
    symmetric(fc, pair.on_front, pair.front_touched)
    symmetric(rc, pair.on_rear, pair.rear_touched)
    taken -= settle(front, fc, pair.on_front, pair.front_touched, False)
    taken -= settle(rear, rc, pair.on_rear, pair.rear_touched, False)
    conclude(pair, taken, spring, step)


@kernel(_nrt=False, forceinline=True)
def contact_back(front, fc, rear, rc, pair, step):
    """As `contact`, for the points beside torn cloth of a ply that lies behind, on the one before it."""
    tear(front, fc, rear, rc, pair)
    if pair.tears[1] == 0:
        return
    taken = -settle(front, fc, pair.on_front, pair.front_touched, True)
    taken -= settle(rear, rc, pair.on_rear, pair.rear_touched, True)
    p, spring, often = pair.points, 0.0, step % _EVERY == 0
    for e in pair.list[: pair.tears[1]]:
        for m in range(p * p):
            a, b = e // fc.nj + (m // p + pair.start) / p, e % fc.nj + (m % p + pair.start) / p
            energy, depth = touch(front, fc, rear, rc, pair, e * p * p + m, a, b, often)
            spring += energy
            if depth > pair.energy[DEEPEST]:
                pair.energy[DEEPEST], pair.energy[PLACE] = depth, e * p * p + m
    symmetric(fc, pair.on_front, pair.front_touched)
    symmetric(rc, pair.on_rear, pair.rear_touched)
    taken -= settle(front, fc, pair.on_front, pair.front_touched, False)
    taken -= settle(rear, rc, pair.on_rear, pair.rear_touched, False)
    conclude(pair, taken, spring, step)


@kernel(_nrt=False)
def conclude(pair, taken, spring, step):
    """Book the energies of a step, and when the first point went through."""
    pair.energy[TAKEN] += taken
    pair.energy[SPRING] = spring
    if pair.energy[PASSED] > 0.0 and pair.energy[WHEN] == 0.0:
        pair.energy[WHEN] = step


@kernel(_nrt=False, forceinline=True)
def tear(front, fc, rear, rc, pair):
    """Note, when more yarns have failed, the elements of the front ply that are next to torn ones of either ply."""
    failures = front.counter[FAILURES] + rear.counter[FAILURES]
    pair.tears[2] = failures - pair.tears[0]
    if pair.tears[2] != 0:
        pair.tears[0] = failures
        look_for_tears(front, fc, rear, rc, pair)


@kernel(_nrt=False)
def look_for_tears(front, fc, rear, rc, pair):
    """The elements of the front ply that are next to torn ones of either ply, into pair.torn and pair.list."""
    pair.tears[1] = 0
    pair.torn[:] = 0
    for i in range(fc.ni):
        for j in range(fc.nj):
            if front.flag[i * fc.s + j]:
                reach(fc, pair, i, j)
    for i in range(rc.ni):
        for j in range(rc.nj):
            if rear.flag[i * rc.s + j]:
                x, y = rc.x0 + (i + 0.5) * rc.dx - fc.x0, rc.y0 + (j + 0.5) * rc.dy - fc.y0
                reach(fc, pair, int(x / fc.dx), int(y / fc.dy))
    for e in range(fc.ni * fc.nj):
        if pair.torn[e]:
            pair.list[pair.tears[1]] = e
            pair.tears[1] += 1


@kernel(_nrt=False)
def reach(const, pair, i, j):
    """Note the elements about (i, j)."""
    for m in range(max(i - _ABOUT, 0), min(i + _ABOUT + 1, const.ni)):
        for n in range(max(j - _ABOUT, 0), min(j + _ABOUT + 1, const.nj)):
            pair.torn[m * const.nj + n] = 1


@kernel(_nrt=False, forceinline=True)
def leave(depth, nearer):
    """Steps that a point which is clear by -depth [m] can be left alone, where it comes nearer by `nearer` in each."""
    return float(LONGEST) if -depth > LONGEST * nearer else math.floor(-depth / nearer)


@kernel(_nrt=False, forceinline=True)
def touch(front, fc, rear, rc, pair, q, a, b, often):
    """Follow the foot of the front ply's point at (a, b), and let it push: (energy in its spring, depth).

    The depth is negative where the point is clear of the rear ply, and 0 where it cannot push. often : whether a foot
    beside torn cloth is to be looked for anew, if it has been followed well or not
    """
    central = pair.points == 1 and pair.form == SMOOTH  # the spline goes through the middles of the elements
    if central:
        i, j, p0, p1, p2, p1x, q0, q1, q2, q1y = int(a), int(b), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        k = np.uint64(i * fc.s + j)
        x, y, z = middle(front.u[0], k, fc.s), middle(front.u[1], k, fc.s), middle(front.u[2], k, fc.s)
    else:
        form_x = pair.form if pair.form != SMOOTH or whole_about(front, fc, a, b) else FACETS
        i, p0, p1, p2, _, _, _, p1x, _ = weights(form_x, a, fc.ni, fc.mirror_x)
        j, q0, q1, q2, _, _, _, q1y, _ = weights(form_x, b, fc.nj, fc.mirror_y)
        k = np.uint64(i * fc.s + j)
        x = across(front.u[0], k, fc.s, p0, p1x, p2, q0, q1, q2)
        y = across(front.u[1], k, fc.s, p0, p1, p2, q0, q1y, q2)
        z = across(front.u[2], k, fc.s, p0, p1, p2, q0, q1, q2)
    x, y = x + fc.x0 + a * fc.dx, y + fc.y0 + b * fc.dy
    at_x, at_y, at_z = x - rc.x0, y - rc.y0, z - pair.apart  # from the first node of the rear ply at rest
    low = -0.5 if pair.form == SMOOTH else 0.0
    low_a, low_b = low if rc.mirror_x else 0.0, low if rc.mirror_y else 0.0
    before_a, before_b = pair.foot[0][q], pair.foot[1][q]
    A = min(max(before_a + pair.going[0][q], low_a), float(rc.ni))
    B = min(max(before_b + pair.going[1][q], low_b), float(rc.nj))
    whole = pair.form != SMOOTH or whole_about(rear, rc, A, B)
    form = pair.form if whole else FACETS
    I, w0, w1, w2, d0, d1, d2, w1x, d1x = weights(form, A, rc.ni, rc.mirror_x)
    J, v0, v1, v2, e0, e1, e2, v1y, e1y = weights(form, B, rc.nj, rc.mirror_y)
    K = np.uint64(I * rc.s + J)
    X, Xa, Xb = patch(rear.u[0], K, rc.s, (w0, w1x, w2), (v0, v1, v2), (d0, d1x, d2), (e0, e1, e2))
    Y, Ya, Yb = patch(rear.u[1], K, rc.s, (w0, w1, w2), (v0, v1y, v2), (d0, d1, d2), (e0, e1y, e2))
    Z, Za, Zb = patch(rear.u[2], K, rc.s, (w0, w1, w2), (v0, v1, v2), (d0, d1, d2), (e0, e1, e2))
    Xa, Yb = Xa + rc.dx, Yb + rc.dy
    x, y, z = at_x - X - A * rc.dx, at_y - Y - B * rc.dy, at_z - Z  # from the foot
    n_x, n_y, n_z = Ya * Zb - Za * Yb, Za * Xb - Xa * Zb, Xa * Yb - Ya * Xb
    size = math.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    tiny = 1e-6 * rc.dx * rc.dy
    if size < tiny:  # cloth that is drawn to a line has no normal
        n_x, n_y, n_z, size = pair.normal[0][q], pair.normal[1][q], pair.normal[2][q], 1.0
    n_x, n_y, n_z = n_x / size, n_y / size, n_z / size
    size = max(size, tiny)
    touches = pair.status[q] == TOUCHING
    along, far, slant = n_x * x + n_y * y + n_z * z, math.sqrt(x * x + y * y + z * z), False
    turned, known = along > 0.0, 0.0  # what comes near does so on its own side
    # so deep that it may come through, or has; or the surface has just changed from spline to facets, or back
    other, pair.faceted[q] = pair.tears[2] != 0 or (pair.faceted[q] == 0) != whole, 0 if whole else 1
    if touches and (pair.was[q] > (1.0 - CLOSE) * pair.thickness or other):
        known = n_x * pair.normal[0][q] + n_y * pair.normal[1][q] + n_z * pair.normal[2][q]
        turned = known < 0.0 if abs(known) > 0.5 else turned
    if turned and pair.form == SMOOTH:
        n_x, n_y, n_z, along = -n_x, -n_y, -n_z, -along
    depth = pair.thickness + along
    near = depth > -0.5 * pair.thickness
    if pair.form == SMOOTH and abs(known) <= 0.5 and far > 0.3 * pair.thickness and along > -0.7 * far:
        # a fold, a rim or cloth drawn to a line, whose normal says nothing of where the point is
        n_x, n_y, n_z, depth, slant = -x / far, -y / far, -z / far, pair.thickness - far, True
    if near:
        aa, ab, bb = Xa * Xa + Ya * Ya + Za * Za, Xa * Xb + Ya * Yb + Za * Zb, Xb * Xb + Yb * Yb + Zb * Zb
        ra, rb = Xa * x + Ya * y + Za * z, Xb * x + Yb * y + Zb * z
        go, turn, sure = (bb * ra - ab * rb) / (size * size), (aa * rb - ab * ra) / (size * size), False
        if depth > 0.0:
            c0, c1, c2, c1x = curving(form, A, rc.ni, rc.mirror_x)
            g0, g1, g2, g1y = curving(form, B, rc.nj, rc.mirror_y)
            F = rear.u
            aa -= x * across(F[0], K, rc.s, c0, c1x, c2, v0, v1, v2)
            aa -= y * across(F[1], K, rc.s, c0, c1, c2, v0, v1y, v2) + z * across(F[2], K, rc.s, c0, c1, c2, v0, v1, v2)
            ab -= x * across(F[0], K, rc.s, d0, d1x, d2, e0, e1, e2)
            ab -= y * across(F[1], K, rc.s, d0, d1, d2, e0, e1y, e2) + z * across(F[2], K, rc.s, d0, d1, d2, e0, e1, e2)
            bb -= x * across(F[0], K, rc.s, w0, w1x, w2, g0, g1, g2)
            bb -= y * across(F[1], K, rc.s, w0, w1, w2, g0, g1y, g2) + z * across(F[2], K, rc.s, w0, w1, w2, g0, g1, g2)
            det = aa * bb - ab * ab
            if det > 0.1 * size * size and aa > 0.0:
                go, turn, sure = (bb * ra - ab * rb) / det, (aa * rb - ab * ra) / det, True
    else:
        # of cloth that stands on end nothing is straight ahead
        area = max(Xa * Yb - Xb * Ya, 0.01 * rc.dx * rc.dy)
        go, turn, sure = (Yb * x - Xb * y) / area, (Xa * y - Ya * x) / area, False
    A2, B2 = A + min(max(go, -STEP), STEP), B + min(max(turn, -STEP), STEP)
    pair.foot[0][q] = min(max(A2, low_a), float(rc.ni))
    pair.foot[1][q] = min(max(B2, low_b), float(rc.nj))
    pair.going[0][q] = pair.going[1][q] = 0.0
    lost, leapt = pair.status[q] == LOST, depth > 0.0 and max(abs(go), abs(turn)) > LEAP
    if not (touches or lost):
        pair.was[q] = pair.slack[q] = 0.0
    pair.status[q] = LOST if leapt or (slant and (touches or lost)) else FREE
    torn = pair.torn[q // (pair.points * pair.points)] != 0
    if pair.form == SMOOTH and (leapt or (torn and (often or not (whole or touches)))):
        seek(rear, rc, pair.foot, q, at_x, at_y, at_z, far)
    if depth <= 0.0:
        return 0.0, 0.0 if torn or slant else depth
    beside_x, beside_y = A2 > rc.ni or (A2 < 0.0 and not rc.mirror_x), B2 > rc.nj or (B2 < 0.0 and not rc.mirror_y)
    if beside_x or beside_y or (leapt and pair.form != NODES):
        return 0.0, 0.0
    left_x, left_y = left(front, fc, a, b), left(rear, rc, A, B)
    if left_x == 0.0 or left_y == 0.0:
        return 0.0, 0.0
    smooth = pair.form == SMOOTH
    v_x = -across(rear.v[0], K, rc.s, w0, w1x, w2, v0, v1, v2)
    v_y = -across(rear.v[1], K, rc.s, w0, w1, w2, v0, v1y, v2)
    v_z = -across(rear.v[2], K, rc.s, w0, w1, w2, v0, v1, v2)
    if central:
        v_x, v_y, v_z = (
            v_x + middle(front.v[0], k, fc.s),
            v_y + middle(front.v[1], k, fc.s),
            v_z + middle(front.v[2], k, fc.s),
        )
    else:
        v_x += across(front.v[0], k, fc.s, p0, p1x, p2, q0, q1, q2)
        v_y += across(front.v[1], k, fc.s, p0, p1, p2, q0, q1y, q2)
        v_z += across(front.v[2], k, fc.s, p0, p1, p2, q0, q1, q2)
    closing = n_x * v_x + n_y * v_y + n_z * v_z
    made, deep = closing * fc.dt, depth > (1.0 - CLOSE) * pair.thickness  # depth that the last step's motion has made
    jump = (depth - pair.was[q] - made) / pair.thickness
    if smooth and deep and abs(known) <= 0.5 and ((not touches and not whole) or (whole and jump > JUMP)):
        return 0.0, 0.0  # it has come from a hole, a rim or another fold, edge on, and is on no side yet
    moved = jump <= JUMP and pair.slack[q] <= (1.0 - CLOSE) * pair.thickness  # by motion, from a side that it had
    if touches and smooth and whole and depth > pair.thickness and left_x == 1.0 and left_y == 1.0 and moved:
        pair.energy[PASSED], pair.energy[WHERE] = pair.energy[PASSED] + 1.0, q
    if smooth and (lost or abs(jump) > JUMP):
        kept = max(pair.was[q] - pair.slack[q] + (0.0 if lost else made), 0.0)
        softer = stiffened(pair, pair.slack[q]) / stiffened(pair, max(depth - kept, 0.0))
        pair.slack[q] = max(depth - kept * math.sqrt(softer), 0.0)
    elif not touches:
        pair.slack[q] = depth if depth > 0.5 * pair.thickness and pair.form == FACETS else 0.0
    elif sure:
        pair.going[0][q] = min(max(pair.foot[0][q] - before_a, -STEP), STEP)
        pair.going[1][q] = min(max(pair.foot[1][q] - before_b, -STEP), STEP)
    pair.status[q] = TOUCHING
    pair.normal[0][q], pair.normal[1][q], pair.normal[2][q] = n_x, n_y, n_z
    pair.was[q], pair.slack[q] = depth, min(pair.slack[q], depth)
    squeezed, part = depth - pair.slack[q], 0.5 if torn else 1.0
    pair.energy[SQUEEZED] = max(pair.energy[SQUEEZED], squeezed)
    if pair.start == 0.0:  # half an element, or a quarter, is modelled about points on planes of symmetry
        part *= (0.5 if a == 0.0 and fc.mirror_x else 1.0) * (0.5 if b == 0.0 and fc.mirror_y else 1.0)
    drag = part * pair.damping
    part *= stiffened(pair, pair.slack[q])
    f = max(0.0, force(pair, part, squeezed, drag, closing))
    if f > 0.0:
        note(pair.front_touched, i, j, 2 if central else 3)
        note(pair.rear_touched, I, J, 3)
        F = pair.on_front
        if central:
            share(F[0], k, fc.s, -f * n_x)
            share(F[1], k, fc.s, -f * n_y)
            share(F[2], k, fc.s, -f * n_z)
        else:
            spread(F[0], k, fc.s, -f * n_x, p0, p1x, p2, q0, q1, q2)
            spread(F[1], k, fc.s, -f * n_y, p0, p1, p2, q0, q1y, q2)
            spread(F[2], k, fc.s, -f * n_z, p0, p1, p2, q0, q1, q2)
        F = pair.on_rear
        spread(F[0], K, rc.s, f * n_x, w0, w1x, w2, v0, v1, v2)
        spread(F[1], K, rc.s, f * n_y, w0, w1, w2, v0, v1y, v2)
        spread(F[2], K, rc.s, f * n_z, w0, w1, w2, v0, v1, v2)
    return 0.5 * part * pair.stiffness * squeezed * squeezed, depth


@kernel(_nrt=False, forceinline=True)
def stiffened(pair, slack):
    """By how much a spring that begins at the depth `slack` is stiffer: what is left of the thickness has to hold as
    much."""
    return min(STIFFER, pair.thickness / max(pair.thickness - slack, 0.1 * pair.thickness)) if slack > 0.0 else 1.0


@kernel(_nrt=False)
def push(state, const, force, touched):
    """Give a ply the impulses of a neighbour's forces; widens its window of rows to them."""
    if touched[1] <= touched[0]:
        return
    for i in range(touched[0], touched[1]):
        for j in range(touched[2], touched[3], WIDTH):
            k, count = i * const.s + j, touched[3] - j
            kick = load(state.kick, k)
            keep(state.v[0], k, fma(kick, load(force[0], k), load(state.v[0], k)), count)
            keep(state.v[1], k, fma(kick, load(force[1], k), load(state.v[1], k)), count)
            keep(state.v[2], k, fma(kick, load(force[2], k), load(state.v[2], k)), count)
    state.rows[0] = min(state.rows[0], max(touched[0] - 4, 0))
    state.rows[1] = max(state.rows[1], min(touched[1] + 3, const.ni))
