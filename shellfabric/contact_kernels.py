"""Contact of the cloth with a rigid projectile: penalty on a signed distance, over points of a smooth surface.

The distance is that of `shapes_kernels`, in the frame of the projectile: its nose at the origin, its axis along z. A
projectile whose axis is tilted has a frame of its own, into which places are turned, and normals back out of it.

Every element carries p x p points x = sum N_i x_i of the surface of `spline_kernels`. One with distance < 0 feels f n,
f = max(0, -k distance - c n.(v - v_p)), and the friction of `friction_kernels`; its nodes share the force by their N_i,
and the projectile gets its opposite, so that momentum is kept. Where yarns have failed, k and c are those of what is
left of the two next to a point.

Why a smooth surface. A lone node that carries a yarn round the edge slides off it down the side of the cylinder, and a
sharp edge snaps it up by its whole depth. Points inside flat elements meet the edge quietly, but the normals of these
jump at nodes, so that the rim bends a yarn at one node or another, and the peak tension goes with where the rim lies in
an element and does not settle with the mesh. With 1 and 2 elements a crossover it was 215 and 250 N in the warp of
S-745, 116 and 127 N in that of S-726; the smooth surface has 217 and 223, 118.7 and 118.8 N. With eight points a
crossover it has converged in their number (S-720, equilibrium form, 92.5 m/s: 134.7 and 153.9 N; four points 131.4 and
149.5, sixteen 134.3 and 153.7). An edge radius of 3 um in place of 0.3 mm takes a tenth off it (120.6 and 139.8 N), a
thirtieth with sixteen points (129.5 and 150.8).
"""

import numpy as np
from numba import njit

from shellfabric import friction_kernels, shapes_kernels, spline_kernels
from shellfabric.membrane_kernels import ERODED

CONTACT, SPRING, FRICTION, FRICTION_SPRING = 0, 1, 2, 3  # of state.contact_energy


@njit(cache=True, error_model="numpy")
def window(state):
    """First and last row, and column, of the elements that contact looks at."""
    return state.window[0], state.window[1], state.window[2], state.window[3]


@njit(cache=True, error_model="numpy")
def reached(state, const):
    """First and last row, and column, of the nodes that it may push: one beyond those of the elements."""
    i0, i1, j0, j1 = window(state)
    return max(i0 - 1, 0), min(i1 + 1, const.ni), max(j0 - 1, 0), min(j1 + 1, const.nj)


@njit(cache=True, error_model="numpy")
def follow(state, const):
    """Let the window of elements that contact looks at, state.window, go with a projectile that moves sideways.

    The body lies between its nose and the place where its axis is at const.depth below the panel; about that the window
    leaves const.reach, by which cloth may be drawn in besides the body's own width, and what the edges have slipped.
    """
    slip = 0.0
    for m in range(const.rim_node.size):
        slip = max(slip, abs(state.u[const.rim_axis[m]][const.rim_node[m]]))
    back = min((state.position[2] + const.depth) / const.frame[2, 2], const.length)
    for c, start, step in ((0, const.x0, const.dx), (1, const.y0, const.dy)):
        nose, foot = state.position[c], state.position[c] - back * const.frame[2, c]
        low, high = min(nose, foot) - start, max(nose, foot) - start
        low, high = low - const.reach[c] - slip, high + const.reach[c] + slip
        count = const.near[2 * c + 1]
        state.window[2 * c] = min(max(int(low / step), 0), count)
        state.window[2 * c + 1] = min(max(int(high / step) + 1, state.window[2 * c]), count)
    state.rows[0] = min(state.rows[0], max(state.window[0] - 2, 0))
    state.rows[1] = max(state.rows[1], min(state.window[1] + 2, const.ni))


@njit(cache=True, error_model="numpy")
def contact(state, const, x, v, strip):
    """Contact forces at the present positions, into state.contact; the force on the projectile into state.reaction.

    x, v : (16, 3), strip : (9, 3) scratch. The elements of the block of rows and columns state.window, which lies in
    const.near, are looked at, unless eroded: what no yarn holds is out of contact. Returns the work that the contact
    has taken in since the last call (spring and damper, by the trapezoid rule) and the energy in its springs.
    """
    i0, i1, j0, j1 = reached(state, const)
    for c in range(3):
        state.reaction[c] = 0.0
        for i in range(i0, i1 + 1):
            for k in range(i * const.s + j0, i * const.s + j1 + 1):
                state.contact[c][np.uint64(k)] = 0.0
    if const.roaming:
        follow(state, const)
    i0, i1, j0, j1 = window(state)
    state.contact_energy[FRICTION_SPRING] = 0.0
    work, spring = 0.0, 0.0
    for i in range(i0, i1):
        for j in range(j0, j1):
            e = (i - const.near[0]) * (const.near[3] - const.near[2]) + j - const.near[2]
            for m in range(16):
                spline_kernels.node(state, const, i - 1 + (m >> 2), j - 1 + (m & 3), x[m], v[m])
            if state.flag[i * const.s + j] and erode(state, const, i, j, x):
                state.touching[e] = False
                state.pressed[e] = 0.0
                if const.friction > 0.0:
                    state.stuck[e] = 0.0
                continue
            if spline_kernels.apart(x, const.R) and not state.touching[e]:
                continue
            element_work, element_spring = press(state, const, i, j, e, x, v, strip)
            work += element_work
            spring += element_spring
    # nodes on a plane of symmetry keep to it
    i0, i1, j0, j1 = reached(state, const)
    if const.mirror_x and i0 == 0:
        for j in range(j0, j1 + 1):
            state.contact[0][j] = 0.0
    if const.mirror_y and j0 == 0:
        for i in range(i0, i1 + 1):
            state.contact[1][i * const.s] = 0.0
    return work, spring


@njit(cache=True, error_model="numpy")
def erode(state, const, i, j, x):
    """Whether the element has no cloth left to push on: its yarns are gone, or those of one family are and the gap that
    they left is wider than const.widest, so that the others are far from it. Once so, it stays so."""
    k = np.uint64(i * const.s + j)
    if state.flag[k] & ERODED:
        return True
    warp = state.intact[0][k] + state.intact[0][k + np.uint64(1)]
    weft = state.intact[1][k] + state.intact[1][k + np.uint64(const.s)]
    a, b = 0.0, 0.0
    for c in range(3):
        a += (x[9, c] - x[5, c] + x[10, c] - x[6, c]) ** 2
        b += (x[6, c] - x[5, c] + x[10, c] - x[9, c]) ** 2
    open1, open2 = a > (2.0 * const.widest * const.dx) ** 2, b > (2.0 * const.widest * const.dy) ** 2
    if (warp == 0.0 and (weft == 0.0 or open1)) or (weft == 0.0 and open2):
        state.flag[k] |= ERODED
        return True
    return False


@njit(cache=True, error_model="numpy")
def cover(state, const, k, s, t):
    """Part of the cloth that is left at the point (s, t) of element k: the mean of the warp and the weft next to it."""
    warp, weft, row = state.intact[0], state.intact[1], np.uint64(const.s)
    near = warp[k] if t < 0.5 else warp[k + np.uint64(1)]
    other = weft[k] if s < 0.5 else weft[k + row]
    if t == 0.5:
        near = 0.5 * (warp[k] + warp[k + np.uint64(1)])
    if s == 0.5:
        other = 0.5 * (weft[k] + weft[k + row])
    return 0.5 * (near + other)


@njit(cache=True, error_model="numpy")
def press(state, const, i, j, e, x, v, strip):
    """Contact of the points of one element: its work and spring energy; forces are added to its nodes.

    Points at one s and in one half of t share their weights along the warp, so that of places, velocities and forces
    there are but three each to deal with: rows 0-2, 3-5 and 6-8 of strip.
    """
    p, half, work, spring = const.points, (const.points + 1) // 2, 0.0, 0.0
    state.touching[e] = False
    k, bent1, bent2 = np.uint64(i * const.s + j), True, True
    whole, plain = state.flag[k] == 0, spline_kernels.untorn(state, const, i, j)
    for a in range(p):
        s, q = (a + 0.5) / p, a // half
        for r in range(2):
            if not plain:
                bent1, bent2 = spline_kernels.bends(state, const, i, j, q, r)
            A, hit = spline_kernels.weights(s - q, bent1), False
            for m in range(3):
                n = 4 * q + r + m
                for c in range(3):
                    strip[m, c] = A[0] * x[n, c] + A[1] * x[n + 4, c] + A[2] * x[n + 8, c]
                    strip[3 + m, c] = A[0] * v[n, c] + A[1] * v[n + 4, c] + A[2] * v[n + 8, c]
                    strip[6 + m, c] = 0.0
            for b in range(r * half, half + r * (p - half)):
                t = (b + 0.5) / p
                B = spline_kernels.weights(t - r, bent2)
                p_x, p_y, p_z = spline_kernels.between(B, strip, 0)
                last = state.pressed[e, a * p + b]  # force of the last step: its size, and its three components
                before = last[0]
                if before == 0.0 and (p_z >= 0.0 or p_x * p_x + p_y * p_y >= const.R * const.R):
                    continue
                depth, n_x, n_y, n_z = shapes_kernels.distance(
                    const.shape, p_x, p_y, p_z, const.R, const.rho, const.length, const.form
                )
                if depth >= 0.0 and before == 0.0:
                    continue
                part = 1.0 if whole else cover(state, const, k, s, t)
                if part == 0.0:
                    last[:] = 0.0
                    if const.friction > 0.0:
                        state.stuck[e, a * p + b] = 0.0
                    continue
                stiffness, damping = part * const.point_stiffness, part * const.point_damping
                if const.tilted:
                    n_x, n_y, n_z = turned_back(const.frame, n_x, n_y, n_z)
                v_x, v_y, v_z = spline_kernels.between(B, strip, 3)
                f = 0.0
                if depth < 0.0:
                    f = max(0.0, -damping * (n_x * v_x + n_y * v_y + n_z * v_z) - stiffness * depth)
                    spring += 0.5 * stiffness * depth * depth
                    state.touching[e] = True
                f_x, f_y, f_z = f * n_x, f * n_y, f * n_z
                work -= 0.5 * const.dt * ((f_x + last[1]) * v_x + (f_y + last[2]) * v_y + (f_z + last[3]) * v_z)
                last[0], last[1], last[2], last[3] = f, f_x, f_y, f_z
                if const.friction > 0.0:
                    t_x, t_y, t_z, taken, held = friction_kernels.rub(
                        state.stuck[e, a * p + b], const.friction * f, stiffness, damping, const.dt,
                        n_x, n_y, n_z, v_x, v_y, v_z,
                    )  # fmt: skip
                    state.contact_energy[FRICTION] += taken
                    state.contact_energy[FRICTION_SPRING] += held
                    f_x, f_y, f_z = f_x + t_x, f_y + t_y, f_z + t_z
                hit = True
                for m in range(3):
                    strip[6 + m, 0] += B[m] * f_x
                    strip[6 + m, 1] += B[m] * f_y
                    strip[6 + m, 2] += B[m] * f_z
            if hit:
                spread(state, const, i - 1 + q, j - 1 + r, A, strip)
    return work, spring


@njit(cache=True, error_model="numpy")
def spread(state, const, i, j, A, strip):
    """Add the forces in a strip to the nodes (i, j) .. (i + 2, j + 2), and their opposite to the projectile's."""
    for n in range(3):
        f_x, f_y, f_z = strip[6 + n, 0], strip[6 + n, 1], strip[6 + n, 2]
        column, sign_y = spline_kernels.seen(j + n, const.nj, const.mirror_y)
        for m in range(3):
            row, sign_x = spline_kernels.seen(i + m, const.ni, const.mirror_x)
            k = np.uint64(row * const.s + column)
            state.contact[0][k] += sign_x * A[m] * f_x
            state.contact[1][k] += sign_y * A[m] * f_y
            state.contact[2][k] += A[m] * f_z
        state.reaction[0] -= f_x
        state.reaction[1] -= f_y
        state.reaction[2] -= f_z


@njit(cache=True, error_model="numpy")
def turned_back(frame, x, y, z):
    """A vector in the frame of the projectile, in that of the panel."""
    return (
        frame[0, 0] * x + frame[1, 0] * y + frame[2, 0] * z,
        frame[0, 1] * x + frame[1, 1] * y + frame[2, 1] * z,
        frame[0, 2] * x + frame[1, 2] * y + frame[2, 2] * z,
    )


@njit(cache=True, error_model="numpy")
def push(state, const):
    """Give nodes and projectile the impulses of the contact forces, equal and opposite."""
    i0, i1, j0, j1 = reached(state, const)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for m in range(i * const.s + j0, i * const.s + j1 + 1):
                k = np.uint64(m)
                state.v[c][k] += state.kick[k] * state.contact[c][k]
        state.speed[c] += const.dt * const.free[c] * state.reaction[c] / const.projectile_mass


@njit(cache=True, error_model="numpy")
def in_the_way(state, const, x, v):
    """Whether a part of the cloth that holds together is ahead of the shoulder, within the projectile's radius."""
    i0, i1, j0, j1 = window(state)
    for i in range(i0, i1):
        for j in range(j0, j1):
            if state.flag[i * const.s + j] & ERODED:
                continue
            for m in range(4):
                spline_kernels.node(state, const, i + (m & 1), j + (m >> 1), x[m], v[m])
            p_x = 0.25 * (x[0, 0] + x[1, 0] + x[2, 0] + x[3, 0])
            p_y = 0.25 * (x[0, 1] + x[1, 1] + x[2, 1] + x[3, 1])
            p_z = 0.25 * (x[0, 2] + x[1, 2] + x[2, 2] + x[3, 2])
            if p_z > -const.shoulder and p_x * p_x + p_y * p_y < const.R * const.R:
                return True
    return False
