"""Where a quantity goes as the mesh is refined, from values on three or more meshes.

With f(h) = f0 + C h^p on three meshes there are as many equations as unknowns,

    (f1 - f2) / (f2 - f3) = (h1^p - h2^p) / (h2^p - h3^p),

which has a solution p > 0 only if the values go one way and their steps shrink fast enough. Where p comes out between
0.5 and 2.1, about the formal order of the element, f0 follows from it. Anywhere else values are noisy or not yet in the
range in which one term rules, an extrapolation by p is not to be trusted, and f0 is taken from a least-squares fit of
first or second order, whichever fits better, with its residual as scatter: after L. Eca and M. Hoekstra, A procedure
for the estimation of the numerical uncertainty of CFD calculations, Journal of Computational Physics 262 (2014) 104.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from validation.values import rms

LOWEST = 0.5
HIGHEST = 2.1
_ORDERS = (1e-6, 60.0)  # between which an order is looked for


@dataclass(frozen=True)
class Extrapolation:
    """The limit of a quantity at h = 0, and how it was found.

    Parameters
    ----------
    limit : in the unit of the quantity
    order : observed order p of the three finest meshes; None where the values know none
    basis : "Richardson", "first order" or "second order" (least squares), or "no change" (within the noise)
    remark : why it is not Richardson; empty where it is
    scatter : rms residual of a least-squares fit, or half the range of values that do not change; 0 for Richardson
    """

    limit: float
    order: float | None
    basis: str
    remark: str
    scatter: float


def observed_order(
    sizes: Sequence[float] | FloatArray, values: Sequence[float] | FloatArray
) -> float | None:
    """Order p of three values on meshes of falling size; None where there is no p > 0."""
    h1, h2, h3 = sizes
    coarse = values[0] - values[1]
    fine = values[1] - values[2]
    if coarse * fine <= 0:
        return None
    ratio = coarse / fine
    if ratio <= log(h1 / h2) / log(h2 / h3):  # the limit of the right-hand side at p -> 0
        return None

    def excess(p):
        # divided by h2^p, so that no power vanishes
        return ((h1 / h2) ** p - 1) - ratio * (1 - (h3 / h2) ** p)

    from scipy.optimize import brentq

    if excess(_ORDERS[1]) > 0:
        return float(brentq(excess, *_ORDERS))
    return _ORDERS[1]


def extrapolate(sizes: ArrayLike, values: ArrayLike, noise: float = 0.0) -> Extrapolation:
    """Extrapolate to h = 0.

    Parameters
    ----------
    sizes : (n,) of the elements, falling, n at least 3
    values : (n,)
    noise : to which the values are known; changes within it do not count

    Raises
    ------
    InputError : fewer than three meshes, sizes that do not fall, or values that are not numbers
    """
    h = np.asarray(sizes, float)
    f = np.asarray(values, float)
    if (
        h.ndim != 1
        or h.size < 3
        or f.shape != h.shape
        or not (np.all(np.diff(h) < 0) and h[-1] > 0)
    ):
        raise InputError(
            "an extrapolation needs at least three values, on meshes of falling element size"
        )
    if not np.isfinite(f).all():
        raise InputError("an extrapolation needs values that are numbers")
    spread = 0.5 * float(np.ptp(f))
    if spread <= noise:
        return Extrapolation(
            float(f[-1]), None, "no change", "changes are within the noise", spread
        )
    p = observed_order(h[-3:], f[-3:])
    if p is not None and LOWEST <= p <= HIGHEST:
        limit = f[-1] + (f[-1] - f[-2]) / ((h[-2] / h[-1]) ** p - 1)
        return Extrapolation(float(limit), p, "Richardson", "", 0.0)
    if p is None:
        steps = np.diff(f[-3:])
        remark = "steps do not shrink"
        if steps[0] * steps[1] <= 0:
            remark = "not monotone"
    else:
        remark = f"observed order {p:.1f} is {'below 0.5' if p < LOWEST else 'above the formal 2'}"
    fits = []
    for order, name in ((1, "first order"), (2, "second order")):
        A = np.column_stack([np.ones_like(h), h**order])
        solution = np.linalg.lstsq(A, f, rcond=None)[0]
        fits.append((rms(A @ solution - f), float(solution[0]), name))
    scatter, limit, name = min(fits)
    return Extrapolation(limit, p, name, remark, scatter)
