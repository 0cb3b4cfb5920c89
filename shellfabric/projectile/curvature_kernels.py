"""Bending of fibres over the nose: from its curvature in the direction of the yarn, at the points that touch.

A fibre of diameter d on a surface of radius R has its axis on the radius R + d/2, and the strain of its outer side is

    e_b = (d/2) / (R + d/2) = d / (2 R + d)

R is 1 over the normal curvature of the nose below the point in the direction in which the yarn passes over it. Each
step, every contact point that touches leaves e_b of warp and weft at the edges nearest to it; what becomes of it:
`cloth.strength_kernels`. Nothing is computed, and nothing compiled, where the diameter is None.
"""

import math

import numpy as np

from shellfabric.cloth.membrane_kernels import ONE
from shellfabric.jit.compile import kernel
from shellfabric.projectile import sdf_kernels
from shellfabric.projectile.window_kernels import reachable_nodes

PROBE = 1e-3  # [edge radii] to both sides, between which the turn of the nose's normal is taken


@kernel(_nrt=False)
def clear_bending(diameter, state, const):
    """Zero what the contact points have left in the last step."""
    if diameter is None:
        return
    i0, i1, j0, j1 = reachable_nodes(state, const)
    for family in range(2):
        for i in range(i0, i1 + 1):
            for k in range(np.uint64(i * const.row_stride + j0), np.uint64(i * const.row_stride + j1 + 1)):
                state.bending_strain[family][k] = 0.0


@kernel(_nrt=False)
def record_bending(diameter, state, const, k, number, depth, at, m, normal, x):
    """Leave the strain of bending of fibres at contact point `number` of the element in slot k, where it touches.

    depth, normal : signed distance [m] of the point, and the nose's normal there
    at, m : scratch whose rows 0 to 2 have the point's place [m] in column m
    x : (16, 3) [m] of the nodes about the element; all in the frame of the nose
    """
    if diameter is None:
        return
    if depth >= 0.0:
        return
    point = at[0, m], at[1, m], at[2, m]
    per = const.points_per_side
    s, t = (number // per + 0.5) / per, (number % per + 0.5) / per
    for family in range(2):
        if family == 0:
            a, b, c, d = x[9], x[10], x[5], x[6]
            slot = k if t < 0.5 else k + ONE
        else:
            a, b, c, d = x[6], x[10], x[5], x[9]
            slot = k if s < 0.5 else k + np.uint64(const.row_stride)
        along = a[0] + b[0] - c[0] - d[0], a[1] + b[1] - c[1] - d[1], a[2] + b[2] - c[2] - d[2]
        bent = fibre_bending(diameter, nose_curvature(const, depth, point, normal, along))
        state.bending_strain[family][slot] = max(state.bending_strain[family][slot], bent)


@kernel()
def fibre_bending(diameter, curvature):
    """Strain of the outer side of a fibre that lies on a surface of the curvature [1/m]: d / (2 R + d)."""
    turn = 0.5 * diameter * curvature
    return turn / (1.0 + turn)


@kernel(_nrt=False)
def nose_curvature(const, depth, point, normal, along):
    """Normal curvature [1/m] of the nose's surface below a point at the signed distance `depth`, in the direction in
    which `along` passes over it; 0 where it is flat or hollow."""
    (x, y, z), (n_x, n_y, n_z), (t_x, t_y, t_z) = point, normal, along
    off = t_x * n_x + t_y * n_y + t_z * n_z
    t_x, t_y, t_z = t_x - off * n_x, t_y - off * n_y, t_z - off * n_z
    length = math.sqrt(t_x * t_x + t_y * t_y + t_z * t_z)
    if length == 0.0:
        return 0.0
    h = PROBE * const.edge_radius
    t_x, t_y, t_z = t_x / length, t_y / length, t_z / length
    turn = 0.0
    for side in (-1.0, 1.0):
        _, m_x, m_y, m_z = sdf_kernels.distance(
            const.nose_shape, x + side * h * t_x, y + side * h * t_y, z + side * h * t_z, const.projectile_radius,
            const.edge_radius, const.projectile_length, const.nose_parameters,
        )  # fmt: skip
        turn += side * (m_x * t_x + m_y * t_y + m_z * t_z)
    # of the surface of that distance; the radius of the nose's own is larger by the depth
    curvature = max(0.0, turn / (2.0 * h))
    return curvature / (1.0 - curvature * depth)
