"""A zone of yarns in the step of its ply: a force module, and what the nose meets. The one file that knows both.

The last node of a chain IS the membrane's node of the rim crossing: one place, one velocity, one
mass, the sum of both forces. Nothing is interpolated, so that momentum and energy are those of one
system. Yarn does not pass the rim.

Inside the rim the membrane has no edges and no mass. In a step the membrane's nodes have moved and
have their own forces when the zone moves, takes place and velocity of its rim from them, and adds its
forces to theirs.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.projectile import contact_kernels
from shellfabric.state import Zone, unit
from shellfabric.yarns.chain_kernels import BOOKS, CROSSINGS, NOSE, NOSE_FRICTION, TORN, move
from shellfabric.yarns.nose_kernels import AHEAD, nose_forces
from shellfabric.yarns.zone_kernels import inner_forces

COUNTED = 1  # of zone.counter: torn segments that the ply knows of


@unit("number", later=True, own=Zone)
def yarn_forces(state, const, own, first, last, acting):
    """[J] that the crossings of a zone store; if `acting`, moves the zone and finds its inner forces."""
    if acting:
        move(own)
        follow_rim(own, state)
        inner_forces(own)
    return own.books[CROSSINGS]


@unit("number", later=True, own=Zone)
def meet_nose(state, const, own, first, last, acting):
    """[J] that the contact of the nose with a zone stores; its forces, which complete those that the rim takes over."""
    nose_forces(own, state, const)
    pull_rim(own, state)
    tell_ply(own, state)
    return own.books[NOSE]


@kernel(_nrt=False)
def follow_rim(zone, state):
    """Places and velocities of the tied nodes from the membrane's."""
    for t in range(zone.tied_node.size):
        n = zone.tied_node[t]
        k = np.uint64(zone.tied_slot[t])
        for c in range(3):
            zone.x[n, c] = zone.tied_rest[t, c] + state.u[c][k]
            zone.v[n, c] = state.v[c][k]


@kernel(_nrt=False)
def pull_rim(zone, state):
    """Add the forces on the tied nodes to the membrane's."""
    for t in range(zone.tied_node.size):
        n = zone.tied_node[t]
        k = np.uint64(zone.tied_slot[t])
        for c in range(3):
            state.f_int[c][k] += zone.f[n, c]


@kernel(_nrt=False)
def tell_ply(zone, state):
    """What the ply keeps of the zone: its work, energies of the contact with the nose, peak tensions, torn yarns."""
    state.yarns_ahead[0] = zone.counter[AHEAD]
    state.yarn_work[0] = 0.0
    for n in range(BOOKS - 2):
        state.yarn_work[0] += zone.books[n]
    state.contact_energy[contact_kernels.CONTACT] = zone.books[NOSE]
    state.contact_energy[contact_kernels.SPRING] = zone.books[NOSE]
    state.contact_energy[contact_kernels.FRICTION] = zone.books[NOSE_FRICTION]
    for family in range(2):
        if zone.peak_tension[family] > state.peak_tension[family]:
            state.peak_tension[family] = zone.peak_tension[family]
            state.peak_segment[family, 0] = edge_of(zone, family, zone.peak_segment[family])
            state.peak_segment[family, 1] = state.counter[0]
    if zone.books[TORN] > zone.counter[COUNTED]:
        zone.counter[COUNTED] = int(zone.books[TORN])
        for family in range(2):
            last = zone.first[family] + zone.yarns[family] * zone.nodes[family]
            for n in range(zone.first[family], last):
                k = edge_of(zone, family, n)
                if zone.breaking[n] and not zone.whole[n] and state.failed[family][k] == 0:
                    state.failed[family][k] = 1
                    state.failure_sums[0] += 1.0
                    state.failure_sums[1] += zone.filtered[n] / zone.strength[n]


@kernel(_nrt=False)
def edge_of(zone, family, n):
    """Slot of the membrane's edge in whose place a segment is."""
    yarn, k = divmod(n - zone.first[family], zone.nodes[family])
    if family == 0:
        stride = (zone.tied_slot[1] - zone.tied_slot[0]) // ((zone.nodes[0] - 1) // 2)
        return np.uint64(zone.tied_slot[2 * yarn] + k // 2 * stride)
    return np.uint64(zone.tied_slot[2 * (zone.yarns[0] + yarn)] + k // 2)
