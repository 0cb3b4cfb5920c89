"""A C1 surface near a structured grid of nodes, whose every cell hands each of its corners the same share.
Along each direction it is the mean of the Catmull-Rom and the uniform cubic B-spline of the nodes: with t
in 0 .. 1 between the two middle nodes of four,

    12 w = 1 - 6 t + 9 t^2 - 4 t^3,  10 - 21 t^2 + 12 t^3,  1 + 6 t + 15 t^2 - 12 t^3,  - 3 t^2 + 4 t^3.

These integrate over the cell to 0, 1/2, 1/2, 0, as linear shape functions do: of all C1 cubics on four
nodes the one on which a uniform pressure loads the nodes as it loads bricks, at edges too, so that a patch
test can be passed (Catmull-Rom alone takes a twelfth of a cell's load from each edge). It lies off the
nodes by h^2 curvature / 12. Beyond an edge stands a phantom row, the mirror image on a symmetry plane, the
straight continuation elsewhere, folded back into weights of the real nodes.
"""

from __future__ import annotations

import numpy as np

from fabrics.base.kernel_cache import kernel

PROJECTION_STEPS = 30
SETTLED = 1e-11  # of a cell


@kernel()
def cubics(t, w):
    """Fill `w` : (3, 4) with the weights of the four nodes and their two derivatives."""
    w[0, 0] = (1 - 6 * t + 9 * t * t - 4 * t**3) / 12
    w[0, 1] = (10 - 21 * t * t + 12 * t**3) / 12
    w[0, 2] = (1 + 6 * t + 15 * t * t - 12 * t**3) / 12
    w[0, 3] = (-3 * t * t + 4 * t**3) / 12
    w[1, 0] = (-6 + 18 * t - 12 * t * t) / 12
    w[1, 1] = (-42 * t + 36 * t * t) / 12
    w[1, 2] = (6 + 30 * t - 36 * t * t) / 12
    w[1, 3] = (-6 * t + 12 * t * t) / 12
    w[2, 0] = (18 - 24 * t) / 12
    w[2, 1] = (-42 + 72 * t) / 12
    w[2, 2] = (30 - 72 * t) / 12
    w[2, 3] = (-6 + 24 * t) / 12


@kernel()
def cell_of(xi, cells):
    """Return the number of the cell that holds the parameter `xi`, 0 .. cells; the nearest one
    beyond the grid."""
    return min(max(int(np.floor(xi)), 0), cells - 1)


@kernel()
def surround(x, grid, axes, mirror, ringed):
    """Copy the positions of the grid's nodes with a phantom row around.

    Parameters
    ----------
    x : (n, 3) [m]
    grid : (ni, nj) node numbers
    axes : (2,) component (0 x, 1 y) that changes sign in the mirror of i = 0 and of j = 0
    mirror : (2,) whether i = 0 and j = 0 are symmetry planes
    ringed : (ni + 2, nj + 2, 3) filled
    """
    ni, nj = grid.shape
    for i in range(ni):
        for j in range(nj):
            ringed[i + 1, j + 1] = x[grid[i, j]]
    for i in range(1, ni + 1):
        if mirror[1]:
            ringed[i, 0] = ringed[i, 2]
            ringed[i, 0, axes[1]] *= -1.0
        else:
            ringed[i, 0] = 2 * ringed[i, 1] - ringed[i, 2]
        ringed[i, nj + 1] = 2 * ringed[i, nj] - ringed[i, nj - 1]
    for j in range(nj + 2):
        if mirror[0]:
            ringed[0, j] = ringed[2, j]
            ringed[0, j, axes[0]] *= -1.0
        else:
            ringed[0, j] = 2 * ringed[1, j] - ringed[2, j]
        ringed[ni + 1, j] = 2 * ringed[ni, j] - ringed[ni - 1, j]


@kernel(fastmath={"contract", "reassoc", "nsz"})
def evaluate(ringed, xi, a, b, surface):
    """Fill `surface` : (6, 3) with S, S_,1, S_,2, S_,11, S_,12, S_,22 at `xi` : (2,).

    ringed : as `surround` fills it;  a, b : (3, 4) scratch
    """
    i = cell_of(xi[0], ringed.shape[0] - 3)
    j = cell_of(xi[1], ringed.shape[1] - 3)
    cubics(xi[0] - i, a)
    cubics(xi[1] - j, b)
    for c in range(3):
        s0 = s1 = s2 = s11 = s12 = s22 = 0.0
        for m in range(4):
            r0 = r1 = r2 = 0.0
            for n in range(4):
                z = ringed[i + m, j + n, c]
                r0 += b[0, n] * z
                r1 += b[1, n] * z
                r2 += b[2, n] * z
            s0 += a[0, m] * r0
            s1 += a[1, m] * r0
            s11 += a[2, m] * r0
            s2 += a[0, m] * r1
            s12 += a[1, m] * r1
            s22 += a[0, m] * r2
        surface[0, c] = s0
        surface[1, c] = s1
        surface[2, c] = s2
        surface[3, c] = s11
        surface[4, c] = s12
        surface[5, c] = s22


@kernel()
def folded(t, cell, cells, mirror_low, even, odd):
    """Fill in the weights of the four nodes and their first derivatives, the phantoms folded back.

    Parameters
    ----------
    t, cell, cells : place within the cell, its number, number of cells along this direction
    mirror_low : the row 0 lies on a symmetry plane
    even, odd : (3, 4) filled: weights of components that keep or change sign in the mirror
    """
    cubics(t, even)
    odd[:] = even
    for order in range(2):
        if cell == 0:
            phantom = even[order, 0]
            even[order, 0] = 0.0
            odd[order, 0] = 0.0
            if mirror_low:
                even[order, 2] += phantom
                odd[order, 2] -= phantom
            else:
                even[order, 1] += 2 * phantom
                even[order, 2] -= phantom
                odd[order, 1] += 2 * phantom
                odd[order, 2] -= phantom
        if cell == cells - 1:
            for weights in (even, odd):
                phantom = weights[order, 3]
                weights[order, 3] = 0.0
                weights[order, 2] += 2 * phantom
                weights[order, 1] -= phantom


@kernel()
def nodes_of(grid, i, j, nodes):
    """Fill `nodes` : (16,) with those that shape the cell i, j; phantoms stand for their
    neighbours."""
    ni, nj = grid.shape
    for m in range(4):
        for n in range(4):
            nodes[4 * m + n] = grid[min(max(i - 1 + m, 0), ni - 1), min(max(j - 1 + n, 0), nj - 1)]


@kernel()
def weights_of(xi, grid, axes, mirror, weights, work):
    """Fill `weights` : (3, 16, 3) with S, S_,1, S_,2 at `xi` as weights of the nodes of its cell
    and components.

    work : (4, 3, 4) scratch
    """
    ni, nj = grid.shape
    i = cell_of(xi[0], ni - 1)
    j = cell_of(xi[1], nj - 1)
    folded(xi[0] - i, i, ni - 1, mirror[0], work[0], work[1])
    folded(xi[1] - j, j, nj - 1, mirror[1], work[2], work[3])
    for c in range(3):
        along = work[1] if c == axes[0] else work[0]
        across = work[3] if c == axes[1] else work[2]
        for m in range(4):
            for n in range(4):
                weights[0, 4 * m + n, c] = along[0, m] * across[0, n]
                weights[1, 4 * m + n, c] = along[1, m] * across[0, n]
                weights[2, 4 * m + n, c] = along[0, m] * across[1, n]


@kernel()
def dot(a, b):
    """Compute the scalar product of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel()
def project(point, ringed, xi, a, b, surface):
    """Find the closest point of the surface by Newton's method from the guess `xi` : (2,), which is
    overwritten.

    ringed, a, b, surface : as for `evaluate`; `surface` belongs to the point found

    Returns
    -------
    found : False where the iteration does not settle or leaves the grid by a cell
    """
    ni = ringed.shape[0] - 2
    nj = ringed.shape[1] - 2
    for _ in range(PROJECTION_STEPS):
        evaluate(ringed, xi, a, b, surface)
        away = point - surface[0]
        s1 = surface[1]
        s2 = surface[2]
        r1 = dot(away, s1)
        r2 = dot(away, s2)
        m11 = dot(s1, s1)
        m12 = dot(s1, s2)
        m22 = dot(s2, s2)
        h11 = m11 - dot(away, surface[3])
        h12 = m12 - dot(away, surface[4])
        h22 = m22 - dot(away, surface[5])
        determinant = h11 * h22 - h12 * h12
        if not (h11 > 0.0 and determinant > 0.0):  # not convex here: Gauss-Newton instead
            h11 = m11
            h12 = m12
            h22 = m22
            determinant = h11 * h22 - h12 * h12
        if not determinant > 0.0:
            return False
        d1 = (h22 * r1 - h12 * r2) / determinant
        d2 = (h11 * r2 - h12 * r1) / determinant
        largest = max(abs(d1), abs(d2))
        if largest < SETTLED:
            return -1.0 < xi[0] < ni and -1.0 < xi[1] < nj
        if not largest <= 1.0:
            d1 = d1 / largest
            d2 = d2 / largest
        xi[0] = min(max(xi[0] + d1, -1.5), ni + 0.5)
        xi[1] = min(max(xi[1] + d2, -1.5), nj + 0.5)
    return False
