"""Points of a chain of nodes.

A yarn is a chain of nodes x_k. Its middle line is their quadratic B-spline, continuous with its
tangent: at the index s, with k the nearest node and u = s - k,

    x(s) = (1/2 - u)^2 / 2 x_(k-1) + (3/4 - u^2) x_k + (1/2 + u)^2 / 2 x_(k+1)

A force at s goes to the three nodes by the same weights, so that force, moment and work are those
at the point.
"""

import numpy as np

from shellfabric.jit.compile import kernel
from shellfabric.surface.surface_kernels import quadratic_weights
from shellfabric.surface.vector_kernels import add, column, scaled

FIXED = (0.125, 0.75, 0.125)  # weights of a point at a node
ONE = np.uint64(1)  # numba asks of a signed index whether it is negative


@kernel(_nrt=False, forceinline=True)
def spline(s, count):
    """Compute (nearest inner node, its three weights, their slopes) at the index s of a chain of
    `count` nodes."""
    k = min(max(int(s + 0.5), 1), count - 2)
    u = s - k
    return k, quadratic_weights(u), (u - 0.5, -2.0 * u, u + 0.5)


@kernel(_nrt=False, forceinline=True)
def gather(x, n, weights):
    """Sum the nodes n - 1, n, n + 1 of x (3, nodes) times their weights."""
    n = np.uint64(n)
    return weighted(weights, (column(x, 0, n - ONE), column(x, 0, n), column(x, 0, n + ONE)))


@kernel(_nrt=False, forceinline=True)
def weighted(weights, vectors):
    """Sum three vectors, or eight times three, times their weights."""
    found = add(scaled(weights[0], vectors[0]), scaled(weights[1], vectors[1]))
    return add(found, scaled(weights[2], vectors[2]))


@kernel(_nrt=False, forceinline=True)
def scatter(f, n, weights, force):
    """Add a force to the nodes n - 1, n, n + 1 of f (3, nodes) by their weights."""
    n = np.uint64(n)
    for c in range(3):
        f[c, n - ONE] += weights[0] * force[c]
        f[c, n] += weights[1] * force[c]
        f[c, n + ONE] += weights[2] * force[c]
