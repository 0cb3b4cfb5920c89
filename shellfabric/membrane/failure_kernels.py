"""Failure of yarns: criterion, removal and energies (docs/theory-panel.md, "Failure of yarns"). Forces
of damaged elements: `damage_kernels`.

What fails is an edge, the piece of a grid line between two nodes. Each line breaks by itself, at one
place, where F > T_u: F follows M over the time t_f, and M is the mean of the tension across the
fibres, the exact integral over lines of constant tension (`membrane.failure.mean_weights`). Where
neither is above half of the strength F is half of it: fabric that is far from failure costs nothing.
The strength is that of the nearest yarn, or follows the strain rate (`criterion_kernels`). Yarns
that cross a broken edge lose the contact with it: see `membrane_kernels` for alpha and kappa. What
it stored is counted as lost, with the half step in which its old force has acted.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import item_or_scalar
from shellfabric.membrane import criterion_kernels
from shellfabric.membrane.energy_kernels import edges_in_row
from shellfabric.membrane.membrane_kernels import bounded_by_tension
from shellfabric.membrane.table_kernels import max_value
from shellfabric.state import REDO, WARP_FAILED, WEFT, WEFT_FAILED, unit


@kernel(_nrt=False)
def mean_tension(const, state, family, i, j):
    """Compute M [N] of the edge (i, j): see the module."""
    lines = const.warp_lines
    tension = state.T[family]
    intact = state.intact_fraction[family]
    line = j
    step = 1
    k = i * const.row_stride
    if family == WEFT:
        lines = const.weft_lines
        line = i
        step = const.row_stride
        k = j
    total = 0.0
    weight = 0.0
    for m in range(lines.weights.shape[1]):
        at = np.uint64(k + (lines.first[line] + m) * step)
        part = lines.weights[line, m] * intact[at]
        total += part * tension[at]
        weight += part
    return total / weight


@kernel(_nrt=False)
def may_fail(const, state, block):
    """Tell whether an edge of a block may break, follow a tension above half of its strength, or
    have a new peak tension."""
    most = state.block_max_tension[block]
    return (
        state.warm_blocks[block]
        or most[0] > min(state.peak_tension[0], const.half_strength1)
        or most[1] > min(state.peak_tension[1], const.half_strength2)
    )


@unit("integer")
def find_failures(const, state, family, first, last):
    """Let F of the edges of the node rows first .. last - 1 follow their M, and mark those that
    break in state.failed.

    Nothing is removed yet, so that what is found does not depend on an order. Keeps the peak with
    its edge and step. Returns how many edges break.
    """
    lines = const.warp_lines
    s = const.row_stride
    columns = const.nj + 1
    count = 0
    lowest = const.half_strength1
    stiffness = const.EA1
    if family == WEFT:
        stiffness = const.EA2
        lines = const.weft_lines
        columns = const.nj
        lowest = const.half_strength2
    tension = state.T[family]
    slow = state.filtered_tension[family]
    intact = state.intact_fraction[family]
    for i in range(first, last):
        watched = min(state.peak_tension[family], lowest)
        if not state.warm_rows[family, i] and max_value(i * s, columns, tension) <= watched:
            continue
        state.warm_rows[family, i] = False
        for j in range(columns):
            k = np.uint64(i * s + j)
            line = j
            place = i
            if family == WEFT:
                line = i
                place = j
            half = lines.half_strength[line]
            if intact[k] == 0.0 or (
                slow[k] <= half and tension[k] <= min(state.peak_tension[family], half)
            ):
                continue
            mean = mean_tension(const, state, family, i, j)
            slow[k] = criterion_kernels.follow_mean(slow[k], mean, half, lines.filter_factor[place])
            if min(mean, slow[k]) > state.peak_tension[family]:
                state.peak_tension[family] = min(mean, slow[k])
                state.peak_slot[family] = k
                state.peak_step[family] = state.steps + 1
            if slow[k] <= half:
                continue
            state.warm_rows[family, i] = True
            load = criterion_kernels.load_of(const.panel, slow[k], lines.strength[line], stiffness)
            if criterion_kernels.breaks(
                const.rate_law, family, const.dt, state.rate_damage[family], k, load
            ):
                state.failed_segments += 1.0
                state.loads_at_failure += load
                state.failed[family][k] = 1
                count += 1
    return count


@unit(later=True)
def break_edges(const, state, family, first, last):
    """Remove the yarn of the edges of the node rows first .. last that `find_failures` has
    marked."""
    end = min(last + 1, const.ni)
    if family == WEFT:
        end = min(last, const.ni) + 1
    for i in range(first, end):
        for j in range(edges_in_row(const, family)):
            k = np.uint64(i * const.row_stride + j)
            if state.failed[family][k] != 0 and state.intact_fraction[family][k] > 0.0:
                state.intact_fraction[family][k] = state.yarn_length[family][k] = 0.0
                flag_elements(const, state, family, i, j)


@kernel(_nrt=False)
def flag_elements(const, state, family, i, j):
    """Set the damage flags of the elements beside a failed edge, and of the blocks whose forces
    depend on it."""
    for side in range(2):
        bit = WARP_FAILED
        p = i
        q = j - side
        if family == WEFT:
            bit = WEFT_FAILED
            p = i - side
            q = j
        if 0 <= p < const.ni and 0 <= q < const.nj:
            state.element_flag[np.uint64(p * const.row_stride + q)] |= bit
    for row in range(max(i - 2, 0), min(i + 2, const.ni - 1) + 1):
        state.block_damage[row // const.rows_per_block] = REDO


@unit("2 numbers", later=True)
def half_step_work(const, state, first, last):
    """Compute half of the present forces times the last changes of stretch: (of the yarns,
    viscous), in the same rows."""
    work = 0.0
    viscous = 0.0
    for family in range(2):
        cv = const.cv1
        end = last
        if family == WEFT:
            cv = const.cv2
            end = last + 1
        for i in range(first, end):
            for j in range(const.row_stride):
                k = np.uint64(i * const.row_stride + j)
                d = state.dstretch[family][k]
                N = np.float64(state.N[family][k])
                part = 0.5 * state.yarn_length[family][k] * d
                work += part * N
                viscous += part * bounded_by_tension(item_or_scalar(cv, k) * d, N)
    return work, viscous
