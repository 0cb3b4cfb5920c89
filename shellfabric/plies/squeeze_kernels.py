"""Points of contact between plies that a step would squeeze by more than the share MAX_SQUEEZE of the thickness.

`point_kernels.spring_force` lists them, with those that are near the bound, past which other plies may push them in the
same step. An additional force holds a point at the bound, computed from the velocities after the step by all forces on
both plies (docs/theory-panel.md, "Packs: contact between plies"). A ply that is pushed pushes the next: all pairs are
swept in turn, from the front to the rear and back (Gauss-Seidel).
"""

import numpy as np

from shellfabric.jit.borrowed_list import borrowed_item
from shellfabric.jit.compile import kernel
from shellfabric.plies.contact_kernels import apply_symmetry, forces_on, half_step_work, neighbour_force
from shellfabric.plies.contact_simd_kernels import MAX_SQUEEZE, WORK
from shellfabric.plies.point_kernels import front_point, grow_window, in_front_frame, rear_surface, scatter_vector
from shellfabric.plies.surface_kernels import FACETS, intact_about, point_place

_SWEEPS = 8
_TINY = 1e-6  # [m/s]
_PUSH_OUT = 0.2  # of what a point is squeezed too far, in a step


@kernel(_nrt=False)
def stop_deep_points(states, consts, pairs):
    """Add to the forces of all pairs what stops their listed points, and its half a step's work."""
    listed, count = 0, len(pairs)
    for number in range(count):
        listed += borrowed_item(pairs, number).deep_count[0]
    if listed == 0:
        return
    for number in range(count):
        book_work(states, consts, pairs, number, -1.0)
    for sweep in range(_SWEEPS):
        held = 0
        for n in range(count):
            held += stop_points(states, consts, pairs, n if sweep % 2 == 0 else count - 1 - n)
        if held == 0:
            break
    for number in range(count):
        pair, (p, q) = borrowed_item(pairs, number), plies_of(number, count)
        if pair.deep_count[0] > 0:
            apply_symmetry(borrowed_item(consts, p), pair.f_front, pair.front_window)
            apply_symmetry(borrowed_item(consts, q), pair.f_rear, pair.rear_window)
            book_work(states, consts, pairs, number, 1.0)


@kernel(_nrt=False, forceinline=True)
def plies_of(number, pairs):
    """Plies (whose points, on whose surface) of a pair by number: first all pairs with the points of the ply before,
    then all with those of the ply behind."""
    p = number % (pairs // 2)
    return (p, p + 1) if number < pairs // 2 else (p + 1, p)


@kernel(_nrt=False)
def book_work(states, consts, pairs, number, sign):
    """Book half a step's work of the forces of a pair with listed points; sign -1 takes a booking back."""
    pair, (p, q) = borrowed_item(pairs, number), plies_of(number, len(pairs))
    if pair.deep_count[0] > 0:
        front, fc = borrowed_item(states, p), borrowed_item(consts, p)
        rear, rc = borrowed_item(states, q), borrowed_item(consts, q)
        given = half_step_work(front, fc, pair.f_front, pair.front_window, False)
        given += half_step_work(rear, rc, pair.f_rear, pair.rear_window, False)
        pair.energy[WORK] -= sign * given


@kernel(_nrt=False)
def stop_points(states, consts, pairs, number):
    """One sweep over the listed points of a pair; how many were pushed."""
    pair, (p, other) = borrowed_item(pairs, number), plies_of(number, len(pairs))
    if pair.deep_count[0] == 0:
        return 0
    front, fc, held = borrowed_item(states, p), borrowed_item(consts, p), 0
    rear, rc = borrowed_item(states, other), borrowed_item(consts, other)
    for q in pair.deep_points[: pair.deep_count[0]]:
        _, a, b = point_place(fc, pair, q)
        _, i, j, k, w_front = front_point(front, fc, pair, a, b)
        A, B = pair.closest_point[0][q], pair.closest_point[1][q]
        form = pair.surface_form if intact_about(rear, rc, A, B) else FACETS
        I, J, K, w_rear, _, _, _ = rear_surface(rear, rc, form, A, B)
        n = pair.normal[0][q], pair.normal[1][q], pair.normal[2][q]
        back = in_front_frame(pair, n)
        speed, kick = predicted_speed(front, fc, pairs, p, k, w_front, back)
        rear_speed, rear_kick = predicted_speed(rear, rc, pairs, other, K, w_rear, n)
        room = MAX_SQUEEZE * pair.thickness - (pair.last_depth[q] - pair.depth_offset[q])
        excess = speed - rear_speed - (room if room > 0.0 else _PUSH_OUT * room) / fc.dt
        if excess > _TINY and kick + rear_kick > 0.0:
            held += 1
            f = excess / (kick + rear_kick)
            grow_window(pair.front_window, i, j, 3)
            grow_window(pair.rear_window, I, J, 3)
            scatter_vector(pair.f_front, k, fc.row_stride, -f, back, w_front)
            scatter_vector(pair.f_rear, K, rc.row_stride, f, n, w_rear)
    return held


@kernel(_nrt=False)
def predicted_speed(state, const, pairs, p, k, weights, n):
    """Of a point of ply p, along n: its velocity [m/s] after a step by all forces but those of torn fabric, and the
    velocity [m/s] that a force of 1 N there makes in a step."""
    (a0, a1, a2, a1x), (b0, b1, b2, b1y) = weights
    speed, made, s = 0.0, 0.0, const.row_stride
    for i, (a, ax) in enumerate(((a0, a0), (a1, a1x), (a2, a2))):
        for j, (b, by) in enumerate(((b0, b0), (b1, b1y), (b2, b2))):
            m = k + np.uint64(i * s + j)
            kick = state.dt_over_mass[m]
            for c, w in enumerate((n[0] * ax * b, n[1] * a * by, n[2] * a * b)):
                total = state.f_int[c][m] + state.f_int_above[c][m] + state.f_contact[c][m]
                if const.has_backing:
                    total += state.f_block_cloth[c][m]
                for number in forces_on(p, len(pairs)):
                    total += neighbour_force(pairs, number)[0][c][m]
                speed += w * (state.v[c][m] + kick * total)
                made += kick * w * w
    return speed, made
