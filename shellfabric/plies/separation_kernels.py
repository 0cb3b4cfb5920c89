"""Distance of two facets, and the direction across the gap between them.

A facet is a triangle of three nodes (columns of an array of positions), or a bare yarn, whose last
node is given twice.
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.surface.vector_kernels import add_scaled, cross, difference, dot, nodal, scaled

_PARALLEL = 1e-12  # squared sine below which two edges count as parallel


@kernel(_nrt=False, forceinline=True)
def to_face(x, p, a, b, c):
    """Compute the vector from node p to its foot on the plane of a triangle, and whether that is
    within the triangle; at its edges the distances of edges are as small."""
    u = difference(x, a, b)
    v = difference(x, a, c)
    r = difference(x, a, p)
    n = cross(u, v)
    square = dot(n, n)
    if square == 0.0:
        return r, False
    along_u = dot(cross(r, v), n) / square
    along_v = dot(cross(u, r), n) / square
    inside = along_u >= 0.0 and along_v >= 0.0 and along_u + along_v <= 1.0
    height = -dot(r, n) / square
    return scaled(height, n), inside


@kernel(_nrt=False, forceinline=True)
def between_edges(x, a, b, c, d):
    """Compute the shortest vector from the edge of nodes a and b to that of c and d."""
    u = difference(x, a, b)
    v = difference(x, c, d)
    r = difference(x, a, c)
    uu = dot(u, u)
    uv = dot(u, v)
    vv = dot(v, v)
    ur = dot(u, r)
    vr = dot(v, r)
    det = uu * vv - uv * uv
    s = 0.0
    if det > _PARALLEL * uu * vv:
        s = min(max((ur * vv - uv * vr) / det, 0.0), 1.0)
    t = (s * uv - vr) / vv
    # the nearest point is an end of the second edge: the first follows it
    if t < 0.0 or t > 1.0:
        t = min(max(t, 0.0), 1.0)
        s = min(max((ur + t * uv) / uu, 0.0), 1.0)
    return add_scaled(add_scaled(r, t, v), -s, u)


@kernel(_nrt=False, forceinline=True)
def edges_of(nodes, first):
    """Return the number of edges of a facet: 3 of a triangle, 1 of a bare yarn."""
    if nodes[first + 1] == nodes[first + 2]:
        return 1
    return 3


@kernel(_nrt=False, forceinline=True)
def span(x, nodes, first, n):
    """Find the least and the largest of n.x over the three nodes from number `first` on."""
    low = 1e30
    high = -1e30
    for i in range(first, first + 3):
        k = nodes[i]
        along = dot(n, nodal(x, k))
        low = min(low, along)
        high = max(high, along)
    return low, high


@kernel(_nrt=False, forceinline=True)
def lower_bound(x, nodes):
    """Compute a distance [m] that two facets are apart at least, by the planes of both: 0 if these
    say nothing."""
    found = 0.0
    for first in (0, 3):
        n = unit_normal(x, nodes[first], nodes[first + 1], nodes[first + 2])
        low, high = span(x, nodes, 0, n)
        other_low, other_high = span(x, nodes, 3, n)
        found = max(found, max(other_low - high, low - other_high))
    return found


@kernel(_nrt=False, forceinline=True)
def unit_normal(x, a, b, c):
    """Return the unit normal of a facet of three nodes; 0 of a bare yarn."""
    n = cross(difference(x, a, b), difference(x, a, c))
    size = math.sqrt(dot(n, n))
    if b == c or size == 0.0:
        return 0.0, 0.0, 0.0
    return scaled(1.0 / size, n)


@kernel(_nrt=False)
def separation(x, nodes):
    """Compute the width [m] of the widest slab between the facets nodes[:3] and nodes[3:], and its
    direction, a unit vector from the first to the second. The width is not above 0
    where they touch or cross."""
    least = 1e60
    best = (0.0, 0.0, 0.0)
    for i in range(3):
        if nodes[4] != nodes[5]:
            way, inside = to_face(x, nodes[i], nodes[3], nodes[4], nodes[5])
            if inside and dot(way, way) < least:
                least = dot(way, way)
                best = way
        if nodes[1] != nodes[2]:
            way, inside = to_face(x, nodes[3 + i], nodes[0], nodes[1], nodes[2])
            if inside and dot(way, way) < least:
                least = dot(way, way)
                best = scaled(-1.0, way)
    for i in range(edges_of(nodes, 0)):
        for j in range(edges_of(nodes, 3)):
            way = between_edges(
                x, nodes[i], nodes[(i + 1) % 3], nodes[3 + j], nodes[3 + (j + 1) % 3]
            )
            if dot(way, way) < least:
                least = dot(way, way)
                best = way
    size = math.sqrt(least)
    if size == 0.0:
        return 0.0, best
    n = scaled(1.0 / size, best)
    return span(x, nodes, 3, n)[0] - span(x, nodes, 0, n)[1], n
