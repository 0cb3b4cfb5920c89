"""Energies of an audit: of motion, and of what yarns and trellis store, broken or not
(`membrane_kernels`).

    yarn     E = n (kappa W / 2 + (1 - kappa) U_alone)      of an edge, n = y / 2 w the crossovers that it stands for
    trellis  E = alpha V U(gamma)                           of a quadrilateral

An audit looks at all of the fabric, and most of it is whole: there kappa and alpha are one, and
means plain ones.
"""

import numpy as np

from shellfabric.cell.crossover_kernels import yarn_alone
from shellfabric.cloth.damage_kernels import (
    edges_in_row,
    sum_crossing,
    trellis_intact_fraction,
    yarn_properties,
)
from shellfabric.cloth.membrane_kernels import INTACT, ONE, WARP, WEFT
from shellfabric.cloth.table_kernels import potential
from shellfabric.cloth.trellis_kernels import regularized_stretch_scalar, shear_energy
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import item_or_scalar
from shellfabric.state import unit


@unit("number")
def kinetic_energy(const, state, i):
    """[J] kinetic energy of the free nodes of row i, m v(n-1/2) v(n+1/2) / 2."""
    found = 0.0
    for j in range(const.row_stride):
        k = np.uint64(i * const.row_stride + j)
        inverse = state.inverse_mass[k]
        if inverse == 0.0:  # held
            continue
        for c in range(3):
            v = state.v[c][k]
            f = state.f_int[c][k] + state.f_int_above[c][k] + state.f_contact[c][k]
            if const.has_backing:
                f += state.f_block_cloth[c][k]
            found += 0.5 * state.mass[k] * v * (v + const.dt * inverse * f)
    return found


@unit("2 numbers")
def stored_energy(const, state, first, last):
    """(energy of the yarns, of the trellis) [J] of the element rows first .. last - 1 and the weft
    at their far end.

    From the stretches alone. In the equilibrium form, whose forces are no gradient, it is what the
    cells store.
    """
    yarns = 0.0
    trellis = 0.0
    for i in range(first, last):
        whole = row_intact(const, state, i)
        inner = whole and i > 0
        yarns += row_energy(const, state, WARP, i, whole)
        yarns += row_energy(const, state, WEFT, i, inner)
        trellis += trellis_energy(const, state, i, whole)
    # the last row of weft edges may be the rim of the panel
    inner = row_intact(const, state, last) and 0 < last < const.ni
    return yarns + row_energy(const, state, WEFT, last, inner), trellis


@kernel(_nrt=False)
def row_intact(const, state, i):
    """Whether no failed yarn has a part in the energy of row i."""
    return state.block_damage[min(i, const.ni - 1) // const.rows_per_block] == INTACT


@unit("number", whole="flag")
def row_energy(const, state, family, i, whole):
    """[J] of the edges (i, 0), (i, 1), ... of a family. whole : none has failed, nor the four that
    cross each; of warp edges but for those at the ends of the row, which two cross."""
    s = const.row_stride
    found = 0.0
    for j in range(edges_in_row(const, family)):
        k = np.uint64(i * s + j)
        length = state.yarn_length[family][k]
        if length == 0.0:  # failed
            continue
        if whole and (family == WEFT or 0 < j < const.nj):
            per_length = cell_energy(
                const, state, family, k, mean_crossing(const, state, family, k)
            )
        else:
            per_length = edge_energy(const, state, family, i, j)
        found += length * per_length
    return found


@kernel(_nrt=False)
def mean_crossing(const, state, family, k):
    """Mean stretch of the four edges that cross the edge at slot k."""
    s = np.uint64(const.row_stride)
    other = state.stretch[1 - family]
    if family == WARP:
        before = item_or_scalar(const.mean_weight2, k)
        lines_before = other[k - ONE] + other[k + s - ONE]
        lines_behind = other[k] + other[k + s]
    else:
        before = item_or_scalar(const.mean_weight1, k)
        lines_before = other[k - s] + other[k - s + ONE]
        lines_behind = other[k] + other[k + ONE]
    return 0.5 * (before * lines_before + (1.0 - before) * lines_behind)


@kernel(_nrt=False)
def cell_energy(const, state, family, k, mean):
    """[J/m] of crossed yarn of the edge at slot k, whose crossing edges have a mean stretch: W / 4
    w."""
    own = state.stretch[family][k]
    l1 = own
    l2 = mean
    w = const.w1
    if family == WEFT:
        l1 = mean
        l2 = own
        w = const.w2
    W = potential(
        l1,
        l2,
        const.table_grid,
        const.potential_coefficients,
        const.table_beyond,
        const.potential_constant,
    )
    return 0.25 / w * W


@kernel(_nrt=False)
def edge_energy(const, state, family, i, j):
    """[J/m] of yarn of the edge (i, j), where yarns that cross it may have failed."""
    k = np.uint64(i * const.row_stride + j)
    other = 1 - family
    intact = state.intact_fraction[other]
    count, present, total = sum_crossing(const, family, i, j, intact, state.stretch[other], 0)
    crossed = present / count
    found = 0.0
    if crossed > 0.0:
        found += crossed * cell_energy(const, state, family, k, total / present)
    if crossed < 1.0:
        w, S0, EA = yarn_properties(const, family)
        alone = yarn_alone(state.stretch[family][k], w, S0, EA)[1]
        found += (1.0 - crossed) / (2.0 * w) * alone
    return found


@unit("number", whole="flag")
def trellis_energy(const, state, i, whole):
    """[J] of the quadrilaterals of row i. whole : no yarn beside them has failed."""
    found = 0.0
    for j in range(const.nj):
        k = np.uint64(i * const.row_stride + j)
        if whole:
            left = 1.0
        else:
            left = trellis_intact_fraction(const, state, k)
        if left > 0.0:
            sine = shear_sine(const, state, k)
            V = item_or_scalar(const.trellis_volume, k)
            found += left * shear_energy(sine, V, const.G1, const.G2, const.gamma1, const.gamma2)
    return found


@kernel(_nrt=False)
def shear_sine(const, state, k):
    """sin(gamma) of the quadrilateral in slot k, as `trellis_kernels.trellis_forces` has it."""
    s = np.uint64(const.row_stride)
    dot = 0.0
    for c in range(3):
        u = state.u[c]
        rise = u[k + s + ONE] - u[k]
        run = u[k + s] - u[k + ONE]
        a = item_or_scalar(const.inv_dx, k) * (rise + run)
        b = item_or_scalar(const.inv_dy, k) * (rise - run)
        if c == 0:
            a += 2.0
        if c == 1:
            b += 2.0
        dot += a * b
    L1, L2 = state.stretch
    f1 = regularized_stretch_scalar(L1[k] + L1[k + ONE])
    f2 = regularized_stretch_scalar(L2[k] + L2[k + s])
    return dot / (f1 * f2)
