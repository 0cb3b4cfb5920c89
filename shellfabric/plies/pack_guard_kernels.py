"""The guard of a pack (`plies.guard_kernels`): in each step, before its forces have acted.

Positions after the step are predicted from all forces that will act in it. The impulses are given as
forces that act in this step alone. Their work is half a step's on the velocities before it, and
half a step's on those after it, as that of all forces is.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import broadcast, head_mask, load, maximum, reduce_max, where
from shellfabric.jit.table import row_of
from shellfabric.plies import near_kernels as near
from shellfabric.plies.frame_kernels import mark_torn
from shellfabric.plies.guard_kernels import project_constraints
from shellfabric.plies.state import unit
from shellfabric.surface.grid_kernels import place, turned, turned_back
from shellfabric.surface.nodal_force_kernels import bounds, extend_window, half_step_work
from shellfabric.surface.vector_kernels import add, add_scaled, column, nodal, scaled


@unit()
def enforce_constraints(states, consts, contact):
    """Find the forces that keep the plies apart in the coming step, into guard.force, and add half
    of their work."""
    lists = contact.lists
    guard = contact.guard
    if lists.remake:
        for p in range(len(states)):
            state = row_of(states, p)
            const = row_of(consts, p)
            place(state, const, state.first_row, state.end_row)
            mark_torn(state, const, contact, p)
            update_displacements(state, const, contact, p)
        for t in range(lists.displacement.size):
            lists.displacement[t] = 0.0
            lists.plane_recheck_at[t] = 0.0
            lists.sorted_tiles[t] = t
    if lists.remake or near.lists_are_outdated(contact):
        lists.remake = 0
        for t in range(lists.displacement.size):
            near.refresh_box(contact, t)
        near.list_tiles(contact)
    guard.n_constraints = 0
    guard.n_nodes = 0
    check_tile_pairs(states, contact)
    check_facet_pairs(contact)
    if guard.n_constraints == 0:
        return
    predict_positions(states, consts, contact)
    given, resolved = project_constraints(contact, guard.n_constraints, guard.n_nodes)
    guard.n_impulses += given
    if not resolved:
        guard.fault = near.NOT_RESOLVED
    if given > 0:
        convert_impulses(contact)
        add_guard_work(states, consts, contact, False)


@unit()
def add_guard_work(states, consts, contact, let_go):
    """Add half of the work of the guard's forces: before their step, or after it, when they are
    taken away."""
    guard = contact.guard
    for p in range(len(states)):
        window = guard.window[p]
        first_row, end_row, _, _ = bounds(window)
        if first_row < end_row:
            state = row_of(states, p)
            const = row_of(consts, p)
            force = guard.force[p]
            guard.work -= half_step_work(state, const, force, window, let_go)


@unit()
def update_displacements(state, const, contact, p):
    """Set the displacement of each tile of a ply in the last step, the largest of its nodes', and
    add it to what the tile has made so far."""
    lists = contact.lists
    s = const.row_stride
    across = lists.tiles_across[p]
    down = (const.ni + near.TALL - 1) // near.TALL
    speed = lists.squared_speed[p]
    for i in range(down + 1):
        begin = max(i * near.TALL, state.first_row)
        end = min((i + 1) * near.TALL, state.end_row + 1)
        for j in range(across + 1):
            square = broadcast(0.0)
            own = head_mask(s - j * near.WIDE)
            if j * near.WIDE >= s:
                end = begin  # there are no nodes
            for row in range(begin, end):
                k = row * s + j * near.WIDE
                x = load(state.v[0], k)
                y = load(state.v[1], k)
                z = load(state.v[2], k)
                square = maximum(square, where(own, x * x + y * y + z * z, 0.0))
            speed[i * (across + 1) + j] = reduce_max(square)
    for i in range(down):
        for j in range(across):
            b = i * (across + 1) + j
            square = max(
                max(speed[b], speed[b + 1]), max(speed[b + across + 1], speed[b + across + 2])
            )
            t = lists.first_tile[p] + i * across + j
            lists.step_displacement[t] = const.dt * math.sqrt(square)
            lists.displacement[t] += lists.step_displacement[t]


@kernel(_nrt=False)
def check_tile_pairs(states, contact):
    """Check the pairs of tiles that can have come near, and the tiles that can be near a plane of
    symmetry."""
    lists = contact.lists
    for m in range(lists.n_tile_pairs):
        a, b = lists.tile_pairs[m]
        if lists.pair_recheck_at[m] > next_displacement(contact, a, b):
            continue
        near.refresh_box(contact, a)
        near.refresh_box(contact, b)
        apart = near.tiles_apart(contact, a, b)
        p = lists.tile_ply[a]
        q = lists.tile_ply[b]
        limit = near.guarded_distance(contact, a, b)
        if apart > limit:
            lists.pair_recheck_at[m] = near.pair_displacement(lists, a, b) + apart - limit
        else:
            first = near.list_facets(contact, row_of(states, p), a, 0)
            near.list_near_facets(
                contact, m, first, near.list_facets(contact, row_of(states, q), b, 1)
            )
    if not (contact.mirror_x or contact.mirror_y):
        return
    for t in range(lists.displacement.size):
        if lists.plane_recheck_at[t] <= lists.displacement[t] + lists.step_displacement[t]:
            near.check_planes(contact, t)


@kernel(_nrt=False, forceinline=True)
def next_displacement(contact, a, b):
    """Return the sum of the displacements [m] of two tiles after another step like the last."""
    lists = contact.lists
    return (
        lists.displacement[a]
        + lists.step_displacement[a]
        + lists.displacement[b]
        + lists.step_displacement[b]
    )


@kernel(_nrt=False)
def check_facet_pairs(contact):
    """Constrain all listed pairs of facets that are near; the others stay in the list for as long
    as it is known when they can be."""
    lists = contact.lists
    kept = 0
    for e in range(lists.n_facet_pairs):
        m = lists.facet_pair_tiles[e]
        a, b = lists.tile_pairs[m]
        if lists.facet_pair_listing[e] != lists.pair_recheck_at[m]:
            continue
        if kept != e:
            lists.facet_pair_tiles[kept] = m
            lists.facet_recheck_at[kept] = lists.facet_recheck_at[e]
            lists.facet_pair_listing[kept] = lists.pair_recheck_at[m]
            for r in range(6):
                lists.facet_pairs[kept, r] = lists.facet_pairs[e, r]
        if lists.facet_recheck_at[kept] <= next_displacement(contact, a, b):
            near.check_facet_pair(contact, kept)
        kept += 1
    lists.n_facet_pairs = kept


@unit()
def predict_positions(states, consts, contact):
    """Predict the positions after the step of all nodes of the constraints, by all known forces,
    and list these nodes."""
    guard = contact.guard
    for row in range(guard.n_constraints):
        for r in range(6):
            g = np.int64(guard.constraint_nodes[row, r])
            if g >= 0 and guard.predicted_step[g] != contact.step:
                guard.predicted_step[g] = contact.step
                guard.nodes[guard.n_nodes] = g
                guard.n_nodes += 1
                p = g // contact.slots_per_ply
                v = next_velocity(
                    row_of(states, p),
                    row_of(consts, p),
                    contact,
                    p,
                    own_number(contact, g),
                )
                v_x, v_y = turned_back(contact.turns[p], v[0], v[1])
                for c, speed in enumerate((v_x, v_y, v[2])):
                    kept = c < 2 and contact.plane_bits[g] >> c & 1
                    guard.predicted_x[c, g] = contact.x[c, g]
                    if not kept:
                        guard.predicted_x[c, g] += contact.dt * speed
                    guard.impulse[c, g] = 0.0


@kernel(_nrt=False, forceinline=True)
def own_number(contact, g):
    """Return the number of a node of the grids in the arrays of its own ply."""
    p = g // contact.slots_per_ply
    i, j = divmod(g - contact.base[p], contact.row_stride[p])
    return i * (contact.nj[p] + 1) + j


@kernel(_nrt=False)
def next_velocity(state, const, contact, p, k):
    """Return the velocity of a node in the coming step, by all forces but the guard's."""
    force = add(force_without_nose(state, const, contact, p, k), nodal(state.f_contact, k))
    return add_scaled(nodal(state.v, k), state.dt_over_mass[k], force)


@kernel(_nrt=False)
def force_without_nose(state, const, contact, p, k):
    """Return the force on node k of ply p of its fabric, of other plies and of a block."""
    pressure = contact.pressure
    force = add(nodal(state.f_int, k), nodal(state.f_int_above, k))
    if const.has_backing:
        force = add(force, nodal(state.f_block_cloth, k))
    for side in range(2):
        force = add(force, nodal(pressure.force[p, side], k))
    return force


@unit()
def convert_impulses(contact):
    """Convert the impulses to forces of a step, in the frames of the plies."""
    guard = contact.guard
    for m in range(guard.n_nodes):
        g = guard.nodes[m]
        p = g // contact.slots_per_ply
        k = own_number(contact, g)
        x, y, z = scaled(1.0 / contact.dt, column(guard.impulse, 0, g))
        if x != 0.0 or y != 0.0 or z != 0.0:
            f_x, f_y = turned(contact.turns[p], x, y)
            force = guard.force[p]
            force[0, k] = f_x
            force[1, k] = f_y
            force[2, k] = z
            i, j = divmod(k, contact.nj[p] + 1)
            extend_window(guard.window[p], i, i + 1, j, j + 1)
