"""Contact of the facets of yarns with a rigid projectile: penalty, damping and friction as between
yarns (`facet_kernels`), on the signed distance of their middles (`projectile.sdf_kernels`)."""

import numpy as np

from shellfabric.contact.friction_kernels import slide
from shellfabric.jit.compile import kernel
from shellfabric.projectile.sdf_kernels import distance
from shellfabric.surface.vector_kernels import add_scaled, dot, scaled, subtract, three
from validation.models.solids.facet_kernels import (
    FACES,
    facet_brick,
    facet_corners,
    mean,
    pressure,
    steps_to,
)

STIFFER = (
    2.0**0.5
)  # damper on the nose, which has the whole penalty, over that of one pass of yarns


@kernel(fastmath={"contract"})
def meet_nose(patch, face, a, b, facet, dt, corners):
    """Add the force of one facet on the projectile.

    dt : [s] since the last call; 0 at the first
    corners : (4,) int scratch
    """
    if patch.torn[facet_brick(patch, face, a, b)]:
        patch.failure_energy += patch.nose_energy[facet]
        patch.nose_energy[facet] = 0.0
        return
    middle = facet_corners(patch, face, a, b, corners)
    gap, normal = distance(patch.nose, subtract(middle, three(patch.nose_position, 0)))
    area = patch.area[facet]
    stiffness = patch.penalty * area
    if gap >= 0.0:
        slider = three(patch.nose_slider[facet], 0)
        patch.friction_work += 0.5 * stiffness * dot(slider, slider)
        for c in range(3):
            patch.nose_slider[facet, c] = 0.0
        patch.nose_energy[facet] = 0.0
        patch.nose_wait[facet] = steps_to(patch, gap)
        return
    p, stored, closed = pressure(-gap, patch.penalty, patch.toe)
    v = subtract(mean(patch.v, corners), three(patch.nose_velocity, 0))
    opening = dot(v, normal)
    push = area * p
    drag = max(-STIFFER * closed * patch.damping[facet] * opening, -push)
    push += drag
    mobility = 0.0
    for k in range(4):
        mobility += 0.0625 / patch.whole_mass[corners[k]]
    # the damper acts at the velocity in the middle of the push
    patch.contact_damping -= drag * (opening + 0.5 * dt * mobility * push) * dt
    force = scaled(push, normal)
    energy = area * stored
    if patch.nose_friction > 0.0:
        limit = patch.nose_friction * area * p
        kept, slid = slide(patch.nose_slider[facet], limit, stiffness, dt, normal, v)
        force = add_scaled(force, -stiffness, three(patch.nose_slider[facet], 0))
        energy += kept
        patch.friction_work += slid
    patch.nose_energy[facet] = energy
    for c in range(3):
        patch.nose_force[c] -= force[c]
        for k in range(4):
            patch.f_other[corners[k], c] -= 0.25 * force[c]


@kernel()
def nose_forces(patch, dt):
    """Add the forces of all faces on the projectile."""
    corners = np.empty(4, np.int64)
    for c in range(3):
        patch.nose_force[c] = 0.0
    for face in range(patch.face_node.size):
        yarn = face // FACES
        facet = patch.face_facet[face] - 1
        for a in range(patch.nx[yarn]):
            for b in range(patch.ny[yarn]):
                facet += 1
                if patch.nose_wait[facet] > 0:
                    patch.nose_wait[facet] -= 1
                    continue
                meet_nose(patch, face, a, b, facet, dt, corners)
