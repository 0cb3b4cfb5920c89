"""Forces of a piece of fabric in its plane: yarn segments joined at crossovers, and the trellis between
them. A node is a crossover, an edge a segment of yarn, so that a piece of any outline is a list of
warp edges, one of weft edges and one of the quadrilaterals between them. The energy is that of the
membrane (docs/theory-panel.md, eq. (1)), and U(Lambda) of a lone yarn on edges that nothing crosses.

`forces` gives, beside the nodal forces, a bound on the block row sum sum_b |K_ab| of each node. Taken
as masses these make the largest eigenvalue of M^-1 K at most 1 (Gershgorin).
"""

import math

import numpy as np

from shellfabric.cell.yarn_kernels import yarn_alone
from shellfabric.jit.compile import entry, kernel
from shellfabric.membrane.trellis_kernels import trellis_law

WARP = 0
WEFT = 1


@kernel()
def potential(l1, l2, table, x0, rx, top1, y0, ry, top2):
    """Compute W and its slopes W1, W2, W11, W12, W22 with the stretches, from the biquadratic
    table.

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


@kernel(_nrt=False)
def stretch_segments(x, coupon, family):
    """Compute stretches and directions of the segments of one family, with the nodes at x."""
    nodes = coupon.nodes[family]
    direction = coupon.direction[family]
    for e in range(nodes.shape[0]):
        i = nodes[e, 0]
        j = nodes[e, 1]
        dx = x[j, 0] - x[i, 0]
        dy = x[j, 1] - x[i, 1]
        d = math.sqrt(dx * dx + dy * dy)
        coupon.stretch[family][e] = d / coupon.length[family]
        direction[e, 0] = dx / d
        direction[e, 1] = dy / d


@kernel(_nrt=False)
def mean_crossing(coupon, family, e):
    """Average the stretch of the segments that cross segment e, and return the share of each; share
    0 if none does."""
    across = coupon.across[family]
    total = 0.0
    count = 0
    for c in range(4):
        if across[e, c] >= 0:
            total += coupon.stretch[1 - family][across[e, c]]
            count += 1
    if count:
        return total / count, 1.0 / count
    return 1.0, 0.0


@kernel(_nrt=False)
def cell_of(coupon, family, own, mean):
    """Compute W of the cell of a segment, and its slopes: own, crossing, own own, own crossing,
    crossing crossing."""
    x0, rx, top1, y0, ry, top2 = coupon.grid
    last1 = int(top1)
    last2 = int(top2)
    table = coupon.potential
    if family == WARP:
        return potential(own, mean, table, x0, rx, last1, y0, ry, last2)
    W, cross, along, cc, kc, kk = potential(mean, own, table, x0, rx, last1, y0, ry, last2)
    return W, along, cross, kk, kc, cc


@kernel(_nrt=False)
def segment_forces(coupon, family):
    """Add one family's part of dE/dLambda to its own segments and to those that cross them, and its
    parts of the bound. Returns its energy."""
    length = coupon.length[family]
    length_other = coupon.length[1 - family]
    across = coupon.across[family]
    pull = coupon.pull[family]
    row = coupon.row[family]
    energy = 0.0
    for e in range(pull.size):
        own = coupon.stretch[family][e]
        mean, share = mean_crossing(coupon, family, e)
        if share == 0.0:
            energy += lone_segment(coupon, family, e)
            continue
        n = 0.5 * coupon.cells[family][e]
        W, along, cross, kk, kc, cc = cell_of(coupon, family, own, mean)
        energy += n * W
        pull[e] += n * along
        row[e] += 2.0 * n * (abs(kk) / length + abs(kc) / length_other)
        for c in range(4):
            o = across[e, c]
            if o >= 0:
                bound = abs(kc) / length + abs(cc) / length_other
                coupon.pull[1 - family][o] += n * share * cross
                coupon.row[1 - family][o] += 2.0 * n * share * bound
    return energy


@kernel(_nrt=False)
def lone_segment(coupon, family, e):
    """Compute the energy of a segment that nothing crosses; add its dE/dLambda and its part of the
    bound."""
    w = coupon.half_width[family]
    S0 = coupon.yarn_length[family]
    EA = coupon.stiffness[family]
    T, U = yarn_alone(coupon.stretch[family][e], w, S0, EA)
    n = coupon.cells[family][e]
    k = 2.0 * w
    coupon.pull[family][e] += n * k * T
    if T > 0.0:
        coupon.row[family][e] += n * 2.0 * k * k * EA / (S0 * coupon.length[family])
    return n * U


@kernel(_nrt=False)
def scatter_pulls(coupon, family, f, bound):
    """Add the pulls of one family to its nodes, and its rows to their bounds."""
    nodes = coupon.nodes[family]
    direction = coupon.direction[family]
    length = coupon.length[family]
    for e in range(nodes.shape[0]):
        N = coupon.pull[family][e] / length
        k = (coupon.row[family][e] + 2.0 * abs(N) / coupon.stretch[family][e]) / length
        i = nodes[e, 0]
        j = nodes[e, 1]
        for c in range(2):
            f[i, c] += N * direction[e, c]
            f[j, c] -= N * direction[e, c]
        bound[i] += k
        bound[j] += k


@kernel()
def shear_angle(x, quad, dX, dY):
    """Shear angle [rad] of a quadrilateral, in (-pi/2, 3 pi/2], and its mean warp and weft
    vectors.

    It is pi / 2 less the angle from the mean of the warp edges to that of the weft edges. In the
    plane that angle is known beyond a right angle of shear: yarns that pass one another are seen,
    and nothing is singular there.
    """
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


@kernel(_nrt=False)
def trellis_forces(x, coupon, f, bound):
    """Add the forces of the trellis to the nodes. Returns its energy."""
    dX, dY = coupon.length
    V = coupon.volume
    G1 = coupon.G1
    gamma1 = coupon.gamma1
    span = coupon.gamma2 - gamma1
    rise = (coupon.G2 - G1) / span
    energy = 0.0
    for k in range(coupon.quads.shape[0]):
        gamma, ax, ay, bx, by = shear_angle(x, coupon.quads[k], dX, dY)
        stress, U = trellis_law(gamma, G1, coupon.G2, gamma1, coupon.gamma2)
        tangent = G1 + rise * min(max(abs(gamma) - gamma1, 0.0), span)
        energy += V * U
        aa = ax * ax + ay * ay
        bb = bx * bx + by * by
        # the angle of a vector grows along its normal:
        # dgamma/da = (-ay, ax) / aa, dgamma/db = (by, -bx) / bb
        px = -0.5 * ay / (aa * dX)
        py = 0.5 * ax / (aa * dX)
        qx = 0.5 * by / (bb * dY)
        qy = -0.5 * bx / (bb * dY)
        near = math.sqrt((px + qx) ** 2 + (py + qy) ** 2)
        far = math.sqrt((px - qx) ** 2 + (py - qy) ** 2)
        curved = V * abs(stress) * (1.0 / (aa * dX * dX) + 1.0 / (bb * dY * dY))
        for corner in range(4):
            # corners 1 and 2 are at the far end of the warp, 2 and 3 of the weft
            sa = -1.0
            sb = -1.0
            own = far
            if corner == 1 or corner == 2:
                sa = 1.0
            if corner >= 2:
                sb = 1.0
            if sa == sb:
                own = near
            node = coupon.quads[k, corner]
            f[node, 0] -= V * stress * (sa * px + sb * qx)
            f[node, 1] -= V * stress * (sa * py + sb * qy)
            bound[node] += 2.0 * V * tangent * own * (near + far) + curved
    return energy


@entry()
def forces(x, coupon):
    """Compute forces f (n, 2) [N] on the nodes at x (n, 2), bounds (n,) [N/m] on their rows, energy
    of yarns and trellis [J]; coupon : Segments."""
    f = np.zeros_like(x)
    bound = np.zeros(x.shape[0])
    for family in range(2):
        coupon.pull[family][:] = 0.0
        coupon.row[family][:] = 0.0
        stretch_segments(x, coupon, family)
    stored = segment_forces(coupon, WARP)
    stored += segment_forces(coupon, WEFT)
    scatter_pulls(coupon, WARP, f, bound)
    scatter_pulls(coupon, WEFT, f, bound)
    sheared = 0.0
    if coupon.volume > 0.0:
        sheared = trellis_forces(x, coupon, f, bound)
    return f, bound, stored, sheared


@entry()
def angles(x, quads, dX, dY):
    """Compute the shear angles (q,) [rad] of the quadrilaterals."""
    gamma = np.empty(quads.shape[0])
    for k in range(quads.shape[0]):
        gamma[k] = shear_angle(x, quads[k], dX, dY)[0]
    return gamma
