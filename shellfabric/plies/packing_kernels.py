"""Fabric keeps the area of its packed yarns.

A membrane of yarns has no stiffness in compression. Where it is torn, or free, nothing holds its elements open: they
contract to points, which press with all of their area on one node of another ply, and whose closest points jump about
on it, so that the contact gives out energy that it never took. Real yarns do not contract: they lie side by side. An
element that is still fabric, of the area A (A0 at rest), stores

    U = A0 P (s - A / A0)^2 / 2 s     where A < s A0,     P = E_c t_s

with the stiffness of solid fibre across its axis, in a sheet as thick as the fibre of the ply is (`Pack`), and the share
s = PACKED. A is half the length of the cross product of the diagonals; the forces are the gradient of U, so that their
sum and their moments vanish. Their stiffness is less than that of the yarns by E_c over E: no step is shorter for it.
"""

import math

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import greater, load, movemask, sqrt
from shellfabric.plies.frame_kernels import BEHIND, STRIDE, extend_window
from shellfabric.plies.near_kernels import tile_bounds
from shellfabric.plies.separation_kernels import cross, difference, dot

PACKED = 0.5  # share of its area at rest that packed fabric has


@kernel(_nrt=False)
def hold_area(contact, p):
    """The forces of all elements of ply p that are smaller than packed fabric."""
    s = contact.shape[p, STRIDE]
    for t in range(contact.first_tile[p], contact.first_tile[p + 1]):
        if contact.way[t] == 0.0:
            continue
        _, i0, i1, j0, j1 = tile_bounds(contact, t)
        for i in range(i0, i1):
            g = contact.base[p] + i * s + j0
            small = movemask(
                greater(PACKED * diagonals8(contact.rest, g, s), diagonals8(contact.x, g, s))
            )
            for lane in range(j1 - j0 if small else 0):
                if small >> lane & 1 and not contact.dropped[g + lane]:
                    hold_element(contact, p, g + lane, s)
                    extend_window(
                        contact.grid_window[p, BEHIND], i, i + 2, j0 + lane, j0 + lane + 2
                    )


@kernel(_nrt=False, forceinline=True)
def hold_element(contact, p, g, s):
    """The forces of the element with the first node g."""
    x, rest, k = contact.x, contact.rest, g - p * contact.slots
    u, v = difference(x, g, g + s + 1), difference(x, g + s, g + 1)
    n, m = cross(u, v), cross(difference(rest, g, g + s + 1), difference(rest, g + s, g + 1))
    size, full = math.sqrt(dot(n, n)), math.sqrt(dot(m, m))
    if not size > 1e-9 * full:
        return
    push = contact.packing[p] * (0.5 - 0.5 * size / full / PACKED) / size
    along_u, along_v, f = cross(v, n), cross(n, u), contact.f[p, BEHIND]
    for c in range(3):
        f[c, k + s + 1] += push * along_u[c]
        f[c, k] -= push * along_u[c]
        f[c, k + 1] += push * along_v[c]
        f[c, k + s] -= push * along_v[c]


@kernel(_nrt=False, forceinline=True)
def diagonals8(x, k, s):
    """Sizes [m^2] of the products of the diagonals of the eight elements from slot k on, twice their areas."""
    n = cross(difference8(x, k, k + s + 1), difference8(x, k + s, k + 1))
    return sqrt(dot(n, n))


@kernel(_nrt=False, forceinline=True)
def difference8(x, a, b):
    """The vectors from the eight nodes from slot a on to those from b on."""
    return (
        load(x[0], b) - load(x[0], a),
        load(x[1], b) - load(x[1], a),
        load(x[2], b) - load(x[2], a),
    )
