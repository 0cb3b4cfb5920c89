"""Resistance of yarns to bending, out of the fabric's plane and in it, at the nodes along each grid line.

With t1, t2 the unit tangents of the segments before and after a node, L their (mean) length at rest and B = n EI / L, n
being the yarns that the line stands for, the turn of the yarn stores

    1/2 B |t2 - t1|^2 = B (1 - t1.t2),          that is 1/2 (EI / L) (kappa L)^2 a yarn, with kappa L = 2 sin(turn / 2)

Forces are its exact gradient: on a segment e = l t

    dE/de1 = -B (t2 - (t1.t2) t1) / l1,         dE/de2 = -B (t1 - (t1.t2) t2) / l2

A rigid motion costs nothing. Where a yarn ends in a clamp its first tangent turns against that at rest, over half a
segment: 2 B. On a plane of symmetry it turns against its own image; half of that turn is the modelled part's. At a free
end nothing turns. A turn keeps the part of it that both its segments keep (see `membrane_kernels` for alpha).
"""

import math

import numpy as np
from numba import types
from numba.extending import overload

from shellfabric.jit.compile import kernel
from shellfabric.state import ModuleTable, unit

FREE_END, SYMMETRY_END, CLAMPED_END = 0, 1, 2


def rest_length(side, inverse, k):
    """Length at rest [m] of the segment at slot k: `side` where all are alike, else one over what the slot has."""


@overload(rest_length, inline="always")
def _rest_length(side, inverse, k):
    if isinstance(inverse, types.Float):
        return lambda side, inverse, k: side
    return lambda side, inverse, k: 1.0 / inverse[k]


def node_stiffness(bending, family, k, rim):
    """B [J] of the node at slot k, on a line at the `rim` or within: a number for each family, or one for each slot."""


@overload(node_stiffness, inline="always")
def _node_stiffness(bending, family, k, rim):
    if isinstance(bending, types.Array):
        return lambda bending, family, k, rim: bending[family] * (0.5 if rim else 1.0)
    return lambda bending, family, k, rim: bending[family][k]


def bends(bending, family):
    """Whether yarns of a family resist bending."""


@overload(bends, inline="always")
def _bends(bending, family):
    if isinstance(bending, types.Array):
        return lambda bending, family: bending[family] > 0.0
    return lambda bending, family: bending[family][0] > 0.0


@kernel(_nrt=False)
def segment_tangent(state, const, family, k):
    """Unit tangent (x, y, z) of the segment at slot k, and its length [m]."""
    u, far = state.u, np.uint64(np.int64(k) + (const.row_stride if family == 0 else 1))
    x = u[0][far] - u[0][k] + (rest_length(const.dx, const.inv_dx, k) if family == 0 else 0.0)
    y = u[1][far] - u[1][k] + (rest_length(const.dy, const.inv_dy, k) if family == 1 else 0.0)
    z = u[2][far] - u[2][k]
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length), length


@kernel(_nrt=False)
def add_bending_force(state, const, family, k, B, t, length, other, cosine):
    """Add the forces of the energy B (1 - t.other) of the segment at slot k, `other` being held."""
    far = np.uint64(np.int64(k) + (const.row_stride if family == 0 else 1))
    for c in range(3):
        force = B * (other[c] - cosine * t[c]) / length
        state.f_int[c][k] -= force
        state.f_int[c][far] += force


@kernel(_nrt=False)
def end_bending(state, const, family, own, kind, B, acting):
    """Bending energy [J] at the end of a yarn in a clamp or on a plane of symmetry; its only segment is at slot own."""
    t, length = segment_tangent(state, const, family, own)
    axis = (1.0, 0.0, 0.0) if family == 0 else (0.0, 1.0, 0.0)
    along = t[family]
    # in a clamp 2 B (1 - t.axis); by a plane of symmetry B / 2 (1 - t.image), with t.image = 2 (t.axis)^2 - 1
    if acting:
        add_bending_force(
            state,
            const,
            family,
            own,
            2.0 * B * (1.0 if kind == CLAMPED_END else along),
            t,
            length,
            axis,
            along,
        )
    return 2.0 * B * (1.0 - along) if kind == CLAMPED_END else B * (1.0 - along * along)


@kernel(_nrt=False)
def family_bending(state, const, family, first, last, acting):
    """Bending energy [J] of one family at the nodes of the rows first .. last; adds its forces if `acting`.

    A node's forces reach the nodes beside it.
    """
    step, n, lines = (
        (const.row_stride, const.ni, const.nj) if family == 0 else (1, const.nj, const.ni)
    )
    intact, total = state.intact_fraction[family], 0.0
    for i in range(first, last + 1):
        for j in range(const.nj + 1):
            at, line = (i, j) if family == 0 else (j, i)
            k = np.uint64(i * const.row_stride + j)
            low = np.uint64(np.int64(k) - step)
            B = node_stiffness(const.bending, family, k, line == 0 or line == lines)
            if at == 0 or at == n:
                own, kind = (
                    (k, const.yarn_ends[family, 0])
                    if at == 0
                    else (low, const.yarn_ends[family, 1])
                )
                if kind != FREE_END and intact[own] > 0.0:
                    total += end_bending(state, const, family, own, kind, B * intact[own], acting)
                continue
            B *= min(intact[low], intact[k])
            if B > 0.0:
                t1, l1 = segment_tangent(state, const, family, low)
                t2, l2 = segment_tangent(state, const, family, k)
                cosine = t1[0] * t2[0] + t1[1] * t2[1] + t1[2] * t2[2]
                total += B * (1.0 - cosine)
                if acting:
                    add_bending_force(state, const, family, low, B, t1, l1, t2, cosine)
                    add_bending_force(state, const, family, k, B, t2, l2, t1, cosine)
    return total


@unit("number", later=True, own=ModuleTable)
def bending_forces(state, const, own, first, last, acting):
    """Bending energy [J] of the node rows first .. last; adds its forces to state.f_int if `acting` (a unit of
    `panel.forces`, without a row)."""
    total = 0.0
    for family in range(2):
        if bends(const.bending, family):
            total += family_bending(state, const, family, first, last, acting)
    return total
