"""Forces of a piece of fabric in its plane: yarn segments joined at crossovers, and the trellis
between them.

A grid line of the fabric is a yarn, a node a crossover, an edge a segment of yarn, so that a piece
of any outline is a list of warp edges, a list of weft edges and a list of the quadrilaterals
between them. With Lambda_e the stretch of an edge, and <Lambda>_e the mean stretch of the edges of
the other family that meet its two ends,

    E = 1/2 sum_warp n_e W(Lambda_e, <Lambda>_e) + 1/2 sum_weft n_e W(<Lambda>_e, Lambda_e)
        + sum_edges that nothing crosses n_e U(Lambda_e) + sum_quads V integral tau dgamma

W is the tabulated potential of the crossover (see `cell`), U that of a yarn alone, n_e the
crossovers that an edge stands for, tau the trellis stress (eq. 4-35 as a total, odd function,
erratum E-11) and V the volume of the shell. A quadrilateral shears by gamma = pi / 2 - angle from a
to b, where a and b are the means of its two warp and its two weft edges. In the plane that angle is
known beyond a right angle of shear: yarns that pass one another are seen (gamma > pi / 2), and
nothing is singular there.

`forces` gives, beside the nodal forces, for each node a bound on the block row sum of the tangent
stiffness, sum_b |K_ab|. Taken as masses these make the largest eigenvalue of M^-1 K at most 1
(Gershgorin).
"""

import math

import numpy as np

from shellfabric.cell.crossover_kernels import yarn_alone
from shellfabric.cloth.trellis_kernels import trellis_law
from shellfabric.jit.compile import entry, kernel


@kernel()
def potential(l1, l2, table, x0, rx, top1, y0, ry, top2):
    """W and its slopes W1, W2, W11, W12, W22 with the stretches, from the biquadratic table.

    Below the table the yarn is slack and the lowest edge is exact; above it the tensions go on
    linearly.
    """
    p = max((l1 - x0) * rx, 0.0)
    q = max((l2 - y0) * ry, 0.0)
    i1 = min(int(p), top1)
    i2 = min(int(q), top2)
    p = p - i1
    q = q - i2
    c = table[i1 * (top2 + 1) + i2]
    a0 = c[0] + q * (c[1] + q * c[2])  # coefficients of 1, p, p^2
    a1 = c[3] + q * (c[4] + q * c[5])
    a2 = c[6] + q * (c[7] + q * c[8])
    b0 = c[1] + 2.0 * q * c[2]
    b1 = c[4] + 2.0 * q * c[5]
    b2 = c[7] + 2.0 * q * c[8]
    W = a0 + p * (a1 + p * a2)
    W1 = a1 + 2.0 * p * a2
    W2 = b0 + p * (b1 + p * b2)
    W11 = 2.0 * a2
    W12 = b1 + 2.0 * p * b2
    W22 = 2.0 * (c[2] + p * (c[5] + p * c[8]))
    return W, rx * W1, ry * W2, rx * rx * W11, rx * ry * W12, ry * ry * W22


@kernel()
def stretch_edges(x, edges, length, L, tx, ty):
    """Stretches L and directions (tx, ty) of the edges of one family, whose length at rest is
    `length`."""
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        dx = x[j, 0] - x[i, 0]
        dy = x[j, 1] - x[i, 1]
        d = math.sqrt(dx * dx + dy * dy)
        L[e] = d / length
        tx[e] = dx / d
        ty[e] = dy / d


@kernel()
def mean_crossing(L, across, e):
    """Mean stretch of the edges that cross edge e, and the share of each; share 0 where none
    does."""
    total = 0.0
    count = 0
    for c in range(4):
        if across[e, c] >= 0:
            total += L[across[e, c]]
            count += 1
    if count:
        return (total / count, 1.0 / count)
    return (1.0, 0.0)


@kernel()
def edge_forces(first, L, L_other, cells, across, lengths, table, grid, yarn, pulls, rows):
    """Add one family's part of dE/dLambda to its own edges and to those that cross them, and its
    parts of the bound.

    first : whether this family is the first argument of the table; yarn = (w, S0, EA). Returns the
        energy.
    lengths, pulls, rows : of this family and of the other: length at rest of an edge [m]; (e,)
        dE/dLambda and parts of the bound, added to
    """
    length, length_other = lengths
    pull, other = pulls
    row, row_other = rows
    x0, rx, top1, y0, ry, top2 = grid
    energy = 0.0
    for e in range(L.size):
        mean, share = mean_crossing(L_other, across, e)
        if share == 0.0:
            T, U = yarn_alone(L[e], yarn[0], yarn[1], yarn[2])
            k = 2.0 * yarn[0]
            energy += cells[e] * U
            pull[e] += cells[e] * k * T
            if T > 0.0:
                row[e] += cells[e] * 2.0 * k * k * yarn[2] / (yarn[1] * length)
            continue
        n = 0.5 * cells[e]
        if first:
            W, own, cross, kk, kc, cc = potential(L[e], mean, table, x0, rx, top1, y0, ry, top2)
        else:
            W, cross, own, cc, kc, kk = potential(mean, L[e], table, x0, rx, top1, y0, ry, top2)
        energy += n * W
        pull[e] += n * own
        row[e] += 2.0 * n * (abs(kk) / length + abs(kc) / length_other)
        for c in range(4):
            o = across[e, c]
            if o >= 0:
                other[o] += n * share * cross
                row_other[o] += 2.0 * n * share * (abs(kc) / length + abs(cc) / length_other)
    return energy


@kernel()
def scatter_edge_forces(edges, length, L, tx, ty, pull, row, f, bound):
    """Add the pulls of one family to its nodes, and its rows to their bounds."""
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        N = pull[e] / length
        f[i, 0] += N * tx[e]
        f[i, 1] += N * ty[e]
        f[j, 0] -= N * tx[e]
        f[j, 1] -= N * ty[e]
        k = (row[e] + 2.0 * abs(N) / L[e]) / length
        bound[i] += k
        bound[j] += k


@kernel()
def shear_angle(x, quad, dX, dY):
    """Shear angle [rad] of a quadrilateral, in (-pi/2, 3 pi/2], and its mean warp and weft
    vectors."""
    p = quad[0]
    q = quad[1]
    r = quad[2]
    s = quad[3]
    ax = 0.5 * (x[q, 0] - x[p, 0] + x[r, 0] - x[s, 0]) / dX
    ay = 0.5 * (x[q, 1] - x[p, 1] + x[r, 1] - x[s, 1]) / dX
    bx = 0.5 * (x[s, 0] - x[p, 0] + x[r, 0] - x[q, 0]) / dY
    by = 0.5 * (x[s, 1] - x[p, 1] + x[r, 1] - x[q, 1]) / dY
    gamma = 0.5 * math.pi - math.atan2(ax * by - ay * bx, ax * bx + ay * by)
    return gamma, ax, ay, bx, by


@kernel()
def trellis_forces(x, quads, dX, dY, V, G1, G2, gamma1, gamma2, f, bound):
    """Add the forces of the trellis to the nodes. Returns its energy."""
    energy = 0.0
    rise = (G2 - G1) / (gamma2 - gamma1)
    for k in range(quads.shape[0]):
        gamma, ax, ay, bx, by = shear_angle(x, quads[k], dX, dY)
        stress, U = trellis_law(gamma, G1, G2, gamma1, gamma2)
        tangent = G1 + rise * min(max(abs(gamma) - gamma1, 0.0), gamma2 - gamma1)
        energy += V * U
        aa = ax * ax + ay * ay
        bb = bx * bx + by * by
        # the angle of a vector grows along its normal: dgamma/da = (-ay, ax) / aa, dgamma/db = (by,
        # -bx) / bb
        px = -0.5 * ay / (aa * dX)
        py = 0.5 * ax / (aa * dX)
        qx = 0.5 * by / (bb * dY)
        qy = -0.5 * bx / (bb * dY)
        near = math.sqrt((px + qx) ** 2 + (py + qy) ** 2)
        far = math.sqrt((px - qx) ** 2 + (py - qy) ** 2)
        curved = V * abs(stress) * (1.0 / (aa * dX * dX) + 1.0 / (bb * dY * dY))
        for corner in range(4):
            if corner == 1 or corner == 2:
                sa = 1.0
            else:
                sa = -1.0
            if corner == 2 or corner == 3:
                sb = 1.0
            else:
                sb = -1.0
            node = quads[k, corner]
            f[node, 0] -= V * stress * (sa * px + sb * qx)
            f[node, 1] -= V * stress * (sa * py + sb * qy)
            if corner == 0 or corner == 2:
                own = near
            else:
                own = far
            bound[node] += 2.0 * V * tangent * own * (near + far) + curved
    return energy


@entry()
def forces(x, edges, cells, across, quads, spacing, table, grid, yarns, shear, work):
    """Forces f (n, 2) [N] on the nodes at x (n, 2), bounds (n,) [N/m] on their rows, energy of
    yarns and trellis [J].

    edges, cells, across, quads, spacing : see `coupon.model.Coupon`;  yarns : (w, S0, EA) of warp
        and weft
    table, grid : (cells, 9) [J] coefficients of the potential; where it begins, cells per stretch
        and last cell, of both stretches
    shear : V [m3], G1, G2 [Pa], gamma1, gamma2 [rad]
    work : (2, 5, edges) scratch: stretch, direction (2), pull and row of both families
    """
    warp, weft = edges
    dX, dY = spacing
    f = np.zeros_like(x)
    bound = np.zeros(x.shape[0])
    n1 = warp.shape[0]
    n2 = weft.shape[0]
    L1 = work[0, 0, :n1]
    tx1 = work[0, 1, :n1]
    ty1 = work[0, 2, :n1]
    pull1 = work[0, 3, :n1]
    row1 = work[0, 4, :n1]
    L2 = work[1, 0, :n2]
    tx2 = work[1, 1, :n2]
    ty2 = work[1, 2, :n2]
    pull2 = work[1, 3, :n2]
    row2 = work[1, 4, :n2]
    work[:, 3:] = 0.0
    stretch_edges(x, warp, dX, L1, tx1, ty1)
    stretch_edges(x, weft, dY, L2, tx2, ty2)
    stored = edge_forces(
        True,
        L1,
        L2,
        cells[0],
        across[0],
        (dX, dY),
        table,
        grid,
        yarns[0],
        (pull1, pull2),
        (row1, row2),
    )
    stored += edge_forces(
        False,
        L2,
        L1,
        cells[1],
        across[1],
        (dY, dX),
        table,
        grid,
        yarns[1],
        (pull2, pull1),
        (row2, row1),
    )
    scatter_edge_forces(warp, dX, L1, tx1, ty1, pull1, row1, f, bound)
    scatter_edge_forces(weft, dY, L2, tx2, ty2, pull2, row2, f, bound)
    V, G1, G2, gamma1, gamma2 = shear
    if V > 0.0:
        sheared = trellis_forces(x, quads, dX, dY, V, G1, G2, gamma1, gamma2, f, bound)
    else:
        sheared = 0.0
    return f, bound, stored, sheared


@entry()
def angles(x, quads, dX, dY):
    """(q,) [rad] shear angles of the quadrilaterals."""
    gamma = np.empty(quads.shape[0])
    for k in range(quads.shape[0]):
        gamma[k] = shear_angle(x, quads[k], dX, dY)[0]
    return gamma
