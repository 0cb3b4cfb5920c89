"""Contact of two edges that cross: the sharp tips of two parallel neighbours, which meet at a point, not
on a face. Each edge is the C1 Catmull-Rom curve through its nodes; r = E - C at their closest points:

    r . a = 0,   r . b = 0,   a = C',  b = E',   r = g n,   n = +-(a x b) / |a x b|

The force -p(g) A g_q, with the law of `surface_contact_kernels` and a constant area A, has a potential.
With U = [-a . r_q; b . r_q], V = [-n . a_q; n . b_q], m = [[a.a, -a.b], [-a.b, b.b]], N = diag(-n . C'',
n . E''), and L = m + g N, which needs no division by g,

    g_q = n . r_q,    g_qq = U^T m^-1 N L^-1 U - U^T L^-1 V - V^T L^-1 U - g V^T L^-1 V
"""

from __future__ import annotations

import numpy as np

from fabrics.base.kernel_cache import kernel
from unitcell3d.contact.surface_contact_kernels import pressure
from unitcell3d.contact.surface_kernels import dot

STEPS = 40


@kernel()
def spline_weights(xi, cells, weights):
    """Fill in the Catmull-Rom weights of the four nodes first .. first + 3 (clipped to the edge)
    and their two derivatives.

    A phantom node continues the edge straight beyond each end and is folded back into weights of
    the real ones.

    Parameters
    ----------
    xi : parameter, 0 .. cells
    cells : along the edge
    weights : (3, 4) filled

    Returns
    -------
    first : number of the first node of the stencil, may be -1
    """
    cell = min(max(int(np.floor(xi)), 0), cells - 1)
    t = xi - cell
    weights[0, 0] = 0.5 * (-t + 2 * t * t - t**3)
    weights[0, 1] = 0.5 * (2 - 5 * t * t + 3 * t**3)
    weights[0, 2] = 0.5 * (t + 4 * t * t - 3 * t**3)
    weights[0, 3] = 0.5 * (-t * t + t**3)
    weights[1, 0] = 0.5 * (-1 + 4 * t - 3 * t * t)
    weights[1, 1] = 0.5 * (-10 * t + 9 * t * t)
    weights[1, 2] = 0.5 * (1 + 8 * t - 9 * t * t)
    weights[1, 3] = 0.5 * (-2 * t + 3 * t * t)
    weights[2, 0] = 0.5 * (4 - 6 * t)
    weights[2, 1] = 0.5 * (-10 + 18 * t)
    weights[2, 2] = 0.5 * (8 - 18 * t)
    weights[2, 3] = 0.5 * (-2 + 6 * t)
    for order in range(3):
        if cell == 0:
            phantom = weights[order, 0]
            weights[order, 0] = 0.0
            weights[order, 1] += 2 * phantom
            weights[order, 2] -= phantom
        if cell == cells - 1:
            phantom = weights[order, 3]
            weights[order, 3] = 0.0
            weights[order, 2] += 2 * phantom
            weights[order, 1] -= phantom
    return cell - 1


@kernel()
def edge_stencil(s, edge, nodes, weights):
    """Fill `nodes` : (4,) and `weights` : (3, 4) of C, C', C'' at s of the curve through the nodes
    `edge` : (n,)."""
    first = spline_weights(s, edge.size - 1, weights)
    for a in range(4):
        nodes[a] = edge[min(max(first + a, 0), edge.size - 1)]


@kernel()
def curve(x, nodes, weights, values):
    """Fill `values` : (3, 3) with C, C', C''."""
    for k in range(3):
        for c in range(3):
            values[k, c] = 0.0
            for a in range(4):
                values[k, c] += weights[k, a] * x[nodes[a], c]


@kernel()
def nearest_nodes(x, first, second, toward, st):
    """Fill `st` : (2,) with the positions of the nodes that are nearest to each other as seen along
    `toward`."""
    least = np.inf
    for i in range(first.size):
        for k in range(second.size):
            r = x[second[k]] - x[first[i]]
            away = dot(r, r) - dot(r, toward) ** 2
            if away < least:
                least = away
                st[0] = i
                st[1] = k


@kernel()
def closest(x, first, second, toward, st, nodes, weights, values):
    """Find the closest points `st` : (2,) of two edges by Newton's method from their nearest nodes;
    False without any."""
    nearest_nodes(x, first, second, toward, st)
    for _ in range(STEPS):
        edge_stencil(st[0], first, nodes[0], weights[0])
        edge_stencil(st[1], second, nodes[1], weights[1])
        curve(x, nodes[0], weights[0], values[0])
        curve(x, nodes[1], weights[1], values[1])
        r = values[1, 0] - values[0, 0]
        a = values[0, 1]
        b = values[1, 1]
        f1 = -dot(r, a)
        f2 = dot(r, b)
        l11 = dot(a, a) - dot(r, values[0, 2])
        l12 = -dot(a, b)
        l22 = dot(b, b) + dot(r, values[1, 2])
        determinant = l11 * l22 - l12 * l12
        if not (l11 > 0.0 and determinant > 0.0):
            l11 = dot(a, a)
            l22 = dot(b, b)
            determinant = l11 * l22 - l12 * l12
        if not determinant > 1e-12 * l11 * l22:
            return False
        d1 = -(l22 * f1 - l12 * f2) / determinant
        d2 = -(l11 * f2 - l12 * f1) / determinant
        largest = max(abs(d1), abs(d2))
        if largest > 0.5:
            d1 = 0.5 * d1 / largest
            d2 = 0.5 * d2 / largest
        st[0] = min(max(st[0] + d1, 0.0), first.size - 1.0)
        st[1] = min(max(st[1] + d2, 0.0), second.size - 1.0)
        if largest < 1e-13:
            break
    else:
        if not largest < 1e-9:
            return False
    return 0.0 < st[0] < first.size - 1.0 and 0.0 < st[1] < second.size - 1.0


@kernel()
def edge_pass(x, first, second, toward, area, penalty, toe, stencil, forces, places, values):
    """Add the contact of two edges: forces, and the tangent if `places` is given.

    Parameters
    ----------
    x : (n, 3) [m] current positions
    first, second : (m,), (k,) node numbers along the edges
    toward : (3,) a direction that leads from the first to the second
    area : [m2] A
    penalty, toe : [Pa/m], [m]
    stencil : (8,) filled: the nodes that act on each other; -1 where there is no contact
    forces : (n, 3) [N] internal forces, added to
    places : (8, 8) blocks of `values`; empty for forces alone
    values : (k, 3, 3) [N/m] blocks, added to

    Returns
    -------
    gap, force : [m] infinite where the edges have no closest points inside, [N]
    """
    nodes = np.empty((2, 4), np.int64)
    weights = np.empty((2, 3, 4))
    found = np.empty((2, 3, 3))
    st = np.empty(2)
    stencil[0] = -1
    if not closest(x, first, second, toward, st, nodes, weights, found):
        return np.inf, 0.0
    a = found[0, 1]
    b = found[1, 1]
    normal = np.cross(a, b)
    normal /= np.sqrt(dot(normal, normal))
    if dot(normal, toward) < 0.0:
        normal = -normal
    gap = dot(found[1, 0] - found[0, 0], normal)
    p, slope = pressure(gap, penalty, toe)
    if p == 0.0:
        return gap, 0.0
    for m in range(8):
        stencil[m] = nodes[m // 4, m % 4]
    # each node's share in r, a and b is a number times the unit matrix
    share = np.empty(8)
    turn = np.empty((2, 8))
    for m in range(8):
        edge = m // 4
        k = m % 4
        share[m] = weights[edge, 0, k] * (1.0 if edge == 1 else -1.0)
        turn[0, m] = weights[0, 1, k] if edge == 0 else 0.0
        turn[1, m] = weights[1, 1, k] if edge == 1 else 0.0
        for c in range(3):
            forces[stencil[m], c] -= p * area * share[m] * normal[c]
    if places.shape[0] > 0:
        edge_tangent(found, normal, gap, p, slope, area, share, turn, places, values)
    return gap, p * area


@kernel()
def edge_tangent(found, normal, gap, p, slope, area, share, turn, places, values):
    """Add the tangent of two edges in contact.

    Parameters
    ----------
    found : (2, 3, 3) [m] C, C', C'' of both edges at their closest points
    normal : (3,) n
    gap, p, slope, area : [m], [Pa], [Pa/m], [m2]
    share : (8,) [-] what each node has in r
    turn : (2, 8) [-] what each node has in a and in b
    places, values : as for `edge_pass`
    """
    n1 = -dot(normal, found[0, 2])
    n2 = dot(normal, found[1, 2])
    a = found[0, 1]
    b = found[1, 1]
    m11 = dot(a, a)
    m12 = -dot(a, b)
    m22 = dot(b, b)
    m_det = m11 * m22 - m12 * m12
    l11 = m11 + gap * n1
    l12 = m12
    l22 = m22 + gap * n2
    l_det = l11 * l22 - l12 * l12
    U = np.empty((2, 8, 3))
    V = np.empty((2, 8, 3))
    for m in range(8):
        for c in range(3):
            U[0, m, c] = -a[c] * share[m]
            U[1, m, c] = b[c] * share[m]
            V[0, m, c] = -normal[c] * turn[0, m]
            V[1, m, c] = normal[c] * turn[1, m]
    for m in range(8):
        for n in range(8):
            place = places[m, n]
            for c in range(3):
                for d in range(3):
                    u1 = U[0, n, d]
                    u2 = U[1, n, d]
                    v1 = V[0, n, d]
                    v2 = V[1, n, d]
                    lu1 = (l22 * u1 - l12 * u2) / l_det
                    lu2 = (l11 * u2 - l12 * u1) / l_det
                    lv1 = (l22 * v1 - l12 * v2) / l_det
                    lv2 = (l11 * v2 - l12 * v1) / l_det
                    w1 = n1 * lu1
                    w2 = n2 * lu2
                    mu1 = (m22 * w1 - m12 * w2) / m_det
                    mu2 = (m11 * w2 - m12 * w1) / m_det
                    curve_ = (
                        U[0, m, c] * (mu1 - lv1)
                        + U[1, m, c] * (mu2 - lv2)
                        - V[0, m, c] * (lu1 + gap * lv1)
                        - V[1, m, c] * (lu2 + gap * lv2)
                    )
                    stiff = -slope * share[m] * share[n] * normal[c] * normal[d]
                    values[place, c, d] += area * (stiff - p * curve_)
