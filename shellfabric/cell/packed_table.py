"""The table of a cell as the kernels read it: rows that begin with a cache line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.cell import crossover_kernels
from shellfabric.jit.aligned import aligned_zeros

_STEPS = 256  # of the force, in the bound of the tension
REACH = 0.15  # of the stretch beyond the table; from 0.1 to 0.2 the tangent there is at most 1.01 times the table's
_PIECE = 2000  # cells that are worked on together, so that what is in between stays in the cache


@dataclass(frozen=True)
class Packed:
    """A table as the kernels read it (`CellTable.packed`).

    Parameters
    ----------
    ceilings, potential, beyond : what the functions of these names return
    """

    ceilings: list[tuple[FloatArray, float]]
    potential: tuple[FloatArray, FloatArray]
    beyond: tuple[float, ...]


def potential(spline: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Pack the potential of a table's `spline` but for its constants, (cells, 8) [J], each row a cache
    line, and these, (cells,) [J]."""
    columns = spline.reshape(-1, 9)
    rows = aligned_zeros(1, 8 * len(columns))[0].reshape(-1, 8)
    rows[:] = columns[:, [3, 6, 1, 2, 4, 7, 5, 8]]  # of p, p p, q, q q, p q, p p q, p q q, p p q q
    return rows, columns[:, 0].copy()


def beyond(spline: FloatArray, steps: tuple[float, float]) -> tuple[float, ...]:
    """Compute what `table_kernels` goes on with beyond a table with a `spline` and `steps` [-]: its reach
    in cells along both stretches, and at its corner both slopes of the potential and both its
    curvatures [J]."""
    corner = spline[-1, -1].reshape(3, 3)  # of p^a q^b at [a, b]
    _, first1, second1 = corner.sum(axis=1)
    _, first2, second2 = corner.sum(axis=0)
    curvatures = max(2 * second1, 0.0), max(2 * second2, 0.0)
    reaches = (REACH / step for step in steps)
    return tuple(map(float, (*reaches, first1 + 2 * second1, first2 + 2 * second2, *curvatures)))


def ceilings(
    spline: FloatArray, tensions: Sequence[FloatArray], scales: Sequence[float]
) -> list[tuple[FloatArray, float]]:
    """Compute the bounds that the forces of the variational form give of the tensions of warp and
    weft (`_ceiling`).

    Parameters
    ----------
    spline, tensions : of a CellTable, tensions of (warp, weft)
    scales : (warp, weft) [m] by which a slope of the potential over a cell of the table is a force
    """
    found = []
    spline = spline.reshape(-1, 3, 3)  # of p^a q^b at [a, b]
    for family, scale in enumerate(scales):
        values = tensions[family].reshape(-1, 4)
        bounds = []
        for begin in range(0, len(spline), _PIECE):
            W, T = (
                np.ascontiguousarray(np.moveaxis(x[begin : begin + _PIECE], 0, -1))
                for x in (spline, values)
            )
            if family == 1:
                W = W.swapaxes(0, 1)
                T = T[[0, 2, 1, 3]]
            force = np.stack([W[1], W[1] + 2 * W[2]]) / scale
            none = np.zeros_like(T[0])
            tension = np.array([[T[0], T[2], none], [T[0] + T[1], T[2] + T[3], none]])
            bounds.append(_bounds(force, tension))
        found.append(_ceiling(*np.concatenate(bounds, axis=1)))
    return found


def _bounds(force, tension):
    """(4, cells) [N] lowest and highest force, most that the tension is above it, and highest
    tension of each cell.

    force, tension (2, 3, cells) [N] : of one family, coefficients over the other's local
    coordinate, at both ends of its own, along which both are linear. A quadratic lies between the
    least and most of its Bernstein coefficients.
    """
    found, excess, tensions = map(_bernstein, (force, tension - force, tension))
    return np.stack(
        [found.min((0, 1)), found.max((0, 1)), excess.max((0, 1)), tensions.max((0, 1))]
    )


def _ceiling(low, high, over, top):
    """((steps, 2) [N], [N]) see `crossover_kernels.tension_bound_table`, and the width of its
    steps."""
    most = max(high.max(), top.max())
    unit = most / _STEPS
    rounding = 1e-9 * most
    steps = np.empty((_STEPS + 1, 2))
    crossover_kernels.tension_bound_table(
        low - rounding, high + rounding, over + rounding, top + rounding, unit, steps
    )
    return steps, unit


def _bernstein(quadratics):
    """(2, 3, n) coefficients of Bernstein from those of 1, x, x x, on 0 <= x <= 1."""
    a = quadratics[:, 0]
    b = quadratics[:, 1]
    c = quadratics[:, 2]
    found = np.empty_like(quadratics)
    found[:, 0] = a
    found[:, 1] = a + 0.5 * b
    found[:, 2] = a + b + c
    return found
