"""Contact of the cloth with a rigid projectile: penalty on a signed distance, over points inside the elements.

The projectile is a cylinder of radius R about the z axis, its flat nose at z = 0 facing +z, its edge rounded with the
radius rho. In the plane (r, z), with q = (r - R + rho, z + rho),

    distance = |max(q, 0)| + min(max(q_r, q_z), 0) - rho,      normal n = its gradient.

Every element carries p x p points x = sum N_i x_i. One with distance < 0 feels f n, f = max(0, -k distance - c n.(v -
v_p)); its nodes share f n by their N_i, and the projectile gets -f n, so that momentum is kept.

Points inside the elements are what keeps contact quiet. A lone node that carries a yarn round the edge slides off it
down the side of the cylinder, which stretches the yarn under the nose to twice the tension outside, though frictionless
contact cannot change it; with a sharp edge it is snapped up by its whole depth besides. A point inside an element meets
the edge where the chord is tangent to it, so that the push is normal to the yarn. With two points a side or more the
peak tension has converged (S-720, 92.5 m/s: 135 N; with one point 200 N; at nodes 290 N), and an edge radius of 3 um
serves as well as 0.3 mm.
"""

import math

import numpy as np
from numba import njit

from shellfabric.membrane_kernels import ERODED


@njit(cache=True, error_model="numpy")
def distance(r, z, R, rho):
    """Signed distance to the rounded cylinder and its gradient (n_r, n_z)."""
    q_r, q_z = r - R + rho, z + rho
    if q_r > 0.0 and q_z > 0.0:
        length = math.sqrt(q_r * q_r + q_z * q_z)
        return length - rho, q_r / length, q_z / length
    if q_r > q_z:
        return q_r - rho, 1.0, 0.0
    return q_z - rho, 0.0, 1.0


@njit(cache=True, error_model="numpy")
def corner(state, const, i, j, x, v):
    """Place of node (i, j) relative to the projectile, and its velocity relative to it."""
    k = np.uint64(i * const.s + j)
    x[0] = const.x0 + i * const.dx + state.u[0][k] - state.position[0]
    x[1] = const.y0 + j * const.dy + state.u[1][k] - state.position[1]
    x[2] = state.u[2][k] - state.position[2]
    for c in range(3):
        v[c] = state.v[c][k] - state.speed[c]


@njit(cache=True, error_model="numpy")
def apart(x, R):
    """Whether the element with the corners x (4, 3) lies ahead of the nose or beside the cylinder."""
    if x[0, 2] > 0.0 and x[1, 2] > 0.0 and x[2, 2] > 0.0 and x[3, 2] > 0.0:
        return True
    low_x, high_x, low_y, high_y = x[0, 0], x[0, 0], x[0, 1], x[0, 1]
    for m in range(1, 4):
        low_x, high_x = min(low_x, x[m, 0]), max(high_x, x[m, 0])
        low_y, high_y = min(low_y, x[m, 1]), max(high_y, x[m, 1])
    gap_x, gap_y = max(low_x, -high_x, 0.0), max(low_y, -high_y, 0.0)
    return gap_x * gap_x + gap_y * gap_y > R * R


@njit(cache=True, error_model="numpy")
def contact(state, const, x, v):
    """Contact forces at the present positions, into state.contact; the force on the projectile into state.reaction.

    x, v : (4, 3) scratch. The elements of the block of rows and columns const.near are looked at, unless eroded: what
    no element holds is out of contact. Returns the work that the contact has taken in since the last call (spring and
    damper, by the trapezoid rule) and the energy in its springs.
    """
    i0, i1, j0, j1 = const.near
    for c in range(3):
        state.reaction[c] = 0.0
        for i in range(i0, i1 + 1):
            for k in range(i * const.s + j0, i * const.s + j1 + 1):
                state.contact[c][np.uint64(k)] = 0.0
    work, spring = 0.0, 0.0
    for i in range(i0, i1):
        for j in range(j0, j1):
            e = (i - i0) * (j1 - j0) + j - j0
            if state.flag[i * const.s + j] & ERODED:
                state.pressed[e] = 0.0
                continue
            for m in range(4):
                corner(state, const, i + (m & 1), j + (m >> 1), x[m], v[m])
            if apart(x, const.R) and not state.touching[e]:
                continue
            element_work, element_spring = press(state, const, i, j, e, x, v)
            work += element_work
            spring += element_spring
    # nodes on a plane of symmetry keep to it
    if const.mirror_x and i0 == 0:
        for j in range(j0, j1 + 1):
            state.contact[0][j] = 0.0
    if const.mirror_y and j0 == 0:
        for i in range(i0, i1 + 1):
            state.contact[1][i * const.s] = 0.0
    return work, spring


@njit(cache=True, error_model="numpy")
def press(state, const, i, j, e, x, v):
    """Contact of the points of one element: its work and spring energy; forces are added to its corners."""
    p, work, spring = const.points, 0.0, 0.0
    state.touching[e] = False
    force = state.reaction
    for a in range(p):
        s = (a + 0.5) / p
        for b in range(p):
            t = (b + 0.5) / p
            n0, n1, n2, n3 = (1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t
            p_x = n0 * x[0, 0] + n1 * x[1, 0] + n2 * x[2, 0] + n3 * x[3, 0]
            p_y = n0 * x[0, 1] + n1 * x[1, 1] + n2 * x[2, 1] + n3 * x[3, 1]
            p_z = n0 * x[0, 2] + n1 * x[1, 2] + n2 * x[2, 2] + n3 * x[3, 2]
            before = state.pressed[e, a * p + b]
            r2 = p_x * p_x + p_y * p_y
            if before == 0.0 and (p_z >= 0.0 or r2 >= const.R * const.R):
                continue
            r = math.sqrt(r2)
            depth, n_r, n_z = distance(r, p_z, const.R, const.rho)
            if depth >= 0.0 and before == 0.0:
                continue
            n_x, n_y = (n_r * p_x / r, n_r * p_y / r) if r > 0.0 else (0.0, 0.0)
            closing = -n_x * (n0 * v[0, 0] + n1 * v[1, 0] + n2 * v[2, 0] + n3 * v[3, 0])
            closing -= n_y * (n0 * v[0, 1] + n1 * v[1, 1] + n2 * v[2, 1] + n3 * v[3, 1])
            closing -= n_z * (n0 * v[0, 2] + n1 * v[1, 2] + n2 * v[2, 2] + n3 * v[3, 2])
            f = 0.0
            if depth < 0.0:
                f = max(0.0, const.point_damping * closing - const.point_stiffness * depth)
                spring += 0.5 * const.point_stiffness * depth * depth
                state.touching[e] = True
            work += 0.5 * (f + before) * closing * const.dt
            state.pressed[e, a * p + b] = f
            for c in range(3):
                push = f * (n_x if c == 0 else n_y if c == 1 else n_z)
                k = np.uint64(i * const.s + j)
                state.contact[c][k] += n0 * push
                state.contact[c][k + np.uint64(const.s)] += n1 * push
                state.contact[c][k + np.uint64(1)] += n2 * push
                state.contact[c][k + np.uint64(const.s) + np.uint64(1)] += n3 * push
                force[c] -= push
    return work, spring


@njit(cache=True, error_model="numpy")
def push(state, const):
    """Give nodes and projectile the impulses of the contact forces, equal and opposite."""
    i0, i1, j0, j1 = const.near
    for c in range(3):
        for i in range(i0, i1 + 1):
            for m in range(i * const.s + j0, i * const.s + j1 + 1):
                k = np.uint64(m)
                state.v[c][k] += state.kick[k] * state.contact[c][k]
        state.speed[c] += const.dt * const.free[c] * state.reaction[c] / const.projectile_mass


@njit(cache=True, error_model="numpy")
def in_the_way(state, const, x, v):
    """Whether a part of the cloth that holds together is still ahead of the edge, within the projectile's radius."""
    i0, i1, j0, j1 = const.near
    for i in range(i0, i1):
        for j in range(j0, j1):
            if state.flag[i * const.s + j] & ERODED:
                continue
            for m in range(4):
                corner(state, const, i + (m & 1), j + (m >> 1), x[m], v[m])
            p_x = 0.25 * (x[0, 0] + x[1, 0] + x[2, 0] + x[3, 0])
            p_y = 0.25 * (x[0, 1] + x[1, 1] + x[2, 1] + x[3, 1])
            p_z = 0.25 * (x[0, 2] + x[1, 2] + x[2, 2] + x[3, 2])
            if p_z > -const.rho and p_x * p_x + p_y * p_y < const.R * const.R:
                return True
    return False
