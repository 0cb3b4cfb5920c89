"""Contact of a block (`block_kernels`) with a projectile, and with points such as those of a ply.

Both are penalties with damping, never less than nothing together; what one side gets the other
gives. Damping is kept apart: what it takes is its force times velocities in the middle of the step,
which are not known yet. A shot is met by signed distance (`sdf_kernels`) at nodes that still have a
brick, a point by the facet below it (`find_contacts`), along the line to its foot: with forces
straight below the point instead, energy comes from nowhere.
"""

import math

import numpy as np
from numba import prange

from shellfabric.contact import normal_kernels
from shellfabric.jit.compile import entry, kernel
from shellfabric.projectile import sdf_kernels
from shellfabric.projectile.profile_kernels import (
    clear_profile,
    profile_power,
    profile_velocity,
    push_profile,
)
from shellfabric.surface.vector_kernels import dot, scaled, subtract

SLICES = 16  # of the points, which threads share
MAX_COLUMNS = 50  # columns that a point is followed across in one call
MAX_FACET_COORDINATE = 3.0  # coordinate in a facet, -1 .. 1 within it, that a foot may have


@kernel()
def node_active(i, j, k, block):
    """Tell whether a brick is left at the node."""
    for p in range(max(i - 1, 0), min(i + 1, block.nx)):
        for q in range(max(j - 1, 0), min(j + 1, block.ny)):
            for r in range(max(k - 1, 0), min(k + 1, block.nz)):
                if not block.gone[(p * block.ny + q) * block.nz + r]:
                    return True
    return False


@entry()
def nose_forces(block, position, speed, nose):
    """Add the forces of a projectile on the nodes of the block to block.outer and drags; those on a
    body that deforms to the rings of its profile.

    Energy and forces of the contact, into block.nose_spring_energy, nose_force and nose_drag.

    Parameters
    ----------
    position, speed : (3,) of the nose [m], [m/s]
    nose : its shape

    Returns
    -------
    power : [W] of the forces of a step ago on the rings of a profile, at its velocities over that of
        the nose
    """
    x = block.x
    power = 0.0
    block.nose_spring_energy = 0.0
    block.nose_force[:] = 0.0
    block.nose_drag[:] = 0.0
    widest = nose.radius * nose.radius
    if nose.kind == sdf_kernels.PROFILE:
        widest = nose.profile.widest**2
        power = profile_power(nose.profile)
        clear_profile(nose.profile)
    for i in range(block.nx + 1):
        for j in range(block.ny + 1):
            for k in range(block.nz + 1):
                n = (i * (block.ny + 1) + j) * (block.nz + 1) + k
                place = subtract(x[n], position)
                # debris may fly ahead of what it came from: every node of the column is looked at
                if place[2] > 0.0 or place[0] * place[0] + place[1] * place[1] > widest:
                    continue
                if not node_active(i, j, k, block):
                    continue
                foot = 0.0, 0.0
                velocity = subtract(block.v[n], speed)
                if nose.kind == sdf_kernels.PROFILE:
                    foot, gap, normal = sdf_kernels.distance_to_profile(nose, place)
                    own = profile_velocity(nose.profile, place, foot)
                    velocity = subtract(velocity, own)
                else:
                    gap, normal = sdf_kernels.distance(nose, place)
                if gap >= 0.0:
                    continue
                opening = dot(velocity, normal)
                push, stored = normal_kernels.spring(block.stiffness[n], -gap)
                drag = normal_kernels.damping_force(push, block.damping[n], opening)
                block.nose_spring_energy += stored
                for c in range(3):
                    block.outer[n, c] -= push * normal[c]
                    block.drags[n, c] -= drag * normal[c]
                    block.nose_force[c] -= push * normal[c]
                    block.nose_drag[c] -= drag * normal[c]
                if nose.kind == sdf_kernels.PROFILE:
                    push_profile(nose.profile, place, foot, scaled(-push - drag, normal))
    return power


@kernel()
def top_brick(p, q, block):
    """Find the first brick of the column (p, q) below all that are gone; nz if there is none. Above
    it there is debris."""
    for r in range(block.nz - 1, -1, -1):
        if block.gone[(p * block.ny + q) * block.nz + r]:
            return r + 1
    return 0


@kernel()
def weights(a, b, w):
    """Fill in the bilinear weights w : (4,) of the nodes of a facet at (a, b)."""
    w[0] = 0.25 * (1 - a) * (1 - b)
    w[1] = 0.25 * (1 + a) * (1 - b)
    w[2] = 0.25 * (1 + a) * (1 + b)
    w[3] = 0.25 * (1 - a) * (1 + b)


@kernel()
def tangents(a, b, x, nodes, A, B):
    """Compute the slopes A, B : (3,) of a facet along its coordinates, four times over."""
    for c in range(3):
        A[c] = (1 - b) * (x[nodes[1], c] - x[nodes[0], c]) + (1 + b) * (
            x[nodes[2], c] - x[nodes[3], c]
        )
        B[c] = (1 - a) * (x[nodes[3], c] - x[nodes[0], c]) + (1 + a) * (
            x[nodes[2], c] - x[nodes[1], c]
        )


@kernel()
def beyond(px, py, x, nodes):
    """Tell which way, -1, 0 or 1 along x and y, a point lies beyond the sides of a facet seen along
    z."""
    p = q = 0
    for m, (go_p, go_q) in enumerate(((0, -1), (1, 0), (0, 1), (-1, 0))):
        n = nodes[m]
        k = nodes[(m + 1) % 4]
        if (x[k, 0] - x[n, 0]) * (py - x[n, 1]) < (x[k, 1] - x[n, 1]) * (px - x[n, 0]):
            p = p + go_p
            q = q + go_q
    return p, q


@kernel()
def locate(at, block, column, place, nodes):
    """Find the facet under a point, from the column it was last over.

    Beside a facet that is drawn out and twisted Newton's steps may go round in circles, within it
    even: then its sides decide which facet is next.

    Parameters
    ----------
    column : (2,) int, overwritten;  place : (2,) filled with the coordinates in the facet, -1 .. 1
    nodes : (4,) filled

    Returns
    -------
    found : False beyond the block, where a column has no brick left, or under a fold that hides
        what is below
    """
    px = at[0]
    py = at[1]
    x = block.x
    ny = block.ny
    nz = block.nz
    w = np.empty(4)
    A = np.empty(3)
    B = np.empty(3)
    for _ in range(MAX_COLUMNS):
        p = column[0]
        q = column[1]
        r = top_brick(p, q, block)
        if r == nz:
            return False
        first = (p * (ny + 1) + q) * (nz + 1) + r
        nodes[0] = first
        nodes[1] = first + (ny + 1) * (nz + 1)
        nodes[2] = nodes[1] + nz + 1
        nodes[3] = first + nz + 1
        a = 0.0
        b = 0.0
        found = False
        for _ in range(20):
            weights(a, b, w)
            rx = px
            ry = py
            for m in range(4):
                rx -= w[m] * x[nodes[m], 0]
                ry -= w[m] * x[nodes[m], 1]
            tangents(a, b, x, nodes, A, B)
            xa = 0.25 * A[0]
            ya = 0.25 * A[1]
            xb = 0.25 * B[0]
            yb = 0.25 * B[1]
            det = xa * yb - xb * ya
            da = (yb * rx - xb * ry) / det
            db = (xa * ry - ya * rx) / det
            a = min(max(a + da, -4.0), 4.0)
            b = min(max(b + db, -4.0), 4.0)
            if abs(da) + abs(db) < 1e-12:
                found = True
                break
        tiny = 1e-9
        go_p = (a > 1 + tiny) - (a < -1 - tiny)
        go_q = (b > 1 + tiny) - (b < -1 - tiny)
        if not found:
            go_p, go_q = beyond(px, py, x, nodes)
        if go_p == 0 and go_q == 0:
            place[0] = a
            place[1] = b
            return found
        if not (0 <= p + go_p < block.nx and 0 <= q + go_q < ny):
            return False
        column[0] = p + go_p
        column[1] = q + go_q
    return False


@kernel()
def closest_point(p, x, nodes, place, A, B):
    """Move `place` from the point of the facet that is straight below p : (3,) to the one that is
    nearest to it.

    Newton on (p - y).A = (p - y).B = 0, on the facet continued by as much as itself; A, B as
    `tangents`, filled.

    Returns
    -------
    found : False where it leads further: the point is not at this facet, but far along its slope
    """
    a = place[0]
    b = place[1]
    w = np.empty(4)
    found = False
    for _ in range(20):
        tangents(a, b, x, nodes, A, B)
        weights(a, b, w)
        aa = ab = bb = ra = rb = 0.0
        for c in range(3):
            off = p[c]
            for m in range(4):
                off -= w[m] * x[nodes[m], c]
            twist = x[nodes[0], c] - x[nodes[1], c] + x[nodes[2], c] - x[nodes[3], c]
            aa = aa + A[c] * A[c]
            bb = bb + B[c] * B[c]
            ab = ab + A[c] * B[c] - 4.0 * off * twist
            ra = ra + off * A[c]
            rb = rb + off * B[c]
        det = aa * bb - ab * ab
        da = 4.0 * (bb * ra - ab * rb) / det
        db = 4.0 * (aa * rb - ab * ra) / det
        a = a + da
        b = b + db
        if not (det > 0.0 and abs(a) < MAX_FACET_COORDINATE and abs(b) < MAX_FACET_COORDINATE):
            break
        if abs(da) + abs(db) < 1e-12:
            place[0] = a
            place[1] = b
            found = True
            break
    tangents(place[0], place[1], x, nodes, A, B)
    return found


@kernel()
def outward_normal(A, B, normal):
    """Compute the unit normal : (3,) of a facet with the slopes A, B, out of the block: against z
    at rest."""
    normal[0] = A[2] * B[1] - A[1] * B[2]
    normal[1] = A[0] * B[2] - A[2] * B[0]
    normal[2] = A[1] * B[0] - A[0] * B[1]
    normal /= math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)


@kernel()
def depth_and_opening(p, speed, block, facet, thickness):
    """Compute the depth [m] of a point p : (3,) in the face, and its opening velocity [m/s], from
    the weights w of the nodes of the facet."""
    nodes, w, normal = facet
    inside = thickness
    opening = 0.0
    for c in range(3):
        under = 0.0
        moving = 0.0
        for m in range(4):
            under += w[m] * block.x[nodes[m], c]
            moving += w[m] * block.v[nodes[m], c]
        inside -= (p[c] - under) * normal[c]
        opening += (speed[c] - moving) * normal[c]
    return inside, opening


@entry()
def at_points(values, rest, weights, nj, found):
    """Interpolate values at points of elements.

    Parameters
    ----------
    values : three arrays of the nodes, row after row, as state.u
    rest : (3, nodes) added to them
    weights : (p, 4) of the corners (0, 0), (1, 0), (0, 1), (1, 1) of an element, for each of its
        points
    nj : elements along a row of nodes
    found : (elements p, 3), overwritten
    """
    stride = nj + 1
    for s in range(found.shape[0]):
        element = s // weights.shape[0]
        m = s % weights.shape[0]
        k = element // nj * stride + element % nj
        w = weights[m]
        for c in range(3):
            x = values[c]
            at = rest[c]
            found[s, c] = w[0] * (x[k] + at[k]) + w[1] * (x[k + stride] + at[k + stride])
            found[s, c] += w[2] * (x[k + 1] + at[k + 1])
            found[s, c] += w[3] * (x[k + stride + 1] + at[k + stride + 1])


@entry()
def to_nodes(forces, weights, nj, found):
    """Share forces (elements p, 3) at points of elements out to the nodes: three arrays `found`,
    overwritten; see `at_points`."""
    stride = nj + 1
    for total in found:
        total[:] = 0.0
    # points and corners outside: the order in which they are summed up at a node
    for m in range(weights.shape[0]):
        for corner, step in enumerate((0, stride, 1, stride + 1)):
            for element in range(forces.shape[0] // weights.shape[0]):
                k = element // nj * stride + element % nj + step
                s = element * weights.shape[0] + m
                for c in range(3):
                    found[c][k] += weights[m, corner] * forces[s, c]


@kernel()
def find_contacts(ends, block, points, thickness, dt):
    """Find the contacts of the points from the first to before the last of `ends` with the face of
    the block, into points.feet, depth, damping_force, normal and weights.

    A facet of the block's face is bilinear over its four nodes: the top of the first brick of its
    column below all that are gone, found from the column that the point was over before. A point
    counts against the facet, its continuation, or the nearest place of it; high above the wall of a
    crater not at all.

    The face of a block that erodes has steps: a point that comes over a higher column is all at
    once inside by as much as a brick, and a spring would throw it out at thousands of m/s. So what
    a point has gone in by grows by motion alone, and what came by a step is put into an offset,
    which shrinks as the point comes out. Where the face drops away or turns, what the spring held
    is lost: the audit counts the work of the contacts, and what no spring stores is damped
    (`block.Block.energies`).
    """
    place = np.empty(2)
    normal = np.empty(3)
    w = np.empty(4)
    A = np.empty(3)
    B = np.empty(3)
    for s in range(*ends):
        points.depth[s] = points.damping_force[s] = 0.0
        was = points.inside[s]
        offset = points.offset[s]
        nodes = points.feet[s]
        at = points.x[s]
        below = locate(at, block, points.columns[s], place, nodes)
        if not (below and closest_point(at, block.x, nodes, place, A, B)):
            points.inside[s] = -1.0
            points.offset[s] = 0.0
            continue
        weights(place[0], place[1], w)
        outward_normal(A, B, normal)
        facet = nodes, w, normal
        inside, opening = depth_and_opening(at, points.v[s], block, facet, thickness)
        # beyond what motion explains, twice over for a facet that turns, it is a step of the face
        step = inside - was
        if step > 2.0 * abs(opening) * dt and inside > 0.0:
            offset += step + opening * dt
        offset = min(max(offset, 0.0), max(inside, 0.0))
        depth = max(inside - offset, 0.0)
        points.inside[s] = inside
        points.offset[s] = offset
        if depth > 0.0:
            push, _ = normal_kernels.spring(points.stiffness[s], depth)
            points.depth[s] = depth
            points.damping_force[s] = normal_kernels.damping_force(push, points.damping[s], opening)
            points.normal[s] = normal
            points.weights[s] = w


@entry(parallel=True)
def point_forces(block, points, thickness, dt):
    """Compute the forces between points and the face of the block: into points.force and
    points.drag, and added to block.outer and block.drags; the energy of the contact into
    block.point_spring_energy.

    Parameters
    ----------
    points : BlockPoints
    thickness : [m] distance that points keep from the face: half of what they stand for
    dt : [s] since the last call
    """
    count = points.columns.shape[0]
    size = (count + SLICES - 1) // SLICES
    for part in prange(SLICES):
        ends = part * size, min((part + 1) * size, count)
        find_contacts(ends, block, points, thickness, dt)
    block.point_spring_energy = 0.0
    for s in range(count):
        depth = points.depth[s]
        drag = points.damping_force[s]
        points.force[s] = 0.0
        points.drag[s] = 0.0
        if depth == 0.0:
            continue
        push, stored = normal_kernels.spring(points.stiffness[s], depth)
        block.point_spring_energy += stored
        for c in range(3):
            normal = points.normal[s, c]
            points.force[s, c] = push * normal
            points.drag[s, c] = drag * normal
            for m in range(4):
                node = points.feet[s, m]
                weight = points.weights[s, m]
                block.outer[node, c] += push * weight * normal
                block.drags[node, c] += drag * weight * normal
