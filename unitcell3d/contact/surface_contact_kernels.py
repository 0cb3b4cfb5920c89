"""Contact of points of one structured surface with the C1 surface (`surface_kernels`) near another, and with plates.

The slave points are the Gauss points of the slave's bilinear faces, x = N_k x_k. For a point with closest point S(xi),
x - S = g n (n: unit normal towards the slave side):

    S_,a . (x - S) = 0,   m_ab = S_,a . S_,b,   k_ab = n . S_,ab,   H_ab = m_ab - g k_ab
    dg = n . (dx - dS)
    D_a = S_,a . (dx - dS),   B_a = n . dS_,a,   dxi = H^-1 (D + g B)
    d(dg) = - D_a m^ab (B_b + k_bc dxi_c) - B_a dxi_a

The contact force is -p(g) A w(xi) dg with the area A of the point and the pressure (penalty k, C1 toe of depth t)

    p = 0 (g >= 0),  k g^2 / 2t (0 < -g < t),  k (-g - t/2) (-g > t).

w is 1 on the master grid and falls to 0 within half a cell beyond a free edge (C1). The equations are those of the
closest-point projection with a large-sliding tangent (e.g. Wriggers, Computational Contact Mechanics, chapter 4); each
side of a crossover is slave once, with half the penalty.

Coulomb friction (coefficient f, regularisation slip s) pulls at the slave point with the traction -tau and at the
master with its opposite, through the same weights as the pressure:

    v = S_,a (xi_a - anchor_a),   tau = f p v / max(|v|, s).

The anchor is where the point stuck when the last load step was accepted; then it is drawn after the point until the
slip v left over is no longer than s (convective slip and return mapping: Laursen and Simo 1993). Slip is measured in
the master's own parameters, so a rigid motion of both makes none.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from unitcell3d.contact.surface_kernels import cell_of, dot, evaluate, nodes_of, project, surround, weights_of

SLAVE, STENCIL = 4, 20  # nodes of a slave face, and with them those of the master's cell
TERMS = 10  # products of rows that make up the tangent of a point


@njit(cache=True)
def pressure(gap, penalty, toe):
    """Contact pressure [Pa] and its slope dp/dg [Pa/m] at the gap `gap` [m] (negative: penetration)."""
    depth = -gap
    if depth <= 0.0:
        return 0.0, 0.0
    if depth < toe:
        return penalty * depth * depth / (2.0 * toe), -penalty * depth / toe
    return penalty * (depth - 0.5 * toe), -penalty


@njit(cache=True)
def overlap_weight(xi, cells, free_low, free_high):
    """Share w of a slave point's area that lies over the master in one direction, and its slope; C1."""
    weight, slope = 1.0, 0.0
    if free_high and xi > cells:
        t = min(2.0 * (xi - cells), 1.0)
        weight, slope = 1.0 - t * t * (3.0 - 2.0 * t), -12.0 * t * (1.0 - t)
    if free_low and xi < 0.0:
        t = min(-2.0 * xi, 1.0)
        weight, slope = 1.0 - t * t * (3.0 - 2.0 * t), 12.0 * t * (1.0 - t)
    return weight, slope


@njit(cache=True)
def point_of(x, nodes, shape, point):
    """Fill `point` : (3,) with the place of a slave point on its face."""
    for c in range(3):
        point[c] = 0.0
        for k in range(SLAVE):
            point[c] += shape[k] * x[nodes[k], c]


@njit(cache=True)
def traction(surface, xi, anchor, p, friction, slip, v, tau):
    """Fill the slip `v` and the friction's traction `tau` : (3,); returns |v|."""
    g1, g2 = xi[0] - anchor[0], xi[1] - anchor[1]
    for c in range(3):
        v[c] = surface[1, c] * g1 + surface[2, c] * g2
    length = np.sqrt(dot(v, v))
    for c in range(3):
        tau[c] = friction * p * v[c] / max(length, slip)
    return length


@njit(cache=True)
def contact_pass(
    x, quads, shapes, areas, grid, axes, mirror, side, penalty, toe, friction, slip,
    xi, anchors, gaps, codes, forces, row_of, places, values, resultant,
):  # fmt: skip
    """One pass: forces of the slave points on the master surface, and their tangent where `places` is given.

    Parameters
    ----------
    x : (n, 3) [m] current positions
    quads : (f, 4) nodes of the slave's faces
    shapes : (g, 4) their shape functions at the Gauss points
    areas : (f g,) [m2] of the points of all faces on the undeformed surface
    grid, axes, mirror : the master, as for `surface_kernels.surround`
    side : +1 where the normal S_,1 x S_,2 points to the slave, else -1
    penalty, toe : [Pa/m], [m]
    friction, slip : coefficient [-] and regularisation slip [m]
    xi : (f g, 2) guess of the closest points; overwritten by them
    anchors : (f g, 2) where each point stuck last; not read without friction
    gaps : (f g,) [m] filled; infinite where the point has no partner
    codes : (f g,) filled: face * (cells of the master) + cell of the master; -1 where there is no contact
    forces : (n, 3) [N] internal forces, added to
    row_of : row of `places` for each code
    places : (m, 20, 20) block of `values` of each pair of the nodes of a code; empty for forces alone
    values : (k, 3, 3) [N/m] blocks, added to
    resultant : (3,) [N] sum of the contact forces on the slaves, added to
    """
    ni, nj = grid.shape
    ringed = np.empty((ni + 2, nj + 2, 3))
    surround(x, grid, axes, mirror, ringed)
    nodes, work = np.empty(STENCIL, np.int64), np.empty((4, 3, 4))
    weights, surface, spread = np.empty((3, 16, 3)), np.empty((6, 3)), np.empty((STENCIL, 3))
    point, normal, v, tau = np.empty(3), np.empty(3), np.empty(3), np.zeros(3)
    left, right = np.empty((TERMS, 3 * STENCIL)), np.empty((TERMS, 3 * STENCIL))
    block = np.empty((3 * STENCIL, 3 * STENCIL))
    for s in range(areas.size):
        gaps[s], codes[s] = np.inf, -1
        face, shape = s // shapes.shape[0], shapes[s % shapes.shape[0]]
        point_of(x, quads[face], shape, point)
        if not project(point, ringed, xi[s], work[0], work[1], surface):
            continue
        normal[:] = side * np.cross(surface[1], surface[2])
        normal /= np.sqrt(dot(normal, normal))
        gap = dot(point - surface[0], normal)
        w1, dw1 = overlap_weight(xi[s, 0], ni - 1, not mirror[0], True)
        w2, dw2 = overlap_weight(xi[s, 1], nj - 1, not mirror[1], True)
        if w1 * w2 == 0.0:
            continue
        gaps[s] = gap
        p, slope = pressure(gap, penalty, toe)
        if p == 0.0:
            continue
        i, j = cell_of(xi[s, 0], ni - 1), cell_of(xi[s, 1], nj - 1)
        codes[s] = (face * (ni - 1) + i) * (nj - 1) + j
        nodes[:SLAVE] = quads[face]
        nodes_of(grid, i, j, nodes[SLAVE:])
        weights_of(xi[s], grid, axes, mirror, weights, work)
        for k in range(SLAVE):
            spread[k] = shape[k]
        spread[SLAVE:] = -weights[0]
        length = 0.0
        if friction > 0.0:
            length = traction(surface, xi[s], anchors[s], p, friction, slip, v, tau)
        area = areas[s]
        share = area * w1 * w2
        for c in range(3):
            push = p * normal[c] - tau[c]
            resultant[c] += share * push
            for m in range(STENCIL):
                forces[nodes[m], c] -= share * push * spread[m, c]
        if places.shape[0] == 0:
            continue
        terms = normal_terms(surface, normal, gap, weights, spread, p, slope, area, w1, w2, dw1, dw2, left, right)
        if friction > 0.0:
            terms = friction_terms(
                surface, normal, weights, spread, p, slope, area, w1, w2, dw1, dw2,
                xi[s, 0] - anchors[s, 0], xi[s, 1] - anchors[s, 1], friction, slip, length, v, tau, left, right,
            )  # fmt: skip
        add_products(left, right, terms, places[row_of[codes[s]]], block, values)


@njit(cache=True)
def normal_terms(surface, normal, gap, weights, spread, p, slope, area, w1, w2, dw1, dw2, left, right):
    """Rows whose products are the tangent of the pressure; those of dxi stand in `right[3]`, `right[4]` over p A w.

    Returns
    -------
    terms : how many rows of `left` and `right` : (10, 60) are filled
    """
    s1, s2 = surface[1], surface[2]
    m11, m12, m22 = dot(s1, s1), dot(s1, s2), dot(s2, s2)
    k11, k12, k22 = dot(normal, surface[3]), dot(normal, surface[4]), dot(normal, surface[5])
    h11, h12, h22 = m11 - gap * k11, m12 - gap * k12, m22 - gap * k22
    h, m_det = h11 * h22 - h12 * h12, m11 * m22 - m12 * m12
    share = area * w1 * w2
    force = p * share
    for m in range(STENCIL):
        for c in range(3):
            at = 3 * m + c
            d1, d2 = spread[m, c] * s1[c], spread[m, c] * s2[c]
            b1 = b2 = 0.0
            if m >= SLAVE:
                b1, b2 = weights[1, m - SLAVE, c] * normal[c], weights[2, m - SLAVE, c] * normal[c]
            e1, e2 = d1 + gap * b1, d2 + gap * b2
            x1, x2 = (h22 * e1 - h12 * e2) / h, (h11 * e2 - h12 * e1) / h
            t1, t2 = b1 + k11 * x1 + k12 * x2, b2 + k12 * x1 + k22 * x2
            across = spread[m, c] * normal[c]
            left[0, at], left[1, at], left[2, at], left[3, at], left[4, at] = across, d1, d2, b1, b2
            right[0, at] = -slope * share * across - p * area * (dw1 * w2 * x1 + w1 * dw2 * x2)
            right[1, at] = force * (m22 * t1 - m12 * t2) / m_det
            right[2, at] = force * (m11 * t2 - m12 * t1) / m_det
            right[3, at], right[4, at] = force * x1, force * x2
    return 5


@njit(cache=True)
def friction_terms(
    surface, normal, weights, spread, p, slope, area, w1, w2, dw1, dw2,
    g1, g2, friction, slip, length, v, tau, left, right,
):  # fmt: skip
    """Rows for the tangent of the friction, after those of `normal_terms`; returns how many are filled."""
    share = area * w1 * w2
    stuck = length <= slip
    phi = 1.0 / max(length, slip)
    dv = np.empty(3)
    for m in range(STENCIL):
        for b in range(3):
            at = 3 * m + b
            x1, x2 = right[3, at] / (p * share), right[4, at] / (p * share)
            dp = slope * spread[m, b] * normal[b]
            leave = area * (dw1 * w2 * x1 + w1 * dw2 * x2)
            turned = 0.0
            if m >= SLAVE:
                turned = g1 * weights[1, m - SLAVE, b] + g2 * weights[2, m - SLAVE, b]
            for c in range(3):
                dv[c] = (surface[1, c] + surface[3, c] * g1 + surface[4, c] * g2) * x1
                dv[c] += (surface[2, c] + surface[4, c] * g1 + surface[5, c] * g2) * x2
            dv[b] += turned
            along = 0.0 if stuck else dot(v, dv) * phi * phi
            for c in range(3):
                dtau = friction * phi * (v[c] * dp + p * (dv[c] - along * v[c]))
                left[5 + c, at] = spread[m, b] if b == c else 0.0
                right[5 + c, at] = share * dtau + tau[c] * leave
            left[8, at] = left[9, at] = 0.0
            if m >= SLAVE:
                left[8, at], left[9, at] = -weights[1, m - SLAVE, b] * tau[b], -weights[2, m - SLAVE, b] * tau[b]
            right[8, at], right[9, at] = share * x1, share * x2
    return 10


@njit(cache=True, fastmath={"contract", "reassoc", "nsz"})
def add_products(left, right, terms, places, block, values):
    """Add the sum of the products left[r] x right[r] to the blocks at `places` : (20, 20)."""
    size = left.shape[1]
    for a in range(size):
        for b in range(size):
            block[a, b] = left[0, a] * right[0, b]
    for r in range(1, terms):
        for a in range(size):
            factor = left[r, a]
            for b in range(size):
                block[a, b] += factor * right[r, b]
    for m in range(size // 3):
        for n in range(size // 3):
            place = places[m, n]
            for a in range(3):
                for b in range(3):
                    values[place, a, b] += block[3 * m + a, 3 * n + b]


@njit(cache=True)
def update_anchors(x, grid, axes, mirror, slip, xi, codes, anchors):
    """Let the anchors follow: to within `slip` [m] of points in contact, to the closest point of the others.

    Parameters
    ----------
    x, grid, axes, mirror, xi, codes : as for `contact_pass`, of the state that has been accepted
    anchors : (s, 2) overwritten
    """
    ni, nj = grid.shape
    ringed, work = np.empty((ni + 2, nj + 2, 3)), np.empty((2, 3, 4))
    surround(x, grid, axes, mirror, ringed)
    surface, v, tau = np.empty((6, 3)), np.empty(3), np.empty(3)
    for s in range(codes.size):
        if codes[s] < 0:
            anchors[s] = xi[s]
            continue
        evaluate(ringed, xi[s], work[0], work[1], surface)
        length = traction(surface, xi[s], anchors[s], 0.0, 0.0, slip, v, tau)
        if length > slip:
            anchors[s] = xi[s] - (xi[s] - anchors[s]) * slip / length


@njit(cache=True)
def plate_pass(x, nodes, areas, height, side, penalty, toe, friction, slip, anchors, forces, places, values):
    """Forces of the nodes of a surface on a rigid plate z = height, and their tangent where `places` is given.

    Parameters
    ----------
    nodes, areas : (s,) node numbers, tributary areas [m2]
    height : [m]
    side : +1 for a plate above the nodes, -1 below
    friction, slip : coefficient [-] and regularisation slip [m]
    anchors : (s, 2) [m] where on the plate each node stuck last
    places : (s,) diagonal block of each node; empty for forces alone

    Returns
    -------
    force : [N] on the plate, positive in compression
    """
    total, v = 0.0, np.empty(2)
    for s in range(nodes.size):
        p, slope = pressure(side * (height - x[nodes[s], 2]), penalty, toe)
        if p == 0.0:
            continue
        forces[nodes[s], 2] += side * p * areas[s]
        total += p * areas[s]
        v[:] = x[nodes[s], :2] - anchors[s]
        length = np.sqrt(v[0] ** 2 + v[1] ** 2)
        phi = friction / max(length, slip)
        for c in range(2):
            forces[nodes[s], c] += areas[s] * p * phi * v[c]
        if places.shape[0] > 0:
            place = places[s]
            values[place, 2, 2] -= slope * areas[s]
            for c in range(2):
                values[place, c, c] += areas[s] * p * phi
                values[place, c, 2] -= areas[s] * phi * v[c] * side * slope
                for d in range(2):
                    if length > slip:
                        values[place, c, d] -= areas[s] * p * phi * v[c] * v[d] / length**2
    return total


@njit(cache=True)
def update_plate_anchors(x, nodes, height, side, slip, anchors):
    """Let the anchors follow to within `slip` [m] of nodes in contact, wholly those of the others; see `plate_pass`."""
    for s in range(nodes.size):
        v = x[nodes[s], :2] - anchors[s]
        length = np.sqrt(v[0] ** 2 + v[1] ** 2)
        if side * (height - x[nodes[s], 2]) >= 0.0:
            anchors[s] += v
        elif length > slip:
            anchors[s] += v * (1.0 - slip / length)
