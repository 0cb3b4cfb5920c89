"""Frictionless contact of the two yarns at each crossing of a weave, in explicit dynamics.

The nodes of each face are held off the other yarn's face, which is the C1 bicubic (Catmull-Rom) surface S(xi) through
its nodes, one pass each way with half the penalty: nothing steps from facet to facet. For a node x with foot S(xi) and
unit normal n towards the node's side,

    g = n . (x - S),    p = k [0; g^2 / 2t; -g - t/2]  for  [g >= 0; 0 < -g < t; -g > t],    U = sum A w int p dg

plus c (-dg/dt) in touch, never less than nothing together. w is 1 over the face and falls to 0 within half a brick
beyond its sides. What the node gets its foot's 16 nodes give, with the weights of S: no momentum is made.

Yarns are woven, so who meets whom is known: a node keeps its foot, which is followed by one Newton step in a time step
(one step lags by the slip in that step, less than a hundredth of a brick; the normal force feels that to second
order). A node whose face is clear of the other rests for as many steps as no motion can close the gap.

Crossings are worked on in four colours, alternate along warp and weft, of which no two touch the same node: threads
change no bit of the result.
"""

import math

import numpy as np
from numba import prange

from shellfabric.jit.compile import entry, kernel

MAX_STEPS_SKIPPED = 60  # the longest rest


@kernel(fastmath={"contract"})
def spline(t, cell, cells, w, dw):
    """Catmull-Rom weights of the nodes cell - 1 .. cell + 2 at cell + t, and their slopes; filled.

    Beyond the ends of the grid the surface goes straight on: a phantom node is twice the last less the one before.
    """
    w[0], dw[0] = 0.5 * t * (-1.0 + t * (2.0 - t)), 0.5 * (-1.0 + t * (4.0 - 3.0 * t))
    w[1], dw[1] = 1.0 + 0.5 * t * t * (-5.0 + 3.0 * t), 0.5 * t * (-10.0 + 9.0 * t)
    w[2], dw[2] = 0.5 * t * (1.0 + t * (4.0 - 3.0 * t)), 0.5 * (1.0 + t * (8.0 - 9.0 * t))
    w[3], dw[3] = 0.5 * t * t * (-1.0 + t), 0.5 * t * (-2.0 + 3.0 * t)
    if cell == 0:
        w[1] += 2.0 * w[0]
        w[2] -= w[0]
        dw[1] += 2.0 * dw[0]
        dw[2] -= dw[0]
        w[0] = dw[0] = 0.0
    if cell == cells - 1:
        w[2] += 2.0 * w[3]
        w[1] -= w[3]
        dw[2] += 2.0 * dw[3]
        dw[1] -= dw[3]
        w[3] = dw[3] = 0.0


@kernel(fastmath={"contract"})
def surface_point(x, first, nx, ny, nz, face, xi0, xi1, nodes, weights, S):
    """The surface of the face `face` (0 or nz) of a yarn at (xi0, xi1).

    Parameters
    ----------
    nodes, weights : (16,) filled
    S : (3, 3) filled: S, S_,1, S_,2
    """
    w, dw, u, du = np.empty(4), np.empty(4), np.empty(4), np.empty(4)
    i = min(max(math.floor(xi0), 0), nx - 1)
    j = min(max(math.floor(xi1), 0), ny - 1)
    spline(xi0 - i, i, nx, w, dw)
    spline(xi1 - j, j, ny, u, du)
    for c in range(3):
        S[0, c] = S[1, c] = S[2, c] = 0.0
    for a in range(4):
        row = first + min(max(i + a - 1, 0), nx) * (ny + 1) * (nz + 1) + face
        s0 = s1 = s2 = d0 = d1 = d2 = 0.0
        for b in range(4):
            n = row + min(max(j + b - 1, 0), ny) * (nz + 1)
            nodes[4 * a + b] = n
            weights[4 * a + b] = w[a] * u[b]
            s0 += u[b] * x[n, 0]
            s1 += u[b] * x[n, 1]
            s2 += u[b] * x[n, 2]
            d0 += du[b] * x[n, 0]
            d1 += du[b] * x[n, 1]
            d2 += du[b] * x[n, 2]
        S[0, 0] += w[a] * s0
        S[0, 1] += w[a] * s1
        S[0, 2] += w[a] * s2
        S[1, 0] += dw[a] * s0
        S[1, 1] += dw[a] * s1
        S[1, 2] += dw[a] * s2
        S[2, 0] += w[a] * d0
        S[2, 1] += w[a] * d1
        S[2, 2] += w[a] * d2


@kernel(fastmath={"contract"})
def closest_point_step(away, S):
    """Newton step (Gauss-Newton, in xi) towards the foot of the point that lies `away` from S, at most half a brick."""
    r1 = away[0] * S[1, 0] + away[1] * S[1, 1] + away[2] * S[1, 2]
    r2 = away[0] * S[2, 0] + away[1] * S[2, 1] + away[2] * S[2, 2]
    m11 = S[1, 0] ** 2 + S[1, 1] ** 2 + S[1, 2] ** 2
    m12 = S[1, 0] * S[2, 0] + S[1, 1] * S[2, 1] + S[1, 2] * S[2, 2]
    m22 = S[2, 0] ** 2 + S[2, 1] ** 2 + S[2, 2] ** 2
    det = m11 * m22 - m12 * m12
    return (
        min(max((m22 * r1 - m12 * r2) / det, -0.5), 0.5),
        min(max((m11 * r2 - m12 * r1) / det, -0.5), 0.5),
        math.sqrt(m22),
    )


@kernel(fastmath={"contract"})
def side_weight(xi, cells):
    """Share w of a node's area that lies over the face, and how far it is beyond where that share ends [bricks]."""
    beyond = max(-xi, xi - cells)
    if beyond <= 0.0:
        return 1.0, 0.0
    if beyond >= 0.5:
        return 0.0, beyond - 0.5
    t = 2.0 * beyond
    return 1.0 - t * t * (3.0 - 2.0 * t), 0.0


@kernel(fastmath={"contract"})
def pressure(depth, penalty, toe):
    """Pressure [Pa], its integral [J/m2], and the share in which the contact is closed, at a depth [m] above 0."""
    if depth < toe:
        return penalty * depth * depth / (2.0 * toe), penalty * depth**3 / (6.0 * toe), depth / toe
    return penalty * (depth - 0.5 * toe), penalty * (0.5 * depth * (depth - toe) + toe * toe / 6.0), 1.0


@kernel(fastmath={"contract"})
def brick_failed(torn, first, i, j, ny, nz, face):
    """Whether the brick (i, j) under a face is torn."""
    return torn[first + (i * ny + j) * nz + (nz - 1 if face > 0 else 0)]


@kernel(fastmath={"contract"})
def node_bare(torn, first, i, j, nx, ny, nz, face):
    """Whether the node (i, j) of a face has no brick left under it."""
    for a in (max(i - 1, 0), min(i, nx - 1)):
        for b in (max(j - 1, 0), min(j, ny - 1)):
            if not brick_failed(torn, first, a, b, ny, nz, face):
                return False
    return True


@kernel(fastmath={"contract"}, forceinline=True)
def contact_share(torn, slave, master, place, shape, foot, bounds, gap):
    """Share w of a node's area that is in contact, and how far it is beyond where that ends [bricks].

    place : (i, j) of the node along and across the slave;  foot : its closest point on the master
    """
    _, long, nx, ny, nz = shape
    share, beyond = side_weight(foot[1], ny)
    if foot[0] <= bounds[0] or foot[0] >= bounds[1]:
        share = 0.0
    elif gap < 0.0 and share > 0.0:
        under = min(max(int(foot[1]), 0), ny - 1)
        if brick_failed(torn, master[2], min(int(foot[0]), nx - 1), under, ny, nz, master[1]) or node_bare(
            torn, slave[2], place[0], place[1], long, ny, nz, slave[1]
        ):
            share = 0.0
    return share, beyond


@kernel(fastmath={"contract"}, forceinline=True)
def apply_pressure(motion, node, nodes, weights, n, gap, share, spring, area, damping, dt, sums):
    """Force [N] on a node along its normal n : (3,), of which its closest point's 16 nodes get the opposite.

    sums : (2,) [J] energy and damping, added to
    """
    _, v, inverse_mass = motion
    p, energy, closed = pressure(-gap, spring[0], spring[1])
    opening = v[node, 0] * n[0] + v[node, 1] * n[1] + v[node, 2] * n[2]
    yielding = inverse_mass[node]
    for m in range(16):
        k = nodes[m]
        yielding += weights[m] * weights[m] * inverse_mass[k]
        opening -= weights[m] * (v[k, 0] * n[0] + v[k, 1] * n[1] + v[k, 2] * n[2])
    push = area * p
    drag = max(-closed * damping * opening, -push) * share
    push = push * share + drag
    sums[0] += energy * area * share
    sums[1] -= drag * (opening + 0.5 * dt * yielding * push) * dt  # at the velocity in the middle of the push
    return push


@kernel(fastmath={"contract"})
def one_pass(motion, torn, slave, master, cell_bounds, shape, side, spring, contact, step, force, out):
    """One pass of the penalty contact: nodes of a slave face on a master surface, as far as both have bricks.

    Parameters
    ----------
    motion, torn : as for `crossings`
    slave, master : (3,) first node of the yarn, its face (0 or nz), its first brick
    cell_bounds : brick along the slave where its cell begins; bricks along the master between which feet may lie
    shape : (5,) bricks: along a cell; along the slave, along the master; across, through
    side : +1 where S_,1 x S_,2 points to the slave, else -1
    spring : (3,) penalty [Pa/m], toe and greatest depth [m]
    contact : area, damping : (s,) [m2], [N s/m] of the slave nodes; xi : (s, 2) feet at the last step and rest : (s,)
        steps for which a node need not be looked at, both overwritten
    step : dt [s], reach [m] by which a gap may close in a step at most
    force : (n, 3) [N] added to
    out : (2,) [J] energy and damping, added to
    """
    cell, _, nx, ny, nz = shape
    (x, _, _), (start, low, high), (area, damping, xi, rest), (dt, reach) = motion, cell_bounds, contact, step
    nodes, weights, S, n, away = np.empty(16, np.int64), np.empty(16), np.empty((3, 3)), np.empty(3), np.empty(3)
    for i in range(cell + 1):
        for j in range(ny + 1):
            s = i * (ny + 1) + j
            if rest[s] > 0:
                rest[s] -= 1
                continue
            node = slave[0] + ((start + i) * (ny + 1) + j) * (nz + 1) + slave[1]
            surface_point(x, master[0], nx, ny, nz, master[1], xi[s, 0], xi[s, 1], nodes, weights, S)
            for c in range(3):
                away[c] = x[node, c] - S[0, c]
            n[0] = side * (S[1, 1] * S[2, 2] - S[1, 2] * S[2, 1])
            n[1] = side * (S[1, 2] * S[2, 0] - S[1, 0] * S[2, 2])
            n[2] = side * (S[1, 0] * S[2, 1] - S[1, 1] * S[2, 0])
            length = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
            n /= length
            gap = away[0] * n[0] + away[1] * n[1] + away[2] * n[2]
            share, beyond = contact_share(torn, slave, master, (start + i, j), shape, xi[s], (low, high), gap)
            slip0, slip1, width = closest_point_step(away, S)
            xi[s, 0] = min(max(xi[s, 0] + slip0, low), high)
            xi[s, 1] = min(max(xi[s, 1] + slip1, -1.5), ny + 1.5)
            if gap < -spring[2]:  # it came in from beside the face: to push it out now would make energy
                share = 0.0
            if gap >= 0.0 or share == 0.0:
                rest[s] = min(int(max(gap, beyond * width) / reach), MAX_STEPS_SKIPPED) if reach > 0.0 else 0
                continue
            push = apply_pressure(motion, node, nodes, weights, n, gap, share, spring, area[s], damping[s], dt, out)
            for c in range(3):
                force[node, c] -= push * n[c]
            for m in range(16):
                for c in range(3):
                    force[nodes[m], c] += push * weights[m] * n[c]


@kernel(fastmath={"contract"})
def crossing(c, motion, torn, weave, shape, spring, contact, step, force, out):
    """Both passes of the crossing c; see `crossings`."""
    firsts, bricks, starts, over, bounds = weave
    area, damping, xi, rest = contact
    cell, ny, nz = shape[0], shape[3], shape[4]
    upper, lower = (0, nz) if over[c] else (nz, 0)  # the face of the warp that meets the weft, and of the weft
    side = -1.0 if over[c] else 1.0
    warp, weft = (firsts[c, 0], upper, bricks[c, 0]), (firsts[c, 1], lower, bricks[c, 1])
    half = (0.5 * spring[0], spring[1], spring[2])
    out[c, 0] = 0.0
    for way in range(2):
        slave, master = (warp, weft) if way == 0 else (weft, warp)
        one_pass(
            motion, torn, slave, master, (starts[c, way], bounds[c, 1 - way, 0], bounds[c, 1 - way, 1]),
            (cell, shape[1 + way], shape[2 - way], ny, nz), side, half,
            (area[c, way], damping[c, way], xi[c, way], rest[c, way]), step, force, out[c],
        )  # fmt: skip


@kernel(parallel=True)
def crossings(order, colours, motion, torn, weave, shape, spring, contact, step, force, out):
    """Add the contact forces of all crossings.

    Parameters
    ----------
    order, colours : (C,) crossings by colour, and (5,) where each colour begins
    motion : x, v : (n, 3) [m], [m/s] positions, and velocities of half a step ago; inverse_mass : (n,) [1/kg]
    torn : bool, of all bricks
    weave : (firsts, bricks, starts, over, bounds)
        firsts, bricks : (C, 2) first nodes, and first bricks, of warp and weft
        starts : (C, 2) bricks along warp and weft where the cell begins
        over : (C,) bool, where the warp lies over the weft
        bounds : (C, 2, 2) bricks along warp and weft between which feet may lie
    shape : (5,) int, bricks along a cell, along a warp, along a weft, across, through
    spring : (3,) penalty [Pa/m] of both passes together, toe [m], depth [m] beyond which a node is no partner
    contact : (area, damping, xi, rest)
        area, damping : (C, 2, s) [m2], [N s/m] of the nodes of warp and weft in the cell
        xi, rest : (C, 2, s, 2), (C, 2, s) overwritten
    step : dt, reach [s], [m] as for `one_pass`
    force : (n, 3) [N] added to
    out : (C, 2) [J] energy stored, overwritten, and damping, added to
    """
    (x, v, inverse_mass), (dt, reach), (area, damping, xi, rest) = motion, step, contact
    firsts, bricks, starts, over, bounds = weave
    for colour in range(4):
        for k in prange(colours[colour], colours[colour + 1]):
            crossing(
                order[k], (x, v, inverse_mass), torn, (firsts, bricks, starts, over, bounds), shape, spring,
                (area, damping, xi, rest), (dt, reach), force, out,
            )  # fmt: skip


@entry(fastmath={"contract"})
def find_closest_points(x, firsts, starts, over, bounds, shape, xi):
    """Closest points of all nodes on the other yarn's face, from the middle of each cell; fills xi."""
    cell, ny, nz = shape[0], shape[3], shape[4]
    nodes, weights, S = np.empty(16, np.int64), np.empty(16), np.empty((3, 3))
    for c in range(over.size):
        faces = (0, nz) if over[c] else (nz, 0)
        for way in range(2):
            master = 1 - way
            nx = shape[1 + master]
            for i in range(cell + 1):
                for j in range(ny + 1):
                    s = i * (ny + 1) + j
                    node = firsts[c, way] + ((starts[c, way] + i) * (ny + 1) + j) * (nz + 1) + faces[way]
                    xi[c, way, s, 0], xi[c, way, s, 1] = starts[c, master] + 0.5 * cell, 0.5 * ny
                    for _ in range(100):
                        surface_point(
                            x, firsts[c, master], nx, ny, nz, faces[master], xi[c, way, s, 0], xi[c, way, s, 1], nodes,
                            weights, S,
                        )  # fmt: skip
                        slip0, slip1, _ = closest_point_step(x[node] - S[0], S)
                        xi[c, way, s, 0] = min(
                            max(xi[c, way, s, 0] + slip0, bounds[c, master, 0]), bounds[c, master, 1]
                        )
                        xi[c, way, s, 1] = min(max(xi[c, way, s, 1] + slip1, -1.5), ny + 1.5)
