"""Nonlinear least squares for residuals that cost seconds to minutes: few evaluations, several beside each other.

Levenberg and Marquardt's steps

    (J^T J + lambda diag(J^T J)) s = -J^T r

from a Jacobian by differences at the start, kept up by Broyden's update from every evaluation after that

    J <- J + (r(x + s) - r(x) - J s) s^T / (s^T s)

and taken by differences again where steps no longer help. It ends when a Jacobian by differences promises to take off
less than `WORTH` of the sum of squares, or when its steps, long or short, do not: the residuals are then as small as
the noise of an evaluation lets them be. Several lambdas are tried beside each other, and the best step is taken.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fabrics.checks import FloatArray

DIFFERENCE = 0.02  # step of the Jacobian, well above what is left in an evaluation
WORTH = 0.01  # of the sum of squares
LONGEST = 0.7  # step in each unknown; they are logarithms
LAMBDA, SPREAD = 1e-2, 10.0  # the first, and the ratio of lambdas that are tried beside each other
ROUNDS = 25


@dataclass(frozen=True)
class Found:
    """x : (p,) the solution; residual : (n,), jacobian : (n, p) by differences, there; met : nothing more promised."""

    x: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    met: bool


def solve(
    evaluate: Callable[[list[FloatArray]], list[FloatArray]],
    start: ArrayLike,
    bounds: tuple[ArrayLike, ArrayLike],
    *,
    trials: int = 1,
) -> Found:
    """Minimise the sum of squares.

    Parameters
    ----------
    evaluate : function of a list of x : (p,) giving a list of residuals (n,)
    start : (p,)
    bounds : ((p,), (p,))
    trials : steps to try in each round, evaluated together

    Returns
    -------
    Found
    """
    low, high = map(np.asarray, bounds)
    x = np.clip(np.asarray(start, float), low, high)
    residual = evaluate([x])[0]
    jacobian, exact, damping = _differences(evaluate, x, residual, high), True, LAMBDA
    retried = False
    for _ in range(ROUNDS):
        dampings = [damping * SPREAD**i for i in range(trials)]
        steps = [_step(jacobian, residual, each, low - x, high - x) for each in dampings]
        now = np.sum(residual**2)
        promised = 1 - min(np.sum((residual + jacobian @ step) ** 2) for step in steps) / now if now > 0 else 0.0
        if promised < WORTH and exact:
            return Found(x, residual, jacobian, True)
        tried = evaluate([x + step for step in steps]) if promised >= WORTH else []
        gains = [1 - np.sum(each**2) / now for each in tried]
        best = int(np.argmax(gains)) if gains else 0
        gain = gains[best] if gains else 0.0
        if gain < WORTH and exact and retried:
            return Found(x, residual, jacobian, False)
        if gain < WORTH and exact:
            damping, retried = dampings[-1] * SPREAD**2, True  # a much shorter step, before it is given up
            continue
        for step, each in zip(steps, tried):
            if np.any(step):  # else a bound is in the way
                jacobian = jacobian + np.outer(each - residual - jacobian @ step, step) / (step @ step)
        exact = False
        if gain > 0:
            x, residual, damping = x + steps[best], tried[best], dampings[best] / SPREAD
        if gain < WORTH:
            jacobian, exact, damping, retried = _differences(evaluate, x, residual, high), True, LAMBDA, False
    return Found(x, residual, _differences(evaluate, x, residual, high), False)


def _differences(evaluate, x, residual, high):
    """The Jacobian (n, p), its columns evaluated together."""
    steps = np.where(x + DIFFERENCE < high, DIFFERENCE, -DIFFERENCE)
    ahead = evaluate([x + step * unit for step, unit in zip(steps, np.eye(len(x)))])
    return np.stack([(each - residual) / step for each, step in zip(ahead, steps)], axis=1)


def _step(jacobian, residual, damping, least, most):
    """Marquardt's step, shortened to `LONGEST`, each part of it between `least` and `most`.

    A part that would leave its bound is set to it, and the others are found anew.
    """
    step, free = np.zeros(len(least)), np.ones(len(least), bool)
    least, most = np.maximum(least, -LONGEST), np.minimum(most, LONGEST)
    while free.any():
        part = jacobian[:, free]
        normal = part.T @ part
        scale = np.maximum(np.diag(normal), 1e-6 * np.diag(normal).max()) + 1e-300
        wanted = np.linalg.solve(normal + damping * np.diag(scale), -part.T @ (residual + jacobian @ (step * ~free)))
        longest = np.abs(wanted).max()
        step[free] = wanted * min(1.0, LONGEST / longest) if longest > 0 else 0.0
        outside = free & ((step < least) | (step > most))
        if not outside.any():
            break
        step = np.where(outside, np.clip(step, least, most), step)
        free &= ~outside
    return step
