"""Which tiles and facets of different plies are near each other, in lists that are remade after a
motion.

A tile is TALL by WIDE elements of a ply. Its travel is the sum over steps of the largest way of its
nodes, with the way that they would make in the coming step. What is `gap` [m] apart is looked at
again when the travels of both its tiles have grown by gap - near [m] together: it cannot have come
nearer than `near` before. That holds of pairs of tiles, of pairs of facets of these, and of a tile
and a plane of symmetry; and with the thickness for `near`, of tiles whose points may press on each
other (`plies.pressure_kernels`).

    pairs of tiles   all whose boxes are within _TILE_REACH thicknesses; found anew when a tile has come that far
    pairs of facets  of tiles that no plane divides: all whose boxes are within _REACH thicknesses; found anew likewise
    rows             those that are nearer than `near`, or could meet in the coming step, for the guard
                     (`plies.guard_kernels`)

An element is two triangles where it has yarns of both families and has not eroded, and, once torn,
is not drawn out to more than twice its size. What has ceased to be one never is one again. Yarns
beside no such element are bare.
"""

import math

from shellfabric.cloth.vector_kernels import cross, difference, dot, scaled
from shellfabric.jit.compile import kernel
from shellfabric.plies.frame_kernels import (
    MIRROR_X,
    NI,
    NJ,
    STRIDE,
    TALL,
    WIDE,
    mean_thickness,
)
from shellfabric.plies.guard_kernels import PLANE_X, PLANE_Y, needed
from shellfabric.plies.separation_kernels import lower_bound, separation
from shellfabric.state import unit

NEAR = 0.3  # thicknesses within which facets have to stay on their sides
PAIRS, ENTRIES, ROWS, NODES, STEP, REMAKE, PRESSED = range(7)  # of contact.count
SLOTS = 4  # rows of contact.closed, given and touched: of the next ply, and of three behind it
WORK, IMPULSES, LEAST, FAILED = range(4)  # of contact.guard
NOT_RESOLVED, NO_ROOM, CROSSED = 1, 2, 3  # of contact.guard[FAILED]
_TILE_REACH, _REACH = 2.0, 0.4  # thicknesses
_FASTER = 1.5  # than in the last step tiles may be in the coming one


@kernel(_nrt=False, forceinline=True)
def tile_bounds(contact, t):
    """Ply of a tile, and its first and last rows and columns of nodes."""
    p = contact.tile_ply[t]
    i, j = divmod(t - contact.first_tile[p], contact.tiles_across[p])
    ni = contact.shape[p, NI]
    nj = contact.shape[p, NJ]
    return p, i * TALL, min((i + 1) * TALL, ni), j * WIDE, min((j + 1) * WIDE, nj)


@kernel(_nrt=False)
def set_box(contact, t):
    """The box of a tile, into contact.box."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    for c in range(3):
        low = 1e30
        high = -1e30
        for i in range(i0, i1 + 1):
            k = contact.base[p] + i * contact.shape[p, STRIDE]
            for x in contact.x[c, k + j0 : k + j1 + 1]:
                low = min(low, x)
                high = max(high, x)
        contact.box[t, c] = low
        contact.box[t, 3 + c] = high


@kernel(_nrt=False, forceinline=True)
def refresh_box(contact, t):
    """The box of a tile, if that has not been found in this step."""
    if contact.boxed[t] != contact.count[STEP]:
        contact.boxed[t] = contact.count[STEP]
        set_box(contact, t)


@kernel(_nrt=False, forceinline=True)
def boxes_apart(box, other):
    """[m] by which two boxes are apart along an axis at least."""
    gap = -1e30
    for c in range(3):
        gap = max(gap, max(box[c] - other[3 + c], other[c] - box[3 + c]))
    return gap


@unit()
def list_tiles(contact):
    """Pairs of tiles of different plies that are within reach, and the order of the tiles along
    x."""
    tiles = contact.travel.size
    order = contact.order
    # insertion sort: tiles are nearly in order already
    for n in range(1, tiles):
        t = order[n]
        m = n - 1
        while m >= 0 and contact.box[order[m], 0] > contact.box[t, 0]:
            order[m + 1] = order[m]
            m -= 1
        order[m + 1] = t
    reach = _TILE_REACH * contact.thickest
    found = 0
    for n in range(tiles):
        a = order[n]
        for m in range(n + 1, tiles):
            b = order[m]
            # sorted by their lower ends: all further ones are beyond reach too
            if contact.box[b, 0] > contact.box[a, 3] + reach:
                break
            if (
                contact.tile_ply[a] != contact.tile_ply[b]
                and boxes_apart(contact.box[a], contact.box[b]) <= reach
            ):
                if found == contact.pair_due.size:
                    contact.guard[FAILED] = NO_ROOM
                    break
                contact.pair_tiles[found, 0] = a
                contact.pair_tiles[found, 1] = b
                contact.pair_due[found] = contact.pair_seen[found] = -1e30
                found += 1
    contact.count[PAIRS] = found
    contact.count[ENTRIES] = 0
    for t in range(tiles):
        contact.travel_then[t] = contact.travel[t]


@kernel(_nrt=False, forceinline=True)
def tiles_thickness(contact, a, b):
    """[m] mean thickness of the plies of two tiles."""
    return mean_thickness(contact, contact.tile_ply[a], contact.tile_ply[b])


@kernel(_nrt=False, forceinline=True)
def guarded_distance(contact, a, b):
    """[m] within which facets of two tiles have to stay on their sides: they could meet in the
    coming step."""
    thickness = tiles_thickness(contact, a, b)
    return max(NEAR * thickness, _FASTER * (contact.way[a] + contact.way[b]))


@kernel(_nrt=False, forceinline=True)
def tiles_have_moved(contact):
    """Whether a tile has come so far that pairs may have come within reach that are not in the
    list."""
    furthest = 0.0
    for t in range(contact.travel.size):
        furthest = max(furthest, contact.travel[t] + contact.way[t] - contact.travel_then[t])
    return 2.0 * furthest > (_TILE_REACH - 1.0) * contact.thickest


@kernel(_nrt=False, forceinline=True)
def mean_normal(contact, t):
    """Unit vector across the diagonals of a tile; 0 of one without any."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    s = contact.shape[p, STRIDE]
    k = contact.base[p]
    u = difference(contact.x, k + i0 * s + j0, k + i1 * s + j1)
    v = difference(contact.x, k + i1 * s + j0, k + i0 * s + j1)
    n = cross(u, v)
    size = math.sqrt(dot(n, n))
    if size > 0.0:
        return scaled(1.0 / size, n)
    return 0.0, 0.0, 0.0


@kernel(_nrt=False)
def tile_span(contact, t, n):
    """The least and the largest of n.x over the nodes of a tile."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    low = 1e30
    high = -1e30
    for i in range(i0, i1 + 1):
        k = contact.base[p] + i * contact.shape[p, STRIDE]
        for m in range(k + j0, k + j1 + 1):
            along = n[0] * contact.x[0, m] + n[1] * contact.x[1, m] + n[2] * contact.x[2, m]
            low = min(low, along)
            high = max(high, along)
    return low, high


@unit("number")
def tiles_apart(contact, a, b):
    """[m] that two tiles are apart at least, by their boxes and their mean normals."""
    found = boxes_apart(contact.box[a], contact.box[b])
    for t in (a, b):
        if found < contact.thickest:
            n = mean_normal(contact, t)
            low, high = tile_span(contact, a, n)
            other_low, other_high = tile_span(contact, b, n)
            found = max(found, max(other_low - high, low - other_high))
    return found


@unit("integer")
def list_facets(contact, state, t, side):
    """The facets of a tile, into contact.facets[side]; their number."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    s = contact.shape[p, STRIDE]
    ni = contact.shape[p, NI]
    nj = contact.shape[p, NJ]
    first = contact.base[p]
    found = 0
    for i in range(i0, i1):
        for j in range(j0, j1):
            g = first + i * s + j
            if contact.dropped[g] == 0:
                found = add_facet(contact, side, found, g, g + s, g + s + 1)
                found = add_facet(contact, side, found, g, g + s + 1, g + 1)
    if state.failures == 0:
        return found
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            g = first + i * s + j
            k = i * (nj + 1) + j
            here = i < ni and j < nj and contact.dropped[g] == 0
            above = i > 0 and j < nj and contact.dropped[g - s] == 0
            before = j > 0 and i < ni and contact.dropped[g - 1] == 0
            if j < j1 and state.intact_fraction[1][k] > 0.0 and not (here or above):
                found = add_facet(contact, side, found, g, g + 1, g + 1)
            if i < i1 and state.intact_fraction[0][k] > 0.0 and not (here or before):
                found = add_facet(contact, side, found, g, g + s, g + s)
    return found


@kernel(_nrt=False, forceinline=True)
def add_facet(contact, side, found, a, b, c):
    """Put a facet and its box at place `found`; the next place."""
    nodes = contact.facets[side, found]
    box = contact.facet_box[side, found]
    nodes[0] = a
    nodes[1] = b
    nodes[2] = c
    for r in range(3):
        u = contact.x[r, a]
        v = contact.x[r, b]
        w = contact.x[r, c]
        box[r] = min(u, min(v, w))
        box[3 + r] = max(u, max(v, w))
    return found + 1


@unit()
def list_near_facets(contact, m, first, second):
    """List the pairs within reach of `first` and `second` facets of pair of tiles m, with when they
    can be near."""
    a, b = contact.pair_tiles[m]
    thickness = tiles_thickness(contact, a, b)
    limit = guarded_distance(contact, a, b)
    found = contact.count[ENTRIES]
    reach = limit + _REACH * thickness
    contact.pair_due[m] = contact.travel[a] + contact.travel[b] + _REACH * thickness
    for i in range(first):
        if boxes_apart(contact.facet_box[0, i], contact.box[b]) > reach:
            continue
        for j in range(second):
            if boxes_apart(contact.facet_box[0, i], contact.facet_box[1, j]) > reach:
                continue
            if found == contact.entry_due.size:
                contact.guard[FAILED] = NO_ROOM
                return
            nodes = contact.entry_nodes[found]
            for r in range(3):
                nodes[r] = contact.facets[0, i, r]
                nodes[3 + r] = contact.facets[1, j, r]
            apart = lower_bound(contact.x, nodes)
            if apart > reach:
                continue
            contact.entry_pair[found] = m
            contact.entry_end[found] = contact.pair_due[m]
            contact.entry_due[found] = contact.travel[a] + contact.travel[b] + apart - limit
            found += 1
    contact.count[ENTRIES] = found


@kernel(_nrt=False, forceinline=True)
def add_row(contact, nodes, n, distance, thickness):
    """A row of the guard."""
    row = contact.count[ROWS]
    if row == contact.row_need.size:
        contact.guard[FAILED] = NO_ROOM
        return
    for r in range(6):
        contact.row_nodes[row, r] = nodes[r]
    for c in range(3):
        contact.row_normal[row, c] = n[c]
    contact.row_need[row] = needed(distance, thickness)
    contact.row_distance[row] = distance
    contact.guard[LEAST] = min(contact.guard[LEAST], distance / thickness)
    contact.count[ROWS] = row + 1


@unit()
def look_at_entry(contact, e):
    """A row of the guard of pair of facets e, where they are near; else when they can be."""
    a, b = contact.pair_tiles[contact.entry_pair[e]]
    thickness = tiles_thickness(contact, a, b)
    nodes = contact.entry_nodes[e]
    limit = guarded_distance(contact, a, b)
    apart = lower_bound(contact.x, nodes)
    if apart <= limit:
        apart, n = separation(contact.x, nodes)
        if apart <= limit:
            if apart <= 0.0:
                contact.guard[FAILED] = CROSSED
                return
            add_row(contact, nodes, n, apart, thickness)
            return
    contact.entry_due[e] = contact.travel[a] + contact.travel[b] + apart - limit


@unit()
def look_at_planes(contact, t):
    """Rows of the guard of the nodes of a tile that are near a plane of symmetry; when the next can
    be."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    thickness = contact.thickness[p]
    least = 1e30
    limit = max(NEAR * thickness, _FASTER * contact.way[t])
    for c in range(2):
        if not contact.shape[p, MIRROR_X + c]:
            continue
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                k = contact.base[p] + i * contact.shape[p, STRIDE] + j
                if contact.mirror[k] >> c & 1:
                    continue
                x = contact.x[c, k]
                if 0.0 < x <= limit:
                    if c == 0:
                        n = (1.0, 0.0, 0.0)
                    else:
                        n = (0.0, 1.0, 0.0)
                    plane = PLANE_Y
                    if c == 0:
                        plane = PLANE_X
                    add_row(contact, (plane, plane, plane, k, k, k), n, x, thickness)
                least = min(least, max(x - limit, 0.0))
    contact.plane_due[t] = contact.travel[t] + least


@unit()
def list_pressed(contact):
    """List the tiles of which points may touch the next ply, and the pairs of tiles that may touch
    through a hole, into contact.pressed."""
    contact.count[STEP] += 1
    contact.count[PRESSED] = 0
    torn = list_neighbours(contact, contact.count[STEP])
    if not torn:
        return
    for m in range(contact.count[PAIRS]):
        front, rear = ordered(contact, m)
        if contact.tile_ply[rear] > contact.tile_ply[front] + 1 and may_touch(
            contact, m, front, rear
        ):
            add_pressed(contact, front, rear)


@unit("flag")
def list_neighbours(contact, now):
    """List the tiles that may touch the next ply, by how far they were from it when last looked at;
    mark those that have a tile of the next ply behind them, and those behind which one has a hole.
    Whether there are holes."""
    torn = False
    for m in range(contact.count[PAIRS]):
        front, rear = ordered(contact, m)
        if contact.tile_ply[rear] != contact.tile_ply[front] + 1:
            continue
        contact.covered[front] = now
        if contact.holes[rear]:
            contact.open[front] = now
            torn = True
        apart = contact.pair_seen[m] + contact.clearance[front]
        if (
            contact.looked_at[front] != now
            and contact.travel[front] + contact.travel[rear] >= apart
        ):
            contact.looked_at[front] = now
            add_pressed(contact, front, rear)
    for m in range(contact.count[PAIRS]):
        front, rear = ordered(contact, m)
        if (
            contact.looked_at[front] == now
            and contact.tile_ply[rear] == contact.tile_ply[front] + 1
        ):
            contact.pair_seen[m] = contact.travel[front] + contact.travel[rear]
    return torn


@kernel(_nrt=False, forceinline=True)
def ordered(contact, m):
    """The tiles of pair m, that of the ply in front first."""
    a, b = contact.pair_tiles[m]
    if contact.tile_ply[a] < contact.tile_ply[b]:
        return (a, b)
    return (b, a)


@kernel(_nrt=False, forceinline=True)
def add_pressed(contact, front, rear):
    """Add a tile and the one behind it to contact.pressed."""
    count = contact.count[PRESSED]
    if count == contact.pressed.shape[0]:
        contact.guard[FAILED] = NO_ROOM
        return
    contact.pressed[count, 0] = front
    contact.pressed[count, 1] = rear
    contact.count[PRESSED] = count + 1


@kernel(_nrt=False, forceinline=True)
def may_touch(contact, m, front, rear):
    """Whether the tiles of pair m, which are not of neighbours, may touch: the front one faces a
    hole, or nothing, of the next ply, and they are within the thickness."""
    if contact.covered[front] == contact.count[STEP] and contact.open[front] != contact.count[STEP]:
        return False
    travel = contact.travel[front] + contact.travel[rear]
    if travel < contact.pair_seen[m]:
        return False
    refresh_box(contact, front)
    refresh_box(contact, rear)
    thickness = tiles_thickness(contact, front, rear)
    apart = tiles_apart(contact, front, rear)
    contact.pair_seen[m] = travel + max(apart - thickness, 0.0)
    return apart <= thickness
