"""Error of the effective stretch: cells whose warp has gained or lost yarn, solved, against the table's scaling.

The panel evaluates the cell of a segment with the unstretched length L = share L0 at the stretch l / share
(`shellfabric.sliding.forces_kernels`). Here the cell itself is solved with the length L, at the same distances and with
the same closure of the two yarns, and the two are compared: tensions, forces on the nodes, configurational force of the
warp and contact force.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray
from fabrics.base.errors import UnstableError
from shellfabric.cell.crossover_kernels import solve_many
from shellfabric.cell.model import COLUMNS, CellModel
from validation.values import largest

QUANTITIES = ("T1", "N1", "N2", "C1", "F")


def solved(
    model: CellModel, stretch1: ArrayLike, stretch2: ArrayLike, share: float
) -> dict[str, FloatArray]:
    """The cell with `share` times the warp's unstretched length.

    Parameters
    ----------
    stretch1, stretch2 : (n,) [-] lengths of the cell over those at rest

    Returns
    -------
    {name: (n,)} of QUANTITIES [N] and W [J]; C1 is -dW/dL1 per unit of L1 / L10 over the cell's length at rest

    Raises
    ------
    UnstableError : a cell that did not close
    """
    warp, weft, *others = model._arguments()
    first, second = np.broadcast_arrays(np.asarray(stretch1, float), np.asarray(stretch2, float))
    out = np.empty((8, first.size))
    longer = (warp[0], share * warp[1], *warp[2:])
    if not solve_many(first.ravel().copy(), second.ravel().copy(), longer, weft, *others, out):
        raise UnstableError("the crossover did not close", where=f"fabric {model.fabric.name}")
    found = dict(zip(COLUMNS, out))
    strain = found["T1"] / warp[2]
    return found | {"C1": found["T1"] * (1 + 0.5 * strain) * warp[1] / (2 * warp[0])}


def scaled(
    model: CellModel, stretch1: ArrayLike, stretch2: ArrayLike, share: float
) -> dict[str, FloatArray]:
    """The same from the cell at rest length, at the effective stretch of the warp, as the sliding panel has it."""
    first, second = np.broadcast_arrays(np.asarray(stretch1, float), np.asarray(stretch2, float))
    x = first / share
    found = model.solve(x, second)
    w, S0, EA = model.yarn_tuples[0][:3]
    slack = np.maximum(2 * w * x - S0, 0)
    alone = EA * slack / S0
    N = found["N1"] + (share - 1) * alone
    config = x * N / share - 0.5 * alone * slack / (2 * w)
    W = found["W"] + (share - 1) * 0.5 * alone * slack
    return {
        "T1": found["T1"],
        "N1": N / share,
        "N2": found["N2"],
        "C1": config,
        "F": found["F"],
        "W": W,
    }


def errors(model: CellModel, shares: ArrayLike, strains: ArrayLike) -> FloatArray:
    """(shares, QUANTITIES) largest error over the warp's strength.

    Parameters
    ----------
    shares : of the warp's length at rest in the cell
    strains : [-] of the warp pulled straight, at which the cells are compared; the weft is at its length at rest
    """
    weave = model.fabric.weave
    straight = weave.S0[0] / (2 * weave.w[0])
    found = []
    for share in np.atleast_1d(shares):
        stretch = share * straight * (1 + np.atleast_1d(strains))
        exact = solved(model, stretch, 1.0, float(share))
        table = scaled(model, stretch, 1.0, float(share))
        found.append(
            [largest(exact[name] - table[name]) / weave.warp.strength for name in QUANTITIES]
        )
    return np.array(found)
