"""Where the lines of a graded grid are at rest, and what a contact point of a graded ply stands for.

The surface of a ply is a spline whose control points are the nodes (`plies.surface_kernels`). On a uniform grid the
place of the surface at rest is x0 + a dx. On a graded grid line i is at x0 + i dx + offset_i, with dx the side of the
smallest element, so that the surface at rest is x0 + a dx + sum w_i offset_i with the weights of the spline: offsets
are added as displacements are. The surface stays smooth in the coordinates (a, b), goes through the middles of all
elements, and conforming plies have the same map. A contact point stands for the fabric of its element: stiffness and
damping are proportional to its area, so that the mass of a node and the springs on it grow alike.

Offsets are arrays on graded plies and the float 0 on uniform ones. numba chooses by that type: kernels of uniform plies
have no instruction of all this.
"""

from numba import types
from numba.extending import overload

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import load


def add_line_offset(value, offsets, i):
    """value + the offset of line i."""


@overload(add_line_offset, inline="always")
def _add_line_offset(value, offsets, i):
    if isinstance(offsets, types.Float):
        return lambda value, offsets, i: value
    return lambda value, offsets, i: value + offsets[i]


def add_middle_offset(value, offsets, i):
    """value + the offset of the middle of the elements between lines i and i + 1."""


@overload(add_middle_offset, inline="always")
def _add_middle_offset(value, offsets, i):
    if isinstance(offsets, types.Float):
        return lambda value, offsets, i: value
    return lambda value, offsets, i: value + 0.5 * (offsets[i] + offsets[i + 1])


def add_middle_offset8(value, offsets, i):
    """`add_middle_offset` of eight elements side by side."""


@overload(add_middle_offset8, inline="always")
def _add_middle_offset8(value, offsets, i):
    if isinstance(offsets, types.Float):
        return lambda value, offsets, i: value
    return lambda value, offsets, i: value + 0.5 * (load(offsets, i) + load(offsets, i + 1))


def add_quarter_side_offset(value, offsets, i):
    """value + what offsets add to a quarter of the side between lines i and i + 1."""


@overload(add_quarter_side_offset, inline="always")
def _add_quarter_side_offset(value, offsets, i):
    if isinstance(offsets, types.Float):
        return lambda value, offsets, i: value
    return lambda value, offsets, i: value + 0.25 * (offsets[i + 1] - offsets[i])


def add_weighted_offset(value, offsets, i, w0, w1, w2):
    """value + the weighted offsets of three lines from i on."""


@overload(add_weighted_offset, inline="always")
def _add_weighted_offset(value, offsets, i, w0, w1, w2):
    if isinstance(offsets, types.Float):
        return lambda value, offsets, i, w0, w1, w2: value
    return lambda value, offsets, i, w0, w1, w2: value + (w0 * offsets[i] + w1 * offsets[i + 1] + w2 * offsets[i + 2])


def add_row_offset8(value, offsets, i, w):
    """value + the weighted offsets of four lines from i on, the same four for eight points."""


@overload(add_row_offset8, inline="always")
def _add_row_offset8(value, offsets, i, w):
    if isinstance(offsets, types.Float):
        return lambda value, offsets, i, w: value
    return lambda value, offsets, i, w: (
        value + (w[0] * offsets[i] + w[1] * offsets[i + 1] + w[2] * offsets[i + 2] + w[3] * offsets[i + 3])
    )


def add_column_offset8(value, offsets, j, w):
    """value + the weighted offsets of four lines from j on, from j + 1 on for the second of eight points, and so on."""


@overload(add_column_offset8, inline="always")
def _add_column_offset8(value, offsets, j, w):
    if isinstance(offsets, types.Float):
        return lambda value, offsets, j, w: value
    return lambda value, offsets, j, w: (
        value
        + (w[0] * load(offsets, j) + w[1] * load(offsets, j + 1) + w[2] * load(offsets, j + 2))
        + w[3] * load(offsets, j + 3)
    )


def scaled_by_area(value, rows, columns, i, j):
    """value times the area of element (i, j) over that of the smallest."""


@overload(scaled_by_area, inline="always")
def _scaled_by_area(value, rows, columns, i, j):
    if isinstance(rows, types.Float):
        return lambda value, rows, columns, i, j: value
    if rows.ndim == 2:  # of turned plies
        return lambda value, rows, columns, i, j: value * rows[i, j]
    return lambda value, rows, columns, i, j: value * (rows[i] * columns[j])


def scaled_by_area8(value, rows, columns, i, j):
    """`scaled_by_area` of eight elements side by side."""


@overload(scaled_by_area8, inline="always")
def _scaled_by_area8(value, rows, columns, i, j):
    if isinstance(rows, types.Float):
        return lambda value, rows, columns, i, j: value
    return lambda value, rows, columns, i, j: (rows[i] * load(columns, j)) * value


def place_in_elements(distance, step, offsets, n):
    """[elements] place of a point at `distance` [m] from the first of the n + 1 lines; goes on beyond both ends."""


@overload(place_in_elements, inline="always")
def _place_in_elements(distance, step, offsets, n):
    if isinstance(offsets, types.Float):
        return lambda distance, step, offsets, n: distance / step
    return lambda distance, step, offsets, n: _search_place(distance, step, offsets, n)


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
