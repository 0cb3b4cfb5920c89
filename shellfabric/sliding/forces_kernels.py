"""Internal forces of a panel whose yarns slide through its nodes: the cell at effective stretches.

The segment of a yarn between two nodes holds `share` times the yarn that it holds at rest. Its effective stretch is

    x = Lambda / share

with Lambda the distance of its nodes over that at rest. The energy of the fabric is that of pinned crossovers at the
effective stretches, E_p(x), and for each segment the energy U(x) of its own yarn alone in proportion to the yarn that
it has gained:

    E = E_p(x) + sum (share - 1) U(x),     U = EA (2 w x - S0)^2 / 2 S0 where that is stretched, else none

The forces on the nodes and the configurational forces on the flux are the derivatives of this one energy:

    -dE/dLambda = -N / share                    N = dE/dx
    -dE/dshare  =  x N / share - U(x)           over the distance at rest: `config` [N], T (1 + e/2) of a straight yarn

The viscosity of a segment is that of its yarn, in proportion to the share. At share = 1 all are, digit by digit, what
`panel.element_kernels` computes. Where neighbouring crossing yarns touch (`lateral_force`) a segment resists being
shortened.
"""

import math

import numpy as np

from shellfabric.cloth import membrane_kernels
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    broadcast,
    fma,
    greater,
    head_mask,
    load,
    masked_store,
    maximum,
    reduce_add,
    store,
    where,
)
from shellfabric.panel import element_kernels
from shellfabric.panel.element_kernels import INTACT, REDO, VISCOUS, WORK


@kernel(_nrt=False)
def element_forces(state, const, slip, block, first, last, works):
    """Internal forces of the element rows first .. last - 1 of one block, as `element_kernels.element_forces`.

    works : (scratch, the same scratch with the effective stretches in the place of the stretches)
    """
    s, thin = const.row_stride, state.block_damage[block] != INTACT
    work, work_x = works
    k0, n = first * s, (last - first) * s
    n2 = n + s if last == const.ni else n
    edge_stretches(state, const, slip, first, last, thin, works)
    element_kernels.trellis_forces(state, const, first, last, thin, work)
    slack = element_kernels.potential_gradient(state, const, block, first, last, thin, work_x)
    if not slack:
        element_kernels.interpolate_tensions(state, const, block, first, last, thin, work_x)
    yarn_forces(state, const, slip, block, k0, n, n2, works)
    element_kernels.scatter_forces(state, const, block, first, last, work)


@kernel(_nrt=False)
def edge_stretches(state, const, slip, first, last, thin, works):
    """Edge vectors, stretches, effective stretches and their means, as `element_kernels.edge_stretches`."""
    s, (w, e) = const.row_stride, works
    low = max(first - 1, 0)
    m0, n = (low - first + 2) * s, (last - low + 1) * s
    membrane_kernels.edge_vectors(
        low * s,
        m0,
        n,
        s,
        state.u,
        (const.inv_dx, const.inv_dy),
        w.A,
        w.B,
        w.stretch1,
        w.inv_stretch1,
        w.stretch2,
        w.inv_stretch2,
    )
    membrane_kernels.reset_idle_slots(m0, n, s, w.B, w.stretch2, w.inv_stretch2)
    for j in range(0, n, WIDTH):
        k, m = low * s + j, m0 + j
        store(e.stretch1, m, load(w.stretch1, m) * load(slip.inv_share[0], k))
        store(e.stretch2, m, load(w.stretch2, m) * load(slip.inv_share[1], k))
    if first == 0:
        membrane_kernels.copy_row(s, 2 * s, s, w.stretch1)
        membrane_kernels.copy_row(s, 2 * s, s, e.stretch1)
    if last == const.ni:
        end = (last - first + 2) * s
        membrane_kernels.copy_row(s, end - s, end, w.stretch1)
        membrane_kernels.copy_row(s, end - s, end, e.stretch1)
    element_kernels.crossing_means(state, const, first, last, thin, e)


@kernel(_nrt=False)
def refresh_tensions(state, const, slip, first, last, works):
    """Update the stale tensions of the blocks first .. last - 1, as `element_kernels.refresh_tensions`."""
    for block in range(first, last):
        if state.tension_stale[block]:
            low, high = (
                max(state.active_rows[0], block * const.rows_per_block),
                min(state.active_rows[1], (block + 1) * const.rows_per_block),
            )
            edge_stretches(state, const, slip, low, high, False, works)
            element_kernels.interpolate_tensions(state, const, block, low, high, False, works[1])


@kernel(_nrt=False, inline="always")
def yarn_forces(state, const, slip, block, k0, n, n2, works):
    """Axial forces of the block's edges, their configurational forces and their work."""
    c, (w, e), s = const, works, const.row_stride
    again = state.block_damage[block] == REDO
    work1, viscous1 = family_forces(
        k0,
        2 * s,
        n,
        1,
        again,
        (c.inv_dx, c.cv1, c.dx, slip.lateral, slip.closest),
        (2.0 * c.w1, c.S01, c.EA1 / c.S01),
        (w.stretch1, w.inv_stretch1, e.stretch1, w.trellis_f1, w.N1),
        (state.stretch[0], state.N[0], state.dstretch[0], state.yarn_length[0]),
        (slip.x[0], slip.share[0], slip.inv_share[0], slip.config[0]),
        w.f_over_stretch1,
    )
    work2, viscous2 = family_forces(
        k0,
        2 * s,
        n2,
        s,
        again,
        (c.inv_dy, c.cv2, c.dy, slip.lateral, slip.closest),
        (2.0 * c.w2, c.S02, c.EA2 / c.S02),
        (w.stretch2, w.inv_stretch2, e.stretch2, w.trellis_f2, w.N2),
        (state.stretch[1], state.N[1], state.dstretch[1], state.yarn_length[1]),
        (slip.x[1], slip.share[1], slip.inv_share[1], slip.config[1]),
        w.f_over_stretch2,
    )
    if not again:
        state.energy_sums[block, WORK] += work1 + work2
        state.energy_sums[block, VISCOUS] += viscous1 + viscous2


@kernel(_nrt=False)
def family_forces(k0, m0, n, back, again, sides, yarn, edges, kept, slipping, on):
    """Forces of n edges of one family, as `membrane_kernels.yarn_forces`, and their configurational forces.

    sides : 1 / dX, viscosity, dX, stiffness of the lateral contact and stretch below which it acts
    yarn : cell length 2 w, unstretched length S0 and EA / S0
    edges : scratch: stretch, its inverse, effective stretch, what the trellis takes, force dE_p/dx
    kept : of the panel, overwritten: stretch, force, change of effective stretch; and length of yarn
    slipping : of the panel: effective stretch (overwritten), share, 1 / share, configurational force (overwritten)
    """
    work, viscous = broadcast(0.0), broadcast(0.0)
    (r, cv, side, lateral, closest), (cell, S0, k_alone) = sides, yarn
    l, inverse, effective, turned, N = edges
    L, P, D, y = kept
    X, share, inv_share, config = slipping
    per_side = 1.0 / side
    for j in range(0, n, WIDTH):
        k, m, left = k0 + j, m0 + j, n - j
        x, length, last, inv = load(effective, m), load(y, k), load(D, k), load(inv_share, k)
        stretch, held = load(l, m), load(share, k)
        slack = maximum(fma(x, cell, broadcast(-S0)), 0.0)
        alone = k_alone * slack
        force = fma(held - 1.0, alone, load(N, m))
        d = last if again else x - load(X, k)
        part = length * d if left >= WIDTH else where(head_mask(left), length * d, 0.0)
        work = fma(part, force + load(P, k), work)
        viscous = fma(part * held, d + last, viscous)
        drive = length * fma(cv * held, d, force)
        pull = drive * inv - (load(turned, m) + load(turned, m - back))
        if lateral > 0.0 and any_lane(greater(closest, stretch)):
            store(effective, m, pull)
            lateral_force(m, min(WIDTH, left), lateral, closest, l, y, k, effective)
            pull = load(effective, m)
            store(effective, m, x)
        store(on, m, r * load(inverse, m) * pull)
        masked_store(
            config, k, per_side * (x * inv * drive - (0.5 / cell) * length * alone * slack), left
        )
        masked_store(L, k, stretch, left)
        masked_store(X, k, x, left)
        masked_store(P, k, force, left)
        masked_store(D, k, d, left)
    return 0.5 * reduce_add(work), cv * (0.5 * reduce_add(viscous))


@kernel(_nrt=False)
def lateral_force(m, count, stiffness, closest, l, y, k, pull):
    """Lateral contact of neighbouring yarns: y K ln(l / closest) / l, added to the pull of edges shorter than that.

    It is the gradient of y K ln(l / closest)^2 / 2: of stiffness K over the spacing at first touch, and unbounded.
    """
    for n in range(count):
        stretch = l[m + n]
        if stretch < closest:
            pull[m + n] += y[np.uint64(k + n)] * stiffness * math.log(stretch / closest) / stretch


@kernel(_nrt=False)
def lateral_energy(state, const, slip):
    """[J] of the lateral contact of the whole panel."""
    total = 0.0
    if not slip.lateral > 0.0:
        return total
    for family in range(2):
        for k in range(np.uint64((const.ni + 1) * const.row_stride)):
            length, stretch = state.yarn_length[family][k], state.stretch[family][k]
            if length > 0.0 and stretch < slip.closest:
                closed = math.log(stretch / slip.closest)
                total += 0.5 * length * slip.lateral * closed * closed
    return total


@kernel(_nrt=False)
def gained_energy(state, const, slip, first, last):
    """[J] sum (share - 1) U(x) of the edges in the element rows first .. last - 1 and the weft at their far end."""
    total = 0.0
    for family in range(2):
        cell, S0, EA = (
            (2.0 * const.w1, const.S01, const.EA1)
            if family == 0
            else (2.0 * const.w2, const.S02, const.EA2)
        )
        for k in range(
            np.uint64(first * const.row_stride), np.uint64((last + 1) * const.row_stride)
        ):
            length, gained = state.yarn_length[family][k], slip.share[family][k] - 1.0
            if length > 0.0 and gained != 0.0:
                slack = max(cell * slip.x[family][k] - S0, 0.0)
                total += gained * length * 0.5 * EA * slack * slack / (S0 * cell)
    return total
