"""Contact of a cable net with the rigid projectile: the shell's own, on the surface whose control points are the nodes.

So the two models differ in what lies under that surface alone. See `contact_kernels` and `spline_kernels`, of which
an element needs the intact fractions of its four bars.
"""

import numpy as np

from shellfabric.cloth import spline_kernels
from shellfabric.cloth.membrane_kernels import WARP_FAILED, WEFT_FAILED
from shellfabric.jit.compile import kernel
from shellfabric.projectile import contact_kernels, window_kernels

WARP, WEFT = 0, 1
CONTACT, SPRING = 1, 2  # of state.energy_sums


@kernel()
def contact_forces(state, const):
    """Add the contact forces to state.f; state.f_contact_nose is the force on the projectile.

    Adds up the work that the contact has taken in, and finds the energy in its springs.
    """
    before = contact_kernels.clear_forces(state, const)
    taken, spring = contact_kernels.contact_window(state, const, state.contact_scratch)
    state.energy_sums[CONTACT] += taken - before
    state.energy_sums[SPRING] = spring
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    for c in range(3):
        for i in range(i0, i1 + 1):
            for m in range(i * const.row_stride + j0, i * const.row_stride + j1 + 1):
                k = np.uint64(m)
                state.f[c, k] += state.f_contact[c, k]


@kernel()
def mark_failed_bars(state, const):
    """Set the damage flags of the elements in the contact window whose bars have failed."""
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    for family in range(2):
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                k = np.uint64(i * const.row_stride + j)
                if state.stiffness[family, k] == 0.0 and state.intact_fraction[family, k] > 0.0:
                    state.intact_fraction[family, k] = 0.0
                    before = (i, max(j - 1, 0)) if family == WARP else (max(i - 1, 0), j)
                    for element in (k, np.uint64(before[0] * const.row_stride + before[1])):
                        state.element_flag[element] |= WARP_FAILED if family == WARP else WEFT_FAILED


@kernel()
def anchored(state, const):
    """Which nodes i0 .. i1 + 1, j0 .. j1 + 1 are joined by unbroken bars to the rim of that block, and so to the net.

    Bars that are not connected to the boundary (a plug) do not count: the projectile may push them for good.
    """
    i0, i1, j0, j1 = const.window_limits
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
                    if here != there and state.stiffness[family, i * const.row_stride + j] > 0.0:
                        joined[i - i0, j - j0] = joined[p, q] = changed = True
    return joined


@kernel()
def net_ahead_of_nose(state, const):
    """Whether the middle of a bar that the net holds is still ahead of the edge, within the projectile's radius."""
    i0, i1, j0, j1 = const.window_limits
    joined = anchored(state, const)
    for family in range(2):
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                if not joined[i - i0, j - j0] or state.stiffness[family, i * const.row_stride + j] == 0.0:
                    continue
                near_x, near_y, near_z = spline_kernels.node_position(state, const, i, j)
                far_x, far_y, far_z = spline_kernels.node_position(
                    state, const, i + (family == WARP), j + (family == WEFT)
                )
                p_x, p_y, p_z = 0.5 * (near_x + far_x), 0.5 * (near_y + far_y), 0.5 * (near_z + far_z)
                if (
                    p_z > -const.edge_radius
                    and p_x * p_x + p_y * p_y < const.projectile_radius * const.projectile_radius
                ):
                    return True
    return False
