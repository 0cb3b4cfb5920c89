"""Discretisation uncertainty of the value on the finest of several meshes.

After L. Eca and M. Hoekstra, A procedure for the estimation of the numerical uncertainty of CFD calculations, Journal
of Computational Physics 262 (2014) 104. With the limit f0 of `validation.verification.richardson`, the value f on the
finest mesh, the residual s of the fit and the range D of the data over the number of steps,

    U = F |f - f0| + s + |f - fit|         s < D
    U = 3 s / D (|f - f0| + s + |f - fit|)   otherwise

with F = 1.25 where the order was observed (the grid convergence index of P. J. Roache) and 3 where a fit of first or
second order took its place. The tolerance of the value itself, such as half the width of a bracket, is added.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from validation.verification.richardson import Extrapolation

OBSERVED, FITTED = 1.25, 3.0


def uncertainty(sizes: Sequence[float], values: Sequence[float], found: Extrapolation, noise: float = 0.0) -> float:
    """U of the last of `values`.

    Parameters
    ----------
    sizes : (n,) of the elements, falling
    values : (n,)
    found : their extrapolation
    noise : to which the values are known
    """
    h, f = np.asarray(sizes, float), np.asarray(values, float)
    if found.basis == "no change":
        return float(np.ptp(f)) + noise
    distance = abs(float(f[-1]) - found.limit)
    if found.basis == "Richardson":
        return OBSERVED * distance + noise
    x = h if found.basis == "first order" else h**2
    slope = float(np.dot(x, f - found.limit) / np.dot(x, x))
    off = abs(float(f[-1]) - found.limit - slope * float(x[-1]))
    step = float(np.ptp(f)) / (f.size - 1)
    if found.scatter < step:
        return FITTED * distance + found.scatter + off + noise
    return 3 * found.scatter / step * (distance + found.scatter + off) + noise
