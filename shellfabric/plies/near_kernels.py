"""Which facets of different plies are near each other, in lists that are remade after a motion.

A tile is TALL by WIDE elements of a ply. Its travel is the sum over steps of the largest way of its nodes, with the way
that they would make in the coming step. What is `gap` [m] apart is looked at again when the travels of both its tiles
have grown by gap - near [m] together: it cannot have come nearer than `near` before. That holds of pairs of tiles, of
pairs of facets of these, and of a tile and a plane of symmetry.

    pairs of tiles   all whose boxes are within _TILE_REACH thicknesses; found anew when a tile has come that far
    pairs of facets  of tiles that no plane divides: all whose boxes are within _REACH thicknesses; found anew likewise
    rows             those that are nearer than `near`, in each step, for the guard (`plies.guard_kernels`)

An element is two triangles where it has yarns of both families and has not eroded, and, once torn, is not drawn out to
more than twice its size. What has ceased to be one never is one again. Yarns beside no such element are bare.
"""

import math

from shellfabric.cloth.membrane_kernels import ERODED
from shellfabric.jit.compile import kernel
from shellfabric.panel.motion_kernels import FAILURES
from shellfabric.plies.guard_kernels import PLANE_X, PLANE_Y, needed
from shellfabric.plies.separation_kernels import cross, difference, dot, lower_bound, separation

TALL, WIDE = 4, 8  # elements of a tile
NEAR = 0.3  # thicknesses within which facets have to stay on their sides
PAIRS, ENTRIES, ROWS, NODES, STEP, REMAKE = range(6)  # of guard.count
WORK, IMPULSES, LEAST, FAILED = range(4)  # of guard.energy
NOT_RESOLVED, NO_ROOM, CROSSED = 1, 2, 3  # of guard.energy[FAILED]
_TILE_REACH, _REACH = 2.0, 0.4  # thicknesses
_DRAWN_OUT = 4.0  # square of the length of a diagonal of a torn element over that at rest


@kernel(_nrt=False, forceinline=True)
def tile_bounds(guard, t):
    """Ply of a tile, and its first and last rows and columns of nodes."""
    p = guard.tile_ply[t]
    i, j = divmod(t - guard.first_tile[p], guard.tiles_across[p])
    ni, nj = guard.shape[p, 1], guard.shape[p, 2]
    return p, i * TALL, min((i + 1) * TALL, ni), j * WIDE, min((j + 1) * WIDE, nj)


@kernel(_nrt=False)
def set_box(guard, t):
    """The box of a tile, into guard.box."""
    p, i0, i1, j0, j1 = tile_bounds(guard, t)
    for c in range(3):
        low, high = 1e30, -1e30
        for i in range(i0, i1 + 1):
            k = p * guard.slots + i * guard.shape[p, 0]
            for x in guard.x[k + j0 : k + j1 + 1, c]:
                low, high = min(low, x), max(high, x)
        guard.box[t, c], guard.box[t, 3 + c] = low, high


@kernel(_nrt=False, forceinline=True)
def boxes_apart(box, other):
    """[m] by which two boxes are apart along an axis at least."""
    gap = -1e30
    for c in range(3):
        gap = max(gap, max(box[c] - other[3 + c], other[c] - box[3 + c]))
    return gap


@kernel(_nrt=False)
def list_tiles(guard):
    """Pairs of tiles of different plies that are within reach, and the order of the tiles along x."""
    tiles, order = guard.travel.size, guard.order
    for n in range(1, tiles):  # nearly in order already
        t, m = order[n], n - 1
        while m >= 0 and guard.box[order[m], 0] > guard.box[t, 0]:
            order[m + 1] = order[m]
            m -= 1
        order[m + 1] = t
    reach, found = _TILE_REACH * guard.thickest, 0
    for n in range(tiles):
        a = order[n]
        for m in range(n + 1, tiles):
            b = order[m]
            if guard.box[b, 0] > guard.box[a, 3] + reach:
                break
            if guard.tile_ply[a] != guard.tile_ply[b] and boxes_apart(guard.box[a], guard.box[b]) <= reach:
                if found == guard.pair_due.size:
                    guard.energy[FAILED] = NO_ROOM
                    break
                guard.pair_tiles[found, 0], guard.pair_tiles[found, 1] = a, b
                guard.pair_due[found] = -1e30
                found += 1
    guard.count[PAIRS], guard.count[ENTRIES], guard.count[REMAKE] = found, 0, 0
    for t in range(tiles):
        guard.travel_then[t] = guard.travel[t]


@kernel(_nrt=False, forceinline=True)
def tiles_have_moved(guard):
    """Whether a tile has come so far that pairs may have come within reach that are not in the list."""
    furthest = 0.0
    for t in range(guard.travel.size):
        furthest = max(furthest, guard.ahead[t] - guard.travel_then[t])
    return 2.0 * furthest > (_TILE_REACH - NEAR) * guard.thickest


@kernel(_nrt=False, forceinline=True)
def mean_normal(guard, t):
    """Unit vector across the diagonals of a tile; 0 of one without any."""
    p, i0, i1, j0, j1 = tile_bounds(guard, t)
    s, k = guard.shape[p, 0], p * guard.slots
    u = difference(guard.x, k + i0 * s + j0, k + i1 * s + j1)
    v = difference(guard.x, k + i1 * s + j0, k + i0 * s + j1)
    n = cross(u, v)
    size = math.sqrt(dot(n, n))
    return (n[0] / size, n[1] / size, n[2] / size) if size > 0.0 else (0.0, 0.0, 0.0)


@kernel(_nrt=False)
def tile_span(guard, t, n):
    """The least and the largest of n.x over the nodes of a tile."""
    p, i0, i1, j0, j1 = tile_bounds(guard, t)
    low, high = 1e30, -1e30
    for i in range(i0, i1 + 1):
        k = p * guard.slots + i * guard.shape[p, 0]
        for m in range(k + j0, k + j1 + 1):
            along = n[0] * guard.x[m, 0] + n[1] * guard.x[m, 1] + n[2] * guard.x[m, 2]
            low, high = min(low, along), max(high, along)
    return low, high


@kernel(_nrt=False)
def tiles_apart(guard, a, b):
    """[m] that two tiles are apart at least, by their boxes and their mean normals."""
    found = boxes_apart(guard.box[a], guard.box[b])
    for t in (a, b):
        if found < NEAR * guard.thickest:
            n = mean_normal(guard, t)
            low, high = tile_span(guard, a, n)
            other_low, other_high = tile_span(guard, b, n)
            found = max(found, max(other_low - high, low - other_high))
    return found


@kernel(_nrt=False, forceinline=True)
def is_facet(guard, state, p, k):
    """Whether element k of ply p is fabric with a yarn of each family; it stays none."""
    g, s, flag = p * guard.slots + k, guard.shape[p, 0], state.element_flag[k]
    if flag != 0 and guard.dropped[g] == 0:
        warp, weft = state.intact_fraction[0], state.intact_fraction[1]
        cut = warp[k] + warp[k + 1] == 0.0 or weft[k] + weft[k + s] == 0.0
        if cut or flag & ERODED or drawn_out(guard, g, s):
            guard.dropped[g] = 1
    return guard.dropped[g] == 0


@kernel(_nrt=False, forceinline=True)
def drawn_out(guard, g, s):
    """Whether a torn element joins pieces that have parted."""
    for a, b in ((g, g + s + 1), (g + 1, g + s)):
        now, rest = difference(guard.x, a, b), difference(guard.rest, a, b)
        if dot(now, now) > _DRAWN_OUT * dot(rest, rest):
            return True
    return False


@kernel(_nrt=False)
def list_facets(guard, state, t, side):
    """The facets of a tile, into guard.facets[side]; their number."""
    p, i0, i1, j0, j1 = tile_bounds(guard, t)
    s, ni, nj, first, found = guard.shape[p, 0], guard.shape[p, 1], guard.shape[p, 2], p * guard.slots, 0
    for i in range(i0, i1):
        for j in range(j0, j1):
            k = i * s + j
            if is_facet(guard, state, p, k):
                found = add_facet(guard, side, found, first + k, first + k + s, first + k + s + 1)
                found = add_facet(guard, side, found, first + k, first + k + s + 1, first + k + 1)
    if state.counter[FAILURES] == 0:
        return found
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            k = i * s + j
            here = i < ni and j < nj and guard.dropped[first + k] == 0
            above = i > 0 and j < nj and guard.dropped[first + k - s] == 0
            before = j > 0 and i < ni and guard.dropped[first + k - 1] == 0
            if j < j1 and state.intact_fraction[1][k] > 0.0 and not (here or above):
                found = add_facet(guard, side, found, first + k, first + k + 1, first + k + 1)
            if i < i1 and state.intact_fraction[0][k] > 0.0 and not (here or before):
                found = add_facet(guard, side, found, first + k, first + k + s, first + k + s)
    return found


@kernel(_nrt=False, forceinline=True)
def add_facet(guard, side, found, a, b, c):
    """Put a facet and its box at place `found`; the next place."""
    nodes, box = guard.facets[side, found], guard.facet_box[side, found]
    nodes[0], nodes[1], nodes[2] = a, b, c
    for r in range(3):
        u, v, w = guard.x[a, r], guard.x[b, r], guard.x[c, r]
        box[r], box[3 + r] = min(u, min(v, w)), max(u, max(v, w))
    return found + 1


@kernel(_nrt=False)
def list_near_facets(guard, m, first, second):
    """List the pairs within reach of `first` and `second` facets of pair of tiles m, with when they can be near."""
    a, b = guard.pair_tiles[m]
    thickness = 0.5 * (guard.thickness[guard.tile_ply[a]] + guard.thickness[guard.tile_ply[b]])
    reach, near, found = (NEAR + _REACH) * thickness, NEAR * thickness, guard.count[ENTRIES]
    guard.pair_due[m] = guard.travel[a] + guard.travel[b] + _REACH * thickness
    for i in range(first):
        if boxes_apart(guard.facet_box[0, i], guard.box[b]) > reach:
            continue
        for j in range(second):
            if boxes_apart(guard.facet_box[0, i], guard.facet_box[1, j]) > reach:
                continue
            if found == guard.entry_due.size:
                guard.energy[FAILED] = NO_ROOM
                return
            nodes = guard.entry_nodes[found]
            for r in range(3):
                nodes[r], nodes[3 + r] = guard.facets[0, i, r], guard.facets[1, j, r]
            apart = lower_bound(guard.x, nodes)
            if apart > reach:
                continue
            guard.entry_pair[found], guard.entry_end[found] = m, guard.pair_due[m]
            guard.entry_due[found] = guard.travel[a] + guard.travel[b] + apart - near
            found += 1
    guard.count[ENTRIES] = found


@kernel(_nrt=False, forceinline=True)
def add_row(guard, nodes, n, distance, thickness):
    """A row of the guard."""
    row = guard.count[ROWS]
    if row == guard.row_need.size:
        guard.energy[FAILED] = NO_ROOM
        return
    for r in range(6):
        guard.row_nodes[row, r] = nodes[r]
    for c in range(3):
        guard.row_normal[row, c] = n[c]
    guard.row_need[row] = needed(distance, thickness)
    guard.energy[LEAST] = min(guard.energy[LEAST], distance / thickness)
    guard.count[ROWS] = row + 1


@kernel(_nrt=False)
def look_at_entry(guard, e):
    """A row of the guard of pair of facets e, where they are near; else when they can be."""
    a, b = guard.pair_tiles[guard.entry_pair[e]]
    thickness = 0.5 * (guard.thickness[guard.tile_ply[a]] + guard.thickness[guard.tile_ply[b]])
    nodes, near = guard.entry_nodes[e], NEAR * thickness
    apart = lower_bound(guard.x, nodes)
    if apart <= near:
        apart, n = separation(guard.x, nodes)
        if apart <= near:
            if apart <= 0.0:
                guard.energy[FAILED] = CROSSED
                return
            add_row(guard, nodes, n, apart, thickness)
            return
    guard.entry_due[e] = guard.travel[a] + guard.travel[b] + apart - near


@kernel(_nrt=False)
def look_at_planes(guard, t):
    """Rows of the guard of the nodes of a tile that are near a plane of symmetry; when the next can be."""
    p, i0, i1, j0, j1 = tile_bounds(guard, t)
    thickness, least = guard.thickness[p], 1e30
    for c in range(2):
        if not guard.shape[p, 3 + c]:
            continue
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                k = p * guard.slots + i * guard.shape[p, 0] + j
                if guard.mirror[k] >> c & 1:
                    continue
                x = guard.x[k, c]
                if 0.0 < x <= NEAR * thickness:
                    n = (1.0, 0.0, 0.0) if c == 0 else (0.0, 1.0, 0.0)
                    plane = PLANE_X if c == 0 else PLANE_Y
                    add_row(guard, (plane, plane, plane, k, k, k), n, x, thickness)
                least = min(least, max(x - NEAR * thickness, 0.0))
    guard.plane_due[t] = guard.travel[t] + least
