"""Kinetic energy of the slip, and what of it leaves with the ends of yarns.

A node's yarn of mass m1 moves at v + t1 q1. Of its kinetic energy the node's part, m v^2 / 2, is counted with the
nodes; the rest, m1 q1 t1 . v + m1 q1^2 / 2, here.
"""

import numpy as np

from shellfabric.jit.compile import kernel

WARP, WEFT = 0, 1


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
                total += 0.5 * slip.mass[family][k] * (along * after + moved * before + before * after)
    return total


@kernel(_nrt=False)
def unit_tangent(state, const, family, i, j):
    """Unit tangent of a yarn at node (i, j), as `tangents` has it; along failed segments where there are no others."""
    t = chord(state, const, family, i, j, True)
    return t if t[0] != 0.0 or t[1] != 0.0 or t[2] != 0.0 else chord(state, const, family, i, j, False)


@kernel(_nrt=False)
def chord(state, const, family, i, j, whole):
    """Unit vector along the segments of a yarn about node (i, j), of whole ones alone if `whole`; or zero."""
    s, step = const.row_stride, const.row_stride if family == WARP else 1
    k, place, last = i * s + j, i if family == WARP else j, const.ni if family == WARP else const.nj
    side = const.dx if family == WARP else const.dy
    x, y, z = 0.0, 0.0, 0.0
    for back in range(2):
        near = k - back * step
        if place - back < 0 or place - back >= last:
            continue
        if whole and state.intact_fraction[family][np.uint64(near)] == 0.0:
            continue
        far = np.uint64(near + step)
        x += state.u[0][far] - state.u[0][np.uint64(near)] + (side if family == WARP else 0.0)
        y += state.u[1][far] - state.u[1][np.uint64(near)] + (0.0 if family == WARP else side)
        z += state.u[2][far] - state.u[2][np.uint64(near)]
    length = (x * x + y * y + z * z) ** 0.5
    return (x / length, y / length, z / length) if length > 0.0 else (0.0, 0.0, 0.0)


@kernel(_nrt=False)
def drop_fluxes(state, const, slip):
    """End the fluxes at nodes that a yarn has left: [J] kinetic energy of its end, whose momentum leaves with it."""
    lost, s = 0.0, const.row_stride
    for family in range(2):
        step = s if family == WARP else 1
        for i in range(const.ni + 1):
            for j in range(s):
                k, inner = i * s + j, (i if family == WARP else j) > 0
                q = slip.q[family][np.uint64(k)]
                if q == 0.0 or state.intact_fraction[family][np.uint64(k)] > 0.0:
                    continue
                if inner and state.intact_fraction[family][np.uint64(k - step)] > 0.0:
                    continue
                t, along = chord(state, const, family, i, j, False), 0.0
                for c in range(3):
                    along += t[c] * state.v[c][np.uint64(k)]
                lost += slip.mass[family][np.uint64(k)] * q * (along + 0.5 * q)
                slip.q[family][np.uint64(k)] = slip.q_before[family][np.uint64(k)] = 0.0
                slip.friction[family][np.uint64(k)] = 0.0
    return lost
