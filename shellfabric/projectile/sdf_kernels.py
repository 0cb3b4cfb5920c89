"""Shapes of the projectile: signed distances with unit gradients, in the frame of the projectile. The axis is
z, the nose's foremost point at z = 0, the body at z <= 0; docs/theory-panel.md, "Projectile". All but STL
and OGIVE are convex and exact: a body K grown by a ball of radius rho, which rounds its edges.

    FLAT, HEMISPHERE, CONE   noses of a cylinder of radius R, without an end or with a flat, rounded one
    SPHERE                   ball of radius R, nothing behind it
    CHISEL                   flat strip across the nose, along y, and two flats that fall off from it
    STL                      samples on a grid (`solid`), interpolated by tricubic B-splines
    OGIVE, PROFILE           a body of revolution whose meridian is a polygon (`profile_kernels`)

A new shape is one function here, one line in `distance`, and an entry of `shapes.SHAPES`.
"""

import math

import numpy as np

from shellfabric.jit.compile import entry, kernel
from shellfabric.projectile.profile_kernels import foot_on_profile
from shellfabric.state import unit
from shellfabric.surface.vector_kernels import three

FLAT, HEMISPHERE, CONE, SPHERE, CHISEL, STL, OGIVE = range(7)  # in the order of `shapes.SHAPES`
PROFILE = OGIVE  # any body of revolution whose meridian is a profile
STL_HEAD = 7  # numbers before the coefficients


@kernel()
def flat(r, z, R, rho):
    """Compute the signed distance to the flat nose and its gradient (n_r, n_z)."""
    q_r = r - R + rho
    q_z = z + rho
    if q_r > 0.0 and q_z > 0.0:
        length = math.sqrt(q_r * q_r + q_z * q_z)
        return length - rho, q_r / length, q_z / length
    if q_r > q_z:
        return q_r - rho, 1.0, 0.0
    return q_z - rho, 0.0, 1.0


@kernel()
def ball(r, z, radius):
    """Compute the signed distance to a ball about (0, z = 0) and its gradient; at its centre the
    axis."""
    length = math.sqrt(r * r + z * z)
    if length == 0.0:
        return -radius, 0.0, 1.0
    return length - radius, r / length, z / length


@kernel()
def hemisphere(r, z, R):
    """Compute the signed distance to a cylinder with a ball for a nose, and its gradient."""
    if z + R > 0.0:
        return ball(r, z + R, R)
    return r - R, 1.0, 0.0


@unit("3 numbers", later=True, r="number", z="number", R="number", rho="number", form="n")
def cone(r, z, R, rho, form):
    """Compute the signed distance to a cone with a rounded tip and shoulder before a cylinder, and
    its gradient.

    The outline is arc, line, arc, line, each tangent to the next; the normals where they meet part
    the plane.
    """
    tip = form[0]
    sine = form[1]
    cosine = form[2]
    shoulder = form[3]
    back = r * sine - (z + tip) * cosine  # along the flank, from where the tip ends
    if back < 0.0:
        return ball(r, z + tip, tip)
    q_r = r - R + rho
    q_z = z - shoulder
    if q_z > 0.0 and q_r * sine - q_z * cosine > 0.0:
        return ball(q_r, q_z, rho)
    flank = r * cosine + (z + tip) * sine - tip
    side = q_r - rho
    if flank > side:
        return flank, cosine, sine
    return side, 1.0, 0.0


@kernel()
def on_ellipse(t, y, a, b):
    """Find the point of the ellipse (t / a)^2 + (y / b)^2 = 1, a >= b, nearest to (t, y), both at
    least 0.

    Its Lagrange multiplier is the one root above -b^2 of a function that falls and is convex there:
    Newton's method from its left climbs to it without overshooting.
    """
    y = max(y, 1e-12 * b)  # on the long axis inside the evolute the nearest point is no more unique
    low = max(-b * b + b * y, -a * a + a * t)
    for _ in range(60):
        p = a * t / (low + a * a)
        q = b * y / (low + b * b)
        slope = -2.0 * (p * p / (low + a * a) + q * q / (low + b * b))
        rise = (p * p + q * q - 1.0) / -slope
        low += rise
        if not rise > 1e-15 * a * a:
            break
    return a * a * t / (low + a * a), b * b * y / (low + b * b)


@kernel()
def nearest_rim(x, y, z, radius, strip, sine, cosine):
    """Find the point nearest to (x, y, z), x and y at least 0, on the rim where the cylinder cuts
    strip and flat of a chisel."""
    # rim of the strip: an arc of a circle at z = 0, from x = strip to x = 0
    r = math.sqrt(x * x + y * y)
    e_x = 0.0
    if r > 0.0:
        e_x = min(radius * x / r, strip)
    e_y = math.sqrt(radius * radius - e_x * e_x)
    arc = (x - e_x) ** 2 + (y - e_y) ** 2 + z * z
    # rim of the flat: an arc of an ellipse in its plane, t along the slope from the axis of the
    # cylinder
    t = max(cosine * x - sine * (z - strip * sine / cosine), 0.0)
    f_t, f_y = on_ellipse(t, y, radius / cosine, radius)
    f_x = max(f_t * cosine, strip)
    f_y = math.sqrt(max(radius * radius - f_x * f_x, 0.0))
    f_z = (strip - f_x) * sine / cosine
    slope = (x - f_x) ** 2 + (y - f_y) ** 2 + (z - f_z) ** 2
    if arc <= slope:
        return e_x, e_y, 0.0
    return f_x, f_y, f_z


@unit(
    "4 numbers", later=True, x="number", y="number", z="number", R="number", rho="number", form="n"
)
def chisel(x, y, z, R, rho, form):
    """Compute the signed distance to a chisel nose and its gradient (n_x, n_y, n_z).

    K is the cylinder R - rho cut by the strip's plane and by the two flats. Outside it the nearest
    point is that of the prism between the planes, if the cylinder holds it; or that of the
    cylinder, if the planes hold it; or on the rim.
    """
    strip = form[0]
    sine = form[1]
    cosine = form[2]
    radius = R - rho
    p_x = abs(x)
    p_y = abs(y)
    p_z = z + rho
    r = math.sqrt(p_x * p_x + p_y * p_y)
    side = r - radius
    off = (p_x - strip) * sine + p_z * cosine
    if side <= 0.0 and off <= 0.0 and p_z <= 0.0:
        if side >= off and side >= p_z:
            if r == 0.0:
                return side - rho, 0.0, 0.0, 0.0
            return side - rho, x / r, y / r, 0.0
        if off > p_z:
            return off - rho, math.copysign(sine, x), 0.0, cosine
        return p_z - rho, 0.0, 0.0, 1.0
    # nearest point of the prism: on the strip, at its corner, on the flat, or the point itself
    e_x = p_x
    e_z = p_z
    if p_z > 0.0 and p_x <= strip:
        e_z = 0.0
    elif off > 0.0 and (p_x - strip) * cosine - p_z * sine <= 0.0:
        e_x = strip
        e_z = 0.0
    elif off > 0.0:
        e_x = p_x - off * sine
        e_z = p_z - off * cosine
    e_y = p_y
    if e_x * e_x + e_y * e_y > radius * radius:
        e_x = p_x * radius / r
        e_y = p_y * radius / r
        e_z = p_z
        if e_z > 0.0 or (e_x - strip) * sine + e_z * cosine > 0.0:
            e_x, e_y, e_z = nearest_rim(p_x, p_y, p_z, radius, strip, sine, cosine)
    n_x = p_x - e_x
    n_y = p_y - e_y
    n_z = p_z - e_z
    length = math.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    if length == 0.0:  # on the boundary of K but for rounding
        return -rho, 0.0, 0.0, 1.0
    return (
        length - rho,
        math.copysign(n_x / length, x),
        math.copysign(n_y / length, y),
        n_z / length,
    )


@kernel()
def b_spline(t):
    """Compute the weights of the four cubic B-splines at a share t of the interval between the
    middle two, and their slopes."""
    a = 1.0 - t
    w = (
        a * a * a / 6.0,
        2.0 / 3.0 - 0.5 * t * t * (1.0 + a),
        2.0 / 3.0 - 0.5 * a * a * (1.0 + t),
        t * t * t / 6.0,
    )
    return w, (-0.5 * a * a, 0.5 * t * (3.0 * t - 4.0), 0.5 * a * (4.0 - 3.0 * a), 0.5 * t * t)


@unit("4 numbers", later=True, x="number", y="number", z="number", form="n")
def sampled(x, y, z, form):
    """Interpolate the signed distance between samples, and the unit vector along its gradient.

    Outside the grid, whose faces lie off the body, what lies between comes on top.
    """
    ny = int(form[5])
    nz = int(form[6])
    per = form[3]
    p_x = (x - form[0]) * per
    p_y = (y - form[1]) * per
    p_z = (z - form[2]) * per
    q_x = min(max(p_x, 1.0), form[4] - 2.001)
    q_y = min(max(p_y, 1.0), form[5] - 2.001)
    q_z = min(max(p_z, 1.0), form[6] - 2.001)
    i = int(q_x)
    j = int(q_y)
    k = int(q_z)
    u, du = b_spline(q_x - i)
    v, dv = b_spline(q_y - j)
    w, dw = b_spline(q_z - k)
    depth = 0.0
    n_x = 0.0
    n_y = 0.0
    n_z = 0.0
    for a in range(4):
        for b in range(4):
            row = STL_HEAD + ((i - 1 + a) * ny + j - 1 + b) * nz + k - 1
            along = (
                w[0] * form[row]
                + w[1] * form[row + 1]
                + w[2] * form[row + 2]
                + w[3] * form[row + 3]
            )
            slope = (
                dw[0] * form[row]
                + dw[1] * form[row + 1]
                + dw[2] * form[row + 2]
                + dw[3] * form[row + 3]
            )
            depth += u[a] * v[b] * along
            n_x = n_x + du[a] * v[b] * along
            n_y = n_y + u[a] * dv[b] * along
            n_z = n_z + u[a] * v[b] * slope
    o_x = p_x - q_x
    o_y = p_y - q_y
    o_z = p_z - q_z
    off = math.sqrt(o_x * o_x + o_y * o_y + o_z * o_z)
    if off > 0.0:
        depth = depth + off / per
        n_x = o_x
        n_y = o_y
        n_z = o_z
    length = math.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    if length == 0.0:
        return depth, 0.0, 0.0, 1.0
    return depth, n_x / length, n_y / length, n_z / length


@kernel()
def from_axis(x, y, r, component):
    """Return the (x, y) parts of a vector with this component away from the axis, at the distance r
    from it."""
    if r > 0.0:
        return component * x / r, component * y / r
    return 0.0, 0.0


@kernel()
def distance_to_profile(nose, point):
    """Compute the foot (side, share) of a point on a profile, the signed distance to the body and
    its gradient (n_x, n_y, n_z)."""
    x, y, z = point
    r = math.sqrt(x * x + y * y)
    side, share, depth, n_r, n_z = foot_on_profile(nose.profile, r, z)
    n_x, n_y = from_axis(x, y, r, n_r)
    return (side, share), depth - nose.edge_radius, (n_x, n_y, n_z)


@kernel()
def reach(const):
    """Return the radius [m] of the cylinder that holds the projectile as it is."""
    if const.nose.kind == PROFILE:
        return const.nose.profile.widest
    return const.projectile_radius


@kernel()
def shoulder_of(const):
    """Return the depth [m] behind the nose from which the projectile has its full width."""
    if const.nose.kind == PROFILE:
        return const.nose.profile.shoulder
    return const.shoulder


@entry()
def distance(nose, point):
    """Compute the signed distance of a point (x, y, z) to a projectile and its gradient (n_x, n_y,
    n_z).

    `form` has what a shape needs beside R and rho:
        CONE   (tip radius, sine and cosine of the half angle, height of the shoulder's centre)
        CHISEL (half the width of the strip of K, sine and cosine of the angle of the flats)
        STL    (place of first sample, 1 / spacing, numbers of samples, B-spline coefficients)

    nose : its shape (`state.Nose`)

    The body that ends is the one without an end cut by a flat nose that faces back. Of two
    distances to convex bodies on one cylinder the larger is exact.
    """
    x, y, z = point
    shape = nose.kind
    R = nose.radius
    rho = nose.edge_radius
    if shape == STL:
        depth, n_x, n_y, n_z = sampled(x, y, z, nose.form)
        return depth, (n_x, n_y, n_z)
    if shape == PROFILE:
        _, depth, normal = distance_to_profile(nose, point)
        return depth, normal
    r = math.sqrt(x * x + y * y)
    if shape == CHISEL:
        depth, n_x, n_y, n_z = chisel(x, y, z, R, rho, nose.form)
    else:
        if shape == FLAT:
            depth, n_r, n_z = flat(r, z, R, rho)
        elif shape == HEMISPHERE:
            depth, n_r, n_z = hemisphere(r, z, R)
        elif shape == CONE:
            depth, n_r, n_z = cone(r, z, R, rho, nose.form)
        else:
            depth, n_r, n_z = ball(r, z + R, R)
        n_x, n_y = from_axis(x, y, r, n_r)
    if nose.length < np.inf:
        end, e_r, e_z = flat(r, -nose.length - z, R, rho)
        if end > depth:
            n_x, n_y = from_axis(x, y, r, e_r)
            return end, (n_x, n_y, -e_z)
    return depth, (n_x, n_y, n_z)


@entry()
def trace(nose, points, directions):
    """Move points (n, 3) inside a projectile along unit directions (n, 3) to its surface, by its
    distance each time."""
    for m in range(points.shape[0]):
        for _ in range(200):
            depth = distance(nose, three(points[m], 0))[0]
            for c in range(3):
                points[m, c] -= depth * directions[m, c]
            if depth > -1e-6 * nose.radius:
                break
