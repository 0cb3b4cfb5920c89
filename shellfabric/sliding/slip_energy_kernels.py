"""Kinetic energy of the slip, and what of it leaves with the ends of yarns.

A node's yarn of mass m1 moves at v + t1 q1. Of its kinetic energy the node's part, m v^2 / 2, is counted with the
nodes; the rest, m1 q1 t1 . v + m1 q1^2 / 2, here.
"""

import numpy as np

from shellfabric.jit.compile import kernel

WARP, WEFT = 0, 1
FRICTION, STOPS, RESIDUAL = (
    0,
    1,
    2,
)  # of slip.work: of friction, of the bounds of a flux, left by the iteration


@kernel(_nrt=False)
def kinetic_energy(state, const, slip):
    """[J] of the slip: that of the yarns' material, whose velocity is v + t q, less that of the nodes."""
    total, s = 0.0, const.row_stride
    for family in range(2):
        for i in range(const.ni + 1):
            for j in range(s):
                k = np.uint64(i * s + j)
                before, after = slip.q_before[family][k], slip.q[family][k]
                if before == 0.0 and after == 0.0:
                    continue
                kick, along, moved = state.dt_over_mass[k], 0.0, 0.0
                t = unit_tangent(state, const, family, i, j)
                for c in range(3):
                    f = state.f_int[c][k] + state.f_int_above[c][k] + state.f_contact[c][k]
                    along += t[c] * state.v[c][k]
                    moved += t[c] * (state.v[c][k] + kick * f)
                total += (
                    0.5 * slip.mass[family][k] * (along * after + moved * before + before * after)
                )
    return total


@kernel(_nrt=False)
def unit_tangent(state, const, family, i, j):
    """Unit tangent of a yarn at node (i, j), as `slip_kernels.tangents` has it; zero where the yarn has left."""
    return chord(
        state,
        const,
        family,
        i,
        j,
        state.intact_fraction[family],
        (state.intact_fraction[family], 0.0),
    )


@kernel(_nrt=False)
def chord(state, const, family, i, j, whole, earlier):
    """Unit vector along the segments of a yarn about node (i, j), of those that are whole; zero where there are none.

    whole : of a segment, above 0 where it is
    earlier : (of a segment, above 1 where it counts besides; how far back in time [s] the positions are)
    """
    s, step = const.row_stride, const.row_stride if family == WARP else 1
    k, place, last = i * s + j, i if family == WARP else j, const.ni if family == WARP else const.nj
    side, (removed, back_in_time) = const.dx if family == WARP else const.dy, earlier
    x, y, z = 0.0, 0.0, 0.0
    for back in range(2):
        near = k - back * step
        if place - back < 0 or place - back >= last:
            continue
        n, far = np.uint64(near), np.uint64(near + step)
        if not (whole[n] > 0.0 or removed[n] > 1):
            continue
        x += state.u[0][far] - state.u[0][n] - back_in_time * (state.v[0][far] - state.v[0][n])
        y += state.u[1][far] - state.u[1][n] - back_in_time * (state.v[1][far] - state.v[1][n])
        z += state.u[2][far] - state.u[2][n] - back_in_time * (state.v[2][far] - state.v[2][n])
        x, y = (x + side, y) if family == WARP else (x, y + side)
    length = (x * x + y * y + z * z) ** 0.5
    return (x / length, y / length, z / length) if length > 0.0 else (0.0, 0.0, 0.0)


@kernel(_nrt=False)
def along(state, const, slip, node, before):
    """t . v of the yarn `family` at node (i, j), with the tangent of the segments that are whole.

    node : (family, i, j)
    before : with that of half a step ago, of the segments too that have been removed in this step
    """
    family, i, j = node
    whole, k = state.intact_fraction[family], np.uint64(i * const.row_stride + j)
    t = (
        chord(state, const, family, i, j, whole, (slip.removed[family], 0.5 * const.dt))
        if before
        else chord(state, const, family, i, j, whole, (whole, 0.0))
    )
    return t[0] * state.v[0][k] + t[1] * state.v[1][k] + t[2] * state.v[2][k]


@kernel(_nrt=False)
def leave_removed(state, const, slip):
    """[J] kinetic energy that the slip loses with the segments removed in this step, slip.removed; ends fluxes.

    At a node that a yarn has left, its flux ends: kinetic energy and momentum of the end go with it. At a node that
    keeps one segment, the tangent turns to that one.
    """
    lost, s = 0.0, const.row_stride
    for family in range(2):
        step, removed, whole = (
            s if family == WARP else 1,
            slip.removed[family],
            state.intact_fraction[family],
        )
        for i in range(const.ni + 1):
            for j in range(s):
                k, inner = np.uint64(i * s + j), (i if family == WARP else j) > 0
                behind, q = np.uint64(np.int64(k) - step) if inner else k, slip.q[family][k]
                if q == 0.0 or not (removed[k] > 1 or removed[behind] > 1):
                    continue
                lost += slip.mass[family][k] * q * along(state, const, slip, (family, i, j), True)
                if whole[k] > 0.0 or (inner and whole[behind] > 0.0):
                    lost -= (
                        slip.mass[family][k] * q * along(state, const, slip, (family, i, j), False)
                    )
                    continue
                lost += slip.mass[family][k] * 0.5 * q * q
                end_flux(const, slip, family, k)
        for n in range(removed.size):
            removed[n] = min(removed[n], np.uint8(1))
    return lost


@kernel(_nrt=False)
def end_flux(const, slip, family, k):
    """End the flux at a node; the forces of friction of the step before have acted for half a step more."""
    half = 0.5 * const.dt * slip.q[family][k]
    slip.work[FRICTION] += half * slip.friction[family][k]
    slip.work[STOPS] += half * slip.stop[family][k]
    slip.work[RESIDUAL] += half * slip.residual[family][k]
    slip.q[family][k] = slip.q_before[family][k] = 0.0
    slip.friction[family][k] = slip.stop[family][k] = slip.residual[family][k] = 0.0
