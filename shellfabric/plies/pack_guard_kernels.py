"""The guard of a pack (`plies.guard_kernels`): in each step, before its forces have acted.

Places are in the frame of the first ply. Those after the step are predicted from all forces that will act in it. The
impulses are given as forces that act in this step alone. Their work is half a step's on the velocities before it, and
half a step's on those after it, as that of all forces is.
"""

import math

import numpy as np

from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import broadcast, head_mask, load, maximum, reduce_max, where
from shellfabric.plies import near_kernels as near
from shellfabric.plies.contact_kernels import forces_on, half_step_work, neighbour_force
from shellfabric.plies.contact_simd_kernels import extend_window
from shellfabric.plies.guard_kernels import project
from shellfabric.plies.turn_kernels import turn_of, turned, turned_back


@kernel(_nrt=False)
def hold_apart(states, consts, pairs, stack, guard):
    """Forces that keep the plies apart in the coming step, into guard.f, and half of their work."""
    for p in range(len(states)):
        if stack.awake[p]:
            follow(borrowed_item(states, p), borrowed_item(consts, p), guard, p)
    guard.count[near.STEP] += 1
    if guard.count[near.REMAKE] or near.tiles_have_moved(guard):
        for t in range(guard.travel.size):
            place_tile(states, guard, t)
        near.list_tiles(guard)
    guard.count[near.ROWS] = guard.count[near.NODES] = 0
    look_at_tiles(states, guard)
    look_at_facets(states, guard)
    if guard.count[near.ROWS] == 0:
        return
    predict(states, consts, pairs, guard)
    given, resolved = project(guard, guard.count[near.ROWS], guard.count[near.NODES])
    guard.energy[near.IMPULSES] += given
    if not resolved:
        guard.energy[near.FAILED] = near.NOT_RESOLVED
    if given > 0:
        give_forces(guard)
        for p in range(len(states)):
            if guard.window[p, 0] < guard.window[p, 1]:
                state, const = borrowed_item(states, p), borrowed_item(consts, p)
                guard.energy[near.WORK] -= half_step_work(state, const, guard.f[p], guard.window[p], False)


@kernel(_nrt=False)
def let_go(states, consts, guard):
    """Take the forces away after their step, and count the other half of their work."""
    for p in range(len(states)):
        if guard.window[p, 0] < guard.window[p, 1]:
            state, const = borrowed_item(states, p), borrowed_item(consts, p)
            guard.energy[near.WORK] -= half_step_work(state, const, guard.f[p], guard.window[p], True)


@kernel(_nrt=False)
def follow(state, const, guard, p):
    """The travels of the tiles of a ply, and those after as far a way as in the last step."""
    s, across = const.row_stride, guard.tiles_across[p]
    down, speed = (const.ni + near.TALL - 1) // near.TALL, guard.block_speed
    for i in range(down + 1):
        begin, end = max(i * near.TALL, state.active_rows[0]), min((i + 1) * near.TALL, state.active_rows[1] + 1)
        for j in range(across + 1):
            square, own = broadcast(0.0), head_mask(s - j * near.WIDE)
            for row in range(begin, end if j * near.WIDE < s else begin):
                k = row * s + j * near.WIDE
                x, y, z = load(state.v[0], k), load(state.v[1], k), load(state.v[2], k)
                square = maximum(square, where(own, x * x + y * y + z * z, 0.0))
            speed[i * (across + 1) + j] = reduce_max(square)
    for i in range(down):
        for j in range(across):
            b = i * (across + 1) + j
            square = max(max(speed[b], speed[b + 1]), max(speed[b + across + 1], speed[b + across + 2]))
            t, way = guard.first_tile[p] + i * across + j, const.dt * math.sqrt(square)
            guard.travel[t] += way
            guard.ahead[t] = guard.travel[t] + way


@kernel(_nrt=False)
def place_tile(states, guard, t):
    """Places of the nodes of a tile, and its box, if that has not been done in this step."""
    if guard.placed[t] == guard.count[near.STEP]:
        return
    guard.placed[t] = guard.count[near.STEP]
    p, i0, i1, j0, j1 = near.tile_bounds(guard, t)
    state, turn = borrowed_item(states, p), turn_of(guard.turns, p)
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            k = i * guard.shape[p, 0] + j
            g = p * guard.slots + k
            x, y = turned_back(turn, state.u[0][k], state.u[1][k])
            guard.x[g, 0], guard.x[g, 1] = guard.rest[g, 0] + x, guard.rest[g, 1] + y
            guard.x[g, 2] = guard.rest[g, 2] + state.u[2][k]
    near.set_box(guard, t)


@kernel(_nrt=False)
def look_at_tiles(states, guard):
    """Look at the pairs of tiles that can have come near, and at the tiles that can be near a plane of symmetry."""
    for m in range(guard.count[near.PAIRS]):
        a, b = guard.pair_tiles[m]
        if guard.pair_due[m] > guard.ahead[a] + guard.ahead[b]:
            continue
        place_tile(states, guard, a)
        place_tile(states, guard, b)
        apart, p, q = near.tiles_apart(guard, a, b), guard.tile_ply[a], guard.tile_ply[b]
        limit = 0.5 * near.NEAR * (guard.thickness[p] + guard.thickness[q])
        if apart > limit:
            guard.pair_due[m] = guard.travel[a] + guard.travel[b] + apart - limit
        else:
            first = near.list_facets(guard, borrowed_item(states, p), a, 0)
            near.list_near_facets(guard, m, first, near.list_facets(guard, borrowed_item(states, q), b, 1))
    for t in range(guard.travel.size if guard.has_planes else 0):
        if guard.plane_due[t] <= guard.ahead[t]:
            place_tile(states, guard, t)
            near.look_at_planes(guard, t)


@kernel(_nrt=False)
def look_at_facets(states, guard):
    """Rows of the guard of all listed pairs of facets that are near; the others stay in the list for as long as it is
    known when they can be."""
    kept = 0
    for e in range(guard.count[near.ENTRIES]):
        m = guard.entry_pair[e]
        a, b = guard.pair_tiles[m]
        if guard.entry_end[e] != guard.pair_due[m]:
            continue
        if kept != e:
            guard.entry_pair[kept], guard.entry_due[kept], guard.entry_end[kept] = (
                m,
                guard.entry_due[e],
                guard.pair_due[m],
            )
            for r in range(6):
                guard.entry_nodes[kept, r] = guard.entry_nodes[e, r]
        if guard.entry_due[kept] <= guard.ahead[a] + guard.ahead[b]:
            place_tile(states, guard, a)
            place_tile(states, guard, b)
            near.look_at_entry(guard, kept)
        kept += 1
    guard.count[near.ENTRIES] = kept


@kernel(_nrt=False)
def predict(states, consts, pairs, guard):
    """Places after the step of all nodes of the rows, by all known forces; lists these nodes."""
    for row in range(guard.count[near.ROWS]):
        for r in range(6):
            g = np.int64(guard.row_nodes[row, r])
            if g >= 0 and guard.node_step[g] != guard.count[near.STEP]:
                guard.node_step[g] = guard.count[near.STEP]
                guard.node_list[guard.count[near.NODES]] = g
                guard.count[near.NODES] += 1
                p = g // guard.slots
                v_x, v_y, v_z = next_velocity(
                    borrowed_item(states, p), borrowed_item(consts, p), pairs, p, g - p * guard.slots
                )
                v_x, v_y = turned_back(turn_of(guard.turns, p), v_x, v_y)
                for c, v in enumerate((v_x, v_y, v_z)):
                    kept = c < 2 and guard.mirror[g] >> c & 1
                    guard.y[g, c] = guard.x[g, c] + (0.0 if kept else guard.dt * v)
                    guard.impulse[g, c] = 0.0


@kernel(_nrt=False)
def next_velocity(state, const, pairs, p, k):
    """The velocity of a node in the coming step, by all forces but the guard's."""
    i, kick = k // const.row_stride, state.dt_over_mass[k]
    f_x, f_y, f_z = sum_at(state.f_int, k, (0.0, 0.0, 0.0))
    f_x, f_y, f_z = sum_at(state.f_contact, k, (f_x, f_y, f_z))
    if i > 0 and i % const.rows_per_block == 0:
        f_x, f_y, f_z = sum_at(state.f_int_above, k, (f_x, f_y, f_z))
    if const.has_backing:
        f_x, f_y, f_z = sum_at(state.f_block_cloth, k, (f_x, f_y, f_z))
    for n in forces_on(p, len(pairs)):
        f_x, f_y, f_z = sum_at(neighbour_force(pairs, n)[0], k, (f_x, f_y, f_z))
    return state.v[0][k] + kick * f_x, state.v[1][k] + kick * f_y, state.v[2][k] + kick * f_z


@kernel(_nrt=False, forceinline=True)
def sum_at(force, k, total):
    """A vector [N], and that of the nodal forces at node k."""
    return total[0] + force[0][k], total[1] + force[1][k], total[2] + force[2][k]


@kernel(_nrt=False)
def give_forces(guard):
    """The impulses as forces of a step, in the frames of the plies."""
    for m in range(guard.count[near.NODES]):
        g = guard.node_list[m]
        p = g // guard.slots
        k, s = g - p * guard.slots, guard.shape[p, 0]
        x, y, z = guard.impulse[g, 0] / guard.dt, guard.impulse[g, 1] / guard.dt, guard.impulse[g, 2] / guard.dt
        if x != 0.0 or y != 0.0 or z != 0.0:
            guard.f[p, 0, k], guard.f[p, 1, k] = turned(turn_of(guard.turns, p), x, y)
            guard.f[p, 2, k] = z
            extend_window(guard.window[p], k // s, k // s + 1, k % s, k % s + 1)
