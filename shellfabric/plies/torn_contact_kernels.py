"""What torn cloth may not do: go through other cloth, of the next ply or through its holes of one further on.

The contact of neighbouring plies (`plies.contact_kernels`) is one of surfaces with a side to each, followed from step
to step. Torn cloth has edges, is drawn to lines and turns over, and through a hole it meets plies that it has no foot
on. So beside torn cloth what is about to happen is looked at as well: with all forces of a step known, so are the
places x' = x + dt v' of the next one. The middle of an element that would then be on the other side of a facet of
another ply, or nearer to it than `gap`, gets the force along the normal n of the facet that keeps it off, and its nodes
and those of the facet share it by their weights w, so that momentum is kept:

    f = (h - h') / (dt^2 sum w^2 / m),     h' = +-n.(x' - y')

h' counts from the side on which the point is; h is the gap, or a tenth of it more than the present distance where that
is less. It is the least that prevents the passage, takes the speed of approach away, and gives none back. What one
force does another may undo, so all are gone through again until none is missing, or _ROUNDS times, and from round to
round less of the gap is asked for.

Looked at are the elements about torn ones, of the ply itself and of those next to it, against the other ply next to it
and against those behind that where all plies between them are torn. A facet is the four triangles between the nodes of
an element and its middle. Through a hole, where warp and weft next to the place are gone, a point may go. Where the
cloth of the next ply is whole it is left to their contact, whose surface lies on the inside of bends, the nodes on the
outside. What by that contact has come through, as when a yarn fails beside a point between the two, may go back. A
triangle that is drawn to a line turns over by itself: where its normal turns by more than 60 degrees in the step, h and
h' are not of one side, and it holds nothing.

Deep points. The springs of that contact are as stiff as the step allows, and hold no more than a share of a point's
mass times t / dt^2. Loose cloth is drawn into folds, and a point is found deep inside the thickness t where it has no
room left to be slowed down in; half of the springs are those of the other ply, which may have no points there. So in
the zone about torn elements a point that touches whole cloth and is deeper than _DEEP is foreseen likewise: with its
normal n and the weights of its foot from the contact,

    h = t - depth,     h' = h + n.(y' - y - x' + x),     f as above, on the nodes that the spring pushes

From _DEEP on an approach as fast as `Pack.in_step_with` reckons with is stopped before it is through.

Rounds. What none of whose nodes has been moved since it was looked at is as it was, and passed over.

Which facets are near a point: the facets of a ply are entered in a raster whose cells are its elements at rest, in
every cell that their boxes reach into within the step.

The work is told as that of all contact of plies is, half a step's of the old forces and half a step's of the new.
"""

import numpy as np

from shellfabric.cloth import spline_kernels
from shellfabric.cloth.membrane_kernels import ERODED
from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import kernel
from shellfabric.panel.step_kernels import FAILURES
from shellfabric.plies.contact_kernels import apply_symmetry, element_of_middle, grow_window, half_step_work
from shellfabric.plies.contact_simd_kernels import IN_CONTACT
from shellfabric.plies.graded_kernels import add_line_offset, ply_place_in_elements
from shellfabric.plies.surface_kernels import SMOOTH, intact_about, spline_weights

WORK, CORRECTIONS, UNRESOLVED = 0, 1, 2  # of stops.energy; how often something was held, and how often not for good
# of stops.counts: what is looked at of a ply, what is in its raster, and which nodes are not those of feet alone
ELEMENTS, NODES, ENTRIES, ZONE_NODES = range(4)
# of stops.deep_point_data: n, h, and `spline_weights` along either family
NORMAL, DISTANCE, WEIGHTS_WARP, WEIGHTS_WEFT = 0, 3, 4, 8
ROW_STRIDE, NI, NJ, MIRROR_X, MIRROR_Y = range(5)  # of stops.ply_shape
TORN, WHOLE = 1, 2  # of stops.zone_mark: an element that is looked at, and one of whole cloth
PAD = 4  # cells of the raster beyond the panel's edges
_TORN_NEIGHBOURS, _PLIES_AWAY = 3, 2  # elements about torn ones, plies whose tears count
_DEEP_FRACTION = 0.5  # [thicknesses] from which a point could come through within a step
_MAX_SWEEPS = 24
_MAX_CORRECTION = 0.1  # [gaps] by which what is nearer than the gap is moved in a step
_MAX_CELLS = 20  # [cells] of a facet that is entered; a wider one is noted as missed
_MARGIN = 4  # [gaps] about a facet, in which what it may meet is looked for
_TRIANGLE_TOLERANCE = 0.02  # of a triangle, beyond its sides
_MIN_NORMAL_COSINE = 0.5  # cosine of the most that a normal may turn in a step


@kernel(_nrt=False)
def enforce_constraints(states, consts, pairs, stack, stops):
    """Forces that keep torn cloth from passing through other plies in the coming step, into stops.f."""
    failures = 0
    for p in range(len(states)):
        failures += stack.ply_counters[p, FAILURES]
    if failures == 0:
        return
    taken, count, deep, half = 0.0, 0, 0, len(pairs) // 2
    if failures != stops.failures[0]:
        stops.failures[0] = failures
        for p in range(len(states)):
            mark_zone(states, consts, stack, stops, p)
    for p in range(len(states)):
        for q in range(max(p - 1, 0), min(p + 2, len(states))):
            if q != p:
                pair = borrowed_item(pairs, min(p, q) + (half if q < p else 0))
                deep = list_deep_points(borrowed_item(states, q), borrowed_item(consts, q), pair, stops, p, q, deep)
    for p in range(len(states)):
        if stops.window[p, 0] < stops.window[p, 1]:
            taken -= half_step_work(
                borrowed_item(states, p), borrowed_item(consts, p), stops.f[p], stops.window[p], True
            )
        if stops.counts[p, NODES] > 0:
            predict_state(states, consts, pairs, stops, p)
            grid_insert(stops, p)
    for p in range(len(states)):
        for way in (-1, 1):
            q = p + way
            while 0 <= q < len(states):
                if stops.counts[p, ELEMENTS] > 0 and stops.counts[q, ELEMENTS] > 0:
                    pair = (
                        borrowed_item(pairs, min(p, q) + (half if q < p else 0))
                        if abs(p - q) == 1
                        else borrowed_item(pairs, 0)
                    )
                    count = collect_candidates(stops, pair, p, q, count)
                if stack.ply_counters[q, FAILURES] == 0:
                    break
                q += way
    project_constraints(stops, count, deep)
    for p in range(len(states)):
        if stops.window[p, 0] < stops.window[p, 1]:
            apply_symmetry(borrowed_item(consts, p), stops.f[p], stops.window[p])
            taken -= half_step_work(
                borrowed_item(states, p), borrowed_item(consts, p), stops.f[p], stops.window[p], False
            )
        grid_clear(stops, p)
    stops.energy[WORK] += taken


@kernel(_nrt=False)
def mark_zone(states, consts, stack, stops, p):
    """List the elements of a ply that are about torn ones, its own or of plies next to it, and their nodes."""
    const, mark = borrowed_item(consts, p), stops.zone_mark[p]
    mark[:] = 0
    for q in range(max(p - _PLIES_AWAY, 0), min(p + _PLIES_AWAY + 1, len(states))):
        other, state = borrowed_item(consts, q), borrowed_item(states, q)
        if stack.ply_counters[q, FAILURES] == 0:
            continue
        for i in range(other.ni):
            for j in range(other.nj if state.block_damage[i // other.rows_per_block] else 0):
                if state.element_flag[i * other.row_stride + j]:
                    m0, n0 = element_of_middle(const, other, i, j)
                    for m in range(max(m0 - _TORN_NEIGHBOURS, 0), min(m0 + _TORN_NEIGHBOURS + 1, const.ni)):
                        for n in range(max(n0 - _TORN_NEIGHBOURS, 0), min(n0 + _TORN_NEIGHBOURS + 1, const.nj)):
                            mark[m * const.row_stride + n] = TORN
    elements, nodes, s = 0, 0, const.row_stride
    for i in range(const.ni + 1):
        for j in range(const.nj + 1):
            k = i * s + j
            if mark[k] == TORN:
                stops.elements[p, elements] = k
                elements += 1
            near = mark[k] + (mark[k - 1] if j > 0 else 0)
            stops.in_node_list[p, k] = near + (mark[k - s] + (mark[k - s - 1] if j > 0 else 0) if i > 0 else 0) > 0
            if stops.in_node_list[p, k]:
                stops.nodes[p, nodes] = k
                nodes += 1
    stops.counts[p, ELEMENTS], stops.counts[p, NODES], stops.counts[p, ZONE_NODES] = elements, nodes, nodes
    for m in range(elements):
        k = stops.elements[p, m]
        if spline_kernels.neighbourhood_intact(borrowed_item(states, p), const, k // s, k % s):
            mark[k] = WHOLE


@kernel(_nrt=False)
def list_deep_points(rear, rc, pair, stops, p, q, count):
    """Add the points of ply p that are deep in whole cloth of ply q to the list, and the nodes about their feet to
    those of ply q; their number."""
    if pair.points_per_side != 1 or pair.surface_form != SMOOTH:
        return count
    s, nj = stops.ply_shape[p, ROW_STRIDE], stops.ply_shape[p, NJ]
    for m in range(stops.counts[p, ELEMENTS]):
        e = stops.elements[p, m]
        point = e // s * nj + e % s
        if (
            pair.status[point] != IN_CONTACT
            or not _DEEP_FRACTION * pair.thickness < pair.last_depth[point] < pair.thickness
        ):
            continue
        a, b = pair.closest_point[0][point], pair.closest_point[1][point]
        if not intact_about(rear, rc, a, b):
            continue
        if count == stops.deep_points.shape[0]:
            stops.energy[UNRESOLVED] += 1.0
            break
        i, w0, w1, w2, _, _, _, w1x, _ = spline_weights(a, rc.ni, rc.mirror_x)
        j, v0, v1, v2, _, _, _, v1y, _ = spline_weights(b, rc.nj, rc.mirror_y)
        (
            stops.deep_points[count, 0],
            stops.deep_points[count, 1],
            stops.deep_points[count, 2],
            stops.deep_points[count, 3],
        ) = p, e, q, i * rc.row_stride + j
        foot = stops.deep_point_data[count]
        for c in range(3):
            foot[NORMAL + c] = pair.normal[c][point]
        foot[DISTANCE] = pair.thickness - pair.last_depth[point]
        foot[WEIGHTS_WARP], foot[WEIGHTS_WARP + 1], foot[WEIGHTS_WARP + 2], foot[WEIGHTS_WARP + 3] = w0, w1, w2, w1x
        foot[WEIGHTS_WEFT], foot[WEIGHTS_WEFT + 1], foot[WEIGHTS_WEFT + 2], foot[WEIGHTS_WEFT + 3] = v0, v1, v2, v1y
        count += 1
        for n in range(9):
            k = (i + n // 3) * rc.row_stride + j + n % 3
            if not stops.in_node_list[q, k]:
                stops.in_node_list[q, k] = True
                stops.nodes[q, stops.counts[q, NODES]] = k
                stops.counts[q, NODES] += 1
    return count


@kernel(_nrt=False)
def predict_state(states, consts, pairs, stops, p):
    """Places of the nodes of a ply now and after the next step, by all known forces, and where it has cloth."""
    half = len(pairs) // 2
    predict_velocities(borrowed_item(states, p), borrowed_item(consts, p), stops, p)
    if p > 0:
        add_impulses(stops, p, borrowed_item(pairs, p - 1).f_rear)
        add_impulses(stops, p, borrowed_item(pairs, half + p - 1).f_front)
    if p < len(states) - 1:
        add_impulses(stops, p, borrowed_item(pairs, p).f_front)
        add_impulses(stops, p, borrowed_item(pairs, half + p).f_rear)
    elif borrowed_item(consts, p).has_backing:
        add_impulses(stops, p, borrowed_item(states, p).f_block_cloth)
    predict_positions(stops, p)


@kernel(_nrt=False)
def predict_velocities(state, const, stops, p):
    """What a ply knows of itself: where it has cloth, places, and velocities by its own forces and the nose's."""
    for m in range(stops.counts[p, ELEMENTS]):
        stops.intact_quadrants[p, stops.elements[p, m]] = intact_quadrants(state, const, stops.elements[p, m])
    for m in range(stops.counts[p, NODES]):
        k = stops.nodes[p, m]
        i, j = k // const.row_stride, k % const.row_stride
        met = i > 0 and i % const.rows_per_block == 0
        stops.x[p, 0, k] = add_line_offset(const.x0 + i * const.dx, const.line_offset1, i) + state.u[0][k]
        stops.x[p, 1, k] = add_line_offset(const.y0 + j * const.dy, const.line_offset2, j) + state.u[1][k]
        stops.x[p, 2, k] = stops.z_rest[p] + state.u[2][k]
        for c in range(3):
            force = state.f_int[c][k] + state.f_contact[c][k] + (state.f_int_above[c][k] if met else 0.0)
            stops.x_next[p, c, k] = state.v[c][k] + state.dt_over_mass[k] * force


@kernel(_nrt=False)
def add_impulses(stops, p, force):
    """Add the impulses of forces to the velocities."""
    for m in range(stops.counts[p, NODES]):
        k = stops.nodes[p, m]
        for c in range(3):
            stops.x_next[p, c, k] += stops.dt_over_mass[p, k] * force[c][k]


@kernel(_nrt=False)
def predict_positions(stops, p):
    """Places after the step in place of velocities; nodes on planes of symmetry keep to them."""
    for m in range(stops.counts[p, NODES]):
        k = stops.nodes[p, m]
        for c in range(3):
            kept = (c == 0 and stops.ply_shape[p, MIRROR_X] and k < stops.ply_shape[p, ROW_STRIDE]) or (
                c == 1 and stops.ply_shape[p, MIRROR_Y] and k % stops.ply_shape[p, ROW_STRIDE] == 0
            )
            stops.x_next[p, c, k] = stops.x[p, c, k] + (0.0 if kept else stops.dt * stops.x_next[p, c, k])


@kernel(_nrt=False)
def intact_quadrants(state, const, k):
    """Bit 2 a + b for the quarter of an element at the end a along the warp and b along the weft, if it has cloth."""
    if state.element_flag[k] == 0:
        return 15
    found = 0
    for m in range(0 if state.element_flag[k] & ERODED else 4):
        a, b = m >> 1, m & 1
        if state.intact_fraction[0][k + b] + state.intact_fraction[1][k + a * const.row_stride] > 0.0:
            found |= 1 << m
    return found


@kernel(_nrt=False, forceinline=True)
def grid_cell(stops, q, x, y):
    """Row and column of the raster of ply q, which has its elements and PAD cells about them."""
    x, y, ni, nj = x - stops.ply_grid[q, 0], y - stops.ply_grid[q, 1], stops.ply_shape[q, NI], stops.ply_shape[q, NJ]
    a, b = (
        int(ply_place_in_elements(x, stops.ply_grid[q, 2], stops.line_offset, q, 0, ni) + PAD),
        int(ply_place_in_elements(y, stops.ply_grid[q, 3], stops.line_offset, q, 1, nj) + PAD),
    )
    return min(max(a, 0), stops.ply_shape[q, NI] + 2 * PAD - 1), min(max(b, 0), stops.ply_shape[q, NJ] + 2 * PAD - 1)


@kernel(_nrt=False)
def grid_insert(stops, p):
    """Enter the facets of a ply that have cloth in its raster."""
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
        a0, b0 = grid_cell(stops, p, stops.box_low[p, 0, e], stops.box_low[p, 1, e])
        a1, b1 = grid_cell(stops, p, stops.box_high[p, 0, e], stops.box_high[p, 1, e])
        if a1 - a0 >= _MAX_CELLS or b1 - b0 >= _MAX_CELLS or entries + _MAX_CELLS**2 > stops.entry_element.shape[1]:
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


@kernel(_nrt=False)
def grid_clear(stops, p):
    """Empty the raster of a ply, and forget the nodes about feet."""
    for m in range(stops.counts[p, ENTRIES]):
        stops.cell_head[p, stops.entry_cell[p, m]] = -1
    for m in range(stops.counts[p, ZONE_NODES], stops.counts[p, NODES]):
        stops.in_node_list[p, stops.nodes[p, m]] = False
    stops.counts[p, ENTRIES], stops.counts[p, NODES] = 0, stops.counts[p, ZONE_NODES]


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
                        point = e // s * stops.ply_shape[p, NJ] + e % s
                        knows = not apart and pair.points_per_side == 1 and pair.status[point] == IN_CONTACT
                        knows = knows and pair.last_depth[point] > pair.thickness
                        for c in range(3):
                            stops.candidate_normal[count, c] = pair.normal[c][point] if knows else 0.0
                        count += 1
                    else:
                        stops.energy[UNRESOLVED] += 1.0
    return count


@kernel(_nrt=False)
def project_constraints(stops, count, deep):
    """Keep the middles of the elements in the list off the facets that they are near, and the points that are `deep`,
    by their number, from going through."""
    held = 0
    for turn in range(_MAX_SWEEPS):
        held, asked = 0, 1.0 - turn / _MAX_SWEEPS
        stops.sweep[0] += 1
        for m in range(count):
            if (turn == 0 or pair_has_moved(stops, m)) and resolve_pair(stops, m, asked):
                held += 1
        for m in range(deep):
            if resolve_deep_point(stops, m, asked):
                held += 1
        if held == 0:
            break
        stops.energy[CORRECTIONS] += held
    stops.energy[UNRESOLVED] += held
    stops.sweep[0] += 1


@kernel(_nrt=False, forceinline=True)
def pair_has_moved(stops, number):
    """Whether a node of an element or a facet, by number in the list, has been moved in this round or the last: if not,
    nothing has come nearer since they were looked at."""
    last = stops.sweep[0] - 1
    for n in range(0, 4, 2):
        p, e = stops.candidates[number, n], stops.candidates[number, n + 1]
        s = stops.ply_shape[p, ROW_STRIDE]
        one = max(stops.last_moved[p, e], stops.last_moved[p, e + 1])
        if max(one, max(stops.last_moved[p, e + s], stops.last_moved[p, e + s + 1])) >= last:
            return True
    return False


@kernel(_nrt=False, forceinline=True)
def element_mean(x, p, e, s):
    """The mean of the four nodes of an element, of an array (plies, 3, slots)."""
    return (
        0.25 * (x[p, 0, e] + x[p, 0, e + 1] + x[p, 0, e + s] + x[p, 0, e + s + 1]),
        0.25 * (x[p, 1, e] + x[p, 1, e + 1] + x[p, 1, e + s] + x[p, 1, e + s + 1]),
        0.25 * (x[p, 2, e] + x[p, 2, e + 1] + x[p, 2, e + s] + x[p, 2, e + s + 1]),
    )


@kernel(_nrt=False)
def resolve_pair(stops, number, asked):
    """Keep the middle of an element off a facet, by number in the list, if it would come through: whether it would."""
    p, e, q, f = (
        stops.candidates[number, 0],
        stops.candidates[number, 1],
        stops.candidates[number, 2],
        stops.candidates[number, 3],
    )
    side = stops.candidate_normal[number]
    own, s, gap = stops.ply_shape[p, ROW_STRIDE], stops.ply_shape[q, ROW_STRIDE], stops.min_distance[p]
    x0, y0, z0 = element_mean(stops.x, p, e, own)
    x1, y1, z1 = element_mean(stops.x_next, p, e, own)
    ring = f, f + s, f + s + 1, f + 1
    M0, M1 = element_mean(stops.x, q, f, s), element_mean(stops.x_next, q, f, s)
    for n in range(4):
        k, o = ring[n], ring[(n + 1) & 3]
        m_x, m_y, m_z, before = triangle_distance(stops.x, q, M0, k, o, x0, y0, z0)
        n_x, n_y, n_z, after = triangle_distance(stops.x_next, q, M1, k, o, x1, y1, z1)
        if n_x * m_x + n_y * m_y + n_z * m_z < _MIN_NORMAL_COSINE:
            continue  # of a line, or a sliver that turns over within the step: its sides are not those of the cloth
        if before * (n_x * side[0] + n_y * side[1] + n_z * side[2]) > 0.0:
            continue  # it is through by what the contact knows of it, which brings it back
        if before < 0.0:
            n_x, n_y, n_z, before, after = -n_x, -n_y, -n_z, -before, -after
        wanted = asked * (gap if before > gap else min(gap, before + _MAX_CORRECTION * gap))
        if after >= wanted:
            continue
        share = before / (before - after) if after < 0.0 else 1.0
        u, v = triangle_weights(stops, q, M0, M1, k, o, share, x0, y0, z0, x1, y1, z1)
        slack = _TRIANGLE_TOLERANCE if after < 0.0 else 0.0
        if u < -slack or v < -slack or u + v > 1.0 + slack:
            continue
        # weights of the facet's nodes: a quarter each of the middle's, and the corners' own
        rest = 0.25 * (1.0 - u - v)
        a, b = 2.0 * rest, 2.0 * rest
        a += (u if n == 1 or n == 2 else 0.0) + (v if n == 0 or n == 1 else 0.0)
        b += (u if n == 2 or n == 3 else 0.0) + (v if n == 1 or n == 2 else 0.0)
        if not stops.intact_quadrants[q, f] >> (2 * (a > 0.5) + (b > 0.5)) & 1:
            continue
        give = 0.0
        for m in (e, e + 1, e + own, e + own + 1):
            give += 0.0625 * stops.dt_over_mass[p, m] * mobility(stops, p, m, n_x, n_y)
        for m in range(4):
            w = rest + (u if m == n else 0.0) + (v if m == ((n + 1) & 3) else 0.0)
            give += w * w * stops.dt_over_mass[q, ring[m]] * mobility(stops, q, ring[m], n_x, n_y)
        if give == 0.0:
            continue
        force = (wanted - after) / (stops.dt * give)
        for m in (e, e + 1, e + own, e + own + 1):
            add_force(stops, p, m, 0.25 * force * n_x, 0.25 * force * n_y, 0.25 * force * n_z)
        for m in range(4):
            w = -force * (rest + (u if m == n else 0.0) + (v if m == ((n + 1) & 3) else 0.0))
            add_force(stops, q, ring[m], w * n_x, w * n_y, w * n_z)
        return True
    return False


@kernel(_nrt=False)
def resolve_deep_point(stops, number, asked):
    """Keep a point that is deep in whole cloth, by number in the list, from coming through: whether it would."""
    p, e, q, first = (
        stops.deep_points[number, 0],
        stops.deep_points[number, 1],
        stops.deep_points[number, 2],
        stops.deep_points[number, 3],
    )
    foot, own, s, gap = (
        stops.deep_point_data[number],
        stops.ply_shape[p, ROW_STRIDE],
        stops.ply_shape[q, ROW_STRIDE],
        stops.min_distance[p],
    )
    n_x, n_y, n_z, before = foot[NORMAL], foot[NORMAL + 1], foot[NORMAL + 2], foot[DISTANCE]
    after, give = before, 0.0
    for m in (e, e + 1, e + own, e + own + 1):
        after -= 0.25 * displacement_along(stops, p, m, n_x, n_y, n_z)
        give += 0.0625 * stops.dt_over_mass[p, m] * mobility(stops, p, m, n_x, n_y)
    for m in range(9):
        k = first + m // 3 * s + m % 3
        f_x, f_y, f_z = closest_point_weights(foot, m)
        after += displacement_along(stops, q, k, f_x, f_y, f_z)
        fixed_x, fixed_y = stops.ply_shape[q, MIRROR_X] and k < s, stops.ply_shape[q, MIRROR_Y] and k % s == 0
        give += stops.dt_over_mass[q, k] * ((0.0 if fixed_x else f_x**2) + (0.0 if fixed_y else f_y**2) + f_z**2)
    wanted = asked * (gap if before > gap else min(gap, before + _MAX_CORRECTION * gap))
    if after >= wanted or give == 0.0:
        return False
    force = (wanted - after) / (stops.dt * give)
    for m in (e, e + 1, e + own, e + own + 1):
        add_force(stops, p, m, -0.25 * force * n_x, -0.25 * force * n_y, -0.25 * force * n_z)
    for m in range(9):
        f_x, f_y, f_z = closest_point_weights(foot, m)
        add_force(stops, q, first + m // 3 * s + m % 3, force * f_x, force * f_y, force * f_z)
    return True


@kernel(_nrt=False, forceinline=True)
def closest_point_weights(foot, m):
    """Normal of a foot times the weights (x, y, z) of node number m of the nine about it."""
    i, j = m // 3, m % 3
    w, v = foot[WEIGHTS_WARP + i], foot[WEIGHTS_WEFT + j]
    w_x, v_y = foot[WEIGHTS_WARP + 3] if i == 1 else w, foot[WEIGHTS_WEFT + 3] if j == 1 else v
    return w_x * v * foot[NORMAL], w * v_y * foot[NORMAL + 1], w * v * foot[NORMAL + 2]


@kernel(_nrt=False, forceinline=True)
def displacement_along(stops, p, k, n_x, n_y, n_z):
    """[m] way of a node in the step, along n."""
    at, to = stops.x, stops.x_next
    way = n_x * (to[p, 0, k] - at[p, 0, k]) + n_y * (to[p, 1, k] - at[p, 1, k])
    return way + n_z * (to[p, 2, k] - at[p, 2, k])


@kernel(_nrt=False, forceinline=True)
def triangle_distance(x, q, M, k, o, p_x, p_y, p_z):
    """Normal of the triangle from M to the nodes k and o of ply q, and how far a point is above it; 0 of a line."""
    a_x, a_y, a_z = x[q, 0, k] - M[0], x[q, 1, k] - M[1], x[q, 2, k] - M[2]
    b_x, b_y, b_z = x[q, 0, o] - M[0], x[q, 1, o] - M[1], x[q, 2, o] - M[2]
    n_x, n_y, n_z = a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x
    size = np.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    if size < 1e-16:
        return 0.0, 0.0, 0.0, 0.0
    n_x, n_y, n_z = n_x / size, n_y / size, n_z / size
    return n_x, n_y, n_z, n_x * (p_x - M[0]) + n_y * (p_y - M[1]) + n_z * (p_z - M[2])


@kernel(_nrt=False, forceinline=True)
def triangle_weights(stops, q, M0, M1, k, o, share, x0, y0, z0, x1, y1, z1):
    """Weights of the nodes k and o where a point is on a triangle, `share` of the step on its way."""
    m_x, m_y, m_z = M0[0] + share * (M1[0] - M0[0]), M0[1] + share * (M1[1] - M0[1]), M0[2] + share * (M1[2] - M0[2])
    A, B = stops.x, stops.x_next
    a_x = A[q, 0, k] + share * (B[q, 0, k] - A[q, 0, k]) - m_x
    a_y = A[q, 1, k] + share * (B[q, 1, k] - A[q, 1, k]) - m_y
    a_z = A[q, 2, k] + share * (B[q, 2, k] - A[q, 2, k]) - m_z
    b_x = A[q, 0, o] + share * (B[q, 0, o] - A[q, 0, o]) - m_x
    b_y = A[q, 1, o] + share * (B[q, 1, o] - A[q, 1, o]) - m_y
    b_z = A[q, 2, o] + share * (B[q, 2, o] - A[q, 2, o]) - m_z
    p_x, p_y, p_z = x0 + share * (x1 - x0) - m_x, y0 + share * (y1 - y0) - m_y, z0 + share * (z1 - z0) - m_z
    aa, ab, bb = a_x * a_x + a_y * a_y + a_z * a_z, a_x * b_x + a_y * b_y + a_z * b_z, b_x * b_x + b_y * b_y + b_z * b_z
    pa, pb = p_x * a_x + p_y * a_y + p_z * a_z, p_x * b_x + p_y * b_y + p_z * b_z
    det = aa * bb - ab * ab
    if det <= 1e-12 * aa * bb:
        return -1.0, -1.0
    return (bb * pa - ab * pb) / det, (aa * pb - ab * pa) / det


@kernel(_nrt=False, forceinline=True)
def mobility(stops, p, k, n_x, n_y):
    """Part of a way along n that a node may go; one on a plane of symmetry keeps to it."""
    s = stops.ply_shape[p, ROW_STRIDE]
    part = 1.0 - (n_x * n_x if stops.ply_shape[p, MIRROR_X] and k < s else 0.0)
    return max(part - (n_y * n_y if stops.ply_shape[p, MIRROR_Y] and k % s == 0 else 0.0), 0.0)


@kernel(_nrt=False, forceinline=True)
def add_force(stops, p, k, f_x, f_y, f_z):
    """A force on a node, and where that takes it."""
    i, j = k // stops.ply_shape[p, ROW_STRIDE], k % stops.ply_shape[p, ROW_STRIDE]
    f_x = 0.0 if i == 0 and stops.ply_shape[p, MIRROR_X] else f_x
    f_y = 0.0 if j == 0 and stops.ply_shape[p, MIRROR_Y] else f_y
    far, force, to = stops.dt * stops.dt_over_mass[p, k], stops.f, stops.x_next
    stops.last_moved[p, k] = stops.sweep[0]
    force[p, 0, k] += f_x
    force[p, 1, k] += f_y
    force[p, 2, k] += f_z
    to[p, 0, k] += far * f_x
    to[p, 1, k] += far * f_y
    to[p, 2, k] += far * f_z
    grow_window(stops.window[p], i, j, 1)
