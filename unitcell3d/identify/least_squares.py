"""Nonlinear least squares for residuals that cost seconds to minutes and come with noise: DFO-LS, without derivatives.

It interpolates each residual linearly between the points of a trust region, whose radius goes from `FIRST` to `LAST`
(Cartis, Fiala, Marteau and Roberts, ACM Transactions on Mathematical Software 45 (2019) 32).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fabrics.checks import FloatArray

FIRST, LAST = 0.3, 0.01  # radii of the trust region, in each unknown; they are logarithms
DIFFERENCE = 0.02  # step of the Jacobian at the solution, well above what is left in an evaluation
MOST = 100  # evaluations


@dataclass(frozen=True)
class Found:
    """x : (p,) the solution; residual : (n,), jacobian : (n, p) by differences, there; met : it ended at `LAST`."""

    x: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    met: bool


def solve(
    evaluate: Callable[[list[FloatArray]], list[FloatArray]],
    start: ArrayLike,
    bounds: tuple[ArrayLike, ArrayLike],
) -> Found:
    """Minimise the sum of squares.

    Parameters
    ----------
    evaluate : function of a list of x : (p,) giving a list of residuals (n,)
    start : (p,)
    bounds : ((p,), (p,)), at least 2 `FIRST` apart

    Returns
    -------
    Found

    Raises
    ------
    ModuleNotFoundError : DFO-LS is not installed
    """
    import dfols

    low, high = (np.asarray(bound, float) for bound in bounds)
    found = dfols.solve(
        lambda x: evaluate([x])[0], np.clip(np.asarray(start, float), low, high), bounds=(low, high), rhobeg=FIRST,
        rhoend=LAST, maxfun=MOST, do_logging=False,
    )  # fmt: skip
    x = np.asarray(found.x)
    (residual,) = evaluate([x])
    return Found(x, residual, _differences(evaluate, x, residual, high), found.flag == found.EXIT_SUCCESS)


def _differences(evaluate, x, residual, high):
    """The Jacobian (n, p), its columns evaluated together."""
    steps = np.where(x + DIFFERENCE < high, DIFFERENCE, -DIFFERENCE)
    ahead = evaluate([x + step * unit for step, unit in zip(steps, np.eye(len(x)))])
    return np.stack([(each - residual) / step for each, step in zip(ahead, steps)], axis=1)
