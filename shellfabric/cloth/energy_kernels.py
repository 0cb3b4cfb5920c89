"""Energies of an audit, eight nodes, edges or quadrilaterals at a time: of motion, and of what whole fabric stores.

Those of yarns and trellis are the energies of `failure_kernels.stored_energy` where no yarn has failed and every edge
has its four crossing edges. An audit looks at all of the fabric: one by one it would cost as much as the steps between
two audits.
"""

from shellfabric.cloth.membrane_kernels import mean_crossing_warp, mean_crossing_weft
from shellfabric.cloth.table_kernels import potential_at
from shellfabric.cloth.trellis_kernels import arcsine, regularized_stretch
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    floor,
    fma,
    gather,
    gather_rows8,
    greater,
    head_mask,
    load,
    load_or_broadcast,
    maximum,
    minimum,
    reduce_add,
    to_int32,
    where,
)
from shellfabric.state import unit

WARP = 0


@unit("number")
def kinetic_energy(const, state, i):
    """[J] kinetic energy of the free nodes of row i, m v(n-1/2) v(n+1/2) / 2."""
    found = broadcast(0.0)
    for j in range(0, const.row_stride, WIDTH):
        k = i * const.row_stride + j
        inverse = load(state.inverse_mass, k)
        per = const.dt * inverse
        free = where(greater(inverse, 0.0), 0.5 * load(state.mass, k), 0.0)
        for c in range(3):
            v, f = (
                load(state.v[c], k),
                load(state.f_int[c], k)
                + load(state.f_int_above[c], k)
                + load(state.f_contact[c], k),
            )
            if const.has_backing:
                f = f + load(state.f_block_cloth[c], k)
            found = found + where(head_mask(const.row_stride - j), free * v * fma(per, f, v), 0.0)
    return reduce_add(found)


@unit("number")
def yarn_energy(const, state, family, i, begin, end):
    """[J] of the edges (i, begin) .. (i, end - 1) of a family, all of which have four crossing edges."""
    x0, rx, top1, y0, ry, top2, across = const.table_grid
    own, other, s = state.stretch[family], state.stretch[1 - family], const.row_stride
    found, w = broadcast(0.0), const.w1 if family == WARP else const.w2
    for j in range(begin, end, WIDTH):
        k = i * s + j
        if family == WARP:
            mean = mean_crossing_warp(
                const.mean_weight2,
                k,
                load(other, k - 1),
                load(other, k),
                load(other, k + s - 1),
                load(other, k + s),
            )
            l1, l2 = load(own, k), mean
        else:
            mean = mean_crossing_weft(
                const.mean_weight1,
                k,
                load(other, k - s),
                load(other, k - s + 1),
                load(other, k),
                load(other, k + 1),
            )
            l1, l2 = mean, load(own, k)
        p, q = maximum((l1 - x0) * rx, 0.0), maximum((l2 - y0) * ry, 0.0)
        cell1, cell2 = floor(minimum(p, top1)), floor(minimum(q, top2))
        row = to_int32(fma(cell1, across, cell2))
        table, level, p, q = (
            gather_rows8(const.potential_coefficients, row),
            gather(const.potential_constant, row),
            p - cell1,
            q - cell2,
        )
        over1, over2 = maximum(p - 1.0, 0.0), maximum(q - 1.0, 0.0)
        W = potential_at(
            minimum(p, 1.0), minimum(q, 1.0), over1, over2, table, level, const.table_beyond
        )
        found = found + where(head_mask(end - j), load(state.yarn_length[family], k) * W, 0.0)
    return 0.25 / w * reduce_add(found)


@unit("number")
def trellis_energy(const, state, i):
    """[J] of the quadrilaterals of row i."""
    s, G1, G2, gamma1, gamma2 = const.row_stride, const.G1, const.G2, const.gamma1, const.gamma2
    found, span, L1, L2 = (
        broadcast(0.0),
        const.gamma2 - const.gamma1,
        state.stretch[0],
        state.stretch[1],
    )
    for j in range(0, const.nj, WIDTH):
        k, dot = i * s + j, broadcast(0.0)
        for c in range(3):
            u = state.u[c]
            rise, run = load(u, k + s + 1) - load(u, k), load(u, k + s) - load(u, k + 1)
            a, b = (
                load_or_broadcast(const.inv_dx, k) * (rise + run),
                load_or_broadcast(const.inv_dy, k) * (rise - run),
            )
            dot = fma(a + (2.0 if c == 0 else 0.0), b + (2.0 if c == 1 else 0.0), dot)
        one, other = (
            regularized_stretch(load(L1, k) + load(L1, k + 1))[0],
            regularized_stretch(load(L2, k) + load(L2, k + s))[0],
        )
        sine = dot / (one * other)
        angle = arcsine(sine)
        middle, beyond = minimum(maximum(angle - gamma1, 0.0), span), maximum(angle - gamma2, 0.0)
        U = (0.5 * G1) * angle * angle + ((G2 - G1) / (6.0 * span)) * middle * middle * middle
        U = U + (0.5 * (G2 - G1)) * beyond * (beyond + span)
        found = found + where(
            head_mask(const.nj - j), load_or_broadcast(const.trellis_volume, k) * U, 0.0
        )
    return reduce_add(found)
