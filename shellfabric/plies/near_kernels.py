"""Which tiles (TALL by WIDE elements) and facets of different plies are near each other, in lists that are remade after
a motion. The displacement of a tile is the sum over the steps of the largest of its nodes in each. What is `gap` [m]
apart cannot have come nearer than `near` before the displacements of both its tiles, with those of another step like
the last, have grown by gap - near together. That holds of pairs of tiles and of facets, of a tile and a plane of
symmetry, and with the thickness for `near`, of tiles whose points may touch each other (`plies.pressure_kernels`).

    pairs of tiles   all whose boxes are within _TILE_REACH thicknesses; listed anew when a tile has come that far
    pairs of facets  of tiles that no plane divides: all whose boxes are within _REACH thicknesses; listed anew likewise
    constraints      pairs of facets that are nearer than `near`, or could meet in the coming step (`guard_kernels`)

An element is two triangles where it has yarns of both families, has not eroded, and is not drawn out to more than
twice its size once torn. What has ceased to be one never is one again. Yarns beside no such element are bare.
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    broadcast,
    greater,
    lane_of,
    load,
    maximum,
    minimum,
    movemask,
)
from shellfabric.plies.frame_kernels import TALL, WIDE, mean_thickness
from shellfabric.plies.guard_kernels import PLANE_X, PLANE_Y, gap_to_keep
from shellfabric.plies.separation_kernels import lower_bound, separation, span, unit_normal
from shellfabric.plies.state import unit
from shellfabric.surface.vector_kernels import column, cross, difference, dot, scaled

NEAR = 0.3  # thicknesses within which facets have to stay on their sides
NOT_RESOLVED, NO_ROOM, CROSSED = 1, 2, 3  # of guard.fault
_TILE_REACH, _REACH = 2.0, 0.4  # thicknesses
_FASTER = 1.5  # than in the last step tiles may be in the coming one
ALWAYS = -1e30  # [m] displacement that any tile has


@kernel(_nrt=False, forceinline=True)
def tile_bounds(contact, t):
    """Return the ply of a tile, and its first and last rows and columns of nodes."""
    lists = contact.lists
    p = lists.tile_ply[t]
    i, j = divmod(t - lists.first_tile[p], lists.tiles_across[p])
    ni = contact.ni[p]
    nj = contact.nj[p]
    return p, i * TALL, min((i + 1) * TALL, ni), j * WIDE, min((j + 1) * WIDE, nj)


@kernel(_nrt=False)
def compute_box(contact, t):
    """Compute the box of a tile, into lists.box."""
    lists = contact.lists
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    for c in range(3):
        low = 1e30
        high = -1e30
        for i in range(i0, i1 + 1):
            k = contact.base[p] + i * contact.row_stride[p]
            for x in contact.x[c, k + j0 : k + j1 + 1]:
                low = min(low, x)
                high = max(high, x)
        lists.box[t, c] = low
        lists.box[t, 3 + c] = high


@kernel(_nrt=False, forceinline=True)
def refresh_box(contact, t):
    """Compute the box of a tile, unless that has been done in this step."""
    lists = contact.lists
    if lists.box_step[t] != contact.step:
        lists.box_step[t] = contact.step
        compute_box(contact, t)


@kernel(_nrt=False, forceinline=True)
def boxes_apart(box, other):
    """Return how far [m] two boxes are apart along an axis at least."""
    gap = -1e30
    for c in range(3):
        gap = max(gap, max(box[c] - other[3 + c], other[c] - box[3 + c]))
    return gap


@unit()
def list_tiles(contact):
    """List the pairs of tiles of different plies that are within reach, and sort the tiles along x."""
    lists = contact.lists
    guard = contact.guard
    tiles = lists.displacement.size
    order = lists.sorted_tiles
    # insertion sort: tiles are nearly in order already
    for n in range(1, tiles):
        t = order[n]
        m = n - 1
        while m >= 0 and lists.box[order[m], 0] > lists.box[t, 0]:
            order[m + 1] = order[m]
            m -= 1
        order[m + 1] = t
    reach = _TILE_REACH * contact.max_thickness
    found = 0
    for n in range(tiles):
        a = order[n]
        for m in range(n + 1, tiles):
            b = order[m]
            # sorted by their lower ends: all further ones are beyond reach too
            if lists.box[b, 0] > lists.box[a, 3] + reach:
                break
            if (
                lists.tile_ply[a] != lists.tile_ply[b]
                and boxes_apart(lists.box[a], lists.box[b]) <= reach
            ):
                if found == lists.pair_recheck_at.size:
                    guard.fault = NO_ROOM
                    break
                lists.tile_pairs[found, 0] = a
                lists.tile_pairs[found, 1] = b
                lists.pair_recheck_at[found] = ALWAYS
                lists.evaluated_at[found] = ALWAYS
                lists.hole_recheck_at[found] = ALWAYS
                found += 1
    lists.n_tile_pairs = found
    lists.n_facet_pairs = 0
    for t in range(tiles):
        lists.listed_displacement[t] = lists.displacement[t]


@kernel(_nrt=False, forceinline=True)
def tiles_thickness(contact, a, b):
    """Return the mean thickness [m] of the plies of two tiles."""
    lists = contact.lists
    return mean_thickness(contact, lists.tile_ply[a], lists.tile_ply[b])


@kernel(_nrt=False, forceinline=True)
def pair_displacement(lists, a, b):
    """Return the sum of the displacements [m] of two tiles."""
    return lists.displacement[a] + lists.displacement[b]


@kernel(_nrt=False, forceinline=True)
def guarded_distance(contact, a, b):
    """Return the distance [m] within which facets of two tiles have to stay on their sides: they
    could meet in the coming step."""
    lists = contact.lists
    thickness = tiles_thickness(contact, a, b)
    return max(
        NEAR * thickness, _FASTER * (lists.step_displacement[a] + lists.step_displacement[b])
    )


@kernel(_nrt=False, forceinline=True)
def lists_are_outdated(contact):
    """Return whether a tile has come so far that pairs may have come within reach that are not in
    the list."""
    lists = contact.lists
    furthest = 0.0
    for t in range(lists.displacement.size):
        furthest = max(
            furthest,
            lists.displacement[t] + lists.step_displacement[t] - lists.listed_displacement[t],
        )
    return 2.0 * furthest > (_TILE_REACH - 1.0) * contact.max_thickness


@kernel(_nrt=False, forceinline=True)
def mean_normal(contact, t):
    """Return the unit vector across the diagonals of a tile; 0 of one without any."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    s = contact.row_stride[p]
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
    """Return the least and the largest of n.x over the nodes of a tile."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    low = 1e30
    high = -1e30
    for i in range(i0, i1 + 1):
        k = contact.base[p] + i * contact.row_stride[p]
        for m in range(k + j0, k + j1 + 1):
            along = n[0] * contact.x[0, m] + n[1] * contact.x[1, m] + n[2] * contact.x[2, m]
            low = min(low, along)
            high = max(high, along)
    return low, high


@unit("number")
def tiles_apart(contact, a, b):
    """Return how far [m] two tiles are apart at least, by their boxes and their mean normals."""
    lists = contact.lists
    found = boxes_apart(lists.box[a], lists.box[b])
    for t in (a, b):
        if found < contact.max_thickness:
            n = mean_normal(contact, t)
            low, high = tile_span(contact, a, n)
            other_low, other_high = tile_span(contact, b, n)
            found = max(found, max(other_low - high, low - other_high))
    return found


@unit("integer")
def list_facets(contact, state, t, side):
    """List the facets of a tile in lists.facets[side], and return their number."""
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    s = contact.row_stride[p]
    ni = contact.ni[p]
    nj = contact.nj[p]
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
    """Put a facet and its box at place `found`, and return the next place."""
    lists = contact.lists
    nodes = lists.facets[side, found]
    box = lists.facet_box[side]
    corner = lists.facet_corner[side]
    nodes[0] = a
    nodes[1] = b
    nodes[2] = c
    for r in range(3):
        u = contact.x[r, a]
        v = contact.x[r, b]
        w = contact.x[r, c]
        box[r, found] = min(u, min(v, w))
        box[3 + r, found] = max(u, max(v, w))
        corner[0, r, found] = u
        corner[1, r, found] = v
        corner[2, r, found] = w
    n = unit_normal(contact.x, a, b, c)
    for r in range(3):
        lists.facet_normal[side, r, found] = n[r]
    low, high = span(contact.x, nodes, 0, n)
    lists.facet_low[side, found] = low
    lists.facet_high[side, found] = high
    return found + 1


@unit()
def list_near_facets(contact, m, first, second):
    """List the pairs within reach of `first` and `second` facets of pair of tiles m, with the
    displacements at which they can be near."""
    lists = contact.lists
    guard = contact.guard
    a, b = lists.tile_pairs[m]
    thickness = tiles_thickness(contact, a, b)
    limit = guarded_distance(contact, a, b)
    found = lists.n_facet_pairs
    reach = limit + _REACH * thickness
    lists.pair_recheck_at[m] = pair_displacement(lists, a, b) + _REACH * thickness
    for i in range(first):
        if boxes_apart(lists.facet_box[0, :, i], lists.box[b]) > reach:
            continue
        for j in range(0, second, WIDTH):
            near = (1 << min(second - j, WIDTH)) - 1
            near &= ~movemask(greater(boxes_apart8(lists, i, j), reach))
            if near == 0:
                continue
            apart = planes_apart8(lists, i, j)
            near &= ~movemask(greater(apart, reach))
            for lane in range(WIDTH):
                if not near >> lane & 1:
                    continue
                if found == lists.facet_recheck_at.size:
                    guard.fault = NO_ROOM
                    return
                for r in range(3):
                    lists.facet_pairs[found, r] = lists.facets[0, i, r]
                    lists.facet_pairs[found, 3 + r] = lists.facets[1, j + lane, r]
                lists.facet_pair_tiles[found] = m
                lists.facet_pair_listing[found] = lists.pair_recheck_at[m]
                own = pair_displacement(lists, a, b) + lane_of(apart, lane)
                lists.facet_recheck_at[found] = own - limit
                found += 1
    lists.n_facet_pairs = found


@kernel(_nrt=False, forceinline=True)
def boxes_apart8(lists, i, j):
    """Return `boxes_apart` of facet i of the first tile and of eight of the second, from j on."""
    gap = broadcast(-1e30)
    for c in range(3):
        before = lists.facet_box[0, c, i] - load(lists.facet_box[1, 3 + c], j)
        behind = load(lists.facet_box[1, c], j) - lists.facet_box[0, 3 + c, i]
        gap = maximum(gap, maximum(before, behind))
    return gap


@kernel(_nrt=False, forceinline=True)
def planes_apart8(lists, i, j):
    """Return `lower_bound` of facet i of the first tile and of eight of the second, from j on."""
    n = column(lists.facet_normal[0], 0, i)
    of_second = lists.facet_normal[1]
    other_n = load(of_second[0], j), load(of_second[1], j), load(of_second[2], j)
    low = other_low = broadcast(1e30)
    high = other_high = broadcast(-1e30)
    for corner in range(3):
        x = lists.facet_corner[1, corner]
        along = dot(n, (load(x[0], j), load(x[1], j), load(x[2], j)))
        other_low = minimum(other_low, along)
        other_high = maximum(other_high, along)
        along = dot(other_n, column(lists.facet_corner[0, corner], 0, i))
        low = minimum(low, along)
        high = maximum(high, along)
    first = maximum(other_low - lists.facet_high[0, i], lists.facet_low[0, i] - other_high)
    second = load(lists.facet_low[1], j) - high
    second = maximum(second, low - load(lists.facet_high[1], j))
    return maximum(maximum(first, second), 0.0)


@kernel(_nrt=False, forceinline=True)
def add_constraint(contact, nodes, n, distance, thickness):
    """Add a constraint of the guard on two facets, or on a node and a plane of symmetry."""
    guard = contact.guard
    row = guard.n_constraints
    if row == guard.required_gap.size:
        guard.fault = NO_ROOM
        return
    for r in range(6):
        guard.constraint_nodes[row, r] = nodes[r]
    for c in range(3):
        guard.normal[row, c] = n[c]
    guard.required_gap[row] = gap_to_keep(distance, thickness)
    guard.gap[row] = distance
    guard.least_gap_ratio = min(guard.least_gap_ratio, distance / thickness)
    guard.n_constraints = row + 1


@unit()
def check_facet_pair(contact, e):
    """Constrain pair of facets e if they are near; else set the displacements at which they can be."""
    lists = contact.lists
    guard = contact.guard
    a, b = lists.tile_pairs[lists.facet_pair_tiles[e]]
    thickness = tiles_thickness(contact, a, b)
    nodes = lists.facet_pairs[e]
    limit = guarded_distance(contact, a, b)
    apart = lower_bound(contact.x, nodes)
    if apart <= limit:
        apart, n = separation(contact.x, nodes)
        if apart <= limit:
            if apart <= 0.0:
                guard.fault = CROSSED
                return
            add_constraint(contact, nodes, n, apart, thickness)
            return
    lists.facet_recheck_at[e] = pair_displacement(lists, a, b) + apart - limit


@unit()
def check_planes(contact, t):
    """Constrain the nodes of a tile that are near a plane of symmetry, and set the displacement at
    which the next can be."""
    lists = contact.lists
    p, i0, i1, j0, j1 = tile_bounds(contact, t)
    thickness = contact.thickness[p]
    least = 1e30
    limit = max(NEAR * thickness, _FASTER * lists.step_displacement[t])
    mirrors = contact.mirror_x, contact.mirror_y
    for c in range(2):
        if not mirrors[c]:
            continue
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                k = contact.base[p] + i * contact.row_stride[p] + j
                if contact.plane_bits[k] >> c & 1:
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
                    add_constraint(contact, (plane, plane, plane, k, k, k), n, x, thickness)
                least = min(least, max(x - limit, 0.0))
    lists.plane_recheck_at[t] = lists.displacement[t] + least


@unit()
def list_contact_pairs(contact):
    """List the tiles of which points may touch the next ply, and the pairs of tiles that may touch
    through a hole, in lists.contact_pairs."""
    lists = contact.lists
    contact.step += 1
    lists.n_contact_pairs = 0
    torn = list_facing_tiles(contact, contact.step)
    if not torn:
        return
    for m in range(lists.n_tile_pairs):
        front, rear = front_and_rear(contact, m)
        if lists.tile_ply[rear] > lists.tile_ply[front] + 1 and may_touch(contact, m, front, rear):
            add_contact_pair(contact, front, rear)


@unit("flag")
def list_facing_tiles(contact, now):
    """List the tiles that may touch the next ply, by how far they were from it when their points
    were last evaluated; mark those that have a tile of the next ply behind them, and those behind
    which one has a hole. Return whether there are holes."""
    lists = contact.lists
    torn = False
    for m in range(lists.n_tile_pairs):
        front, rear = front_and_rear(contact, m)
        if lists.tile_ply[rear] != lists.tile_ply[front] + 1:
            continue
        lists.faced_step[front] = now
        if lists.has_hole[rear]:
            lists.faced_hole_step[front] = now
            torn = True
        recheck_at = lists.evaluated_at[m] + lists.tile_gap[front]
        if (
            lists.evaluated_step[front] != now
            and pair_displacement(lists, front, rear) >= recheck_at
        ):
            lists.evaluated_step[front] = now
            add_contact_pair(contact, front, rear)
    for m in range(lists.n_tile_pairs):
        front, rear = front_and_rear(contact, m)
        if lists.evaluated_step[front] == now and lists.tile_ply[rear] == lists.tile_ply[front] + 1:
            lists.evaluated_at[m] = pair_displacement(lists, front, rear)
    return torn


@kernel(_nrt=False, forceinline=True)
def front_and_rear(contact, m):
    """Return the tiles of pair m, that of the ply in front first."""
    lists = contact.lists
    a, b = lists.tile_pairs[m]
    if lists.tile_ply[a] < lists.tile_ply[b]:
        return (a, b)
    return (b, a)


@kernel(_nrt=False, forceinline=True)
def add_contact_pair(contact, front, rear):
    """Add a tile and the one behind it to lists.contact_pairs."""
    lists = contact.lists
    guard = contact.guard
    count = lists.n_contact_pairs
    if count == lists.contact_pairs.shape[0]:
        guard.fault = NO_ROOM
        return
    lists.contact_pairs[count, 0] = front
    lists.contact_pairs[count, 1] = rear
    lists.n_contact_pairs = count + 1


@kernel(_nrt=False, forceinline=True)
def may_touch(contact, m, front, rear):
    """Return whether the tiles of pair m, which are not of neighbours, may touch: the front one
    faces a hole, or nothing, of the next ply, and they are within the thickness."""
    lists = contact.lists
    if lists.faced_step[front] == contact.step and lists.faced_hole_step[front] != contact.step:
        return False
    displacement = pair_displacement(lists, front, rear)
    if displacement < lists.hole_recheck_at[m]:
        return False
    refresh_box(contact, front)
    refresh_box(contact, rear)
    thickness = tiles_thickness(contact, front, rear)
    apart = tiles_apart(contact, front, rear)
    lists.hole_recheck_at[m] = displacement + max(apart - thickness, 0.0)
    return apart <= thickness
