"""Where the lines of a graded grid are at rest, and what a contact point of a graded ply stands for.

The surface of a ply is a spline whose control points are the nodes (`plies.surface_kernels`). On a uniform grid the
place of the surface at rest is x0 + a dx. On a graded grid line i is at x0 + i dx + offset_i, with dx the side of the
smallest element, so that the surface at rest is x0 + a dx + sum w_i offset_i with the weights of the spline: offsets
are added as displacements are. The surface stays smooth in the coordinates (a, b), goes through the middles of all
elements, and conforming plies have the same map. A contact point stands for the fabric of its element: stiffness and
damping are proportional to its area, so that the mass of a node and the springs on it grow alike.

Offsets are arrays on graded plies and None on uniform ones: kernels of uniform plies have no instruction of all this.
"""

from numba import types
from numba.extending import overload, register_jitable

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import load


@register_jitable
def add_line_offset(value, offsets, i):
    """value + the offset of line i."""
    return value if offsets is None else value + offsets[i]


@register_jitable
def add_middle_offset(value, offsets, i):
    """value + the offset of the middle of the elements between lines i and i + 1."""
    return value if offsets is None else value + 0.5 * (offsets[i] + offsets[i + 1])


@register_jitable
def add_middle_offset8(value, offsets, i):
    """`add_middle_offset` of eight elements side by side."""
    return value if offsets is None else value + 0.5 * (load(offsets, i) + load(offsets, i + 1))


@register_jitable
def add_quarter_side_offset(value, offsets, i):
    """value + what offsets add to a quarter of the side between lines i and i + 1."""
    return value if offsets is None else value + 0.25 * (offsets[i + 1] - offsets[i])


@register_jitable
def add_weighted_offset(value, offsets, i, w0, w1, w2):
    """value + the weighted offsets of three lines from i on."""
    return value if offsets is None else value + (w0 * offsets[i] + w1 * offsets[i + 1] + w2 * offsets[i + 2])


@register_jitable
def add_row_offset8(value, offsets, i, w):
    """value + the weighted offsets of four lines from i on, the same four for eight points."""
    if offsets is None:
        return value
    return value + (w[0] * offsets[i] + w[1] * offsets[i + 1] + w[2] * offsets[i + 2] + w[3] * offsets[i + 3])


@register_jitable
def add_column_offset8(value, offsets, j, w):
    """value + the weighted offsets of four lines from j on, from j + 1 on for the second of eight points, and so on."""
    if offsets is None:
        return value
    three = w[0] * load(offsets, j) + w[1] * load(offsets, j + 1) + w[2] * load(offsets, j + 2)
    return value + three + w[3] * load(offsets, j + 3)


def scaled_by_area(value, rows, columns, i, j):
    """value times the area of element (i, j) over that of the smallest; of turned plies rows have all products."""


@overload(scaled_by_area, inline="always")
def _scaled_by_area(value, rows, columns, i, j):
    if isinstance(rows, types.NoneType):
        return lambda value, rows, columns, i, j: value
    if rows.ndim == 2:  # of turned plies
        return lambda value, rows, columns, i, j: value * rows[i, j]
    return lambda value, rows, columns, i, j: value * (rows[i] * columns[j])


@register_jitable
def scaled_by_area8(value, rows, columns, i, j):
    """`scaled_by_area` of eight elements side by side."""
    return value if rows is None else (rows[i] * load(columns, j)) * value


@register_jitable
def place_in_elements(distance, step, offsets, n):
    """[elements] place of a point at `distance` [m] from the first of the n + 1 lines; goes on beyond both ends."""
    return distance / step if offsets is None else _search_place(distance, step, offsets, n)


@kernel(_nrt=False)
def _search_place(distance, step, offsets, n):
    """`place_in_elements` by bisection among the lines."""
    low, high = 0, n - 1
    while low < high:
        middle = (low + high + 1) // 2
        if middle * step + offsets[middle] <= distance:
            low = middle
        else:
            high = middle - 1
    before, behind = low * step + offsets[low], (low + 1) * step + offsets[low + 1]
    return low + (distance - before) / (behind - before)
