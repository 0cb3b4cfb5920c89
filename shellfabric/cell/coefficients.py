"""Coefficients of the tables of a cell: bilinear and biquadratic interpolation."""

from __future__ import annotations

import numpy as np

from fabrics.base.checks import FloatArray


def grid(lowest: float, highest: float, n: int) -> FloatArray:
    """Make a uniform grid (n,), one of them 1, from `lowest` or a step below it to at least
    `highest`; lowest <= 1 < highest."""
    below = int((1 - lowest) / (highest - lowest) * (n - 1))
    if below:
        step = (1 - lowest) / below
    else:
        step = (highest - 1) / (n - 2)
    below = below or int(lowest < 1)
    return 1 + step * (np.arange(n) - below)


def bilinear(f: FloatArray) -> FloatArray:
    """Compute c (n1-1, n2-1, 4) with f = c0 + c1 s + c2 t + c3 s t in the local coordinates 0 <= s,
    t <= 1 of each cell."""
    f00 = f[:-1, :-1]
    f10 = f[1:, :-1]
    f01 = f[:-1, 1:]
    f11 = f[1:, 1:]
    found = np.empty((*f00.shape, 4))
    for k, values in enumerate((f00, f10 - f00, f01 - f00, f11 - f10 - f01 + f00)):
        found[..., k] = values
    return found


def nonnegative(
    f: FloatArray, fx: FloatArray, fy: FloatArray, fxy: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Limit nodal values and slopes per cell of the grid so that the bicubic between them is
    nowhere negative.

    Where yarns come into contact the potential rises from zero as a parabola, and a cubic through
    it dips below zero: fabric would creep away from its rest. A bicubic is not negative where its
    Bernstein coefficients are not: those about a node are f +- fx / 3 +- fy / 3 +- fxy / 9, with
    the signs of the four cells there. Beside rest alone, since it costs accuracy of the table.
    """
    f = np.maximum(f, 0.0)
    fx = np.clip(fx, -3 * f, 3 * f)
    fy = np.clip(fy, -3 * f, 3 * f)
    lowest = 3 * np.abs(fx + fy) - 9 * f
    highest = 9 * f - 3 * np.abs(fx - fy)
    return f, fx, fy, np.clip(fxy, lowest, highest)


def spline(
    f: FloatArray, fx: FloatArray, fy: FloatArray, fxy: FloatArray, rest: tuple[int, int]
) -> FloatArray:
    """Compute c (n1-1, n2-1, 9) with f = sum c[3 p + q] s^p t^q, the quadratic B-spline next to
    nodal values and slopes.

    A quadratic from node 0 to node 1 has the control (f0 + f1) / 2 + (f0' - f1') / 4 in between,
    where the tangents at its ends meet; of what is no quadratic it is the mean of the two tangents.
    Pieces joined so share values and first derivatives. Forces are linear along their own stretch,
    and off by a twelfth of the spacing's square times their curvature at the nodes, by half as much
    and the other way in between.

    rest : node of the stretches 1. Controls about it are not negative, and so neither is f; and
    those next to it are zero where f and its slopes are, so that fabric at rest has no forces.
    """
    still = abs(f[rest]) + abs(fx[rest]) + abs(fy[rest]) < 1e-9 * np.abs(f).max()
    d = _controls(_controls(f, fx, 0), _controls(fy, fxy, 0), 1)
    i, j = rest  # the controls before and behind it are i and i + 1
    about = slice(max(i - 1, 0), i + 3), slice(max(j - 1, 0), j + 3)
    d[about] = np.maximum(d[about], 0.0)
    if still:
        d[i : i + 2, j : j + 2] = 0.0
    c = np.empty((d.shape[0] - 2, d.shape[1] - 2, 9))
    for p, along in enumerate(_monomials(d)):
        for q, both in enumerate(_monomials(along.T)):
            c[..., 3 * p + q] = both.T
    if still:
        c[i, j, [0, 1, 3]] = 0.0  # to the last digit
    return c


def _monomials(d):
    """Coefficients of 1, s, s^2 along the first axis between two controls, from these and the one
    behind them."""
    before = d[:-2]
    here = d[1:-1]
    behind = d[2:]
    return 0.5 * before + 0.5 * here, here - before, 0.5 * before - here + 0.5 * behind


def _controls(f, slope, axis):
    """Controls between the nodes along an axis, and one beyond each end, from values and slopes at
    the nodes."""
    f = np.moveaxis(f, axis, 0)
    slope = np.moveaxis(slope, axis, 0)
    inner = 0.5 * (f[:-1] + f[1:]) + 0.25 * (slope[:-1] - slope[1:])
    return np.moveaxis(
        np.concatenate([inner[:1] - slope[:1], inner, inner[-1:] + slope[-1:]]), 0, axis
    )
