"""Tangent of the contact of one point as a sum of products of rows, left[r] x right[r], over the
nodes' components.

The equations, and their symbols, are those of `surface_contact_kernels`. The pressure's tangent
takes the rows

    dg x (-dp/dg A w dg - p A dw),  D_a x (p A w m^ab (B_b + k_bc dxi_c)),  B_a x (p A w dxi_a),

and the friction's the three components of the pull, and those of the change of the weights.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np

from fabrics.base.kernel_cache import kernel
from unitcell3d.contact.surface_kernels import dot

SLAVE, STENCIL = 4, 20  # nodes of a slave face, and with them those of the master's cell
TERMS = 10  # products of rows that make up the tangent of a point

# Of the point that is evaluated:
# surface : (6, 3) [m] S, S_,1, S_,2, S_,11, S_,12, S_,22
# normal : (3,) [-] n
# weights : (3, 16, 3) [-] S, S_,1, S_,2 as weights of the master's nodes
# spread : (20, 3) [-] x - S as weights of all nodes
# v, tau : (3,) [m] slip, [Pa] traction of the friction, zero without
# left, right : (10, 60) rows whose products are the tangent
Scratch = namedtuple("Scratch", "surface normal weights spread v tau left right")


@kernel()
def normal_terms(scratch, gap, p, slope, area, overlap):
    """Fill in the rows whose products are the tangent of the pressure; those of dxi stand in
    `right[3]`, `right[4]` over p A w.

    Parameters
    ----------
    gap, p, slope, area : [m], [Pa], [Pa/m], [m2] of the point
    overlap : (4,) [-] w of both directions, and their slopes

    Returns
    -------
    terms : how many rows of `left` and `right` are filled
    """
    surface = scratch.surface
    normal = scratch.normal
    weights = scratch.weights
    spread = scratch.spread
    left = scratch.left
    right = scratch.right
    w1, w2, dw1, dw2 = overlap
    s1 = surface[1]
    s2 = surface[2]
    m11 = dot(s1, s1)
    m12 = dot(s1, s2)
    m22 = dot(s2, s2)
    k11 = dot(normal, surface[3])
    k12 = dot(normal, surface[4])
    k22 = dot(normal, surface[5])
    h11 = m11 - gap * k11
    h12 = m12 - gap * k12
    h22 = m22 - gap * k22
    h = h11 * h22 - h12 * h12
    m_det = m11 * m22 - m12 * m12
    share = area * w1 * w2
    force = p * share
    for m in range(STENCIL):
        for c in range(3):
            at = 3 * m + c
            d1 = spread[m, c] * s1[c]
            d2 = spread[m, c] * s2[c]
            b1 = b2 = 0.0
            if m >= SLAVE:
                b1 = weights[1, m - SLAVE, c] * normal[c]
                b2 = weights[2, m - SLAVE, c] * normal[c]
            e1 = d1 + gap * b1
            e2 = d2 + gap * b2
            x1 = (h22 * e1 - h12 * e2) / h
            x2 = (h11 * e2 - h12 * e1) / h
            t1 = b1 + k11 * x1 + k12 * x2
            t2 = b2 + k12 * x1 + k22 * x2
            across = spread[m, c] * normal[c]
            left[0, at] = across
            left[1, at] = d1
            left[2, at] = d2
            left[3, at] = b1
            left[4, at] = b2
            right[0, at] = -slope * share * across - p * area * (dw1 * w2 * x1 + w1 * dw2 * x2)
            right[1, at] = force * (m22 * t1 - m12 * t2) / m_det
            right[2, at] = force * (m11 * t2 - m12 * t1) / m_det
            right[3, at] = force * x1
            right[4, at] = force * x2
    return 5


@kernel()
def friction_terms(scratch, p, slope, area, overlap, slid, law, length):
    """Fill in rows for the tangent of the friction, after those of `normal_terms`; return how many
    are filled.

    Parameters
    ----------
    p, slope, area, overlap : as for `normal_terms`
    slid : (2,) [-] xi - anchor
    length : [m] |v|
    """
    surface = scratch.surface
    normal = scratch.normal
    weights = scratch.weights
    spread = scratch.spread
    v = scratch.v
    tau = scratch.tau
    left = scratch.left
    right = scratch.right
    w1, w2, dw1, dw2 = overlap
    g1, g2 = slid
    friction = law.friction
    slip = law.slip
    share = area * w1 * w2
    stuck = length <= slip
    phi = 1.0 / max(length, slip)
    dv = np.empty(3)
    for m in range(STENCIL):
        for b in range(3):
            at = 3 * m + b
            x1 = right[3, at] / (p * share)
            x2 = right[4, at] / (p * share)
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
                left[8, at] = -weights[1, m - SLAVE, b] * tau[b]
                left[9, at] = -weights[2, m - SLAVE, b] * tau[b]
            right[8, at] = share * x1
            right[9, at] = share * x2
    return 10


@kernel(fastmath={"contract", "reassoc", "nsz"})
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
