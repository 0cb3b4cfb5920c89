"""Broad phase of the contact of torn plies: pairs of elements and facets that are near each other, by uniform grids.

The cells of a ply's grid are its elements at rest; a facet is entered in every cell that its box in the coming step
reaches.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.plies.contact_simd_kernels import IN_CONTACT
from shellfabric.plies.graded_kernels import ply_place_in_elements
from shellfabric.plies.turn_kernels import corners_of_box, turn_of, turned, turned_back

WORK, CORRECTIONS, UNRESOLVED = 0, 1, 2  # of stops.energy; how often something was held, and how often not for good
ELEMENTS, NODES, ENTRIES = range(3)  # of stops.counts: elements of the zone, nodes, entries in the grid
ROW_STRIDE, NI, NJ, MIRROR_X, MIRROR_Y = range(5)  # of stops.ply_shape
TORN, WHOLE = 1, 2  # of stops.zone_mark: an element that is looked at, and one of whole fabric
PAD = 4  # cells of the grid beyond the panel's edges
_MAX_CELLS = 20  # [cells] of a facet that is entered; a wider one joins pieces that have parted
_MARGIN = 4  # [gaps] about a facet, in which what it may meet is searched


@kernel(_nrt=False, forceinline=True)
def grid_cell(stops, q, x, y):
    """Row and column of the grid of ply q, which has its elements and PAD cells about them."""
    x, y = turned(turn_of(stops.turns, q), x, y)
    x, y, ni, nj = x - stops.ply_grid[q, 0], y - stops.ply_grid[q, 1], stops.ply_shape[q, NI], stops.ply_shape[q, NJ]
    a, b = (
        int(ply_place_in_elements(x, stops.ply_grid[q, 2], stops.line_offset, q, 0, ni) + PAD),
        int(ply_place_in_elements(y, stops.ply_grid[q, 3], stops.line_offset, q, 1, nj) + PAD),
    )
    return min(max(a, 0), stops.ply_shape[q, NI] + 2 * PAD - 1), min(max(b, 0), stops.ply_shape[q, NJ] + 2 * PAD - 1)


@kernel(_nrt=False)
def grid_insert(stops, p):
    """Enter the facets of a ply that have fabric in its grid."""
    entries, width, s, margin = (
        0,
        stops.ply_shape[p, NJ] + 2 * PAD,
        stops.ply_shape[p, ROW_STRIDE],
        _MARGIN * stops.min_distance[p],
    )
    for m in range(stops.counts[p, ELEMENTS]):
        e = stops.elements[p, m]
        if stops.intact_quadrants[p, e] == 0:
            continue
        for c in range(3):
            low, high = 1e30, -1e30
            for k in (e, e + 1, e + s, e + s + 1):
                low = min(low, min(stops.x[p, c, k], stops.x_next[p, c, k]))
                high = max(high, max(stops.x[p, c, k], stops.x_next[p, c, k]))
            stops.box_low[p, c, e], stops.box_high[p, c, e] = low - margin, high + margin
        a0, b0, a1, b1 = cells_of_box(stops, p, e)
        if a1 - a0 >= _MAX_CELLS or b1 - b0 >= _MAX_CELLS:
            continue
        if entries + _MAX_CELLS**2 > stops.entry_element.shape[1]:
            stops.energy[UNRESOLVED] += 1.0
            continue
        for a in range(a0, a1 + 1):
            for b in range(b0, b1 + 1):
                head = a * width + b
                stops.entry_element[p, entries] = e
                stops.entry_cell[p, entries] = head
                stops.entry_next[p, entries] = stops.cell_head[p, head]
                stops.cell_head[p, head] = entries
                entries += 1
    stops.counts[p, ENTRIES] = entries


@kernel(_nrt=False, forceinline=True)
def cells_of_box(stops, p, e):
    """First row and column, last row and column of the cells of its ply's grid that the box of a facet reaches."""
    low, high = stops.box_low[p], stops.box_high[p]
    a0, b0 = grid_cell(stops, p, low[0, e], low[1, e])
    a1, b1 = a0, b0
    for corner in range(1, corners_of_box(stops.turns)):
        x, y = high[0, e] if corner < 3 else low[0, e], high[1, e] if corner != 2 else low[1, e]
        a, b = grid_cell(stops, p, x, y)
        a0, b0, a1, b1 = min(a0, a), min(b0, b), max(a1, a), max(b1, b)
    return a0, b0, a1, b1


@kernel(_nrt=False)
def grid_clear(stops, p):
    """Empty the grid of a ply."""
    for m in range(stops.counts[p, ENTRIES]):
        stops.cell_head[p, stops.entry_cell[p, m]] = -1
    stops.counts[p, ENTRIES] = 0


@kernel(_nrt=False)
def collect_candidates(stops, pair, p, q, count):
    """Add the elements of ply p and the facets of ply q that are near each other to the list, and their number.

    pair : the contact of the points of ply p on ply q, where they are next to each other
    """
    width, s, apart = stops.ply_shape[q, NJ] + 2 * PAD, stops.ply_shape[p, ROW_STRIDE], abs(p - q) > 1
    for m in range(stops.counts[p, ELEMENTS]):
        e = stops.elements[p, m]
        if stops.intact_quadrants[p, e] == 0:
            continue
        x0, y0, z0 = element_mean(stops.x, p, e, s)
        x1, y1, z1 = element_mean(stops.x_next, p, e, s)
        a0, b0 = grid_cell(stops, q, x0, y0)
        a1, b1 = grid_cell(stops, q, x1, y1)
        for once in range(1 if a0 == a1 and b0 == b1 else 2):
            a, b = (a1, b1) if once == 0 else (a0, b0)
            entry = stops.cell_head[q, a * width + b]
            while entry >= 0:
                f = np.int64(stops.entry_element[q, entry])
                entry = stops.entry_next[q, entry]
                near = max(z0, z1) >= stops.box_low[q, 2, f] and min(z0, z1) <= stops.box_high[q, 2, f]
                near = near and max(x0, x1) >= stops.box_low[q, 0, f] and min(x0, x1) <= stops.box_high[q, 0, f]
                near = near and max(y0, y1) >= stops.box_low[q, 1, f] and min(y0, y1) <= stops.box_high[q, 1, f]
                if near and (apart or stops.zone_mark[q, f] != WHOLE):
                    if count < stops.candidates.shape[0]:
                        stops.candidates[count, 0], stops.candidates[count, 1] = p, e
                        stops.candidates[count, 2], stops.candidates[count, 3] = q, f
                        point = e // s * stops.ply_shape[p, NJ] * pair.points_per_side**2 + e % s
                        knows = not apart and pair.status[point] == IN_CONTACT
                        knows = knows and pair.last_depth[point] > pair.thickness
                        for c in range(3):
                            stops.candidate_normal[count, c] = pair.normal[c][point] if knows else 0.0
                        n_x, n_y = stops.candidate_normal[count, 0], stops.candidate_normal[count, 1]
                        n_x, n_y = turned_back(turn_of(stops.turns, q), n_x, n_y)
                        stops.candidate_normal[count, 0], stops.candidate_normal[count, 1] = n_x, n_y
                        count += 1
                    else:
                        stops.energy[UNRESOLVED] += 1.0
    return count


@kernel(_nrt=False, forceinline=True)
def element_mean(x, p, e, s):
    """The mean of the four nodes of an element, of an array (plies, 3, slots)."""
    return (
        0.25 * (x[p, 0, e] + x[p, 0, e + 1] + x[p, 0, e + s] + x[p, 0, e + s + 1]),
        0.25 * (x[p, 1, e] + x[p, 1, e + 1] + x[p, 1, e + s] + x[p, 1, e + s + 1]),
        0.25 * (x[p, 2, e] + x[p, 2, e + 1] + x[p, 2, e + s] + x[p, 2, e + s + 1]),
    )
