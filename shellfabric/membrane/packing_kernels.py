"""Packed fabric: an element keeps a share of its area at rest (docs/theory-panel.md, "Bending and
packing"; `fabrics.ply_laws.packing_stiffness`, `packed_area` of fabrics/data_sheet.toml).

    a = mean warp side / dx,     b = mean weft side / dy,     A / A0 = |a x b|

Forces are the gradient of U: their sum and their moments vanish. They are softer than the yarns by
E_c over E, so the time step stays. An element without a yarn of either family, or a torn one that
is drawn out to twice its size, is no fabric any more, and keeps nothing.

Which blocks have packed elements is found eight elements at a time while their sides are in cache
(`has_packed`); only these blocks are then looked at element by element.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, broadcast, fma, head_mask, load, minimum, reduce_max, where
from shellfabric.membrane.bending_kernels import rest_length
from shellfabric.membrane.membrane_kernels import ONE, scratch_slot
from shellfabric.state import DRAWN_OUT, RESOLVED, PartTable, unit

_MOST_LENGTH = 2.0  # of a diagonal of a torn element that is still fabric, over its length at rest
_LEAST_AREA = 1e-9  # over that at rest: the normal of a smaller element is not known


@unit("flag")
def has_packed(state, const, work, first, last):
    """Tell whether an element of a block's rows has less than the share of its area at rest that
    packed fabric keeps."""
    s = const.row_stride
    A = work.A
    B = work.B
    share = const.packed_area
    end = scratch_slot(const, first, last)
    least = broadcast(16.0)
    for j in range(2 * s, end, WIDTH):
        a_x = load(A[0], j) + load(A[0], j + 1)
        a_y = load(A[1], j) + load(A[1], j + 1)
        a_z = load(A[2], j) + load(A[2], j + 1)
        b_x = load(B[0], j) + load(B[0], j + s)
        b_y = load(B[1], j) + load(B[1], j + s)
        b_z = load(B[2], j) + load(B[2], j + s)
        n_x = a_y * b_z - a_z * b_y
        n_y = a_z * b_x - a_x * b_z
        n_z = a_x * b_y - a_y * b_x
        square = fma(n_x, n_x, fma(n_y, n_y, n_z * n_z))
        # behind the last element lies what the scratch holds of another block
        least = minimum(least, where(head_mask(end - j), square, 16.0))
    # the sums of two sides are twice their mean, and their product four times the area
    return -reduce_max(0.0 - least) < 16.0 * share * share


@unit("number", own=PartTable)
def packing_forces(state, const, own, first, last, acting):
    """Compute the energy [J] of the packed elements of the rows first .. last - 1; add their forces
    to state.f_int if `acting` (a unit of `parts.Part`, without a row)."""
    total = 0.0
    per = const.rows_per_block
    for block in range(first // per, (last + per - 1) // per):
        if not state.packed_blocks[block]:
            continue
        for i in range(max(first, block * per), min(last, (block + 1) * per)):
            for j in range(const.nj):
                total += packing_force(state, const, np.uint64(i * const.row_stride + j), acting)
    return total


@kernel(_nrt=False)
def packing_force(state, const, k, acting):
    """Compute the energy [J] of the element at slot k; add its forces to state.f_int if
    `acting`."""
    share = const.packed_area
    s = np.uint64(const.row_stride)
    a, b = mean_sides(state, const, k)
    n_x = a[1] * b[2] - a[2] * b[1]
    n_y = a[2] * b[0] - a[0] * b[2]
    n_z = a[0] * b[1] - a[1] * b[0]
    area = math.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    if area >= share or not is_fabric(state, const, k):
        return 0.0
    dx = rest_length(const.dx, const.inv_dx, k)
    dy = rest_length(const.dy, const.inv_dy, k)
    stiffness = const.packing_stiffness * dx * dy
    missing = share - area
    if acting and area > _LEAST_AREA:
        push = 0.5 * stiffness * missing / (share * area)
        for c in range(3):
            d = (c + 1) % 3
            e = (c + 2) % 3
            normal_d = (n_y, n_z, n_x)[c]
            normal_e = (n_z, n_x, n_y)[c]
            along_warp = push / dx * (b[d] * normal_e - b[e] * normal_d)
            along_weft = push / dy * (normal_d * a[e] - normal_e * a[d])
            f = state.f_int[c]
            f[k] -= along_warp + along_weft
            f[k + s] += along_warp - along_weft
            f[k + ONE] -= along_warp - along_weft
            f[k + s + ONE] += along_warp + along_weft
    return 0.5 * stiffness * missing * missing / share


@kernel(_nrt=False)
def mean_sides(state, const, k):
    """Average the warp sides and the weft sides (x, y, z) of the element at slot k, over their
    length at rest."""
    s = np.uint64(const.row_stride)
    half1 = 0.5 / rest_length(const.dx, const.inv_dx, k)
    half2 = 0.5 / rest_length(const.dy, const.inv_dy, k)
    x, y, z = state.u
    up_x = x[k + s + ONE] - x[k]
    side_x = x[k + s] - x[k + ONE]
    up_y = y[k + s + ONE] - y[k]
    side_y = y[k + s] - y[k + ONE]
    up_z = z[k + s + ONE] - z[k]
    side_z = z[k + s] - z[k + ONE]
    warp = 1.0 + half1 * (up_x + side_x), half1 * (up_y + side_y), half1 * (up_z + side_z)
    weft = half2 * (up_x - side_x), 1.0 + half2 * (up_y - side_y), half2 * (up_z - side_z)
    return warp, weft


@kernel(_nrt=False)
def is_fabric(state, const, k):
    """Tell whether the element at slot k has yarns of both families, is not torn and drawn out, and
    is none whose yarns are resolved."""
    s = np.uint64(const.row_stride)
    warp = state.intact_fraction[0]
    weft = state.intact_fraction[1]
    if warp[k] + warp[k + ONE] == 0.0 or weft[k] + weft[k + s] == 0.0:
        return False
    return state.element_flag[k] & (DRAWN_OUT | RESOLVED) == 0


@unit("number", later=True)
def let_go(state, const):
    """Flag the torn elements that are drawn out; energy [J] that they stored."""
    lost = 0.0
    for i in range(state.first_row, state.end_row):
        for j in range(const.nj):
            k = np.uint64(i * const.row_stride + j)
            flag = state.element_flag[k]
            passed_over = flag == 0 or flag & (DRAWN_OUT | RESOLVED)
            if passed_over or not is_drawn_out(state, const, k):
                continue
            lost += packing_force(state, const, k, False)
            state.element_flag[k] = flag | DRAWN_OUT
    return lost


@kernel(_nrt=False)
def is_drawn_out(state, const, k):
    """Tell whether a diagonal of the element at slot k is longer than that of fabric may be."""
    (a_x, a_y, a_z), (b_x, b_y, b_z) = mean_sides(state, const, k)
    dx = rest_length(const.dx, const.inv_dx, k)
    dy = rest_length(const.dy, const.inv_dy, k)
    u_x = dx * a_x + dy * b_x
    u_y = dx * a_y + dy * b_y
    u_z = dx * a_z + dy * b_z
    v_x = dx * a_x - dy * b_x
    v_y = dx * a_y - dy * b_y
    v_z = dx * a_z - dy * b_z
    longest = max(u_x * u_x + u_y * u_y + u_z * u_z, v_x * v_x + v_y * v_y + v_z * v_z)
    return longest > _MOST_LENGTH * _MOST_LENGTH * (dx * dx + dy * dy)
