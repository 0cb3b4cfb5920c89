"""Contact of the bars of a cable net with the rigid projectile: penalty on `shapes_kernels.flat`.

Every bar carries points x = (1 - t) x_near + t x_far. One with distance < 0 feels f n,
f = max(0, -k distance - c n.(v - v_p)); the two nodes share f n by 1 - t and t, and the projectile gets -f n, so that
momentum is kept. Points inside the bars and not the nodes alone, so that the edge pushes where a bar is tangent to it,
normal to the yarn.
"""

import math

import numpy as np
from numba import njit

from shellfabric.shapes_kernels import flat

WARP, WEFT = 0, 1
CONTACT, SPRING = 1, 2  # of state.sums
ONE = np.uint64(1)


@njit(cache=True, error_model="numpy")
def ends(state, const, family, i, j, x, v):
    """Places of the two nodes of a bar relative to the projectile, and their velocities relative to it: x, v (2, 3)."""
    for m in range(2):
        p, q = (i + m, j) if family == WARP else (i, j + m)
        k = np.uint64(p * const.s + q)
        x[m, 0] = const.origin[0] + p * const.spacing[0] + state.u[0, k] - state.position[0]
        x[m, 1] = const.origin[1] + q * const.spacing[1] + state.u[1, k] - state.position[1]
        x[m, 2] = state.u[2, k] - state.position[2]
        for c in range(3):
            v[m, c] = state.v[c, k] - state.speed[c]


@njit(cache=True, error_model="numpy")
def apart(x, R):
    """Whether the bar lies ahead of the nose or beside the cylinder."""
    if x[0, 2] > 0.0 and x[1, 2] > 0.0:
        return True
    near_x = max(min(x[0, 0], x[1, 0]), -max(x[0, 0], x[1, 0]), 0.0)
    near_y = max(min(x[0, 1], x[1, 1]), -max(x[0, 1], x[1, 1]), 0.0)
    return near_x * near_x + near_y * near_y > R * R


@njit(cache=True, error_model="numpy")
def contact(state, const, x, v):
    """Add the contact forces to state.g; state.reaction is the force on the projectile. x, v : (2, 3) scratch.

    Looks at the bars that begin in the block of node rows and columns const.near. Adds up the work that the contact has
    taken in (spring and damper, by the trapezoid rule), and sums the energy in its springs.
    """
    i0, i1, j0, j1 = const.near
    state.reaction[:] = 0.0
    state.sums[SPRING] = 0.0
    for family in range(2):
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                touching = state.touching[family, i - i0, j - j0]  # a bar that has failed since lets go here
                if touching or state.stiff[family, i * const.s + j] > 0.0:
                    ends(state, const, family, i, j, x, v)
                    if touching or not apart(x, const.R):
                        press(state, const, family, i, j, x, v)


@njit(cache=True, error_model="numpy")
def press(state, const, family, i, j, x, v):
    """Contact of the points of the bar that begins at node (i, j), whose ends are at x with the velocities v."""
    k = np.uint64(i * const.s + j)
    weight = state.stiff[family, k] * const.S0[family] / const.EA[family]
    stiffness, damping = weight * const.point_stiffness[family], weight * const.point_damping[family]
    row, column = i - const.near[0], j - const.near[2]
    points, touching, work, spring = state.pressed.shape[3], False, 0.0, 0.0
    near_x = near_y = near_z = far_x = far_y = far_z = 0.0
    for a in range(points):
        t = (a + 0.5) / points
        s = 1.0 - t
        p_x, p_y, p_z = s * x[0, 0] + t * x[1, 0], s * x[0, 1] + t * x[1, 1], s * x[0, 2] + t * x[1, 2]
        r = math.sqrt(p_x * p_x + p_y * p_y)
        depth, n_r, n_z = flat(r, p_z, const.R, const.rho)
        before = state.pressed[family, row, column, a]
        if depth >= 0.0 and before == 0.0:
            continue
        n_x, n_y = (n_r * p_x / r, n_r * p_y / r) if r > 0.0 else (0.0, 0.0)
        closing = -n_x * (s * v[0, 0] + t * v[1, 0]) - n_y * (s * v[0, 1] + t * v[1, 1])
        closing -= n_z * (s * v[0, 2] + t * v[1, 2])
        f = 0.0
        if depth < 0.0:
            f = max(0.0, damping * closing - stiffness * depth)
            spring += 0.5 * stiffness * depth * depth
            touching = True
        work += 0.5 * (f + before) * closing * const.dt
        state.pressed[family, row, column, a] = f
        touching |= f > 0.0
        near_x, near_y, near_z = near_x + s * f * n_x, near_y + s * f * n_y, near_z + s * f * n_z
        far_x, far_y, far_z = far_x + t * f * n_x, far_y + t * f * n_y, far_z + t * f * n_z
    state.touching[family, row, column] = touching
    state.sums[CONTACT] += work
    state.sums[SPRING] += spring
    m = k + (np.uint64(const.s) if family == WARP else ONE)
    share(state, k, near_x, near_y, near_z)
    share(state, m, far_x, far_y, far_z)


@njit(cache=True, error_model="numpy")
def share(state, k, f_x, f_y, f_z):
    """Give a force to node k, and its opposite to the projectile."""
    state.g[0, k] += f_x
    state.g[1, k] += f_y
    state.g[2, k] += f_z
    state.reaction[0] -= f_x
    state.reaction[1] -= f_y
    state.reaction[2] -= f_z


@njit(cache=True, error_model="numpy")
def anchored(state, const):
    """Which nodes i0 .. i1 + 1, j0 .. j1 + 1 are joined by unbroken bars to the rim of that block, and so to the net.

    What is not joined is a plug that the projectile has punched out and may push before it for good.
    """
    i0, i1, j0, j1 = const.near
    i1, j1 = min(i1 + 1, const.ni), min(j1 + 1, const.nj)
    joined = np.zeros((i1 - i0 + 1, j1 - j0 + 1), np.bool_)
    joined[-1, :] = joined[:, -1] = True
    joined[0, :] |= i0 > 0
    joined[:, 0] |= j0 > 0
    changed = True
    while changed:
        changed = False
        for family in range(2):
            for i in range(i0, i1 + (family == WEFT)):
                for j in range(j0, j1 + (family == WARP)):
                    p, q = (i - i0 + 1, j - j0) if family == WARP else (i - i0, j - j0 + 1)
                    here, there = joined[i - i0, j - j0], joined[p, q]
                    if here != there and state.stiff[family, i * const.s + j] > 0.0:
                        joined[i - i0, j - j0] = joined[p, q] = changed = True
    return joined


@njit(cache=True, error_model="numpy")
def in_the_way(state, const, x, v):
    """Whether the middle of a bar that the net holds is still ahead of the edge, within the projectile's radius."""
    i0, i1, j0, j1 = const.near
    joined = anchored(state, const)
    for family in range(2):
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                if not joined[i - i0, j - j0] or state.stiff[family, i * const.s + j] == 0.0:
                    continue
                ends(state, const, family, i, j, x, v)
                p_x, p_y, p_z = 0.5 * (x[0, 0] + x[1, 0]), 0.5 * (x[0, 1] + x[1, 1]), 0.5 * (x[0, 2] + x[1, 2])
                if p_z > -const.rho and p_x * p_x + p_y * p_y < const.R * const.R:
                    return True
    return False
