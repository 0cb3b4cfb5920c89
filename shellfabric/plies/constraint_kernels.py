"""Non-penetration constraints of torn plies, pair by pair: the impulse that keeps a point on its side of a facet.

The method and its symbols are those of `plies.torn_contact_kernels`.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.plies.broad_phase_kernels import MIRROR_X, MIRROR_Y, ROW_STRIDE, element_mean
from shellfabric.plies.point_kernels import grow_window
from shellfabric.plies.turn_kernels import turn_of, turned

_MAX_CORRECTION = 0.1  # [gaps] by which what is nearer than the gap is moved in a step
_TRIANGLE_TOLERANCE = 0.02  # of a triangle, beyond its sides
_MIN_NORMAL_COSINE = 0.5  # cosine of the most that a normal may turn in a step


@kernel(_nrt=False)
def resolve_pair(stops, number, fraction):
    """Keep the middle of an element off a facet, by number in the list, if it would come through: whether it would."""
    p, e, q, f = (
        stops.candidates[number, 0],
        stops.candidates[number, 1],
        stops.candidates[number, 2],
        stops.candidates[number, 3],
    )
    side = stops.candidate_normal[number]
    own, s, gap = stops.ply_shape[p, ROW_STRIDE], stops.ply_shape[q, ROW_STRIDE], stops.min_distance[p]
    x0, y0, z0 = element_mean(stops.x, p, e, own)
    x1, y1, z1 = element_mean(stops.x_next, p, e, own)
    ring = f, f + s, f + s + 1, f + 1
    M0, M1 = element_mean(stops.x, q, f, s), element_mean(stops.x_next, q, f, s)
    for n in range(4):
        k, o = ring[n], ring[(n + 1) & 3]
        m_x, m_y, m_z, before = triangle_distance(stops.x, q, M0, k, o, x0, y0, z0)
        n_x, n_y, n_z, after = triangle_distance(stops.x_next, q, M1, k, o, x1, y1, z1)
        if n_x * m_x + n_y * m_y + n_z * m_z < _MIN_NORMAL_COSINE:
            continue  # of a line, or a sliver that turns over within the step: its sides are not those of the fabric
        if before * (n_x * side[0] + n_y * side[1] + n_z * side[2]) > 0.0:
            continue  # it is through by what the contact knows of it, which brings it back
        if before < 0.0:
            n_x, n_y, n_z, before, after = -n_x, -n_y, -n_z, -before, -after
        wanted = fraction * (gap if before > gap else min(gap, before + _MAX_CORRECTION * gap))
        if after >= wanted:
            continue
        share = before / (before - after) if after < 0.0 else 1.0
        u, v = triangle_weights(stops, q, M0, M1, k, o, share, (x0, y0, z0), (x1, y1, z1))
        slack = _TRIANGLE_TOLERANCE if after < 0.0 else 0.0
        if u < -slack or v < -slack or u + v > 1.0 + slack:
            continue
        # weights of the facet's nodes: a quarter each of the middle's, and the corners' own
        rest = 0.25 * (1.0 - u - v)
        a, b = 2.0 * rest, 2.0 * rest
        a += (u if n == 1 or n == 2 else 0.0) + (v if n == 0 or n == 1 else 0.0)
        b += (u if n == 2 or n == 3 else 0.0) + (v if n == 1 or n == 2 else 0.0)
        if not stops.intact_quadrants[q, f] >> (2 * (a > 0.5) + (b > 0.5)) & 1:
            continue
        give = 0.0
        for m in (e, e + 1, e + own, e + own + 1):
            give += 0.0625 * stops.dt_over_mass[p, m] * mobility(stops, p, m, n_x, n_y)
        for m in range(4):
            w = rest + (u if m == n else 0.0) + (v if m == ((n + 1) & 3) else 0.0)
            give += w * w * stops.dt_over_mass[q, ring[m]] * mobility(stops, q, ring[m], n_x, n_y)
        if give == 0.0:
            continue
        force = (wanted - after) / (stops.dt * give)
        for m in (e, e + 1, e + own, e + own + 1):
            add_force(stops, p, m, 0.25 * force * n_x, 0.25 * force * n_y, 0.25 * force * n_z)
        for m in range(4):
            w = -force * (rest + (u if m == n else 0.0) + (v if m == ((n + 1) & 3) else 0.0))
            add_force(stops, q, ring[m], w * n_x, w * n_y, w * n_z)
        return True
    return False


@kernel(_nrt=False, forceinline=True)
def triangle_distance(x, q, M, k, o, p_x, p_y, p_z):
    """Normal of the triangle from M to the nodes k and o of ply q, and how far a point is above it; 0 of a line."""
    a_x, a_y, a_z = x[q, 0, k] - M[0], x[q, 1, k] - M[1], x[q, 2, k] - M[2]
    b_x, b_y, b_z = x[q, 0, o] - M[0], x[q, 1, o] - M[1], x[q, 2, o] - M[2]
    n_x, n_y, n_z = a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x
    size = np.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    if size < 1e-16:
        return 0.0, 0.0, 0.0, 0.0
    n_x, n_y, n_z = n_x / size, n_y / size, n_z / size
    return n_x, n_y, n_z, n_x * (p_x - M[0]) + n_y * (p_y - M[1]) + n_z * (p_z - M[2])


@kernel(_nrt=False, forceinline=True)
def triangle_weights(stops, q, M0, M1, k, o, share, start, end):
    """Weights of the nodes k and o where a point is on a triangle, `share` of the step on its way from start to end."""
    (x0, y0, z0), (x1, y1, z1) = start, end
    m_x, m_y, m_z = M0[0] + share * (M1[0] - M0[0]), M0[1] + share * (M1[1] - M0[1]), M0[2] + share * (M1[2] - M0[2])
    A, B = stops.x, stops.x_next
    a_x = A[q, 0, k] + share * (B[q, 0, k] - A[q, 0, k]) - m_x
    a_y = A[q, 1, k] + share * (B[q, 1, k] - A[q, 1, k]) - m_y
    a_z = A[q, 2, k] + share * (B[q, 2, k] - A[q, 2, k]) - m_z
    b_x = A[q, 0, o] + share * (B[q, 0, o] - A[q, 0, o]) - m_x
    b_y = A[q, 1, o] + share * (B[q, 1, o] - A[q, 1, o]) - m_y
    b_z = A[q, 2, o] + share * (B[q, 2, o] - A[q, 2, o]) - m_z
    p_x, p_y, p_z = x0 + share * (x1 - x0) - m_x, y0 + share * (y1 - y0) - m_y, z0 + share * (z1 - z0) - m_z
    aa, ab, bb = a_x * a_x + a_y * a_y + a_z * a_z, a_x * b_x + a_y * b_y + a_z * b_z, b_x * b_x + b_y * b_y + b_z * b_z
    pa, pb = p_x * a_x + p_y * a_y + p_z * a_z, p_x * b_x + p_y * b_y + p_z * b_z
    det = aa * bb - ab * ab
    if det <= 1e-12 * aa * bb:
        return -1.0, -1.0
    return (bb * pa - ab * pb) / det, (aa * pb - ab * pa) / det


@kernel(_nrt=False, forceinline=True)
def mobility(stops, p, k, n_x, n_y):
    """Part of a way along n that a node may go; one on a plane of symmetry keeps to it."""
    s = stops.ply_shape[p, ROW_STRIDE]
    part = 1.0 - (n_x * n_x if stops.ply_shape[p, MIRROR_X] and k < s else 0.0)
    return max(part - (n_y * n_y if stops.ply_shape[p, MIRROR_Y] and k % s == 0 else 0.0), 0.0)


@kernel(_nrt=False, forceinline=True)
def add_force(stops, p, k, f_x, f_y, f_z):
    """A force on a node, and where that takes it."""
    i, j = k // stops.ply_shape[p, ROW_STRIDE], k % stops.ply_shape[p, ROW_STRIDE]
    f_x = 0.0 if i == 0 and stops.ply_shape[p, MIRROR_X] else f_x
    f_y = 0.0 if j == 0 and stops.ply_shape[p, MIRROR_Y] else f_y
    far, force, to = stops.dt * stops.dt_over_mass[p, k], stops.f, stops.x_next
    stops.last_moved[p, k] = stops.sweep[0]
    own_x, own_y = turned(turn_of(stops.turns, p), f_x, f_y)
    force[p, 0, k] += own_x
    force[p, 1, k] += own_y
    force[p, 2, k] += f_z
    to[p, 0, k] += far * f_x
    to[p, 1, k] += far * f_y
    to[p, 2, k] += far * f_z
    grow_window(stops.window[p], i, j, 1)
