"""Signed distance to the meridian of a body of revolution, and what it takes and gives there.

The outline is a polygon (r, z). The profile K is that polygon set back by the edge radius rho, the body
K grown by a ball of that radius: its edges are rounded and the distance is exact (`sdf_kernels`). A node
is set back along the bisector by 2 rho m / |m|^2, m the sum of the unit normals beside it. Nodes that come
nearer than rho to another part of the outline are left out: a ball of this radius does not reach there.

The body may move over its nose, ring by ring (`metal.motion_kernels`): the velocity at a foot is between
those of the two rings beside it, which share the force on it.
"""

import math

import numpy as np

from shellfabric.jit.compile import entry, kernel
from shellfabric.state import Profile, unit

SHARPEST = 1.0  # least square of the sum of the normals beside a node: 60 degrees each from it
NEAR = 1e-6  # share of the edge radius by which a node of K may be too near to the outline
COINCIDENT = 1e-3  # share of the edge radius below which two nodes of K are one
WIDER = 1e-3  # share by which contact looks further than the largest radius


@kernel()
def side_normal(places, k):
    """Compute the unit normal (n_r, n_z), outwards, of side k of a polygon (n, 2) from tip to tail."""
    t_r = places[k + 1, 0] - places[k, 0]
    t_z = places[k + 1, 1] - places[k, 1]
    length = math.sqrt(t_r * t_r + t_z * t_z)
    return -t_z / length, t_r / length


@kernel()
def share_along(places, k, r, z):
    """Compute the share (0 to 1) of the way along side k at which it is nearest to (r, z), and the
    square of the distance."""
    t_r = places[k + 1, 0] - places[k, 0]
    t_z = places[k + 1, 1] - places[k, 1]
    share = ((r - places[k, 0]) * t_r + (z - places[k, 1]) * t_z) / (t_r * t_r + t_z * t_z)
    share = min(max(share, 0.0), 1.0)
    o_r = r - places[k, 0] - share * t_r
    o_z = z - places[k, 1] - share * t_z
    return share, o_r * o_r + o_z * o_z


@kernel()
def nearest_side(places, count, r, z):
    """Find the place of a polygon nearest to (r, z): its side, and the share of the way along it.

    The nearest node first, then the better of the sides beside it.
    """
    best = np.inf
    nearest = 0
    for k in range(count):
        o_r = r - places[k, 0]
        o_z = z - places[k, 1]
        square = o_r * o_r + o_z * o_z
        if square < best:
            best = square
            nearest = k
    best = np.inf
    side = 0
    share = 0.0
    for k in range(max(nearest - 1, 0), min(nearest + 1, count - 1)):
        along, square = share_along(places, k, r, z)
        if square < best:
            best = square
            side = k
            share = along
    return side, share


@unit("5 numbers", later=True, profile=Profile, r="number", z="number")
def foot_on_profile(profile, r, z):
    """Find the foot of (r, z) on a profile: its side, the share of the way along it, the signed
    distance to it and its gradient (n_r, n_z)."""
    places = profile.place
    side, share = nearest_side(places, profile.count, r, z)
    n_r, n_z = side_normal(places, side)
    # at a corner the normal is that of both sides
    other = side
    if share == 0.0 and side > 0:
        other = side - 1
    if share == 1.0 and side < profile.count - 2:
        other = side + 1
    if other != side:
        m_r, m_z = side_normal(places, other)
        n_r += m_r
        n_z += m_z
        length = math.sqrt(n_r * n_r + n_z * n_z)
        n_r /= length
        n_z /= length
    o_r = r - places[side, 0] - share * (places[side + 1, 0] - places[side, 0])
    o_z = z - places[side, 1] - share * (places[side + 1, 1] - places[side, 1])
    far = math.sqrt(o_r * o_r + o_z * o_z)
    sign = 1.0
    if n_r * o_r + n_z * o_z < 0.0:
        sign = -1.0
    if far > 0.0:
        n_r = sign * o_r / far
        n_z = sign * o_z / far
    return float(side), share, sign * far, n_r, n_z


@kernel()
def rings_beside(profile, side):
    """Return the two rings between which a side of a profile lies."""
    k = int(side)
    return profile.ring[k], profile.ring[k + 1]


@kernel()
def away_from_axis(x, y, component):
    """Return the (x, y) parts of a vector that points away from the axis at (x, y)."""
    r = math.sqrt(x * x + y * y)
    if r > 0.0:
        return component * x / r, component * y / r
    return 0.0, 0.0


@kernel()
def profile_velocity(profile, point, foot):
    """Interpolate the velocity (x, y, z) over that of the nose, of a foot (side, share) of a point."""
    side, share = foot
    a, b = rings_beside(profile, side)
    v_r = (1.0 - share) * profile.velocity[a, 0] + share * profile.velocity[b, 0]
    v_z = (1.0 - share) * profile.velocity[a, 1] + share * profile.velocity[b, 1]
    v_x, v_y = away_from_axis(point[0], point[1], v_r)
    return v_x, v_y, v_z


@kernel()
def push_profile(profile, point, foot, force):
    """Give a force (x, y, z) in the nose's frame at a point to the rings beside its foot."""
    side, share = foot
    a, b = rings_beside(profile, side)
    r = math.sqrt(point[0] * point[0] + point[1] * point[1])
    f_r = 0.0
    if r > 0.0:
        f_r = (force[0] * point[0] + force[1] * point[1]) / r
    profile.force[a, 0] += (1.0 - share) * f_r
    profile.force[b, 0] += share * f_r
    profile.force[a, 1] += (1.0 - share) * force[2]
    profile.force[b, 1] += share * force[2]


@kernel()
def profile_power(profile):
    """Compute the power [W] of the forces on a profile, at its velocities over that of the nose."""
    power = 0.0
    for k in range(profile.force.shape[0]):
        power += profile.force[k, 0] * profile.velocity[k, 0]
        power += profile.force[k, 1] * profile.velocity[k, 1]
    return power


@kernel()
def clear_profile(profile):
    """Take all forces off a profile."""
    profile.force[:] = 0.0


@kernel()
def foremost(outline):
    """Find the largest z [m] of an outline (rings, 2)."""
    found = -np.inf
    for k in range(outline.shape[0]):
        found = max(found, outline[k, 1])
    return found


@kernel()
def set_back(outline, k, radius):
    """Compute (r, z) [m] by which node k of an outline is set back, so that a ball of this radius
    about it touches both sides beside the node."""
    last = outline.shape[0] - 2
    n_r, n_z = side_normal(outline, min(max(k - 1, 0), last))
    m_r, m_z = side_normal(outline, min(k, last))
    m_r += n_r
    m_z += n_z
    if outline[k, 0] <= 0.0:  # the other side is its mirror image
        m_r = 0.0
    scale = 2.0 * radius / max(m_r * m_r + m_z * m_z, SHARPEST)
    return scale * m_r, scale * m_z


@kernel()
def depth_below(outline, r, z):
    """Compute the distance [m] of a place to an outline."""
    best = np.inf
    for k in range(outline.shape[0] - 1):
        _, square = share_along(outline, k, r, z)
        best = min(best, square)
    return math.sqrt(best)


@entry()
def place_profile(profile, outline, radius):
    """Lay the profile into an outline (rings, 2) [m] of tip to tail, set back by an edge radius [m]."""
    nose = foremost(outline)
    widest = 0.0
    shoulder = 0.0
    count = 0
    last = outline.shape[0] - 1
    for k in range(last + 1):
        if outline[k, 0] > widest * (1.0 + WIDER):
            widest = outline[k, 0]
            shoulder = nose - outline[k, 1]
        back_r, back_z = set_back(outline, k, radius)
        r = max(outline[k, 0] - back_r, 0.0)
        z = outline[k, 1] - back_z
        if 0 < k < last and depth_below(outline, r, z) < (1.0 - NEAR) * radius:
            continue
        if count > 0:
            o_r = r - profile.place[count - 1, 0]
            o_z = z - nose - profile.place[count - 1, 1]
            if o_r * o_r + o_z * o_z < (COINCIDENT * radius) ** 2:
                continue
        profile.place[count, 0] = r
        profile.place[count, 1] = z - nose
        profile.ring[count] = k
        count += 1
    profile.count = count
    profile.widest = widest * (1.0 + WIDER)
    profile.shoulder = shoulder
