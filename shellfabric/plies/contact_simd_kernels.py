"""Contact of plies, eight points at once: most of what `ply_contact_kernels.touch` is asked for.

Points of neighbouring elements are side by side, and so are their feet, to within a node: eight of them lie over four
rows of four nodes each, that of the next a slot further. Each has its weights at three of the four and none at the
other, since in aligned plies the feet are where two segments of the spline meet, some on this side of it and some on
that. What is found is the same as of one point at a time, to round-off. All that asks for more than a formula is left
to `touch`: torn cloth, rims, planes of symmetry, folds, lost feet, and what is so deep that it might have come through.
"""

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    above,
    bits,
    fabs,
    first,
    floor,
    highest,
    keep,
    lanes_of,
    least,
    load,
    most,
    some,
    splat,
    sqrt,
    those,
    total,
    where,
)
from shellfabric.panel.step_kernels import FAILURES
from shellfabric.plies.surface_kernels import across8, bases8, curved8, middle8, patch8, share8, spread8, whole_about

TAKEN, SPRING, DEEPEST, PLACE, PASSED, WHERE, WHEN, SQUEEZED = range(8)  # of pair.energy
FREE, TOUCHING, LOST = 0, 1, 2  # of pair.status; a point whose foot leaps or lies aside is lost until it has one again
CLOSE, STIFFER = 0.15, 3.0  # [thicknesses] where a point may come through; most that a spring is stiffened
# [thicknesses] that a depth may change beside the motion: sliding by a tenth of an element over a bend as narrow as an
# element makes a few hundredths (second order), another fold or side several tenths
JUMP = 0.1
STEP, LEAP = 0.25, 0.2  # [elements] longest step of a foot; one so long has none
LONGEST = 8  # most steps that a point is left alone


@kernel(_nrt=False, forceinline=True)
def touch8(front, fc, rear, rc, pair, q, i, j, count, nearer, now, due):
    """`touch` for those of the points in the middles of the elements (i, j) .. (i, j + count) with which nothing is
    the matter, eight at once: whole cloth on whole cloth, feet side by side and away from rims and planes of symmetry,
    not lost, in no fold, not so deep that it might come through, and not deeper at once than motion may have made it.

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
    tall = some(above(where(lanes_of(fit), I, 0.0), 0.5))
    (wa, da, ca), (wb, db, cb) = bases8(r, above(I, 0.5)), bases8(t, above(J, 0.5))
    X, Xa, Xb = patch8(rear.u[0], K, rc.s, wa, wb, da, db, tall)
    Y, Ya, Yb = patch8(rear.u[1], K, rc.s, wa, wb, da, db, tall)
    Z, Za, Zb = patch8(rear.u[2], K, rc.s, wa, wb, da, db, tall)
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
    was = load(pair.was, q)
    deep = bits(above(was, (1.0 - CLOSE) * thick))
    slow = bits(above(JUMP * thick, fabs(depth - where(lanes_of(held), was, 0.0))))
    fit &= bits(above(square, tiny * tiny)) & ~(held & (slant | deep))
    clear, inside = fit & bits(above(0.0, depth)), fit & bits(above(depth, 0.0))
    pressed = inside & ~slant & bits(above((1.0 - CLOSE) * thick, depth)) & slow
    aa, ab, bb = Xa * Xa + Ya * Ya + Za * Za, Xa * Xb + Ya * Yb + Za * Zb, Xb * Xb + Yb * Yb + Zb * Zb
    ra, rb = Xa * x + Ya * y + Za * z, Xb * x + Yb * y + Zb * z
    area, near = most(Xa * Yb - Xb * Ya, 0.01 * rc.dx * rc.dy), above(depth, -0.5 * thick)
    over = 1.0 / where(near, square, area)
    go = where(near, bb * ra - ab * rb, Yb * x - Xb * y) * over
    turn = where(near, aa * rb - ab * ra, Xa * y - Ya * x) * over
    sure = 0
    if pressed != 0:
        Xaa, Xab, Xbb = curved8(rear.u[0], K, rc.s, wa, wb, da, db, ca, cb, tall)
        Yaa, Yab, Ybb = curved8(rear.u[1], K, rc.s, wa, wb, da, db, ca, cb, tall)
        Zaa, Zab, Zbb = curved8(rear.u[2], K, rc.s, wa, wb, da, db, ca, cb, tall)
        aa = aa - (x * Xaa + y * Yaa + z * Zaa)
        ab = ab - (x * Xab + y * Yab + z * Zab)
        bb = bb - (x * Xbb + y * Ybb + z * Zbb)
        det = aa * bb - ab * ab
        sure = pressed & bits(above(det, 0.1 * square)) & bits(above(aa, 0.0))
        go = where(lanes_of(sure), (bb * ra - ab * rb) / det, go)
        turn = where(lanes_of(sure), (aa * rb - ab * ra) / det, turn)
        pressed &= ~bits(above(most(fabs(go), fabs(turn)), LEAP))
    done, before_a, before_b = clear | pressed, load(pair.foot[0], q), load(pair.foot[1], q)
    low_a, low_b = -0.5 if rc.mirror_x else 0.0, -0.5 if rc.mirror_y else 0.0
    A2 = most(least(A + most(least(go, STEP), -STEP), float(rc.ni)), low_a)
    B2 = most(least(B + most(least(turn, STEP), -STEP), float(rc.nj)), low_b)
    keep(pair.foot[0], q, where(lanes_of(done), A2, before_a), count)
    keep(pair.foot[1], q, where(lanes_of(done), B2, before_b), count)
    later = now + 1.0 + least(floor(depth * (-1.0 / nearer)), float(LONGEST))
    keep(pair.until, q, where(lanes_of(clear), later, where(lanes_of(inside), now, load(pair.until, q))), count)
    energy = 0.0
    if pressed | (held & clear) != 0:
        steady = lanes_of(pressed & held & sure)
        remember(pair.going[0], q, where(steady, most(least(A2 - before_a, STEP), -STEP), 0.0), done, count)
        remember(pair.going[1], q, where(steady, most(least(B2 - before_b, STEP), -STEP), 0.0), done, count)
        for m in range(count):
            if (done >> m) & 1:
                pair.status[q + m], pair.faceted[q + m] = TOUCHING if (pressed >> m) & 1 else FREE, 0
    if pressed != 0:
        n, at = (n_x / size, n_y / size, n_z / size), (i, j, int(I0) - 1, int(J0) - 1)
        energy = press8(front, fc, rear, rc, pair, q, at, count, pressed, held, depth, n, wa, wb, tall)
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
def press8(front, fc, rear, rc, pair, q, at, count, pressed, held, depth, n, wa, wb, tall):
    """Let those of eight points push whose bits are set in `pressed`; the energy in their springs.

    at : where the nodes begin, (i, j) of the front ply's and of the rear one's; n : the normals; wa, wb : the weights
    of the feet, `tall` where they are over four lines of nodes
    """
    (i, j, I, J), thick = at, pair.thickness
    slack = least(where(lanes_of(held), load(pair.slack, q), 0.0), depth)
    remember(pair.was, q, depth, pressed, count)
    remember(pair.slack, q, slack, pressed, count)
    for c in range(3):
        remember(pair.normal[c], q, n[c], pressed, count)
    if highest(where(lanes_of(pressed), depth, 0.0)) > pair.energy[DEEPEST]:
        for m in range(count):
            if (pressed >> m) & 1 and pair.was[q + m] > pair.energy[DEEPEST]:
                pair.energy[DEEPEST], pair.energy[PLACE] = pair.was[q + m], q + m
    k, K, closing = i * fc.s + j, I * rc.s + J, splat(0.0)
    for c in range(3):
        closing = closing + n[c] * (middle8(front.v[c], k, fc.s) - across8(rear.v[c], K, rc.s, wa, wb, tall))
    # what is left of the thickness has to hold as much
    stiffer = least(thick / most(thick - slack, 0.1 * thick), STIFFER)
    part, squeezed = where(above(slack, 0.0), stiffer, 1.0), depth - slack
    pair.energy[SQUEEZED] = max(pair.energy[SQUEEZED], highest(where(lanes_of(pressed), squeezed, 0.0)))
    f = where(lanes_of(pressed), most(force(pair, part, squeezed, pair.damping, closing), 0.0), 0.0)
    if bits(above(f, 0.0)) != 0:
        widen(pair.front_touched, i, i + 2, j, min(j + WIDTH + 1, fc.s))
        widen(pair.rear_touched, I, I + (4 if tall else 3), max(J, 0), min(J + WIDTH + 3, rc.s))
        for c in range(3):
            share8(pair.on_front[c], k, fc.s, 0.0 - f * n[c])
            spread8(pair.on_rear[c], K, rc.s, f * n[c], wa, wb, tall)
    return total(where(lanes_of(pressed), 0.5 * part * pair.stiffness * squeezed * squeezed, 0.0))


@kernel(_nrt=False, forceinline=True)
def widen(touched, i0, i1, j0, j1):
    """Widen the window of nodes with forces to i0 .. i1 - 1, j0 .. j1 - 1."""
    touched[0], touched[1] = min(touched[0], i0), max(touched[1], i1)
    touched[2], touched[3] = min(touched[2], j0), max(touched[3], j1)


@kernel(_nrt=False, forceinline=True)
def remember(array, q, value, which, count):
    """Write those of eight numbers whose bits are set."""
    keep(array, q, where(lanes_of(which), value, load(array, q)), count)


@kernel(_nrt=False, forceinline=True)
def force(pair, part, squeezed, drag, closing):
    """[N] of the springs and dampers of points that are squeezed, and come nearer at the speed `closing`."""
    return part * pair.stiffness * squeezed + drag * closing
