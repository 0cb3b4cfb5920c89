"""Fibre bars on the mesh edges along a yarn: two-node bars that carry tension (thesis section
3.4.1, App. B.1).

    strain e = l / L - 1,    force N = E A s(e)      (eq. 4-7: nominal, so that T = E A_s e for a whole yarn)

with s(e) of `fabrics.yarn_stress_kernels.fibre_law`.

The bars lie on the crimped path, so their strain is strain beyond crimp and failure needs no
correction (erratum E-18).
"""

from __future__ import annotations

import numpy as np

from fabrics import yarn_stress_kernels
from fabrics.base.kernel_cache import kernel

fibre_law = kernel()(yarn_stress_kernels.fibre_law)


@kernel()
def bar_strains(x, pairs, length, strain):
    """Compute the engineering strain of each bar.

    Parameters
    ----------
    x : (n, 3) [m] current positions
    pairs : (b, 2) node numbers
    length : (b,) [m] undeformed
    strain : (b,) filled
    """
    for bar in range(pairs.shape[0]):
        p, q = pairs[bar]
        square = 0.0
        for c in range(3):
            square += (x[q, c] - x[p, c]) ** 2
        strain[bar] = np.sqrt(square) / length[bar] - 1.0


@kernel()
def bar_forces(x, pairs, length, stiffness, compression, width, forces):
    """Add the internal forces of the bars.

    Parameters
    ----------
    x : (n, 3) [m]
    pairs : (b, 2)
    length : (b,) [m]
    stiffness : (b,) [N] E A
    compression, width : [-] r and d of the law
    forces : (n, 3) [N] added to
    """
    for bar in range(pairs.shape[0]):
        p, q = pairs[bar]
        edge = x[q] - x[p]
        current = np.sqrt(edge[0] ** 2 + edge[1] ** 2 + edge[2] ** 2)
        value, _ = fibre_law(current / length[bar] - 1.0, compression, width)
        for c in range(3):
            pull = stiffness[bar] * value * edge[c] / current
            forces[p, c] -= pull
            forces[q, c] += pull


@kernel()
def bar_tangent(x, pairs, length, stiffness, compression, width, places, values):
    """Add the tangent of the bars: N'/L t t^T + N/l (I - t t^T).

    Parameters
    ----------
    x, pairs, length, stiffness, compression, width : as for `bar_forces`
    places : (b, 2, 2) block of `values` for each pair of end nodes
    values : (k, 3, 3) [N/m] blocks, added to
    """
    for bar in range(pairs.shape[0]):
        p, q = pairs[bar]
        edge = x[q] - x[p]
        current = np.sqrt(edge[0] ** 2 + edge[1] ** 2 + edge[2] ** 2)
        value, slope = fibre_law(current / length[bar] - 1.0, compression, width)
        axial = stiffness[bar] * slope / length[bar]
        across = stiffness[bar] * value / current
        for a in range(3):
            for b in range(3):
                k = (axial - across) * edge[a] * edge[b] / current**2
                if a == b:
                    k += across
                values[places[bar, 0, 0], a, b] += k
                values[places[bar, 1, 1], a, b] += k
                values[places[bar, 0, 1], a, b] -= k
                values[places[bar, 1, 0], a, b] -= k
