"""Contact of parallel neighbours: the rounded edges of yarns that lie side by side.

The middles of the tips at the side of a yarn, one a section, form the line C(xi) with the weights of
`spline_kernels`. The edge is a tube of the assumed diameter D about it (`numerics.SolidNumerics`). Of
two neighbours, one of which rises where the other falls, the edges cross: to get past each other they
would have to go through each other. For the tip y of a section, with its foot C(xi) on the line that
it faces, the closest point of that line, and r = y - C,

    U = A Pi(D - |r|),    f = A p r / |r|.

The foot moves at right angles to r and does no work. A is the length of the edge that belongs to the
section, times D; Pi and p are those of `facet_kernels`, as are damper and friction.
"""

import math

import numpy as np

from shellfabric.contact.friction_kernels import slide
from shellfabric.jit.compile import entry, kernel
from shellfabric.surface.vector_kernels import add_scaled, dot, scaled, subtract, three
from validation.models.solids.facet_kernels import CLOSE, TRIES, pressure, steps_to
from validation.models.solids.spline_kernels import line_weights

SIDES = 2  # of a yarn
STATIONS = 4  # that shape a line


@kernel()
def tip_node(patch, side, station):
    """Return the lowest node of a tip; the others through it follow."""
    sheet = (patch.ny[side // SIDES] + 1) * (patch.nz + 1)
    return patch.side_node[side] + station * sheet


@kernel(fastmath={"contract"})
def tip_of(patch, values, side, station):
    """Return the mean of the rows of an array (n, 3) at the nodes of a tip."""
    first = tip_node(patch, side, station)
    found = (0.0, 0.0, 0.0)
    for k in range(patch.nz + 1):
        found = add_scaled(found, 1.0 / (patch.nz + 1), three(values[first + k], 0))
    return found


@kernel()
def add_at_tip(patch, side, station, force):
    """Add an internal force [N] to the nodes of a tip, alike."""
    first = tip_node(patch, side, station)
    for k in range(patch.nz + 1):
        for c in range(3):
            patch.f_other[first + k, c] += force[c] / (patch.nz + 1)


@kernel()
def as_seen(patch, side, station, vector):
    """Return a vector at a section as its mirror image has it, if the number of the section is below
    0."""
    if station >= 0:
        return vector
    if patch.family[side // SIDES] == 0:
        return -vector[0], vector[1], vector[2]
    return vector[0], -vector[1], vector[2]


@kernel(fastmath={"contract"})
def line_point(patch, values, side, stations, w):
    """Sum up w[m] times the means of the rows of an array (n, 3) at four tips of a side, which may be
    mirrored."""
    found = (0.0, 0.0, 0.0)
    for m in range(STATIONS):
        tip = tip_of(patch, values, side, abs(stations[m]))
        found = add_scaled(found, w[m], as_seen(patch, side, stations[m], tip))
    return found


@kernel(fastmath={"contract"})
def find_tip(patch, tip, side, place, stations, w, slope):
    """Find the foot of a tip on the side that it faces.

    Parameters
    ----------
    place : (3,) [m] of the tip
    stations : (4,) int, w, slope : (4,) filled: sections, below 0 if mirrored, and their weights

    Returns
    -------
    r : (3,) [m] from the foot to the tip
    found : whether it is the foot; where it has run on it is found in a later call
    """
    nx = patch.nx[side // SIDES]
    moved = 0.0
    for tried in range(TRIES):
        seen = patch.tip_foot[tip]
        cell = line_weights(seen, nx, patch.quarter == 1, w, slope)
        for m in range(STATIONS):
            stations[m] = min(cell + m - 1, nx)
        r = subtract(place, line_point(patch, patch.x, side, stations, w))
        along = line_point(patch, patch.x, side, stations, slope)
        step = dot(r, along) / dot(along, along)
        patch.tip_foot[tip] = min(max(seen + min(max(step, -1.0), 1.0), 0.0), nx)
        moved = abs(patch.tip_foot[tip] - seen)
        if moved < CLOSE or tried == TRIES - 1:
            break
    return r, moved < CLOSE


@kernel()
def tip_gone(patch, side, station):
    """Tell whether a brick at a tip is torn."""
    yarn = side // SIDES
    across = 0
    if side % SIDES == 1:
        across = patch.ny[yarn] - 1
    for a in range(max(station - 1, 0), min(station + 1, patch.nx[yarn])):
        first = patch.first_brick[yarn] + (a * patch.ny[yarn] + across) * patch.nz
        for k in range(patch.nz):
            if patch.torn[first + k]:
                return True
    return False


@kernel()
def clear_tip(patch, tip, stiffness):
    """Let a tip slip freely, since it is clear: what its friction held is lost to sliding."""
    slider = three(patch.tip_slider[tip], 0)
    patch.friction_work += 0.5 * stiffness * dot(slider, slider)
    patch.tip_energy[tip] = 0.0
    for c in range(3):
        patch.tip_slider[tip, c] = 0.0


@kernel(fastmath={"contract"})
def meet_neighbour(patch, side, station, tip, dt, stations, w, slope):
    """Add the forces of one tip on the side that it faces.

    dt : [s] since the last call; 0 at the first
    stations, w, slope : (4,) scratch
    """
    facing = patch.side_partner[side]
    area = patch.tip_area[tip]
    stiffness = 0.5 * patch.penalty * area
    place = tip_of(patch, patch.x, side, station)
    r, found = find_tip(patch, tip, facing, place, stations, w, slope)
    distance = math.sqrt(dot(r, r))
    depth = patch.tip_diameter[tip] - distance
    if depth <= 0.0 or not found:
        clear_tip(patch, tip, stiffness)
        if found:
            patch.tip_wait[tip] = steps_to(patch, -depth)
        return
    under = int(patch.tip_foot[tip] + 0.5)
    if tip_gone(patch, side, station) or tip_gone(patch, facing, under):
        patch.failure_energy += patch.tip_energy[tip]
        patch.tip_energy[tip] = 0.0
        patch.tip_wait[tip] = -1
        return
    out = scaled(1.0 / distance, r)
    p, stored, closed = pressure(depth, 0.5 * patch.penalty, patch.toe)
    v = tip_of(patch, patch.v, side, station)
    v = subtract(v, line_point(patch, patch.v, facing, stations, w))
    opening = dot(v, out)
    push = area * p
    drag = max(-closed * patch.tip_damping[tip] * opening, -push)
    patch.contact_damping -= drag * opening * dt
    force = scaled(push + drag, out)
    energy = area * stored
    if patch.friction > 0.0:
        limit = patch.friction * push
        kept, slid = slide(patch.tip_slider[tip], limit, stiffness, dt, out, v)
        force = add_scaled(force, -stiffness, three(patch.tip_slider[tip], 0))
        energy += kept
        patch.friction_work += slid
    patch.tip_energy[tip] = energy
    add_at_tip(patch, side, station, scaled(-1.0, force))
    for m in range(STATIONS):
        own = scaled(w[m], as_seen(patch, facing, stations[m], force))
        add_at_tip(patch, facing, abs(stations[m]), own)


@kernel()
def tip_forces(patch, dt):
    """Add the forces of all parallel neighbours on each other."""
    stations = np.empty(STATIONS, np.int64)
    w = np.empty(STATIONS)
    slope = np.empty(STATIONS)
    for side in range(patch.side_node.size):
        if patch.side_partner[side] < 0:
            continue
        for station in range(patch.nx[side // SIDES] + 1):
            tip = patch.side_tip[side] + station
            if patch.tip_wait[tip] < 0:  # gone with a brick
                continue
            if patch.tip_wait[tip] > 0:
                patch.tip_wait[tip] -= 1
                continue
            meet_neighbour(patch, side, station, tip, dt, stations, w, slope)


@entry()
def find_tips(patch, distances):
    """Find the feet of all tips from where they are; fills the distances (tips,) [m], infinite where
    a tip faces none."""
    stations = np.empty(STATIONS, np.int64)
    w = np.empty(STATIONS)
    slope = np.empty(STATIONS)
    for side in range(patch.side_node.size):
        facing = patch.side_partner[side]
        for station in range(patch.nx[side // SIDES] + 1):
            tip = patch.side_tip[side] + station
            distances[tip] = np.inf
            if facing < 0:
                continue
            place = tip_of(patch, patch.x, side, station)
            r, _ = find_tip(patch, tip, facing, place, stations, w, slope)
            distances[tip] = math.sqrt(dot(r, r))
