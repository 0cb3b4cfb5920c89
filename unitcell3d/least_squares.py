"""Nonlinear least squares for residuals that cost seconds to minutes: few evaluations, several beside each other.

Levenberg and Marquardt's steps

    (J^T J + lambda diag(J^T J)) s = -J^T r

from a Jacobian by differences at the start, kept up by Broyden's update from every evaluation after that

    J <- J + (r(x + s) - r(x) - J s) s^T / (s^T s)

and taken by differences again where steps no longer help. It ends when a Jacobian by differences promises to take off
less than `WORTH` of the sum of squares. Several lambdas are tried beside each other, and the best step is taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

DIFFERENCE = 0.02  # step of the Jacobian, well above what is left in an evaluation
WORTH = 0.01  # of the sum of squares
LONGEST = 0.7  # step in each unknown; they are logarithms
LAMBDA, SPREAD = 1e-2, 10.0  # the first, and the ratio of lambdas that are tried beside each other
ROUNDS = 25


@dataclass(frozen=True)
class Found:
    """x : (p,) the solution; residual : (n,) there; jacobian : (n, p) there, by differences; met : it converged."""

    x: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    met: bool


def solve(evaluate, start, bounds, *, trials=1):
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
    for _ in range(ROUNDS):
        dampings = [damping * SPREAD**i for i in range(trials)]
        steps = [_step(jacobian, residual, each, low - x, high - x) for each in dampings]
        left = min(np.sum((residual + jacobian @ step) ** 2) for step in steps)
        if left >= (1 - WORTH) * np.sum(residual**2):
            if exact:
                return Found(x, residual, jacobian, True)
            jacobian, exact, damping = _differences(evaluate, x, residual, high), True, LAMBDA
            continue
        tried = evaluate([x + step for step in steps])
        best = int(np.argmin([np.sum(each**2) for each in tried]))
        better = np.sum(tried[best] ** 2) < np.sum(residual**2)
        for step, each in zip(steps, tried):
            if not np.any(step):  # a bound is in the way
                continue
            jacobian = jacobian + np.outer(each - residual - jacobian @ step, step) / (step @ step)
        exact = False
        if better:
            x, residual, damping = x + steps[best], tried[best], dampings[best] / SPREAD
        else:
            damping = dampings[-1] * SPREAD
            if damping > 1e3:
                jacobian, exact, damping = _differences(evaluate, x, residual, high), True, LAMBDA
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
