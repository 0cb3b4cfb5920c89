"""Pressure and friction between plies, point by point (docs/theory-panel.md, "Packs: contact between plies", and
"contact law of plies"). With y the point of the surface of a ply behind that is closest to a point x,

    n = (y - x) / d,     f = A max(0, p(t - d) + c n.v)                                 (1)
    v_t = v - (v.n) n,   g = k_t s + c v_t,   |k_t s| <= mu f,   c |v_t| <= mu f - |k_t s|   (2)
    p(d' - (d' - d) / e),     d < d', the deepest closure since a point touched         (3)

-f n - g acts on the nodes of the front ply about x, the opposite on those of the rear ply about y. The distance has
no sign: the guard keeps plies apart. A point that leaves forgets d', what it jumped by and its elastic slip. Most
points are computed eight at once, in rows of neighbours; what needs more than a formula (torn fabric, sides, folds)
one at a time.
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import (
    WIDTH,
    any_lane,
    broadcast,
    equal_bytes,
    fabs,
    floor,
    greater,
    lane_numbers,
    load,
    mask_from_bits,
    masked_store,
    maximum,
    minimum,
    movemask,
    reduce_add,
    reduce_max,
    sqrt,
    where,
)
from shellfabric.plies.frame_kernels import (
    BEFORE,
    BEHIND,
    grid_in_pack,
    has_dropped,
    is_torn,
    mean_thickness,
    nearest_place,
)
from shellfabric.plies.near_kernels import tile_bounds
from shellfabric.plies.point_kernels import (
    friction_force,
    held,
    newton_matrix,
    normal_equations,
    normal_force,
    offset_after,
    sliding_velocity,
    solve,
    spring_at,
    unearned,
)
from shellfabric.plies.state import unit
from shellfabric.surface.nodal_force_kernels import extend_window
from shellfabric.surface.surface_kernels import (
    facet_foot,
    foot_at,
    mean_speed8,
    patch8,
    patch_at,
    point_mean_speed,
    point_speeds8,
    point_tilt,
    point_vector8,
    scatter8,
    scatter_limited8,
    scatter_limited_to_points8,
    scatter_to_points8,
    second_slopes8,
    share_out,
    share_out_limited,
    speeds8,
    speeds_at,
    spline_weights8,
    tilt8,
    vector_at8,
    vector_of,
)
from shellfabric.surface.vector_kernels import (
    add,
    cross,
    difference,
    dot,
    nodal,
    scaled,
    subtract,
)

SLOTS = 4  # rows of `Pressure.last_closure`: of the next ply, and of three behind it
_ITERATIONS = 8  # of Newton's method, of a point alone
_LONGEST = 0.5  # [elements] a step of it
_LAST, _LAST_FAR = 0.01, 0.2  # [elements] a step that ends it, within the thickness and beyond
_BERTH = 1.1  # [thicknesses] from which on a point counts as clear: its closest point is followed to a few hundredths
_FAR = 1e30
_ASIDE = 1e-6  # [elements] from a side of a facet
_WITHIN = 1.0 - 1e-9  # [elements] how far from its first corner the places of a torn facet go


@unit()
def press(contact, me, count):
    """Compute the forces between neighbours, of the points of one thread's plies."""
    lists = contact.lists
    pressure = contact.pressure
    for p in range(me, contact.failures.size, count):
        pressure.spring_energy[p] = 0.0
    for n in range(lists.n_contact_pairs):
        tile = lists.contact_pairs[n, 0]
        other = lists.contact_pairs[n, 1]
        p = lists.tile_ply[tile]
        if lists.tile_ply[other] == p + 1 and p % count == me:
            press_tile(contact, tile, p)


@unit()
def press_others(contact):
    """Compute the forces between plies that are no neighbours."""
    lists = contact.lists
    for n in range(lists.n_contact_pairs):
        tile = lists.contact_pairs[n, 0]
        other = lists.contact_pairs[n, 1]
        p = lists.tile_ply[tile]
        q = lists.tile_ply[other]
        if q != p + 1:
            press_through_hole(contact, tile, other, p, q)


@unit()
def press_tile(contact, tile, p):
    """Compute the forces of the points of a tile of ply p on the next ply; how far the nearest of
    those that do not touch is from that, into lists.tile_gap."""
    lists = contact.lists
    pressure = contact.pressure
    _, i0, i1, j0, j1 = tile_bounds(contact, tile)
    points = pressure.points_per_side**2
    nj = contact.nj[p]
    clearance = _FAR
    for row in range(i0 * points, i1 * points):
        q = pressure.first_point[p] + row * nj + j0
        count = j1 - j0
        left = (1 << count) - 1
        if pressure.same_angle[p]:
            left, clear = press_points8(contact, p, row, j0, q, count)
            clearance = min(clearance, clear)
        if left == 0:
            continue
        for lane in range(count):
            if (left >> lane) & 1:
                a = pressure.closest_a[q + lane]
                b = pressure.closest_b[q + lane]
                a, b, clear = press_point(contact, p, p + 1, row, j0 + lane, a, b, -1)
                pressure.closest_a[q + lane] = a
                pressure.closest_b[q + lane] = b
                clearance = min(clearance, clear)
    lists.tile_gap[tile] = max(clearance, 0.0)


@unit(later=True)
def press_through_hole(contact, tile, other, p, q):
    """Compute the forces on a tile of ply q of the points of a tile of ply p that the next ply does
    not touch."""
    pressure = contact.pressure
    _, i0, i1, j0, j1 = tile_bounds(contact, tile)
    _, m0, m1, n0, n1 = tile_bounds(contact, other)
    points = pressure.points_per_side**2
    s = contact.row_stride[p]
    S = contact.row_stride[q]
    thickness = mean_thickness(contact, p, q)
    reach = (thickness + contact.max_diagonal) ** 2
    for i in range(i0, i1):
        for j in range(j0, j1):
            g = contact.base[p] + i * s + j
            if contact.dropped[g]:
                continue
            nearest = reach
            a = 0.0
            b = 0.0
            middle = middle_of(contact, g, s)
            for m in range(m0, m1):
                for n in range(n0, n1):
                    k = contact.base[q] + m * S + n
                    u = subtract(middle_of(contact, k, S), middle)
                    if dot(u, u) >= nearest or contact.dropped[k]:
                        continue
                    if (
                        max(height_over(contact, g, s, k, S), height_over(contact, k, S, g, s))
                        <= thickness
                    ):
                        nearest = dot(u, u)
                        a = m + 0.5
                        b = n + 0.5
            if nearest >= reach:
                continue
            for m in range(points):
                press_point(contact, p, q, i * points + m, j, a, b, other)


@kernel(_nrt=False, forceinline=True)
def middle_of(contact, g, s):
    """Return the mean [m] of the corners of element g (grid of stride s)."""
    x = contact.x
    near = add(nodal(x, g), nodal(x, g + 1))
    return scaled(0.25, add(near, add(nodal(x, g + s), nodal(x, g + s + 1))))


@kernel(_nrt=False, forceinline=True)
def height_over(contact, g, s, k, S):
    """Compute the height [m] by which all nodes of element k (grid of stride S) are off those of
    element g across its plane."""
    x = contact.x
    n = cross(difference(x, g, g + s + 1), difference(x, g + s, g + 1))
    size = math.sqrt(dot(n, n))
    low = 0.0
    high = 0.0
    least = _FAR
    most = -_FAR
    for corner in (g + 1, g + s, g + s + 1):
        along = dot(n, difference(x, g, corner))
        low = min(low, along)
        high = max(high, along)
    for corner in (k, k + 1, k + S, k + S + 1):
        along = dot(n, difference(x, g, corner))
        least = min(least, along)
        most = max(most, along)
    if size > 0.0:
        return max(least - high, low - most) / size
    return 0.0


@kernel(_nrt=False, forceinline=True)
def place_of_point(contact, row, j):
    """Return the place (a, b) [elements] of the point of a row of points in the j-th element: rows
    have one point an element."""
    pressure = contact.pressure
    points = pressure.points_per_side
    i = row // points**2
    m = row % points**2
    return i + (m // points + 0.5) / points, j + (m % points + 0.5) / points


@kernel(_nrt=False, forceinline=True)
def newton_step(w, slopes, second, thickness):
    """Compute the step (a, b) [elements] towards the closest point: Newton's within the thickness;
    that of Gauss and Newton beyond it, and if there is no other. Return it, and whether it is
    within.

    With the offset w = x - y, slopes y_a, y_b and the step (a, b), the offset at its end is, to
    second order,

        w - (y_a + (a y_aa + b y_ab) / 2) a - (y_b + (a y_ab + b y_bb) / 2) b               (4)

    w : offset of the point; slopes : of the surface along a and b; second : its second slopes aa,
        ab, bb
    """
    plain, along, solvable, near = normal_equations(w, slopes, thickness)
    if not solvable:
        step = 0.0
        if plain[0] > 0.0:
            step = along[0] / plain[0]
        return step, 0.0, False
    a, b = solve(newton_matrix(plain, w, second, near), along)
    return a, b, near


@kernel(_nrt=False, forceinline=True)
def bounded_step(w, slopes, step, place, room):
    """Bound a step to a room (low, high) from `place`; where it is cut along one axis, take the
    best along the other."""
    low, high = room
    y_a, y_b = slopes
    a = min(max(step[0], low[0] - place[0]), high[0] - place[0])
    b = min(max(step[1], low[1] - place[1]), high[1] - place[1])
    bb = dot(y_b, y_b)
    aa = dot(y_a, y_a)
    if a != step[0] and bb > 0.0:
        b = min(max((dot(y_b, w) - a * dot(y_a, y_b)) / bb, low[1] - place[1]), high[1] - place[1])
    elif b != step[1] and aa > 0.0:
        a = min(max((dot(y_a, w) - b * dot(y_a, y_b)) / aa, low[0] - place[0]), high[0] - place[0])
    return a, b


@unit("3 numbers", a="number", b="number")
def press_point(contact, p, q, row, j, a, b, tile):
    """Compute the force of a point of ply p on ply q, whose closest point is looked for from the
    place (a, b) on: its place, and how far the point is from touching [m].

    row, j : of the point (`place_of_point`); tile : which the closest point has to be in, or -1
    """
    pressure = contact.pressure
    element = row // pressure.points_per_side**2
    number = slot_of(p, q), pressure.first_point[p] + row * contact.nj[p] + j
    if contact.dropped[contact.base[p] + element * contact.row_stride[p] + j]:
        # what its springs held goes with the element: it is counted as lost
        for slot in range(SLOTS):
            pressure.lost_energy[p] += held_energy(contact, p, element, j, (slot, number[1]))
        return a, b, _FAR
    held = 0.0
    if contact.failures[q] > 0 and has_dropped(contact, q, a, b):
        held = held_energy(contact, p, element, j, number)
    at_a, at_b = place_of_point(contact, row, j)
    foot = foot_at(grid_in_pack(contact, p), is_torn(contact, p, at_a, at_b), at_a, at_b)
    x = vector_of(contact.x, foot)
    # through a hole: the next ply is in between where it is whole
    if tile >= 0 and touches_next(contact, p, row, j, x):
        return a, b, _FAR
    thickness = mean_thickness(contact, p, q)
    (a, b), w, closest, ended = closest_point(contact, q, x, a, b, thickness)
    distance = math.sqrt(dot(w, w))
    if 1e-9 * thickness < distance < thickness and (tile < 0 or is_in_tile(contact, tile, a, b)):
        n = scaled(-1.0 / distance, w)
        area = pressure.area_ratio[pressure.first_element[p] + element * contact.nj[p] + j]
        push(contact, (p, foot), (q, closest), area, n, thickness - distance, number)
        if held > 0.0:
            held -= point_energy(contact, p, element, j, number)
    pressure.lost_energy[p] += max(held, 0.0)
    clear = 0.0
    if ended:
        clear = distance - _BERTH * thickness
    return a, b, clear


@kernel(_nrt=False, forceinline=True)
def slot_of(p, q):
    """Return the row of what a point of ply p remembers (`Pressure.last_closure`) for ply q: the
    first for the next ply."""
    if q == p + 1:
        return 0
    return 1 + (q - p - 2) % (SLOTS - 1)


@kernel(_nrt=False)
def point_energy(contact, p, i, j, number):
    """Compute the energy [J] that a point of the element (i, j) of ply p stores by the closure of
    when it last touched."""
    pressure = contact.pressure
    area = pressure.area_ratio[pressure.first_element[p] + i * contact.nj[p] + j]
    closure = pressure.last_closure[number] - pressure.unearned_closure[number]
    return area * spring_at(pressure, p, closure, pressure.deepest_closure[number])[2]


@kernel(_nrt=False)
def held_energy(contact, p, i, j, number):
    """Compute `point_energy` of a point that touched a step ago, else 0."""
    pressure = contact.pressure
    if pressure.last_contact_step[number] != contact.step - 1.0:
        return 0.0
    return point_energy(contact, p, i, j, number)


@kernel(_nrt=False, forceinline=True)
def closest_point(contact, q, x, a, b, thickness):
    """Find the point of ply q that is closest to x, looked for from the place (a, b) on.

    Returns
    -------
    its place, the offset of x from it, its foot, whether the search has ended. The foot is that of
    the last place that was looked at. Where there is no fabric the offset is _FAR.
    """
    searched = False
    none = 0.0, 0.0, 0.0
    foot = 0, 0, (0, 0), none, none
    grid = grid_in_pack(contact, q)
    w = _FAR, _FAR, _FAR
    for iteration in range(_ITERATIONS):
        torn = is_torn(contact, q, a, b)
        if torn and not searched and has_dropped(contact, q, a, b):
            a, b = nearest_place(contact, q, (a, b), x)
            searched = True
            if has_dropped(contact, q, a, b):
                return (a, b), (_FAR, _FAR, _FAR), foot, False
        foot, y, slopes, second = patch_at(contact.x, grid, torn, a, b)
        w = subtract(x, y)
        step_a, step_b, near = newton_step(w, slopes, second, thickness)
        facet = foot[0], foot[1]
        room = bounds(contact, q, torn, facet)
        go, turn = bounded_step(w, slopes, (step_a, step_b), (a, b), room)
        # beside the facet: another may be nearer
        if torn and not searched and (go != step_a or turn != step_b):
            a, b = nearest_place(contact, q, (a, b), x)
            searched = True
            continue
        last = _LAST_FAR
        if near:
            last = _LAST
        ended = max(abs(go), abs(turn)) <= last
        go = min(max(go, -_LONGEST), _LONGEST)
        turn = min(max(turn, -_LONGEST), _LONGEST)
        a += go
        b += turn
        # a facet is flat along each axis: one step is enough
        if torn:
            foot = facet_foot(grid, facet, (a, b))
            w = subtract(x, vector_of(contact.x, foot))
            return (a, b), w, foot, False
        if ended or iteration == _ITERATIONS - 1:
            if not near:
                second = none, none, none
            return (a, b), offset_after(w, slopes, second, go, turn), foot, ended
    return (a, b), w, foot, False


@kernel(_nrt=False, forceinline=True)
def touches_next(contact, p, row, j, x):
    """Tell whether a point of ply p, which is at x, is within the thickness of the next ply; one
    whose closest place is on the rim of a hole is over the hole, on whichever side the hole is."""
    pressure = contact.pressure
    n = pressure.first_point[p] + row * contact.nj[p] + j
    a = pressure.closest_a[n]
    b = pressure.closest_b[n]
    torn = is_torn(contact, p + 1, a, b)
    if torn and (has_dropped(contact, p + 1, a, b) or is_on_rim(contact, p + 1, a, b)):
        return False
    y = vector_of(contact.x, foot_at(grid_in_pack(contact, p + 1), torn, a, b))
    w = subtract(x, y)
    return dot(w, w) < mean_thickness(contact, p, p + 1) ** 2


@kernel(_nrt=False, forceinline=True)
def is_on_rim(contact, q, a, b):
    """Tell whether the place (a, b) of torn ply q is on a side that its facet shares with a hole."""
    before = has_dropped(contact, q, a - _ASIDE, b) or has_dropped(contact, q, a, b - _ASIDE)
    behind = has_dropped(contact, q, a + _ASIDE, b) or has_dropped(contact, q, a, b + _ASIDE)
    return before or behind


@kernel(_nrt=False, forceinline=True)
def is_in_tile(contact, tile, a, b):
    """Tell whether the place (a, b) is in an element of a tile."""
    _, i0, i1, j0, j1 = tile_bounds(contact, tile)
    return i0 <= int(a) < i1 and j0 <= int(b) < j1


@kernel(_nrt=False, forceinline=True)
def bounds(contact, p, torn, facet):
    """Return where closest points of ply p may be: ((lowest a, lowest b), (highest a, highest b));
    of torn fabric in a facet alone, to which a place on its far side belongs as one on its near side
    does."""
    i, j = facet
    if torn:
        return (float(i), float(j)), (i + _WITHIN, j + _WITHIN)
    low_a = 0.0
    if contact.mirror_x:
        low_a = -0.5
    low_b = 0.0
    if contact.mirror_y:
        low_b = -0.5
    return (low_a, low_b), (float(contact.ni[p]), float(contact.nj[p]))


@kernel(_nrt=False, forceinline=True)
def push(contact, front, rear, area, n, closure, number):
    """Add the force between a point of a ply and its closest point on one behind it to the nodes of
    both.

    Parameters
    ----------
    front, rear : number of the ply, foot of its point (`surface_kernels.foot_at`)
    area : that the point stands for
    n : unit vector from the point to the closest one
    closure : [m]
    number : of the point, of what it remembers (`Pressure.last_closure`)
    """
    pressure = contact.pressure
    p, foot = front
    q, closest = rear
    front_speeds, front_speed, front_tilt = moving(contact, foot, n)
    rear_speeds, rear_speed, rear_tilt = moving(contact, closest, n)
    closing = front_speed - rear_speed
    touched = pressure.last_contact_step[number] == contact.step - 1.0
    closures = earned_closure(contact, mean_thickness(contact, p, q), number, closure, closing)
    f, energy, drag = normal_force(pressure, p, area, closures, closing, True)
    force = scaled(f, n)
    front_nodes = pushed_nodes(contact, p, BEHIND, foot)
    rear_nodes = pushed_nodes(contact, q, BEFORE, closest)
    tilt = min(front_tilt, rear_tilt)
    slower = min(front_speed, rear_speed) - tilt
    faster = max(front_speed, rear_speed) + tilt
    back = scaled(-1.0, force)
    share_out_limited(*front_nodes, front_speeds, (back, (-1.0, slower, drag)))
    share_out_limited(*rear_nodes, rear_speeds, (force, (1.0, faster, drag)))
    if pressure.friction > 0.0:
        v = subtract(vector_of(contact.v, foot), vector_of(contact.v, closest))
        kept = 0.0, 0.0, 0.0
        if touched:
            kept = pressure.slip_x[number], pressure.slip_y[number], pressure.slip_z[number]
        sliding = sliding_velocity(v, closing, n)
        pull, slip, lost = friction_force(pressure, contact.dt, p, area, f, kept, sliding, n, True)
        pressure.slip_x[number], pressure.slip_y[number], pressure.slip_z[number] = slip
        share_out(*front_nodes, scaled(-1.0, pull))
        share_out(*rear_nodes, pull)
        pressure.friction_work[p] += lost
    pressure.spring_energy[p] += energy
    pressure.max_closure[p] = max(pressure.max_closure[p], closures[0])


@kernel(_nrt=False, forceinline=True)
def moving(contact, foot, n):
    """Return how the nodes about a foot move along the normal: their speeds, the mean of these, and
    their tilt."""
    _, _, at, wa, wb = foot
    speeds = speeds_at(contact.v, at, n)
    return speeds, point_mean_speed(speeds, wa, wb), point_tilt(speeds, wa, wb)


@kernel(_nrt=False, forceinline=True)
def pushed_nodes(contact, p, side, foot):
    """Return what a foot on ply p pushes: forces of the plies on one side of it, their window, and
    the foot on its grid."""
    pressure = contact.pressure
    i, j, (k, stride), wa, wb = foot
    own = i, j, (k - p * contact.slots_per_ply, stride), wa, wb
    return pressure.grid_force[p, side], pressure.grid_window[p, side], own


@kernel(_nrt=False, forceinline=True)
def earned_closure(contact, thickness, number, closure, closing):
    """Return the closure [m] of a point less its unearned part, and the deepest since it touched;
    remember them.

    In folds and beside tears the closest point may jump, surfaces change and plies come to meet
    through a hole, each at a depth that no motion has made. What a closure c jumps by, c - c_old -
    dt n.v beyond _JUMP thicknesses, does not press (`unearned`), until the point has left.
    """
    pressure = contact.pressure
    memory = (
        pressure.last_contact_step[number],
        pressure.last_closure[number],
        pressure.unearned_closure[number],
    )
    now = float(contact.step)
    part = unearned(closure, contact.dt * closing, memory, now, thickness)
    earned = closure - part
    deepest = earned
    if memory[0] == now - 1.0:
        deepest = max(deepest, pressure.deepest_closure[number])
    pressure.last_contact_step[number] = now
    pressure.last_closure[number] = closure
    pressure.unearned_closure[number] = part
    pressure.deepest_closure[number] = deepest
    return earned, deepest


@kernel(_nrt=False, forceinline=True)
def store_where(values, points, which, new):
    """Store new values of those of eight points that are `which`; points : number of the first, how
    many there are."""
    first, count = points
    masked_store(values, first, where(which, new, load(values, first)), count)


@kernel(_nrt=False, forceinline=True)
def earned_closure8(contact, thickness, points, closure, closing, which):
    """Do as `earned_closure` on the next ply for those of eight points that are `which`."""
    pressure = contact.pressure
    q, _ = points
    memory = (
        load(pressure.last_contact_step[0], q),
        load(pressure.last_closure[0], q),
        load(pressure.unearned_closure[0], q),
    )
    now = float(contact.step)
    part = unearned(closure, contact.dt * closing, memory, now, thickness)
    earned = closure - part
    touched = greater(0.5, fabs(memory[0] - (now - 1.0)))
    deepest = maximum(where(touched, load(pressure.deepest_closure[0], q), 0.0), earned)
    store_where(pressure.last_contact_step[0], points, which, broadcast(now))
    store_where(pressure.last_closure[0], points, which, closure)
    store_where(pressure.unearned_closure[0], points, which, part)
    store_where(pressure.deepest_closure[0], points, which, deepest)
    return earned, deepest


@kernel(_nrt=False, forceinline=True)
def press_points8(contact, p, row, j, q, count):
    """Press those of `count` points from number q on, as `press_point` does, which begin in the
    j-th element of a row of points and need no more than the formulas: (those left, as bits, how
    far the nearest of the others is from touching)."""
    pressure = contact.pressure
    x = contact.x
    S = contact.row_stride[p + 1]
    thickness = mean_thickness(contact, p, p + 1)
    a, b = place_of_point(contact, row, j)
    foot = foot_at(grid_in_pack(contact, p), False, a, b)
    _, _, nodes, wa, wb = foot
    lanes = lane_numbers()
    all_of = (1 << count) - 1
    A = load(pressure.closest_a, q)
    B = load(pressure.closest_b, q)
    fit = whole8(contact, p, nodes[0] + nodes[1] + 1, (q, count))
    n_a = contact.ni[p + 1]
    n_b = contact.nj[p + 1]
    I = floor(minimum(maximum(A + 0.5, 0.0), float(n_a)))
    J = floor(minimum(maximum(B + 0.5, 0.0), float(n_b)))
    chosen = mask_from_bits(fit)
    I0 = -reduce_max(where(chosen, 0.0 - I, -_FAR))
    J0 = -reduce_max(where(chosen, lanes - J, -_FAR))
    if fit == 0:
        return all_of, _FAR
    K = contact.base[p + 1] + (int(I0) - 1) * S + int(J0) - 1
    r = A - I
    t = B - J
    I = I - I0
    J = J - lanes - J0
    # four rows of four nodes hold points whose nearest nodes are a node apart at most
    fit &= ~movemask(greater(maximum(I, J), 1.5))
    tall = any_lane(greater(where(mask_from_bits(fit), I, 0.0), 0.5))
    za, da, ca = spline_weights8(r, greater(I, 0.5))
    zb, db, cb = spline_weights8(t, greater(J, 0.5))
    weights = (za, da, ca), (zb, db, cb)
    at = K, S, tall
    y, y_a, y_b = patch8(x, at, weights)
    w = subtract(point_vector8(x, nodes, wa, wb), y)
    slopes = y_a, y_b
    go, turn, second, near, fit = newton_steps8(x, (at, weights), w, slopes, thickness, fit)
    longest = maximum(fabs(go), fabs(turn))
    fit &= ~(movemask(greater(longest, _LAST_FAR)) | near & movemask(greater(longest, _LAST)))
    A = A + go
    B = B + turn
    fit &= within8(contact, p + 1, A, B)
    points = q, count
    store_where(pressure.closest_a, points, mask_from_bits(fit), A)
    store_where(pressure.closest_b, points, mask_from_bits(fit), B)
    w = offset_after(w, slopes, second, go, turn)
    distance = sqrt(dot(w, w))
    touching = (
        fit
        & near
        & movemask(greater(thickness, distance))
        & movemask(greater(distance, 1e-9 * thickness))
    )
    clear = (
        -reduce_max(where(mask_from_bits(fit & ~touching), 0.0 - distance, -_FAR))
        - _BERTH * thickness
    )
    if touching:
        n = scaled(-1.0 / distance, w)
        closest = int(I0) - 1, int(J0) - 1, K, za, zb, tall
        element = pressure.first_element[p] + row // pressure.points_per_side**2 * contact.nj[p] + j
        area = load(pressure.area_ratio, element)
        closure = thickness - distance
        push8(contact, (p, foot), closest, area, n, closure, touching, (q, count))
        clear = 0.0
    return all_of & ~fit, clear


@kernel(_nrt=False, forceinline=True)
def newton_steps8(x, patch, w, slopes, thickness, fit):
    """Do as `newton_step` for those of eight points that are `fit`: the steps along a and b, second
    slopes of the surface, which points are near, as bits, and which are fit still.

    patch : of the surface, for `surface_kernels.second_slopes8`
    """
    at, weights = patch
    matrix, along, solvable, near = normal_equations(w, slopes, thickness)
    fit &= movemask(solvable)
    near = fit & movemask(near)
    none = broadcast(0.0)
    second = (none, none, none), (none, none, none), (none, none, none)
    if near:
        second = second_slopes8(x, at, weights)
        matrix = newton_matrix(matrix, w, second, mask_from_bits(near))
    a, b = solve(matrix, along)
    return a, b, second, near, fit


@kernel(_nrt=False, forceinline=True)
def whole8(contact, p, node, points):
    """Return those of eight points, as bits, that are not beside torn fabric of either ply; node :
    the nearest to the first point; points : number of the first, how many there are."""
    pressure = contact.pressure
    q, count = points
    fit = (1 << count) - 1
    if contact.failures[p] > 0:
        fit &= movemask(equal_bytes(contact.torn, node, 0))
    if contact.failures[p + 1] > 0:
        for lane in range(count):
            if is_torn(contact, p + 1, pressure.closest_a[q + lane], pressure.closest_b[q + lane]):
                fit &= ~(1 << lane)
    return fit


@kernel(_nrt=False, forceinline=True)
def within8(contact, p, A, B):
    """Return those of eight places, as bits, that are within the bounds of whole fabric of ply
    p."""
    (low_a, low_b), (high_a, high_b) = bounds(contact, p, False, (0, 0))
    beside = movemask(greater(low_a, A)) | movemask(greater(low_b, B))
    return ~(beside | movemask(greater(A, high_a)) | movemask(greater(B, high_b)))


@kernel(_nrt=False, forceinline=True)
def push8(contact, front, closest, area, n, closure, touching, points):
    """Push those of eight points of a ply and the next apart whose bits are set, as `push` does.

    Parameters
    ----------
    front : the ply, and the foot of the first point
    closest : foot of the first closest point, and whether it has four rows of nodes
        (`surface_kernels.interpolate_rows8`)
    points : number of the first, how many there are
    """
    pressure = contact.pressure
    p, (i, j, nodes, wa, wb) = front
    I, J, K, za, zb, tall = closest
    S = contact.row_stride[p + 1]
    which = mask_from_bits(touching)
    front_speeds = point_speeds8(contact.v, nodes, n)
    rear_speeds = speeds8(contact.v, (K, S, tall), n)
    front_speed = point_mean_speed(front_speeds, wa, wb)
    rear_speed = mean_speed8(rear_speeds, za, zb)
    closing = front_speed - rear_speed
    thickness = mean_thickness(contact, p, p + 1)
    first, _ = points
    last_step = load(pressure.last_contact_step[0], first)
    touched = greater(0.5, fabs(last_step - (contact.step - 1.0)))
    closures = earned_closure8(contact, thickness, points, closure, closing, which)
    f, energy, drag = normal_force(pressure, p, area, closures, closing, which)
    pressure.spring_energy[p] += reduce_add(energy)
    most = reduce_max(where(which, closures[0], 0.0))
    pressure.max_closure[p] = max(pressure.max_closure[p], most)
    if not any_lane(greater(f, 0.0)):
        if pressure.friction > 0.0:
            pressure.friction_work[p] += release8(pressure, p, area, points, touched, which)
        return
    ahead = pressure.grid_window[p, BEHIND]
    extend_window(ahead, i, i + 3, j, min(j + WIDTH + 2, contact.nj[p] + 2))
    behind = pressure.grid_window[p + 1, BEFORE]
    rows = 3
    if tall:
        rows = 4
    last = min(J + WIDTH + 3, contact.nj[p + 1] + 2)
    extend_window(behind, I, I + rows, max(J, -1), last)
    at = nodes[0] - p * contact.slots_per_ply, nodes[1]
    behind_at = K - (p + 1) * contact.slots_per_ply, S, tall
    front_force = pressure.grid_force[p, BEHIND]
    rear_force = pressure.grid_force[p + 1, BEFORE]
    force = scaled(f, n)
    back = scaled(-1.0, force)
    tilt = minimum(point_tilt(front_speeds, wa, wb), tilt8(rear_speeds, za, zb))
    slower = minimum(front_speed, rear_speed) - tilt
    faster = maximum(front_speed, rear_speed) + tilt
    scatter_limited_to_points8(
        front_force, at, (wa, wb), front_speeds, (back, (-1.0, slower, drag))
    )
    scatter_limited8(rear_force, behind_at, (za, zb), rear_speeds, (force, (1.0, faster, drag)))
    if pressure.friction > 0.0:
        v_p = point_vector8(contact.v, nodes, wa, wb)
        v = subtract(v_p, vector_at8(contact.v, (K, S, tall), za, zb))
        sliding = sliding_velocity(v, closing, n)
        kept = held(touched, slip8(pressure, first))
        pull, slip, lost = friction_force(pressure, contact.dt, p, area, f, kept, sliding, n, which)
        store_where(pressure.slip_x[0], points, which, slip[0])
        store_where(pressure.slip_y[0], points, which, slip[1])
        store_where(pressure.slip_z[0], points, which, slip[2])
        pressure.friction_work[p] += reduce_add(lost)
        own = (wa[0], wa[1], wa[2], 0.0), (wb[0], wb[1], wb[2], 0.0)
        for c in range(3):
            scatter_to_points8(front_force[c], at, 0.0 - pull[c], own)
            scatter8(rear_force[c], behind_at, pull[c], (za, zb))


@kernel(_nrt=False, forceinline=True)
def slip8(pressure, first):
    """Return the elastic slips [m] on the next ply of eight points from number `first` on."""
    return (
        load(pressure.slip_x[0], first),
        load(pressure.slip_y[0], first),
        load(pressure.slip_z[0], first),
    )


@kernel(_nrt=False, forceinline=True)
def release8(pressure, p, area, points, touched, which):
    """Let the springs of those of eight points that are `which` go, as nothing presses any more, and
    return the energy [J] of those that had `touched` a step ago."""
    first, _ = points
    kept = held(which, held(touched, slip8(pressure, first)))
    none = broadcast(0.0)
    store_where(pressure.slip_x[0], points, which, none)
    store_where(pressure.slip_y[0], points, which, none)
    store_where(pressure.slip_z[0], points, which, none)
    return 0.5 * pressure.stick_stiffness[p] * reduce_add(area * dot(kept, kept))
