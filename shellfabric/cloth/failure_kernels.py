"""Failure of yarns: criterion, removal and energies. Forces of damaged elements: `damage_kernels`.

What fails is a segment of a yarn between two crossovers. Where elements are shorter than a crossover a yarn has several
lines: its axis, and the lines between it and the axes of its two neighbours, whose fabric both share in proportion to
the distance from the other's axis (`panel.grading.YarnLines`). Its tension is the mean over these lines by these
shares, the shape function of a yarn's line on a mesh of one element a crossover: the same quantity on every mesh. It is
compared with the strength as it is, or low-passed over a time tau:

    dT_f/dt = (T - T_f) / tau

The strength is that of the yarn, or follows the strain rate (`strength_kernels`).

A failed segment is gone for good, its mass stays. Its crossing yarns lose the contact with it: see `membrane_kernels`
for alpha and kappa. What it stored is booked as lost, with the half step in which its old force has acted.
"""

import numpy as np

from shellfabric.cell.crossover_kernels import yarn_alone
from shellfabric.cloth import energy_kernels, strength_kernels
from shellfabric.cloth.damage_kernels import WARP, WEFT, sum_crossing, trellis_intact_fraction, yarn_properties
from shellfabric.cloth.membrane_kernels import ONE, WARP_FAILED, WEFT_FAILED
from shellfabric.cloth.table_kernels import potential
from shellfabric.cloth.trellis_kernels import regularized_stretch_scalar, shear_energy
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import item_or_scalar

ROUNDING = 1e-9  # of an intact fraction: less is nothing


@kernel(_nrt=False)
def lines_of_yarn(along, axis):
    """(first, last) of the lines of which a part belongs to the yarn whose axis is line `axis`."""
    first, last = axis, axis
    while first > 0 and along.yarn[first - 1] < 0:
        first -= 1
    while last + 1 < along.yarn.size and along.yarn[last + 1] < 0:
        last += 1
    return first, last


@kernel(_nrt=False)
def line_share(along, line, axis):
    """Share of a line that belongs to the yarn whose axis is line `axis`."""
    return 1.0 - along.share[line] if line < axis else along.share[line]


@kernel(_nrt=False)
def yarn_tension(const, tension, family, row, column):
    """Tension of the yarn segment that begins at node (row, column): mean over its length and its lines' shares of that
    of edges, such as state.T[family]."""
    if family == WARP:
        along, across = const.yarn_columns, const.yarn_rows
    else:
        along, across = const.yarn_rows, const.yarn_columns
    axis, start = (column, row) if family == WARP else (row, column)
    first, last = lines_of_yarn(along, axis)
    total, weight = 0.0, 0.0
    for line in range(first, last + 1):
        share = line_share(along, line, axis) * along.width[line]
        for place in range(start, start + across.elements[start]):
            part = share * across.side[place]
            i, j = (place, line) if family == WARP else (line, place)
            total += part * tension[np.uint64(i * const.row_stride + j)]
            weight += part
    return total / weight


@kernel(_nrt=False)
def yarn_strength(const, family, row, column):
    """Strength of the yarn whose axis runs through node (row, column)."""
    if family == WARP:
        return const.yarn_strengths1[const.yarn_columns.yarn[column]]
    return const.yarn_strengths2[const.yarn_rows.yarn[row]]


@kernel(_nrt=False)
def loading(const, state, family, row, column, T):
    """(load, damage after this step) of the segment of tension T from node (row, column) on: the load is the tension
    over the strength of the yarn, the damage 0 without a law of rates."""
    load, k = T / yarn_strength(const, family, row, column), np.uint64(row * const.row_stride + column)
    return load, strength_kernels.damage(const.rate_law, family, const.dt, state.rate_damage[family], k, load)


@kernel(_nrt=False)
def is_past(const, load, damage):
    """Whether a segment fails at a load and a damage, as `loading` gives them."""
    return load > strength_kernels.highest_load(const.rate_law) or damage >= 1.0


@kernel(_nrt=False)
def begins_segment(const, i, j):
    """Whether segments of yarns begin at node (i, j), where the axes of a warp and of a weft yarn cross."""
    return const.yarn_rows.yarn[i] >= 0 and const.yarn_columns.yarn[j] >= 0


@kernel(_nrt=False)
def any_past_strength(const, state, family, first, last):
    """Whether a yarn segment that begins in the node rows first .. last exceeds its yarn's strength."""
    rows = last - 1 if family == WARP else last
    columns = const.nj if family == WARP else const.nj - 1
    for i in range(first, rows + 1):
        for j in range(0, columns + 1):
            whole = begins_segment(const, i, j) and not state.failed[family][np.uint64(i * const.row_stride + j)]
            if whole:
                T = yarn_tension(const, state.T[family], family, i, j)
                load, damage = loading(const, state, family, i, j, T)
                if T > 0.0 and is_past(const, load, damage):
                    return True
    return False


@kernel(_nrt=False)
def filter_tensions(const, state):
    """Low-pass the tensions of all edges of the active rows; means of them are then those of filtered tensions."""
    first, last = state.active_rows[0] * const.row_stride, (state.active_rows[1] + 1) * const.row_stride
    for family in range(2):
        slow, tension = state.filtered_tension[family], state.T[family]
        for k in range(np.uint64(first), np.uint64(last)):
            slow[k] += const.filter_alpha * (tension[k] - slow[k])


@kernel(_nrt=False)
def detect_failures(const, state, family, first, last):
    """Break the yarn segments that exceed their strength, among those that begin in the node rows first .. last.

    Where const.filter_alpha > 0 the filtered tension counts. Keeps the peak with its segment and step. Returns how many
    have failed.
    """
    failures = 0
    # a segment of one edge that is below the peak and the lowest strength needs no closer look
    lowest = const.min_strength1 if family == WARP else const.min_strength2
    single = const.n_per_crossover == 1 and const.filter_alpha == 0.0
    bound = min(state.peak_tension[family], lowest) if single else -1.0
    rows = last - 1 if family == WARP else last
    columns = const.nj if family == WARP else const.nj - 1
    for i in range(first, rows + 1):
        for j in range(0, columns + 1):
            k = np.uint64(i * const.row_stride + j)
            if state.T[family][k] <= bound or state.failed[family][k] or not begins_segment(const, i, j):
                continue
            T = yarn_tension(const, state.T[family], family, i, j)
            if T > state.peak_tension[family]:
                state.peak_segment[family, 0], state.peak_segment[family, 1] = k, state.counter[0] + 1
            state.peak_tension[family] = max(state.peak_tension[family], T)
            if const.filter_alpha > 0.0:
                T = yarn_tension(const, state.filtered_tension[family], family, i, j)
            if T <= lowest:
                continue
            load, damage = loading(const, state, family, i, j, T)
            strength_kernels.keep_damage(const.rate_law, state.rate_damage[family], k, damage)
            if is_past(const, load, damage):
                state.failure_sums[0] += 1.0
                state.failure_sums[1] += load
                state.failed[family][k] = 1
                break_segment(const, state, family, i, j)
                failures += 1
    return failures


@kernel(_nrt=False)
def break_segment(const, state, family, row, column):
    """Break the yarn segment that begins at node (row, column): reduce its edges' intact fraction and yarn length."""
    if family == WARP:
        along, across = const.yarn_columns, const.yarn_rows
    else:
        along, across = const.yarn_rows, const.yarn_columns
    axis, start = (column, row) if family == WARP else (row, column)
    first, last = lines_of_yarn(along, axis)
    for line in range(first, last + 1):
        share = line_share(along, line, axis)
        for place in range(start, start + across.elements[start]):
            i, j = (place, line) if family == WARP else (line, place)
            k = np.uint64(i * const.row_stride + j)
            before = state.intact_fraction[family][k]
            # the shares of all yarns of a line add up to one but for the last digit
            after = before - share if before - share > ROUNDING else 0.0
            state.intact_fraction[family][k] = after
            state.yarn_length[family][k] *= after / before
            flag_elements(const, state, family, i, j)


@kernel(_nrt=False)
def flag_elements(const, state, family, i, j):
    """Set the damage flags of the elements beside a failed edge, and of the blocks whose forces depend on it."""
    bit = WARP_FAILED if family == WARP else WEFT_FAILED
    for side in range(2):
        p, q = (i, j - side) if family == WARP else (i - side, j)
        if 0 <= p < const.ni and 0 <= q < const.nj:
            state.element_flag[np.uint64(p * const.row_stride + q)] |= bit
    for row in range(max(i - 2, 0), min(i + 2, const.ni - 1) + 1):
        state.block_damage[row // const.rows_per_block] = 2


@kernel(_nrt=False)
def stored_energy(const, state, first, last):
    """(energy of the yarns, of the trellis) of the element rows first .. last - 1 and the weft at their far end.

    From the stretches alone. In the equilibrium form, whose forces are no gradient, it is what the cells store.
    """
    cells, trellis = 0.0, 0.0
    for family in range(2):
        for i in range(first, last if family == WARP else last + 1):
            lines = const.row_stride if family == WARP else const.nj
            begin, end = lines, lines  # of what is whole, and has four crossing edges
            if row_intact(const, state, i) and family == WARP:
                begin, end = 1, const.nj
            elif row_intact(const, state, i) and 0 < i < const.ni:
                begin, end = 0, const.nj
            for j in range(begin):
                cells += edge_energy(const, state, family, i, j)
            for j in range(end, lines):
                cells += edge_energy(const, state, family, i, j)
            cells += energy_kernels.yarn_energy(const, state, family, i, begin, end)
    for i in range(first, last):
        if row_intact(const, state, i):
            trellis += energy_kernels.trellis_energy(const, state, i)
            continue
        for j in range(const.nj):
            k = np.uint64(i * const.row_stride + j)
            left = trellis_intact_fraction(const, state, k)
            if left > 0.0:
                sine = shear_sine(const, state, k)
                V = item_or_scalar(const.trellis_volume, k)
                trellis += left * shear_energy(sine, V, const.G1, const.G2, const.gamma1, const.gamma2)
    return cells, trellis


@kernel(_nrt=False)
def row_intact(const, state, i):
    """Whether no failed yarn has a part in the energy of row i."""
    return state.block_damage[min(i, const.ni - 1) // const.rows_per_block] == 0


@kernel(_nrt=False)
def edge_energy(const, state, family, i, j):
    """[J] of the edge (i, j), of which yarns may have failed, as those that cross it may."""
    w, S0, EA = yarn_properties(const, family)
    k = np.uint64(i * const.row_stride + j)
    y = state.yarn_length[family][k]
    if y == 0.0:
        return 0.0
    L = state.stretch[family][k]
    other = 1 - family
    count, present, total = sum_crossing(const, family, i, j, state.intact_fraction[other], state.stretch[other], 0)
    crossed, found = present / count, 0.0
    if crossed > 0.0:
        pair = (L, total / present) if family == WARP else (total / present, L)
        W = potential(
            *pair, const.table_grid, const.potential_coefficients, const.table_beyond, const.potential_constant
        )  # fmt: skip
        found += 0.5 * y / (2.0 * w) * crossed * W
    if crossed < 1.0:
        found += y / (2.0 * w) * (1.0 - crossed) * yarn_alone(L, w, S0, EA)[1]
    return found


@kernel()
def half_step_work(const, state, first, last):
    """Half of the present forces times the last changes of stretch: (of the yarns, viscous), in the same rows."""
    work, viscous = 0.0, 0.0
    for family in range(2):
        cv = const.cv1 if family == WARP else const.cv2
        for i in range(first, last if family == WARP else last + 1):
            for j in range(const.row_stride):
                k = np.uint64(i * const.row_stride + j)
                d = state.dstretch[family][k]
                work += 0.5 * state.yarn_length[family][k] * state.N[family][k] * d
                viscous += 0.5 * state.yarn_length[family][k] * item_or_scalar(cv, k) * d * d
    return work, viscous


@kernel()
def shear_sine(const, state, k):
    """sin(gamma) of the quadrilateral in slot k, as `trellis_kernels.trellis_forces` has it."""
    s, L1, L2 = np.uint64(const.row_stride), state.stretch[WARP], state.stretch[WEFT]
    dot = 0.0
    for c in range(3):
        u = state.u[c]
        u00, u01, u10, u11 = u[k], u[k + ONE], u[k + s], u[k + s + ONE]
        a = item_or_scalar(const.inv_dx, k) * (u10 - u00 + u11 - u01) + (2.0 if c == 0 else 0.0)
        b = item_or_scalar(const.inv_dy, k) * (u01 - u00 + u11 - u10) + (2.0 if c == 1 else 0.0)
        dot += a * b
    return dot / (regularized_stretch_scalar(L1[k] + L1[k + ONE]) * regularized_stretch_scalar(L2[k] + L2[k + s]))
