"""Coulomb friction between neighbouring plies, at the points of the contact of `plies.contact_kernels`.

With f the normal force of a point, v the velocity of the front ply's point over its closest point on the rear ply and g
the elastic slip, both along the surface,

    t = -(k_t g + c_t v),    where |t| > mu f:   t := mu f t / |t|,  g := -t / k_t

(Coulomb's law regularised by an elastic slip, `projectile.friction_kernels`). t acts on the nodes of the front ply by
the weights of the point, -t on those of the rear ply by the weights of its closest point: the sum is zero to round-off.
The stiffness k_t and the damping c_t follow from the time step and the mass of a point (`plies.friction`).

Work. The work of all contact forces is summed over the nodes (`contact_kernels.half_step_work`); that of the friction
is summed over the points by the same trapezoid rule, and the work of the normal forces is the difference. A point that
has lost contact has the second half of the work of its last force in the step after it.

The faces of two plies touch half a thickness away from either middle surface. The moment of friction about the middle
surface, half a thickness times t, is neglected: a membrane takes no moments.
"""

from numba.extending import register_jitable

from shellfabric.jit.compile import kernel
from shellfabric.plies.contact_simd_kernels import FRICTION_WORK
from shellfabric.plies.graded_kernels import scaled_by_area
from shellfabric.plies.point_kernels import (
    front_point,
    grow_window,
    in_front_frame,
    rear_surface,
    relative_velocity,
    scatter_vector,
)
from shellfabric.plies.surface_kernels import FACETS, SMOOTH, intact_about, point_place
from shellfabric.projectile.friction_kernels import friction_force


@register_jitable
def friction_forces(friction_state, front, fc, rear, rc, pair, start, end):
    """Add the friction of the points start .. end - 1 to the forces of both plies, and its work to pair.energy; without
    friction, nothing."""
    if friction_state is not None:
        for q in range(start, end):
            stuck = friction_state[q]
            if pair.normal_force[q] > 0.0 or stuck[3] != 0.0 or stuck[4] != 0.0 or stuck[5] != 0.0:
                point_friction(front, fc, rear, rc, pair, q)


@kernel(_nrt=False)
def point_friction(front, fc, rear, rc, pair, q):
    """Friction of one point over a step; a point without normal force has none from then on."""
    e, a, b = point_place(fc, pair, q)
    _, i, j, k, w_front = front_point(front, fc, pair, a, b)
    A, B = pair.closest_point[0][q], pair.closest_point[1][q]
    whole = pair.surface_form != SMOOTH or intact_about(rear, rc, A, B)
    form = pair.surface_form if whole else FACETS
    I, J, K, w_rear, _, _, _ = rear_surface(rear, rc, form, A, B)
    v_x, v_y, v_z = relative_velocity(front, fc, rear, rc, pair, k, w_front, K, w_rear)
    part = 0.5 if pair.near_torn[e] != 0 else 1.0
    if pair.point_offset == 0.0:  # half an element, or a quarter, is modelled about points on planes of symmetry
        part *= (0.5 if a == 0.0 and fc.mirror_x else 1.0) * (0.5 if b == 0.0 and fc.mirror_y else 1.0)
    part = scaled_by_area(part, pair.area_factor1, pair.area_factor2, int(a), int(b))
    f = pair.normal_force[q]
    t_x, t_y, t_z, taken, _ = friction_force(
        pair.friction_state[q], pair.friction * f, part * pair.slip_stiffness, part * pair.slip_damping, fc.dt,
        pair.normal[0][q], pair.normal[1][q], pair.normal[2][q], v_x, v_y, v_z,
    )  # fmt: skip
    pair.energy[FRICTION_WORK] += taken
    if f == 0.0:
        pair.friction_state[q, :] = 0.0
        return
    grow_window(pair.front_window, i, j, 3)
    grow_window(pair.rear_window, I, J, 3)
    t = (t_x, t_y, t_z)
    scatter_vector(pair.f_front, k, fc.row_stride, 1.0, in_front_frame(pair, t), w_front)
    scatter_vector(pair.f_rear, K, rc.row_stride, -1.0, t, w_rear)
