"""The yarn that moves through the nodes: shares of the segments, free ends of yarn, open windows.

Ends of yarn. A segment that has failed, or whose yarn has been pulled out of the node at its end, has no force: from
each of the nodes beside it hangs a free tail. When the tail is used up, the yarn leaves that node, and the segment
before it becomes the tail.

Open windows. The projectile touches a closed surface through the nodes. Where yarns have been drawn apart, only what
lies near one of them is left of it (`projectile.window_kernels.cover_at_point`); an element between whose four yarns
the whole projectile fits is taken out of contact.

Open windows and segments that a yarn's end has left count as failures of their ply: there the contact between plies
looks for edges and holes, and the projectile for a way through.
"""

import numpy as np

from shellfabric.cloth import failure_kernels
from shellfabric.cloth.membrane_kernels import ERODED, WINDOW
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import WIDTH, any_lane, fabs, fma, greater, load, masked_store, where
from shellfabric.panel.motion_kernels import FAILURES
from shellfabric.projectile import window_kernels

WARP, WEFT = 0, 1
EMPTIED, PULLED_OUT, TAILS = (
    0,
    1,
    2,
)  # of slip.counter: a tail is used up, segments pulled out, ends of yarn
REMOVED_NOW = np.uint8(2)  # of slip.removed: in this step; 1 in an earlier one


@kernel(_nrt=False)
def move_yarn(state, const, slip):
    """Move the yarn of a step through the nodes: the shares of the segments, and the tails of those without force."""
    s, dt = const.row_stride, const.dt
    for i in range(state.active_rows[0], state.active_rows[1] + 1):
        here, ahead = slip.row_slips[i], i < const.ni and slip.row_slips[i + 1]
        if not (here or ahead):
            continue
        for j in range(0, s, WIDTH):
            k, left = i * s + j, s - j
            q1, q2 = load(slip.q[0], k), load(slip.q[1], k)
            if i < const.ni:
                flow = (q1 - load(slip.q[0], k + s)) * (dt / const.dx)
                if any_lane(greater(fabs(flow), 0.0)):
                    add_yarn(state, slip, 0, k, left, flow)
            if here:
                flow = (q2 - load(slip.q[1], k + 1)) * (dt / const.dy)
                if any_lane(greater(fabs(flow), 0.0)):
                    add_yarn(state, slip, 1, k, left, flow)
                if any_lane(greater(fabs(q1) + fabs(q2), 0.0)):
                    masked_store(slip.passed[0], k, fma(q1, dt, load(slip.passed[0], k)), left)
                    masked_store(slip.passed[1], k, fma(q2, dt, load(slip.passed[1], k)), left)
    if slip.counter[TAILS] > 0:
        move_tails(state, const, slip)


@kernel(_nrt=False, forceinline=True)
def add_yarn(state, slip, family, k, left, flow):
    """Add to the shares of eight segments, of those that are whole."""
    share = load(slip.share[family], k)
    share = where(greater(load(state.intact_fraction[family], k), 0.0), share + flow, share)
    masked_store(slip.share[family], k, share, left)
    masked_store(slip.inv_share[family], k, 1.0 / share, left)


@kernel(_nrt=False)
def move_tails(state, const, slip):
    """Move the free tails. slip.tail has the parts [at rest lengths] on the near and the far side of each segment."""
    s = const.row_stride
    for family in range(2):
        step, per = (s, const.dt / const.dx) if family == WARP else (1, const.dt / const.dy)
        near, far = slip.tail[family]
        for i in range(state.active_rows[0], state.active_rows[1] + 1):
            if not (slip.row_slips[i] or (family == WARP and i > 0 and slip.row_slips[i - 1])):
                continue
            for j in range(s):
                k = np.uint64(i * s + j)
                if slip.q[family][k] == 0.0:
                    continue
                back = np.int64(k) - step
                if (
                    state.intact_fraction[family][k] == 0.0
                ):  # slot s further: one before the first is there too
                    near[np.uint64(np.int64(k) + s)] += per * slip.q[family][k]
                    if near[np.uint64(np.int64(k) + s)] < 0.0:
                        slip.counter[EMPTIED] = 1
                if back < 0 or state.intact_fraction[family][np.uint64(back)] == 0.0:
                    far[np.uint64(back + s)] -= per * slip.q[family][k]
                    if far[np.uint64(back + s)] < 0.0:
                        slip.counter[EMPTIED] = 1


@kernel(_nrt=False)
def pull_out(state, const, slip, family, i, j):
    """Take the force from the segment that begins at node (i, j), whose yarn has left the node at one end of it."""
    k = np.uint64(i * const.row_stride + j)
    state.intact_fraction[family][k] = 0.0
    state.yarn_length[family][k] = 0.0
    failure_kernels.flag_elements(const, state, family, i, j)
    slip.counter[PULLED_OUT] += 1
    state.counter[FAILURES] += 1
    slip.removed[family][k] = REMOVED_NOW


@kernel(_nrt=False)
def open_windows(state, const, slip):
    """Find the elements whose yarns have been drawn apart along both families, in the contact window.

    Those that the projectile fits through are taken out of contact; the others are flagged for `cover_at_point`.
    """
    i0, i1, j0, j1 = window_kernels.window_bounds(state)
    s, one, width = np.uint64(const.row_stride), np.uint64(1), 2.0 * const.projectile_radius
    wide1, wide2 = width / const.dx, width / const.dy
    L1, L2 = state.stretch
    for i in range(i0, i1):
        for j in range(j0, j1):
            k = np.uint64(i * const.row_stride + j)
            most1, most2 = max(L1[k], L1[k + one]), max(L2[k], L2[k + s])
            if (
                state.element_flag[k] & ERODED
                or most1 <= window_kernels.COVERED
                or most2 <= window_kernels.COVERED
            ):
                continue
            if not state.element_flag[k] & WINDOW:
                state.element_flag[k] |= WINDOW
                state.counter[FAILURES] += 1
            if min(L1[k], L1[k + one]) > wide1 and min(L2[k], L2[k + s]) > wide2:
                state.element_flag[k] |= ERODED


@kernel(_nrt=False)
def new_tails(state, const, slip):
    """Give the yarn of the segments that have failed in this step to the nodes beside them, half each."""
    s = const.row_stride
    for family in range(2):
        near, far = slip.tail[family]
        for k in range(
            np.uint64(state.active_rows[0] * s), np.uint64((state.active_rows[1] + 1) * s)
        ):
            if state.failed[family][k] != 0 and slip.removed[family][k] == 0:
                slip.removed[family][k] = REMOVED_NOW
                slip.counter[TAILS] += 1
                near[k + np.uint64(s)] = far[k + np.uint64(s)] = 0.5 * slip.share[family][k]


@kernel(_nrt=False)
def release_tails(state, const, slip):
    """Let the yarns whose tails are used up leave their nodes: the segments before these become tails."""
    s = const.row_stride
    slip.counter[EMPTIED] = 0
    for family in range(2):
        near, far = slip.tail[family]
        step = s if family == WARP else 1
        rows = const.ni if family == WARP else const.ni + 1
        columns = s if family == WARP else const.nj
        for i in range(rows):
            for j in range(columns):
                k = i * s + j
                if state.intact_fraction[family][np.uint64(k)] == 0.0:
                    continue
                # the segment's far node is left where the tail behind that is used up, its near node likewise
                behind, ahead = np.uint64(k + step + s), np.uint64(k - step + s)
                gone = near[behind] < 0.0
                if gone or far[ahead] < 0.0:
                    slot = np.uint64(k + s)
                    near[slot] = slip.share[family][np.uint64(k)] + near[behind] if gone else 0.0
                    far[slot] = 0.0 if gone else slip.share[family][np.uint64(k)] + far[ahead]
                    near[behind] = 0.0 if gone else near[behind]
                    far[ahead] = far[ahead] if gone else 0.0
                    pull_out(state, const, slip, family, i, j)
