"""Contact of the nodes of one structured surface with the C1 surface through the nodes of another, and with plates.

The master surface is the bicubic Catmull-Rom interpolant of its grid of nodes: C1, through every node. Beyond the
edge of the grid a phantom row closes the stencil, the mirror image on a symmetry plane and the straight continuation
elsewhere; both fold back into weights of real nodes, w(i, j, component).

For a slave point x with closest point S(xi), x - S = g n (n: unit normal towards the slave side):

    S_,a . (x - S) = 0,   m_ab = S_,a . S_,b,   k_ab = n . S_,ab,   H_ab = m_ab - g k_ab
    dg = n . (dx - dS)
    D_a = S_,a . (dx - dS),   B_a = n . dS_,a,   dxi = H^-1 (D + g B)
    d(dg) = - D_a m^ab (B_b + k_bc dxi_c) - B_a dxi_a

The contact force is -p(g) A w(xi) dg with the tributary area A and the pressure (penalty k, C1 toe of depth t)

    p = 0 (g >= 0),  k g^2 / 2t (0 < -g < t),  k (-g - t/2) (-g > t).

w is 1 on the master grid and falls to 0 within half a cell beyond a free edge (C1): the slave points that slide off are
those of the yarn's end, whose tributary area reaches half a cell back over the master. The equations are those of the
closest-point projection with a large-sliding tangent (e.g. Wriggers, Computational Contact Mechanics, chapter 4); each
side of a crossover is slave once, with half the penalty.
"""

from __future__ import annotations

import numpy as np
from numba import njit

PROJECTION_STEPS = 30


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
def spline_weights(xi, cells, mirror_low, even, odd):
    """Catmull-Rom weights of the four nodes first .. first + 3 (clipped to the grid) and their two derivatives.

    Parameters
    ----------
    xi : parameter, 0 .. cells
    cells : cells along this direction
    mirror_low : the row 0 lies on a symmetry plane
    even, odd : (3, 4) filled: weights of components that keep or change sign in the mirror

    Returns
    -------
    first : number of the first node of the stencil, may be -1
    """
    cell = min(max(int(np.floor(xi)), 0), cells - 1)
    t = xi - cell
    even[0, 0] = 0.5 * (-t + 2 * t * t - t**3)
    even[0, 1] = 0.5 * (2 - 5 * t * t + 3 * t**3)
    even[0, 2] = 0.5 * (t + 4 * t * t - 3 * t**3)
    even[0, 3] = 0.5 * (-t * t + t**3)
    even[1, 0] = 0.5 * (-1 + 4 * t - 3 * t * t)
    even[1, 1] = 0.5 * (-10 * t + 9 * t * t)
    even[1, 2] = 0.5 * (1 + 8 * t - 9 * t * t)
    even[1, 3] = 0.5 * (-2 * t + 3 * t * t)
    even[2, 0] = 0.5 * (4 - 6 * t)
    even[2, 1] = 0.5 * (-10 + 18 * t)
    even[2, 2] = 0.5 * (8 - 18 * t)
    even[2, 3] = 0.5 * (-2 + 6 * t)
    odd[:] = even
    for order in range(3):
        if cell == 0:
            phantom = even[order, 0]
            even[order, 0] = 0.0
            odd[order, 0] = 0.0
            if mirror_low:
                even[order, 2] += phantom
                odd[order, 2] -= phantom
            else:
                even[order, 1] += 2 * phantom
                even[order, 2] -= phantom
                odd[order, 1] += 2 * phantom
                odd[order, 2] -= phantom
        if cell == cells - 1:
            for weights in (even, odd):
                phantom = weights[order, 3]
                weights[order, 3] = 0.0
                weights[order, 2] += 2 * phantom
                weights[order, 1] -= phantom
    return cell - 1


@njit(cache=True)
def surface_stencil(xi, grid, axes, mirror, nodes, weights, work):
    """Stencil of the master surface at xi.

    Parameters
    ----------
    xi : (2,) parameters along i and j
    grid : (ni, nj) node numbers
    axes : (2,) component (0 x, 1 y) that changes sign in the mirror of i = 0 and of j = 0
    mirror : (2,) whether i = 0 and j = 0 are symmetry planes
    nodes : (16,) filled
    weights : (6, 16, 3) filled: S, S_,1, S_,2, S_,11, S_,12, S_,22 as weights of each node and component
    work : (4, 3, 4) scratch
    """
    ni, nj = grid.shape
    i0 = spline_weights(xi[0], ni - 1, mirror[0], work[0], work[1])
    j0 = spline_weights(xi[1], nj - 1, mirror[1], work[2], work[3])
    orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    for a in range(4):
        i = min(max(i0 + a, 0), ni - 1)
        for b in range(4):
            j = min(max(j0 + b, 0), nj - 1)
            nodes[4 * a + b] = grid[i, j]
            for c in range(3):
                along = work[1] if c == axes[0] else work[0]
                across = work[3] if c == axes[1] else work[2]
                for k in range(6):
                    oi, oj = orders[k]
                    weights[k, 4 * a + b, c] = along[oi, a] * across[oj, b]


@njit(cache=True)
def evaluate(x, nodes, weights, surface):
    """Fill `surface` : (6, 3) with S and its derivatives from the stencil."""
    for k in range(6):
        for c in range(3):
            total = 0.0
            for m in range(16):
                total += weights[k, m, c] * x[nodes[m], c]
            surface[k, c] = total


@njit(cache=True)
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def project(point, x, grid, axes, mirror, xi, nodes, weights, surface, work):
    """Closest point of the master surface by Newton's method from the guess `xi`, which is overwritten.

    Returns
    -------
    found : False where the iteration does not settle or leaves the grid by more than a cell
    """
    ni, nj = grid.shape
    for _ in range(PROJECTION_STEPS):
        surface_stencil(xi, grid, axes, mirror, nodes, weights, work)
        evaluate(x, nodes, weights, surface)
        away = point - surface[0]
        s1, s2 = surface[1], surface[2]
        r1, r2 = dot(away, s1), dot(away, s2)
        m11, m12, m22 = dot(s1, s1), dot(s1, s2), dot(s2, s2)
        h11, h12, h22 = m11 - dot(away, surface[3]), m12 - dot(away, surface[4]), m22 - dot(away, surface[5])
        determinant = h11 * h22 - h12 * h12
        if not (h11 > 0.0 and determinant > 0.0):  # not convex here: Gauss-Newton instead
            h11, h12, h22 = m11, m12, m22
            determinant = h11 * h22 - h12 * h12
        if not determinant > 0.0:
            return False
        d1 = (h22 * r1 - h12 * r2) / determinant
        d2 = (h11 * r2 - h12 * r1) / determinant
        largest = max(abs(d1), abs(d2))
        if largest > 1.0:
            d1, d2 = d1 / largest, d2 / largest
        xi[0] = min(max(xi[0] + d1, -1.5), ni + 0.5)
        xi[1] = min(max(xi[1] + d2, -1.5), nj + 0.5)
        if largest < 1e-13:
            break
    else:
        if not largest < 1e-9:
            return False
    return -1.0 < xi[0] < ni and -1.0 < xi[1] < nj


@njit(cache=True)
def contact_pass(
    x, slaves, areas, grid, axes, mirror, side, penalty, toe, xi, gaps, stencils, forces, places, values, resultant
):
    """One pass: forces of the slave points on the master surface, and their tangent where `places` is given.

    Parameters
    ----------
    x : (n, 3) [m] current positions
    slaves, areas : (s,) node numbers and tributary areas [m2] of the undeformed surface
    grid, axes, mirror : the master, as for `surface_stencil`
    side : +1 where the normal S_,1 x S_,2 points to the slave, else -1
    penalty, toe : [Pa/m], [m]
    xi : (s, 2) guess of the closest points; overwritten by them
    gaps : (s,) [m] filled; infinite where the slave has no partner
    stencils : (s, 17) filled: the slave node, then the 16 nodes it acts on; -1 where there is no contact
    forces : (n, 3) [N] internal forces, added to
    places : (s, 17, 17) block of `values` of each pair of the stencil; empty for forces alone
    values : (k, 3, 3) [N/m] blocks, added to
    resultant : (3,) [N] sum of the contact forces on the slaves, added to

    Returns
    -------
    energy : [J] of penetration where w = 1 (a measure; the edges' share is not conservative)
    """
    nodes = np.empty(17, np.int64)
    weights, surface, work = np.empty((6, 16, 3)), np.empty((6, 3)), np.empty((4, 3, 4))
    D, B, N = np.empty((2, 17, 3)), np.empty((2, 17, 3)), np.empty((17, 3))
    slide, turn = np.empty((2, 17, 3)), np.empty((2, 17, 3))
    energy = 0.0
    for s in range(slaves.size):
        gaps[s] = np.inf
        stencils[s, 0] = -1
        point = x[slaves[s]]
        if not project(point, x, grid, axes, mirror, xi[s], nodes[1:], weights, surface, work):
            continue
        s1, s2 = surface[1], surface[2]
        normal = side * np.cross(s1, s2)
        normal /= np.sqrt(dot(normal, normal))
        gap = dot(point - surface[0], normal)
        w1, dw1 = overlap_weight(xi[s, 0], grid.shape[0] - 1, not mirror[0], True)
        w2, dw2 = overlap_weight(xi[s, 1], grid.shape[1] - 1, not mirror[1], True)
        gaps[s] = gap
        p, slope = pressure(gap, penalty, toe)
        if p == 0.0 or w1 * w2 == 0.0:
            continue
        nodes[0] = slaves[s]
        stencils[s] = nodes
        area = areas[s]
        force = p * area * w1 * w2
        for c in range(3):
            N[0, c] = normal[c]
            resultant[c] += force * normal[c]
            for m in range(16):
                N[m + 1, c] = -weights[0, m, c] * normal[c]
        for m in range(17):
            for c in range(3):
                forces[nodes[m], c] -= force * N[m, c]
        energy += 0.5 * force * -gap
        if places.shape[0] == 0:
            continue

        # the slip dxi of the closest point, and the turn of the normal, as rows over the 51 unknowns of the stencil
        for a in range(2):
            for c in range(3):
                D[a, 0, c] = surface[1 + a, c]
                B[a, 0, c] = 0.0
                for m in range(16):
                    D[a, m + 1, c] = -weights[0, m, c] * surface[1 + a, c]
                    B[a, m + 1, c] = weights[1 + a, m, c] * normal[c]
        m11, m12, m22 = dot(s1, s1), dot(s1, s2), dot(s2, s2)
        k11, k12, k22 = dot(normal, surface[3]), dot(normal, surface[4]), dot(normal, surface[5])
        h11, h12, h22 = m11 - gap * k11, m12 - gap * k12, m22 - gap * k22
        h, m_det = h11 * h22 - h12 * h12, m11 * m22 - m12 * m12
        for m in range(17):
            for c in range(3):
                e1, e2 = D[0, m, c] + gap * B[0, m, c], D[1, m, c] + gap * B[1, m, c]
                x1, x2 = (h22 * e1 - h12 * e2) / h, (h11 * e2 - h12 * e1) / h
                t1, t2 = B[0, m, c] + k11 * x1 + k12 * x2, B[1, m, c] + k12 * x1 + k22 * x2
                slide[0, m, c], slide[1, m, c] = x1, x2
                turn[0, m, c], turn[1, m, c] = (m22 * t1 - m12 * t2) / m_det, (m11 * t2 - m12 * t1) / m_det
        stiff = -slope * area * w1 * w2
        for m in range(17):
            for n in range(17):
                place = places[s, m, n]
                for a in range(3):
                    for b in range(3):
                        curve = -(
                            D[0, m, a] * turn[0, n, b]
                            + D[1, m, a] * turn[1, n, b]
                            + B[0, m, a] * slide[0, n, b]
                            + B[1, m, a] * slide[1, n, b]
                        )
                        leave = dw1 * w2 * slide[0, n, b] + w1 * dw2 * slide[1, n, b]
                        values[place, a, b] += stiff * N[m, a] * N[n, b] - force * curve - p * area * N[m, a] * leave
    return energy


@njit(cache=True)
def plate_pass(x, nodes, areas, height, side, penalty, toe, forces, places, values):
    """Forces of the nodes of a surface on a rigid plate z = height, and their tangent where `places` is given.

    Parameters
    ----------
    nodes, areas : (s,) node numbers, tributary areas [m2]
    height : [m]
    side : +1 for a plate above the nodes, -1 below
    places : (s,) diagonal block of each node; empty for forces alone

    Returns
    -------
    force : [N] on the plate, positive in compression
    """
    total = 0.0
    for s in range(nodes.size):
        p, slope = pressure(side * (height - x[nodes[s], 2]), penalty, toe)
        forces[nodes[s], 2] += side * p * areas[s]
        total += p * areas[s]
        if places.shape[0] > 0:
            values[places[s], 2, 2] -= slope * areas[s]
    return total
