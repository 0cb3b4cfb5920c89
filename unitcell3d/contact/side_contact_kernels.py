"""Contact of two edges that run side by side: points of one on the curve of the other, the normal in the
plane. What meets is the flank: the mean place of the nodes from the yarn's middle to its tip, with the
distance that it has from the tip at rest. The master is the C1 Catmull-Rom curve E(t) through those
places, the slave point c the mean of those of an element; r = E - c without its vertical part:

    r . b = 0,   b = E',   r = (g + o) n,   n . toward > 0,   o: the two distances of the tips

The force is that of the potential A P(g), P' = -p of `surface_contact_kernels`. With the rows R
(variation of r at fixed t) and B (that of b), m = b . b, k = n . E'',

    g_q = n . R,  t_q = -(b . R + (g + o) n . B) / (m + (g + o) k),  g_qq = n . B t_q - (b . R)(n . B + k t_q) / m
"""

from __future__ import annotations

import numpy as np

from fabrics.base.kernel_cache import kernel
from unitcell3d.contact.edge_contact_kernels import spline_weights
from unitcell3d.contact.surface_contact_kernels import pressure

STEPS = 40


@kernel()
def side_pass(
    x,
    slaves,
    master,
    toward,
    areas,
    offset,
    penalty,
    toe,
    guess,
    gaps,
    pressed,
    stencils,
    forces,
    places,
    values,
):
    """Add the contact of points of one edge with another: forces, and the tangent if `places` is given.

    Parameters
    ----------
    x : (n, 3) [m] current positions
    slaves : (s, 2 k) nodes whose mean is a point
    master : (m, k) nodes whose mean is a point of the curve
    toward : (3,) a direction in the plane from the slave to the master
    areas : (s,) [m2]
    offset : [m] o
    penalty, toe : [Pa/m], [m]
    guess : (s,) parameters of the closest points, overwritten
    gaps, pressed : (s,) filled: [m] infinite without a closest point, [N]
    stencils : (s, 6 k) filled: nodes that act on each other; -1 where there is no contact
    forces : (n, 3) [N] internal forces, added to
    places : (s, 6 k, 6 k) blocks of `values`; empty for forces alone
    values : (k, 3, 3) [N/m] blocks, added to

    Returns
    -------
    force : [N] the sum over the points
    """
    cells = master.shape[0] - 1
    weights = np.empty((3, 4))
    found = np.empty((3, 3))
    K = master.shape[1]
    own = 2 * K
    size_ = 6 * K
    share = np.empty(size_)
    turn = np.empty(size_)
    total = 0.0
    for s in range(areas.size):
        stencils[s, 0] = -1
        gaps[s] = np.inf
        pressed[s] = 0.0
        cx = 0.0
        cy = 0.0
        for m in range(own):
            cx += x[slaves[s, m], 0] / own
            cy += x[slaves[s, m], 1] / own
        t = guess[s]
        first = 0
        settled = False
        for _ in range(STEPS):
            first = spline_weights(t, cells, weights)
            for order in range(3):
                for c in range(3):
                    found[order, c] = 0.0
                    for a in range(4):
                        i = min(max(first + a, 0), cells)
                        mid = 0.0
                        for m in range(K):
                            mid += x[master[i, m], c] / K
                        found[order, c] += weights[order, a] * mid
            rx = found[0, 0] - cx
            ry = found[0, 1] - cy
            along = rx * found[1, 0] + ry * found[1, 1]
            slope = found[1, 0] ** 2 + found[1, 1] ** 2
            full = slope + rx * found[2, 0] + ry * found[2, 1]
            step = -along / (full if full > 0.0 else slope)
            if abs(step) < 1e-12:
                settled = True
                break
            step = min(max(step, -0.5), 0.5)
            t = min(max(t + step, 0.0), float(cells))
        if not (settled and 0.0 < t < cells):
            continue
        guess[s] = t
        bx = found[1, 0]
        by = found[1, 1]
        size = np.sqrt(bx * bx + by * by)
        nx = -by / size
        ny = bx / size
        if nx * toward[0] + ny * toward[1] < 0.0:
            nx = -nx
            ny = -ny
        reach = nx * rx + ny * ry
        gap = reach - offset
        gaps[s] = gap
        p, p_slope = pressure(gap, penalty, toe)
        if p == 0.0:
            continue
        area = areas[s]
        pressed[s] = p * area
        total += p * area
        for m in range(own):
            stencils[s, m] = slaves[s, m]
            share[m] = -1.0 / own
            turn[m] = 0.0
        for a in range(4):
            i = min(max(first + a, 0), cells)
            for k in range(K):
                m = own + K * a + k
                stencils[s, m] = master[i, k]
                share[m] = weights[0, a] / K
                turn[m] = weights[1, a] / K
        for m in range(size_):
            forces[stencils[s, m], 0] -= p * area * share[m] * nx
            forces[stencils[s, m], 1] -= p * area * share[m] * ny
        if places.shape[0] == 0:
            continue
        mm = bx * bx + by * by
        bend = nx * found[2, 0] + ny * found[2, 1]
        for m in range(size_):
            for n in range(size_):
                place = places[s, m, n]
                for c in range(2):
                    nc = nx if c == 0 else ny
                    bc = bx if c == 0 else by
                    for d in range(2):
                        nd = nx if d == 0 else ny
                        bd = bx if d == 0 else by
                        td = -(bd * share[n] + reach * nd * turn[n]) / (mm + reach * bend)
                        curved = nc * turn[m] * td - bc * share[m] * (nd * turn[n] + bend * td) / mm
                        values[place, c, d] += area * (
                            -p_slope * share[m] * share[n] * nc * nd - p * curved
                        )
    return total
