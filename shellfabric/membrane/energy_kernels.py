"""Energies of an audit: of motion, and of what yarns and trellis store, broken or not
(`membrane_kernels`).

    yarn     E = n (kappa W / 2 + (1 - kappa) U_alone)      of an edge, n = y / 2 w the crossovers that it stands for
    trellis  E = alpha V U(gamma)                           of a quadrilateral
"""

import numpy as np

from shellfabric.cell.yarn_kernels import yarn_alone
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import item_or_scalar
from shellfabric.membrane.damage_kernels import trellis_intact_fraction, yarn_properties
from shellfabric.membrane.membrane_kernels import ONE
from shellfabric.membrane.table_kernels import potential
from shellfabric.membrane.trellis_kernels import regularized_stretch_scalar, shear_energy
from shellfabric.state import WARP, WEFT, unit


@unit("number")
def kinetic_energy(const, state, i):
    """Compute the kinetic energy [J] of the free nodes of row i, m v(n-1/2) v(n+1/2) / 2."""
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
    """Compute (energy of the yarns, of the trellis) [J] of the element rows first .. last - 1 and
    the weft at their far end.

    From the stretches alone. In the equilibrium form, whose forces are no gradient, it is what the
    cells store.
    """
    yarns = 0.0
    trellis = 0.0
    for i in range(first, last):
        yarns += row_energy(const, state, WARP, i) + row_energy(const, state, WEFT, i)
        trellis += trellis_energy(const, state, i)
    # the last row of weft edges may be the rim of the panel
    return yarns + row_energy(const, state, WEFT, last), trellis


@kernel()
def edges_in_row(const, family):
    """Return the number of edges of a family in a row of slots: the last slot has no weft edge."""
    if family == WARP:
        return const.row_stride
    return const.nj


@unit("number")
def row_energy(const, state, family, i):
    """Compute the energy [J] of the edges (i, 0), (i, 1), ... of a family."""
    w, S0, EA = yarn_properties(const, family)
    found = 0.0
    for j in range(edges_in_row(const, family)):
        k = np.uint64(i * const.row_stride + j)
        length = state.yarn_length[family][k]
        if length == 0.0:  # failed
            continue
        own = state.stretch[family][k]
        crossed, mean = crossing_edges(const, state, family, i, j)
        stored = 0.0
        if crossed > 0.0:
            stored += 0.5 * crossed * cell_energy(const, family, own, mean)
        if crossed < 1.0:
            stored += (1.0 - crossed) * yarn_alone(own, w, S0, EA)[1]
        found += length / (2.0 * w) * stored
    return found


@kernel(_nrt=False)
def crossing_edges(const, state, family, i, j):
    """Compute (crossed fraction kappa, mean stretch of what is left) of the edges that cross edge
    (i, j): four, or two at the ends of their lines."""
    s = const.row_stride
    intact = state.intact_fraction[1 - family]
    stretch = state.stretch[1 - family]
    split = const.mean_weight2
    back = 1
    far = s
    begins = j == 0
    ends = j == const.nj
    if family == WEFT:
        split = const.mean_weight1
        back = s
        far = 1
        begins = i == 0
        ends = i == const.ni
    crossed = 0.0
    total = 0.0
    for end in range(2):
        at = i * s + j + end * far
        before = item_or_scalar(split, np.uint64(at))
        if begins:
            before = 0.0
        if ends:
            before = 1.0
        for share in (1.0 - before, before):
            if share > 0.0:
                part = 0.5 * share * intact[np.uint64(at)]
                crossed += part
                total += part * stretch[np.uint64(at)]
            at -= back
    if crossed > 0.0:
        return crossed, total / crossed
    return 0.0, 1.0


@kernel(_nrt=False)
def cell_energy(const, family, own, mean):
    """Interpolate W [J] of a crossover of an edge, whose crossing edges have a mean stretch."""
    warp = own
    weft = mean
    if family == WEFT:
        warp = mean
        weft = own
    return potential(
        warp,
        weft,
        const.table_grid,
        const.potential_coefficients,
        const.table_beyond,
        const.potential_constant,
    )


@unit("number")
def trellis_energy(const, state, i):
    """Compute the energy [J] of the quadrilaterals of row i."""
    found = 0.0
    for j in range(const.nj):
        k = np.uint64(i * const.row_stride + j)
        left = trellis_intact_fraction(const, state, k)
        if left > 0.0:
            sine = shear_sine(const, state, k)
            V = item_or_scalar(const.trellis_volume, k)
            found += left * shear_energy(sine, V, const.G1, const.G2, const.gamma1, const.gamma2)
    return found


@kernel(_nrt=False)
def shear_sine(const, state, k):
    """Compute sin(gamma) of the quadrilateral in slot k, as `trellis_kernels.trellis_forces` has
    it."""
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
