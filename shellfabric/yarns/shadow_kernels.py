"""What other plies and a block see of a zone of yarns: shadow nodes, in the membrane's grid inside the rim
(docs/theory-panel.md, "Resolved yarns", packs).

At the crossing (i, j) at rest the zone gives x = w x_a + (1 - w) x_b of a node a of its warp yarn and b of
its weft yarn, w = A_weft / (A_warp + A_weft) by the amplitudes, so that it is at mid-height at rest.
No node of a chain belongs to two shadow nodes: others treat it as a node of the mass m, 1 / m =
w^2 / m_a + (1 - w)^2 / m_b. With f = m (w f_a / m_a + (1 - w) f_b / m_b) in state.f_int the membrane's own
mover moves it as the chains move, and the guard's forecast is exact. By how much its velocity is then
another one than that of its chains tells what it was pushed by: the zone makes one step in one of its ply.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.state import ERODED

ONE = np.uint64(1)


@kernel(_nrt=False, forceinline=True)
def nodes_at(zone, i, j):
    """Return the nodes of the warp yarn j and the weft yarn i at their crossing at rest, and the
    slot of their shadow node."""
    a = zone.first[0] + j * zone.nodes[0] + 2 * (i + 1)
    b = zone.first[1] + i * zone.nodes[1] + 2 * (j + 1)
    k = zone.tied_slot[2 * (zone.yarns[0] + i)] + j + 1
    return a, b, np.uint64(k)


@kernel(_nrt=False, forceinline=True)
def of_both(zone, a, b, warp, weft):
    """Return the weighted mean of a value of the warp's node and one of the weft's."""
    return zone.warp_share * warp + (1.0 - zone.warp_share) * weft


@kernel(_nrt=False)
def take_pushes(zone, state, const):
    """Hand to the chains what others have pushed their shadow nodes by in this step, which the
    chains have still to make."""
    for i in range(max(zone.mirror_first[0], 0), zone.yarns[1]):
        for j in range(max(zone.mirror_first[1], 0), zone.yarns[0]):
            a, b, k = nodes_at(zone, i, j)
            for c in range(3):
                warp = zone.v[c, a] + zone.dt * zone.inverse_mass[a] * zone.f[c, a]
                weft = zone.v[c, b] + zone.dt * zone.inverse_mass[b] * zone.f[c, b]
                force = (state.v[c][k] - of_both(zone, a, b, warp, weft)) / state.dt_over_mass[k]
                force /= zone.crossing_share[j, i]
                zone.f[c, a] += zone.warp_share * force
                zone.f[c, b] += (1.0 - zone.warp_share) * force


@kernel(_nrt=False)
def place_shadow(zone, state, const):
    """Set places, velocities and forces of the shadow nodes from their chains, and erode the
    elements that are no fabric any more."""
    for i in range(max(zone.mirror_first[0], 0), zone.yarns[1]):
        for j in range(max(zone.mirror_first[1], 0), zone.yarns[0]):
            a, b, k = nodes_at(zone, i, j)
            mass = const.dt / state.dt_over_mass[k]
            apart = 0.0
            for c in range(3):
                at_rest = 0.0
                if c == 0:
                    at_rest = zone.tied_rest[2 * (zone.yarns[0] + i), 0]
                if c == 1:
                    at_rest = zone.tied_rest[2 * j, 1]
                state.u[c][k] = of_both(zone, a, b, zone.x[c, a], zone.x[c, b]) - at_rest
                state.v[c][k] = of_both(zone, a, b, zone.v[c, a], zone.v[c, b])
                warp = zone.inverse_mass[a] * zone.f[c, a]
                weft = zone.inverse_mass[b] * zone.f[c, b]
                state.f_int[c][k] = mass * of_both(zone, a, b, warp, weft)
                state.f_int_above[c][k] = 0.0
                apart += (zone.x[c, a] - zone.x[c, b]) ** 2
            bears = zone.whole[a - 1] or zone.whole[a] or zone.whole[b - 1] or zone.whole[b]
            if not bears or apart > zone.furthest * zone.furthest:
                erode_about(state, const, k, i > zone.mirror_first[0], j > zone.mirror_first[1])


@kernel(_nrt=False)
def erode_about(state, const, k, below, left):
    """Take the four elements about a node out of all contacts."""
    s = np.uint64(const.row_stride)
    for number, e in enumerate((k, k - ONE, k - s, k - s - ONE)):
        # there is none beyond a plane of symmetry: it lies before the array
        if (number % 2 == 1 and not left) or (number >= 2 and not below):
            continue
        if state.element_flag[e] & ERODED == 0:
            state.element_flag[e] |= ERODED
            state.failures += 1
