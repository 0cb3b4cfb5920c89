"""Contact of neighbouring plies: penalty between two smooth surfaces.

Surfaces. Those of `ply_surface_kernels`: splines, and facets where yarns have failed.

Gap. Each element of the front ply, which the projectile meets first, carries p x p points x of its surface. y is the
foot of x on the rear ply's surface and n the normal there, the way that the shot flies:

    depth = t - n.(y - x),      f = max(0, k depth + c n.(v_x - v_y))   where depth > 0

with t the mean thickness of the two plies: thickness lies on both sides of a middle surface, so that curved plies that
nest keep t along their normals. -f n acts on the nodes of the front ply by their weights in x, f n on those of the rear
ply by their weights in y: the sum is zero to the last digits. Whole cloth that came through, where depth > t, would
still be pushed back, and the harder; it is counted, and ends the run.

Sides. Contact does not ask which way a normal points, but on which side of the cloth a point is: what comes near is on
its own side, and stays there. Cloth that is drawn in until an element lies upside down has a normal that turns over
within a step: a point 0.006 t deep was found 1.99 t deep, and thrown. So n points away from x as long as x cannot have
come through, which takes a depth close to t in the step before; then it goes on from the n of that step. In folds, on
rims and where cloth is drawn to a line the normal says nothing of x - y, and n is its direction.

The foot follows from step to step by one step of Gauss and Newton; of a point that touches by one of Newton, from where
the foot will be if it goes on as it did in the last step. From where it was, n is that of a step ago: a hundredth of an
element, but always to the same side. Plies that slide on each other over a bend were pulled along by that, and contact
gave several per cent of a shot's energy. Where the plies are further apart than half their thickness the foot is the
point straight ahead of x, which is never ambiguous.

Failed yarns. What is left of a yarn pushes as the whole: its mass is the same. Nothing pushes where both yarns next to
x or y are gone: that is a hole, and a point may go through it. What comes out of a hole is on either side, and pushes
from there. Found inside the thickness, it begins without a force, on a spring that is as much stiffer as the rest of
the thickness is less (three times at most), and is let no deeper; found in the very middle, edge on, it is on no side
yet. A point whose foot leaps, as in folds of whole cloth, is let go until it has one again, and goes on with its spring
as it was then. With one of its new depth it had brought energy from nothing, 1.1 % of a shot's in four bunched plies.
Beside torn cloth feet get lost, so they are looked for anew, and elements are as long as the holes, so both plies have
points there (`contact_back`), with half the stiffness each: the middle of an element behind otherwise goes through what
hangs before it, between the points of that.

Naive forms, for comparison: the nodes of the front ply against the bilinear facets of the rear one (FACETS), or against
the node there, along z (NODES).

Which points are looked at. Plies that are deflected by less than a quarter of the gap between them cannot touch: there
is a box about those nodes of each ply that are deflected by more, three elements wider, renewed every eight steps, in
which a transverse wave comes less than an element further. A point that is clear of the other ply is left alone for as
long as it would need to get there at one and a half times the highest speeds of both plies.

Work. What a step's contact takes from the motion is summed over the nodes: half a step's work of the old forces, half a
step's of the new, on the same velocities. So it balances to the last digits, whatever the weights.
"""

import math

import numpy as np

from shellfabric.compiled import kernel
from shellfabric.lanes import (
    WIDTH,
    above,
    bits,
    fabs,
    first,
    floor,
    fma,
    highest,
    keep,
    lanes_of,
    least,
    load,
    most,
    splat,
    sqrt,
    those,
    total,
    where,
)
from shellfabric.march_kernels import FAILURES
from shellfabric.ply_surface_kernels import (
    FACETS,
    NODES,
    SMOOTH,
    across,
    across8,
    bases8,
    curved8,
    curving,
    left,
    middle,
    middle8,
    patch,
    patch8,
    seek,
    share,
    share8,
    spread,
    spread8,
    weights,
    whole_about,
)

TAKEN, SPRING, DEEPEST, PLACE, PASSED, WHERE, WHEN = range(7)  # of pair.energy
_CLOSE, _STIFFER = 0.15, 3.0  # [thicknesses] where a point may come through; most that a spring is stiffened
FREE, TOUCHING, LOST = 0, 1, 2  # of pair.status; a point whose foot leaps or lies aside is lost until it has one again
_EVERY, _MARGIN = 8, 3  # steps between scans, elements about what they find
_FASTER, _LONGEST = 1.5, 8  # than at the last scan nodes may become; most steps that a point is left alone
_STEP, _LEAP = 0.25, 0.2  # [elements] longest step of a foot; one so long has none
_ABOUT = 3  # elements about torn ones that count as beside them


@kernel(_nrt=False, forceinline=True)
def scan(state, const, least, box):
    """Widen the box (first and last row, and column, of nodes) to all that are deflected by more than `least`.

    Returns the highest speed of a node.
    """
    z, s, fastest = state.u[2], const.s, 0.0
    for i in range(const.ni + 1):
        row = i * s
        low, high = s, -1
        for j in range(s):
            if abs(z[row + j]) > least:
                low, high = min(low, j), max(high, j)
        if high >= 0:
            box[0], box[1] = min(box[0], i), max(box[1], i)
            box[2], box[3] = min(box[2], low), max(box[3], high)
    for k in range((const.ni + 1) * s):
        v_x, v_y, v_z = state.v[0][k], state.v[1][k], state.v[2][k]
        fastest = max(fastest, v_x * v_x + v_y * v_y + v_z * v_z)
    return math.sqrt(fastest)


@kernel(_nrt=False, forceinline=True)
def settle(state, const, force, touched):
    """Half a step's work of the nodal forces on the present velocities, which are those of half a step ago."""
    work = splat(0.0)
    for i in range(touched[0], touched[1]):
        for j in range(touched[2], touched[3], WIDTH):
            k, inside = i * const.s + j, first(touched[3] - j)
            power = load(force[0], k) * load(state.v[0], k)
            power = fma(load(force[1], k), load(state.v[1], k), power)
            power = fma(load(force[2], k), load(state.v[2], k), power)
            work = work + where(inside, power, 0.0)
    return 0.5 * const.dt * total(work)


@kernel(_nrt=False, forceinline=True)
def clear(const, force, touched):
    """Set the forces of the last step to zero."""
    for F in force:
        for i in range(touched[0], touched[1]):
            for k in range(np.uint64(i * const.s + touched[2]), np.uint64(i * const.s + touched[3])):
                F[k] = 0.0
    touched[0], touched[1], touched[2], touched[3] = const.ni + 1, 0, const.s, 0


@kernel(_nrt=False, forceinline=True)
def note(touched, i, j, n):
    """Widen the window of nodes with forces by n by n nodes."""
    touched[0], touched[1] = min(touched[0], i), max(touched[1], i + n)
    touched[2], touched[3] = min(touched[2], j), max(touched[3], j + n)


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


@kernel(_nrt=False)
def contact(front, fc, rear, rc, pair, step):
    """Forces between two plies at their present positions, into pair.on_front and pair.on_rear."""
    if step % _EVERY == 0:
        pair.speed[0] = scan(front, fc, pair.least, pair.front_box)
        pair.speed[1] = scan(rear, rc, pair.least, pair.rear_box)
    if front.counter[FAILURES] + rear.counter[FAILURES] != pair.tears[0]:
        tear(front, fc, rear, rc, pair)
    taken = -settle(front, fc, pair.on_front, pair.front_touched) - settle(rear, rc, pair.on_rear, pair.rear_touched)
    clear(fc, pair.on_front, pair.front_touched)
    clear(rc, pair.on_rear, pair.rear_touched)
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
    taken -= settle(front, fc, pair.on_front, pair.front_touched) + settle(rear, rc, pair.on_rear, pair.rear_touched)
    conclude(pair, taken, spring, step)


@kernel(_nrt=False)
def contact_back(front, fc, rear, rc, pair, step):
    """As `contact`, for the points beside torn cloth of a ply that lies behind, on the one before it."""
    if front.counter[FAILURES] + rear.counter[FAILURES] != pair.tears[0]:
        tear(front, fc, rear, rc, pair)
    if pair.tears[1] == 0:
        return
    taken = -settle(front, fc, pair.on_front, pair.front_touched) - settle(rear, rc, pair.on_rear, pair.rear_touched)
    clear(fc, pair.on_front, pair.front_touched)
    clear(rc, pair.on_rear, pair.rear_touched)
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
    taken -= settle(front, fc, pair.on_front, pair.front_touched) + settle(rear, rc, pair.on_rear, pair.rear_touched)
    conclude(pair, taken, spring, step)


@kernel(_nrt=False)
def conclude(pair, taken, spring, step):
    """Book the energies of a step, and when the first point went through."""
    pair.energy[TAKEN] += taken
    pair.energy[SPRING] = spring
    if pair.energy[PASSED] > 0.0 and pair.energy[WHEN] == 0.0:
        pair.energy[WHEN] = step


@kernel(_nrt=False)
def tear(front, fc, rear, rc, pair):
    """Note the elements of the front ply that are next to torn ones of either ply."""
    pair.tears[0], pair.tears[1] = front.counter[FAILURES] + rear.counter[FAILURES], 0
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
    return float(_LONGEST) if -depth > _LONGEST * nearer else math.floor(-depth / nearer)


@kernel(_nrt=False, forceinline=True)
def touch8(front, fc, rear, rc, pair, q, i, j, count, nearer, now, due):
    """`touch` for those of the points in the middles of the elements (i, j) .. (i, j + count) with which nothing is
    the matter, eight at once: whole cloth on whole cloth, feet side by side and away from rims and planes of symmetry,
    not lost, in no fold, and not so deep that it might come through.

    due : the points that are to be looked at, as bits. Returns (those that are left for `touch`, energy in the springs
    of the others).
    """
    k, own = i * fc.s + j, bits(first(count))
    held = own & bits(those(pair.status, q, TOUCHING))
    fit = (own & bits(those(pair.status, q, FREE)) | held) & bits(those(front.flag, k, 0))
    A, B = load(pair.foot[0], q) + load(pair.going[0], q), load(pair.foot[1], q) + load(pair.going[1], q)
    rank = load(pair.rank, 0)
    fit = whole8(rear, rc, pair, q, count, fit)
    I, J = floor(least(most(A + 0.5, 1.0), rc.ni - 1.0)), floor(least(most(B + 0.5, 1.0), rc.nj - 1.0))
    r, t = A - I, B - J
    fit &= ~bits(above(most(fabs(r), fabs(t)), 0.5))
    chosen = lanes_of(fit)
    I0, J0 = -highest(where(chosen, 0.0 - I, -1e9)), -highest(where(chosen, rank - J, -1e9))
    slot = (I0 - 1.0) * rc.s + (J0 - 1.0)
    if fit == 0 or slot < 0.0:
        return due, 0.0
    K = int(slot)
    I, J = I - I0, J - rank - J0  # from the first of all nodes
    fit &= ~bits(above(most(I, J), 1.5))
    (wa, da, ca), (wb, db, cb) = bases8(r, above(I, 0.5)), bases8(t, above(J, 0.5))
    X, Xa, Xb = patch8(rear.u[0], K, rc.s, wa, wb, da, db)
    Y, Ya, Yb = patch8(rear.u[1], K, rc.s, wa, wb, da, db)
    Z, Za, Zb = patch8(rear.u[2], K, rc.s, wa, wb, da, db)
    Xa, Yb = Xa + rc.dx, Yb + rc.dy
    x = middle8(front.u[0], k, fc.s) - X - A * rc.dx + (fc.x0 + (i + 0.5) * fc.dx - rc.x0)
    y = middle8(front.u[1], k, fc.s) - Y - B * rc.dy + (fc.y0 + (j + 0.5) * fc.dy - rc.y0) + rank * fc.dy
    z = middle8(front.u[2], k, fc.s) - Z - pair.apart
    n_x, n_y, n_z = Ya * Zb - Za * Yb, Za * Xb - Xa * Zb, Xa * Yb - Ya * Xb
    square, tiny, thick = n_x * n_x + n_y * n_y + n_z * n_z, 1e-6 * rc.dx * rc.dy, pair.thickness
    size = sqrt(square)
    along, far = (n_x * x + n_y * y + n_z * z) / size, x * x + y * y + z * z
    depth = thick + along
    slant = bits(above(far, 0.09 * thick * thick)) & bits(above(0.49 * far, along * along))
    deep = bits(above(load(pair.was, q), (1.0 - _CLOSE) * thick))
    fit &= bits(above(square, tiny * tiny)) & ~(held & (slant | deep))
    clear, inside = fit & bits(above(0.0, depth)), fit & bits(above(depth, 0.0))
    pressed = inside & ~slant & bits(above((1.0 - _CLOSE) * thick, depth)) & (held | bits(above(0.5 * thick, depth)))
    aa, ab, bb = Xa * Xa + Ya * Ya + Za * Za, Xa * Xb + Ya * Yb + Za * Zb, Xb * Xb + Yb * Yb + Zb * Zb
    ra, rb = Xa * x + Ya * y + Za * z, Xb * x + Yb * y + Zb * z
    area, near = most(Xa * Yb - Xb * Ya, 0.01 * rc.dx * rc.dy), above(depth, -0.5 * thick)
    go = where(near, (bb * ra - ab * rb) / square, (Yb * x - Xb * y) / area)
    turn = where(near, (aa * rb - ab * ra) / square, (Xa * y - Ya * x) / area)
    sure = 0
    if pressed != 0:
        Xaa, Xab, Xbb = curved8(rear.u[0], K, rc.s, wa, wb, da, db, ca, cb)
        Yaa, Yab, Ybb = curved8(rear.u[1], K, rc.s, wa, wb, da, db, ca, cb)
        Zaa, Zab, Zbb = curved8(rear.u[2], K, rc.s, wa, wb, da, db, ca, cb)
        aa = aa - (x * Xaa + y * Yaa + z * Zaa)
        ab = ab - (x * Xab + y * Yab + z * Zab)
        bb = bb - (x * Xbb + y * Ybb + z * Zbb)
        det = aa * bb - ab * ab
        sure = pressed & bits(above(det, 0.1 * square)) & bits(above(aa, 0.0))
        go = where(lanes_of(sure), (bb * ra - ab * rb) / det, go)
        turn = where(lanes_of(sure), (aa * rb - ab * ra) / det, turn)
        pressed &= ~bits(above(most(fabs(go), fabs(turn)), _LEAP))
    done, before_a, before_b = clear | pressed, load(pair.foot[0], q), load(pair.foot[1], q)
    low_a, low_b = -0.5 if rc.mirror_x else 0.0, -0.5 if rc.mirror_y else 0.0
    A2 = most(least(A + most(least(go, _STEP), -_STEP), float(rc.ni)), low_a)
    B2 = most(least(B + most(least(turn, _STEP), -_STEP), float(rc.nj)), low_b)
    keep(pair.foot[0], q, where(lanes_of(done), A2, before_a), count)
    keep(pair.foot[1], q, where(lanes_of(done), B2, before_b), count)
    later = now + 1.0 + least(floor((0.0 - depth) / nearer), float(_LONGEST))
    keep(pair.until, q, where(lanes_of(clear), later, load(pair.until, q)), count)
    energy = 0.0
    if pressed | (held & clear) != 0:
        steady = lanes_of(pressed & held & sure)
        remember(pair.going[0], q, where(steady, most(least(A2 - before_a, _STEP), -_STEP), 0.0), done, count)
        remember(pair.going[1], q, where(steady, most(least(B2 - before_b, _STEP), -_STEP), 0.0), done, count)
        for m in range(count):
            if (done >> m) & 1:
                pair.status[q + m] = TOUCHING if (pressed >> m) & 1 else FREE
    if pressed != 0:
        remember(pair.was, q, depth, pressed, count)
        remember(pair.slack, q, least(where(lanes_of(held), load(pair.slack, q), 0.0), depth), pressed, count)
        n_x, n_y, n_z = n_x / size, n_y / size, n_z / size
        remember(pair.normal[0], q, n_x, pressed, count)
        remember(pair.normal[1], q, n_y, pressed, count)
        remember(pair.normal[2], q, n_z, pressed, count)
        if highest(where(lanes_of(pressed), depth, 0.0)) > pair.energy[DEEPEST]:
            for m in range(count):
                if (pressed >> m) & 1 and pair.was[q + m] > pair.energy[DEEPEST]:
                    pair.energy[DEEPEST], pair.energy[PLACE] = pair.was[q + m], q + m
        v_x = middle8(front.v[0], k, fc.s) - across8(rear.v[0], K, rc.s, wa, wb)
        v_y = middle8(front.v[1], k, fc.s) - across8(rear.v[1], K, rc.s, wa, wb)
        v_z = middle8(front.v[2], k, fc.s) - across8(rear.v[2], K, rc.s, wa, wb)
        slack = least(where(lanes_of(held), load(pair.slack, q), 0.0), depth)
        part = least(thick / most(thick - slack, 0.1 * thick), _STIFFER)
        part, squeezed = where(above(slack, 0.0), part, 1.0), depth - slack
        f = most(force(pair, part, squeezed, splat(pair.damping), n_x * v_x + n_y * v_y + n_z * v_z), 0.0)
        f = where(lanes_of(pressed), f, 0.0)
        energy = total(where(lanes_of(pressed), 0.5 * part * pair.stiffness * squeezed * squeezed, 0.0))
        if bits(above(f, 0.0)) != 0:
            push8(fc, rc, pair, i, j, int(I0) - 1, int(J0) - 1, f * n_x, f * n_y, f * n_z, wa, wb)
    return (due & ~done) | (inside & ~pressed), energy


@kernel(_nrt=False, forceinline=True)
def whole8(rear, rc, pair, q, count, fit):
    """Those of eight points that are not beside torn cloth, of either ply."""
    if pair.tears[1] > 0 or rear.counter[FAILURES] > 0:
        for m in range(count):
            a, b = pair.foot[0][q + m] + pair.going[0][q + m], pair.foot[1][q + m] + pair.going[1][q + m]
            if (fit >> m) & 1 and (pair.torn[q + m] or not whole_about(rear, rc, max(a, 0.0), max(b, 0.0))):
                fit &= ~(1 << m)
    return fit


@kernel(_nrt=False, forceinline=True)
def remember(array, q, value, which, count):
    """Write those of eight numbers whose bits are set."""
    keep(array, q, where(lanes_of(which), value, load(array, q)), count)


@kernel(_nrt=False, forceinline=True)
def force(pair, part, squeezed, drag, closing):
    """[N] of the springs and dampers of points that are squeezed, and come nearer at the speed `closing`."""
    return part * pair.stiffness * squeezed + drag * closing


@kernel(_nrt=False, forceinline=True)
def push8(fc, rc, pair, i, j, I, J, f_x, f_y, f_z, wa, wb):
    """Give the forces of eight points to the nodes of both plies: those of the front one begin at (i, j), of the rear
    one at (I, J)."""
    k, K = i * fc.s + j, I * rc.s + J
    touched = pair.front_touched
    touched[0], touched[1] = min(touched[0], i), max(touched[1], i + 2)
    touched[2], touched[3] = min(touched[2], j), max(touched[3], min(j + WIDTH + 1, fc.s))
    touched = pair.rear_touched
    touched[0], touched[1] = min(touched[0], I), max(touched[1], min(I + 4, rc.ni + 1))
    touched[2], touched[3] = min(touched[2], max(J, 0)), max(touched[3], min(J + WIDTH + 3, rc.s))
    share8(pair.on_front[0], k, fc.s, 0.0 - f_x)
    share8(pair.on_front[1], k, fc.s, 0.0 - f_y)
    share8(pair.on_front[2], k, fc.s, 0.0 - f_z)
    spread8(pair.on_rear[0], K, rc.s, f_x, wa, wb)
    spread8(pair.on_rear[1], K, rc.s, f_y, wa, wb)
    spread8(pair.on_rear[2], K, rc.s, f_z, wa, wb)


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
    if touches and pair.was[q] > (1.0 - _CLOSE) * pair.thickness:  # so deep that it may come through, or has
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
    A2, B2 = A + min(max(go, -_STEP), _STEP), B + min(max(turn, -_STEP), _STEP)
    pair.foot[0][q] = min(max(A2, low_a), float(rc.ni))
    pair.foot[1][q] = min(max(B2, low_b), float(rc.nj))
    pair.going[0][q] = pair.going[1][q] = 0.0
    lost, leapt = pair.status[q] == LOST, depth > 0.0 and max(abs(go), abs(turn)) > _LEAP
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
    if not touches and smooth and not whole and depth > (1.0 - _CLOSE) * pair.thickness:
        return 0.0, 0.0  # it has come from a hole, edge on, and is on no side yet
    if touches and smooth and depth > pair.thickness and left_x == 1.0 and left_y == 1.0:
        pair.energy[PASSED], pair.energy[WHERE] = pair.energy[PASSED] + 1.0, q
    if lost:
        pair.slack[q] = max(depth - (pair.was[q] - pair.slack[q]), 0.0)
    elif not touches:
        pair.slack[q] = depth if depth > 0.5 * pair.thickness and pair.form != NODES else 0.0
    elif sure:
        pair.going[0][q] = min(max(pair.foot[0][q] - before_a, -_STEP), _STEP)
        pair.going[1][q] = min(max(pair.foot[1][q] - before_b, -_STEP), _STEP)
    pair.status[q] = TOUCHING
    pair.normal[0][q], pair.normal[1][q], pair.normal[2][q] = n_x, n_y, n_z
    pair.was[q], pair.slack[q] = depth, min(pair.slack[q], depth)
    squeezed, part = depth - pair.slack[q], 0.5 if torn else 1.0
    if pair.start == 0.0:  # half an element, or a quarter, is modelled about points on planes of symmetry
        part *= (0.5 if a == 0.0 and fc.mirror_x else 1.0) * (0.5 if b == 0.0 and fc.mirror_y else 1.0)
    drag = part * pair.damping
    if pair.slack[q] > 0.0:  # what is left of the thickness has to hold as much
        part *= min(_STIFFER, pair.thickness / max(pair.thickness - pair.slack[q], 0.1 * pair.thickness))
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
    f = max(0.0, force(pair, part, squeezed, drag, n_x * v_x + n_y * v_y + n_z * v_z))
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
