"""Vectors of three components, as tuples or the rows of an array."""

from shellfabric.jit.compile import kernel


@kernel(_nrt=False, forceinline=True)
def dot(a, b):
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel(_nrt=False, forceinline=True)
def cross(a, b):
    """Return the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel(_nrt=False, forceinline=True)
def scaled(s, a):
    """Return s a."""
    return s * a[0], s * a[1], s * a[2]


@kernel(_nrt=False, forceinline=True)
def add(a, b):
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel(_nrt=False, forceinline=True)
def subtract(a, b):
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel(_nrt=False, forceinline=True)
def add_scaled(a, s, b):
    """Return a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@kernel(_nrt=False, forceinline=True)
def across(a, normal):
    """Return the part of a at right angles to a unit vector."""
    return subtract(a, scaled(dot(a, normal), normal))


@kernel(_nrt=False, forceinline=True)
def three(values, first):
    """Return the vector of three values that stand one after another."""
    return values[first], values[first + 1], values[first + 2]


@kernel(_nrt=False, forceinline=True)
def column(values, first, k):
    """Return the vector of three rows of an array in its column k."""
    return values[first, k], values[first + 1, k], values[first + 2, k]


@kernel(_nrt=False, forceinline=True)
def nodal(values, k):
    """Return the vector of node k, of three arrays of its components."""
    return values[0][k], values[1][k], values[2][k]


@kernel(_nrt=False, forceinline=True)
def difference(x, a, b):
    """Return the vector from node a to node b."""
    return subtract(nodal(x, b), nodal(x, a))


@kernel(_nrt=False, forceinline=True)
def components(axes, x):
    """Return the components of a vector along three axes, the rows of an array."""
    return dot(axes[0], x), dot(axes[1], x), dot(axes[2], x)


@kernel(_nrt=False, forceinline=True)
def combined(axes, x):
    """Return the vector with these components along three axes, the rows of an array."""
    return add_scaled(add_scaled(scaled(x[0], axes[0]), x[1], axes[1]), x[2], axes[2])
