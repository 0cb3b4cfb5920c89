"""Vectors of three numbers, and points of a chain of nodes.

A yarn is a chain of nodes x_k. Its middle line is their quadratic B-spline, continuous with its
tangent: at the index s, with k the nearest node and u = s - k,

    x(s) = (1/2 - u)^2 / 2 x_(k-1) + (3/4 - u^2) x_k + (1/2 + u)^2 / 2 x_(k+1)

A force at s goes to the three nodes by the same weights, so that force, moment and work are those at the point.
"""

from shellfabric.jit.compile import kernel


@kernel()
def dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel()
def cross(a, b):
    """Vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@kernel()
def plus(a, factor, b):
    """a + factor b."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@kernel()
def scaled(factor, a):
    """factor a."""
    return factor * a[0], factor * a[1], factor * a[2]


@kernel()
def across(a, normal):
    """The part of a at right angles to a unit vector."""
    return plus(a, -dot(a, normal), normal)


@kernel()
def row(x, n):
    """Row n of an array (nodes, 3)."""
    return x[n, 0], x[n, 1], x[n, 2]


@kernel()
def spline(s, count):
    """(nearest inner node, its three weights, their slopes) at the index s of a chain of `count` nodes."""
    k = min(max(int(s + 0.5), 1), count - 2)
    u = s - k
    weights = (0.5 * (0.5 - u) ** 2, 0.75 - u * u, 0.5 * (0.5 + u) ** 2)
    return k, weights, (u - 0.5, -2.0 * u, u + 0.5)


@kernel()
def gather(x, n, weights):
    """Sum of the rows n - 1, n, n + 1 times their weights."""
    found = scaled(weights[0], row(x, n - 1))
    found = plus(found, weights[1], row(x, n))
    return plus(found, weights[2], row(x, n + 1))


@kernel()
def scatter(f, n, weights, force):
    """Add a force to the nodes n - 1, n, n + 1 by their weights."""
    for c in range(3):
        f[n - 1, c] += weights[0] * force[c]
        f[n, c] += weights[1] * force[c]
        f[n + 1, c] += weights[2] * force[c]
