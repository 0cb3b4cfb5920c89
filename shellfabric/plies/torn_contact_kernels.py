"""Predictive non-penetration constraints of torn plies: of the next ply, and through its holes of plies further on.

The contact of neighbouring plies (`plies.contact_kernels`) is one of surfaces with a side to each, followed from step
to step. Torn fabric has edges, is drawn to lines and turns over, and through a hole it meets plies that it has no foot
on. So beside torn fabric positions x' = x + dt v' after the coming step are predicted from all forces. The middle of an
element that would then be on the other side of a facet of another ply, or nearer to it than `gap`, gets the force along
the normal n of the facet that keeps it off, shared out by the weights w of its nodes and the facet's:

    f = (h - h') / (dt^2 sum w^2 / m),     h' = +-n.(x' - y')

h' counts from the side on which the point is; h is the gap, or a tenth of it more than the present distance where that
is less. It is the least that prevents the penetration, takes the speed of approach away, and gives none back. What one
force does another may undo, so all are swept again (Gauss-Seidel) until none is missing, or _MAX_SWEEPS times, and from
sweep to sweep the target is a smaller part of the gap. A pair none of whose nodes has moved since is skipped.

Looked at are the elements about torn ones, of the ply itself and of those next to it, against the other ply next to it
and those behind that where all plies between them are torn (uniform grids, `plies.broad_phase_kernels`). A facet is one
of four triangles between the nodes of an element and its middle. Where the next ply is whole a point is left to their
contact; what by that has come through may go back. A triangle whose normal turns by more than 60 degrees in the step
holds nothing.

Places are in the frame of the first ply, forces and velocities of a ply in its own (`plies.turn_kernels`). The work is
counted as that of all contact of plies is, half a step's of the old forces and half a step's of the new.
"""

from shellfabric.cloth import spline_kernels
from shellfabric.cloth.membrane_kernels import ERODED
from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import kernel
from shellfabric.panel.motion_kernels import FAILURES
from shellfabric.plies.broad_phase_kernels import (
    CORRECTIONS,
    ELEMENTS,
    MIRROR_X,
    MIRROR_Y,
    NODES,
    ROW_STRIDE,
    TORN,
    UNRESOLVED,
    WHOLE,
    WORK,
    collect_candidates,
    grid_clear,
    grid_insert,
)
from shellfabric.plies.constraint_kernels import resolve_pair
from shellfabric.plies.contact_kernels import (
    apply_symmetry,
    element_of_middle,
    forces_on,
    half_step_work,
    neighbour_force,
)
from shellfabric.plies.graded_kernels import add_line_offset
from shellfabric.plies.turn_kernels import turn_between, turn_of, turned_back

_TORN_NEIGHBOURS, _PLIES_AWAY = 3, 2  # elements about torn ones, plies whose tears count
_MAX_SWEEPS = 24


@kernel(_nrt=False)
def enforce_constraints(states, consts, pairs, stack, stops):
    """Forces that keep torn fabric from passing through other plies in the coming step, into stops.f."""
    failures = 0
    for p in range(len(states)):
        failures += stack.ply_counters[p, FAILURES]
    if failures == 0:
        return
    taken, count, half = 0.0, 0, len(pairs) // 2
    if failures != stops.failures[0]:
        stops.failures[0] = failures
        for p in range(len(states)):
            mark_zone(states, consts, stack, stops, p)
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
    project_constraints(stops, count)
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
                    m0, n0 = element_of_middle(turn_between(stops.turns, p, q), const, other, i, j)
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
            if near + (mark[k - s] + (mark[k - s - 1] if j > 0 else 0) if i > 0 else 0) > 0:
                stops.nodes[p, nodes] = k
                nodes += 1
    stops.counts[p, ELEMENTS], stops.counts[p, NODES] = elements, nodes
    for m in range(elements):
        k = stops.elements[p, m]
        if spline_kernels.neighbourhood_intact(borrowed_item(states, p), const, k // s, k % s):
            mark[k] = WHOLE


@kernel(_nrt=False)
def predict_state(states, consts, pairs, stops, p):
    """Places of the nodes of a ply now and after the next step, by all known forces, and where it has fabric."""
    predict_velocities(borrowed_item(states, p), borrowed_item(consts, p), stops, p)
    for n in forces_on(p, len(pairs)):
        add_impulses(stops, p, neighbour_force(pairs, n)[0])
    if p == len(states) - 1 and borrowed_item(consts, p).has_backing:
        add_impulses(stops, p, borrowed_item(states, p).f_block_cloth)
    predict_positions(stops, p)


@kernel(_nrt=False)
def predict_velocities(state, const, stops, p):
    """What a ply knows of itself: where it has fabric, places, and velocities by its own forces and the nose's."""
    for m in range(stops.counts[p, ELEMENTS]):
        stops.intact_quadrants[p, stops.elements[p, m]] = intact_quadrants(state, const, stops.elements[p, m])
    for m in range(stops.counts[p, NODES]):
        k = stops.nodes[p, m]
        i, j = k // const.row_stride, k % const.row_stride
        met = i > 0 and i % const.rows_per_block == 0
        x = add_line_offset(const.x0 + i * const.dx, const.line_offset1, i) + state.u[0][k]
        y = add_line_offset(const.y0 + j * const.dy, const.line_offset2, j) + state.u[1][k]
        stops.x[p, 0, k], stops.x[p, 1, k] = turned_back(turn_of(stops.turns, p), x, y)
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
        v_x, v_y = turned_back(turn_of(stops.turns, p), stops.x_next[p, 0, k], stops.x_next[p, 1, k])
        stops.x_next[p, 0, k], stops.x_next[p, 1, k] = v_x, v_y
        for c in range(3):
            kept = (c == 0 and stops.ply_shape[p, MIRROR_X] and k < stops.ply_shape[p, ROW_STRIDE]) or (
                c == 1 and stops.ply_shape[p, MIRROR_Y] and k % stops.ply_shape[p, ROW_STRIDE] == 0
            )
            stops.x_next[p, c, k] = stops.x[p, c, k] + (0.0 if kept else stops.dt * stops.x_next[p, c, k])


@kernel(_nrt=False)
def intact_quadrants(state, const, k):
    """Bit 2 a + b for the quarter of an element at the end a along the warp and b along the weft, if it has fabric."""
    if state.element_flag[k] == 0:
        return 15
    found = 0
    for m in range(0 if state.element_flag[k] & ERODED else 4):
        a, b = m >> 1, m & 1
        if state.intact_fraction[0][k + b] + state.intact_fraction[1][k + a * const.row_stride] > 0.0:
            found |= 1 << m
    return found


@kernel(_nrt=False)
def project_constraints(stops, count):
    """Keep the middles of the elements in the list off the facets that they are near."""
    held = 0
    for turn in range(_MAX_SWEEPS):
        held, fraction = 0, 1.0 - turn / _MAX_SWEEPS
        stops.sweep[0] += 1
        for m in range(count):
            if (turn == 0 or pair_has_moved(stops, m)) and resolve_pair(stops, m, fraction):
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
