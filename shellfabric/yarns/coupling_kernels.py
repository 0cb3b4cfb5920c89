"""A zone of yarns in the step of its ply: its energy, and what the nose meets. The one file that knows both.

The last node of a chain IS the membrane's node of the rim crossing: one place, one velocity, one
mass, the sum of both forces. Nothing is interpolated in space, so that momentum and energy are those of one
system. Yarn does not pass the rim.

Inside the rim the membrane has no edges and no mass. In a step the membrane's nodes and the nose have moved, and the
membrane has its own forces, when the zone moves. It makes m steps in one of the membrane, in which rim and nose go on
at their velocities. The mean F of its forces on them over these steps is late by
(m - 1) / (2 m) steps of the membrane, which would make energy. Rim and nose therefore take

    F(n) + (m - 1) / (2 m) (F(n) - F(n - 1))

whose sum over all steps is that of F.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.state import unit
from shellfabric.subcycle_kernels import subcycle
from shellfabric.surface.vector_kernels import three
from shellfabric.yarns.chain_kernels import move, nodes_of
from shellfabric.yarns.nose_kernels import nose_forces
from shellfabric.yarns.shadow_kernels import place_shadow, take_pushes
from shellfabric.yarns.state import Zone
from shellfabric.yarns.zone_kernels import inner_forces

PRESENT = 0  # of zone.outer_force
BEFORE = 1


@unit("number", later=True, own=Zone)
def yarn_forces(state, const, own, first, last, acting):
    """Return the energy [J] that the crossings of a zone store; it acts where the nose does."""
    return own.stored_at_crossings


@unit(later=True, own=Zone)
def march_zone(state, const, own):
    """Move the zone through a step of its ply, under the nose."""
    steps = own.substeps
    end = three(state.projectile_position, 0)
    own.outer_force[PRESENT] = 0.0
    if own.has_shadow:
        take_pushes(own, state, const)
    subcycle(step_zone, (own, state, const, end), steps, const.dt)
    for c in range(3):
        state.projectile_position[c] = end[c]
    give_outer_forces(own, state, 0.5 * (steps - 1) / steps)
    write_to_ply(own, state)
    if own.has_shadow:
        place_shadow(own, state, const)


@kernel(_nrt=False)
def step_zone(body, dt, left):
    """Make one of the zone's own steps, the time `left` [s] before the nose is at the `end` of its
    displacement; body : zone, state, const and this end."""
    zone, state, const, end = body
    for c in range(3):
        state.projectile_position[c] = end[c] - left * state.projectile_velocity[c]
    move(zone)
    follow_rim(zone, state, left)
    inner_forces(zone)
    nose_forces(zone, state, const)
    count_outer_forces(zone, state, 1.0 / zone.substeps)


@kernel(_nrt=False)
def follow_rim(zone, state, left):
    """Set positions and velocities of the tied nodes, the time `left` [s] before the membrane's."""
    for t in range(zone.tied_node.size):
        n = zone.tied_node[t]
        k = np.uint64(zone.tied_slot[t])
        for c in range(3):
            zone.v[c, n] = state.v[c][k]
            zone.x[c, n] = zone.tied_rest[t, c] + state.u[c][k] - left * state.v[c][k]


@kernel(_nrt=False)
def count_outer_forces(zone, state, share):
    """Add a share of the forces on the tied nodes and, after them, on the nose to their means."""
    mean = zone.outer_force[PRESENT]
    for c in range(3):
        for t in range(zone.tied_node.size):
            mean[t, c] += share * zone.f[c, zone.tied_node[t]]
        mean[-1, c] += share * state.f_contact_nose[c]


@kernel(_nrt=False)
def give_outer_forces(zone, state, ahead):
    """Add the mean forces, extrapolated `ahead` [steps], to those of the membrane's nodes; give the nose its own."""
    present = zone.outer_force[PRESENT]
    before = zone.outer_force[BEFORE]
    for c in range(3):
        for t in range(present.shape[0]):
            force = present[t, c] + ahead * (present[t, c] - before[t, c])
            before[t, c] = present[t, c]
            if t < zone.tied_slot.size:
                state.f_int[c][np.uint64(zone.tied_slot[t])] += force
            else:
                state.f_contact_nose[c] = force


@kernel(_nrt=False)
def write_to_ply(zone, state):
    """Copy what the ply keeps of the zone: work, energies of the contact with the nose, peak tensions, torn yarns."""
    state.yarns_ahead = zone.points_ahead
    state.yarn_work = stored_and_lost(zone)
    state.contact_work = zone.stored_at_nose
    state.contact_spring_energy = zone.stored_at_nose
    state.nose_friction_work = zone.nose_friction_work
    for family in range(2):
        if zone.peak_tension[family] > state.peak_tension[family]:
            state.peak_tension[family] = zone.peak_tension[family]
            state.peak_slot[family] = edge_of(zone, family, zone.peak_segment[family])
            state.peak_step[family] = state.steps
    if zone.torn_segments > zone.torn_segments_told:
        zone.torn_segments_told = int(zone.torn_segments)
        for family in range(2):
            for n in range(*nodes_of(zone, family)):
                k = edge_of(zone, family, n)
                if zone.breaking[n] and not zone.whole[n] and state.failed[family][k] == 0:
                    state.failed[family][k] = 1
                    state.failed_segments += 1.0
                    state.loads_at_failure += zone.filtered[n] / zone.strength[n]


@kernel()
def stored_and_lost(zone):
    """Sum the work [J] done so far on resolved yarns and on the contacts of theirs."""
    stored = (
        zone.stored + zone.stored_at_crossings + zone.stored_at_neighbours + zone.stored_at_nose
    )
    lost = stored + zone.damped + zone.friction_work + zone.lost_with_yarns + zone.lost_when_slack
    return lost + zone.nose_friction_work + zone.lost_in_snaps


@kernel(_nrt=False)
def edge_of(zone, family, n):
    """Return the slot of the membrane's edge in whose place a segment is."""
    yarn, k = divmod(n - zone.first[family], zone.nodes[family])
    if family == 0:
        stride = (zone.tied_slot[1] - zone.tied_slot[0]) // ((zone.nodes[0] - 1) // 2)
        return np.uint64(zone.tied_slot[2 * yarn] + k // 2 * stride)
    return np.uint64(zone.tied_slot[2 * (zone.yarns[0] + yarn)] + k // 2)
