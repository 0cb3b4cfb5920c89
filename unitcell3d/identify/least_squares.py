"""Nonlinear least squares with a Jacobian that comes with each evaluation: scipy's trust region,
kept inside bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from fabrics.base.checks import FloatArray

# relative change of the sum of squares, or of the unknowns, which are logarithms
CONVERGED = 1e-3
MOST = 30  # evaluations


@dataclass(frozen=True)
class Found:
    """x : (p,) the solution; residual : (n,) and jacobian : (n, p) there; met : converged within
    `MOST` evaluations."""

    x: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    met: bool


def solve(
    evaluate: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    start: ArrayLike,
    bounds: tuple[ArrayLike, ArrayLike],
) -> Found:
    """Minimise the sum of squares; the first step is at most 1 long in the unknowns.

    Parameters
    ----------
    evaluate : function of x : (p,) giving residual (n,) and jacobian (n, p); a residual that is not
        finite makes the step that led to it shorter
    start : (p,)
    bounds : ((p,), (p,))

    Returns
    -------
    Found
    """
    low, high = (np.asarray(bound, float) for bound in bounds)
    origin = np.clip(np.asarray(start, float), low, high)
    known: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def at(step):
        if step.tobytes() not in known:
            known[step.tobytes()] = evaluate(origin + step)
        return known[step.tobytes()]

    # in steps from the start: scipy's first trust region is then 1 wide
    found = least_squares(
        lambda step: at(step)[0],
        np.zeros_like(origin),
        jac=lambda step: at(step)[1],
        bounds=(low - origin, high - origin),
        xtol=CONVERGED,
        ftol=CONVERGED,
        max_nfev=MOST,
    )
    residual, jacobian = at(found.x)
    return Found(origin + found.x, residual, jacobian, found.status > 0)


def identify(
    jacobian: FloatArray, noise: float, freedom: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Compute the 95 % half width of each parameter, their correlation, and the singular values and
    directions of J.

    Parameters
    ----------
    jacobian : (n, p) of the weighted misfit
    noise : standard deviation of one weighted misfit
    freedom : degrees of freedom of the misfit
    """
    _, singular, directions = np.linalg.svd(jacobian, full_matrices=False)
    covariance = noise**2 * (directions.T / np.maximum(singular, 1e-12) ** 2) @ directions
    deviation = np.sqrt(np.diag(covariance))
    from scipy.stats import t as student  # which takes a quarter of a second to load

    half = student.ppf(0.975, freedom) * deviation
    return half, covariance / np.outer(deviation, deviation), singular, directions
