"""A zone of yarns in the step of its ply: its energy, and what the nose meets. The one file that
knows both (docs/theory-panel.md, "Resolved yarns", Tie and Time steps).

The last node of a chain IS the membrane's node of the rim crossing. Nothing is interpolated in
space, so that momentum and energy are those of one system. In a step the membrane's nodes and the
nose have moved, and the membrane has its own forces, when the zone moves. It makes m steps in one of
the membrane, in which rim and nose go on at their velocities; they take the mean of its forces F_0
to F_m, moved to the end of the membrane's step. A force that is late, or extrapolated from the step
before, is damping below 0, which makes energy when cut yarns recoil.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.state import unit
from shellfabric.subcycle_kernels import subcycle
from shellfabric.surface.vector_kernels import three
from shellfabric.yarns.chain_kernels import mirror_nodes, move, nodes_of
from shellfabric.yarns.nose_kernels import nose_forces
from shellfabric.yarns.shadow_kernels import place_shadow, take_pushes
from shellfabric.yarns.state import Zone
from shellfabric.yarns.zone_kernels import inner_forces


@unit("number", later=True, own=Zone)
def yarn_forces(state, const, own, first, last, acting):
    """Return the energy [J] that the crossings of a zone store; it acts where the nose does."""
    return own.stored_at_crossings


@unit(later=True, own=Zone)
def march_zone(state, const, own):
    """Move the zone through a step of its ply, under the nose."""
    steps = own.substeps
    end = three(state.projectile_position, 0)
    own.taken_work += 0.5 * const.dt * power_taken(own, state)
    begin_outer_forces(own)
    if own.has_shadow:
        take_pushes(own, state, const)
    subcycle(step_zone, (own, state, const, end), steps, const.dt)
    for c in range(3):
        state.projectile_position[c] = end[c]
    give_outer_forces(own, state)
    own.taken_work += 0.5 * const.dt * power_taken(own, state)
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
    mirror_nodes(zone)
    inner_forces(zone)
    nose_forces(zone, state, const)
    count_outer_forces(zone, state, 1.0 / zone.substeps)


@kernel(_nrt=False)
def follow_rim(zone, state, left):
    """Set positions and velocities of the tied nodes, the time `left` [s] before the membrane's."""
    for t in range(zone.tied_node.size):
        if zone.tied_share[t] == 0.0:
            continue
        n = zone.tied_node[t]
        k = np.uint64(zone.tied_slot[t])
        for c in range(3):
            zone.v[c, n] = state.v[c][k]
            zone.x[c, n] = zone.tied_rest[t, c] + state.u[c][k] - left * state.v[c][k]


@kernel(_nrt=False)
def begin_outer_forces(zone):
    """Begin what rim and nose take with the forces before the step, F_0 (see above)."""
    share = 0.5 / zone.substeps - 0.5
    for k in range(zone.outer_force.shape[0]):
        for c in range(3):
            zone.taken_force[k, c] = share * zone.outer_force[k, c]


@kernel(_nrt=False)
def count_outer_forces(zone, state, share):
    """Find the forces on the tied nodes and, after them, on the nose, and their work; add a share
    of them to what these take."""
    rim = zone.tied_node.size
    power = 0.0
    for c in range(3):
        for k in range(rim + 1):
            force = state.f_contact_nose[c]
            velocity = state.projectile_velocity[c]
            if k < rim:
                force = zone.tied_share[k] * zone.f[c, zone.tied_node[k]]
                velocity = zone.v[c, zone.tied_node[k]]
            power += (zone.outer_force[k, c] + force) * velocity
            zone.outer_force[k, c] = force
            zone.taken_force[k, c] += share * force
    zone.given_work += 0.5 * zone.dt * power


@kernel(_nrt=False)
def give_outer_forces(zone, state):
    """Add to the forces of the membrane's nodes and of the nose what they take, with F_m (see
    above)."""
    share = 0.5 - 0.5 / zone.substeps
    for c in range(3):
        for k in range(zone.outer_force.shape[0]):
            zone.taken_force[k, c] += share * zone.outer_force[k, c]
        for t in range(zone.tied_slot.size):
            if zone.tied_share[t] == 0.0:
                continue
            state.f_int[c][np.uint64(zone.tied_slot[t])] += zone.taken_force[t, c]
        state.f_contact_nose[c] = zone.taken_force[-1, c]


@kernel(_nrt=False)
def power_taken(zone, state):
    """Compute the power [W] of what rim and nose have taken last, at the velocities of this step."""
    power = 0.0
    for c in range(3):
        for t in range(zone.tied_slot.size):
            if zone.tied_share[t] == 0.0:
                continue
            power += zone.taken_force[t, c] * state.v[c][np.uint64(zone.tied_slot[t])]
        power += zone.taken_force[-1, c] * state.projectile_velocity[c]
    return power


@kernel(_nrt=False)
def write_to_ply(zone, state):
    """Copy what the ply keeps of the zone: work, energies of the contact with the nose, peak
    tensions, torn yarns."""
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
    halves = int(2.0 * zone.torn_segments)  # on a plane of symmetry half a segment tears
    if halves > zone.torn_segments_told:
        zone.torn_segments_told = halves
        for family in range(2):
            for n in range(*nodes_of(zone, family)):
                k = edge_of(zone, family, n)
                torn = zone.segment_share[n] > 0.0 and zone.breaking[n] and not zone.whole[n]
                if torn and state.failed[family][k] == 0:
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
