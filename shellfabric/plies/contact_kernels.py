"""Contact of neighbouring plies: pressure against closure between two smooth surfaces, point by point.

Each element of the front ply, which the projectile meets first, carries p x p points x of its spline surface
(`plies.surface_kernels`). y is the closest point of the rear ply's surface, n the normal there, the way that the shot
flies, t the mean thickness of the two plies:

    depth = t - n.(y - x),      f = max(0, A p(d) + c n.(v_x - v_y)),     d = depth - offset

with the law p (`plies.law_kernels`) and the area A of the point. -f n acts on the nodes of the front ply by their
weights in x, f n on those of the rear ply by their weights in y: the sum is zero to the last digits. Which side of the
fabric a point is on, the offset, failed yarns: docs/theory-panel.md, "Packs: contact between plies". What this contact
would let through, the guard stops (`plies.guard_kernels`). Naive forms, for comparison: nodes of the front ply against
the bilinear facets of the rear one (FACETS), or against the node there, along z (NODES).

Which points are computed: a box about the nodes of each ply that are deflected by more than a quarter of the gap, three
elements wider, is renewed every eight steps. A point that is clear of the other ply is skipped for as long as it would
need to get there at one and a half times the highest speeds of both plies. Most are computed eight at once
(`plies.contact_simd_kernels`). Beside failed yarns both plies have points (`contact_forces_back`), with half the law.
Plies at other angles (`plies.turn_kernels`) meet in the frame of the rear one, their points one at a time.

Work: half a step's of the old forces and half a step's of the new on the same velocities, summed over the nodes, which
balances to the last digits whatever the weights. Friction acts at the same points (`plies.ply_friction_kernels`).
"""

import math

from numba import types
from numba.extending import overload, register_jitable

from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    fabs,
    fma,
    greater,
    head_mask,
    load,
    masked_store,
    maximum,
    movemask,
    reduce_add,
    reduce_max,
    where,
)
from shellfabric.panel.motion_kernels import FAILURES
from shellfabric.plies.contact_simd_kernels import (
    MAX_DEPTH,
    MAX_STEPS_SKIPPED,
    SPRING,
    WORK,
    contact_points8,
)
from shellfabric.plies.graded_kernels import add_line_offset, add_middle_offset, place_in_elements
from shellfabric.plies.normal_force_kernels import clear_normal_forces
from shellfabric.plies.ply_friction_kernels import friction_forces
from shellfabric.plies.point_kernels import contact_point, take_over_contact
from shellfabric.plies.surface_kernels import SMOOTH, point_number
from shellfabric.plies.turn_kernels import turned_back

_SCAN_INTERVAL, _MARGIN = 8, 3  # steps between scans, elements about what they find
_SPEED_MARGIN = 1.5  # than at the last scan nodes may become
_TORN_NEIGHBOURS = 3  # elements about torn ones that count as beside them
_KNOWN, _NEW = 1, 2  # of pair.near_torn: beside torn fabric, and since this step


@kernel(_nrt=False)
def scan_deflections(state, const, least, box):
    """Widen the box (first and last row, and column, of nodes) to all that are deflected by more than `least`.

    Returns the highest speed of a node.
    """
    s, fastest = const.row_stride, broadcast(0.0)
    for i in range(const.ni + 1):
        for j in range(0, s, WIDTH):
            k, own = i * s + j, head_mask(s - j)
            v_x, v_y, v_z = load(state.v[0], k), load(state.v[1], k), load(state.v[2], k)
            fastest = maximum(fastest, where(own, v_x * v_x + v_y * v_y + v_z * v_z, 0.0))
            if box[0] <= i <= box[1] and box[2] <= j and j + WIDTH <= box[3] + 1:
                continue
            beyond = movemask(own) & movemask(greater(fabs(load(state.u[2], k)), least))
            for m in range(WIDTH if beyond != 0 else 0):
                if (beyond >> m) & 1:
                    box[0], box[1] = min(box[0], i), max(box[1], i)
                    box[2], box[3] = min(box[2], j + m), max(box[3], j + m)
    return math.sqrt(reduce_max(fastest))


@kernel(_nrt=False, forceinline=True)
def half_step_work(state, const, force, touched, over):
    """Half a step's work of the nodal forces on the present velocities, which are those of half a step ago; takes them
    away where they are `over`."""
    work, none = broadcast(0.0), broadcast(0.0)
    for i in range(touched[0], touched[1]):
        for j in range(touched[2], touched[3], WIDTH):
            k, inside = i * const.row_stride + j, head_mask(touched[3] - j)
            power = load(force[0], k) * load(state.v[0], k)
            power = fma(load(force[1], k), load(state.v[1], k), power)
            power = fma(load(force[2], k), load(state.v[2], k), power)
            work = work + where(inside, power, 0.0)
            if over:
                masked_store(force[0], k, none, touched[3] - j)
                masked_store(force[1], k, none, touched[3] - j)
                masked_store(force[2], k, none, touched[3] - j)
    if over:
        touched[0], touched[1], touched[2], touched[3] = const.ni + 1, 0, const.row_stride, 0
    return 0.5 * const.dt * reduce_add(work)


@kernel(_nrt=False)
def apply_symmetry(const, force, touched):
    """Nodes on a plane of symmetry keep to it."""
    if const.mirror_x and touched[0] == 0:
        for k in range(touched[2], touched[3]):
            force[0][k] = 0.0
    if const.mirror_y and touched[2] == 0:
        for i in range(touched[0], touched[1]):
            force[1][i * const.row_stride] = 0.0


@kernel(_nrt=False, forceinline=True)
def place_on(const, turn, x, y):
    """[elements] place on a ply at rest of a point (x, y) [m] of another ply's frame; turn : from its own to that."""
    x, y = turned_back(turn, x, y)
    return (
        place_in_elements(x - const.x0, const.dx, const.line_offset1, const.ni),
        place_in_elements(y - const.y0, const.dy, const.line_offset2, const.nj),
    )


@kernel(_nrt=False, forceinline=True)
def element_of_node(pair, fc, rc, i, j):
    """Element (row, column) of the front ply in which node (i, j) of the rear ply is at rest."""
    x = add_line_offset(rc.x0 + i * rc.dx, rc.line_offset1, i)
    y = add_line_offset(rc.y0 + j * rc.dy, rc.line_offset2, j)
    row, column = place_on(fc, pair.turn, x, y)
    return int(row), int(column)


@kernel(_nrt=False, forceinline=True)
def element_of_middle(turn, fc, rc, i, j):
    """Element (row, column) of the front ply in which the middle of element (i, j) of the rear ply is at rest.

    turn : from the frame of the front ply to that of the rear one
    """
    x = add_middle_offset(rc.x0 + (i + 0.5) * rc.dx, rc.line_offset1, i)
    y = add_middle_offset(rc.y0 + (j + 0.5) * rc.dy, rc.line_offset2, j)
    row, column = place_on(fc, turn, x, y)
    return int(row), int(column)


@kernel(_nrt=False, forceinline=True)
def candidate_window(pair, fc, rc):
    """Element rows and columns of the front ply where either ply's deflection can bring them into contact."""
    i0, i1, j0, j1 = pair.front_box[0], pair.front_box[1], pair.front_box[2], pair.front_box[3]
    if pair.rear_box[0] <= pair.rear_box[1]:
        for corner in range(4):
            i, j = element_of_node(pair, fc, rc, pair.rear_box[corner & 1], pair.rear_box[2 + (corner >> 1)])
            i0, i1, j0, j1 = min(i0, i), max(i1, i + 1), min(j0, j), max(j1, j + 1)
    return max(i0 - _MARGIN, 0), min(i1 + _MARGIN, fc.ni), max(j0 - _MARGIN, 0), min(j1 + _MARGIN, fc.nj)


def contact_row8(turn, front, fc, rear, rc, pair, q, count, nearer, now, due):
    """`contact_points8` of eight points side by side: those that are left for `contact_point`, energy; of turned plies,
    whose points side by side have no closest points side by side, all are."""


@overload(contact_row8, inline="always")
def _contact_row8(turn, front, fc, rear, rc, pair, q, count, nearer, now, due):
    if isinstance(turn, types.NoneType):
        return lambda turn, front, fc, rear, rc, pair, q, count, nearer, now, due: contact_points8(
            front, fc, rear, rc, pair, q, count, nearer, now, due
        )
    return lambda turn, front, fc, rear, rc, pair, q, count, nearer, now, due: (due, 0.0)


@kernel(_nrt=False, forceinline=True)
def contact_forces(front, fc, rear, rc, pair, twin, step):
    """Forces between two plies at their present positions, into pair.f_front and pair.f_rear.

    twin : Pair with the points of the rear ply
    """
    if step % _SCAN_INTERVAL == 0:
        pair.max_speed[0] = scan_deflections(front, fc, pair.min_deflection, pair.front_box)
        pair.max_speed[1] = scan_deflections(rear, rc, pair.min_deflection, pair.rear_box)
    mark_torn(front, fc, rear, rc, pair)
    mark_torn(rear, rc, front, fc, twin)
    book(front, fc, rear, rc, pair, True)
    i0, i1, j0, j1 = candidate_window(pair, fc, rc)
    p, spring, now, often = pair.points_per_side**2, 0.0, float(step), step % _SCAN_INTERVAL == 0
    shot = math.sqrt(
        front.projectile_velocity[0] ** 2 + front.projectile_velocity[1] ** 2 + front.projectile_velocity[2] ** 2
    )
    nearer = _SPEED_MARGIN * fc.dt * (max(pair.max_speed[0], shot) + max(pair.max_speed[1], shot))
    for row in range(i0 * p, i1 * p):
        start, end = row * fc.nj + j0, row * fc.nj + j1
        clear_normal_forces(pair.normal_force, start, end)
        for q0 in range(start, end, WIDTH):
            count = min(WIDTH, end - q0)
            due = movemask(head_mask(count)) & ~movemask(greater(load(pair.recheck_step, q0), now))
            if due != 0 and pair.surface_form == SMOOTH:
                due, energy = contact_row8(pair.turn, front, fc, rear, rc, pair, q0, count, nearer, now, due)
                spring += energy
            if due == 0:
                continue
            for q in range(q0, q0 + count):
                if (due >> (q - q0)) & 1 == 0:
                    continue
                energy, depth = contact_point(front, fc, rear, rc, pair, twin, q, often)
                if depth < 0.0:
                    pair.recheck_step[q] = now + 1.0 + steps_until_contact(depth, nearer)
                spring += energy
                pair.energy[MAX_DEPTH] = max(pair.energy[MAX_DEPTH], depth)
        friction_forces(pair.friction_state, front, fc, rear, rc, pair, start, end)
    book(front, fc, rear, rc, pair, False)
    pair.energy[SPRING] = spring


@kernel(_nrt=False)
def book(front, fc, rear, rc, pair, over):
    """Book half a step's work of the forces of a pair: of those of the last step, which are `over`, or of the new."""
    if not over:
        apply_symmetry(fc, pair.f_front, pair.front_window)
        apply_symmetry(rc, pair.f_rear, pair.rear_window)
    pair.energy[WORK] -= half_step_work(front, fc, pair.f_front, pair.front_window, over)
    pair.energy[WORK] -= half_step_work(rear, rc, pair.f_rear, pair.rear_window, over)


@kernel(_nrt=False, forceinline=True)
def contact_forces_back(front, fc, rear, rc, pair, twin, step):
    """As `contact_forces`, which is called first, for the points beside torn fabric of a ply that lies behind, on the
    one before it."""
    if pair.torn_counts[1] == 0:
        return
    book(front, fc, rear, rc, pair, True)
    spring, often = 0.0, step % _SCAN_INTERVAL == 0
    for e in pair.torn_elements[: pair.torn_counts[1]]:
        for m in range(pair.points_per_side**2):
            q = point_number(fc, pair, e // fc.nj, e % fc.nj, m)
            clear_normal_forces(pair.normal_force, q, q + 1)
            if pair.near_torn[e] == _NEW:
                take_over_contact(fc, rc, pair, twin, q)
            energy, depth = contact_point(front, fc, rear, rc, pair, twin, q, often)
            spring += energy
            pair.energy[MAX_DEPTH] = max(pair.energy[MAX_DEPTH], depth)
            friction_forces(pair.friction_state, front, fc, rear, rc, pair, q, q + 1)
        pair.near_torn[e] = _KNOWN
    book(front, fc, rear, rc, pair, False)
    pair.energy[SPRING] = spring


@kernel(_nrt=False, forceinline=True)
def mark_torn(front, fc, rear, rc, pair):
    """List, when more yarns have failed, the elements of the front ply that are next to torn ones of either ply."""
    failures = front.counter[FAILURES] + rear.counter[FAILURES]
    pair.torn_counts[2] = failures - pair.torn_counts[0]
    if pair.torn_counts[2] != 0:
        pair.torn_counts[0] = failures
        list_torn_elements(front, fc, rear, rc, pair)


@kernel(_nrt=False)
def list_torn_elements(front, fc, rear, rc, pair):
    """The elements of the front ply that are next to torn ones of either ply, into pair.near_torn and
    pair.torn_elements."""
    pair.torn_counts[1] = 0
    for i in range(fc.ni):
        for j in range(fc.nj):
            if front.element_flag[i * fc.row_stride + j]:
                mark_neighbours(fc, pair, i, j)
    for i in range(rc.ni):
        for j in range(rc.nj):
            if rear.element_flag[i * rc.row_stride + j]:
                m, n = element_of_middle(pair.turn, fc, rc, i, j)
                mark_neighbours(fc, pair, m, n)
    for e in range(fc.ni * fc.nj):
        if pair.near_torn[e]:
            pair.torn_elements[pair.torn_counts[1]] = e
            pair.torn_counts[1] += 1


@kernel(_nrt=False)
def mark_neighbours(const, pair, i, j):
    """Mark the elements about (i, j)."""
    for m in range(max(i - _TORN_NEIGHBOURS, 0), min(i + _TORN_NEIGHBOURS + 1, const.ni)):
        for n in range(max(j - _TORN_NEIGHBOURS, 0), min(j + _TORN_NEIGHBOURS + 1, const.nj)):
            if pair.near_torn[m * const.nj + n] == 0:
                pair.near_torn[m * const.nj + n] = _NEW


@kernel(_nrt=False, forceinline=True)
def steps_until_contact(depth, nearer):
    """Steps for which a point that is clear by -depth [m] can be skipped, where it comes nearer by `nearer` in each."""
    return float(MAX_STEPS_SKIPPED) if -depth > MAX_STEPS_SKIPPED * nearer else math.floor(-depth / nearer)


@register_jitable
def forces_on(p, pairs):
    """Numbers of the forces of its neighbours on ply p, of a pack with so many pairs; see `side_of`."""
    return range(max(4 * p - 2, 0), min(4 * p + 2, 2 * pairs))


@register_jitable
def side_of(n, pairs):
    """Where force number n is: (number of the pair, whether it is that on the pair's front ply).

    Each two neighbours have four, two on the ply before, then two on the one behind; of two the first is of the pair
    whose points the ply before has.
    """
    return n // 4 + n % 2 * (pairs // 2), n % 4 in (0, 3)


@kernel(_nrt=False, forceinline=True)
def neighbour_force(pairs, n):
    """Force number n of `forces_on`: (nodal forces, window of nodes)."""
    number, on_front = side_of(n, len(pairs))
    pair = borrowed_item(pairs, number)
    return (pair.f_front, pair.front_window) if on_front else (pair.f_rear, pair.rear_window)


@kernel(_nrt=False)
def apply_impulses(state, const, force, touched):
    """v += dt f / m of a ply, with the contact forces of a neighbour; widens its window of active rows to them. Whether
    there are any."""
    if touched[1] <= touched[0]:
        return False
    for i in range(touched[0], touched[1]):
        for j in range(touched[2], touched[3], WIDTH):
            k, count = i * const.row_stride + j, touched[3] - j
            kick = load(state.dt_over_mass, k)
            masked_store(state.v[0], k, fma(kick, load(force[0], k), load(state.v[0], k)), count)
            masked_store(state.v[1], k, fma(kick, load(force[1], k), load(state.v[1], k)), count)
            masked_store(state.v[2], k, fma(kick, load(force[2], k), load(state.v[2], k)), count)
    state.active_rows[0] = min(state.active_rows[0], max(touched[0] - 4, 0))
    state.active_rows[1] = max(state.active_rows[1], min(touched[1] + 3, const.ni))
    return True
