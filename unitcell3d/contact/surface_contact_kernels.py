"""Contact of points of one structured surface with the C1 surface (`surface_kernels`) near another: force
-p(g) A w dg, tangent of large sliding (Wriggers, Computational Contact Mechanics, chapter 4), Coulomb
friction from where the point stuck when the last load step was accepted (docs/theory-cell.md, "The 3D
crossover: contact"). Each side of a crossover is slave once, with half the penalty.

With slave points x at the Gauss points of bilinear faces, x - S = g n, m_ab = S_,a . S_,b, k_ab = n . S_,ab,
H = m - g k, D_a = S_,a . (dx - dS) and B_a = n . dS_,a:

    S_,a . (x - S) = 0,   dg = n . (dx - dS),   dxi = H^-1 (D + g B)
    d(dg) = - D_a m^ab (B_b + k_bc dxi_c) - B_a dxi_a,   v = S_,a (xi_a - anchor_a),  tau = f p v / max(|v|, s)
"""

from __future__ import annotations

import numpy as np

from fabrics.base.kernel_cache import kernel
from unitcell3d.contact.surface_kernels import (
    cell_of,
    dot,
    evaluate,
    nodes_of,
    project,
    surround,
    weights_of,
)
from unitcell3d.contact.surface_tangent_kernels import (
    SLAVE,
    STENCIL,
    TERMS,
    Scratch,
    add_products,
    friction_terms,
    normal_terms,
)


@kernel()
def pressure(gap, penalty, toe):
    """Compute the contact pressure [Pa] and its slope dp/dg [Pa/m] at the gap `gap` [m] (negative:
    penetration)."""
    depth = -gap
    if depth <= 0.0:
        return 0.0, 0.0
    if depth < toe:
        return penalty * depth * depth / (2.0 * toe), -penalty * depth / toe
    return penalty * (depth - 0.5 * toe), -penalty


@kernel()
def overlap_weight(xi, cells, free_low, free_high):
    """Compute the share w of a slave point's area that lies over the master in one direction, and
    its slope; C1."""
    weight = 1.0
    slope = 0.0
    if free_high and xi > cells:
        t = min(2.0 * (xi - cells), 1.0)
        weight = 1.0 - t * t * (3.0 - 2.0 * t)
        slope = -12.0 * t * (1.0 - t)
    if free_low and xi < 0.0:
        t = min(-2.0 * xi, 1.0)
        weight = 1.0 - t * t * (3.0 - 2.0 * t)
        slope = 12.0 * t * (1.0 - t)
    return weight, slope


@kernel()
def point_of(x, nodes, shape, point):
    """Fill `point` : (3,) with the position of a slave point on its face."""
    for c in range(3):
        point[c] = 0.0
        for k in range(SLAVE):
            point[c] += shape[k] * x[nodes[k], c]


@kernel()
def traction(surface, xi, anchor, p, friction, slip, v, tau):
    """Fill the slip `v` and the friction's traction `tau` : (3,); returns |v|."""
    g1 = xi[0] - anchor[0]
    g2 = xi[1] - anchor[1]
    for c in range(3):
        v[c] = surface[1, c] * g1 + surface[2, c] * g2
    length = np.sqrt(dot(v, v))
    for c in range(3):
        tau[c] = friction * p * v[c] / max(length, slip)
    return length


@kernel()
def contact_pass(x, slave, master, law, state, forces, blocks, resultant):
    """Make one pass: forces of the slave points on the master surface, and their tangent if there
    are places for it.

    Parameters
    ----------
    x : (n, 3) [m] current positions
    slave, master, law : SlavePoints, Face, ContactLaw
    state : PassState; `xi`, `gaps` and `codes` are overwritten
    forces : (n, 3) [N] internal forces, added to
    blocks : Blocks, whose `values` are added to
    resultant : (3,) [N] sum of the contact forces on the slaves, added to
    """
    ni, nj = master.grid.shape
    xi = state.xi
    ringed = np.empty((ni + 2, nj + 2, 3))
    surround(x, master.grid, master.axes, master.mirror, ringed)
    point = np.empty(3)
    nodes = np.empty(STENCIL, np.int64)
    work = np.empty((4, 3, 4))
    scratch = Scratch(
        np.empty((6, 3)),
        np.empty(3),
        np.empty((3, 16, 3)),
        np.empty((STENCIL, 3)),
        np.empty(3),
        np.zeros(3),
        np.empty((TERMS, 3 * STENCIL)),
        np.empty((TERMS, 3 * STENCIL)),
    )
    surface = scratch.surface
    normal = scratch.normal
    block = np.empty((3 * STENCIL, 3 * STENCIL))
    for s in range(slave.areas.size):
        state.gaps[s] = np.inf
        state.codes[s] = -1
        face = s // slave.shapes.shape[0]
        shape = slave.shapes[s % slave.shapes.shape[0]]
        point_of(x, slave.quads[face], shape, point)
        if not project(point, ringed, xi[s], work[0], work[1], surface):
            continue
        normal[:] = master.side * np.cross(surface[1], surface[2])
        normal /= np.sqrt(dot(normal, normal))
        gap = dot(point - surface[0], normal)
        w1, dw1 = overlap_weight(xi[s, 0], ni - 1, not master.mirror[0], True)
        w2, dw2 = overlap_weight(xi[s, 1], nj - 1, not master.mirror[1], True)
        if w1 * w2 == 0.0:
            continue
        state.gaps[s] = gap
        p, slope = pressure(gap, law.penalty, law.toe)
        if p == 0.0:
            continue
        i = cell_of(xi[s, 0], ni - 1)
        j = cell_of(xi[s, 1], nj - 1)
        state.codes[s] = (face * (ni - 1) + i) * (nj - 1) + j
        nodes[:SLAVE] = slave.quads[face]
        nodes_of(master.grid, i, j, nodes[SLAVE:])
        weights_of(xi[s], master.grid, master.axes, master.mirror, scratch.weights, work)
        for k in range(SLAVE):
            scratch.spread[k] = shape[k]
        scratch.spread[SLAVE:] = -scratch.weights[0]
        area = slave.areas[s]
        overlap = (w1, w2, dw1, dw2)
        length = add_force(
            xi[s], state.anchors[s], p, area * w1 * w2, law, scratch, nodes, forces, resultant
        )
        if blocks.places.shape[0] == 0:
            continue
        terms = normal_terms(scratch, gap, p, slope, area, overlap)
        if law.friction > 0.0:
            slid = xi[s, 0] - state.anchors[s, 0], xi[s, 1] - state.anchors[s, 1]
            terms = friction_terms(scratch, p, slope, area, overlap, slid, law, length)
        row = blocks.row_of[state.codes[s]]
        add_products(scratch.left, scratch.right, terms, blocks.places[row], block, blocks.values)


@kernel()
def add_force(xi, anchor, p, share, law, scratch, nodes, forces, resultant):
    """Add the force of one point to `forces` and `resultant`; returns the length [m] of its slip.

    Parameters
    ----------
    xi, anchor : (2,) [-] closest point, and where the point stuck last
    p, share : [Pa], [m2] pressure, and the area that it acts on
    nodes : (20,) of the slave's face and of the master's cell
    """
    length = 0.0
    if law.friction > 0.0:
        length = traction(
            scratch.surface, xi, anchor, p, law.friction, law.slip, scratch.v, scratch.tau
        )
    for c in range(3):
        push = p * scratch.normal[c] - scratch.tau[c]
        resultant[c] += share * push
        for m in range(STENCIL):
            forces[nodes[m], c] -= share * push * scratch.spread[m, c]
    return length


@kernel()
def update_anchors(x, master, slip, state):
    """Let the anchors follow: to within `slip` [m] of points in contact, to the closest point of
    the others.

    Parameters
    ----------
    x : (n, 3) [m] positions of the state that has been accepted
    master : Face
    state : PassState; `anchors` are overwritten
    """
    ni, nj = master.grid.shape
    xi = state.xi
    anchors = state.anchors
    ringed = np.empty((ni + 2, nj + 2, 3))
    work = np.empty((2, 3, 4))
    surround(x, master.grid, master.axes, master.mirror, ringed)
    surface = np.empty((6, 3))
    v = np.empty(3)
    tau = np.empty(3)
    for s in range(state.codes.size):
        if state.codes[s] < 0:
            anchors[s] = xi[s]
            continue
        evaluate(ringed, xi[s], work[0], work[1], surface)
        length = traction(surface, xi[s], anchors[s], 0.0, 0.0, slip, v, tau)
        if length > slip:
            anchors[s] = xi[s] - (xi[s] - anchors[s]) * slip / length
