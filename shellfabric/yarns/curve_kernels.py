"""Points of a chain of nodes.

A yarn is a chain of nodes x_k. Its middle line is their quadratic B-spline, continuous with its
tangent: at the index s, with k the nearest node and u = s - k,

    x(s) = (1/2 - u)^2 / 2 x_(k-1) + (3/4 - u^2) x_k + (1/2 + u)^2 / 2 x_(k+1)

A force at s goes to the three nodes by the same weights, so that force, moment and work are those at the point.
"""

from shellfabric.cloth.surface_kernels import quadratic_weights
from shellfabric.cloth.vector_kernels import add_scaled, scaled
from shellfabric.jit.compile import kernel


@kernel()
def row(x, n):
    """Row n of an array (nodes, 3)."""
    return x[n, 0], x[n, 1], x[n, 2]


@kernel()
def spline(s, count):
    """(nearest inner node, its three weights, their slopes) at the index s of a chain of `count` nodes."""
    k = min(max(int(s + 0.5), 1), count - 2)
    u = s - k
    return k, quadratic_weights(u), (u - 0.5, -2.0 * u, u + 0.5)


@kernel()
def gather(x, n, weights):
    """Sum of the rows n - 1, n, n + 1 times their weights."""
    found = scaled(weights[0], row(x, n - 1))
    found = add_scaled(found, weights[1], row(x, n))
    return add_scaled(found, weights[2], row(x, n + 1))


@kernel()
def scatter(f, n, weights, force):
    """Add a force to the nodes n - 1, n, n + 1 by their weights."""
    for c in range(3):
        f[n - 1, c] += weights[0] * force[c]
        f[n, c] += weights[1] * force[c]
        f[n + 1, c] += weights[2] * force[c]
