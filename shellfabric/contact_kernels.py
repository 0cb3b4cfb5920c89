"""Contact of the fabric's nodes with a rigid projectile, by penalty on a signed distance.

The projectile is a cylinder of radius R about the z axis, its flat nose at z = 0 facing +z, its edge rounded with the
radius rho. In the plane (r, z), with q = (r - R + rho, z + rho),

    distance = |max(q, 0)| + min(max(q_r, q_z), 0) - rho,      normal n = its gradient.

A node with distance < 0 feels f n, f = max(0, -k distance - c n.(v - v_p)), and the projectile -f n. The edge must be
round: with a sharp one a node that slides inwards past it is lifted by all its depth in a single step, and its yarn
reads several times its strength (tests/shellfabric/test_contact.py shows it).
"""

import math

import numpy as np
from numba import njit


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
def contact(state, const):
    """Contact forces at the present positions, into state.contact; the force on the projectile into state.reaction.

    Nodes of the block of node rows and columns const.near are looked at, those that some element still holds.
    Returns the work that the contact took in since the last call (spring and damper, by the trapezoid rule), the
    energy in the springs, and the number of nodes in contact.
    """
    work, spring, touching = 0.0, 0.0, 0
    k_m, c_m = const.penalty, const.damping
    force = state.reaction
    force[:] = 0.0
    position, speed = state.position, state.speed
    for i in range(const.near[0], const.near[1]):
        for j in range(const.near[2], const.near[3]):
            k = np.uint64(i * const.s + j)
            before = state.pressed[k]
            f = 0.0
            if state.held[k] > 0:
                x = const.x0 + i * const.dx + state.u[0, k] - position[0]
                y = const.y0 + j * const.dy + state.u[1, k] - position[1]
                z = state.u[2, k] - position[2]
                r = math.sqrt(x * x + y * y)
                depth, n_r, n_z = distance(r, z, const.R, const.rho)
                if depth < 0.0 or before > 0.0:
                    n_x, n_y = (n_r * x / r, n_r * y / r) if r > 0.0 else (0.0, 0.0)
                    closing = n_x * (speed[0] - state.v[0, k]) + n_y * (speed[1] - state.v[1, k])
                    closing += n_z * (speed[2] - state.v[2, k])
                    m = state.mass[k]
                    if depth < 0.0:
                        f = max(0.0, m * (c_m * closing - k_m * depth))
                        spring += 0.5 * k_m * m * depth * depth
                        touching += 1
                    work += 0.5 * (f + before) * closing * const.dt
                    state.contact[0, k] = f * n_x
                    state.contact[1, k] = f * n_y
                    state.contact[2, k] = f * n_z
                    force[0] -= f * n_x
                    force[1] -= f * n_y
                    force[2] -= f * n_z
            state.pressed[k] = f
            if f == 0.0:
                state.contact[0, k] = state.contact[1, k] = state.contact[2, k] = 0.0
    return work, spring, touching


@njit(cache=True, error_model="numpy")
def push(state, const):
    """Give nodes and projectile the impulses of the contact forces: equal and opposite, so that momentum is kept."""
    for i in range(const.near[0], const.near[1]):
        for j in range(const.near[2], const.near[3]):
            k = np.uint64(i * const.s + j)
            if state.pressed[k] > 0.0:
                for c in range(3):
                    state.v[c, k] += const.dt * state.inverse_mass[k] * state.contact[c, k]
    for c in range(3):
        state.speed[c] += const.dt * const.free[c] * state.reaction[c] / const.projectile_mass


@njit(cache=True, error_model="numpy")
def in_the_way(state, const):
    """Number of held nodes that are still ahead of the nose, within the projectile's radius."""
    count = 0
    for i in range(const.near[0], const.near[1]):
        for j in range(const.near[2], const.near[3]):
            k = np.uint64(i * const.s + j)
            x = const.x0 + i * const.dx + state.u[0, k] - state.position[0]
            y = const.y0 + j * const.dy + state.u[1, k] - state.position[1]
            if state.held[k] > 0 and x * x + y * y < const.R * const.R and state.u[2, k] > state.position[2] - const.rho:
                count += 1
    return count
