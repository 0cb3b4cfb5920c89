"""Norms, products and solutions whose bits are the same on every processor.

What numpy and scipy hand to BLAS or LAPACK (the operator @, `np.dot`, `np.linalg`, SuperLU) is added up in an order
that the library chooses by the processor: the last bits differ from machine to machine. Code that then
decides something by such a number, or iterates from it, can go another way. Here everything is a product
of elements and numpy's sum, which adds in one order wherever it runs.

`tools/processor_places.py` finds the calls that are not made through this module;
tools/processor_places.csv says of each what it decides.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def norm(values: FloatArray, axis: int | None = None, *, keepdims: bool = False) -> FloatArray:
    """Compute the Euclidean norm of an array, of all entries or along an axis, in its unit."""
    return np.sqrt(np.sum(values * values, axis=axis, keepdims=keepdims))


def dot(first: ArrayLike, second: ArrayLike) -> float:
    """Add up the products of the entries of two arrays (n,)."""
    return float(np.sum(np.multiply(first, second)))


def multiply(first: ArrayLike, second: ArrayLike) -> FloatArray:
    """Multiply matrices or vectors as the operator @ does; for short sums.

    numpy's einsum adds in loops of its own, which are compiled for every processor alike.
    """
    first = np.asarray(first, float)
    second = np.asarray(second, float)
    left = "...ij"
    right = "...jk"
    result = "...ik"
    if first.ndim == 1:
        left = "j"
        result = result.replace("i", "")
    if second.ndim == 1:
        right = "j"
        result = result.replace("k", "")
    return np.einsum(f"{left},{right}->{result}", first, second)


def determinant(matrices: FloatArray) -> FloatArray:
    """Compute the determinants (...) of matrices (..., 3, 3) as triple products of their rows."""
    a, b, c = np.moveaxis(matrices, -2, 0)
    return np.sum(a * np.cross(b, c), axis=-1)


def invert(matrices: FloatArray) -> FloatArray:
    """Compute the inverses (..., 3, 3) of matrices (..., 3, 3): cross products of their rows over the
    determinant."""
    a, b, c = np.moveaxis(matrices, -2, 0)
    columns = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
    return columns / determinant(matrices)[..., None, None]


def fit_line(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Fit (slope, value at x = 0) of the straight line with the least squares through points (n,)."""
    off = x - x.mean()
    slope = dot(off, y) / dot(off, off)
    return slope, float(y.mean() - slope * x.mean())


def solve_laplace(matrix: csr_matrix, loads: FloatArray, tolerance: float = 1e-12) -> FloatArray:
    """Solve a symmetric positive semidefinite sparse system by conjugate gradients, (n, k).

    What no load reaches stays zero. The products of scipy's sparse matrices are plain loops.

    Parameters
    ----------
    matrix : (n, n)
    loads : (n, k), each column by itself
    tolerance : [-] of the norm of what is left of a column, over that of its load
    """
    found = np.zeros_like(loads)
    rest = loads.copy()
    direction = rest.copy()
    size = np.sum(rest * rest, axis=0)
    enough = tolerance**2 * size
    for _ in range(10 * len(loads)):
        if np.all(size <= enough):
            break
        pushed = matrix @ direction
        stiffness = np.sum(direction * pushed, axis=0)
        step = np.divide(size, stiffness, out=np.zeros_like(size), where=stiffness > 0)
        found += step * direction
        rest -= step * pushed
        before = size
        size = np.sum(rest * rest, axis=0)
        direction = (
            rest + np.divide(size, before, out=np.zeros_like(size), where=before > 0) * direction
        )
    return found
