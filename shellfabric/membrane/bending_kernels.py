"""Resistance of yarns to bending, out of the fabric's plane and in it, at the nodes along each grid
line (docs/theory-panel.md, "Bending and packing"). With t1, t2 the unit tangents of the segments
e = l t before and after a node, and B = n EI / L of the n yarns that the line stands for,

    1/2 B |t2 - t1|^2 = B (1 - t1.t2),   dE/de1 = -B (t2 - (t1.t2) t1) / l1,   dE/de2 = -B (t1 - (t1.t2) t2) / l2

A clamp has 2 B, over half a segment. On a plane of symmetry a tangent turns against its own image;
half of that turn is the modelled part's. At a free end nothing turns. A turn keeps the part of it
that both its segments keep (see `membrane_kernels` for alpha).
"""

import math

import numpy as np
from numba import types
from numba.extending import overload

from shellfabric.jit.compile import kernel
from shellfabric.state import WARP, WEFT, PartTable, unit

FREE_END = 0
SYMMETRY_END = 1
CLAMPED_END = 2


def rest_length(side, inverse, k):
    """Return the length at rest [m] of the segment at slot k: `side` if all are alike, else one
    over what the slot has."""


@overload(rest_length, inline="always")
def _rest_length(side, inverse, k):
    if isinstance(inverse, types.Float):
        return lambda side, inverse, k: side
    return lambda side, inverse, k: 1.0 / inverse[k]


def node_stiffness(bending, family, k, rim):
    """Return B [J] of the node at slot k, on a line at the `rim` or within: a number for each
    family, or one for each slot."""


@overload(node_stiffness, inline="always")
def _node_stiffness(bending, family, k, rim):
    if isinstance(bending, types.UniTuple):
        return lambda bending, family, k, rim: bending[family][k]

    def of_line(bending, family, k, rim):
        if rim:
            return 0.5 * bending[family]
        return bending[family]

    return of_line


def bends(bending, family):
    """Tell whether yarns of a family resist bending."""


@overload(bends, inline="always")
def _bends(bending, family):
    if isinstance(bending, types.Array):
        return lambda bending, family: bending[family] > 0.0
    return lambda bending, family: bending[family][0] > 0.0


@kernel(_nrt=False)
def far_node(const, family, k):
    """Return the slot of the node at the end of the segment at slot k."""
    if family == WARP:
        return np.uint64(np.int64(k) + const.row_stride)
    return np.uint64(np.int64(k) + 1)


@kernel(_nrt=False)
def segment_tangent(state, const, family, k):
    """Compute the unit tangent (x, y, z) of the segment at slot k, and its length [m]."""
    far = far_node(const, family, k)
    x = state.u[0][far] - state.u[0][k]
    y = state.u[1][far] - state.u[1][k]
    z = state.u[2][far] - state.u[2][k]
    if family == WARP:
        x += rest_length(const.dx, const.inv_dx, k)
    else:
        y += rest_length(const.dy, const.inv_dy, k)
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length), length


@kernel(_nrt=False)
def add_bending_force(state, const, family, k, B, segment, other, cosine):
    """Add the forces of the energy B (1 - t.other) of the segment (t, length) at slot k, `other`
    being held."""
    t, length = segment
    far = far_node(const, family, k)
    for c in range(3):
        force = B * (other[c] - cosine * t[c]) / length
        state.f_int[c][k] -= force
        state.f_int[c][far] += force


@kernel(_nrt=False)
def end_bending(state, const, family, k, kind, B, acting):
    """Compute the bending energy [J] at the end of a yarn in a clamp or on a plane of symmetry; its
    only segment is at slot k."""
    segment = segment_tangent(state, const, family, k)
    axis = (1.0, 0.0, 0.0)
    if family == WEFT:
        axis = (0.0, 1.0, 0.0)
    along = segment[0][family]
    # in a clamp 2 B (1 - t.axis); by a plane of symmetry B / 2 (1 - t.image), t.image being
    # 2 (t.axis)^2 - 1
    energy = 2.0 * B * (1.0 - along)
    slope = 2.0 * B
    if kind == SYMMETRY_END:
        energy = B * (1.0 - along * along)
        slope *= along
    if acting:
        add_bending_force(state, const, family, k, slope, segment, axis, along)
    return energy


@kernel(_nrt=False)
def family_bending(state, const, family, first, last, acting):
    """Compute the bending energy [J] of one family at the nodes of the rows first .. last; add its
    forces if `acting`.

    A node's forces reach the nodes beside it.
    """
    total = 0.0
    for i in range(first, last + 1):
        for j in range(const.nj + 1):
            k = np.uint64(i * const.row_stride + j)
            if family == WARP:
                place = i
                end = const.ni
                before = np.uint64(np.int64(k) - const.row_stride)
                rim = j == 0 or j == const.nj
            else:
                place = j
                end = const.nj
                before = np.uint64(np.int64(k) - 1)
                rim = i == 0 or i == const.ni
            B = node_stiffness(const.bending, family, k, rim)
            if place == 0:
                total += yarn_end(state, const, family, k, const.yarn_ends[family, 0], B, acting)
            elif place == end:
                total += yarn_end(
                    state, const, family, before, const.yarn_ends[family, 1], B, acting
                )
            else:
                total += turn(state, const, family, before, k, B, acting)
    return total


@kernel(_nrt=False)
def yarn_end(state, const, family, k, kind, B, acting):
    """Compute the bending energy [J] at the end of a yarn, whose last segment is at slot k."""
    intact = state.intact_fraction[family][k]
    if kind == FREE_END or intact == 0.0:
        return 0.0
    return end_bending(state, const, family, k, kind, B * intact, acting)


@kernel(_nrt=False)
def turn(state, const, family, before, behind, B, acting):
    """Compute the energy [J] of the turn between two segments, given by their slots."""
    intact = state.intact_fraction[family]
    B *= min(intact[before], intact[behind])
    if B == 0.0:
        return 0.0
    one = segment_tangent(state, const, family, before)
    two = segment_tangent(state, const, family, behind)
    t1 = one[0]
    t2 = two[0]
    cosine = t1[0] * t2[0] + t1[1] * t2[1] + t1[2] * t2[2]
    if acting:
        add_bending_force(state, const, family, before, B, one, t2, cosine)
        add_bending_force(state, const, family, behind, B, two, t1, cosine)
    return B * (1.0 - cosine)


@unit("number", later=True, own=PartTable)
def bending_forces(state, const, own, first, last, acting):
    """Compute the bending energy [J] of the node rows first .. last; add its forces to state.f_int
    if `acting` (a unit of `parts.Part`, without a row)."""
    total = 0.0
    for family in range(2):
        if bends(const.bending, family):
            total += family_bending(state, const, family, first, last, acting)
    return total
