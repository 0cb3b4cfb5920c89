"""Energies of an audit, eight nodes, edges or quadrilaterals at a time: of motion, and of what whole cloth stores.

Those of yarns and trellis are the energies of `failure_kernels.stored_energy` where no yarn has failed and every edge
has its four crossing edges. An audit looks at all of the cloth: one by one it would cost as much as the steps between
two audits.
"""

from shellfabric.cloth.membrane_kernels import along, angle_of, beside, lever
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    above,
    at,
    cells,
    columns8,
    entries,
    first,
    floor,
    fma,
    least,
    load,
    most,
    splat,
    total,
    where,
)

WARP = 0


@kernel(_nrt=False)
def motion(const, state, i):
    """[J] kinetic energy of the free nodes of row i, m v(n-1/2) v(n+1/2) / 2."""
    found = splat(0.0)
    for j in range(0, const.s, WIDTH):
        k = i * const.s + j
        inverse = load(state.inverse_mass, k)
        per = const.dt * inverse
        free = where(above(inverse, 0.0), 0.5 * load(state.mass, k), 0.0)
        for c in range(3):
            v, f = load(state.v[c], k), load(state.g0[c], k) + load(state.g1[c], k) + load(state.contact[c], k)
            if const.backed:
                f = f + load(state.behind[c], k)
            found = found + where(first(const.s - j), free * v * fma(per, f, v), 0.0)
    return total(found)


@kernel(_nrt=False)
def edges(const, state, family, i, begin, end):
    """[J] of the edges (i, begin) .. (i, end - 1) of a family, all of which have four crossing edges."""
    x0, rx, top1, y0, ry, top2, across = const.grid
    own, other, s = state.L[family], state.L[1 - family], const.s
    found, w = splat(0.0), const.w1 if family == WARP else const.w2
    for j in range(begin, end, WIDTH):
        k = i * s + j
        if family == WARP:
            mean = beside(
                const.split2, k, load(other, k - 1), load(other, k), load(other, k + s - 1), load(other, k + s)
            )
            l1, l2 = load(own, k), mean
        else:
            mean = along(
                const.split1, k, load(other, k - s), load(other, k - s + 1), load(other, k), load(other, k + 1)
            )
            l1, l2 = mean, load(own, k)
        p, q = most((l1 - x0) * rx, 0.0), most((l2 - y0) * ry, 0.0)
        cell1, cell2 = floor(least(p, top1)), floor(least(q, top2))
        row = cells(fma(cell1, across, cell2))
        table, level, p, q = columns8(const.spline, row), entries(const.level, row), p - cell1, q - cell2
        one, two = fma(q, fma(q, table[6], table[4]), table[0]), fma(q, fma(q, table[7], table[5]), table[1])
        W = fma(p, fma(p, two, one), fma(q, fma(q, table[3], table[2]), level))
        found = found + where(first(end - j), load(state.y[family], k) * W, 0.0)
    return 0.25 / w * total(found)


@kernel(_nrt=False)
def trellis(const, state, i):
    """[J] of the quadrilaterals of row i."""
    s, G1, G2, gamma1, gamma2 = const.s, const.G1, const.G2, const.gamma1, const.gamma2
    found, span, L1, L2 = splat(0.0), const.gamma2 - const.gamma1, state.L[0], state.L[1]
    for j in range(0, const.nj, WIDTH):
        k, dot = i * s + j, splat(0.0)
        for c in range(3):
            u = state.u[c]
            rise, run = load(u, k + s + 1) - load(u, k), load(u, k + s) - load(u, k + 1)
            a, b = at(const.rx0, k) * (rise + run), at(const.ry0, k) * (rise - run)
            dot = fma(a + (2.0 if c == 0 else 0.0), b + (2.0 if c == 1 else 0.0), dot)
        one, other = lever(load(L1, k) + load(L1, k + 1))[0], lever(load(L2, k) + load(L2, k + s))[0]
        sine = dot / (one * other)
        angle = angle_of(sine)
        middle, beyond = least(most(angle - gamma1, 0.0), span), most(angle - gamma2, 0.0)
        U = (0.5 * G1) * angle * angle + ((G2 - G1) / (6.0 * span)) * middle * middle * middle
        U = U + (0.5 * (G2 - G1)) * beyond * (beyond + span)
        found = found + where(first(const.nj - j), at(const.V, k) * U, 0.0)
    return total(found)
